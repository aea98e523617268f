"""A terminal instead of voice and ear: the robot's words are printed, the user's are typed."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Callable
from typing import NamedTuple

from prima.devices import voice
from prima.devices.goals import LISTEN, RECORD, SAY, Accepted, Begin, Done, Sees, Speaks, Stopped
from prima.devices.profile import Profile
from prima.devices.settings import DriverSettings
from prima.errors import UsageError
from prima.errors.visible import visible
from prima.interpreter.surroundings import nearest
from prima.live.driver import Driver, speaks
from prima.live.drivers.console.commands import HERE, Typed, help_text, read_typed, waits
from prima.live.drivers.console.lines import LineSource
from prima.messages import Heard, Occurred
from prima.sim.map import Map

TYPED_MS = 100
"""How long saying typed words takes, so that the robot can stop asking before it hears them."""
TICK_S = 0.02
SLOWEST, FASTEST = 0.01, 1000.0


class ConsoleSaying(NamedTuple):
    """A text that is being said. Times are ms of the run."""

    timeline: voice.SpeechTimeline
    began: int
    ends: int

    def said(self, ms: float) -> int:
        """How many of its characters have been said after a time."""
        return sum(1 for end in self.timeline.ends if end <= ms)


class ConsoleDriver(Driver):
    """Speaker, speech recognition and human detection by standard error and standard input.

    A text lasts as long as the robot's voice takes for it, divided by ``option`` ``speed``.
    If it has the device human-detection, the user is seen from the start, unless ``user`` is
    ``false``. With ``stdin`` ``false`` standard input is not read.
    """

    kind = "console"
    mapped = True
    own = frozenset({SAY, LISTEN, RECORD})

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._saying: dict[str, ConsoleSaying] = {}
        """The speech under way, by goal."""
        self._listening: set[str] = set()
        self._heard: tuple[int, str] | None = None
        """The end (ms of the run) and the text of the user's current utterance."""
        self._lines: LineSource | None = None
        self._task: asyncio.Task[None] | None = None
        self._speed = 1.0

    async def open(self) -> None:
        """Begin to read.

        Raises:
            UsageError: an option is wrong.
        """
        self.settings.check_options("speed", "user", "stdin")
        self._speed = self.settings.number("speed", SLOWEST, FASTEST, 1.0)
        seen = self.settings.choice("user", "true", "false") == "true"
        reads = self.settings.choice("stdin", "true", "false") == "true"
        source = _standard_input() if reads else None
        if source is not None and self._lines is None:
            self._lines = LineSource(source)
            self._task = asyncio.ensure_future(self._read(self._lines))
        if self._sees:
            self.tell(HERE if seen else Sees(False))

    @property
    def _sees(self) -> bool:
        """Whether this driver reports where the user is."""
        return "human-detection" in self.settings.devices

    def start(self, goal: Begin) -> None:
        """Print what is to be said, or open the ear."""
        self.tell(Accepted(goal.key))
        if goal.kind in (LISTEN, RECORD):
            self._listening.add(goal.key)
            return
        text, command = speaks(goal), goal.command
        rates = self.profile.voices
        timeline = voice.timeline(command.text or "", command.lang, rates, command.cues)
        now, lasts = self.now(), max(round(timeline.total / self._speed), 1)
        self._saying[goal.key] = ConsoleSaying(timeline, now, now + lasts)
        if text:
            self._print(f"robot: {' '.join(visible(text).split())}")

    def cancel(self, key: str) -> None:
        """Stop at once."""
        said, saying = None, self._saying.pop(key, None)
        if saying is not None:
            self._print("robot: (breaks off)")
            said = saying.said((self.now() - saying.began) * self._speed)
        self._listening.discard(key)
        self.tell(Stopped(key, said=said))

    async def safe(self) -> None:
        """Fall silent."""
        for key in list(self._saying):
            self.cancel(key)

    async def close(self) -> None:
        """Read no more."""
        if self._lines is not None:
            self._lines.close()
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    def due(self) -> int | None:
        """When a text has been said, or the user's words."""
        heard = [self._heard[0]] if self._heard is not None else []
        return min([*(one.ends for one in self._saying.values()), *heard], default=None)

    def sample(self, now: int) -> None:
        """Report what has been said by now."""
        for key in [key for key, one in self._saying.items() if one.ends <= now]:
            del self._saying[key]
            self.tell(Done(key))
        if self._heard is not None and self._heard[0] <= now:
            text, self._heard = self._heard[1], None
            self.tell(Heard(text))

    # What is typed ----------------------------------------------------------------------

    async def _read(self, lines: LineSource) -> None:
        """Carry out one line after the other."""
        while (line := await lines.next()) is not None:
            if not line.strip():
                continue
            try:
                await self._carry_out(read_typed(line))
            except UsageError as error:
                self._print(str(error))

    async def _carry_out(self, typed: Typed) -> None:
        if isinstance(typed.news, Sees) and not self._sees:
            raise UsageError("Another driver sees the user: human-detection is not this one's.")
        if isinstance(typed.news, Occurred) and typed.news.name.startswith("touch."):
            self._check_sensor(typed.news.name.removeprefix("touch."))
        if typed.news is not None:
            self.tell(typed.news)
        elif typed.said:
            self._heard = self.now() + TYPED_MS, typed.said
            self.tell(Speaks(True))
            await self._until(lambda: self._heard is None)
        elif typed.command == "wait":
            await self._wait(waits(typed.rest))
        elif typed.command == "help":
            self._print(help_text())
        else:
            signal.raise_signal(signal.SIGINT)

    def _check_sensor(self, name: str) -> None:
        """Raise a UsageError if the robot has other touch sensors, but not this one."""
        known = self.profile.touch
        if known and name not in known:
            raise UsageError(f'There is no touch sensor "{name}". {nearest(name, known).text}')

    async def _wait(self, lasts: int | None) -> None:
        if lasts is None:
            await self._until(lambda: bool(self._listening) and not self._saying)
            return
        until = self.now() + lasts
        await self._until(lambda: self.now() >= until)

    async def _until(self, holds: Callable[[], bool]) -> None:
        """Wait until something holds by the run's clock, which may be faster than real time."""
        while not holds():
            await asyncio.sleep(TICK_S)

    def _print(self, text: str) -> None:
        """Print to standard error: standard output has the rows of the run."""
        sys.stderr.write(f"{visible(text, chr(10))}\n")
        sys.stderr.flush()


def _standard_input() -> int | None:
    """Its file descriptor, if there is one."""
    try:
        return sys.stdin.fileno()
    except (AttributeError, OSError, ValueError):
        return None


DRIVER = ConsoleDriver
