"""The queue of prompts (VoiceXML 2.0, 4.1.8), with pauses and marks between them."""

from __future__ import annotations

from prima.messages import Command, Cue
from prima.voicexml.arranging import Arranged
from prima.voicexml.queue import PromptQueue

MARK, PAUSE = Cue(3, "mark", "here"), Cue(0, "pause", 500)


def queued(*pieces: tuple[str, tuple[Cue, ...]]) -> PromptQueue:
    queue = PromptQueue()
    for text, cues in pieces:
        queue.say(text, "en", "", cues)
    return queue


def said(queue: PromptQueue) -> list[tuple[str | None, list[tuple[int, str]]]]:
    """The texts of what is queued, with the places and kinds of their cues."""
    pieces = [one for one in queue.take() if isinstance(one, Command)]
    return [(one.text, [(cue.at, cue.kind) for cue in one.cues]) for one in pieces]


def test_what_has_no_text_is_ahead_of_the_next_words_whoever_says_them() -> None:
    queue = queued(("", (PAUSE,)), ("Hello.", (MARK,)))
    assert said(queue) == [("Hello.", [(0, "pause"), (3, "mark")])]
    queue.say("Once more.", "en", "", ())
    assert said(queue) == [("Once more.", [])]


def test_what_has_no_text_is_behind_what_is_said_before() -> None:
    queue = queued(("Hello.", ()), ("", (PAUSE,)))
    assert said(queue) == [("Hello.", [(6, "pause")])]


def test_what_follows_a_command_is_not_behind_what_is_said_before_it() -> None:
    queue = queued(("Hello.", ()))
    queue.put(Arranged([]))
    queue.say("", "en", "", (PAUSE,))
    assert queue.take_last_said() is None
    assert queue.question_cues(None) == (PAUSE,)
    assert queue.question_cues(None) == (), "it has been taken"


def test_only_prompts_that_allow_it_and_follow_one_another_are_open_to_an_answer() -> None:
    queue = queued(("One.", ()))
    queue.note_bargein(False)
    for text, cues in (("Two.", (MARK,)), ("Three.", ())):
        queue.say(text, "en", "", cues)
        queue.note_bargein(True)
    longest = Cue(0, "longest", 9000)
    opened = queue.open_to_answers(Command("q-and-a", {"bargein": True}, cues=(longest,)))
    assert [one.text for one in opened] == ["Three.", "Two."]
    assert opened[0].cues == (longest, Cue(0, "earlier")) and opened[1].cues == (longest, MARK)
    assert queue.open_to_answers(Command("q-and-a", {"bargein": False})) == []
