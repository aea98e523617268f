"""Random applications and the world they meet: plays of documents, scripts for the mediator.

Two ways in. A :class:`Play` is two or three real documents, run by a
:class:`~prima.session.Session` with devices made up here. A :class:`Script` is
what two or three requesters ask of a :class:`~prima.scheduler.mediator.Mediator`
directly. Both are plain values, so that a failing one is printed whole and can
be run again; what devices do is drawn from the play's seed and the AB's name
alone, so that shrinking one part of a play does not change the others.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from random import Random
from typing import Any

from hypothesis import strategies as st

from prima.interpreter.application import Interpreter
from prima.interpreter.reader import read_document
from prima.language.commands import PATIENCE_MS, TABLE_4_2, CommandType
from prima.messages import (
    CloseUnit,
    Command,
    Emergency,
    Ended,
    Failed,
    Group,
    Halted,
    Heard,
    Inbound,
    LeaveState,
    Listening,
    Loaded,
    Notice,
    Occurred,
    OpenUnit,
    Order,
    Record,
    Request,
    Step,
    Unloaded,
)
from prima.scheduler.mediator import Mediator
from prima.scheduler.policy import EXTENSIONS, policy_named
from prima.scheduler.recorder import Recorder
from prima.session import Session
from prima.transcript.lines import line

STEPS = 600
"""Instants that a run may have; more is a run cut off, which is no fault as such."""
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

# The world --------------------------------------------------------------------


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
        if dice.randrange(100) < world.fails:
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


@dataclass
class Run:
    """What came of a play or a script."""

    records: list[Record]
    complete: bool
    """Whether the run came to rest before it was cut off."""
    problems: list[str] = field(default_factory=list)
    """What the driver itself saw that may not be."""

    def lines(self) -> str:
        """The transcript, as it would be written."""
        return "".join(line(record) for record in self.records)


def _orders_match(records: Iterable[Record], starts: list[str]) -> list[str]:
    """Invariant 3 where it matters: devices are told once what the transcript tells."""
    told = [r["behavior"] for r in records if r["phase"] == "start" and r["command"] != "iu"]
    return [] if told == starts else [f"invariant 3: devices started {starts}, not {told}"]


# Plays: documents through a session ------------------------------------------------


@dataclass(frozen=True)
class Play:
    """Documents, when they are loaded, what happens around them, and how devices behave."""

    documents: tuple[str, ...]
    loads: tuple[int, ...]
    events: tuple[tuple[int, Inbound], ...]
    world: World


def perform(
    play: Play, policy: str = "prima", bound: int | None = None, patience: int = PATIENCE_MS
) -> Run:
    """Run a play to its end, or cut it off."""
    documents = []
    for number, text in enumerate(play.documents):
        document, problems = read_document(f"{APPS[number]}.xml", text.encode())
        errors = [str(problem) for problem in problems if problem.severity == "error"]
        assert not errors, (errors, text)
        documents.append(document)
    chosen = policy_named(policy)
    session = Session(documents, chosen, play.world.table, bound, patience=patience)
    devices = Devices(play.world)
    for document, start in zip(documents, play.loads, strict=True):
        devices.plan(start, Loaded(document.id))
    for time, value in play.events:
        devices.plan(time, value)
    records: list[Record] = []
    now = steps = 0
    while steps < STEPS:
        times = [time for time in (devices.due(), session.deadline()) if time is not None]
        if not times:
            break
        steps, now = steps + 1, max(now, min(times))
        for order in session.step(now, devices.collect(now)):
            devices.order(now, order)
        records += session.drain()
    run = Run(records, steps < STEPS, _orders_match(records, devices.starts))
    run.problems += [f"a defect: {error!r}" for error in session.defects]
    if run.complete:
        run.problems += _stuck(session)
    return run


def _stuck(session: Session) -> list[str]:
    """Invariant 9: with nothing left to happen, who waits for something of the mediator's?"""
    if session.mediator.halted:
        return []
    found = []
    memory = session.mediator.memory
    for ab in memory.behaviors.values():
        found.append(f"invariant 9: {ab.id} is {ab.state} for ever")
    for stream in memory.streams.values():
        found.append(f"invariant 9: {stream.name} stays open for ever")
    for app in session.apps.values():
        # Private, but nothing else tells an application that waits for a Command
        # which is gone from one that waits for an event.
        waiting = sorted(app._waiting) if isinstance(app, Interpreter) else []
        if waiting and not app.over and not memory.behaviors:
            found.append(f"invariant 9: {app.name} waits for {waiting}, which nobody will end")
    return found


SAYING = ("face-human-and-speak", "turn-and-speak", "speak", "speak")
PLAIN = (
    "<speak>Hello.</speak>",
    "<speak>Well.</speak>",
    "<face-human/>",
    "<face-human-and-speak>You.</face-human-and-speak>",
    '<turn-and-speak angle="90">There.</turn-and-speak>',
    '<set-direction heading="10"/>',
    '<turn angle="30"/>',
    '<set-speed-and-time speed="0.1" time="1s"/>',
    '<move-head pan="10"/>',
    '<point-by-hand angle="20"/>',
    '<gesture name="nod"/>',
)
MORE = (*PLAIN, *(f'<command type="{name}"/>' for name in DANCES))
"""What may be asked for outside units too."""
NESTED = '<iu><speak>In.</speak><turn angle="1"/></iu>'
NOW = (
    "<stop-moving/>",
    '<speak order="now">Wait.</speak>',
    '<turn angle="5" order="now"/>',
    '<topological-move to="room" order="now"/>',
)
LOOPS = (
    '<topological-move to="room"/>',
    '<set-position x="1" y="2"/>',
    '<set-position-and-direction x="1" y="2" heading="3"/>',
    "<active-sensing-human>Where are you?</active-sensing-human>",
    "<active-sensing-human/>",
    "<tracking-human/>",
)
HOOKED = '<speak>Hooked.<on event="cancel"><log>cut</log></on><on event="end">{}</on></speak>'
THROWN = "thrown.here"
TURNS = ("suspended", "resumed")
EVENTS = ("touch", "touch.head", "message", "corner", "human.found", "human.lost")


HINTS = re.compile(r' (stream|hold-for|channel|restartable)="[^"]*"')


def without_hints(play: Play) -> Play:
    """The same play, but its applications tell the mediator nothing of what they would like."""
    blank = tuple(HINTS.sub(lambda hint: " " * len(hint[0]), text) for text in play.documents)
    return replace(play, documents=blank)


class Author:
    """Writes one document. Every choice is drawn, so that it shrinks."""

    def __init__(self, draw: Any, name: str, lively: bool) -> None:
        self.draw = draw
        self.name = name
        self.lively = lively
        """Whether the application may stop on its own account: by errors, exits, timeouts."""
        self.fields = count(1)

    def some(self, low: int, high: int) -> int:
        return int(self.draw(st.integers(low, high)))

    def one(self, choices: Iterable[str]) -> str:
        return str(self.draw(st.sampled_from(tuple(choices))))

    def chance(self, of: int) -> bool:
        """True once in ``of`` times; False is the simpler choice."""
        return bool(self.some(1, of) == of)

    def document(self) -> str:
        self.forms = [f"f{number}" for number in range(1, self.some(1, 3) + 1)]
        parts = []
        if self.chance(3):
            parts.append(self.handler(0, self.one(EVENTS)))
        if self.chance(3):
            # It may be thrown again wherever it leads: so it leads nowhere.
            parts.append(f"<error>{self.content(len(self.forms), simple=True)}</error>")
        if self.chance(5):
            target = self.one(self.forms)
            parts.append(f'<link next="#{target}"><grammar><item>mumble</item></grammar></link>')
        parts += [self.form(index) for index in range(len(self.forms))]
        kind = "fa" if self.name == "fa" else "ea"
        head = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{self.name}">'
        return head + "".join(parts) + "</prima>"

    def form(self, index: int) -> str:
        items = "".join(self.item(index) for _ in range(self.some(0, 2)))
        handlers = "".join(
            self.handler(index, self.one((*EVENTS, *TURNS, "own", "end", "cancel", "error")))
            for _ in range(self.some(0, 2))
        )
        hints = self.hold(4) + self.connect(4)
        watch = self.watch(index) if self.chance(8) else ""
        return f'<form id="{self.forms[index]}"{hints}>{watch}{items}{handlers}</form>'

    def watch(self, index: int) -> str:
        """A condition that is true on entry; what it raises may leave the state at once."""
        ahead = self.forms[index + 1 :]
        leaving = [f'<goto next="#{form}"/>' for form in ahead]
        if not self.lively:
            leaving.append("<exit/>")
        content = self.command(False) if self.chance(2) else ""
        content += self.one(leaving) if leaving and self.chance(2) else ""
        return f'<watch name="w" when="true"/><on event="w">{content}</on>'

    def hold(self, of: int) -> str:
        """X3: now and then the hint that the stream be kept open."""
        return f' stream="hold" hold-for="{self.some(1, 6000)}ms"' if self.chance(of) else ""

    def connect(self, of: int) -> str:
        """X4: now and then the hint that the robot turn to the user first."""
        return ' channel="connect"' if self.chance(of) else ""

    def restart(self, text: str) -> str:
        """X2: now and then the hint that a Command or unit may be interrupted."""
        if not self.chance(3):
            return text
        return re.sub(r"^<[\w-]+", r'\g<0> restartable="true"', text)

    def item(self, index: int) -> str:
        kind = self.some(0, 7)
        if kind == 6:
            # A unit behind speech: it is linked until that has ended.
            return f"<block><speak>First.</speak></block>{self.unit(index)}"
        if kind == 7:
            # What is wanted now, behind speech of one's own.
            said = "".join(f"<speak>{word}.</speak>" for word in ("One", "Two")[: self.some(1, 2)])
            return f"<block>{said}{self.one(NOW)}{self.command(False)}</block>"
        if kind < 3:
            return f"<block{self.hold(6)}>{self.content(index, sends=True)}</block>"
        if kind < 5:
            return self.question(index)
        return self.unit(index)

    def question(self, index: int, unit: bool = False) -> str:
        parts = ["<prompt>Well?</prompt>"]
        if self.chance(3):
            parts.append(f"<noinput>{self.content(index, unit=unit, simple=True)}</noinput>")
        if self.chance(3):
            parts.append(f"<nomatch>{self.content(index, unit=unit, simple=True)}</nomatch>")
        if self.chance(2):
            parts.append(f"<filled>{self.content(index, unit=unit)}</filled>")
        if self.chance(4):
            parts.append(self.handler(index, self.one(EVENTS), unit))
        if self.chance(8):
            parts.append(self.leaving(index))
        hints = self.hold(6) + self.connect(6)
        name = f'name="q{next(self.fields)}" type="boolean"'
        return f"<field {name}{hints}>{''.join(parts)}</field>"

    def leaving(self, index: int) -> str:
        """A handler that leaves the state while a question may be asked."""
        leave = f'<goto next="#{self.one(self.forms)}"/>'
        if self.chance(4) and not self.lively:
            leave = "<exit/>"
        said = "<speak>Bye.</speak>" if self.chance(3) else ""
        return f'<on event="{self.one(EVENTS)}">{said}{leave}</on>'

    def unit(self, index: int) -> str:
        parts = []
        for _ in range(self.some(1, 2)):
            if self.chance(2):
                parts.append(self.question(index, unit=True))
            else:
                parts.append(f"<block>{self.content(index, unit=True)}</block>")
        if self.chance(4):
            parts.append(self.handler(index, self.one(EVENTS), True))
        if self.chance(6):
            # A handler inside that is reached by throw alone.
            thrown = f'<throw event="{THROWN}"/>'
            parts.append(f"<block>{thrown}</block>")
            parts.append(f'<on event="{THROWN}">{self.content(index, unit=True)}</on>')
        longest = f' longest="{self.some(1, 6000)}ms"' if self.chance(3) else ""
        return f"<iu{longest}>{''.join(parts)}</iu>"

    def handler(self, index: int, event: str, unit: bool = False) -> str:
        reactive = self.one(("", "", ' reactive="true"', ' reactive="false"'))
        # Ends and errors may come for ever, so what is done about them asks for nothing;
        # the application's own event is sent by what comes from outside or once, and leads ahead;
        # so does what its stream comes to.
        simple = event in ("end", "cancel", "error")
        external = not simple and event not in ("own", *TURNS)
        content = self.content(index, unit=unit, simple=simple, external=external, sends=external)
        return f'<on event="{event}"{reactive}>{content}</on>'

    def content(
        self,
        index: int,
        unit: bool = False,
        simple: bool = False,
        external: bool = False,
        sends: bool = False,
    ) -> str:
        """Content; ``simple`` asks for nothing, ``external`` may go anywhere in the document.

        Only where it ``sends`` does it send itself an event.
        """
        parts = []
        for _ in range(self.some(0, 3)):
            kind = self.some(0, 9)
            if simple or kind == 9:
                parts.append(self.effortless(sends))
            elif kind < 5:
                parts.append(self.command(unit))
            elif kind == 5:
                parts.append(f"<par>{self.branch(unit)}{self.branch(unit)}</par>")
            elif kind == 6:
                parts.append(self.group())
            elif kind == 7:
                parts.append(self.one(NOW[:3] if unit else NOW))
            else:
                parts.append(f'<if cond="true">{self.command(unit)}</if>')
        if self.chance(3):
            ahead = self.forms if external else self.forms[index + 1 :]
            if ahead:
                parts.append(f'<goto next="#{self.one(ahead)}"/>')
            elif self.chance(3) and not self.lively:
                parts.append("<exit/>")
        return "".join(parts)

    def effortless(self, sends: bool = False) -> str:
        quiet = ("<log>so</log>", '<send to="server"/>', "<reprompt/>")
        return self.one((*quiet, '<send event="own" delay="700ms"/>') if sends else quiet)

    def command(self, unit: bool) -> str:
        if not unit and self.chance(3):
            return self.one(LOOPS)
        if self.chance(12):
            return self.restart(HOOKED.format(self.effortless()))
        return self.restart(self.one(MORE))

    def branch(self, unit: bool) -> str:
        if self.chance(3):
            return f"<seq>{self.command(unit)}{self.command(unit)}</seq>"
        return self.command(unit)

    def group(self) -> str:
        inside = [self.one(PLAIN) for _ in range(self.some(1, 3))]
        if self.chance(3):
            second = self.one((*PLAIN, NESTED, NESTED, NESTED))
            inside.append(f"<par>{self.one(PLAIN)}{second}</par>")
        longest = f' longest="{self.some(1, 3000)}ms"' if self.chance(4) else ""
        return self.restart(f"<iu{longest}>{''.join(inside)}</iu>")


def _when(event: tuple[int, Inbound]) -> int:
    return event[0]


@st.composite
def plays(draw: Any, lively: bool = False) -> Play:
    """Two or three applications; ``lively``: every user answers and every device ends."""
    names = APPS[: draw(st.sampled_from((2, 2, 2, 3)))]
    documents = tuple(Author(draw, name, lively).document() for name in names)
    loads = tuple(draw(st.sampled_from((0, 0, 1, 700))) for _ in names)
    events: list[tuple[int, Inbound]] = []
    for _ in range(draw(st.integers(0, 8))):
        time = draw(st.integers(1, 12_000))
        name = draw(st.sampled_from(EVENTS))
        events.append((time, Occurred(name, "user" if "touch" in name else "environment")))
    if not lively and draw(st.integers(1, 4)) == 4:
        time = draw(st.integers(1, 8000))
        events.append((time, Emergency(True)))
        events.append((time + draw(st.integers(1, 3000)), Emergency(False, draw(st.booleans()))))
    if not lively and draw(st.integers(1, 4)) == 4:
        events.append((draw(st.integers(1, 8000)), Unloaded(draw(st.sampled_from(names)))))
    events.sort(key=_when)
    if len(names) == 3 and draw(st.booleans()):
        # All three may react to one event.
        both = '<on event="touch"><speak>Yes.</speak><face-human/></on></prima>'
        documents = tuple(text.replace("</prima>", both) for text in documents)
        events = sorted(
            [*events, (draw(st.integers(1, 9000)), Occurred("touch", "user"))], key=_when
        )
    seed = draw(st.integers(0, 10_000))
    world = World(seed, lacks=draw(st.integers(1, 5)) == 5)
    if not lively:
        world = World(
            seed,
            draw(st.sampled_from((0, 0, 5, 20))),
            draw(st.sampled_from((0, 30, 60))),
            draw(st.booleans()),
            world.lacks,
        )
    return Play(documents, loads, tuple(events), world)


# Scripts: requests to a mediator ------------------------------------------------------


@dataclass(frozen=True)
class Ask:
    """Commands to ask for at once: their types, or groups of them, and whom each follows."""

    whats: tuple[str | tuple[str, ...], ...]
    after: tuple[tuple[int, ...], ...]
    now: bool = False
    hold: int | None = None
    connect: bool = False
    restartable: bool = False


@dataclass(frozen=True)
class Open:
    """Open a unit with these devices."""

    devices: frozenset[str]
    longest: int | None


@dataclass(frozen=True)
class Close:
    """Leave the unit, if one is open."""


@dataclass(frozen=True)
class Leave:
    """Leave the state."""


@dataclass(frozen=True)
class Go:
    """End the application."""


Deed = Ask | Open | Close | Leave | Go


@dataclass(frozen=True)
class Script:
    """What requesters do: in their windows one after another, and at events.

    ``events`` are a time and, for each application, what it does about it.
    """

    windows: tuple[tuple[tuple[Deed, ...], ...], ...]
    events: tuple[tuple[int, tuple[tuple[Deed, ...], ...]], ...]
    emergencies: tuple[tuple[int, int, bool], ...]
    world: World
    views: tuple[tuple[int, bool], ...] = ()
    """When the camera comes to see the user, or loses him (V4, X4)."""

    def deeds(self) -> list[Deed]:
        """All that anybody may do."""
        windows = [deeds for app in self.windows for deeds in app]
        events = [deeds for _, apps in self.events for deeds in apps]
        return [deed for deeds in (*windows, *events) for deed in deeds]


ARGUMENTS: dict[str, dict[str, Any]] = {
    "turn-and-speak": {"angle": 10.0},
    "set-direction": {"heading": 10.0},
    "turn": {"angle": 10.0},
    "set-speed-and-time": {"time": "1s"},
    "point-by-hand": {"angle": 10.0},
    "gesture": {"name": "nod"},
    "topological-move": {"to": "room"},
    "set-position": {"x": 1.0, "y": 2.0},
    "set-position-and-direction": {"x": 1.0, "y": 2.0, "heading": 3.0},
}
PIECES = tuple(name for name, row in TABLE_4_2.items() if not row.feedback and not row.leaves)
GROUPED = tuple(name for name in PIECES if name not in ("q-and-a", "stop-moving"))
ALL = (*TABLE_4_2, *DANCES)


def command(name: str, now: bool = False, restartable: bool = False) -> Command:
    """A Command of a type that is valid; only what is one piece is ever restartable."""
    row = TABLE[name]
    text = "Hello." if row.text == "required" else None
    restartable = restartable and not row.feedback and not row.now
    return Command(name, dict(ARGUMENTS.get(name, {})), text, now, restartable=restartable)


class Requester:
    """One application of a script: it keeps to what documents can ask for."""

    def __init__(self, name: str, windows: tuple[tuple[Deed, ...], ...]) -> None:
        self.name = name
        self.windows = list(windows)
        self.state = 1
        self.unit: int | None = None
        self.devices: frozenset[str] = frozenset()
        self.over = False
        self._asked = False
        """Whether the state has asked for something, so that the mediator knows of it (O3)."""
        self._numbers = count(1)

    def act(self, mediator: Mediator, deeds: Iterable[Deed], cause: int | None = None) -> None:
        for deed in deeds:
            if self.over:
                return
            match deed:
                case Ask():
                    steps = self._steps(deed)
                    if not steps:
                        continue
                    number = next(self._numbers)
                    asked = Request(
                        number, steps, self.state, cause, self.unit, deed.hold, deed.connect
                    )
                    mediator.request(self.name, asked)
                    self._asked, cause = True, None
                case Open() if self.unit is None:
                    self.unit, self.devices = next(self._numbers), deed.devices
                    mediator.open_unit(
                        self.name,
                        OpenUnit(self.unit, self.state, deed.devices, deed.longest, cause),
                    )
                    self._asked, cause = True, None
                case Close():
                    self._close(mediator)
                case Leave():
                    self._leave(mediator)
                    self.state += 1
                case Go():
                    self._leave(mediator)
                    mediator.unload(self.name, "exit")
                    self.over = True

    def _leave(self, mediator: Mediator) -> None:
        self._close(mediator)
        if self._asked:
            mediator.leave_state(self.name, LeaveState(self.state))
        self._asked = False

    def _close(self, mediator: Mediator) -> None:
        if self.unit is not None:
            mediator.close_unit(self.name, CloseUnit(self.unit))
            self.unit = None

    def _steps(self, asked: Ask) -> list[Step]:
        """The steps that may be asked for where the requester is: in its unit, or not."""
        steps: list[Step] = []
        for what, after in zip(asked.whats, asked.after, strict=True):
            if what == "stop-moving" and steps:
                what = "turn"  # what is wanted now begins a request
            names = (what,) if isinstance(what, str) else what
            if self.unit is not None and not all(
                name in PIECES and TABLE[name].occupied(command(name).text) <= self.devices
                for name in names
            ):
                return []
            if isinstance(what, str):
                now = asked.now and not steps
                steps.append(Step(command(what, now, asked.restartable), after))
            else:
                inner = [
                    Step(command(name), (index - 1,) if index % 2 else ())
                    for index, name in enumerate(what)
                ]
                steps.append(Step(Group(inner, 4000, restartable=asked.restartable), after))
        return steps

    def told(self, mediator: Mediator, notice: Notice) -> None:
        """A window: what the script says next."""
        if notice.what == "unit-timeout" and notice.run == self.unit:
            self.unit = None
        if notice.what != "ended" and self.windows:
            self.act(mediator, self.windows.pop(0))


def drive(script: Script, policy: str = "prima", patience: int = PATIENCE_MS) -> Run:
    """Run a script; it does what a session does, by rule V3."""
    recorder = Recorder()
    mediator = Mediator(policy_named(policy), script.world.table, recorder, patience=patience)
    apps = {
        name: Requester(name, windows) for name, windows in zip(APPS, script.windows, strict=False)
    }
    for name in apps:
        mediator.load(name, "fa" if name == "fa" else "ea")
    devices = Devices(script.world)
    events = dict(enumerate(script.events, 1))
    for serial, (time, _) in events.items():
        devices.plan(time, Occurred("event", data={"serial": serial}))
    for time, seen in script.views:
        devices.plan(time, Occurred("human.found" if seen else "human.lost"))
    for pressed, lasts, resume in script.emergencies:
        devices.plan(pressed, Emergency(True))
        devices.plan(pressed + lasts, Emergency(False, resume))
    records: list[Record] = []
    now = steps = 0

    def settle() -> None:
        while mediator.told:
            told = mediator.told.popleft()
            app = apps[told.app]
            if app.over:
                continue
            mediator.open_window(told)
            for notice in told.notices:
                app.told(mediator, notice)
            mediator.close_window(told)

    while steps < STEPS:
        times = [time for time in (devices.due(), mediator.deadline()) if time is not None]
        held = [app for app in apps.values() if app.unit is not None and not app.over]
        if not times and not held:
            break
        steps, now = steps + 1, max(now, min(times, default=now + 1))
        recorder.now = now
        if not times:
            held[0].act(mediator, [Close()])  # U5: a unit is concluded for certain
        values = devices.collect(now)
        for value in sorted(values, key=lambda one: isinstance(one, Occurred | Emergency)):
            match value:
                case Ended():
                    mediator.ended(value.behavior, value.goal, value.data)
                case Failed():
                    mediator.failed(value.behavior, value.device, value.reason)
                case Listening():
                    recorder.add("listening", "robot", behavior=value.behavior)
                    mediator.listening(value.behavior)
                case Heard():
                    question = mediator.question()
                    if question is not None and question.listening:
                        mediator.orders.append(Order("abort", question.id))
                        mediator.ended(question.id, True, {"outcome": "filled"}, inbound=False)
                case Halted():
                    mediator.interrupted(value.behavior, value.data)
                case Emergency():
                    mediator.emergency(value.pressed, value.resume, len(events) + steps)
                case Occurred(name="human.found" | "human.lost"):
                    recorder.add("event", "environment", event=value.name, inbound=True)
                    mediator.sees_user(value.name == "human.found")
                case Occurred():
                    serial = value.data["serial"]
                    recorder.add(
                        "event", "environment", event="message", serial=serial, inbound=True
                    )
                    for app, deeds in zip(apps.values(), events[serial][1], strict=False):
                        app.act(mediator, deeds, serial)
            settle()
        mediator.expire()
        settle()
        mediator.select()
        for order in mediator.drain_orders():
            devices.order(now, order)
        records += recorder.drain()
    run = Run(records, steps < STEPS, _orders_match(records, devices.starts))
    if run.complete and not mediator.halted:
        run.problems += [
            f"invariant 9: {ab.id} is {ab.state} for ever"
            for ab in mediator.memory.behaviors.values()
        ]
    return run


@st.composite
def _asks(draw: Any) -> Ask:
    whats: list[str | tuple[str, ...]] = []
    after: list[tuple[int, ...]] = []
    for index in range(draw(st.sampled_from((1, 1, 2, 3)))):
        if draw(st.integers(1, 6)) == 6:
            whats.append(tuple(draw(st.lists(st.sampled_from(GROUPED), min_size=1, max_size=3))))
        else:
            whats.append(draw(st.sampled_from(ALL)))
        parents = draw(st.sets(st.integers(0, index - 1), max_size=2)) if index else set()
        after.append(tuple(sorted(parents)))
    return Ask(
        tuple(whats),
        tuple(after),
        draw(st.integers(1, 6)) == 6,
        draw(st.integers(1, 6000)) if draw(st.integers(1, 4)) == 4 else None,
        draw(st.integers(1, 4)) == 4,
        draw(st.integers(1, 3)) == 3,
    )


_opens = st.builds(
    Open,
    st.sets(st.sampled_from(("speaker", "speech-recognition", "neck", "arm", "locomotion"))).map(
        lambda devices: frozenset(devices | {"speaker"})
    ),
    st.one_of(st.none(), st.integers(1, 5000)),
)
_deed: st.SearchStrategy[Deed] = st.integers(0, 19).flatmap(
    lambda kind: (
        _asks()
        if kind < 13
        else _opens
        if kind < 15
        else st.just(Close())
        if kind < 17
        else st.just(Leave())
        if kind < 19
        else st.just(Go())
    )
)
_deeds = st.lists(_deed, max_size=3).map(tuple)


@st.composite
def scripts(draw: Any) -> Script:
    """Two or three requesters and what happens to them."""
    apps = draw(st.sampled_from((2, 2, 3)))
    windows = tuple(
        tuple(draw(_deeds) for _ in range(draw(st.integers(0, 4)))) for _ in range(apps)
    )
    events = []
    time = 0
    for _ in range(draw(st.integers(1, 7))):
        time += draw(st.sampled_from((0, 1, 50, 400, 1500, 4000)))
        events.append((time, tuple(draw(_deeds) for _ in range(apps))))
    emergencies = []
    if draw(st.integers(1, 5)) == 5:
        emergencies.append(
            (draw(st.integers(1, 6000)), draw(st.integers(1, 2000)), draw(st.booleans()))
        )
    world = World(
        draw(st.integers(0, 10_000)),
        draw(st.sampled_from((0, 0, 5, 20))),
        draw(st.sampled_from((0, 50))),
        lacks=draw(st.integers(1, 5)) == 5,
    )
    views = draw(st.lists(st.tuples(st.integers(1, 8000), st.booleans()), max_size=3))
    return Script(windows, tuple(events), tuple(emergencies), world, tuple(views))
