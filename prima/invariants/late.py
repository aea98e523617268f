"""Lateness: reactions that are given up (X8), and late answers (X8, X10)."""

from __future__ import annotations

from prima.invariants.model import AB, WAITING, Record, ms
from prima.invariants.selection import Selection

A_MOMENT = 5
"""Milliseconds by which a reaction that may start, but is outranked, may exceed its time."""
LATE = 2000
"""Milliseconds after a question's timeout within which the user may still begin to answer."""


class Late(Selection):
    """X8 and X10."""

    def hears_surely(self, ab: AB) -> None:
        """C3: count an end that certainly has a notice; leaving a unit could suppress it."""
        if not (self.is_given_up(ab) or ab.silent or ab.unit):
            self.owed[ab.tree.name] += 1

    def hears_of(self, ab: AB) -> None:
        """C3, O3, E2: an end opens a window, unless the AB was given up before."""
        if not self.is_given_up(ab):
            self.heard[ab.tree.name] += 1

    def reaction_of(self, ab: AB) -> AB | None:
        """The root, not yet started, of the reaction to which an AB belongs."""
        ab = ab.outermost
        while ab.parents:
            ab = self.abs[min(ab.parents)]
        return ab if ab.phase == WAITING and ab.cause is not None else None

    def comes_too_late(self, ab: AB, was: str, root: AB | None, waited: list[AB]) -> None:
        """X8: it belongs to a reaction whose time is over; the rest of that reacts at once."""
        shown = f"{ab.shown} ({was}) is given up"
        if "x8" not in self.extensions or root is None or root.fresh_until is None:
            self.report(3, "X8", f"{shown}, but is of no reaction that has a time")
            return
        if root.fresh_until > self.now:
            self.report(3, "X8", f"{shown} before {root.fresh_until} ms")
        for other in waited:
            if other.phase == WAITING:
                other.cause, other.fresh_until = root.cause, self.now

    def fresh(self, ab: AB) -> None:
        """X8 at the end of an instant: no reaction waits after its time."""
        if ab.cause is None or ab.fresh_until is None or "x8" not in self.extensions:
            return
        if self.now > ab.fresh_until + A_MOMENT:
            self.report(16, "X8", f"{ab.shown} waits, but was worth it until {ab.fresh_until} ms")

    def answered_early(self, ab: AB, record: Record) -> None:
        """X8, X10: a question is answered before it was asked."""
        self._may_be_answered(ab, record["rule"])
        self.answered_now(ab)
        self.hears_of(ab)
        self.hears_surely(ab)
        waited = [one for one in ab.tree.members.values() if ab.name in one.parents]
        for other in waited:
            other.parents |= ab.parents
        reacts = ab.cause is not None
        self.remove(ab)
        for other in waited:
            if reacts and other.phase == WAITING:
                other.cause = self.speech

    def _may_be_answered(self, ab: AB, rule: str) -> None:
        if rule not in ("X8", "X10") or rule.lower() not in self.extensions:
            self.report(3, str(rule), f"{ab.shown} is answered by a rule that is not on")
        if not ab.question or ab.phase not in (WAITING, "linked"):
            self.report(3, str(rule), f"{ab.shown} is answered early, but it is {ab.phase}")
        if self.speech_at != self.now:
            self.report(3, str(rule), f"{ab.shown} is answered, but nobody has said anything")
        if rule == "X8" and self.reaction_of(ab) is None:
            self.report(3, "X8", f"{ab.shown} is answered early, but is of no reaction that waits")

    def note_speech(self, record: Record) -> None:
        """X10: the application whose question the user answers just after its timeout."""
        if record["event"] != "speech" or record["actor"] != "user":
            return
        self.speech_at, self.speech = self.now, record.get("serial")
        began = self.now - ms((record.get("data") or {}).get("lasted", 0))
        late = [app for app, when in self.lapsed if began - when <= LATE]
        if "x10" not in self.extensions:
            late = []
        named = record.get("app") or ""
        if named and (record.get("rule") != "X10" or named not in late):
            self.report(
                16, "X10", f"only {named} hears an utterance that answers none of its questions"
            )
        self.late_app = late[0] if len(late) == len(self.lapsed) == 1 else ""

    def note_lapse(self, record: Record) -> None:
        """X10: a question has timed out or was answered."""
        ab = self.abs.get(record["behavior"])
        if ab is None or not ab.question:
            return
        if record["outcome"] == "noinput" and record.get("inbound"):
            before = self.lapsed if ab.silent else []
            self.lapsed = [*before, (ab.app, self.now)]
            return
        late = self.late_app if self.speech_at == self.now else ""
        if record["outcome"] == "filled" and late not in ("", ab.app):
            self.report(16, "X10", f"{ab.shown} is answered by what {late} has asked")
