"""Patience (E6): ABs kept from the speaker for too long, recomputed from the records."""

from __future__ import annotations

from prima.invariants.model import AB, LINKED, WAITING, Record, base, ms
from prima.invariants.streams import Streams

SECONDS = 60
"""How long an application may keep another from the speaker by default."""


class Patience(Streams):
    """E6: how long others, and not rules, have kept each waiting AB from the speaker."""

    def _read_ahead(self) -> None:
        super()._read_ahead()
        head = self.records[0].get("data") or {} if self.records else {}
        self.patience = ms(head.get("patience", SECONDS))
        """The bound (ms); 0 if there is none."""
        self._kept: dict[str, int] = {}
        self._kept_now: set[str] = set()
        self._answered: dict[str, int] = {}
        """When the user last answered a question of each stream."""
        self._starving: set[str] = set()
        """The ABs that have been reported."""

    def pass_time(self, time: int) -> None:
        """Count the time that passes without changes."""
        for name in self._kept_now:
            self._kept[name] = self._kept.get(name, 0) + time - self.now

    def note_keepers(self) -> None:
        """At the end of an instant: note which ABs are kept from the speaker from now on."""
        self._kept = {name: time for name, time in self._kept.items() if self._waits(name)}
        self._starving = set(filter(self._waits, self._starving))
        self._kept_now = set()
        if self.halted:
            return
        waiting = {ab.name: ab for ab in self.waiting.values() if ab.unit is None}
        self._kept_now = {name for name, ab in waiting.items() if self._kept_from_speaker(ab)}
        for name in sorted((self._kept.keys() & waiting.keys()) - self._starving):
            if self.overdue(waiting[name]):
                self.report(13, "E6", f"{name} starves, and nothing says so")

    def _waits(self, name: str) -> bool:
        """Whether an AB has yet to start, be it behind a way back of its stream (X1)."""
        return self.abs[name].phase in (WAITING, LINKED)

    def _kept_from_speaker(self, ab: AB) -> bool:
        if not self.prima or "speaker" not in ab.devices or ab.cause is not None:
            return False
        by = ab.said[1] if ab.said is not None else ""
        if by.replace("#", ":").partition(":")[0] in ("", ab.app):
            return False  # its own application keeps it waiting
        if self.kept_by_floor(ab) or self.refused_by_channel(ab):
            return False
        speaks = [
            one for one in self.running.values() if one.unit is None and "speaker" in one.devices
        ]
        if speaks:
            return speaks[0].app != ab.app
        return self.refused_by_topic(ab) is not None

    def overdue(self, ab: AB) -> bool:
        """Whether others have kept it from the speaker for the maximum time."""
        return self.patience > 0 and self._kept.get(ab.name, 0) >= self.patience

    def its_turn(self, ab: AB) -> bool:
        """E6: whether it precedes all but reactions, since no response to an answer waits."""
        return self.overdue(ab) and not any(map(self._acknowledges, self.waiting.values()))

    def _acknowledges(self, ab: AB) -> bool:
        just = ab.followed_at == self.now == self._answered.get(ab.tree.name)
        return ab.unit is None and just and "speaker" in ab.devices and not ab.asks

    def note_answer(self, record: Record) -> None:
        """Note that a question was answered without a device's end."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is not None and ab.asks and not record.get("inbound"):
            self._answered[ab.tree.name] = self.now

    def answered_now(self, ab: AB) -> None:
        """X8, X10: a question was answered before it was asked."""
        self._answered[ab.tree.name] = self.now
        if ab.unit is None:
            self.answered_tree = ab.tree

    def note_starve(self, record: Record) -> None:
        """An AB recorded as starving is waiting, and by E6 for the required time."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.name not in self.waiting:
            self.report(13, "E6", f"{record['behavior']} is said to starve, but does not wait")
            return
        self._starving.add(ab.name)
        if record["rule"] == "E6" and not self.overdue(ab):
            self.report(13, "E6", f"{ab.name} is said to starve, but nobody kept it so long")
