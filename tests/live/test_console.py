"""The driver whose voice is standard error and whose ear is standard input."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

import pytest

from prima.devices.goals import (
    LISTEN,
    SAY,
    Accepted,
    Begin,
    Done,
    News,
    Report,
    Sees,
    Speaks,
    Stopped,
)
from prima.devices.profile import Profile, read_robot
from prima.errors import UsageError
from prima.live.drivers.console import ConsoleDriver
from prima.live.drivers.console.commands import COMMANDS, help_text, read_typed, waits
from prima.live.drivers.console.lines import LineSource
from prima.messages import Command, Emergency, Heard, Occurred, Sensed
from prima.sim.map import read_world
from prima.talk.typed import COMMANDS as TALK

ROOT = Path(__file__).parent.parent.parent
ROBOT = ROOT / "documents" / "robots" / "console.xml"
ROOM = ROOT / "documents" / "worlds" / "room.xml"
WRITTEN = '<driver kind="console" devices="speaker speech-recognition"/>'
DEVICES = "speaker speech-recognition human-detection"
SPEAKER = frozenset({"speaker"})


def profile(*options: tuple[str, str], devices: str = "") -> Profile:
    made = "".join(f'<option name="{name}" value="{value}"/>' for name, value in options)
    driver = f'<driver kind="console" devices="{devices or DEVICES}">{made}</driver>'
    source = ROBOT.read_text(encoding="utf-8").replace(WRITTEN, driver)
    assert driver in source
    return read_robot("robot.xml", source.encode())


class Harness:
    """A driver in an event loop, with what it tells and a clock."""

    def __init__(self, *options: tuple[str, str], speed: float = 1.0, devices: str = "") -> None:
        robot = profile(*options, devices=devices)
        settings = next(one for one in robot.drivers if one.kind == "console")
        self.driver = ConsoleDriver(settings, robot, read_world("room.xml", ROOM.read_bytes()))
        self.told: list[Report | News] = []
        self._began = monotonic()
        self._speed = speed

    def now(self) -> int:
        return int((monotonic() - self._began) * 1000 * self._speed)

    async def __aenter__(self) -> Harness:
        self.driver.attach(self.told.append, self.now)
        await self.driver.open()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.driver.close()

    def say(self, key: str, text: str) -> None:
        command = Command("speak", {}, text, lang="en")
        self.driver.start(Begin(key, SAY, command, SPEAKER))

    async def until(self, holds: Callable[[], bool]) -> None:
        async with asyncio.timeout(30):
            while not holds():
                self.driver.sample(self.now())
                await asyncio.sleep(0.005)


@contextmanager
def stdin(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], int]]:
    """A pipe in the place of standard input; gives what types into it."""
    source, sink = os.pipe()
    with os.fdopen(source) as reader:
        monkeypatch.setattr(sys, "stdin", reader)
        try:
            yield lambda text: os.write(sink, text.encode())
        finally:
            os.close(sink)


def test_a_text_is_printed_and_lasts_as_long_as_the_voice(
    capsys: pytest.CaptureFixture[str],
) -> None:
    async def play() -> None:
        async with Harness(("stdin", "false")) as one:
            one.say("a", "Hello  there\x1b[2J.")
            assert one.driver.due() == pytest.approx(1100, abs=200)
            assert one.told == [Sees(True, 1.0, 0.0), Accepted("a")]
            one.driver.sample(5_000)
            assert one.told[2:] == [Done("a")]
            assert one.driver.due() is None

    asyncio.run(play())
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "robot: Hello there\ufffd[2J.\n")


def test_a_faster_voice_takes_less_time() -> None:
    async def play() -> None:
        async with Harness(("stdin", "false"), ("speed", "100"), ("user", "false")) as one:
            one.say("a", "Hello there.")
            assert one.told[0] == Sees(False)
            await one.until(lambda: Done("a") in one.told)
            assert one.now() < 1000

    asyncio.run(play())


def test_what_is_cancelled_stops_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    async def play() -> None:
        async with Harness(("stdin", "false")) as one:
            one.say("a", "Hello there.")
            one.driver.cancel("a")
            one.say("b", "Once more.")
            await one.driver.safe()
            assert [told for told in one.told if isinstance(told, Stopped)] == [
                Stopped("a", said=0),
                Stopped("b", said=0),
            ]
            assert one.driver.due() is None
            one.driver.cancel("a")  # what is over has stopped as well
            assert one.told[-1] == Stopped("a")

    asyncio.run(play())
    assert capsys.readouterr().err.count("(breaks off)") == 2


def test_a_line_is_what_the_user_says(monkeypatch: pytest.MonkeyPatch) -> None:
    async def play() -> None:
        with stdin(monkeypatch) as types:
            async with Harness() as one:
                types("\n  Come  on, follow me.\r\n/touch head\nlast")
                await one.until(lambda: len(one.told) == 4)
        assert one.told[1:] == [
            Speaks(True),
            Heard("Come on, follow me."),
            Occurred("touch.head", "user", {"sensor": "head"}),
        ]

    asyncio.run(play())


def test_a_sensor_that_the_robot_lacks_is_not_touched(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    async def play() -> None:
        with stdin(monkeypatch) as types:
            async with Harness() as one:
                types("/touch hed\n/touch nose\n/event touch.nose\n/touch back\n")
                await one.until(lambda: len(one.told) == 2)
                one.driver.profile.touch = frozenset()
                types("/touch back\n")
                await one.until(lambda: len(one.told) == 3)
        touched = Occurred("touch.back", "user", {"sensor": "back"})
        assert one.told[1:] == [touched, touched], "a robot without any takes every name"

    asyncio.run(play())
    nose = 'There is no touch sensor "nose". There is back and head.'
    assert capsys.readouterr().err.splitlines() == [
        'There is no touch sensor "hed". Did you mean "head"?',
        *(nose, nose),
    ]


def test_the_last_line_counts_without_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    async def play() -> None:
        source, sink = os.pipe()
        os.write(sink, b"Yes.")
        os.close(sink)
        with os.fdopen(source) as reader:
            monkeypatch.setattr(sys, "stdin", reader)
            async with Harness() as one:
                await one.until(lambda: Heard("Yes.") in one.told)
                one.say("a", "It goes on after the end of the input.")
                assert one.told[-1] == Accepted("a")

    asyncio.run(play())


def test_lines_wait_for_a_question_or_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    async def play() -> None:
        with stdin(monkeypatch) as types:
            async with Harness(("speed", "20"), speed=10) as one:
                types("/wait\nYes.\n/wait 2s\n/go\n")
                one.say("s", "Shall I?")
                one.driver.start(Begin("l", LISTEN, Command("q-and-a"), frozenset()))
                await one.until(lambda: Heard("Yes.") in one.told)
                heard, began = one.now(), monotonic()
                await one.until(lambda: Emergency(False, True) in one.told)
                assert one.told.index(Done("s")) < one.told.index(Speaks(True))
                assert one.now() - heard >= 1900 and monotonic() - began < 1.5  # the run's time

    asyncio.run(play())


@pytest.mark.parametrize(
    ("line", "news"),
    [
        ("/touch head", Occurred("touch.head", "user", {"sensor": "head"})),
        ("/event visitor name=Ann", Occurred("visitor", "environment", {"name": "Ann"})),
        ("/sensor temperature=30.5", Sensed({"temperature": 30.5})),
        ("/sensor light true", Sensed({"light": True})),
        (
            "/message from Ann: I am late.",
            Occurred("message", "environment", {"from": "Ann", "text": "I am late."}),
        ),
        ("/leave", Sees(False)),
        ("/come", Sees(True, 1.0, 0.0)),
        ("/stop", Emergency(True)),
        ("/go", Emergency(False, True)),
    ],
)
def test_commands_tell_what_happens(line: str, news: News) -> None:
    assert read_typed(line).news == news


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("/tuch head", 'There is no command "/tuch". Did you mean "/touch"?'),
        ("/xyz", 'There is no command "/xyz". Type /help.'),
        ("/touch", 'Write "/touch SENSOR".'),
        ("/event", 'Write "/event NAME KEY=VALUE ...".'),
        ("/event emergency.stop", 'Write "/stop" or "/go".'),
        ("/event visitor Ann", 'Write "/event NAME KEY=VALUE ...".'),
        ('/event visitor name="Ann', "A quotation mark is not closed."),
        ("/sensor light", 'Write "/sensor NAME=VALUE".'),
        ("/stop now", "Nothing follows this command."),
        ("x" * 2001, "The line is longer than 2000 characters."),
        ("a\0b", "The line contains an invalid character: U+0000."),
    ],
)
def test_a_wrong_line_says_what_to_write(line: str, message: str) -> None:
    with pytest.raises(UsageError) as error:
        read_typed(line)
    assert str(error.value) == message


@pytest.mark.parametrize("line", ["/event 1!", "/wait long"])
def test_a_wrong_value_is_refused(line: str) -> None:
    with pytest.raises(UsageError):
        read_typed(line)


def test_help_names_every_command_and_talk_knows_most_of_them() -> None:
    assert all(f"/{name}" in help_text() for name in COMMANDS)
    assert COMMANDS.keys() - TALK.keys() == {"come", "stop"}
    assert waits("2s") == 2000 and waits("") is None


def test_wrong_lines_change_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    async def play() -> None:
        with stdin(monkeypatch) as types:
            async with Harness() as one:
                types(f"/help\n/nothing\n{'x' * 30_000}\n/stop\n")
                await one.until(lambda: len(one.told) == 2)
                assert one.told[1] == Emergency(True)

    asyncio.run(play())
    printed = capsys.readouterr()
    assert "Type /help." in printed.err and "is longer than" in printed.err
    assert "/touch SENSOR" in printed.err and not printed.out


def test_who_sees_the_user_tells_where_they_are(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    async def play() -> None:
        with stdin(monkeypatch) as types:
            async with Harness(devices="speaker speech-recognition") as one:
                types("/leave\n/stop\n")
                await one.until(lambda: bool(one.told))
                assert one.told == [Emergency(True)]

    asyncio.run(play())
    assert "Another driver sees the user" in capsys.readouterr().err


def test_more_input_than_anybody_hears_is_not_kept() -> None:
    source, sink = os.pipe()
    os.set_blocking(sink, False)

    async def play() -> int:
        lines, written = LineSource(source), 0
        for _ in range(200):
            await asyncio.sleep(0.001)
            try:
                written += os.write(sink, b"yes\n" * 1000)
            except BlockingIOError:
                break
        assert await lines.next() == "yes"
        lines.close()
        return written

    assert asyncio.run(play()) < 200_000
    os.close(sink)
    os.close(source)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("speed", "0"), 'speed is "0". Write a number from 0.01 to 1000.'),
        (("speed", "nan"), 'speed is "nan". Write a number from 0.01 to 1000.'),
        (("user", "yes"), 'user is "yes". Write false or true.'),
        (("speed", "1_0"), 'speed is "1_0". Write a number from 0.01 to 1000.'),
        (("usr", "true"), 'there is no option "usr". Write speed, stdin or user.'),
    ],
)
def test_a_wrong_option_is_refused(option: tuple[str, str], message: str) -> None:
    async def play() -> None:
        async with Harness(option):
            pass

    with pytest.raises(UsageError, match=f"^robot.xml:[0-9]+:[0-9]+: {message}$"):
        asyncio.run(play())


APPLICATION = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">
<form id="f"><field name="come" type="boolean"><prompt>Shall I come?</prompt>
<noinput count="2"><exit/></noinput></field>
<block><speak>Well then.</speak><exit/></block></form></prima>"""


def live(tmp_path: Path, typed: str) -> subprocess.CompletedProcess[str]:
    path = tmp_path / "a.xml"
    path.write_text(APPLICATION, encoding="utf-8")
    command = ["-m", "prima", "live", "--robot", str(ROBOT), "--fa", str(path), "--speed", "5"]
    return subprocess.run(
        [sys.executable, *command],
        input=typed,
        capture_output=True,
        text=True,
        timeout=60,
        cwd=ROOT,
        check=False,
    )


def test_a_run_is_spoken_to_through_a_pipe(tmp_path: Path) -> None:
    done = live(tmp_path, "/wait\nYes.\n/stop\n/wait 1s\n/go\n")
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if "the emergency stop" in line]
    pressed, released = (float(row.split()[1]) for row in rows)
    assert released - pressed > 0.9
    assert '"Yes."' in done.stdout and "robot: Shall I come?" in done.stderr
    assert "robot:" not in done.stdout


@pytest.mark.skipif(os.name == "nt", reason="signals are POSIX's")
def test_quit_ends_the_run_as_ctrl_c_does(tmp_path: Path) -> None:
    done = live(tmp_path, "/quit\n")
    assert done.returncode == 128 + signal.SIGINT, done.stderr
    assert "Traceback" not in done.stderr
