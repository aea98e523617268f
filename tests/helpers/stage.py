"""A small stage for tests of the rules: applications ask, devices end, the order is seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from prima.language.commands import PATIENCE_MS, TABLE_4_2, CommandType
from prima.messages import (
    CloseUnit,
    Command,
    Group,
    LeaveState,
    Notice,
    OpenUnit,
    Order,
    Record,
    Request,
    Step,
)
from prima.scheduler.mediator import Mediator
from prima.scheduler.policy import policy_named
from prima.scheduler.recorder import Recorder

MOVE = Command("topological-move", {"to": "room"})
TRACK = Command("tracking-human")


def say(text: str = "Hello.") -> Command:
    return Command("speak", text=text)


def ask(text: str = "Well?") -> Command:
    return Command("q-and-a", text=text)


def move(to: str = "room") -> Command:
    return Command("topological-move", {"to": to})


def search(text: str | None = None) -> Command:
    return Command("active-sensing-human", text=text)


def command(kind: str, text: str | None = None, /, **args: Any) -> Command:
    return Command(kind, args, text)


def restartable(what: Command) -> Command:
    return replace(what, restartable=True)


def chain(*whats: Command | Group) -> list[Step]:
    """Commands one after another, as a run of them is."""
    return [Step(what, (index - 1,) if index else ()) for index, what in enumerate(whats)]


class Stage:
    """A mediator with applications ``fa`` and ``ea``, driven by hand."""

    def __init__(
        self,
        policy: str = "prima",
        apps: Mapping[str, str] | None = None,
        table: Mapping[str, CommandType] = TABLE_4_2,
        bound: int | None = None,
        patience: int = PATIENCE_MS,
        refuses: bool = False,
    ) -> None:
        self.refuses = refuses
        """Whether Commands may be refused (E3): a test of something else would test nothing."""
        self.recorder = Recorder()
        chosen = policy_named(policy)
        self.mediator = Mediator(chosen, table, self.recorder, bound, patience=patience)
        for name, kind in ({"fa": "fa", "ea": "ea"} if apps is None else apps).items():
            self.mediator.load(name, kind)
        self.runs = 0
        self.records: list[Record] = []
        self.notices: list[tuple[str, Notice]] = []
        self.orders: list[Order] = []

    # What applications do -----------------------------------------------------

    def request(
        self,
        app: str,
        *whats: Command | Group,
        cause: int | None = None,
        state: int = 1,
        unit: int | None = None,
        steps: list[Step] | None = None,
        hold: int | None = None,
        connect: bool = False,
        words: Command | None = None,
        fresh: int | None = None,
    ) -> int:
        """Ask for Commands; nothing is selected before :meth:`select`."""
        self.runs += 1
        asked = Request(self.runs, steps or chain(*whats), state, cause, unit, hold, connect)
        asked.words, asked.fresh = words, fresh
        self.mediator.ask(app, asked)
        return self.runs

    def leave(self, app: str, state: int = 1) -> None:
        self.mediator.ask(app, LeaveState(state))

    def open(self, app: str, number: int, *devices: str, longest: int | None = None) -> None:
        self.mediator.ask(app, OpenUnit(number, 1, frozenset(devices), longest))

    def close(self, app: str, number: int) -> None:
        self.mediator.ask(app, CloseUnit(number))

    # What happens ---------------------------------------------------------------

    def at(self, time: int) -> Stage:
        self.recorder.now = time
        return self

    def end(self, behavior: str, goal: bool = True, then: Any = None, **data: Any) -> None:
        """An AB ends; ``then`` is called in the window that its end opens."""
        self.mediator.ended(behavior, goal, data)
        self.settle(then)

    def settle(self, then: Any = None) -> None:
        while self.mediator.deliveries:
            told = self.mediator.deliveries.popleft()
            self.notices += [(told.app, notice) for notice in told.notices]
            self.mediator.open_window(told)
            if then is not None:
                then()
                then = None
            self.mediator.close_window(told)

    def select(self) -> list[str]:
        """Select, and give what was started, in order."""
        self.settle()
        self.mediator.select()
        self.orders += self.mediator.drain_orders()
        made = self.recorder.drain()
        refused = [r for r in made if r["phase"] == "fail" and r["rule"] == "E3"]
        assert self.refuses or not refused, refused
        self.records += made
        return [record["behavior"] for record in made if record["phase"] == "start"]

    # What is seen -----------------------------------------------------------------

    @property
    def running(self) -> set[str]:
        return {ab.id for ab in self.mediator.memory.running.values()}

    @property
    def floor(self) -> list[str]:
        return [stream.name for stream in self.mediator.memory.floor]

    def rule(self, behavior: str) -> str:
        """The rule by which an AB was selected last."""
        found = [
            r["rule"] for r in self.records if r["phase"] == "decision" and r["winner"] == behavior
        ]
        return str(found[-1])

    def losers(self, behavior: str) -> list[str]:
        """Whom an AB went before when it was selected last."""
        found = [
            r["losers"]
            for r in self.records
            if r["phase"] == "decision" and r["winner"] == behavior
        ]
        return list(found[-1])

    def holds(self, behavior: str) -> list[str]:
        """The rules that have held an AB back."""
        return [
            r["rule"] for r in self.records if r["phase"] == "hold" and r["behavior"] == behavior
        ]

    def phases(self, phase: str) -> list[Record]:
        return [record for record in self.records if record["phase"] == phase]

    def told(self, app: str) -> list[str]:
        """What an application was told, as ``what`` or the event's name."""
        return [notice.event or notice.what for name, notice in self.notices if name == app]


def inserted(stage: Stage) -> list[tuple[str, str]]:
    """What the mediator has put in: for which AB, and the Command."""
    return [
        (record["inserted"], record["command"])
        for record in stage.phases("request")
        if record.get("inserted")
    ]
