"""What must hold in every run, recomputed from a transcript's records alone.

Nothing of the mediator is used here: working memory, trees, floor, engagement
and reactions are built again from requests, starts, ends, cancellations,
failures and windows, by the numbered rules of the mediation. What the mediator
says about its own view (``floor``, ``suspend``, ``resume``, ``hold``,
``decision``) is not believed and not read; ``stream-end`` alone is, because a
Command that its tree has outlived is a Command lost.

The extensions relax some invariants, and each is held to what it relaxes:

- X1, X4: an AB that the mediator put in starts before the one that it was put in
  for (4), counts as its reaction's start (6), and is there only for a reason (11);
- X2: only an AB marked so is interrupted, only for a reaction that starts in that
  instant (2), and it starts again from its beginning (3); a reaction that finds
  nothing else in its way does not wait (6);
- X3: a held stream is open, so it keeps channel and floor (5, 7); it is held only as
  long as was asked for, and no shorter (10);
- X5: one free and one faithful motion share devices (1); a loop that only carries
  what holds the floor may start beside it (7).

``held``, ``interrupt`` and ``inserted`` are read as claims: each has to be justified.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

Record = Mapping[str, Any]

LINKED, WAITING, RUNNING, GONE = "linked", "waiting", "running", "gone"
BASELINES = ("fifo", "fair", "fixed", "none")
EXTENSIONS = frozenset(("x1", "x2", "x3", "x4", "x5", "x6"))
RESTORING = ("set-position", "set-position-and-direction", "set-direction", "face-human")
"""What X1 may put in, and the head's Command."""
GOING = (
    "set-position",
    "set-position-and-direction",
    "topological-move",
    "set-speed-and-time",
    "tracking-human",
)
"""What changes where the robot stands, so that it relies on no place itself."""
FAR = 0.5
"""Metres from its place at which a stream is not where it was (X1)."""
COMPOSED = {"free", "faithful"}
A_MOMENT = 1e-6


@dataclass(slots=True, eq=False)
class AB:
    """An Atomic Behavior as its records tell of it; a feedback Command is one, loops and all."""

    name: str
    command: str
    app: str
    tree: Tree
    devices: frozenset[str]
    high: bool
    leaves: bool
    engages: bool
    feedback: bool
    question: bool
    state: int | None
    unit: AB | None
    cause: int | None
    """The event reacted to: the reactive flag, until it starts (C5)."""
    parents: set[str]
    requested: float
    place: int
    """The index of its request among the records."""
    restartable: bool = False
    motion: str = ""
    connect: bool = False
    """Whether the robot has to see the user, or turn to him, before it starts (X4)."""
    inserted: str = ""
    put_before: str = ""
    """What it was put in before."""
    phase: str = WAITING
    loop: int = 0
    starts: int = 0
    started: int = -1
    """The index of its latest start among the records."""
    started_at: float = -1
    reacted: int | None = None
    """The event that it reacted to when it started last."""
    interrupted: bool = False
    """Whether it has to start again from its beginning (X2)."""
    content: list[Record] = field(default_factory=list)
    """What was requested inside the unit since it started from its beginning."""
    before: list[Record] = field(default_factory=list)
    """The same for the time before it was interrupted."""
    listening: bool = False
    silent: bool = False
    """Whether O2 may have made the mediator deaf for it while it runs."""

    def inside(self, other: AB) -> bool:
        """Whether this is a part of the unit ``other``, at any depth."""
        unit = self.unit
        while unit is not None and unit is not other:
            unit = unit.unit
        return unit is other

    @property
    def outermost(self) -> AB:
        """The AB that is cut if this one is: the unit around it, or itself."""
        return self if self.unit is None else self.unit.outermost

    @property
    def shown(self) -> str:
        return f"{self.name}.{self.loop}" if self.loop else self.name


@dataclass(slots=True, eq=False)
class Tree:
    """A Communication Stream."""

    name: str
    app: str
    members: dict[str, AB] = field(default_factory=dict)
    windows: int = 0
    engaged: bool = False
    cause: int | None = None
    causes: set[int] = field(default_factory=set)
    hold: float | None = None
    """How long (s) its latest request wants it held afterwards (X3)."""
    hold_state: int | None = None
    until: float | None = None
    """Until when (s) it is held."""
    joined: int = -1
    """The index of the record by which a request joined it, being held."""
    requested: int = -1
    """The index of the latest request."""
    suspended: bool = False
    place: tuple[float, float] | None = None
    """Where the robot has gone for it, so that what follows relies on standing there (X1)."""

    @property
    def open(self) -> bool:
        """C1: something of it is in working memory, or a window is open; or it is held (X3)."""
        return bool(self.members) or self.windows > 0 or self.until is not None

    def contending(self) -> list[AB]:
        """What runs and waits: linked ABs hold nothing back, but for what something was put in for."""
        return [self.meant(ab) for ab in self.members.values() if ab.phase != LINKED]

    def meant(self, ab: AB) -> AB:
        """What an AB that was put in was put in for (X1, X4), while that is there; else itself."""
        return self.members.get(ab.put_before, ab)

    def engages(self) -> bool:
        """K1: from the first engaging start to the end, unless all that contends leaves."""
        contending = self.contending()
        return self.engaged and not (contending and all(ab.leaves for ab in contending))


@dataclass(slots=True)
class Cut:
    """A cancellation that has to be justified by what else happens in its instant."""

    ab: AB
    was: str
    rule: str
    place: int
    tree_devices: frozenset[str]


def base(behavior: str) -> str:
    """An AB's name without the number of its loop."""
    return behavior.partition(".")[0]


class Checker:
    """Goes through the records of one run, in order."""

    def __init__(self, records: Iterable[Record], policy: str) -> None:
        self.records = list(records)
        name, *extensions = policy.split("+")
        self.policy, _, self.first = name.partition(":")
        self.prima = self.policy == "prima"
        self.extensions = EXTENSIONS if "all" in extensions else frozenset(extensions)
        written = bool(self.records) and self.records[0]["phase"] == "run"
        self.second = 1 if written else 1000
        """A second in the records' time: transcripts count seconds, runs milliseconds."""
        self.in_view = False
        """Whether the camera sees the user (V4)."""
        self.seen: set[str] = set()
        """ABs that have waited while the camera saw the user: X4 may be done with them."""
        self.faced: set[str] = set()
        """ABs for which the robot turns to the user (X4)."""
        self.lacking: set[str] = set()
        self.robot: tuple[float, float] | None = None
        """Where the robot stands, as its devices have told."""
        self.found: list[str] = []
        self.apps: dict[str, int] = {}
        self.gone_apps: set[str] = set()
        self.abs: dict[str, AB] = {}
        self.waiting: dict[str, AB] = {}
        self.running: dict[str, AB] = {}
        self.trees: dict[str, Tree] = {}
        self.floor: list[Tree] = []
        self.halted = False
        self.left: dict[tuple[str, int | None], str] = {}
        """States that a cancellation says were left, and by which AB it was said."""
        self.now: float = 0
        self.place = 0
        self.extra_reactions = 0
        self._new_instant()
        self.last: dict[str, int] = {}
        self.last_state: dict[tuple[str, int | None], int] = {}
        self.unit_ends: dict[str, float] = {}
        self.begins: dict[tuple[float, str], int] = {}
        """When streams begin to be held, and the index of the record that says so."""
        self.nested: set[str] = set()
        """Units inside units: what is in them is requested when they start, and by nobody."""
        for place, record in enumerate(self.records):
            if record["phase"] == "end" and record["command"] == "iu":
                self.unit_ends[record["behavior"]] = record["time"]
            if record["phase"] == "held" and record["outcome"] == "begun":
                self.begins[record["time"], record["tree"]] = place
            if "behavior" in record and record["phase"] != "halted":
                self.last[base(record["behavior"])] = place
            if record["phase"] != "request":
                continue
            if record["command"] == "iu" and record.get("unit"):
                self.nested.add(record["behavior"])
            if record.get("unit") not in self.nested:
                self.last_state[record["app"], record.get("state")] = place

    def _new_instant(self) -> None:
        self.cuts: list[Cut] = []
        self.urgent: list[tuple[str, frozenset[str], int]] = []
        """Commands wanted now in this instant: application, devices, place (O2)."""
        self.failed: list[AB] = []
        self.unloaded: set[str] = set()
        self.released = False
        self.started_leaving: list[tuple[str, set[AB]]] = []
        self.started_inside: list[AB] = []
        self.tree_devices: dict[str, frozenset[str]] = {}
        self.gave_way: list[tuple[AB, AB, int]] = []
        """X2: what was interrupted, for which reaction, and where the record is."""

    def report(self, number: int, rule: str, text: str) -> None:
        """Note a violation of an invariant, with the rule behind it."""
        self.found.append(f"invariant {number} ({rule}) at {self.now:g}: {text}")

    # Going through ------------------------------------------------------------

    def run(self) -> list[str]:
        """All violations, in the order in which they show."""
        takes: dict[str, Callable[[Record], None]] = {
            "load": self._load,
            "unload": self._unload,
            "request": self._request,
            "window": self._window,
            "listening": self._listening,
            "stream-end": self._stream_end,
            "emergency": self._emergency,
            "start": self._start,
            "end": self._end,
            "fail": self._fail,
            "cancel": self._cancel,
            "event": self._event,
            "interrupt": self._interrupt,
            "held": self._held,
            "substitute": self._substitute,
        }
        for place, record in enumerate(self.records):
            self.place = place
            if record["time"] != self.now:
                self._instant_over()
                self.now = record["time"]
                self._new_instant()
            take = takes.get(record["phase"])
            if take is not None:
                take(record)
        self._instant_over()
        return self.found

    def _load(self, record: Record) -> None:
        if record["actor"] == "mediator":
            self.apps[record["app"]] = len(self.apps)

    def _unload(self, record: Record) -> None:
        if record["actor"] == "mediator":
            self.gone_apps.add(record["app"])
            self.unloaded.add(record["app"])

    def _request(self, record: Record) -> None:
        name, app = record["behavior"], record["app"]
        if name in self.abs:
            self.report(3, "U1", f"{name} is requested twice")
            return
        if (app, record.get("state")) in self.left and record.get("unit") not in self.nested:
            other = self.left[app, record.get("state")]
            self.report(3, "O3", f"{other} was given up, but {name} is of the same state")
        tree = self.trees.get(record["tree"])
        if tree is None:
            tree = self.trees[record["tree"]] = Tree(record["tree"], app)
        parents = record.get("parents") or ([record["parent"]] if record.get("parent") else [])
        names = {base(parent) for parent in parents}
        unknown = [parent for parent in names if parent not in self.abs]
        if unknown:
            self.report(4, "U3", f"{name} follows {unknown[0]}, which was never requested")
        unit = self.abs.get(base(record["unit"])) if record.get("unit") else None
        before = self.abs.get(base(record["before"])) if record.get("inserted") else None
        if before is not None:
            names.discard(before.name)  # the loop of it that has ended
        if record["command"] in self.lacking:
            self.report(3, "X6", f"{name} is requested, but the robot lacks {record['command']}")
        ab = self.abs[name] = AB(
            name=name,
            command=record["command"],
            app=app,
            tree=tree,
            devices=frozenset(record["devices"]),
            high=record["priority"] == "high",
            leaves=bool(record.get("leaves")),
            engages=bool(record.get("engages")),
            feedback=bool(record.get("feedback")),
            question=record["command"] == "q-and-a",
            state=record.get("state"),
            unit=unit,
            cause=record.get("cause") if record.get("reactive") else None,
            parents={one for one in names if one in self.abs and self.abs[one].phase != GONE},
            requested=self.now,
            place=self.place,
            restartable=bool(record.get("restartable")),
            motion=record.get("motion", "") if unit is None else "",
            connect=bool(record.get("connect")),
            inserted=record.get("inserted", ""),
            put_before=base(record.get("before") or ""),
        )
        tree.members[name] = ab
        self._wants_hold(tree, ab, record)
        if unit is not None:
            unit.content.append(record)
        if ab.inserted:
            self._put_in(ab, before, record)
        if ab.parents:
            ab.phase = LINKED
        else:
            self._wait(ab)
        if record.get("order") == "now":
            self.urgent.append((app, ab.devices, self.place))
            self._maybe_silence(ab)

    def _event(self, record: Record) -> None:
        if record["event"] in ("human.found", "human.lost"):
            self.in_view = record["event"] == "human.found"

    # Extensions ---------------------------------------------------------------

    def _put_in(self, ab: AB, before: AB | None, record: Record) -> None:
        """X1, X4: the mediator itself puts an AB in before another."""
        rule, shown = ab.inserted, f"{ab.name} is put in"
        if rule not in ("X1", "X4") or rule.lower() not in self.extensions:
            self.report(11, rule, f"{shown} by a rule that is not on")
        if before is None or before.tree is not ab.tree or before.inserted or before.unit:
            self.report(11, rule, f"{shown} before something that it cannot stand before")
            return
        first = before.phase == WAITING
        if not first and not before.parents & ab.parents:
            self.report(11, rule, f"{shown}, but {before.shown} is {before.phase}")
        if ab.cause != (before.cause if first else None):
            self.report(11, "C5", f"{shown} with a flag that {before.shown} has not")
        before.cause = None
        if rule == "X1":
            self._restores(ab, record)
        else:
            self._connects(ab, before, record)
        before.parents.add(ab.name)
        before.phase = LINKED
        self.waiting.pop(before.name, None)

    def _restores(self, ab: AB, record: Record) -> None:
        """X1: only what a suspended stream relies on is restored."""
        if not ab.tree.suspended:
            self.report(11, "X1", f"{ab.name} is put in, but {ab.tree.name} was not suspended")
        if record["command"] not in (*RESTORING, "move-head"):
            self.report(11, "X1", f"{ab.name} restores nothing: it is {record['command']}")
        for other in ab.tree.members.values():
            if other is not ab and other.inserted == "X1" and other.command == ab.command:
                self.report(11, "X1", f"{ab.name} restores what {other.shown} restores already")

    def _stands_right(self, ab: AB) -> None:
        """X1: a suspended stream goes on where the robot stood for it."""
        place, robot = ab.tree.place, self.robot
        if (
            not ab.tree.suspended
            or ab.inserted
            or ab.command in GOING
            or "x1" not in self.extensions
        ):
            return
        if place is not None and robot is not None and math.dist(place, robot) > FAR:
            self.report(11, "X1", f"{ab.shown} resumes at {robot}, but its stream was at {place}")

    def _moved(self, ab: AB, record: Record) -> None:
        """Take in where a Command's end, or a loop's, has brought the robot."""
        data = record.get("data") or {}
        if not {"x", "y", "heading"} <= data.keys():
            return
        self.robot = (data["x"], data["y"])
        if ab.command == "tracking-human":
            ab.tree.place = None
        elif ab.command in GOING and not ab.inserted and record["outcome"] != "again":
            ab.tree.place = self.robot

    def _connects(self, ab: AB, before: AB, record: Record) -> None:
        """X4: the user is turned to once, where that was asked for, and he is not seen."""
        if not before.connect or before.name in self.faced or self.in_view or before.starts:
            self.report(11, "X4", f"{ab.name} is put in, but {before.shown} needs no channel")
        if not (record["command"] == "face-human" and ab.devices >= before.devices):
            self.report(11, "X4", f"{ab.name} does not keep the channel for {before.shown}")
        self.faced.add(before.name)

    def _interrupt(self, record: Record) -> None:
        """X2: a restartable AB, and no other, gives way to a reaction that waits for it."""
        ab = self._running_one(record, "is interrupted")
        if ab is None:
            return
        by = self.abs.get(base(record["by"]))
        if "x2" not in self.extensions or not ab.restartable or ab.unit is not None:
            self.report(2, "X2", f"{ab.shown} is interrupted, which is not marked so")
        if by is None or by.phase != WAITING or by.cause is None or not by.devices & ab.devices:
            self.report(2, "X2", f"{ab.shown} is interrupted for {record['by']}, no reaction to it")
        elif ab.started_at == self.now and (not by.high or by.cause <= (ab.reacted or 0)):
            self.report(
                2, "S2", f"{ab.shown} is interrupted at its start: {by.shown} was outranked"
            )
        if by is not None:
            self.gave_way.append((ab, by, self.place))
        ab.interrupted = True
        ab.before, ab.content = ab.content, []
        self._wait(ab)

    def _starts_again(self, ab: AB, record: Record) -> None:
        """X2: from its beginning, and whole."""
        if not record.get("resumed"):
            self.report(3, "X2", f"{ab.shown} starts as if it had not been interrupted")
        before, now = (
            [(one["command"], one.get("text"), one.get("args")) for one in content]
            for content in (ab.before, ab.content)
        )
        if before != now:
            self.report(3, "X2", f"{ab.shown} starts again as something else: {now}, not {before}")
        ab.interrupted = False

    def _interruptions(self) -> None:
        """At the end of an instant: for what ABs were interrupted, and whether wholly."""
        for ab, by, place in self.gave_way:
            if by.started <= place:
                self.report(2, "X2", f"{ab.shown} is interrupted, but {by.shown} does not start")
        for ab in self.running.values():
            if ab.unit is not None and ab.unit.phase != RUNNING:
                self.report(2, "X2", f"{ab.shown} runs on, but its unit {ab.unit.shown} does not")

    def _wants_hold(self, tree: Tree, ab: AB, record: Record) -> None:
        """X3: the latest request says how long; while one is held, requests join it."""
        tree.hold, tree.hold_state = record.get("hold"), ab.state
        tree.requested = self.place
        if ab.parents or ab.unit is not None or ab.inserted:
            return
        held = [other for other in self.trees.values() if other.app == ab.app and other.until]
        if held and not any(tree is other for other in held) and not self._joined_now(tree):
            self.report(10, "X3", f"{ab.name} does not join {held[0].name}, which is held for it")

    def _joined_now(self, tree: Tree) -> bool:
        return tree.joined >= 0 and self.records[tree.joined]["time"] == self.now

    def _held(self, record: Record) -> None:
        name, outcome = record["tree"], record["outcome"]
        tree = self.trees.get(name)
        if "x3" not in self.extensions or tree is None:
            self.report(10, "X3", f"{name} is held, which is not to be")
            return
        if outcome == "begun":
            self._begin_hold(tree, record)
            return
        if tree.until is None:
            self.report(10, "X3", f"{name} is held no longer ({outcome}), but was not")
        elif outcome == "over" and abs(tree.until - self.now / self.second) > A_MOMENT:
            self.report(10, "X3", f"{name} was to be held until {tree.until:g}")
        elif outcome == "left":
            self.left.setdefault((tree.app, tree.hold_state), name)
        tree.until = tree.hold = None
        if outcome == "joined":
            tree.joined = self.place

    def _begin_hold(self, tree: Tree, record: Record) -> None:
        """X3: a stream of which nothing is left stays open, and takes the floor if it is free."""
        now = self.now / self.second
        until: float = record["data"]["until"]
        if tree.open or tree.hold is None or tree.app in self.gone_apps:
            self.report(10, "X3", f"{tree.name} is held, but nobody asks for it")
        elif abs(until - now - tree.hold) > A_MOMENT:
            self.report(10, "X3", f"{tree.name} is held until {until:g}, not for {tree.hold:g} s")
        tree.until = until
        self._close_trees()
        if not self.floor:
            self._give_floor(tree)

    def _holds_rightly(self) -> None:
        """X3, at the end of an instant: nothing is held too long, or while it goes on."""
        for tree in self.trees.values():
            if tree.until is not None and tree.until <= self.now / self.second + A_MOMENT:
                self.report(10, "X3", f"{tree.name} is held beyond {tree.until:g}")
            if tree.until is not None and tree.members:
                self.report(
                    10, "X3", f"{tree.name} is held, but {next(iter(tree.members))} is of it"
                )
            if self._joined_now(tree) and tree.requested < tree.joined:
                self.report(10, "X3", f"{tree.name} is joined by nothing")

    def _ends_rightly(self, tree: Tree) -> None:
        """X3: a stream ends only when nobody wants it held; a state left unseen may be why."""
        state_goes_on = self.last_state.get((tree.app, tree.hold_state), -1) >= self.place
        if tree.hold is not None and state_goes_on and tree.app not in self.gone_apps:
            self.report(10, "X3", f"{tree.name} ends, but was to be held for {tree.hold:g} s")

    def _substitute(self, record: Record) -> None:
        """X6: from here on, what the robot lacks is asked for no more."""
        if "x6" not in self.extensions:
            self.report(3, "X6", f"{record['command']} is replaced, which is not on")
        self.lacking.add(record["command"])

    def composes(self, ab: AB, other: AB) -> bool:
        """X5: a free motion carries a faithful one; both may use the same devices then."""
        return "x5" in self.extensions and {ab.motion, other.motion} == COMPOSED

    def carries_floor(self, ab: AB) -> bool:
        """X5: whether what holds the floor does nothing but a motion that the AB can carry."""
        contending = self.floor[-1].contending() if self.floor else []
        return bool(contending) and all(
            ab.motion == "free" and self.composes(ab, other) and other.phase == RUNNING
            for other in contending
        )

    def gives_way(self, ab: AB, reaction: AB) -> bool:
        """X2: whether an AB is certain to be interrupted for a reaction.

        It may not be where the reaction ranks below it (S2a, S2b), or where its state
        may have been left, so that it must not start again.
        """
        ab = ab.outermost
        heard = not ab.silent and ab.app not in self.gone_apps
        return (
            "x2" in self.extensions
            and ab.restartable
            and reaction.high
            and reaction.cause is not None
            and reaction.cause > (ab.reacted or 0)
            and heard
            and self.last_state[ab.app, ab.state] >= self.place
        )

    # What becomes of trees --------------------------------------------------------

    def _maybe_silence(self, urgent: AB) -> None:
        """O2: what runs on other devices finishes unheard, and nothing is recorded of that."""
        for tree in self.trees.values():
            devices = self.tree_devices.get(tree.name, frozenset()).union(
                *(ab.devices for ab in tree.members.values() if ab is not urgent)
            )
            if tree.app == urgent.app and devices & urgent.devices:
                for ab in tree.members.values():
                    ab.silent = ab.silent or ab.phase == RUNNING

    def _window(self, record: Record) -> None:
        tree = self.trees.get(record["tree"])
        if tree is None:
            self.report(3, "C1", f"a window of {record['tree']} opens, which has ended")
            tree = self.trees[record["tree"]] = Tree(record["tree"], record["app"])
        tree.windows += 1 if record["outcome"] == "open" else -1

    def _listening(self, record: Record) -> None:
        ab = self.running.get(base(record["behavior"]))
        if ab is not None:
            ab.listening = True

    def _stream_end(self, record: Record) -> None:
        tree = self.trees.get(record["tree"])
        if tree is None:
            return
        if tree.until is not None:
            self.report(10, "X3", f"{tree.name} ends, but is held until {tree.until:g}")
            tree.until = None
        for ab in list(tree.members.values()):
            self.report(3, "C1", f"{ab.shown} is {ab.phase}, but its tree has ended: it is lost")
            self._remove(ab)

    def _emergency(self, record: Record) -> None:
        self.halted = record["outcome"] == "pressed"
        self.released = self.released or not self.halted

    # What becomes of ABs --------------------------------------------------------

    def _wait(self, ab: AB) -> None:
        self.running.pop(ab.name, None)
        ab.phase = WAITING
        self.waiting[ab.name] = ab

    def _remove(self, ab: AB) -> None:
        ab.phase = GONE
        self.waiting.pop(ab.name, None)
        self.running.pop(ab.name, None)
        ab.tree.members.pop(ab.name, None)
        for other in list(ab.tree.members.values()):
            if ab.name in other.parents:
                other.parents.discard(ab.name)
                if not other.parents and other.phase == LINKED:
                    self._wait(other)

    def _close_trees(self) -> None:
        """C1, F3: when everything of the instant is taken in, empty trees end."""
        for tree in [tree for tree in self.trees.values() if not tree.open]:
            if self.begins.get((self.now, tree.name), -1) > self.place:
                continue  # it is held from this instant on
            self._ends_rightly(tree)
            del self.trees[tree.name]
            if tree in self.floor:
                self.floor.remove(tree)

    def _start(self, record: Record) -> None:
        name = base(record["behavior"])
        ab = self.abs.get(name)
        if ab is None:
            self.report(3, "U1", f"{record['behavior']} starts and was never requested")
            return
        self._close_trees()
        self._may_run(ab, record)
        if self.halted:
            self.report(2, "E5", f"{record['behavior']} starts during the emergency stop")
        self._devices_free(ab, record["behavior"])
        if ab.interrupted:
            self._starts_again(ab, record)
        if ab.unit is None:
            if self.prima and ab.phase == WAITING:
                self._allowed(ab, record["behavior"])
            self._channel_connected(ab)
            self._stands_right(ab)
            reaction = self._reaction_of(ab, record)
            composed = self.carries_floor(ab)
            self._run(ab)
            ab.tree.suspended = False
            if self.prima and (reaction is not None or not composed):
                self._take_floor(ab, reaction)
        else:
            self.started_inside.append(ab)
            if ab.unit.phase != RUNNING:
                self.report(
                    4, "U5", f"{ab.shown} starts, but its unit {ab.unit.shown} does not run"
                )
            if self.prima and ab.leaves:
                self._channel_kept(ab, record["behavior"])
            self._run(ab)

    def _channel_connected(self, ab: AB) -> None:
        """X4: the first word waits until the robot has turned to a user whom it does not see."""
        wanted = "x4" in self.extensions and ab.connect and not ab.starts
        if wanted and ab.name not in self.faced | self.seen and not self.in_view:
            self.report(11, "X4", f"{ab.shown} starts, but the robot has not turned to the user")

    def _run(self, ab: AB) -> None:
        self.waiting.pop(ab.name, None)
        ab.phase = RUNNING
        ab.starts += 1
        ab.started, ab.started_at, ab.reacted = self.place, self.now, ab.cause
        ab.loop += 1 if ab.feedback else 0
        ab.cause = None
        ab.listening = False
        self.running[ab.name] = ab
        ab.tree.engaged = ab.tree.engaged or ab.engages

    def _may_run(self, ab: AB, record: Record) -> None:
        """Invariants 3 and 4: asked for, not over, not running, and its parents have ended."""
        shown = record["behavior"]
        if ab.phase == GONE:
            self.report(3, "U1", f"{shown} starts again: it was over")
        elif ab.phase == RUNNING:
            self.report(3, "U1", f"{shown} starts and runs already")
        if ab.parents:
            self.report(4, "U3", f"{shown} starts before {', '.join(sorted(ab.parents))} has ended")
        expected = f"{ab.name}.{ab.loop + 1}" if ab.feedback else ab.name
        if shown != expected:
            self.report(3, "U2", f"{shown} starts where {expected} was due")
        if frozenset(record["devices"]) != ab.devices or record["tree"] != ab.tree.name:
            self.report(3, "U1", f"{shown} starts as something else than was requested")
        if ab.app in self.gone_apps and ab.unit is None:
            self.report(3, "E2", f"{shown} starts, but {ab.app} has ended")

    def _devices_free(self, ab: AB, shown: str) -> None:
        """Invariant 1; a unit's own Commands run on its devices."""
        for other in self.running.values():
            both = ab.devices & other.devices
            if both and self.composes(ab, other):
                continue
            if both and other is not ab and not ab.inside(other) and not other.inside(ab):
                what = ", ".join(sorted(both))
                self.report(1, "S1", f"{shown} starts while {other.shown} runs on {what}")

    def _reaction_of(self, ab: AB, record: Record) -> int | None:
        """The event that a starting AB reacts to. E4's bound makes a reaction of what starved."""
        if ab.cause is None and record.get("reactive"):
            self.extra_reactions -= 1
            return self.extra_reactions
        return ab.cause

    # Rules of selection -----------------------------------------------------------

    def _take_floor(self, ab: AB, reaction: int | None) -> None:
        """F1: a reaction takes the floor. F3: so does what starts in spite of another's."""
        tree = ab.tree
        holder = self.floor[-1] if self.floor else None
        if reaction is not None:
            tree.cause = reaction
            tree.causes.add(reaction)
        if reaction is None and (holder is None or holder.app == ab.app):
            return
        self._give_floor(tree)

    def _give_floor(self, tree: Tree) -> None:
        """C2: who takes the floor suspends the others' streams."""
        if self.floor and self.floor[-1] is tree:
            return
        if tree in self.floor:
            self.floor.remove(tree)
        self.floor.append(tree)
        for other in self.trees.values():
            other.suspended = other.suspended or other.app != tree.app

    def refused_by_floor(self, ab: AB, surely: bool = False) -> Tree | None:
        """F2: the stream that keeps the AB from starting, or that may keep it.

        "Another event" is left open by F2 where the floor's stream goes on from one
        reaction to the next (O2, O3): another than the last is certain to be meant,
        than an earlier one perhaps. Who reacts to an earlier one may start or wait.
        """
        holder = self.floor[-1] if self.floor else None
        if holder is None or holder.app == ab.app:
            return None
        held = {holder.cause} if surely else holder.causes
        if ab.cause is not None and ab.cause not in held:
            return None
        contending = holder.contending()
        high = ab.tree.meant(ab).high
        if contending and all(high and not other.high for other in contending):
            return None
        return None if self.carries_floor(ab) else holder

    def refused_by_channel(self, ab: AB) -> Tree | None:
        """K1: the stream that engages the user."""
        if ab.leaves:
            for tree in self.trees.values():
                if tree.app != ab.app and tree.open and tree.engages():
                    return tree
        return None

    def free_to_go(self, ab: AB) -> bool:
        """Whether F2 and K1 are certain to let a waiting AB start."""
        return self.refused_by_floor(ab) is None and self.refused_by_channel(ab) is None

    def outranks(self, ab: AB, other: AB) -> bool:
        """S2a and S2b, as far as they are certain.

        Which stream is "active" while nobody holds the floor is left open by S2b:
        then reactions to one event may go in either order.
        """
        if ab.high != other.high:
            return ab.high
        if ab.cause is None or other.cause is None:
            return ab.cause is not None
        if ab.cause != other.cause:
            return ab.cause > other.cause
        holder = self.floor[-1] if self.floor else None
        return holder is not None and holder.app == ab.app != other.app

    def _allowed(self, ab: AB, shown: str) -> None:
        """Invariants 5, 6 and 7 at a start."""
        holder = self.refused_by_floor(ab, surely=True)
        if holder is not None:
            number = 7 if ab.leaves else 5
            self.report(number, "F2", f"{shown} starts while {holder.name} holds the floor")
        if ab.leaves:
            self._channel_kept(ab, shown)
        for other in self.waiting.values():
            if other is ab or other.unit is not None or not other.devices & ab.devices:
                continue
            if not self.outranks(other, ab) or not self.free_to_go(other):
                continue
            if self._restoring(other):
                continue
            if other.cause is not None:
                # S3: whether or not its other devices are free, it holds this one back.
                number = 5 if other.leaves else 6
                self.report(number, "S3", f"{shown} starts before the reaction {other.shown}")
            elif not self._busy(other) and not self._held_back(other):
                self.report(5, "S2a", f"{shown} starts before {other.shown}, which outranks it")

    def _channel_kept(self, ab: AB, shown: str) -> None:
        tree = self.refused_by_channel(ab)
        if tree is not None:
            self.report(7, "K1", f"{shown} starts while {tree.name} engages the user")
        units = {other for other in self.running.values() if other.app != ab.app}
        self.started_leaving.append((shown, units))

    def _busy(self, ab: AB, interrupting: bool = True) -> bool:
        """Whether a running AB occupies one of the devices, and keeps it (S1, U5, X2)."""
        return any(
            ab.devices & other.devices
            and other is not ab
            and not ab.inside(other)
            and not self.composes(ab, other)
            and not (interrupting and self.gives_way(other, ab))
            for other in self.running.values()
        )

    def _held_back(self, ab: AB) -> bool:
        """S3: whether a reaction that may outrank it wants one of its devices."""
        return any(
            other is not ab
            and other.unit is None
            and other.cause is not None
            and other.devices & ab.devices
            and not self.outranks(ab, other)
            and self.refused_by_floor(other, surely=True) is None
            and self.refused_by_channel(other) is None
            for other in self.waiting.values()
        )

    # Ends ---------------------------------------------------------------------

    def _running_one(self, record: Record, what: str) -> AB | None:
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase != RUNNING or ab.shown != record["behavior"]:
            phase = ab.phase if ab is not None else "unknown"
            self.report(3, "U1", f"{record['behavior']} {what}, but it is {phase}")
            return None
        return ab

    def _end(self, record: Record) -> None:
        ab = self._running_one(record, "ends")
        if ab is None:
            return
        self._moved(ab, record)
        inner = [other for other in self.running.values() if other.inside(ab)]
        if inner:
            self.report(2, "U5", f"{ab.shown} ends while {inner[0].shown} runs in it")
        if ab.feedback and not record["goal"]:
            if record["outcome"] == "again":
                self._wait(ab)
                return
            if not ab.silent and ab.app not in self.gone_apps:
                # Given up before its goal: only O3 is left as a reason, so its state is over.
                self._say_left(ab)
        self._remove(ab)

    def _say_left(self, ab: AB) -> None:
        """O3 has no record of its own; no later request may then be of that state."""
        self.left.setdefault((ab.app, ab.state), ab.shown)

    def _fail(self, record: Record) -> None:
        if "behavior" not in record:
            return  # E3: refused before it entered working memory
        ab = self.abs.get(base(record["behavior"]))
        # A unit fails with the Command in it (U4); it is running then as well.
        ab = self._running_one(record, "fails") if ab is not None else None
        if ab is None:
            return
        if record["rule"] == "U5":
            for inner in self.running.values():
                inner.silent = inner.silent or inner is ab or inner.inside(ab)
            return  # a unit out of time ends when the Command of it that runs has
        if not ab.inserted:  # what it was put in for goes on without it
            self.failed.append(ab)
        self._remove(ab)

    def _cancel(self, record: Record) -> None:
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase == GONE:
            self.report(3, "O2", f"{record['behavior']} is cancelled, but it is not there")
            return
        was, rule = ab.phase, record["rule"]
        if record["outcome"] == "halted":
            if was != RUNNING:
                self.report(3, "E5", f"{ab.shown} is halted, but it is {was}")
            if not self.halted:
                self.report(2, "E5", f"{ab.shown} is halted without an emergency stop")
            if self._never_again(ab):
                self._remove(ab)
            else:
                self._wait(ab)
            return
        # What the tree wanted when the first of it was taken out, and what it was asked since.
        devices = self.tree_devices.get(ab.tree.name, frozenset()).union(
            *(one.devices for one in ab.tree.members.values())
        )
        self.tree_devices[ab.tree.name] = devices
        self.cuts.append(Cut(ab, was, rule, self.place, devices))
        self._remove(ab)

    def _never_again(self, ab: AB) -> bool:
        """Whether a halted AB may have been given up before (O2, O3, E2): nothing says so.

        It is taken to be gone where nothing is ever told of it again and the
        state that asked for it never asks for anything again.
        """
        if self.last[ab.name] != self.place:
            return False
        silent = ab.silent or ab.app in self.gone_apps
        unit = ab.unit
        while unit is not None:  # it was left, if it ends because of this
            silent = silent or self.unit_ends.get(unit.name, -1) == self.now
            unit = unit.unit
        return silent or self.last_state[ab.app, ab.state] < self.place

    # The end of an instant ----------------------------------------------------------

    def _instant_over(self) -> None:
        self._close_trees()
        self._holds_rightly()
        self._interruptions()
        for cut in self.cuts:
            self._justified(cut)
        for shown, others in self.started_leaving:
            for inner in self.started_inside:
                if inner.engages and any(inner.inside(unit) for unit in others):
                    # S2a: the unit's Command ranks before the loop, so K1 holds the loop.
                    self.report(
                        7, "K1", f"{shown} starts in the instant in which {inner.shown} engages"
                    )
        if self.halted:
            for ab in self.running.values():
                self.report(2, "E5", f"{ab.shown} runs during the emergency stop")
            return
        for ab in self.waiting.values():
            self._waits_rightly(ab)
            if self.in_view:
                self.seen.add(ab.name)

    def _waits_rightly(self, ab: AB) -> None:
        """Invariant 5: no waiting AB waits while it may start."""
        if ab.unit is not None:
            if ab.unit.phase == RUNNING and (self.policy == "none" or not self._busy_inside(ab)):
                self.report(5, "U5", f"{ab.shown} waits in {ab.unit.shown} on free devices")
            return
        if self.policy == "none":
            self.report(5, "none", f"{ab.shown} waits, though nothing mediates")
        elif self._busy(ab):
            return
        elif self.prima:
            if self.free_to_go(ab) and not self._held_back(ab) and not self._restoring(ab):
                if not self._busy(ab, interrupting=False):
                    self.report(5, "S1", f"{ab.shown} waits while its devices are free")
                if ab.cause is not None and not ab.leaves:
                    self.report(6, "S1", f"the reaction {ab.shown} is late")
        elif not any(self._ahead(other, ab) for other in self.waiting.values()):
            self.report(5, self.policy, f"{ab.shown} waits while its devices are free")

    def _restoring(self, ab: AB) -> bool:
        """X1: its stream is on its way back; what else is of it may wait for that."""
        return not ab.inserted and any(other.inserted == "X1" for other in ab.tree.members.values())

    def _busy_inside(self, ab: AB) -> bool:
        unit = ab.unit
        assert unit is not None
        for other in self.running.values():
            both = ab.devices & other.devices
            if other is not ab and not ab.inside(other) and both:
                return True
        return False

    def _ahead(self, other: AB, ab: AB) -> bool:
        """Baselines: whether another waiting AB may rank first and hold a device back."""
        if other is ab or other.unit is not None or not other.devices & ab.devices:
            return False
        if self.policy == "fair":
            return True  # whose turn it is depends on more than these two
        if self.policy == "fixed":
            top = self.first or min(self.apps, key=self.apps.__getitem__)
            if (other.app == top) != (ab.app == top):
                return other.app == top
        return other.requested <= ab.requested

    def _justified(self, cut: Cut) -> None:
        """Invariants 2 and 3: why an AB was taken out of working memory."""
        ab, number = cut.ab, 2 if cut.was == RUNNING else 3
        shown = f"{ab.shown} ({cut.was}) is cancelled"
        whole = [other.ab for other in self.cuts if ab.inside(other.ab)]
        """Units that are cancelled with it: what is in them goes with them."""
        match cut.rule:
            case "O2":
                mine = [one for one in self.urgent if one[0] == ab.app and one[2] > cut.place]
                devices = ab.devices.union(*(unit.devices for unit in whole))
                if cut.was != RUNNING:
                    devices = cut.tree_devices
                if not any(wanted & devices for _, wanted, _ in mine):
                    self.report(number, "O2", f"{shown} without a Command wanted now")
            case "O3" | "E2":
                if cut.was == RUNNING and not ab.listening and not whole:
                    self.report(2, "O3", f"{shown}: it does not listen")
                if cut.rule == "O3":
                    self._say_left(ab)
                    if self.last_state[ab.app, ab.state] > cut.place:
                        self.report(number, "O3", f"{shown}, but its state goes on")
                elif ab.app not in self.unloaded:
                    self.report(number, "E2", f"{shown}, but {ab.app} goes on")
            case "U5":
                if cut.was == RUNNING and not ab.listening:
                    self.report(2, "U5", f"{shown}: it does not listen")
            case "E1":
                near = [one for one in self.failed if one.tree is ab.tree]
                if not near:
                    self.report(number, "E1", f"{shown}, but nothing of its tree has failed")
                if cut.was == RUNNING and not any(ab.inside(one.unit) for one in near if one.unit):
                    self.report(2, "E1", f"{shown}, but nothing of its unit has failed")
            case "X2":
                if not any(ab.inside(unit) for unit, _, _ in self.gave_way):
                    self.report(number, "X2", f"{shown}, but no unit around it is interrupted")
            case "E5":
                if not (self.released or self.halted):
                    self.report(number, "E5", f"{shown} without an emergency")
            case rule:
                self.report(number, str(rule), f"{shown} by a rule that cancels nothing")


def check(records: Iterable[Record], policy: str = "prima") -> list[str]:
    """Violations of invariants 1 to 7, 10 and 11 in a run; of 1 to 5 under a baseline policy.

    10: a held stream is held as long as was asked for (X3). 11: what the mediator puts in
    itself has a reason, and takes the place of what it is put in for (X1, X4).

    Under ``none`` invariant 1 is expected to fail: nothing keeps devices apart.
    """
    return Checker(records, policy).run()


def unfinished(records: Iterable[Record], policy: str = "prima") -> list[str]:
    """ABs that are still in working memory after the last record (for invariant 9)."""
    checker = Checker(records, policy)
    checker.run()
    return [
        f"invariant 9: {ab.shown} of {ab.tree.name} is {ab.phase} at the end"
        for ab in checker.abs.values()
        if ab.phase != GONE
    ]


def numbers(violations: Iterable[str]) -> set[int]:
    """Which invariants are violated."""
    return {int(text.split()[1].rstrip(":")) for text in violations}
