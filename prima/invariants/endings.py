"""Ends: what may end ABs (invariants 2 and 3), by O2, O3, U5 and E1 to E5."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from prima.invariants.late import Late
from prima.invariants.model import AB, GONE, LINKED, RUNNING, WAITING, Cut, Record, Tree, base

Fault = tuple[int | None, str, str]
"""The invariant that a cancellation violates, by default that of its AB's phase, a rule, a text."""


def _shown(cut: Cut) -> str:
    return f"{cut.ab.shown} ({cut.was}) is cancelled"


class Endings(Late):
    """How running ABs end, and why others are removed."""

    def maybe_silence(self, urgent: AB) -> None:
        """O2: ABs that run on other devices finish without a notice, which is not recorded."""
        for tree in self.trees.values():
            devices = self.tree_devices.get(tree.name, frozenset()).union(
                *(ab.devices for ab in tree.members.values() if ab is not urgent)
            )
            if tree.app == urgent.app and devices & urgent.devices:
                for ab in tree.members.values():
                    ab.silent = ab.silent or ab.phase == RUNNING

    def note_end(self, record: Record) -> None:
        """An AB, or a loop of it, ends."""
        ab = self.running_one(record, "ends")
        if ab is None:
            return
        self.moved(ab, record)
        inner = [other for other in self.running.values() if other.inside(ab)]
        if inner:
            self.report(2, "U5", f"{ab.shown} ends while {inner[0].shown} runs in it")
        if ab.feedback and not record["goal"]:
            self._loop_over(ab)
            if record["outcome"] == "again":
                self._goes_on(ab)
                return
            if not (self.is_given_up(ab) or ab.silent):
                self.report(3, "U2", f"{ab.shown} ends before its goal, but its state goes on")
        self.hears_of(ab)
        if not (ab.inserted or ab.command == "iu"):
            self.hears_surely(ab)
        self.remove(ab)

    def note_over(self, record: Record) -> None:
        """E2: the run is over once all applications and the ABs that they left have ended."""
        if record["outcome"] == "over":
            for ab in self.running.values():
                self.report(2, "E2", f"{ab.shown} still runs as the run ends")

    def _goes_on(self, ab: AB) -> None:
        """U2: a loop has ended, and the next one waits."""
        self.wait(ab)
        ab.followed_at = self.now
        if self.has_left(ab):
            self.report(3, "O3", f"{ab.shown} goes on, but its state was left")
        if ab.last_loop:
            self.report(3, "E1", f"{ab.shown} goes on, but its tree has failed")

    def note_fail(self, record: Record) -> None:
        """A request or an AB fails (E1)."""
        if not record.get("behavior"):
            self.refused.add(record["app"])
            return  # E3: refused before it entered working memory
        ab = self.abs.get(base(record["behavior"]))
        # A unit fails with the Command in it (U4); it is running then as well.
        ab = self.running_one(record, "fails") if ab is not None else None
        if ab is None:
            return
        self.hears_of(ab)
        if record["rule"] == "U5":
            if ab.name in self.groups:  # of another unit, its author handles the error
                self._ends_loops(ab)
            for inner in self.running.values():
                inner.silent = inner.silent or inner is ab or inner.inside(ab)
            return  # a unit out of time ends when its running Command has
        self._loop_over(ab)
        if not ab.inserted:  # the AB that it was inserted for goes on without it
            self.failed.append(ab)
            self._ends_loops(ab)
        self.remove(ab)

    def _ends_loops(self, failed: AB) -> None:
        """E1: the loops of a failed tree end, unless the AB had been given up before (O2, O3)."""
        surely = not (failed.silent or self.is_given_up(failed) or failed.unit)
        for ab in failed.tree.members.values():
            if ab.feedback and ab.phase == RUNNING and not ab.inserted:
                ab.silent = True
                ab.last_loop = ab.last_loop or surely

    def _loop_over(self, ab: AB) -> None:
        """F5: a loop is over: the robot moves on only if something starts now."""
        if ab.moves and ab.unit is None:
            self.halting[ab.name] = ab

    def note_cancel(self, record: Record) -> None:
        """An AB is removed from working memory."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase == GONE:
            self.report(3, "O2", f"{record['behavior']} is cancelled, but it is not there")
        elif record["outcome"] == "answered":
            self.answered_early(ab, record)
        elif record["outcome"] == "halted":
            self._halted(ab)
        else:
            self._cancelled(ab, record)

    def _cancelled(self, ab: AB, record: Record) -> None:
        was, rule = ab.phase, record["rule"]
        # ABs of a tree or unit removed together may be recorded with their former state.
        lately = was == WAITING and self.now in (ab.followed_at, ab.freed_at)
        told = {was, LINKED} if rule in ("E1", "X2") and lately else {was}
        if was == LINKED and ab.joined_at == self.now:
            told.add(WAITING)  # until the selection it does not wait for the way back
        if record["outcome"] not in told:
            self.report(13, rule, f"{ab.shown} is {was} when cancelled, not {record['outcome']}")
        self.cuts.append(Cut(ab, was, rule, self.place, self._wanted(ab.tree)))
        if was == RUNNING:
            self._loop_over(ab)
        late = self.reaction_of(ab) if rule == "X8" else None
        waited = [one for one in ab.tree.members.values() if ab.name in one.parents]
        self.remove(ab, ended=was == RUNNING)  # what ran has ended, even if cut short
        if rule == "X8":
            self.comes_too_late(ab, was, late, waited)

    def _wanted(self, tree: Tree) -> frozenset[str]:
        """The devices that a tree wanted when its first AB was removed, and has requested since."""
        there = [one.devices for one in tree.members.values()]
        devices = self.tree_devices.get(tree.name, frozenset()).union(*there)
        self.tree_devices[tree.name] = devices
        return devices

    def _halted(self, ab: AB) -> None:
        """E5: the emergency stop ends an AB, which then waits."""
        if ab.phase == RUNNING:
            self._loop_over(ab)
        else:
            self.report(3, "E5", f"{ab.shown} is halted, but it is {ab.phase}")
        if not self.halted:
            self.report(2, "E5", f"{ab.shown} is halted without an emergency stop")
        self.wait(ab)

    def justified(self, cut: Cut) -> None:
        """Invariants 2 and 3: why an AB was removed from working memory."""
        reasons: dict[str, Callable[[Cut], Iterator[Fault]]] = {
            "O2": self._for_something_urgent,
            "O3": self._as_state_was_left,
            "E2": self._as_application_ended,
            "U5": self._as_unit_ended,
            "E1": self._as_tree_failed,
            "X2": self._as_unit_gave_way,
            "E5": self._in_emergency,
        }
        if cut.rule == "X8":
            return  # checked when it was cancelled
        number = 2 if cut.was == RUNNING else 3
        if cut.rule not in reasons:
            text = f"{_shown(cut)} by a rule that cancels nothing"
            self.report(number, cut.rule, text)
            return
        for only, rule, text in reasons[cut.rule](cut):
            self.report(only or number, rule, f"{_shown(cut)}{text}")

    def _units_cut(self, cut: Cut) -> list[AB]:
        """Units that are cancelled with it, along with their contents."""
        return [other.ab for other in self.cuts if cut.ab.inside(other.ab)]

    def _for_something_urgent(self, cut: Cut) -> Iterator[Fault]:
        """O2: a Command with ``now`` needs a device of it, or of its tree if it did not run."""
        devices = cut.tree_devices
        if cut.was == RUNNING:
            devices = cut.ab.devices.union(*(unit.devices for unit in self._units_cut(cut)))
        later = [one for one, place in self.urgent if place > cut.place]
        if not any(one.app == cut.ab.app and one.devices & devices for one in later):
            yield None, "O2", " without a Command wanted now"

    def _only_listens(self, cut: Cut) -> Iterator[Fault]:
        """O3, E2: running ABs go on, unless they listen or their unit is cancelled."""
        if cut.was == RUNNING and not cut.ab.listening and not self._units_cut(cut):
            yield 2, "O3", ": it does not listen"

    def _as_state_was_left(self, cut: Cut) -> Iterator[Fault]:
        yield from self._only_listens(cut)
        if not self._given_up(cut):
            yield None, "O3", ", but its state goes on"

    def _as_application_ended(self, cut: Cut) -> Iterator[Fault]:
        yield from self._only_listens(cut)
        if cut.ab.app not in self.unloaded:
            yield None, "E2", f", but {cut.ab.app} goes on"

    def _as_unit_ended(self, cut: Cut) -> Iterator[Fault]:
        if cut.was == RUNNING and not cut.ab.listening:
            yield 2, "U5", ": it does not listen"

    def _as_tree_failed(self, cut: Cut) -> Iterator[Fault]:
        near = [one for one in self.failed if one.tree is cut.ab.tree]
        if not near:
            yield None, "E1", ", but nothing of its tree has failed"
        if cut.was == RUNNING and not any(cut.ab.inside(one.unit) for one in near if one.unit):
            yield 2, "E1", ", but nothing of its unit has failed"

    def _as_unit_gave_way(self, cut: Cut) -> Iterator[Fault]:
        if not any(cut.ab.inside(unit) for unit, _, _ in self.gave_way):
            yield None, "X2", ", but no unit around it is interrupted"

    def _in_emergency(self, _cut: Cut) -> Iterator[Fault]:
        if not (self.released or self.halted):
            yield None, "E5", " without an emergency"

    def _given_up(self, cut: Cut) -> bool:
        """O3: its state is left in this instant or, if it ran, it or its application before."""
        ab = cut.ab
        if cut.was == RUNNING:
            return self.is_given_up(ab)
        return (ab.app, ab.state) in self.left_now
