"""Lateness: reactions that are given up (X8), and late answers (X8, X10)."""

from __future__ import annotations

from prima.invariants.memory import Memory
from prima.invariants.model import AB, WAITING, Record, ms
from prima.invariants.patience import answered_now

A_MOMENT = 5
"""Milliseconds by which a reaction that may start, but is outranked, may exceed its time."""
LATE = 2000
"""Milliseconds after a question's timeout within which the user may still begin to answer."""


def hears_surely(memory: Memory, ab: AB) -> None:
    """C3: count an end that certainly has a notice; leaving a unit could suppress it."""
    if not (memory.is_given_up(ab) or ab.silent or ab.unit):
        memory.owed[ab.tree.name] += 1


def hears_of(memory: Memory, ab: AB) -> None:
    """C3, O3, E2: an end opens a window, unless the AB was given up before."""
    if not memory.is_given_up(ab):
        memory.heard[ab.tree.name] += 1


def reaction_of(memory: Memory, ab: AB) -> AB | None:
    """The root, not yet started, of the reaction to which an AB belongs."""
    ab = ab.outermost
    while ab.parents:
        ab = memory.abs[min(ab.parents)]
    return ab if ab.phase == WAITING and ab.cause is not None else None


def comes_too_late(memory: Memory, ab: AB, was: str, root: AB | None, waited: list[AB]) -> None:
    """X8: it belongs to a reaction whose time is over; the rest of that reacts at once."""
    shown = f"{ab.shown} ({was}) is given up"
    if "x8" not in memory.extensions or root is None or root.fresh_until is None:
        memory.report(3, "X8", f"{shown}, but is of no reaction that has a time")
        return
    if root.fresh_until > memory.now:
        memory.report(3, "X8", f"{shown} before {root.fresh_until} ms")
    for other in waited:
        if other.phase == WAITING:
            other.cause, other.fresh_until = root.cause, memory.now


def fresh(memory: Memory, ab: AB) -> None:
    """X8 at the end of an instant: no reaction waits after its time."""
    if ab.cause is None or ab.fresh_until is None or "x8" not in memory.extensions:
        return
    if memory.now > ab.fresh_until + A_MOMENT:
        memory.report(16, "X8", f"{ab.shown} waits, but was worth it until {ab.fresh_until} ms")


def answered_early(memory: Memory, ab: AB, record: Record) -> None:
    """X8, X10: a question is answered before it was asked."""
    _may_be_answered(memory, ab, record["rule"])
    answered_now(memory, ab)
    hears_of(memory, ab)
    hears_surely(memory, ab)
    waited = [one for one in ab.tree.members.values() if ab.name in one.parents]
    for other in waited:
        other.parents |= ab.parents
    reacts = ab.cause is not None
    memory.remove(ab)
    for other in waited:
        if reacts and other.phase == WAITING:
            other.cause = memory.speech


def _may_be_answered(memory: Memory, ab: AB, rule: str) -> None:
    if rule not in ("X8", "X10") or rule.lower() not in memory.extensions:
        memory.report(3, str(rule), f"{ab.shown} is answered by a rule that is not on")
    if not ab.question or ab.phase not in (WAITING, "linked"):
        memory.report(3, str(rule), f"{ab.shown} is answered early, but it is {ab.phase}")
    if memory.speech_at != memory.now:
        memory.report(3, str(rule), f"{ab.shown} is answered, but nobody has said anything")
    if rule == "X8" and reaction_of(memory, ab) is None:
        memory.report(3, "X8", f"{ab.shown} is answered early, but is of no reaction that waits")


def note_speech(memory: Memory, record: Record) -> None:
    """X10: the application whose question the user answers just after its timeout."""
    if record["event"] != "speech" or record["actor"] != "user":
        return
    memory.speech_at, memory.speech = memory.now, record.get("serial")
    began = memory.now - ms((record.get("data") or {}).get("lasted", 0))
    late = [app for app, when in memory.lapsed if began - when <= LATE]
    if "x10" not in memory.extensions:
        late = []
    named = record.get("app") or ""
    if named and (record.get("rule") != "X10" or named not in late):
        memory.report(
            16, "X10", f"only {named} hears an utterance that answers none of its questions"
        )
    memory.late_app = late[0] if len(late) == len(memory.lapsed) == 1 else ""


def note_lapse(memory: Memory, record: Record) -> None:
    """X10: a question has timed out or was answered."""
    ab = memory.abs.get(record["behavior"])
    if ab is None or not ab.question:
        return
    if record["outcome"] == "noinput" and record.get("inbound"):
        before = memory.lapsed if ab.silent else []
        memory.lapsed = [*before, (ab.app, memory.now)]
        return
    late = memory.late_app if memory.speech_at == memory.now else ""
    if record["outcome"] == "filled" and late not in ("", ab.app):
        memory.report(16, "X10", f"{ab.shown} is answered by what {late} has asked")
