"""A driver whose user is synthetic: another voice answers what the robot says, and the ear hears it.

``prima live --driver`` takes it. Its address is a scenario: the user says its answers, and does
what it lets them do while the robot does something, as far as that needs no legs.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path
from time import monotonic

from prima.devices.goals import SAY, Begin
from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.live.drivers.speech import SpeechDriver
from prima.live.drivers.speech.sound import CHUNK, CHUNK_S, Hear, seconds
from prima.live.drivers.speech.voices import Voices
from prima.messages import Data, Occurred, Record
from prima.sim.happenings import When
from prima.sim.scenario import read_scenario

VOICE = "en-us+f3"
PAUSE_S = 1.0
"""How long the user thinks before they answer."""
PATIENCE_S = 2.0
"""The longest that the user, who does not walk, waits for anything else."""


class Pipes:
    """A loudspeaker and a microphone in memory."""

    def __init__(self) -> None:
        self.played: Hear = lambda _: None
        """Called with each chunk that the robot plays, when it is played."""
        self.heard = 0
        self._hear: Hear = lambda _: None
        self._left = b""

    def open(self, hear: Hear, lost: Callable[[str], None]) -> None:
        """Begin to listen."""
        self._hear = hear

    def put(self, sound: bytes) -> None:
        """Let the microphone hear a sound."""
        sound = self._left + sound
        for start in range(0, len(sound) - CHUNK + 1, CHUNK):
            self._hear(sound[start : start + CHUNK])
        self._left = sound[len(sound) // CHUNK * CHUNK :]

    async def play(self, sound: bytes) -> None:
        """Play a sound in real time."""
        began, self.heard = monotonic(), 0
        for start in range(0, len(sound), CHUNK):
            self.played(sound[start : start + CHUNK])
            ends = began + seconds(sound[: start + CHUNK])
            await asyncio.sleep(max(ends - monotonic(), 0))
            self.heard = min(start + CHUNK, len(sound))

    def close(self) -> None:
        """Hear nothing more."""
        self._hear = lambda _: None


class HeardDriver(SpeechDriver):
    """Speech by two pipes in memory instead of a sound card."""

    kind = "heard"

    def sound(self) -> Pipes:
        return self._pipes

    async def open(self) -> None:
        self._pipes = Pipes()
        path = Path(self.settings.address)
        scenario = read_scenario(str(path), path.read_bytes())
        whens = [when for when in scenario.whens if when.trigger == "asked"]
        self._whens = [when for when in scenario.whens if when.trigger == "doing"]
        self._answers = [(when.what, when.doings[0].text) for when in whens]
        self.hears([Answers({text: text for _, text in self._answers})])
        self._voice = await asyncio.to_thread(Voices, "espeak")
        self._speech = b""
        await super().open()
        self._room = asyncio.ensure_future(self._sounds())

    async def close(self) -> None:
        self._room.cancel()
        await super().close()

    async def perform(self, goal: Begin) -> Data:
        done = await super().perform(goal)
        if goal.kind == SAY:
            asyncio.get_running_loop().call_later(PAUSE_S, self._answer, goal.command.text or "")
        return done

    def observe(self, now: int, records: list[Record]) -> None:
        for record in records:
            for when in [one for one in self._whens if one.what == record.get("command")]:
                if record["phase"] == "start":
                    self._whens.remove(when)
                    self._do(when)

    def _do(self, when: When) -> None:
        """Let happen what the scenario says, later; each thing once."""
        loop = asyncio.get_running_loop()
        after = min(when.after.ms(1) / 1000, PATIENCE_S)
        for doing in when.doings:
            match doing.name:
                case "wait":
                    after += min(doing.values["for"].ms(1) / 1000, PATIENCE_S)
                case "touch":
                    data = {"sensor": doing.values["sensor"]}
                    touch = Occurred(f"touch.{data['sensor']}", "user", data)
                    loop.call_later(after, self.tell, touch)
                case "message":
                    told = {"from": doing.values["from"], "text": doing.text}
                    loop.call_later(after, self.tell, Occurred("message", "environment", told))

    def _answer(self, text: str) -> None:
        """Say what answers a text; again if that was not understood."""
        for asked, answer in self._answers:
            if fold(asked) in fold(text):
                self._speech += self._voice.say(answer, VOICE)
                return

    async def _sounds(self) -> None:
        """Silence, or what the user says, in real time."""
        while True:
            self._pipes.put(self._speech[:CHUNK].ljust(CHUNK, b"\0"))
            self._speech = self._speech[CHUNK:]
            await asyncio.sleep(CHUNK_S)


DRIVER = HeardDriver
