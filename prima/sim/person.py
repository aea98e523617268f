"""The scripted user, and the surroundings' events, of a scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from heapq import heapify, heappop, heappush

from prima.devices import voice
from prima.devices.senses import sensor_value
from prima.grammar.text import fold
from prima.interpreter.selection import takes
from prima.messages import (
    Emergency,
    Heard,
    Inbound,
    Json,
    Loaded,
    Narrated,
    Occurred,
    Record,
    Unloaded,
)
from prima.sim.happenings import Doing, When
from prima.sim.robot import Robot
from prima.sim.scenario import Scenario
from prima.sim.world import World, distance

KEYS = frozenset("0123456789*# ")
"""What is pressed, where nothing else is said."""
KEYS_THAT_END = "#*"
"""Keys pressed at the end of what is recorded: there is no silence to wait for."""

PHASES = {
    "asked": ("listening",),
    "said": ("listening", "end"),
    "doing": ("start",),
    "done": ("end",),
    "on": ("event",),
}
"""The records in which a user sees what he waits for, by their phase."""
OVER = ("end", "cancel", "fail")
"""How a behaviour ends in the records."""


@dataclass(slots=True, order=True)
class Script:
    """What follows a trigger: what is left of it, and when it goes on (ms)."""

    time: int
    triggered: bool
    """Whether something that the robot did has begun it; what was planned comes first."""
    serial: int
    left: list[Doing] = field(compare=False)
    speaking: str = field(default="", compare=False)
    began: int = field(default=0, compare=False)
    """When the user began to speak."""
    lasts: int = field(default=0, compare=False)
    """How long (ms) he speaks."""
    told: dict[str, Json] = field(default_factory=dict, compare=False)
    """What is told of it where it is recorded."""


class Person:
    """Plays the user: observes what the robot does, and does what the scenario says."""

    def __init__(self, scenario: Scenario, world: World, robot: Robot) -> None:
        self.world = world
        self.robot = robot
        self.sensors: dict[str, Json] = {}
        self._speed = scenario.person_speed
        self._awaited: dict[str, list[tuple[int, When]]] = {}
        """What the user waits for in records of a phase, with its number in the scenario."""
        self._fired: dict[int, int] = {}
        self._seen: dict[int, int] = {}
        self._scripts: list[Script] = []
        """What is still to be done, as a heap: what comes next is first."""
        self._playing: list[Script] = []
        """What is being done at this instant, and not in the heap meanwhile."""
        self._serial = 0
        self._listens = False
        """Whether it matters to the user what is said."""
        self._texts: dict[str, str] = {}
        """What the behaviours that go on have said."""
        self._following: float | None = None
        for index, when in enumerate(scenario.whens):
            if when.trigger == "at":
                self._begin(when.doings, int(when.what) + when.after, False)
            for phase in PHASES.get(when.trigger, ()):
                self._awaited.setdefault(phase, []).append((index, when))
            self._listens = self._listens or when.trigger in ("asked", "said")

    def _begin(self, doings: list[Doing], time: int, triggered: bool) -> Script:
        self._serial += 1
        script = Script(time, triggered, self._serial, list(doings))
        heappush(self._scripts, script)
        return script

    def play(self, time: int, doings: list[Doing]) -> Callable[[], bool]:
        """Do something at a time (ms) that is still to come, as a ``when`` at that time would.

        Returns:
            what tells whether all of it has been done.
        """
        script = self._begin(doings, time, False)
        return lambda: not any(one is script for one in self._scripts)

    @property
    def will_load(self) -> bool:
        """Whether an application is still to be put in again."""
        return any(doing.name == "load" for one in self._scripts for doing in one.left)

    # Observing --------------------------------------------------------------------

    def observe(self, now: int, records: list[Record]) -> None:
        """See what has happened, and react to it after a while."""
        for record in records:
            phase = record["phase"]
            if phase == "start" and self._listens and record.get("text"):
                self._texts[record["behavior"].partition(".")[0]] = record["text"]
            for index, when in self._awaited.get(phase, ()):
                if self._is(when, phase, record):
                    self._trigger(index, when, now)
            if self._texts and phase in OVER and record.get("outcome") != "again":
                self._texts.pop(str(record.get("behavior")).partition(".")[0], None)

    def _trigger(self, index: int, when: When, now: int) -> None:
        self._seen[index] = self._seen.get(index, 0) + 1
        fired = self._fired.get(index, 0)
        if self._seen[index] >= when.count and fired < when.times:
            self._fired[index] = fired + 1
            self._begin(when.doings, now + max(when.after, 1), True)

    def _is(self, when: When, phase: str, record: Record) -> bool:
        """Whether a record, of one of the trigger's phases, is what the user waits for."""
        behavior = record.get("behavior") or ""
        match when.trigger:
            case "asked":
                return self._holds(when, behavior)
            case "said":
                over = phase == "listening" or record.get("outcome") == "done"
                return over and self._holds(when, behavior)
            case "doing":
                first = behavior.partition(".")[2] in ("", "1")
                return first and record.get("command") == when.what
            case "done":
                over = record.get("outcome") != "again"
                return over and record.get("command") == when.what
            case _:
                return takes(when.what, record["event"])

    def _holds(self, when: When, behavior: str) -> bool:
        said = self._texts.get(behavior.partition(".")[0], "")
        return bool(said) and fold(when.what) in fold(said)

    # Doing ------------------------------------------------------------------------

    def due(self) -> int | None:
        """When something is to be done next, if ever."""
        return self._scripts[0].time if self._scripts else None

    def collect(self, now: int) -> list[Inbound]:
        """Everything that happens at ``now`` by the scenario's script."""
        made: list[Inbound] = []
        if self._scripts and self._scripts[0].time <= now:
            while self._scripts and self._scripts[0].time <= now:
                self._playing.append(heappop(self._scripts))
            for script in self._playing:
                made += self._go_on(script, now)
            self._scripts += [one for one in self._playing if one.left or one.speaking]
            heapify(self._scripts)  # whoever hangs up changes when others go on
            self._playing.clear()
        if self._following is not None:
            self._follow(self._following)
        return made

    def _go_on(self, script: Script, now: int) -> list[Inbound]:
        made: list[Inbound] = []
        while script.time <= now:
            if script.speaking:
                told = {**self.robot.conductor.marks_passed(script.began), **script.told}
                made.append(Heard(script.speaking, told, now - script.began))
                script.speaking = ""
                self.robot.ear.speech_ends()
            if not script.left:
                break
            doing = script.left.pop(0)
            made += self._do(doing, script, now)
        return made

    def _do(self, doing: Doing, script: Script, now: int) -> list[Inbound]:
        values = doing.values
        match doing.name:
            case "say":
                self._speak(doing.text, script, now)
                script.told = {**values.get("told", {}), **script.told}
            case "hang-up":
                return [self._hang_up(now)]
            case "touch":
                sensor = values["sensor"]
                return [Occurred(f"touch.{sensor}", "user", {"sensor": sensor})]
            case "walk":
                return self._walk(doing, script, now)
            case "wait":
                script.time = now + values["for"]
            case "look":
                return [Narrated("user", f"looks at the {values['at']}")]
            case "follow":
                self._following = values["distance"] or 1.2
                return [Narrated("user", "goes along with the robot")]
            case "stay":
                self._following = None
                self.world.walk(None, self._speed)
            case "leave":
                self._following = self.world.person = None
                self.world.walk(None, self._speed)
                return [Narrated("user", "goes away")]
            case "note":
                return [Narrated("environment", doing.text)]
            case _:
                return self._happen(doing, now)
        return []

    def _speak(self, text: str, script: Script, now: int) -> None:
        """Begin to say something; what is recorded is over after a silence, or cut off."""
        self.robot.speech_begins(now)
        script.began, script.speaking, script.told = now, text, {}
        bounds = self.robot.ear.recording()
        said = self._timeline(text.rstrip(KEYS_THAT_END) if bounds is not None else text)
        script.lasts, silence = said.total, 0
        if bounds is not None:
            longest, silence = bounds.longest, bounds.silence
            script.told = {"duration": script.lasts}
            if 0 < longest < script.lasts:
                script.speaking, script.lasts, silence = _part(said, longest), longest, 0
                script.told = {"duration": longest, "maxtime": True}
            elif text.endswith(tuple(KEYS_THAT_END)):
                silence = 0
        elif not KEYS.issuperset(text):
            longest = self.robot.conductor.longest_answer()
            if 0 < longest < script.lasts:
                script.lasts, script.told = longest, {"toolong": True}
        script.time = now + script.lasts + silence

    def _timeline(self, text: str) -> voice.Timeline:
        return voice.timeline(text, voice.language(text), self.robot.profile.voices, ())

    def _hang_up(self, now: int) -> Inbound:
        """Hang up, and say nothing more; what is being recorded is told as far as it goes."""
        data: dict[str, Json] = {}
        for script in sorted([*self._playing, *self._scripts], key=lambda one: one.serial):
            spoken = min(now - script.began, script.lasts)
            if script.speaking and "duration" in script.told and spoken:
                said = _part(self._timeline(script.speaking), spoken)
                data = {"recorded": said, "duration": spoken}
            if script.speaking:
                script.speaking, script.time = "", now
                self.robot.ear.speech_ends()
        return Occurred("connection.disconnect.hangup", "user", data)

    def _happen(self, doing: Doing, now: int) -> list[Inbound]:
        """What is none of the user's doing."""
        values = doing.values
        match doing.name:
            case "message":
                data = {"from": values["from"] or "", "text": doing.text}
                return [Occurred("message", "environment", data, values["to"])]
            case "event":
                return [Occurred(values["name"], "environment", values["data"])]
            case "sensor":
                self.sensors[values["name"]] = sensor_value(values["value"])
            case "fail":
                device, hangs = values["device"], bool(values["hangs"])
                how = "hangs" if hangs else "fails"
                note = Narrated("environment", f"the {device} {how}")
                return [note, *self.robot.broke(now, device, hangs)]
            case "repair":
                self.robot.body.broken.pop(values["device"], None)
                return [Narrated("environment", f"the {values['device']} works again")]
            case "emergency":
                return [Emergency(True)]
            case "release":
                return [Emergency(False, bool(values["resume"]))]
            case "unload":
                return [Unloaded(values["application"])]
            case "load":
                return [Loaded(values["application"])]
        return []

    def _walk(self, doing: Doing, script: Script, now: int) -> list[Inbound]:
        values = doing.values
        goal = self.world.map.point(values["to"]) if values["to"] else (values["x"], values["y"])
        self._following = None
        if self.world.person is None or goal is None:
            return []
        self.world.walk(goal, self._speed)
        script.time = now + round(distance(self.world.person, goal) / self._speed * 1000) + 1
        whither = f"to the {values['to']}" if values["to"] else f"to {goal[0]:g}, {goal[1]:g}"
        return [Narrated("user", f"walks {whither}")]

    def _follow(self, keep: float) -> None:
        """Stay behind the robot while it moves."""
        world, person = self.world, self.world.person
        if person is None:
            return
        here = world.position
        if distance(here, person) > keep + 0.2:
            share = keep / distance(here, person)
            goal = (
                here[0] + (person[0] - here[0]) * share,
                here[1] + (person[1] - here[1]) * share,
            )
            world.walk(goal, self._speed)


def _part(said: voice.Timeline, ms: int) -> str:
    """What has been said after a time: whole words, unless not even one is over."""
    return said.heard(ms) or said.text[: max(sum(1 for end in said.ends if end <= ms), 1)]
