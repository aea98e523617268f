"""Waits of ABs: starving ones are reported, and those that want to speak get a turn.

The mediator counts the time between selections, in which nothing changes. The ranking that
follows from E6 is in :func:`prima.scheduler.rules.e6`.
"""

from __future__ import annotations

from typing import Final

from prima.messages.times import earliest
from prima.scheduler import rules
from prima.scheduler.behavior import Behavior, application
from prima.scheduler.mediation import Mediation

STARVING_LOOPS: Final = 20
"""A waiting AB is reported after this many loops of another's feedback Command (E4)."""


def e4(mediation: Mediation, ab: Behavior) -> bool:
    """E4: count the loops that other applications' ABs of equal priority have waited.

    Returns:
        Whether an AB has waited so long that it counts as a reaction from now on.
    """
    if ab.loop <= 1:
        return False
    bound, bounded = mediation.bound, []
    for other in mediation.memory.waiting.values():
        equal = other.priority == ab.priority and other.reaction is None
        if not (equal and _waits_for_loops(mediation, other, ab)):
            continue
        wait = other.wait
        wait.loops += 1
        if wait.loops == STARVING_LOOPS:
            wait.starves = True  # E6 need not report it again
            _report(mediation, other, "E4", ab.id, loop=STARVING_LOOPS)
        if bound is not None and wait.loops >= bound:
            bounded.append(other)
    for _, other in mediation.policy.ranked(bounded, mediation.memory, mediation.now):
        mediation.starved += 1
        other.reaction = -mediation.starved
    return bool(bounded)


def _waits_for_loops(mediation: Mediation, ab: Behavior, loop: Behavior) -> bool:
    """E4: whether an AB waits because of another application's feedback Command.

    It needs one of that one's devices, or its stream holds the floor (F2).
    """
    keeps = bool(ab.devices & loop.devices) or mediation.memory.holder is loop.stream
    return keeps and ab.app is not loop.app


def _report(mediation: Mediation, ab: Behavior, rule: str, by: str, **fields: object) -> None:
    mediation.recorder.add(
        "starve", "mediator", app=ab.app.name, behavior=ab.id, rule=rule, by=by, **fields
    )


def count_waits(mediation: Mediation) -> None:
    """E6: add the time since the previous selection, and report starving ABs."""
    most, now = mediation.patience, mediation.now
    for ab in mediation.memory.waiting.values():
        wait = ab.wait
        if wait.kept_since is not None:
            wait.kept += now - wait.kept_since
            wait.overdue = wait.kept >= most
        if wait.since is None or wait.starves:
            continue
        waited = max(now - wait.since, wait.kept)
        if waited >= most:
            wait.starves = True
            rule, by = wait.blocked
            rule = "E6" if wait.overdue else rule
            _report(mediation, ab, rule, by, data={"waited": waited / 1000})


def note_waits(mediation: Mediation) -> None:
    """E6: note which AB now waits because of which other, and when the next one will starve."""
    if not (mediation.patience and mediation.policy.floor):
        return
    due = [_due(mediation, ab) for ab in mediation.memory.waiting.values()]
    mediation.starving = earliest(None, *due)


def _due(mediation: Mediation, ab: Behavior) -> int | None:
    """When a waiting AB will starve (ms), if another application keeps it waiting."""
    wait, now = ab.wait, mediation.now
    wait.kept_since = None
    if application(wait.blocked[1]) == ab.app.name:
        wait.since = None
        return None
    if wait.since is None:
        wait.since = now
    waited = now - wait.since
    if rules.keeps_speaker(ab, mediation.memory):
        wait.kept_since = now
        waited = max(waited, wait.kept)
    return None if wait.starves else now + mediation.patience - waited


def forget_waits(mediation: Mediation) -> None:
    """E5: in an emergency no application keeps another waiting."""
    count_waits(mediation)
    for ab in mediation.memory.waiting.values():
        ab.wait.since = ab.wait.kept_since = None
