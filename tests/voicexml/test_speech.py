"""What prompts take in simulated time, and marks as places to be told and to go on from."""

from __future__ import annotations

import struct
import wave
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from prima import api
from prima.devices.voice import PAUSE_MS, SENTENCE_MS, duration, timeline
from prima.messages import Cue, Record
from prima.voicexml.cues import MAX_CUES, fold, rate_of
from prima.voicexml.document import read_page
from prima.voicexml.recordings import length_ms
from tests import ROOT
from tests.helpers.voice import Call, vxml

DEMO = ROOT / "documents"
Played = Callable[..., api.Transcript]


@pytest.fixture
def played(tmp_path: Path) -> Played:
    """Runs a document beside its files; each ``(ms, text)`` is said at a time of the run."""

    def run(
        body: str, *says: tuple[int, str], policy: str = "prima", more: str = ""
    ) -> api.Transcript:
        (tmp_path / "app.vxml").write_text(vxml(body))
        script = "".join(f'<when at="{at}ms"><say>{text}</say></when>' for at, text in says)
        (tmp_path / "scenario.xml").write_text(
            f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" policy="{policy}"'
            f' world="{DEMO}/worlds/room.xml" robot="{DEMO}/robots/papero.xml">'
            '<robot at="middle"/><person x="1" y="0"/><application src="app.vxml"/>'
            f"{script}{more}</scenario>"
        )
        made = api.rehearse(tmp_path / "scenario.xml")
        again = api.replay(made, tmp_path / "scenario.xml")
        assert again.dumps() == made.dumps()
        return made

    return run


def of(transcript: api.Transcript, phase: str) -> list[Record]:
    return [record for record in transcript.records if record["phase"] == phase]


def takes(transcript: api.Transcript) -> list[int]:
    """How long each speak took, in ms."""
    begun = [r for r in of(transcript, "start") if r["command"] == "speak"]
    ends = {r["behavior"]: r["time"] for r in of(transcript, "end")}
    return [round(1000 * (ends[r["behavior"]] - r["time"])) for r in begun]


def texts(transcript: api.Transcript) -> list[str]:
    return [record["text"] for record in of(transcript, "start") if record.get("text")]


def logs(transcript: api.Transcript) -> list[str]:
    return [record["message"] for record in of(transcript, "log")]


def prompt(markup: str) -> str:
    return f"<form><block><prompt>{markup}</prompt></block></form>"


def plain(text: str) -> int:
    return duration(text, "en", {})


# How long it takes --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("markup", "text", "more"),
    [
        ('One <break time="2s"/> two', "One two", 2000),
        ('One <break time="+1.5s"/> two', "One two", 1500),
        ('One <break time="250ms" strength="x-strong"/> two', "One two", 250),
        ("One <break/> two", "One two", 500),
        ('One <break strength="none"/> two', "One two", 0),
        ('One <break strength="x-weak"/> two', "One two", 100),
        ('One <break strength="weak"/> two', "One two", 250),
        ('One <break strength="medium"/> two', "One two", 500),
        ('One <break strength="strong"/> two', "One two", 750),
        ('One <break strength="x-strong"/> two', "One two", 1000),
        ('One <break size="small"/> two', "One two", 250),
        ('One <break size="large"/> two', "One two", 1000),
        ('<break time="2s"/>One two', "One two", 2000),
        ('One two<break time="2s"/>', "One two", 2000),
        ('One<break time="2s"/>two', "One two", 2000),
        ('One <break time="2s"/><break time="1s"/> two', "One two", 3000),
        ("<s>One</s> <s>two</s>", "One two", SENTENCE_MS),
        ("<p><s>One</s></p><p><s>two</s></p>", "One two", SENTENCE_MS),
        ("<p>One</p> two", "One two", SENTENCE_MS),
        ("One <p>two</p>", "One two", SENTENCE_MS),
        ("<s>One.</s><s>Two.</s>", "One. Two.", 0),
        ("<s>One</s>", "One", 0),
        ("<emphasis level='strong'>One</emphasis> two", "One two", 0),
        ('<voice gender="female">One</voice> two', "One two", 0),
        ('<prosody rate="default" pitch="high" volume="loud">One two</prosody>', "One two", 0),
        ('<prosody rate="medium">One two</prosody>', "One two", 0),
    ],
)
def test_pauses_are_added_to_what_the_words_take(  # SSML 1.0, 2.2.3
    played: Played, markup: str, text: str, more: int
) -> None:
    made = played(prompt(markup))
    assert (texts(made), takes(made)) == ([text], [plain(text) + more])


@pytest.mark.parametrize(
    ("rate", "factor"),
    [
        ("x-slow", 0.5),
        ("slow", 0.8),
        ("fast", 1.25),
        ("x-fast", 2.0),
        ("0.5", 0.5),
        ("2", 2.0),
        ("+10%", 1.1),
        ("-50%", 0.5),
        ("150%", 1.5),
        ("+0.5", 1.5),
    ],
)
def test_a_rate_counts_for_the_letters(played: Played, rate: str, factor: float) -> None:
    text = "A rather long sentence to be said at a rate"
    made = played(prompt(f'<prosody rate="{rate}">{text}</prosody>'))
    assert texts(made) == [text]
    expected = (plain(text) - PAUSE_MS) / factor + PAUSE_MS
    assert takes(made)[0] == pytest.approx(expected, abs=2)


@pytest.mark.parametrize(
    ("outer", "inner", "factor"),
    [
        ("-50%", "-50%", 0.25),
        ("50%", "+50%", 0.75),
        ("fast", "+100%", 2.5),
        ("2", "default", 1.0),
        ("2", "0.5", 0.5),
        ("slow", "fast", 1.25),
        ("10", "+1000%", 10.0),
        ("0", "-100%", 0.1),
        ("0.5", "no rate at all", 0.5),
    ],
)
def test_relative_rates_multiply_and_others_do_not(outer: str, inner: str, factor: float) -> None:
    assert rate_of(inner, rate_of(outer, 1.0)) == pytest.approx(factor)


def test_a_rate_ends_with_its_element_whatever_is_in_it(played: Played) -> None:
    made = played(
        prompt(
            '<prosody rate="0.5">aaaaaaaaaaaaaa <voice xml:lang="en-GB">bbbbbbbbbbbbbb</voice>'
            " cccccccccccccc</prosody> dddddddddddddd"
        )
    )
    assert texts(made) == ["aaaaaaaaaaaaaa", "bbbbbbbbbbbbbb", "cccccccccccccc dddddddddddddd"]
    assert takes(made) == [2300, 2300, 3300]


def test_a_set_duration_goes_before_rates_and_pauses(played: Played) -> None:  # SSML 1.0, 2.2.4
    made = played(
        prompt('<prosody duration="3s" rate="slow">One <break time="9s"/> two.</prosody>').replace(
            "</block>", '<prompt>One <prosody duration="3s">two</prosody></prompt></block>'
        )
    )
    assert takes(made) == [3000, 3000 + plain("One")]


def test_a_set_duration_within_another_is_a_part_of_it(played: Played) -> None:
    made = played(
        prompt(
            '<prosody duration="2s"><prosody duration="3s">One</prosody>'
            '<mark name="m"/><prosody duration="1s">two</prosody></prosody>'
        )
    )
    assert takes(made) == [2000]
    cues = tuple(
        Cue(at, kind, value)  # type: ignore[arg-type]
        for at, kind, value in (
            (0, "lasts", 2000),
            (0, "lasts", 3000),
            (3, "end", None),
            (3, "mark", "m"),
            (3, "lasts", 1000),
            (6, "end", None),
            (6, "end", None),
        )
    )
    assert timeline("Onetwo", "en", {}, cues).marks == ((1500, "m"),)


def test_a_set_duration_that_is_split_has_no_effect(played: Played) -> None:
    made = played(prompt('<prosody duration="9s">One <voice xml:lang="fr">deux</voice></prosody>'))
    assert takes(made) == [plain("One"), duration("deux", "fr", {})]


def test_a_pause_alone_goes_with_what_is_said_around_it(played: Played) -> None:
    made = played(
        """<form><block><prompt><break time="1s"/></prompt><prompt>One.</prompt>
        <prompt><break time="2s"/></prompt></block></form>"""
    )
    assert takes(made) == [plain("One.") + 3000]


def test_a_question_of_a_pause_alone_listens_after_it(played: Played) -> None:
    made = played(
        """<form><field name="f"><prompt timeout="1s"><break time="2s"/></prompt>
        <option>yes</option><noinput><exit/></noinput></field></form>"""
    )
    assert [record["time"] for record in of(made, "listening")] == [2.0]


def test_pauses_count_between_the_choices_of_an_enumerate(played: Played) -> None:
    made = played(
        """<menu><property name="timeout" value="1s"/><prompt><enumerate>Say <value expr="_prompt"/>
        <break time="1s"/></enumerate></prompt><choice event="a">red</choice><choice event="b">blue
        </choice><noinput><exit/></noinput></menu>"""
    )
    assert texts(made) == ["Say red Say blue"]
    heard = plain("Say red Say blue") + 2000
    assert [record["time"] for record in of(made, "listening")] == [heard / 1000]


def test_pauses_count_in_what_a_command_says(played: Played) -> None:
    made = played(
        '<form xmlns:p="urn:prima:dialogue:1"><block><p:turn-and-speak angle="1">One'
        ' <break time="3s"/> two</p:turn-and-speak></block></form>'
    )
    start, end = of(made, "start")[0], of(made, "end")[0]
    assert end["time"] - start["time"] == pytest.approx((plain("One two") + 3000) / 1000)


def test_a_pause_before_a_command_goes_ahead_of_what_it_says(played: Played) -> None:
    made = played(
        """<form xmlns:p="urn:prima:dialogue:1"><block><prompt><break time="2s"/><p:speak>One <mark
        name="a"/> two</p:speak></prompt><prompt>three</prompt></block></form>""",
        policy="prima+x2",
    )
    assert takes(made) == [plain("One two") + 2000, plain("three")]
    asked = of(made, "request")
    assert [one.get("restartable") for one in asked] == [True, None]
    assert asked[0]["cues"] == [{"at": 0, "pause": 2000}, {"at": 3, "mark": "a"}]


def test_a_long_pause_is_no_failure_of_the_speaker(played: Played) -> None:  # E1
    made = played(prompt('One <break time="300s"/> two'))
    assert (takes(made), of(made, "fail")) == ([plain("One two") + 300_000], [])


def test_a_slow_voice_is_no_failure_of_the_speaker() -> None:
    text = "a" * 4000
    assert timeline(text, "en", {}, (Cue(0, "rate", 0.1),)).total < 500 * 4000 * 10


def test_what_has_no_cues_is_recorded_as_before(played: Played) -> None:
    made = played(prompt("<p>One.</p> <emphasis>two</emphasis> <voice name='x'>three</voice>"))
    assert all("cues" not in record for record in made.records)


def test_cues_without_number_are_bounded() -> None:
    parts: list[str | Cue] = []
    for index in range(5000):
        parts += [Cue(0, "lasts", 5), f"w{index} ", Cue(0, "mark", "m"), Cue(0, "end")]
    cues = fold(parts)[1]
    assert len(cues) <= 2 * MAX_CUES
    kinds = [cue.kind for cue in cues]
    assert kinds.count("lasts") == kinds.count("end")


def test_pauses_with_nothing_to_say_are_bounded(played: Played) -> None:
    pauses = '<break time="1ms"/>' * 10
    prompts = f"<prompt>{pauses}</prompt>" * 300
    made = played(f"<form><block>{prompts}<prompt>One</prompt>{prompts}</block></form>")
    assert takes(made)[0] <= plain("One") + 3 * MAX_CUES


@pytest.mark.parametrize(
    "parts", [["a", "b"], [" a", "b "], ["a ", " b"], ["", "\n", "a"], ["a\tb", "", " c", "d"], []]
)
def test_text_is_folded_as_one_piece(parts: list[str]) -> None:
    assert fold(parts) == (" ".join("".join(parts).split()), ())


def pieces(chance: Random, deep: int) -> list[str | Cue]:
    """Random words and cues, set times inside each other."""
    made: list[str | Cue] = []
    for _ in range(chance.randint(0, 5)):
        match chance.randint(0, 6):
            case 0 if deep:
                inner = pieces(chance, deep - 1)
                made += [Cue(0, "lasts", chance.choice([0, 1, 900])), *inner, Cue(0, "end")]
            case 1:
                made.append(Cue(0, "rate", chance.choice([0.1, 1.0, 10.0])))
            case 2:
                made.append(Cue(0, "pause", chance.choice([1, 5000])))
            case 3:
                made.append(Cue(0, "mark", f"m{len(made)}"))
            case 4:
                made.append(Cue(0, "sentence"))
            case _:
                made.append(chance.choice(["One. ", "two", " ", "...", "日本 "]))
    return made


@pytest.mark.parametrize("seed", range(200))
def test_time_never_goes_back(seed: int) -> None:
    made = pieces(Random(seed), 3)
    text, cues = fold(made)
    laid = timeline(text, "en", {}, cues)
    assert text == " ".join("".join(one for one in made if isinstance(one, str)).split())
    assert len(laid.ends) == len(text) and laid.heard(laid.total) == text
    assert list(laid.ends) == sorted(laid.ends)
    times = [time for time, _ in laid.marks]
    assert times == sorted(times) and all(0 <= time <= laid.total for time in times)
    named = [one.value for one in made if isinstance(one, Cue) and one.kind == "mark"]
    assert [name for _, name in laid.marks] == named


# Values that are none -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("markup", "column"),
    [
        ('<break time="2"/>', 14),
        ('<break time="soon"/>', 14),
        ('<break time="-1s"/>', 14),
        ('<break time="1e3s"/>', 14),
        ('<break strength="huge"/>', 18),
        ('<break size="tiny"/>', 14),
        ('<prosody rate="quick">x</prosody>', 16),
        ('<prosody rate="">x</prosody>', 16),
        ('<prosody rate="10 %">x</prosody>', 16),
        ('<prosody rate="+-1">x</prosody>', 16),
        ('<prosody rate="1e3">x</prosody>', 16),
        ('<prosody rate="-">x</prosody>', 16),
        ('<prosody duration="long">x</prosody>', 20),
        ('<emphasis level="much">x</emphasis>', 18),
        ('<voice gender="robot">x</voice>', 16),
    ],
)
def test_a_value_that_is_none_is_told_with_its_place(markup: str, column: int) -> None:
    lines = f"<form><block><prompt>\n{markup}\n</prompt></block></form>"
    page = read_page("a.vxml", "a.vxml", vxml(lines).encode())
    [problem] = page.problems
    assert (problem.severity, problem.code, problem.place.line) == ("error", "bad-value", 2)
    assert (problem.place.column, bool(problem.remedy)) == (column, True)


@pytest.mark.parametrize(
    "markup",
    [
        '<break time=".5s"/><break time="5.s"/><break time="0ms"/>',
        '<prosody rate=".5"><prosody rate="5."><prosody rate="-15.9%">x</prosody></prosody></prosody>',
        '<prosody rate="999999999">x</prosody><prosody rate="0">y</prosody>',
        '<prosody duration="0s">x</prosody>',
    ],
)
def test_values_at_the_edge_are_fine(played: Played, markup: str) -> None:
    made = played(prompt(f"{markup} z"))
    assert made.outcome == "over" and takes(made)[0] > 0


# Recordings -----------------------------------------------------------------------------------


def recording(path: Path, seconds: float, rate: int = 8000) -> None:
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(1)
        sound.setframerate(rate)
        sound.writeframes(b"\x80" * round(seconds * rate))


def au(length: int, size: int, encoding: int = 1, rate: int = 8000) -> bytes:
    return b".snd" + struct.pack(">5I", 24, length, encoding, rate, 1) + b"x" * size


def mulaw(length: int, there: int) -> bytes:
    """A WAV file of 8-bit mu-law, as telephones have it, with a chunk before its sound."""
    form = b"fmt " + struct.pack("<IHHIIHH", 18, 7, 1, 8000, 8000, 1, 8) + b"\0\0"
    other = b"LIST" + struct.pack("<I", 3) + b"abc\0"
    body = b"WAVE" + form + other + b"data" + struct.pack("<I", length) + b"x" * there
    return b"RIFF" + struct.pack("<I", len(body)) + body


def test_a_recording_of_the_folder_takes_its_own_time(played: Played, tmp_path: Path) -> None:
    (tmp_path / "sounds").mkdir()
    recording(tmp_path / "sounds" / "bell.wav", 2.5)
    made = played(
        prompt('<audio src="sounds/bell.wav"/>').replace(
            "</block>",
            """<prompt><audio expr="'sounds/' + 'bell.wav'">A bell. <break time="9s"/></audio></prompt>
            <prompt>Listen: <audio src="sounds/bell.wav">a bell</audio>!</prompt>
            <prompt xml:base="sounds/"><audio src="bell.wav"/></prompt></block>""",
        )
    )
    assert texts(made) == ["[bell.wav]", "A bell.", "Listen: a bell !", "[bell.wav]"]
    assert takes(made) == [2500, 2500, plain("Listen:") + 2500, 2500]


def test_a_recording_that_is_not_there_is_said(played: Played) -> None:
    made = played(
        """<form><block><prompt><audio src="none.wav">A <break time="1s"/> bell.</audio></prompt>
        <prompt><audio src="none.wav"/></prompt>
        <prompt><audio src="http://example.org/a.wav">Far away.</audio></prompt>
        <prompt><audio src="http://example.org/a.wav"/></prompt></block></form>"""
    )
    assert texts(made) == ["A bell.", "[none.wav]", "Far away.", "[a.wav]"]
    assert takes(made) == [plain("A bell.") + 1000, 1000, plain("Far away."), 1000]


@pytest.mark.parametrize(
    "name",
    ["../x.wav", "/etc/passwd", "http://[", "a%00b.wav", "x" * 5000, "", "#a", "data:,x", "app.vxml",
     "folder", "link.wav"],
)  # fmt: skip
def test_what_is_no_recording_of_the_folder_is_not_played(
    played: Played, tmp_path: Path, name: str
) -> None:
    (tmp_path / "folder").mkdir()
    recording(tmp_path.parent / "x.wav", 9)
    (tmp_path / "link.wav").symlink_to(tmp_path.parent / "x.wav")
    made = played(prompt(f'<audio src="{name}">Said.</audio>'))
    assert (texts(made), takes(made), made.failures) == (["Said."], [plain("Said.")], [])


@pytest.mark.parametrize(
    ("head", "size", "ms"),
    [
        (mulaw(4000, 4000), None, 500),
        (mulaw(80_000, 10), 100_000, 10_000),  # only the beginning has been read
        (mulaw(0xFFFFFFFF, 4000), None, 500),  # written without knowing its end
        (mulaw(4000, 10), None, None),  # says more than there is
        (mulaw(0, 0), None, None),
        (au(4000, 4000), None, 500),
        (au(0xFFFFFFFF, 4000), None, 500),
        (au(4000, 4000, 3), None, 250),
        (au(4000, 4000, 99), None, None),
        (au(4000, 10), None, None),
        (au(10, 10, rate=0), None, None),
        (b"RIFF", None, None),
        (b"RIFF\0\0\0\0WAVE", None, None),
        (b"RIFF\0\0\0\0WAVEfmt \xff\xff\xff\xff", None, None),
        (b"RIFF\0\0\0\0WAVEdata\x01\0\0\0x", None, None),
        (b".snd\0", None, None),
        (b"ID3 an mp3", None, None),
        (b"", None, None),
    ],
)
def test_a_recordings_header_is_believed_only_where_it_can_be_true(
    head: bytes, size: int | None, ms: int | None
) -> None:
    assert length_ms(head, len(head) if size is None else size) == ms


# Marks ----------------------------------------------------------------------------------------

SECOND = "aaaaaaaaaaaaaa"
"""A word that takes a second."""
ASKED = f"""<field name="f"><prompt>{SECOND} <mark name="one"/> {SECOND} <mark name="two"/> {SECOND}</prompt>
<option>yes</option><nomatch><log expr="'no ' + application.lastresult$.markname
+ ' ' + application.lastresult$.marktime"/><exit/></nomatch>
<filled><log expr="f$.markname + ' ' + f$.marktime"/><log
expr="application.lastresult$.markname + ' ' + application.lastresult$.marktime"/></filled></field>"""


@pytest.mark.parametrize(
    ("at", "told"),
    [
        (500, "undefined undefined"),
        (1000, "one 0"),
        (1700, "one 700"),
        (2250, "two 250"),
        (3300, "two 1300"),
        (5300, "two 1300"),  # the prompt was over after 3.3 s
    ],
)
def test_the_last_mark_is_that_passed_at_bargein(played: Played, at: int, told: str) -> None:
    made = played(f"<form>{ASKED}</form>", (at, "yes"))
    assert logs(made) == [told, told]


def test_without_bargein_all_marks_are_passed_before_an_answer(played: Played) -> None:
    asked = ASKED.replace("<prompt>", '<prompt bargein="false">')
    made = played(f"<form>{asked}</form>", (500, "yes"), (3250, "yes"))
    assert logs(made) == ["two 1300", "two 1300"]


def test_a_nomatch_tells_the_mark_as_well(played: Played) -> None:
    made = played(f"<form>{ASKED}</form>", (1700, "what"))
    assert logs(made) == ["no one 700"]


@pytest.mark.parametrize(("at", "told"), [(3500, "zero 1500"), (4700, "one 400")])
def test_a_mark_of_an_earlier_prompt_counts(played: Played, at: int, told: str) -> None:
    before = f'<prompt>{SECOND} {SECOND} <mark name="zero"/> {SECOND}</prompt>'
    made = played(f"<form><block>{before}</block>{ASKED}</form>", (at, "yes"))
    assert logs(made) == [told, told]


def test_a_mark_of_what_was_answered_before_does_not_count(played: Played) -> None:
    second = ASKED.replace('"f"', '"g"').replace("f$", "g$").replace("<mark", "<break")
    second = second.replace('<break name="one"/>', "").replace('<break name="two"/>', "")
    made = played(f"<form>{ASKED}{second}</form>", (1700, "yes"), (6000, "yes"))
    assert logs(made)[-1] == "undefined undefined"


def test_a_mark_in_a_recordings_text_is_not_passed(played: Played, tmp_path: Path) -> None:
    recording(tmp_path / "bell.wav", 2)
    body = ASKED.replace(SECOND, '<audio src="bell.wav">a <mark name="x"/> bell</audio>', 1)
    assert logs(played(f"<form>{body}</form>", (1900, "yes")))[0] == "undefined undefined"
    assert logs(played(f"<form>{body}</form>", (2100, "yes")))[0] == "one 100"


def test_by_a_device_that_tells_of_no_marks_the_last_one_counts() -> None:
    call = Call(f"<form>{ASKED}</form>")
    call.answer("yes")
    assert call.logs()[0] == "two undefined"


# Resuming from a mark (X2) ----------------------------------------------------------------------

STORY = f"""<form><block><prompt>{SECOND} <mark name="one"/> {SECOND} {SECOND} <mark name="two"/> {SECOND}
</prompt></block></form>"""
TOUCH = f"""<application src="{DEMO}/fa/follow.xml" kind="fa"/><answer to="What's the matter">Nothing.</answer>
<when at="AT"><touch sensor="head"/></when>"""


def story(played: Played, at: str, body: str = STORY, policy: str = "prima+x2") -> api.Transcript:
    return played(body, policy=policy, more=TOUCH.replace("AT", at))


@pytest.mark.parametrize(
    ("at", "mark", "left"),
    [("500ms", None, 4300), ("1700ms", "one", 3300), ("3500ms", "two", 1300)],
)
def test_x2_an_utterance_goes_on_from_the_last_mark_passed(
    played: Played, at: str, mark: str | None, left: int
) -> None:
    made = story(played, at)
    resumed = of(made, "start")[-1]
    assert (resumed["resumed"], resumed.get("data", {}).get("mark")) == (True, mark)
    end = of(made, "end")[-1]
    assert end["time"] - resumed["time"] == pytest.approx(left / 1000)
    row = made.rows()[-2].what
    assert row.startswith("resumes ") and row.endswith(f"from the mark {mark}") == bool(mark)


def test_x2_an_utterance_may_be_broken_off_again_before_its_next_mark(played: Played) -> None:
    more = TOUCH.replace("AT", "1500ms") + (
        '<when asked="What\'s the matter" count="1" after="2500ms"><touch sensor="head"/></when>'
    )
    made = played(STORY, policy="prima+x2", more=more)
    told = [record["data"] for record in of(made, "halted")]
    assert [one["mark"] for one in told] == ["one", "one"]
    assert told[1]["heard"].startswith(SECOND)
    end, start = of(made, "end")[-1], of(made, "start")[-1]
    assert end["time"] - start["time"] == pytest.approx(3.3)


@pytest.mark.parametrize("policy", ["prima", "prima+x1"])
def test_without_x2_marks_do_not_let_an_utterance_be_broken(played: Played, policy: str) -> None:
    made = story(played, "1700ms", policy=policy)
    assert of(made, "interrupt") == []


def test_x2_a_prompt_without_marks_is_not_broken(played: Played) -> None:
    made = story(
        played, "1700ms", STORY.replace('<mark name="one"/>', "").replace('<mark name="two"/>', "")
    )
    assert of(made, "interrupt") == []


# Hotword bargein ----------------------------------------------------------------------------

HOT = f"""<form><field name="f"><prompt bargeintype="hotword">{SECOND} {SECOND} {SECOND}</prompt>
<option>yes</option><nomatch><log>no</log></nomatch><noinput><log>silence</log><exit/></noinput>
<filled><log expr="f"/></filled></field></form>"""


def test_with_hotword_bargein_what_is_not_understood_does_not_count(  # 4.1.5.1
    played: Played,
) -> None:
    made = played(HOT, (500, "what"), (4500, "who"))
    assert logs(made) == ["silence"]
    assert [record["time"] for record in of(made, "listening")] == [3.3]


def test_with_hotword_bargein_an_answer_ends_the_prompt(played: Played) -> None:
    made = played(HOT, (500, "what"), (1500, "yes"))
    assert (logs(made), of(made, "listening")) == (["yes"], [])
    assert of(made, "end")[-1]["time"] == pytest.approx(1.5 + plain("yes") / 1000, abs=0.1)


def test_without_bargein_there_is_no_hotword(played: Played) -> None:
    hot = HOT.replace("<prompt", '<prompt bargein="false"').replace(
        "<log>no</log>", "<log>no</log><exit/>"
    )
    assert logs(played(hot, (500, "yes"), (4000, "what"))) == ["no"]


def test_hotword_may_be_a_property(played: Played) -> None:  # 6.3.2
    hot = HOT.replace(' bargeintype="hotword"', "")
    with_property = hot.replace("<form>", '<property name="bargeintype" value="hotword"/><form>')
    assert logs(played(with_property, (500, "what"))) == ["silence"]
    assert logs(played(hot, (500, "what")))[0] == "no"


LONG_ANSWER = "the one that stands at the very end of the long corridor"

# The timeout and the user's speech (4.1.7) ---------------------------------------------------


@pytest.mark.parametrize("bargein", ["true", "false"])
@pytest.mark.parametrize("at", [0, 2000, 2900])
def test_the_timeout_does_not_run_while_the_user_speaks(
    played: Played, at: int, bargein: str
) -> None:
    asking = f"""<form><field name="f"><prompt bargein="{bargein}" timeout="500ms">Which one?</prompt>
    <option>{LONG_ANSWER}</option><noinput><log>silence</log></noinput>
    <filled><log expr="f"/></filled></field></form>"""
    hello = asking.replace("<form>", "<form><block>Hello, and good morning.</block>")
    assert logs(played(hello, (at, LONG_ANSWER))) == [LONG_ANSWER]


# Speech that is too long (6.3.2) --------------------------------------------------------------

LIMITED = f"""<form><property name="maxspeechtimeout" value="1s"/><field name="f"><prompt>Which?</prompt>
<option dtmf="1">{LONG_ANSWER}</option><option dtmf="2">this</option>
<catch event="maxspeechtimeout"><log>too long</log><exit/></catch>
<filled><log expr="f"/></filled></field></form>"""


def test_who_speaks_for_too_long_is_not_listened_to(played: Played) -> None:
    assert plain(LONG_ANSWER) > 1000
    made = played(LIMITED, (1500, LONG_ANSWER))
    assert logs(made) == ["too long"]
    assert of(made, "end")[-1]["time"] == 2.5, "no longer than the property says"
    (heard,) = [one for one in of(made, "event") if one["event"] == "speech"]
    assert heard["data"]["toolong"] is True


@pytest.mark.parametrize(
    ("said", "value"), [("this", "1s"), ("1", "1ms"), (LONG_ANSWER, "0s"), (LONG_ANSWER, "1min")]
)
def test_what_is_short_enough_is_an_answer(played: Played, said: str, value: str) -> None:
    made = played(LIMITED.replace('value="1s"', f'value="{value}"'), (1500, said))
    assert logs(made) == [LONG_ANSWER if said == "1" else said]


def test_without_a_catch_the_platform_asks_again(played: Played) -> None:  # 5.2.5
    text = LIMITED.replace("<catch", '<catch cond="false"')
    made = played(text, (1500, LONG_ANSWER), (6000, "this"))
    assert texts(made) == ["Which?", "That was too long.", "Which?"]
    assert logs(made) == ["this"]


def test_a_recording_has_its_own_longest_time(played: Played) -> None:
    made = played(
        """<form><property name="maxspeechtimeout" value="1s"/><record name="r"><prompt>Speak.</prompt>
        <filled><log expr="r$.duration > 1000"/></filled></record></form>""",
        (1500, LONG_ANSWER),
    )
    assert logs(made) == ["true"]


def test_speech_that_is_too_long_before_the_question_ends_it_as_well(played: Played) -> None:
    text = LIMITED.replace("<field", f"<block><prompt>{SECOND} {SECOND}</prompt></block><field")
    made = played(text, (500, LONG_ANSWER))
    assert logs(made) == ["too long"]
    assert texts(made) == [f"{SECOND} {SECOND}"]


def test_keys_alone_as_input_have_no_limit(played: Played) -> None:  # 6.3.6
    text = LIMITED.replace("<field", '<property name="inputmodes" value="dtmf"/><field')
    noinput = "<noinput><log>silence</log><exit/></noinput>"
    made = played(text.replace("<filled", f"{noinput}<filled"), (1500, LONG_ANSWER))
    assert logs(made) == ["silence"]


def test_another_question_than_was_asked_does_not_limit_what_was_said(played: Played) -> None:
    text = LIMITED.replace(
        "</field></form>",
        f"""<catch event="touch"><goto next="#two"/></catch></field></form>
        <form id="two"><field name="g"><prompt>And?</prompt><option>{LONG_ANSWER}</option>
        <filled><log expr="g"/></filled></field></form>""",
    )
    made = played(text, (1500, LONG_ANSWER), more='<when at="1800ms"><touch sensor="head"/></when>')
    assert logs(made) == [LONG_ANSWER]


def test_who_hangs_up_while_he_speaks_for_too_long_has_recorded_nothing(played: Played) -> None:
    made = played(LIMITED, (1500, LONG_ANSWER), more='<when at="2s"><hang-up/></when>')
    (gone,) = [one for one in of(made, "event") if one["event"].endswith("hangup")]
    assert gone.get("data") is None


MARKED = f"""<form><block><prompt>{SECOND}<mark name="one"/></prompt>
<prompt>{SECOND}<mark name="two"/> {SECOND}</prompt></block><field name="f">
<prompt>Which?<mark name="three"/> Now?</prompt><option>red</option>
<filled><log expr="f$.markname"/></filled></field></form>"""


@pytest.mark.parametrize(("at", "mark"), [(300, "undefined"), (1500, "one"), (2600, "two")])
def test_the_last_mark_is_that_passed_when_an_answer_comes_before_the_question(  # 2.1, 4
    played: Played, at: int, mark: str
) -> None:
    assert logs(played(MARKED, (at, "red"))) == [mark]


def test_a_text_with_half_a_letter_comes_out_of_a_grammar() -> None:
    call = Call(
        """<form><field name="x"><prompt>Well?</prompt>
        <grammar version="1.0" root="r" tag-format="semantics/1.0">
          <rule id="r">go<tag>out = "a\\ud800b"</tag></rule></grammar>
        <filled><log expr="x"/><log expr="x.length"/></filled></field></form>"""
    )
    call.answer("go")
    assert call.logs() == ["a\ufffdb", "3"]
