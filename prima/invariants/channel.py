"""The channel (K1), and events: sensing the user, and the causes of reactions (C5, E5)."""

from __future__ import annotations

from prima.invariants.memory import Memory
from prima.invariants.model import AB, Record, Tree

PATIENCE = 20_000
"""Milliseconds without a sight, word or touch of the user after which streams engage nobody (K1)."""


class Channel(Memory):
    """Inbound events, and their consequences for K1."""

    def note_event(self, record: Record) -> None:
        """An event: whether the user caused it (K1), and whether it may be a cause (C5)."""
        self.note_serial(record)
        name = record["event"]
        if name in ("human.found", "human.lost"):
            if self.in_view or name == "human.found":
                self.sensed_at = self.now
            self.in_view = name == "human.found"
        elif name == "speech" or record["actor"] == "user":
            self.sensed_at = self.now

    def note_serial(self, record: Record) -> None:
        """Note an event that reactions may name as their cause; event numbers are unique."""
        serial = record.get("serial")
        if serial is None:
            return
        if serial in self.serials:
            self.report(15, "C5", f"two events have the number {serial}")
        self.serials[serial] = self.now

    def note_emergency(self, record: Record) -> None:
        """E5: the record has the number that reactions to it refer to."""
        self.halted = record["outcome"] == "pressed"
        self.released = self.released or not self.halted
        if not self.halted and not (record.get("data") or {}).get("resume", True):
            for tree in self.trees.values():
                tree.hold = None  # X3 does not hold streams that the operator does not resume
        if record.get("serial") is None:
            self.report(15, "E5", f"the emergency stop is {record['outcome']} without a number")
        self.note_serial(record)

    def caused_rightly(self, ab: AB, record: Record) -> None:
        """C5: a reaction names an event of this instant; other requests name none."""
        cause = record.get("cause")
        if bool(record.get("reactive")) != (cause is not None):
            self.report(15, "C5", f"{ab.name} has the cause {cause}, reactive or not")
        elif cause is not None and self.serials.get(cause, -1) != self.now and self.numbered:
            self.report(
                15, "C5", f"{ab.name} reacts to {cause}, which did not happen in this instant"
            )

    @property
    def lapses_at(self) -> int:
        """When streams cease to engage the user, if the user is not sensed until then."""
        return self.sensed_at + PATIENCE

    @property
    def sensed(self) -> bool:
        """K1: whether the user was seen, heard or felt recently."""
        return self.in_view or self.now < self.lapses_at

    def refused_by_channel(self, ab: AB) -> Tree | None:
        """K1: the stream that engages the user, so that ABs that leave the user wait."""
        if ab.leaves:
            for tree in self.trees.values():
                if self.keeps_user(tree, ab):
                    return tree
        return None

    def keeps_user(self, tree: Tree, ab: AB) -> bool:
        """K1: whether a stream engages the user when another application's AB would leave them."""
        return tree.app != ab.app and tree.open and tree.engages(self.sensed)

    def channel_kept(self, ab: AB, shown: str) -> None:
        """Invariant 7 at a start."""
        tree = self.refused_by_channel(ab)
        if tree is not None:
            self.report(7, "K1", f"{shown} starts while {tree.name} engages the user")
        units = {other for other in self.running.values() if other.app != ab.app}
        self.started_leaving.append((shown, units))

    def channel_kept_inside(self) -> None:
        """K1 at the end of an instant: a unit's Command ranks before a loop (S2a)."""
        for shown, others in self.started_leaving:
            for inner in self.started_inside:
                engages = inner.engages and inner.tree.engages(self.sensed)
                if engages and any(inner.inside(unit) for unit in others):
                    self.report(
                        7, "K1", f"{shown} starts in the instant in which {inner.shown} engages"
                    )
