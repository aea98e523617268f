"""The world of generated runs: the robot's Commands, devices and the user, drawn from a seed.

What a device does is drawn from the seed and the AB's name alone, so that
shrinking one part of a run does not change the others.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from random import Random

from hypothesis import strategies as st

from prima.language.commands import TABLE_4_2, CommandType
from prima.messages import (
    Command,
    Ended,
    Failed,
    Halted,
    Heard,
    Inbound,
    Listening,
    Occurred,
    Order,
    Record,
)
from prima.scheduler.policy import EXTENSIONS
from prima.transcript.lines import line

STEPS = 600
"""Instants that a run may have; more is a run cut off, not a fault as such."""


APPS = ("fa", "ea", "xa")


def _own(name: str, *devices: str) -> CommandType:
    """A motion that the robot's maker has added: it is faithful to its own path (X5)."""
    return CommandType(name, name.title(), "", frozenset(devices), motion="faithful")


DANCES = ("dance", "spin", "waltz")
TABLE: Mapping[str, CommandType] = {
    **TABLE_4_2,
    "dance": _own("dance", "locomotion", "neck", "arm"),
    "spin": _own("spin", "locomotion"),
    "waltz": _own("waltz", "locomotion", "localization"),
}
"""The robot's Commands: Table 4.2 and what its maker has added."""


def without_arm() -> Mapping[str, CommandType]:
    """The Commands of a robot that has a laser where others have an arm (X6)."""
    hand = TABLE["point-by-hand"]
    laser = replace(hand, name="point-by-laser", title="Laser", devices=frozenset({"laser"}))
    lacking = replace(hand, substitute=laser.name)
    return {**TABLE, laser.name: laser, hand.name: lacking}


LACKING = without_arm()
baselines = st.sampled_from(("fifo", "fair", "fixed", "fixed:ea", "none"))
extended: st.SearchStrategy[str] = st.one_of(
    st.sets(st.sampled_from(EXTENSIONS), min_size=1).map(
        lambda names: "+".join(("prima", *sorted(names)))
    ),
    st.just("prima+all"),
)
"""``prima`` with some of the extensions."""


@dataclass(frozen=True)
class World:
    """How devices and the user behave."""

    seed: int = 0
    fails: int = 0
    """Of a hundred ABs, how many fail."""
    silent: int = 0
    """Of a hundred questions, how many nobody answers, or not so that they understand."""
    endless: bool = False
    """Whether a tracking never reaches its goal."""
    lacks: bool = False
    """Whether the robot has a laser instead of an arm (X6)."""

    @property
    def table(self) -> Mapping[str, CommandType]:
        """What the robot can do."""
        return LACKING if self.lacks else TABLE


class Devices:
    """A robot made up: it ends what it is told to start, sooner or later."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.agenda: list[tuple[int, int, Inbound, int]] = []
        self.tasks: dict[str, int] = {}
        """What the robot does, and which of its tasks that is: an AB may start again."""
        self.starts: list[str] = []
        self._serial = count()

    def plan(self, time: int, value: Inbound, task: int = -1) -> None:
        heapq.heappush(self.agenda, (time, next(self._serial), value, task))

    def due(self) -> int | None:
        return self.agenda[0][0] if self.agenda else None

    def collect(self, now: int) -> list[Inbound]:
        """What happens now; what an aborted AB would have reported does not."""
        found: list[Inbound] = []
        while self.agenda and self.agenda[0][0] <= now:
            _, _, value, task = heapq.heappop(self.agenda)
            if isinstance(value, Ended | Failed | Listening):
                if self.tasks.get(value.behavior) != task:
                    continue
                if not isinstance(value, Listening):
                    del self.tasks[value.behavior]
            found.append(value)
        return found

    def order(self, now: int, order: Order) -> None:
        match order.verb:
            case "abort":
                self.tasks.pop(order.behavior, None)
            case "interrupt":
                self._halt(now, order.behavior)
            case "start":
                self.starts.append(order.behavior)
                self.tasks[order.behavior] = len(self.starts)
                self._begin(now, order)
            case "send":
                dice = Random(f"{self.world.seed} {order.behavior}")
                name = f"reply.{order.data['to']}"
                self.plan(now + dice.randint(1, 2000), Occurred(name, app=order.app))

    def _halt(self, now: int, name: str) -> None:
        """X2: tell how much was done, at once or when it may have started again."""
        assert name in self.tasks, f"{name} is interrupted and does not run"
        del self.tasks[name]
        dice = Random(f"{self.world.seed} halt {name}")
        done = dice.randint(0, 4) / 4
        self.plan(now + dice.choice((1, 1, 40, 900)), Halted(name, {"done": done, "heard": "He"}))

    def _begin(self, now: int, order: Order) -> None:
        command = order.command
        assert command is not None
        world, name, task = self.world, order.behavior, self.tasks[order.behavior]
        row = world.table[command.type]
        dice = Random(f"{world.seed} {name}")
        lasts = dice.randint(1, 600 if row.feedback else 3000)
        data = self._pose(name, command) if "locomotion" in order.devices else {}
        if dice.randrange(100) < world.fails and order.devices:
            device = dice.choice(sorted(order.devices))
            self.plan(now + lasts, Failed(name, device, "it fails"), task)
        elif command.type == "q-and-a":
            self._ask(now, now + lasts, name, dice)
        elif row.feedback:
            # The goal depends on the Command, not on the loop, so that it is reached for certain.
            loops = Random(f"{world.seed} {name.partition('.')[0]}").randint(1, 6)
            endless = world.endless and command.type == "tracking-human"
            self.plan(now + lasts, Ended(name, order.loop >= loops and not endless, data), task)
        else:
            self.plan(now + lasts, Ended(name, True, data), task)

    def _pose(self, name: str, command: Command) -> dict[str, float]:
        """Where the robot stands afterwards: where it was told to go, or anywhere (X1)."""
        dice = Random(f"{self.world.seed} pose {name}")
        anywhere = {"x": dice.choice((0.0, 3.0)), "y": 0.0, "heading": dice.choice((0.0, 90.0))}
        return {key: float(command.args.get(key, value)) for key, value in anywhere.items()}

    def _ask(self, now: int, said: int, name: str, dice: Random) -> None:
        later, task = said + dice.randint(1, 3000), self.tasks[name]
        self.plan(said, Listening(name), task)
        if dice.randrange(100) >= self.world.silent:
            self.plan(later, Heard(dice.choice(("yes", "no"))))
        elif dice.random() < 0.5:
            self.plan(later, Heard("mumble"))
        self.plan(later + 1, Ended(name, True, {"outcome": "noinput"}), task)
        if dice.randrange(200) < self.world.silent:
            self.plan(later + dice.randint(2, 2500), Heard(dice.choice(("yes", "no", "mumble"))))


@dataclass
class Run:
    """What came of a play or a script."""

    records: list[Record]
    complete: bool
    """Whether the run came to rest before it was cut off."""
    problems: list[str] = field(default_factory=list)
    """What the driver itself saw that may not be."""
    calling: frozenset[str] = frozenset()
    """The applications whose states may go on while another makes requests."""

    def lines(self) -> str:
        """The transcript, as it would be written."""
        return "".join(line(record) for record in self.records)


lasting = st.one_of(st.integers(1, 3000), st.just(25_000))
"""How long (ms) an emergency lasts: at times so long that nobody engages the user any more (K1)."""


def left_undone(now: int, due: int | None) -> list[str]:
    """What is due at an instant is done at it: else the next one is the same."""
    return (
        [f"at {now} ms it leaves undone what was due at {due}"]
        if due is not None and due <= now
        else []
    )


def orders_match(records: Iterable[Record], starts: list[str]) -> list[str]:
    """Invariant 3 where it matters: devices are told once what the transcript tells."""
    told = [r["behavior"] for r in records if r["phase"] == "start" and r["command"] != "iu"]
    return [] if told == starts else [f"invariant 3: devices started {starts}, not {told}"]
