"""Ends: who may end what (invariants 2 and 3), by O2, O3, U5 and E1 to E5."""

from __future__ import annotations

from prima.invariants.late import Late
from prima.invariants.model import AB, GONE, LINKED, RUNNING, WAITING, Cut, Record, base


class Endings(Late):
    """What becomes of ABs that run, and why others are taken out."""

    def maybe_silence(self, urgent: AB) -> None:
        """O2: what runs on other devices finishes unheard, and nothing is recorded of that."""
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
                self.wait(ab)
                ab.followed_at = self.now
                if self.has_left(ab):
                    self.report(3, "O3", f"{ab.shown} goes on, but its state was left")
                return
            if not (self.has_left(ab) or ab.silent or ab.app in self.gone_apps):
                self.report(3, "U2", f"{ab.shown} ends before its goal, but its state goes on")
        self.hears_of(ab)
        if not (ab.silent or ab.inserted or ab.command == "iu" or ab.unit):
            self.hears_surely(ab)
        self.remove(ab)

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
            for inner in self.running.values():
                inner.silent = inner.silent or inner is ab or inner.inside(ab)
            return  # a unit out of time ends when the Command of it that runs has
        self._loop_over(ab)
        if not ab.inserted:  # what it was put in for goes on without it
            self.failed.append(ab)
        self.remove(ab)

    def _loop_over(self, ab: AB) -> None:
        """F5: a loop is over, and nothing moves the robot on unless something starts now."""
        if ab.moves and ab.unit is None:
            self.halting[ab.name] = ab

    def note_cancel(self, record: Record) -> None:
        """An AB is taken out of working memory."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase == GONE:
            self.report(3, "O2", f"{record['behavior']} is cancelled, but it is not there")
            return
        was, rule = ab.phase, record["rule"]
        if record["outcome"] == "answered":
            self.answered_early(ab, record)
            return
        if record["outcome"] == "halted":
            if was != RUNNING:
                self.report(3, "E5", f"{ab.shown} is halted, but it is {was}")
            if not self.halted:
                self.report(2, "E5", f"{ab.shown} is halted without an emergency stop")
            if was == RUNNING:
                self._loop_over(ab)
            self.wait(ab)
            return
        # What is taken out at once, a failed tree or a unit, may be told as it was before.
        behind = (
            rule in ("E1", "X2") and was == WAITING and self.now in (ab.followed_at, ab.freed_at)
        )
        if record["outcome"] not in ((was, LINKED) if behind else (was,)):
            self.report(13, rule, f"{ab.shown} is {was} when cancelled, not {record['outcome']}")
        # What the tree wanted when the first of it was taken out, and what it was asked since.
        devices = self.tree_devices.get(ab.tree.name, frozenset()).union(
            *(one.devices for one in ab.tree.members.values())
        )
        self.tree_devices[ab.tree.name] = devices
        self.cuts.append(Cut(ab, was, rule, self.place, devices))
        if was == RUNNING:
            self._loop_over(ab)
        late = self.reaction_of(ab) if rule == "X8" else None
        waited = [one for one in ab.tree.members.values() if ab.name in one.parents]
        self.remove(ab, ended=was == RUNNING)  # what ran has ended, cut short as it is
        if rule == "X8":
            self.comes_too_late(ab, was, late, waited)

    def justified(self, cut: Cut) -> None:
        """Invariants 2 and 3: why an AB was taken out of working memory."""
        ab, number = cut.ab, 2 if cut.was == RUNNING else 3
        shown = f"{ab.shown} ({cut.was}) is cancelled"
        whole = [other.ab for other in self.cuts if ab.inside(other.ab)]
        """Units that are cancelled with it: what is in them goes with them."""
        match cut.rule:
            case "O2":
                wanted = [
                    one.devices
                    for one, place in self.urgent
                    if one.app == ab.app and place > cut.place
                ]
                devices = ab.devices.union(*(unit.devices for unit in whole))
                if cut.was != RUNNING:
                    devices = cut.tree_devices
                if not any(one & devices for one in wanted):
                    self.report(number, "O2", f"{shown} without a Command wanted now")
            case "O3" | "E2":
                if cut.was == RUNNING and not ab.listening and not whole:
                    self.report(2, "O3", f"{shown}: it does not listen")
                if cut.rule == "O3":
                    if not self._given_up(cut):
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
            case "X8":
                pass  # looked at when it was cancelled
            case rule:
                self.report(number, str(rule), f"{shown} by a rule that cancels nothing")

    def _given_up(self, cut: Cut) -> bool:
        """O3: its state is left in this instant; of what ran, it or its application was left before."""
        ab = cut.ab
        if cut.was == RUNNING:
            return self.has_left(ab) or ab.app in self.gone_apps
        return (ab.app, ab.state) in self.left_now
