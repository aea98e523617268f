"""Scripts: what two or three generated requesters ask of a mediator directly."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

from hypothesis import strategies as st

from prima.language.commands import PATIENCE_MS, TABLE_4_2
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
    Notice,
    Occurred,
    OpenUnit,
    Order,
    Record,
    Request,
    Step,
)
from prima.scheduler.mediator import Mediator
from prima.scheduler.policy import policy_named
from prima.scheduler.recorder import Recorder
from tests.helpers.generated.world import (
    APPS,
    DANCES,
    STEPS,
    TABLE,
    Devices,
    Run,
    World,
    lasting,
    left_undone,
    orders_match,
)


@dataclass(frozen=True)
class Ask:
    """Commands to ask for at once: their types, or groups of them, and whom each follows."""

    whats: tuple[str | tuple[str, ...], ...]
    after: tuple[tuple[int, ...], ...]
    now: bool = False
    hold: int | None = None
    connect: bool = False
    restartable: bool = False
    words: bool = False
    fresh: int | None = None


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
    "pause": {"time": "1s"},
    "point-by-hand": {"angle": 10.0},
    "gesture": {"name": "nod"},
    "topological-move": {"to": "room"},
    "set-position": {"x": 1.0, "y": 2.0},
    "set-position-and-direction": {"x": 1.0, "y": 2.0, "heading": 3.0},
}
PIECES = tuple(name for name, row in TABLE_4_2.items() if not row.feedback and not row.leaves)
GROUPED = tuple(name for name in PIECES if name not in ("q-and-a", "stop-moving"))
ALL = (*TABLE_4_2, *DANCES, *("q-and-a", "speak") * 3)
"""What is asked for; questions and words often, as much happens by their ends."""


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
                    asked.fresh = deed.fresh
                    asked.words = command("speak") if deed.words else None
                    mediator.ask(self.name, asked)
                    self._asked, cause = True, None
                case Open() if self.unit is None:
                    self.unit, self.devices = next(self._numbers), deed.devices
                    mediator.ask(
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
            mediator.ask(self.name, LeaveState(self.state))
        self._asked = False

    def _close(self, mediator: Mediator) -> None:
        if self.unit is not None:
            mediator.ask(self.name, CloseUnit(self.unit))
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


class Driver:
    """Runs a script; it does what a session does, by rule V3."""

    def __init__(self, script: Script, policy: str, patience: int) -> None:
        self.recorder, self.devices = Recorder(), Devices(script.world)
        self.mediator = Mediator(
            policy_named(policy), script.world.table, self.recorder, patience=patience
        )
        self.apps = {
            name: Requester(name, windows)
            for name, windows in zip(APPS, script.windows, strict=False)
        }
        for name in self.apps:
            self.mediator.load(name, "fa" if name == "fa" else "ea")
        self.events = dict(enumerate(script.events, 1))
        self._plan(script)

    def _plan(self, script: Script) -> None:
        plan = self.devices.plan
        for serial, (time, _) in self.events.items():
            plan(time, Occurred("event", data={"serial": serial}))
        for time, seen in script.views:
            plan(time, Occurred("human.found" if seen else "human.lost"))
        for pressed, lasts, resume in script.emergencies:
            plan(pressed, Emergency(True))
            plan(pressed + lasts, Emergency(False, resume))

    def run(self) -> Run:
        """Drive it to its end."""
        records: list[Record] = []
        problems: list[str] = []
        now = steps = 0
        while steps < STEPS and (due := self._due(now)) is not None:
            steps, now = steps + 1, due
            self._instant(now, len(self.events) + steps)
            records += self.recorder.drain()
            problems += left_undone(now, self.mediator.deadline())
        problems += orders_match(records, self.devices.starts)
        return Run(records, steps < STEPS, problems)

    def _due(self, now: int) -> int | None:
        """The next instant; where nothing more happens by itself, a unit is concluded (U5)."""
        known = (self.devices.due(), self.mediator.deadline())
        times = [time for time in known if time is not None]
        if times:
            return max(now, min(times))
        held = [app for app in self.apps.values() if app.unit is not None and not app.over]
        if not held:
            return None
        self.recorder.now = now + 1
        held[0].act(self.mediator, [Close()])
        return now + 1

    def _instant(self, now: int, serial: int) -> None:
        self.recorder.now = now
        values = self.devices.collect(now)
        for value in sorted(values, key=lambda one: isinstance(one, Occurred | Emergency)):
            if isinstance(value, Occurred):
                self._occurred(value)
            elif isinstance(value, Emergency):
                self.mediator.emergency(value.pressed, value.resume, serial)
            else:
                self._reported(value)
            self._settle()
        self.mediator.expire()
        self._settle()
        self.mediator.select()
        for order in self.mediator.drain_orders():
            self.devices.order(now, order)

    def _reported(self, value: Inbound) -> None:
        mediator = self.mediator
        match value:
            case Ended():
                mediator.ended(value.behavior, value.goal, value.data)
            case Failed():
                mediator.failed(value.behavior, value.device, value.reason)
            case Halted():
                mediator.interrupted(value.behavior, value.data)
            case Listening():
                self.recorder.add("listening", "robot", behavior=value.behavior)
                mediator.listening(value.behavior)
            case Heard():
                question = mediator.question()
                if question is not None and question.listening:
                    mediator.orders.append(Order("abort", question.id))
                    mediator.ended(question.id, True, {"outcome": "filled"}, inbound=False)

    def _occurred(self, value: Occurred) -> None:
        if value.name in ("human.found", "human.lost"):
            self.recorder.add("event", "environment", event=value.name, inbound=True)
            self.mediator.sees_user(value.name == "human.found")
            return
        serial = value.data["serial"]
        self.recorder.add("event", "environment", event="message", serial=serial, inbound=True)
        for app, deeds in zip(self.apps.values(), self.events[serial][1], strict=False):
            app.act(self.mediator, deeds, serial)

    def _settle(self) -> None:
        mediator = self.mediator
        while mediator.deliveries:
            told = mediator.deliveries.popleft()
            app = self.apps[told.app]
            if app.over:
                continue
            mediator.open_window(told)
            for notice in told.notices:
                app.told(mediator, notice)
            mediator.close_window(told)


def drive(script: Script, policy: str = "prima", patience: int = PATIENCE_MS) -> Run:
    """Run a script; whatever stays in working memory for ever is a problem."""
    driver = Driver(script, policy, patience)
    run = driver.run()
    if run.complete and not driver.mediator.halted:
        run.problems += [
            f"invariant 9: {ab.id} is {ab.state} for ever"
            for ab in driver.mediator.memory.behaviors.values()
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
        draw(st.integers(1, 3)) == 3,
        draw(st.sampled_from((1, 700, 3000))) if draw(st.integers(1, 3)) == 3 else None,
    )


_opens = st.builds(
    Open,
    st.sets(st.sampled_from(("speaker", "speech-recognition", "neck", "arm", "locomotion"))).map(
        lambda devices: frozenset(devices | {"speaker"})
    ),
    st.one_of(st.none(), st.integers(1, 5000)),
)
_QUESTION = Ask(("q-and-a",), ((),))
_TURNS = (
    _QUESTION,
    Ask(("speak",), ((),)),
    Ask(("move-head", "speak"), ((), (0,))),
    Ask(("speak", "turn"), ((), ())),
    Ask((("speak", "turn"),), ((),)),
    Ask(("face-human",), ((),)),
)
"""A question or an utterance, and little with it: what conversations are made of."""
_talk = st.builds(
    replace,
    st.sampled_from(_TURNS),
    hold=st.sampled_from((None, 6000)),
    restartable=st.booleans(),
)
_deed: st.SearchStrategy[Deed] = st.integers(0, 19).flatmap(
    lambda kind: (
        _talk
        if kind < 5
        else _asks()
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
    windows = [tuple(draw(_deeds) for _ in range(draw(st.integers(0, 4)))) for _ in range(apps)]
    events = []
    time = 0
    if draw(st.integers(1, 4)) == 4:  # a question, while which others come to speak (X7, X10)
        asker = draw(st.integers(0, apps - 1))
        windows[asker] = ((draw(st.sampled_from(_TURNS[1:3])),), *windows[asker])
        for who, deed in ((asker, _QUESTION), (1 - asker if asker < 2 else 0, draw(_talk))):
            time += draw(st.sampled_from((1, 50, 400)))
            events.append((time, tuple((deed,) if one == who else () for one in range(apps))))
    for _ in range(draw(st.integers(1, 7))):
        time += draw(st.sampled_from((0, 1, 50, 400, 1500, 4000)))
        events.append((time, tuple(draw(_deeds) for _ in range(apps))))
    emergencies = []
    if draw(st.integers(1, 5)) == 5:
        emergencies.append((draw(st.integers(1, 6000)), draw(lasting), draw(st.booleans())))
    world = World(
        draw(st.integers(0, 10_000)),
        draw(st.sampled_from((0, 0, 5, 20))),
        draw(st.sampled_from((0, 50))),
        lacks=draw(st.integers(1, 5)) == 5,
    )
    views = draw(st.lists(st.tuples(st.integers(1, 8000), st.booleans()), max_size=3))
    return Script(tuple(windows), tuple(events), tuple(emergencies), world, tuple(views))
