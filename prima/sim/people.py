"""The scripted users of a scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from heapq import heapify, heappop, heappush
from math import dist

from prima.devices import voice
from prima.messages import Heard, Inbound, Json, Narrated, Occurred, Record
from prima.sim.happenings import Doing, When
from prima.sim.incidents import happen
from prima.sim.robot import Robot
from prima.sim.scenario import Scenario
from prima.sim.triggers import PHASES, fires
from prima.sim.world import World
from prima.transcript.record import Entry

KEYS = frozenset("0123456789*# ")
"""The keys of a telephone."""
KEYS_THAT_END = "#*"
"""Keys pressed to end a recording: there is no silence to wait for."""

OVER = ("end", "cancel", "fail")
"""The kinds of records that end a behaviour."""


@dataclass(slots=True, order=True)
class TriggeredScript:
    """The rest of a trigger's sequence, and when it continues (ms)."""

    time: int
    triggered: bool
    """Whether it was triggered by the robot; planned sequences come first."""
    serial: int
    left: list[Doing] = field(compare=False)
    who: str = field(default="", compare=False)
    """The person who does it."""
    number: int = field(default=1, compare=False)
    """How many times this has been done, from 1: its random values depend on that."""
    speaking: str = field(default="", compare=False)
    began: int = field(default=0, compare=False)
    """When they began to speak."""
    lasts: int = field(default=0, compare=False)
    """How long (ms) they speak."""
    report: dict[str, Json] = field(default_factory=dict, compare=False)
    """The report if it is recorded."""


class People:
    """Plays the users: observes the robot, and follows the scenario."""

    def __init__(self, scenario: Scenario, world: World, robot: Robot) -> None:
        self.world = world
        self.robot = robot
        self.sensors: dict[str, Json] = {}
        self.first = scenario.persons[0].name
        """The person who acts where no person is named."""
        self._several = len(scenario.persons) > 1
        self._seed = scenario.seed
        self._speeds = {one.name: one.speed.drawn(self._seed) for one in scenario.persons}
        self._awaited: dict[str, list[tuple[int, When]]] = {}
        """Triggers by the phase of the records that they wait for, with their numbers."""
        self._fired: dict[int, int] = {}
        self._seen: dict[int, int] = {}
        self._scripts: list[TriggeredScript] = []
        """Actions to come, as a heap: the next one is first."""
        self._playing: list[TriggeredScript] = []
        """Actions of this instant, which are not in the heap meanwhile."""
        self._serial = 0
        self._texts: dict[str, str] = {}
        """The texts of the behaviours that are under way."""
        self._following: dict[str, float] = {}
        """The people who follow the robot, and at which distance (m)."""
        for index, when in enumerate(scenario.whens):
            if when.trigger == "at" and when.chance.happens(self._seed, 1):
                time = when.what.ms(self._seed) + when.after.ms(self._seed)
                self._begin(when.doings, time, False, when.person)
            for phase in PHASES.get(when.trigger, ()):
                self._awaited.setdefault(phase, []).append((index, when))

    def _begin(
        self, doings: list[Doing], time: int, triggered: bool, who: str = "", number: int = 1
    ) -> TriggeredScript:
        self._serial += 1
        who = who or self.first
        script = TriggeredScript(time, triggered, self._serial, list(doings), who, number)
        heappush(self._scripts, script)
        return script

    def play(self, time: int, doings: list[Doing]) -> Callable[[], bool]:
        """Let the first person do something at a future time (ms), as a ``when`` would.

        Returns:
            a function that says whether all of it has been done.
        """
        script = self._begin(doings, time, False)
        return lambda: not any(one is script for one in self._scripts)

    @property
    def there(self) -> bool:
        """Whether the first person is present."""
        return self.world.people[self.first].at is not None

    @property
    def will_load(self) -> bool:
        """Whether an application is yet to be loaded again."""
        return any(doing.name == "load" for one in self._scripts for doing in one.left)

    # Observing --------------------------------------------------------------------

    def observe(self, now: int, records: list[Record]) -> None:
        """Observe what has happened, and react to it after a delay."""
        for record in records:
            phase, name = record["phase"], str(record.get("behavior")).partition(".")[0]
            if phase == "start" and record.get("text"):
                self._texts[name] = record["text"]
            if awaited := self._awaited.get(phase):
                self._check(awaited, Entry(record), self._texts.get(name, ""), now)
            if phase in OVER and record.get("outcome") != "again":
                self._texts.pop(name, None)

    def _check(self, awaited: list[tuple[int, When]], entry: Entry, said: str, now: int) -> None:
        """Begin what is triggered by a record."""
        for index, when in awaited:
            if fires(when.trigger, when.what, entry, said):
                self._trigger(index, when, now)

    def _trigger(self, index: int, when: When, now: int) -> None:
        seen = self._seen[index] = self._seen.get(index, 0) + 1
        fired = self._fired.get(index, 0) + 1
        if seen < when.count or fired > when.times:
            return
        if when.chance.happens(self._seed, seen):
            self._fired[index] = fired
            after = max(when.after.ms(self._seed, fired), 1)
            self._begin(when.doings, now + after, True, when.person, fired)

    # Doing ------------------------------------------------------------------------

    def due(self) -> int | None:
        """When there is next something to do, if ever."""
        return self._scripts[0].time if self._scripts else None

    def collect(self, now: int) -> list[Inbound]:
        """Everything that the scenario's script does at ``now``."""
        made: list[Inbound] = []
        while self._scripts and self._scripts[0].time <= now:
            self._playing.append(heappop(self._scripts))
        for script in self._playing:
            made += self._go_on(script, now)
        for script in self._playing:
            if script.left or script.speaking:
                heappush(self._scripts, script)
        self._playing.clear()
        return made

    def follow(self) -> None:
        """Let those who follow the robot go after it."""
        for who, keep in self._following.items():
            self._follow(who, keep)

    def _go_on(self, script: TriggeredScript, now: int) -> list[Inbound]:
        made: list[Inbound] = []
        while script.time <= now:
            if script.speaking:
                made += self._said(script, now)
            if not script.left:
                break
            doing = script.left.pop(0)
            made += self._do(doing, script, now)
        return made

    def _said(self, script: TriggeredScript, now: int) -> list[Inbound]:
        """What a user has said, as the recogniser reports it; a broken one hears nothing."""
        text, script.speaking = script.speaking, ""
        report = {**self.robot.conductor.marks_passed(script.began), **script.report}
        self.robot.ear.speech_ends()
        if self.robot.deaf:
            self.robot.ear.listen_on(now)
            return self._does(script.who, f'says "{text}", which the robot does not hear')
        return [Heard(text, report | self._by(script.who), now - script.began)]

    def _by(self, who: str) -> dict[str, Json]:
        """Who has spoken or touched, if that is not clear."""
        return {"person": who} if self._several else {}

    def _does(self, who: str, what: str) -> list[Inbound]:
        """A user's action, as a note for the reader."""
        return [Narrated("user", f"{who} {what}" if self._several else what)]

    def _do(self, doing: Doing, script: TriggeredScript, now: int) -> list[Inbound]:
        values, who = doing.values, script.who
        match doing.name:
            case "one-of":
                chosen = values["choice"].of(values["several"], self._seed, script.number)
                script.left.insert(0, chosen)
            case "say" if not doing.text:
                return []
            case "say":
                self.world.attend(who)
                self._speak(doing.text, script, now)
                script.report = {**values.get("report", {}), **script.report}
            case "hang-up":
                return [self._hang_up(now)]
            case "touch":
                self.world.attend(who)
                sensor = values["sensor"]
                data = {"sensor": sensor, **self._by(who)}
                return [Occurred(f"touch.{sensor}", "user", data)]
            case "wait":
                script.time = now + values["for"].ms(self._seed, script.number)
            case "look":
                return self._does(who, f"looks at the {values['at']}")
            case "walk" | "follow" | "stay" | "leave":
                return self._go(doing, script, now)
            case _:
                return happen(doing, self.robot, self.sensors, now)
        return []

    def _speak(self, text: str, script: TriggeredScript, now: int) -> None:
        """Begin to say something; a recording ends after a silence, or is cut off."""
        self.robot.speech_begins(now)
        script.began, script.speaking, script.report = now, text, {}
        bounds = self.robot.ear.recording()
        said = self._timeline(text.rstrip(KEYS_THAT_END) if bounds is not None else text)
        script.lasts, silence = said.total, 0
        if bounds is not None:
            longest, silence = bounds.longest, bounds.silence
            script.report = {"duration": script.lasts}
            if 0 < longest < script.lasts:
                script.speaking, script.lasts, silence = _part(said, longest), longest, 0
                script.report = {"duration": longest, "maxtime": True}
            elif text.endswith(tuple(KEYS_THAT_END)):
                silence = 0
        elif not KEYS.issuperset(text):
            longest = self.robot.conductor.longest_answer()
            if 0 < longest < script.lasts:
                script.lasts, script.report = longest, {"toolong": True}
        script.time = now + script.lasts + silence

    @staticmethod
    def _timeline(text: str) -> voice.SpeechTimeline:
        """How a user says a text: at the usual rates, whatever the robot's own are."""
        return voice.timeline(text, voice.language(text), {}, ())

    def _hang_up(self, now: int) -> Inbound:
        """Hang up, and say nothing more; a recording in progress is reported as far as it got."""
        data: dict[str, Json] = {}
        speaking = [one for one in (*self._playing, *self._scripts) if one.speaking]
        for script in sorted(speaking, key=lambda one: one.serial):
            spoken = min(now - script.began, script.lasts)
            if "duration" in script.report and spoken:
                said = _part(self._timeline(script.speaking), spoken)
                data = {"recorded": said, "duration": spoken}
            script.speaking, script.time = "", now
            self.robot.ear.speech_ends()
        if speaking:
            heapify(self._scripts)
        return Occurred("connection.disconnect.hangup", "user", data)

    def _go(self, doing: Doing, script: TriggeredScript, now: int) -> list[Inbound]:
        """Walk somewhere, follow the robot, stop, or go away; nothing if they have gone."""
        who = script.who
        self._following.pop(who, None)
        if self.world.people[who].at is None:
            return []
        match doing.name:
            case "walk":
                return self._walk(doing, script, now)
            case "follow":
                self._following[who] = doing.values["distance"] or 1.2
                return self._does(who, "goes along with the robot")
            case "leave":
                self.world.leave(who)
                return self._does(who, "goes away")
        self.world.walk(who, None, self._speeds[who])
        return []

    def _walk(self, doing: Doing, script: TriggeredScript, now: int) -> list[Inbound]:
        values, who, speed = doing.values, script.who, self._speeds[script.who]
        goal = self.world.map.point(values["to"]) if values["to"] else (values["x"], values["y"])
        at = self.world.people[who].at
        if at is None or goal is None:
            return []
        self.world.walk(who, goal, speed)
        script.time = now + round(dist(at, goal) / speed * 1000) + 1
        whither = f"to the {values['to']}" if values["to"] else f"to {goal[0]:g}, {goal[1]:g}"
        return self._does(who, f"walks {whither}")

    def _follow(self, who: str, keep: float) -> None:
        """Stay behind the robot while it moves."""
        world, person = self.world, self.world.people[who].at
        if person is None:
            return
        here = world.position
        gap = dist(here, person)
        if gap > keep + 0.2:
            share = keep / gap
            goal = (
                here[0] + (person[0] - here[0]) * share,
                here[1] + (person[1] - here[1]) * share,
            )
            world.walk(who, goal, self._speeds[who])


def _part(said: voice.SpeechTimeline, ms: int) -> str:
    """The words said after a time: whole ones, unless not even one is finished."""
    return said.heard(ms) or said.text[: max(sum(1 for end in said.ends if end <= ms), 1)]
