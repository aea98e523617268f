"""The queue of prompts, which is played when a wait is reached (VoiceXML 2.0, 4.1.8)."""

from __future__ import annotations

from collections.abc import Mapping

from prima.messages import Command, Cue
from prima.voicexml.arranging import Arranged, Queued
from prima.voicexml.cues import MAX_CUES, later


class PromptQueue:
    """Prompts and Commands that are to be played, with the pauses and marks between them."""

    def __init__(self) -> None:
        self.pieces: list[Queued] = []
        self.answering: Mapping[str, str] | None = None
        """How the last prompt queued may be answered: its timeout and bargein count (4.1.7)."""
        self._prompt: Command | None = None
        """The last prompt queued."""
        self._ahead: tuple[Cue, ...] = ()
        """Pauses and marks not yet followed by speech."""

    def __bool__(self) -> bool:
        return bool(self.pieces)

    def put(self, piece: Queued) -> None:
        """Add Commands of the robot, which are always carried out: nobody may break in on them."""
        piece.hook = False
        self.pieces.append(piece)

    def say(self, text: str, lang: str, place: str, cues: tuple[Cue, ...]) -> None:
        """Add speech with its cues.

        Where there is no text, pauses and marks go behind what is said before, or ahead of what
        will be said next.
        """
        if text:
            prompt = self.cued(Command("speak", text=text, lang=lang, source=place), cues)
            self.pieces.append(prompt)
            self._prompt = prompt
            return
        last = self._said_last()
        if last is None and len(self._ahead) < MAX_CUES:
            self._ahead += later(cues, 0)
        elif last is not None and cues and len(last.cues) < MAX_CUES:
            _cue(last, (*last.cues, *later(cues, len(last.text or ""))))

    def cued(self, command: Command, cues: tuple[Cue, ...]) -> Command:
        """A Command with a text, whose cues follow those that are ahead of it."""
        _cue(command, (*self._ahead, *cues))
        self._ahead = ()
        return command

    def note_bargein(self, allowed: bool) -> None:
        """Note whether the user may break in on what has just been queued (4.1.5, 6.3.2)."""
        for piece in self.pieces:
            if piece.hook is None:
                piece.hook = allowed

    def take(self) -> list[Queued]:
        """Take all of it, to be played."""
        taken, self.pieces, self.answering = self.pieces, [], None
        return taken

    # For a question ----------------------------------------------------------------------

    def take_last_said(self) -> Command | None:
        """Take the last prompt, if nothing else follows it."""
        last = self._said_last()
        if last is None or last is not self._prompt:  # a Command of the robot may speak, too
            return None
        self.pieces.pop()
        return last

    def question_cues(self, asked: Command | None) -> tuple[Cue, ...]:
        """The cues of a question behind the queue: those of its prompt, and those of its own."""
        own, self._ahead = (asked.cues if asked is not None else self._ahead), ()
        return (*self._earlier(len(self.pieces)), *own)

    def open_to_answers(self, question: Command) -> list[Command]:
        """The part of the queue before a question during which it may be answered (4.1.5).

        Those are the last prompts: an answer ends the wait, and what may not be broken in on is
        to be said before. They get the cues that an answer needs.
        """
        found: list[Command] = []
        longest = tuple(cue for cue in question.cues if cue.kind == "longest")
        for index in reversed(range(len(self.pieces) if question.args["bargein"] else 0)):
            command = self.pieces[index]
            if isinstance(command, Arranged) or not command.hook:
                break
            command.cues = (*longest, *self._earlier(index), *command.cues)
            found.append(command)
        return found

    def _earlier(self, index: int) -> tuple[Cue, ...]:
        """The cue that there are marks before a piece, if so."""
        marked = any(cue.kind == "mark" for one in self.pieces[:index] for cue in one.cues)
        return (Cue(0, "earlier"),) if marked else ()

    def _said_last(self) -> Command | None:
        """The last speech; None if something else follows it."""
        last = self.pieces[-1] if self.pieces else None
        return last if isinstance(last, Command) and last.type == "speak" else None


def _cue(command: Command, cues: tuple[Cue, ...]) -> None:
    """Give a Command its cues. By marks the author says from where it can go on (X2)."""
    command.cues = cues
    command.restartable = command.type == "speak" and any(cue.kind == "mark" for cue in cues)
