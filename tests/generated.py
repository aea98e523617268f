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
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import count
from random import Random
from typing import Any

from hypothesis import strategies as st

from prima.commands import TABLE_4_2
from prima.interpreter.reader import read_document
from prima.messages import (
    CloseUnit,
    Command,
    Emergency,
    Ended,
    Failed,
    Group,
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
from prima.scheduler.chronicle import Chronicle
from prima.scheduler.mediator import Mediator
from prima.scheduler.selection import policy_named
from prima.session import Session
from prima.transcript.lines import line

STEPS = 600
"""Instants that a run may have; more is a run cut off, which is no fault as such."""
APPS = ("fa", "ea", "xa")

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


class Devices:
    """A robot made up: it ends what it is told to start, sooner or later."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.agenda: list[tuple[int, int, Inbound]] = []
        self.tasks: set[str] = set()
        self.starts: list[str] = []
        self._serial = count()

    def plan(self, time: int, value: Inbound) -> None:
        heapq.heappush(self.agenda, (time, next(self._serial), value))

    def due(self) -> int | None:
        return self.agenda[0][0] if self.agenda else None

    def collect(self, now: int) -> list[Inbound]:
        """What happens now; what an aborted AB would have reported does not."""
        found: list[Inbound] = []
        while self.agenda and self.agenda[0][0] <= now:
            value = heapq.heappop(self.agenda)[2]
            if isinstance(value, Ended | Failed | Listening) and value.behavior not in self.tasks:
                continue
            if isinstance(value, Ended | Failed):
                self.tasks.discard(value.behavior)
            found.append(value)
        return found

    def order(self, now: int, order: Order) -> None:
        if order.verb == "abort":
            self.tasks.discard(order.behavior)
        elif order.verb == "start":
            self.starts.append(order.behavior)
            self.tasks.add(order.behavior)
            self._begin(now, order)
        elif order.verb == "send":
            dice = Random(f"{self.world.seed} {order.behavior}")
            name = f"reply.{order.data['to']}"
            self.plan(now + dice.randint(1, 2000), Occurred(name, app=order.app))

    def _begin(self, now: int, order: Order) -> None:
        assert order.command is not None
        world, name = self.world, order.behavior
        dice = Random(f"{world.seed} {name}")
        lasts = dice.randint(1, 600 if TABLE_4_2[order.command.type].feedback else 3000)
        if dice.randrange(100) < world.fails:
            device = dice.choice(sorted(order.devices))
            self.plan(now + lasts, Failed(name, device, "it fails"))
        elif order.command.type == "q-and-a":
            self._ask(now, now + lasts, name, dice)
        elif TABLE_4_2[order.command.type].feedback:
            # The goal depends on the Command, not on the loop, so that it is reached for certain.
            loops = Random(f"{world.seed} {name.partition('.')[0]}").randint(1, 6)
            endless = world.endless and order.command.type == "tracking-human"
            self.plan(now + lasts, Ended(name, order.loop >= loops and not endless))
        else:
            self.plan(now + lasts, Ended(name))

    def _ask(self, now: int, said: int, name: str, dice: Random) -> None:
        later = said + dice.randint(1, 3000)
        self.plan(said, Listening(name))
        if dice.randrange(100) >= self.world.silent:
            self.plan(later, Heard(dice.choice(("yes", "no"))))
        elif dice.random() < 0.5:
            self.plan(later, Heard("mumble"))
        self.plan(later + 1, Ended(name, True, {"outcome": "noinput"}))


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


def perform(play: Play, policy: str = "prima", bound: int | None = None) -> Run:
    """Run a play to its end, or cut it off."""
    documents = []
    for number, text in enumerate(play.documents):
        document, problems = read_document(f"{APPS[number]}.xml", text.encode())
        errors = [str(problem) for problem in problems if problem.severity == "error"]
        assert not errors, (errors, text)
        documents.append(document)
    session = Session(documents, policy_named(policy), TABLE_4_2, bound)
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
        found.append(f"invariant 9: {ab.id} is {ab.state.value} for ever")
    for stream in memory.streams.values():
        found.append(f"invariant 9: {stream.name} stays open for ever")
    for app in session.apps.values():
        # Private, but nothing else tells an application that waits for a Command
        # which is gone from one that waits for an event.
        waiting = sorted(app._waiting)
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
EVENTS = ("touch", "touch.head", "message", "corner", "human.found", "human.lost")


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
            self.handler(index, self.one((*EVENTS, "own", "end", "cancel", "error")))
            for _ in range(self.some(0, 2))
        )
        return f'<form id="{self.forms[index]}">{items}{handlers}</form>'

    def item(self, index: int) -> str:
        kind = self.some(0, 5)
        if kind < 3:
            return f"<block>{self.content(index, sends=True)}</block>"
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
        return f'<field name="q{next(self.fields)}" type="boolean">{"".join(parts)}</field>'

    def unit(self, index: int) -> str:
        parts = []
        for _ in range(self.some(1, 2)):
            if self.chance(2):
                parts.append(self.question(index, unit=True))
            else:
                parts.append(f"<block>{self.content(index, unit=True)}</block>")
        if self.chance(4):
            parts.append(self.handler(index, self.one(EVENTS), True))
        longest = f' longest="{self.some(1, 6000)}ms"' if self.chance(3) else ""
        return f"<iu{longest}>{''.join(parts)}</iu>"

    def handler(self, index: int, event: str, unit: bool = False) -> str:
        reactive = self.one(("", "", ' reactive="true"', ' reactive="false"'))
        # Ends and errors may come for ever, so what is done about them asks for nothing;
        # the application's own event is sent by what comes from outside or once, and leads ahead.
        simple = event in ("end", "cancel", "error")
        external = not simple and event != "own"
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
            return HOOKED.format(self.effortless())
        return self.one(PLAIN)

    def branch(self, unit: bool) -> str:
        if self.chance(3):
            return f"<seq>{self.command(unit)}{self.command(unit)}</seq>"
        return self.command(unit)

    def group(self) -> str:
        inside = [self.one(PLAIN) for _ in range(self.some(1, 3))]
        if self.chance(3):
            inside.append(f"<par>{self.one(PLAIN)}{self.one(PLAIN)}</par>")
        longest = f' longest="{self.some(1, 3000)}ms"' if self.chance(4) else ""
        return f"<iu{longest}>{''.join(inside)}</iu>"


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
    events.sort(key=lambda event: event[0])
    seed = draw(st.integers(0, 10_000))
    world = World(seed)
    if not lively:
        world = World(
            seed,
            draw(st.sampled_from((0, 0, 5, 20))),
            draw(st.sampled_from((0, 30, 60))),
            draw(st.booleans()),
        )
    return Play(documents, loads, tuple(events), world)


# Scripts: requests to a mediator ------------------------------------------------------


@dataclass(frozen=True)
class Ask:
    """Commands to ask for at once: their types, or groups of them, and whom each follows."""

    whats: tuple[str | tuple[str, ...], ...]
    after: tuple[tuple[int, ...], ...]
    now: bool = False


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
GROUPED = tuple(name for name in PIECES if name != "q-and-a")
ALL = tuple(TABLE_4_2)


def command(name: str, now: bool = False) -> Command:
    """A Command of a type that is valid."""
    text = "Hello." if TABLE_4_2[name].text == "required" else None
    return Command(name, dict(ARGUMENTS.get(name, {})), text, now)


class Requester:
    """One application of a script: it keeps to what documents can ask for."""

    def __init__(self, name: str, windows: tuple[tuple[Deed, ...], ...]) -> None:
        self.name = name
        self.windows = list(windows)
        self.state = 1
        self.unit: int | None = None
        self.devices: frozenset[str] = frozenset()
        self.over = False
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
                    asked = Request(number, steps, self.state, cause, self.unit)
                    mediator.request(self.name, asked)
                    cause = None
                case Open() if self.unit is None:
                    self.unit, self.devices = next(self._numbers), deed.devices
                    mediator.open_unit(
                        self.name,
                        OpenUnit(self.unit, self.state, deed.devices, deed.longest, cause),
                    )
                    cause = None
                case Close():
                    self._close(mediator)
                case Leave():
                    self._close(mediator)
                    mediator.leave_state(self.name, LeaveState(self.state))
                    self.state += 1
                case Go():
                    self._close(mediator)
                    mediator.leave_state(self.name, LeaveState(self.state))
                    mediator.unload(self.name, "exit")
                    self.over = True

    def _close(self, mediator: Mediator) -> None:
        if self.unit is not None:
            mediator.close_unit(self.name, CloseUnit(self.unit))
            self.unit = None

    def _steps(self, asked: Ask) -> list[Step]:
        """The steps that may be asked for where the requester is: in its unit, or not."""
        steps: list[Step] = []
        for what, after in zip(asked.whats, asked.after, strict=True):
            names = (what,) if isinstance(what, str) else what
            if self.unit is not None and not all(
                name in PIECES and TABLE_4_2[name].occupied(command(name).text) <= self.devices
                for name in names
            ):
                return []
            if isinstance(what, str):
                steps.append(Step(command(what, asked.now and not steps), after))
            else:
                inner = [
                    Step(command(name), (index - 1,) if index % 2 else ())
                    for index, name in enumerate(what)
                ]
                steps.append(Step(Group(inner, 4000), after))
        return steps

    def told(self, mediator: Mediator, notice: Notice) -> None:
        """A window: what the script says next."""
        if notice.what == "unit-timeout" and notice.run == self.unit:
            self.unit = None
        if notice.what != "ended" and self.windows:
            self.act(mediator, self.windows.pop(0))


def drive(script: Script, policy: str = "prima") -> Run:
    """Run a script; it does what a session does, by rule V3."""
    chronicle = Chronicle()
    mediator = Mediator(policy_named(policy), TABLE_4_2, chronicle)
    apps = {
        name: Requester(name, windows) for name, windows in zip(APPS, script.windows, strict=False)
    }
    for name in apps:
        mediator.load(name, "fa" if name == "fa" else "ea")
    devices = Devices(script.world)
    events = dict(enumerate(script.events, 1))
    for serial, (time, _) in events.items():
        devices.plan(time, Occurred("event", data={"serial": serial}))
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
        chronicle.now = now
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
                    chronicle.add("listening", "robot", behavior=value.behavior)
                    mediator.listening(value.behavior)
                case Heard():
                    question = mediator.question()
                    if question is not None and question.listening:
                        mediator.orders.append(Order("abort", question.id))
                        mediator.ended(question.id, True, {"outcome": "filled"}, inbound=False)
                case Emergency():
                    mediator.emergency(value.pressed, value.resume)
                case Occurred():
                    serial = value.data["serial"]
                    for app, deeds in zip(apps.values(), events[serial][1], strict=False):
                        app.act(mediator, deeds, serial)
            settle()
        mediator.expire()
        settle()
        mediator.select()
        for order in mediator.drain_orders():
            devices.order(now, order)
        records += chronicle.drain()
    run = Run(records, steps < STEPS, _orders_match(records, devices.starts))
    if run.complete and not mediator.halted:
        run.problems += [
            f"invariant 9: {ab.id} is {ab.state.value} for ever"
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
    return Ask(tuple(whats), tuple(after), draw(st.integers(1, 6)) == 6)


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
    )
    return Script(windows, tuple(events), tuple(emergencies), world)
