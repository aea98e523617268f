"""What must hold in every run, recomputed from a transcript's records alone.

Nothing of the mediator is used here: working memory, trees, floor, engagement
and reactions are built again from requests, starts, ends, cancellations,
failures and windows, by the numbered rules of the mediation. What the mediator
says about its own view (``floor``, ``suspend``, ``resume``, ``hold``,
``decision``) is not believed and not read; ``stream-end`` alone is, because a
Command that its tree has outlived is a Command lost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

Record = Mapping[str, Any]

LINKED, WAITING, RUNNING, GONE = "linked", "waiting", "running", "gone"
BASELINES = ("fifo", "fair", "fixed", "none")


@dataclass(slots=True, eq=False)
class AB:
    """An Atomic Behavior as its records tell of it; a feedback Command is one, loops and all."""

    name: str
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
    phase: str = WAITING
    loop: int = 0
    starts: int = 0
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

    @property
    def open(self) -> bool:
        """C1: something of it is in working memory, or a window is open."""
        return bool(self.members) or self.windows > 0

    def contending(self) -> list[AB]:
        """Running and waiting ABs: linked ones hold nothing back."""
        return [ab for ab in self.members.values() if ab.phase != LINKED]

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
        self.policy = policy.partition(":")[0]
        self.first = policy.partition(":")[2]
        self.prima = self.policy == "prima"
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
        for place, record in enumerate(self.records):
            if record["phase"] == "end" and record["command"] == "iu":
                self.unit_ends[record["behavior"]] = record["time"]
            if "behavior" in record:
                self.last[base(record["behavior"])] = place
            if record["phase"] == "request":
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
        if (app, record.get("state")) in self.left:
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
        ab = self.abs[name] = AB(
            name=name,
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
        )
        tree.members[name] = ab
        if ab.parents:
            ab.phase = LINKED
        else:
            self._wait(ab)
        if record.get("order") == "now":
            self.urgent.append((app, ab.devices, self.place))
            self._maybe_silence(ab)

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
        for ab in list(tree.members.values()) if tree is not None else ():
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
        if ab.unit is None:
            if self.prima and ab.phase == WAITING:
                self._allowed(ab, record["behavior"])
            reaction = self._reaction_of(ab, record)
            self._run(ab)
            if self.prima:
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

    def _run(self, ab: AB) -> None:
        self.waiting.pop(ab.name, None)
        ab.phase = RUNNING
        ab.starts += 1
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
        if tree in self.floor:
            self.floor.remove(tree)
        self.floor.append(tree)

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
        if contending and all(ab.high and not other.high for other in contending):
            return None
        return holder

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

    def _busy(self, ab: AB) -> bool:
        """Whether a running AB occupies one of the devices (S1, U5)."""
        for other in self.running.values():
            if ab.devices & other.devices and other is not ab and not ab.inside(other):
                return True
        return False

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
            if self.free_to_go(ab) and not self._held_back(ab):
                self.report(5, "S1", f"{ab.shown} waits while its devices are free")
                if ab.cause is not None and not ab.leaves:
                    self.report(6, "S1", f"the reaction {ab.shown} is late")
        elif not any(self._ahead(other, ab) for other in self.waiting.values()):
            self.report(5, self.policy, f"{ab.shown} waits while its devices are free")

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
                if cut.was == RUNNING and not any(one.unit is ab.unit for one in near if one.unit):
                    self.report(2, "E1", f"{shown}, but nothing of its unit has failed")
            case "E5":
                if not (self.released or self.halted):
                    self.report(number, "E5", f"{shown} without an emergency")
            case rule:
                self.report(number, str(rule), f"{shown} by a rule that cancels nothing")


def check(records: Iterable[Record], policy: str = "prima") -> list[str]:
    """Violations of invariants 1 to 7 in a run; of 1 to 5 under a baseline policy.

    Under ``none`` invariant 1 is expected to fail: nothing keeps devices apart.
    """
    return Checker(records, policy).run()


def unfinished(records: Iterable[Record]) -> list[str]:
    """ABs that are still in working memory after the last record (for invariant 9)."""
    checker = Checker(records, "prima")
    checker.run()
    return [
        f"invariant 9: {ab.shown} of {ab.tree.name} is {ab.phase} at the end"
        for ab in checker.abs.values()
        if ab.phase != GONE
    ]


def numbers(violations: Iterable[str]) -> set[int]:
    """Which invariants are violated."""
    return {int(text.split()[1].rstrip(":")) for text in violations}
