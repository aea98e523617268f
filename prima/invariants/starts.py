"""Starts: what may start, and the consequences."""

from __future__ import annotations

from prima.invariants.model import AB, GONE, RUNNING, WAITING, Record, base
from prima.invariants.telling import Telling


class Starts(Telling):
    """Checks each start against all rules that can keep an AB from starting."""

    def note_start(self, record: Record) -> None:
        """An AB, or a loop of it, starts."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None:
            self.report(3, "U1", f"{record['behavior']} starts and was never requested")
            return
        self.close_trees()
        self._may_run(ab, record)
        if self.halted:
            self.report(2, "E5", f"{record['behavior']} starts during the emergency stop")
        self._devices_free(ab, record["behavior"])
        self.started_by(ab, record)
        if ab.interrupted:
            self.starts_again(ab, record)
        if ab.unit is None:
            self._start_outside(ab, record)
        else:
            self._start_inside(ab, record)

    def _start_outside(self, ab: AB, record: Record) -> None:
        shown = record["behavior"]
        if self.prima and ab.phase == WAITING:
            self.allowed(ab, shown)
            self.decided_rightly(ab, shown)
        if not self.third_turn(ab):
            self.channel_connected(ab)
            self.stands_right(ab)
            self.words_said(ab)
        reaction = self._reaction_of(ab, record)
        aside = self.starts_aside(ab)
        beside = aside or self.carries_floor(ab)
        self._run(ab)
        if not aside:
            self.resume(ab)
        if not self.prima:
            ab.tree.suspended = False
            return
        if reaction is not None or not beside:
            self.take_floor(ab, reaction)
        self.note_words(ab)
        self.check_floor()

    def _start_inside(self, ab: AB, record: Record) -> None:
        unit = ab.unit
        assert unit is not None
        self.started_inside.append(ab)
        if unit.phase != RUNNING:
            self.report(4, "U5", f"{ab.shown} starts, but its unit {unit.shown} does not run")
        if self.prima and ab.leaves:
            self.channel_kept(ab, record["behavior"])
        self._run(ab)

    def _run(self, ab: AB) -> None:
        self.waiting.pop(ab.name, None)
        if not ab.starts:  # what starts again still reacts to the same event
            ab.reacted = ab.cause
        if self.third_turn(ab):  # it precedes all waiting reactions (X7)
            ab.reacted = max(one.cause or 0 for one in (ab, *self.waiting.values()))
        self.turn = None if ab is self.turn else self.turn
        ab.phase = RUNNING
        ab.starts += 1
        ab.started, ab.started_at = self.place, self.now
        ab.loop += 1 if ab.feedback else 0
        ab.cause = ab.fresh_until = None
        ab.listening = False
        self.running[ab.name] = ab
        self.driven = self.driven or ab.drives
        ab.tree.started = self.place
        ab.tree.spoken = ab.tree.spoken or (ab.says and ab.command != "iu")
        ab.tree.engaged = ab.tree.engaged or ab.engages

    def _may_run(self, ab: AB, record: Record) -> None:
        """Invariants 3 and 4: requested, not over, not running, and its parents have ended."""
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
        """The event that a starting AB reacts to. E4's bound makes a starving AB a reaction."""
        if ab.cause is None and record.get("reactive"):
            self.extra_reactions -= 1
            return self.extra_reactions
        return ab.cause
