"""Selection: what goes first (S2), what is held back (S3), and what need not wait (S1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from prima.invariants.model import AB, RUNNING, WAITING, Record, base
from prima.invariants.patience import Patience

RULES = ("S2a", "X7", "S2b", "E6", "S2c", "S2d", "S2e", "S2f")
MANY = 8
"""If more ABs wait, not all need to be checked."""


class Selection(Patience):
    """Rules S1 to S3, by the numbers that S2 compares."""

    def active_app(self) -> str | None:
        """S2b: the active stream's application: the floor's, else of the open one started last."""
        if self.holder is not None:
            return self.holder.app
        begun = [tree for tree in self.trees.values() if tree.open and tree.started >= 0]
        return max(begun, key=lambda tree: tree.started).app if begun else None

    def key(self, ab: AB) -> tuple[Any, ...]:
        """S2a to S2f, then the order of requests."""
        reaction: tuple[int, int, bool] = (1, 0, False)
        if ab.cause is not None:
            reaction = (0, -ab.cause, ab.app != self.active_app())
        return (
            not ab.high,
            not self.third_turn(ab),
            reaction,
            not self.its_turn(ab),
            ab.followed_at != self.now,
            -ab.tree.rank,
            ab.requested,
            self.apps.get(ab.app, 0),
            ab.place,
        )

    def rule_between(self, ab: AB, other: AB) -> str:
        """The first part of S2 in which two ABs differ."""
        pairs = zip(self.key(ab), self.key(other), strict=True)
        index = next((index for index, (one, two) in enumerate(pairs) if one != two), len(RULES))
        return RULES[index] if index < len(RULES) else "S2e"

    def outranks(self, ab: AB, other: AB) -> bool:
        """S2: whether the first goes before the second."""
        return self.key(ab) < self.key(other)

    def competing(self, ab: AB) -> list[AB]:
        """All other ABs that wait, outside units and not because of this one (X2), sorted by S2."""
        aside = [one for one, by, _ in self.gave_way if by is ab]
        others = [
            one
            for one in self.waiting.values()
            if one is not ab and one.unit is None and one not in aside
        ]
        return sorted(others, key=self.key)

    def free_to_go(self, ab: AB) -> bool:
        """Whether F2, F6, K1 and X7 are certain to let a waiting AB start."""
        kept = self.refused_by_floor(ab) or self.refused_by_topic(ab) or self.refused_by_channel(ab)
        return kept is None and self.refused_by_turn(ab) is None

    def keeps_devices(self, ab: AB) -> bool:
        """S3: whether it holds its devices back from lower-ranked ABs while it waits."""
        return ab.cause is not None or self.overdue(ab) or self.third_turn(ab)

    def held_back(self, ab: AB, winner: AB | None = None, surely: bool = True) -> bool:
        """S3: whether a reaction that outranks it needs one of its devices, and may start.

        When determining what could start instead of a winner, the winner holds nothing back.
        ``surely`` says how to read F2 for reactions for which it is open.
        """
        return any(
            other is not winner
            and self.keeps_devices(other)
            and other.devices & ab.devices
            and self.outranks(other, ab)
            and self.refused_by_turn(other) is None
            and self.refused_by_floor(other, surely) is None
            and self.refused_by_channel(other) is None
            for other in self.competing(ab)
        )

    def could_start(self, ab: AB, winner: AB, surely: bool = True) -> bool:
        """S1: whether nothing keeps a waiting AB from starting instead of another."""
        return self.kept_by_s3(ab) and not self.held_back(ab, winner, surely)

    def kept_by_s3(self, ab: AB) -> bool:
        """Whether nothing but S3 can keep a waiting AB from starting."""
        return self.occupant(ab) is None and self.free_to_go(ab)

    def busy(self, ab: AB) -> bool:
        """Whether a running AB occupies one of the devices, and keeps it (S1, U5, X2)."""
        return any(
            ab.devices & other.devices
            and other is not ab
            and not ab.inside(other)
            and not self.composes(ab, other)
            and not self.gives_way(other, ab)
            for other in self.running.values()
        )

    # At a start ---------------------------------------------------------------------

    def allowed(self, ab: AB, shown: str) -> None:
        """Invariants 5, 6, 7 and 12: no AB that could start instead outranks it."""
        holder = self.refused_by_floor(ab, surely=True)
        if holder is not None:
            number = 7 if ab.leaves else 5
            self.report(number, "F2", f"{shown} starts while {holder.name} holds the floor")
        turn = self.refused_by_turn(ab)
        if turn is not None:
            self.report(16, "X7", f"{shown} speaks between an answer and {turn.shown}")
        topic = self.refused_by_topic(ab)
        if topic is not None:
            self.report(5, "F6", f"{shown} speaks into the topic of {topic.name}")
        if ab.leaves:
            self.channel_kept(ab, shown)
        for other in self.competing(ab):
            if self.outranks(other, ab) and self.free_to_go(other):
                self._passed_over(other, ab, shown)

    def _passed_over(self, other: AB, ab: AB, shown: str) -> None:
        """S2, S3: ABs that outrank the starting one must be unable to start instead."""
        rule = self.rule_between(other, ab)
        if self.keeps_devices(other) and other.devices & ab.devices:
            # S3: it holds this device back whether or not its other devices are free.
            number = 5 if other.leaves else 6
            self.report(number, "S3", f"{shown} starts before the reaction {other.shown}")
        elif self.could_start(other, ab):
            number = 5 if rule in ("S2a", "S2b") and other.devices & ab.devices else 12
            self.report(number, rule, f"{shown} starts before {other.shown}, which outranks it")

    def admitted_by(self, ab: AB) -> str:
        """The rule by which an AB without competitors starts."""
        holder = self.holder
        running = self.running.values()
        if any(self.composes(ab, one) and ab.devices & one.devices for one in running):
            return "X5"
        if self.carries_floor(ab):
            return "X5"
        if self.third_turn(ab) and self.kept_otherwise(ab):
            return "X7"
        if holder is not None and holder.app != ab.app:
            return "F2"
        return "S4" if self.running else "S1"

    def started_by(self, ab: AB, record: Record) -> None:
        """A start has the rule of its decision; inside a unit, without a decision, the unit's."""
        decision, shown = self.decision, record["behavior"]
        if ab.unit is not None:
            expected = "U4" if ab.unit.name in self.groups else "U5"
        elif decision is not None and decision["winner"] == shown:
            expected = decision["rule"]
        else:
            return  # a missing decision is found elsewhere
        if record["rule"] != expected:
            self.report(13, "S1", f"{shown} starts by {expected}, not {record['rule']}")

    def decided_rightly(self, ab: AB, shown: str) -> None:
        """The ``decision`` before a start: its losers, and the rule that decided."""
        decision, self.decision = self.decision, None
        if decision is None or decision["winner"] != shown:
            self.report(13, "S2", f"{shown} starts, but nobody has decided so")
            return
        rivals = [other for other in self.competing(ab) if self.could_start(other, ab)]
        needed = {  # those that cannot run beside it (S1)
            other.shown
            for other in rivals
            if other.devices & ab.devices and not self.composes(ab, other)
        }
        self._check_losers(ab, shown, decision, needed)
        named = {*decision["losers"], *needed}
        rivals = [other for other in rivals if other.shown in named]
        readings = [one[0] for one in (rivals, self._perhaps(ab, decision["losers"])) if one]
        self._check_rule(ab, shown, decision["rule"], readings)

    def _perhaps(self, ab: AB, losers: Sequence[str]) -> list[AB]:
        """The losers of a decision to which F2 is open."""
        named = [other for other in self.competing(ab) if other.shown in losers]
        return [other for other in named if self.could_start(other, ab, surely=False)]

    def _check_losers(self, ab: AB, shown: str, decision: Record, needed: set[str]) -> None:
        """S2: the losers could have started; all are named, up to the limit."""
        losers, count = set(decision["losers"]), decision["losers_count"]
        allowed = {other.shown for other in self.competing(ab) if self.kept_by_s3(other)}
        if strangers := losers - allowed:
            text = f"{shown} is said to start before {sorted(strangers)}"
            self.report(13, "S2", f"{text}, which could not have started")
        elif count <= MANY and (needed - losers or len(losers) != count):
            text = f"{shown} is said to start before {decision['losers']}"
            self.report(13, "S2", f"{text}, {count}, not {sorted(needed)}")
        elif count > MANY and (len(losers) != MANY or not len(needed) <= count <= len(allowed)):
            self.report(13, "S2", f"{shown} is said to start before {count}, not {len(needed)}")

    def _check_rule(self, ab: AB, shown: str, rule: str, readings: list[AB]) -> None:
        """S2: the rule decided between the winner and the first rival, by a reading of F2."""
        if not readings:
            expected = self.admitted_by(ab)
            if rule != expected:
                self.report(13, "S2", f"{shown} starts by {rule}, without losers, not {expected}")
        elif not any(self._decides(rule, ab, rival) for rival in readings):
            expected = self.rule_between(ab, readings[0])
            text = f"{shown} starts before {readings[0].shown} by {expected}, not {rule}"
            self.report(13, "S2", text)

    def _decides(self, rule: str, ab: AB, rival: AB) -> bool:
        """S2: whether it is the rule that decided between the two."""
        expected = self.rule_between(ab, rival)
        alike = ("S2e", "S2f") if rival.app == ab.app else ()
        return rule == expected or {rule, expected} <= set(alike)

    # At the end of an instant -------------------------------------------------------

    def waits_rightly(self, ab: AB) -> None:
        """Invariant 5: no waiting AB waits while it may start."""
        if ab.unit is not None:
            if ab.unit.phase == RUNNING and (self.policy == "none" or self.occupant(ab) is None):
                self.report(5, "U5", f"{ab.shown} waits in {ab.unit.shown} on free devices")
        elif self.policy == "none":
            self.report(5, "none", f"{ab.shown} waits, though nothing mediates")
        elif self.prima:
            self.late(ab)
            self.waits_suspended(ab)
            if len(self.waiting) <= MANY:
                self._check_reason(ab)
        elif not self.busy(ab) and not any(self._ahead(one, ab) for one in self.waiting.values()):
            self.report(5, self.policy, f"{ab.shown} waits while its devices are free")

    def late(self, ab: AB) -> None:
        """Invariants 5 and 6: an AB that could start by now does not wait."""
        if self.free_to_go(ab) and not self.held_back(ab) and not self.busy(ab):
            if self.occupant(ab) is None:
                self.report(5, "S1", f"{ab.shown} waits while its devices are free")
            if ab.cause is not None and not ab.leaves:
                self.report(6, "S1", f"the reaction {ab.shown} is late")

    def _check_reason(self, ab: AB) -> None:
        """An AB's latest ``hold`` says why it waits, and is true as long as it does."""
        if ab.said is None:
            if not ab.interrupted:  # its own record says it
                self.report(13, "S1", f"nothing says why {ab.shown} waits")
            return
        rule, by, when = ab.said
        if not self._held_by(ab, rule, by):
            still = "" if when == self.now else "still "
            self.report(13, rule, f"{ab.shown} is {still}said to wait by {rule} for {by}")

    def _held_by(self, ab: AB, rule: str, by: str) -> bool:
        """Whether a reason for a wait is true."""
        if rule == "F2":
            kept = self.refused_by_floor(ab, surely=False)
            return kept is not None and by == kept.name
        if rule == "K1":  # a stream other than the first that keeps it may be named
            tree = self.trees.get(by)
            return ab.leaves and tree is not None and self.keeps_user(tree, ab)
        other = self.abs.get(base(by))
        return other is not None and self._held_by_ab(ab, rule, other)

    def _held_by_ab(self, ab: AB, rule: str, other: AB) -> bool:
        match rule:
            case "S1":
                return other.phase == RUNNING and bool(other.devices & ab.devices)
            case "S3":
                waits = other.phase == WAITING and self.keeps_devices(other)
                return waits and bool(other.devices & ab.devices)
            case "X7":
                return other is self.refused_by_turn(ab)
            case "F6":
                return self.keeps_topic(other, ab)
        return False

    def _ahead(self, other: AB, ab: AB) -> bool:
        """Baselines: whether another waiting AB may rank first and hold back a device."""
        if other is ab or other.unit is not None or not other.devices & ab.devices:
            return False
        if self.policy == "fair":
            return True  # the turn depends on more than these two
        if self.policy == "fixed":
            top = self.first or min(self.apps, key=self.apps.__getitem__)
            if (other.app == top) != (ab.app == top):
                return other.app == top
        return other.requested <= ab.requested

    def note_hold(self, record: Record) -> None:
        """A record says why an AB waits."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase != WAITING:
            self.report(13, "S1", f"{record['behavior']} is said to wait, but does not")
        elif ab.shown != record["behavior"]:
            self.report(13, "S1", f"{record['behavior']} is said to wait, but {ab.shown} does")
        else:
            ab.said = (record["rule"], record.get("by") or "", self.now)
