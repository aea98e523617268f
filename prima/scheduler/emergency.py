"""E5: the emergency stop ends everything at once, and nothing starts until it is released."""

from __future__ import annotations

from prima.scheduler.behavior import RUNNING, Behavior, Inside
from prima.scheduler.endings import delete, last_first, remove, settle, tell_cancelled
from prima.scheduler.mediation import Mediation
from prima.scheduler.starvation import forget_waits
from prima.scheduler.streams import let_go


def e5(mediation: Mediation, pressed: bool, resume: bool, serial: int) -> None:
    """E5: the stop is pressed, or released with or without resuming.

    Args:
        mediation: what is shared.
        pressed: whether it is pressed.
        resume: whether what was stopped resumes.
        serial: the number of the event by which applications are notified.
    """
    mediation.recorder.add(
        "emergency",
        "mediator",
        rule="E5",
        outcome="pressed" if pressed else "released",
        inbound=True,
        serial=serial,
        data=None if pressed else {"resume": resume},
    )
    mediation.halted = pressed
    if pressed:
        forget_waits(mediation)
        for ab in [one for one in mediation.memory.running.values() if one.unit is None]:
            halt(mediation, ab)
    elif not resume:
        _give_up(mediation)


def _give_up(mediation: Mediation) -> None:
    """Delete everything that was stopped."""
    memory = mediation.memory
    for name in list(mediation.holds):
        let_go(mediation, memory.streams[name], "left")
    for stream in memory.streams.values():
        stream.hold = None
    for ab in last_first(memory.behaviors.values()):
        if not ab.in_group:
            delete(mediation, ab, "E5")
            if not ab.silent:
                tell_cancelled(mediation, ab)


def _halt_inner(mediation: Mediation, inside: Inside, given_up: bool) -> None:
    """Stop what runs in a unit, without letting the unit settle as done meanwhile."""
    was_open, inside.open = inside.open, True
    for inner in list(inside.members.values()):
        if given_up:
            delete(mediation, inner, "E5")
        elif inner.state is RUNNING:
            halt(mediation, inner)
    inside.open = was_open


def halt(mediation: Mediation, ab: Behavior) -> None:
    """Stop a running AB; it waits to start again unless it is no longer wanted."""
    inside = ab.inside
    left = inside is not None and inside.spans and not inside.open
    given_up = ab.silent or left
    if inside is not None:
        _halt_inner(mediation, inside, given_up)
        if not (inside.members or inside.open or given_up):
            settle(mediation, ab)  # everything left of it had been given up
            return
    if ab.command is not None:
        mediation.order("abort", ab)
    outcome = "running" if given_up else "halted"
    mediation.recorder.behavior("cancel", ab, rule="E5", outcome=outcome)
    if given_up:
        remove(mediation, ab)
    else:
        mediation.memory.release(ab)
        mediation.memory.wait(ab)
