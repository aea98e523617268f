"""Failures: devices that fail or hang, units that take too long, absent users (E1, U5, K1)."""

from __future__ import annotations

from typing import Final

from prima.messages import Command, Notice
from prima.messages.times import earliest
from prima.scheduler.behavior import RUNNING, Behavior
from prima.scheduler.endings import (
    close_unit,
    delete,
    delete_rest,
    forget_effects,
    note_rolling,
    remove,
)
from prima.scheduler.mediation import Mediation
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.streams import let_go

HANG_MS: Final = 120_000
"""A Command fails if it runs this much longer than its own stated times (E1)."""
MS_A_LETTER: Final = 500
"""How long saying a letter may take at most."""


def e1(mediation: Mediation, ab: Behavior, event: str, reason: str, inbound: bool = False) -> None:
    """E1: a running AB fails; the rest of its tree is deleted unless given up before (O2, O3)."""
    mediation.recorder.behavior(
        "fail",
        ab,
        rule="E1",
        event=event,
        message=reason,
        device=event.rpartition(".")[2],
        inbound=inbound or None,
    )
    note_rolling(mediation, ab)
    forget_effects(ab)
    command = ab.command
    ab = _unit_that_fails(mediation, ab, event, reason)
    remove(mediation, ab)
    if ab.inserted or ab.silent:
        return  # the AB that it was inserted for, or its replacement, goes on without it
    delete_rest(mediation, _tree_of(ab), ab.run, "E1")
    if ab.run is not None:
        notice = Notice("failed", ab.run.number, command, event=event, message=reason)
        mediation.tell(ab.app, ab.stream, notice)


def _tree_of(ab: Behavior) -> dict[str, Behavior]:
    """E1, U5: whose rest is deleted with an AB: its stream's, or that of the spanning unit around it."""
    unit = ab.unit
    while unit is not None and not unit.spans:
        unit = unit.unit
    return ab.stream.members if unit is None else unit.inner


def _unit_that_fails(mediation: Mediation, ab: Behavior, event: str, reason: str) -> Behavior:
    """U4: in a group the unit is the AB that fails; a spanning unit is left to its author."""
    while ab.unit is not None and ab.unit.inside is not None and not ab.unit.spans:
        unit, inside = ab.unit, ab.unit.inside
        for inner in list(inside.members.values()):
            if inner is not ab:
                delete(mediation, inner, "E1")
        inside.open = True  # so that it does not settle as done
        remove(mediation, ab)
        ab = unit
        mediation.recorder.behavior("fail", ab, rule="E1", event=event, message=reason)
    return ab


def deadline(mediation: Mediation) -> int | None:
    """When the next unit, device or awaited event is overdue (ms)."""
    memory = mediation.memory
    late = [ab.late for ab in memory.running.values()]
    late += mediation.holds.values()
    if not mediation.halted:
        late += [_lapse(memory, mediation.absence), mediation.starving]
        late += [ab.stale for ab in memory.waiting.values()]
    return earliest(None, *late)


def _lapse(memory: WorkingMemory, absence: int) -> int | None:
    """K1: when the user will count as absent, if anything depends on it."""
    if memory.in_view or memory.absent or not memory.engaged:
        return None
    if not any(ab.leaves for ab in memory.waiting.values()):
        return None
    return memory.sensed + absence


def look_for_user(mediation: Mediation) -> None:
    """K1: a user who has not been seen, heard or felt for a while is no longer engaged."""
    memory = mediation.memory
    memory.absent = not memory.in_view and mediation.now - memory.sensed >= mediation.absence


def expire(mediation: Mediation) -> None:
    """U5, E1, X3: end what has run, or has been held, for too long."""
    now, running = mediation.now, mediation.memory.running
    for name in [name for name, due in mediation.holds.items() if due <= now]:
        let_go(mediation, mediation.memory.streams[name], "over")
    late = [ab for ab in running.values() if ab.late is not None and ab.late <= now]
    active = mediation.memory.active
    late.sort(key=lambda ab: (ab.app is not active, ab.app.order, ab.serial))  # V3
    for ab in late:
        if ab.name not in running:  # it ended with another one
            continue
        if ab.inside is not None:
            unit_timeout(mediation, ab)
        else:
            mediation.order("abort", ab)
            device = min(ab.devices, default="none")
            e1(mediation, ab, f"error.device.{device}", "The device did not end in time.")


def unit_timeout(mediation: Mediation, unit: Behavior) -> None:
    """U5: a unit has taken too long."""
    mediation.recorder.behavior("fail", unit, rule="U5", event="error.unit.timeout")
    number = next((key for key, ab in unit.app.units.items() if ab is unit), None)
    run, message = unit.run, "The unit took too long."
    if number is not None:
        close_unit(mediation, unit.app, number)
        notice = Notice("unit-timeout", number, event="error.unit.timeout", message=message)
        mediation.tell(unit.app, unit.stream, notice)
        return
    heard = not unit.silent
    unit.silent, unit.late = True, None
    for ab in reversed(list(unit.inner.values())):
        if ab.state is not RUNNING:
            delete(mediation, ab, "U5")
    if not heard:
        return  # its replacement goes on
    delete_rest(mediation, _tree_of(unit), run, "U5")
    awaited = run.number if run else 0
    notice = Notice("failed", awaited, event="error.unit.timeout", message=message)
    mediation.tell(unit.app, unit.stream, notice)


def set_deadlines(mediation: Mediation) -> None:
    """E1, U5, E6: note when the ABs that have just started will have run for too long."""
    for ab in mediation.started:
        if ab.command is not None:
            ab.late = mediation.now + allowance(ab)
        elif ab.group is not None and ab.group.longest is not None:
            longest = ab.group.longest
            if mediation.shared and "speaker" in ab.devices:
                longest = min(longest, mediation.longest_turn)
            ab.late = mediation.now + longest


def allowance(ab: Behavior) -> int:
    """How long an AB may run (ms): :data:`HANG_MS` beyond the times that it is given."""
    row, command = ab.type, ab.command
    assert row is not None and command is not None
    stated = [
        int(value) for name, value in command.args.items() if row.arguments[name].kind == "duration"
    ]
    return HANG_MS + row.lasts + sum(stated) + _saying_ms(command)


def _saying_ms(command: Command) -> int:
    """How long a text may take to say (ms): its letters at its slowest rate, and its cues."""
    slowest, times = 1.0, 0.0
    for cue in command.cues:
        if not isinstance(cue.value, int | float):
            continue
        if cue.kind == "rate":
            slowest = min(slowest, cue.value)
        else:
            times += cue.value
    return round(times + MS_A_LETTER * len(command.text or "") / slowest)
