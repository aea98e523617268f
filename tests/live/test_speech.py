"""The driver of voice and ear, without the packages that it needs."""

from __future__ import annotations

import asyncio
import re
import subprocess
import sys
from collections.abc import Sized
from pathlib import Path
from time import process_time
from types import SimpleNamespace

import pytest

from prima.devices.goals import (
    RECORD,
    SAY,
    Accepted,
    Begin,
    Broke,
    News,
    RecordingBounds,
    Report,
    Speaks,
    Stopped,
)
from prima.devices.profile import read_robot
from prima.devices.settings import DriverSettings
from prima.errors import UsageError
from prima.grammar import load
from prima.grammar.answers import Answers
from prima.live.driver import Refused, Unreachable, Unusable
from prima.live.drivers.speech import SpeechDriver, SpokenPiece, heard, pieces, read_options
from prima.live.drivers.speech.jsgf import jsgf, spelt
from prima.live.drivers.speech.nearest import hypotheses, likeness
from prima.live.drivers.speech.segments import BEFORE_S, Segments
from prima.live.drivers.speech.sound import CHUNK, CHUNK_S, SoundCard, beep, seconds
from prima.live.drivers.speech.sounds import arpabet
from prima.live.drivers.speech.voices import Voices
from prima.live.recordings import Recordings
from prima.messages import Command, Cue, Heard, Hypothesis
from prima.sim.map import read_world
from tests.parties.speech.user import Pipes

ROOT = Path(__file__).parents[2]
ROBOT = ROOT / "documents" / "robots" / "speech.xml"
ROOM = ROOT / "documents" / "worlds" / "room.xml"
LOUD, QUIET = b"\x00\x40" * (CHUNK // 2), bytes(CHUNK)


def likely(chunk: bytes) -> float:
    return float(chunk == LOUD)


def settings_with(*options: tuple[str, str]) -> DriverSettings:
    made = "".join(f'<option name="{name}" value="{value}"/>' for name, value in options)
    text = ROBOT.read_text(encoding="utf-8")
    assert "</driver>" in text
    for name, _ in options:
        text = re.sub(f'<option name="{name}".*/>', "", text)
    source = text.replace("</driver>", f"{made}</driver>", 1)
    return next(one for one in read_robot("r.xml", source.encode()).drivers if one.kind == "speech")


# Grammars -----------------------------------------------------------------------------------


def written(abnf: str) -> str:
    grammar = load(f"#ABNF 1.0;\nlanguage en;\nroot $a;\n{abnf}")
    made = jsgf([Answers(grammars=[grammar])], lambda word: word != "kidode")
    return made.partition("<heard> = ")[2].rstrip(";\n")


@pytest.mark.parametrize(
    ("abnf", "made"),
    [
        ("$a = follow me;", "follow me"),
        ("$a = Come on, please | stop;", "( come on please | stop )"),
        ("$a = [please] go;", "[ please ] go"),
        ("$a = go <1-3>;", "( go ) [ go ] [ go ]"),
        ("$a = go <2->;", "( go ) ( go ) ( go )*"),
        ("$a = $b now; $b = here | there;", "( here | there ) now"),
        ("$a = here {x} | Kidode;", "here"),
        ("$a = I'll go;", "i'll go"),
        ("$a = here | $a there;", "here | ( here ) there"),
        ("$a = go $NULL | $VOID away;", "go"),
        ("$a = go | $<builtin:grammar/boolean>;", "go | ( yes | no )"),
        ("$a = go | on $<builtin:grammar/date>;", "go"),
    ],
)
def test_a_grammar_is_written_for_the_recogniser(abnf: str, made: str) -> None:
    assert written(abnf) in (made, f"( {made} )")


def test_options_and_types_are_written_and_what_nothing_can_be_said_of_is_not() -> None:
    takes = [Answers({"The lab": 1, "Room 12": 2}, type="boolean")]
    made = jsgf(takes, lambda _: True)
    assert made.startswith("#JSGF V1.0;") and "= the lab | ( yes | no );" in made
    assert jsgf([Answers(type="text")], lambda _: True) == ""
    assert jsgf([], lambda _: True) == ""
    many = Answers({f"{'very ' * 2000}{word}": 1 for word in ("a", "b", "c", "d", "e", "f")})
    assert jsgf([many], lambda _: True) == ""


TWICE = "".join(f"$x{at} = $x{at + 1} $x{at + 1};" for at in range(18))
NESTED = "".join(f"$x{at} = {'(b | ' * 90}$x{at + 1}{')' * 90};" for at in range(35))


@pytest.mark.parametrize(
    "rules",
    [
        f"$r = $x0 | a; {TWICE} $x18 = ();",
        f"$r = $x0 | a; {TWICE} $x18 = kidode;",
        f"$r = {'(' * 6}a{')<40->' * 6};",
        f"$r = $x0; {NESTED} $x35 = a;",
    ],
)
def test_a_grammar_that_is_large_when_it_is_written_is_left_to_the_open_ear(rules: str) -> None:
    grammar = load(f"#ABNF 1.0;\nlanguage en; root $r; {rules}")
    began = process_time()
    assert jsgf([Answers(grammars=[grammar])], lambda word: word != "kidode") == ""
    assert process_time() - began < 2, "50 ms on a quiet machine"


def test_words_are_spelt_as_dictionaries_spell_them() -> None:
    assert spelt("I’ll wait in Prof. Kidode's 'room'.") == [
        "i'll",
        "wait",
        "in",
        "prof",
        "kidode's",
        "room",
    ]


def test_names_are_given_their_sounds() -> None:
    assert arpabet("kˈɪdOdz") == "K IH D OW D Z"
    assert arpabet("x?") == ""


# Hypotheses ---------------------------------------------------------------------------------

ROOMS = ("Prof. Kidode's room", "the laboratory")


def test_the_phrase_that_is_like_what_was_heard_is_an_alternative() -> None:
    found = hypotheses("Prof kiddled through.", "", ROOMS, 0.6)
    assert found[0] == Hypothesis("Prof kiddled through.", 0.9)
    assert [one.text for one in found[1:]] == ["prof kidodes room"]
    assert 0.6 <= found[1].confidence < 0.9
    assert hypotheses("What a lovely day.", "", ROOMS, 0.6)[1:] == []


def test_what_both_recognisers_have_heard_is_surer() -> None:
    (only,) = hypotheses("The laboratory.", "the laboratory", ROOMS, 0.6)
    assert only == Hypothesis("The laboratory.", 0.99)
    one = hypotheses("Prof kiddled through.", "", ROOMS, 0.6)[1]
    both = hypotheses("Prof kiddled through.", "prof kidode's room", ROOMS, 0.6)[1]
    assert both.text == one.text and both.confidence > one.confidence


def test_what_only_the_grammar_fits_counts_if_it_is_somewhat_like_what_was_said() -> None:
    said = "Plough kiddled through."
    assert 0.4 < likeness(said, ROOMS[0]) < 0.6
    assert hypotheses(said, "", ROOMS, 0.6)[1:] == []
    assert hypotheses(said, "prof kidode's room", ROOMS, 0.6)[1].text == "prof kidodes room"
    assert hypotheses("What a lovely day.", "come on", ROOMS, 0.6)[1:] == []


def test_without_an_open_recogniser_the_grammar_is_taken_at_its_word() -> None:
    assert hypotheses("", "the laboratory", ROOMS, 0.6) == [Hypothesis("the laboratory", 0.6)]
    assert hypotheses("", "", ROOMS, 0.6) == []


def test_hypotheses_are_told_as_confidence_and_alternatives() -> None:
    told = heard([Hypothesis("a", 0.9), Hypothesis("b", 0.7)])
    assert told == Heard(
        "a", {"confidence": 0.9, "alternatives": [{"text": "b", "confidence": 0.7}]}
    )
    assert heard([Hypothesis("a", 0.9)]) == Heard("a", {"confidence": 0.9})


# Sound --------------------------------------------------------------------------------------


def test_utterances_are_cut_out_of_what_is_heard() -> None:
    segments = Segments(likely, 0.1)
    said = [segments.feed(one) for one in [QUIET] * 40 + [LOUD] * 10 + [QUIET] * 10]
    (found,) = [one for one in said if one]
    assert found.count(LOUD) == 10
    assert BEFORE_S <= seconds(found) <= BEFORE_S + 10 * CHUNK_S + 0.2
    assert not segments.speaking


def test_a_click_is_no_speech_and_endless_speech_is_cut() -> None:
    segments = Segments(likely, 0.1)
    assert not any(segments.feed(one) for one in [LOUD, LOUD, QUIET] * 20)
    assert any(segments.feed(LOUD) for _ in range(int(30 / CHUNK_S)))


def test_pipes_give_whole_chunks_and_play_in_real_time() -> None:
    pipes, played = Pipes(), bytearray()
    got: list[bytes] = []
    pipes.played = played.extend
    pipes.open(got.append, lambda _: None)
    pipes.put(bytes(CHUNK + 10))
    pipes.put(bytes(CHUNK - 10))
    assert [len(one) for one in got] == [CHUNK, CHUNK]
    asyncio.run(pipes.play(LOUD * 3))
    assert played == LOUD * 3


def test_pauses_lie_between_the_pieces_of_a_text() -> None:
    command = Command("speak", {}, "One. Two.", cues=(Cue(4, "pause", 500), Cue(9, "mark", "m")))
    assert list(pieces(command)) == [SpokenPiece("One.", 500, 0), SpokenPiece("Two.", 0, 5)]
    assert list(pieces(Command("speak", {}, " "))) == []


class Ears:
    """Recognisers that always hear the same."""

    def hear(self, sound: bytes) -> list[Hypothesis]:
        return [Hypothesis("Yes.", 0.9)]

    def close(self) -> None:
        """Nothing to give back."""


class Quick(SpeechDriver):
    """The driver with two pipes, and ears and voice of a test's own."""

    def sound(self) -> Pipes:
        self.pipes = Pipes()
        return self.pipes

    def _load(self) -> None:
        self._ears = Ears()
        self._voices = type("Voices", (), {"say": lambda *_: LOUD * 10})()
        self._segments = Segments(likely, 0.1)


async def quick(told: list[Report | News], *options: tuple[str, str]) -> Quick:
    robot = read_robot("r.xml", ROBOT.read_bytes())
    driver = Quick(settings_with(*options), robot, read_world("room.xml", ROOM.read_bytes()))
    driver.attach(told.append)
    await driver.open()
    return driver


async def until(told: Sized, count: int) -> None:
    async with asyncio.timeout(5):
        while len(told) < count:
            await asyncio.sleep(0.005)


def test_speech_is_told_when_it_begins_and_when_it_is_understood() -> None:
    told: list[Report | News] = []

    async def play() -> None:
        driver = await quick(told)
        driver.pipes.put(LOUD * 10 + QUIET * 10)
        await until(told, 2)
        await driver.close()

    asyncio.run(play())
    assert told == [Speaks(True), Heard("Yes.", {"confidence": 0.9})]


@pytest.mark.parametrize("duplex", ["half", "full"])
def test_the_ear_is_closed_while_the_robot_speaks(duplex: str) -> None:
    told: list[Report | News] = []

    async def play() -> None:
        driver = await quick(told, ("duplex", duplex))
        driver.pipes.put(LOUD * 5)
        await until(told, 1)
        playing = asyncio.ensure_future(driver._play(LOUD * 20))
        await asyncio.sleep(0.05)
        driver.pipes.put(LOUD * 10 + QUIET * 10)
        await playing
        await asyncio.sleep(0.1)
        await driver.close()

    asyncio.run(play())
    words = Speaks(False) if duplex == "half" else Heard("Yes.", {"confidence": 0.9})
    assert told == [Speaks(True), words]


@pytest.mark.parametrize(("chunks", "said"), [(7, 0), (35, 8)])
def test_x2_it_tells_how_much_of_a_text_was_played(chunks: int, said: int) -> None:
    told: list[Report | News] = []
    played: list[bytes] = []
    command = Command("speak", {}, "One. Two three.", lang="en", cues=(Cue(4, "pause", 100),))

    async def play() -> None:
        driver = await quick(told)
        driver._voices = type("Slow", (), {"say": lambda *_: LOUD * 20})()
        driver.pipes.played = played.append
        driver.start(Begin("a", SAY, command, frozenset({"speaker"})))
        await until(played, chunks)
        driver.cancel("a")
        await until(told, 2)
        await driver.close()

    asyncio.run(play())
    assert told == [Accepted("a"), Stopped("a", said=said)]


# Recordings ---------------------------------------------------------------------------------

EAR = frozenset({"speech-recognition"})


async def recorded(
    told: list[Report | News], sound: bytes, bounds: RecordingBounds, recordings: Recordings
) -> None:
    driver = await quick(told)
    driver.recordings = recordings
    command = Command("q-and-a", {"timeout": "5s"}, cues=(Cue(0, "record", 0),))
    driver.start(Begin("a", RECORD, command, EAR, bounds=bounds))
    await asyncio.sleep(0.01)
    driver.pipes.put(sound)
    await until(told, 3)
    driver.cancel("a")
    await until(told, 4)
    driver.pipes.put(LOUD * 10 + QUIET * 10)
    await until(told, 6)
    await driver.close()


def test_what_the_user_says_is_recorded_without_the_silence_behind_it(tmp_path: Path) -> None:
    told: list[Report | News] = []
    kept = Recordings(str(tmp_path / "visit.jsonl"))
    sound = QUIET * 4 + LOUD * 20 + QUIET * 40
    asyncio.run(recorded(told, sound, RecordingBounds(silence=320), kept))
    data = (tmp_path / "visit-1.wav").read_bytes()
    facts = {"duration": 24 * 32, "size": len(data), "type": "audio/x-wav", "maxtime": False}
    assert told[:4] == [Accepted("a"), Speaks(True), Heard("visit-1.wav", facts), Stopped("a")]
    assert kept.samples("visit-1.wav") == QUIET * 4 + LOUD * 20
    assert told[4:] == [Speaks(True), Heard("Yes.", {"confidence": 0.9})]


def test_a_recording_is_cut_off_at_its_longest_time() -> None:
    told: list[Report | News] = []
    kept = Recordings()
    asyncio.run(recorded(told, LOUD * 40, RecordingBounds(longest=640), kept))
    assert isinstance(told[2], Heard)
    assert (told[2].text, told[2].data["maxtime"]) == ("recording-1.wav", True)
    assert kept.samples("recording-1.wav") == LOUD * 20


def test_a_recording_that_is_given_up_is_not_kept(tmp_path: Path) -> None:
    told: list[Report | News] = []

    async def play() -> None:
        driver = await quick(told)
        driver.recordings = Recordings(str(tmp_path / "visit.jsonl"))
        driver.start(Begin("a", RECORD, Command("q-and-a"), EAR))
        await asyncio.sleep(0.01)
        driver.pipes.put(LOUD * 10)
        driver.cancel("a")
        await until(told, 4)
        await driver.close()

    asyncio.run(play())
    assert told == [Accepted("a"), Speaks(True), Speaks(False), Stopped("a")]
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_written_is_not_recorded(tmp_path: Path) -> None:
    told: list[Report | News] = []

    async def play() -> None:
        driver = await quick(told)
        driver.recordings = Recordings(str(tmp_path / "gone" / "visit.jsonl"))
        driver.start(Begin("a", RECORD, Command("q-and-a"), EAR))
        await asyncio.sleep(0.01)
        driver.pipes.put(LOUD * 10 + QUIET * 80)
        await until(told, 4)
        await driver.close()

    asyncio.run(play())
    why = "the recording cannot be written: No such file or directory"
    assert told[3] == Broke("a", "speech-recognition", why, lacks=True)


def test_a_signal_and_a_recording_are_played_as_sounds() -> None:
    kept = Recordings()
    name = kept.keep(LOUD * 3, 16_000).text
    text = f"You said: {name} Again [beep]"
    cues = (Cue(9, "sound", name), Cue(25, "end"), Cue(32, "sound", "[beep]"), Cue(38, "end"))
    made = list(pieces(Command("speak", {}, text, cues=cues)))
    assert [(one.text, one.sound) for one in made] == [
        ("You said:", ""),
        (name, name),
        ("Again", ""),
        ("[beep]", "[beep]"),
    ]

    async def sounds() -> list[bytes]:
        driver = await quick([])
        driver.recordings = kept
        found = [driver._sound_of(one, "en") for one in made]
        await driver.close()
        return found

    voice, played, _, signal = asyncio.run(sounds())
    assert (voice, played) == (LOUD * 10, LOUD * 3)
    assert signal == beep() and seconds(signal) == 0.5 and set(signal) != {0}


def test_recordings_of_other_folders_are_not_played(tmp_path: Path) -> None:
    (tmp_path / "visits").mkdir()
    kept = Recordings(str(tmp_path / "visits" / "visit.jsonl"))
    assert kept.keep(LOUD, 16_000).text == "visit-1.wav"
    (tmp_path / "visit-1.wav").write_bytes((tmp_path / "visits" / "visit-1.wav").read_bytes())
    assert kept.samples("visit-../../visit-1.wav") is kept.samples("visit-2.wav") is None
    again = Recordings(str(tmp_path / "visits" / "visit.jsonl"))
    assert again.keep(LOUD, 16_000).text == "visit-2.wav", "nothing is written over"


# Bad input ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("ear", "left"), 'ear is "left". Write both, grammar or open.'),
        (("cutoff", "2"), 'cutoff is "2". Write a number from 0 to 1.'),
        (("silence", "x"), 'silence is "x". Write a number from 0.1 to 5.'),
        (("vioce", "espeak"), 'there is no option "vioce".'),
    ],
)
def test_a_wrong_option_is_refused(option: tuple[str, str], message: str) -> None:
    with pytest.raises(UsageError) as error:
        read_options(settings_with(option))
    assert message in str(error.value)


def test_what_is_not_installed_is_named_with_the_line_that_installs_it() -> None:
    async def play() -> None:
        robot = read_robot("r.xml", ROBOT.read_bytes())
        driver = SpeechDriver(settings_with(), robot, read_world("r.xml", ROOM.read_bytes()))
        driver.attach(lambda _: None)
        await driver.open()

    with pytest.raises(Unusable, match=r"pip install 'prima\[speech\]'"):
        asyncio.run(play())


@pytest.mark.parametrize(
    ("lang", "module", "extra"),
    [("en", "hibari", "speech"), ("ja", "pyopenjtalk", "speech,speech-ja")],
)
def test_a_voice_that_is_not_installed_is_named_with_its_extra(
    lang: str, module: str, extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(Refused, match=re.escape(f"pip install 'prima[{extra}]'")):
        Voices().say("a", lang)


def test_a_microphone_is_named_by_digits_or_by_anything_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[object] = []

    class Absent:
        def __init__(self, device: object, **_: object) -> None:
            asked.append(device)
            raise ValueError("none")

    monkeypatch.setitem(
        sys.modules, "sounddevice", SimpleNamespace(RawInputStream=Absent, RawOutputStream=Absent)
    )
    for name in ("", "3", "USB", "\u00b2"):
        with pytest.raises(Unreachable, match="microphone"):
            SoundCard(name).open(lambda _: None, lambda _: None)
    assert asked == [None, 3, "USB", "\u00b2"]


def test_the_command_says_so_as_well(tmp_path: Path) -> None:
    command = ["-m", "prima", "live", "--robot", str(ROBOT), "--check"]
    done = subprocess.run(
        [sys.executable, *command],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=ROOT,
        check=False,
    )
    assert done.returncode == 2
    assert "pip install 'prima[speech]'" in done.stdout
