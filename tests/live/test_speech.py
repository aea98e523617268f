"""The driver of voice and ear, without the packages that it needs."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

import pytest

from prima.devices.goals import News, Report, Speaks
from prima.devices.profile import read_robot
from prima.devices.settings import DriverSettings
from prima.errors import UsageError
from prima.grammar import load
from prima.grammar.answers import Answers
from prima.live.driver import Unreachable
from prima.live.drivers.speech import SpeechDriver, heard, pieces, read_options
from prima.live.drivers.speech.jsgf import jsgf, spelt
from prima.live.drivers.speech.nearest import hypotheses, likeness
from prima.live.drivers.speech.segments import BEFORE_S, Segments
from prima.live.drivers.speech.sound import CHUNK, CHUNK_S, Pipes, seconds
from prima.live.drivers.speech.sounds import arpabet
from prima.messages import Command, Cue, Heard, Hypothesis
from prima.sim.map import read_world

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
    assert list(pieces(command)) == [("One.", 500), ("Two.", 0)]
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


async def until(told: list[Report | News], count: int) -> None:
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

    with pytest.raises(Unreachable, match=r"pip install 'prima\[speech\]'"):
        asyncio.run(play())


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
    assert done.returncode == 3
    assert "pip install 'prima[speech]'" in done.stdout
