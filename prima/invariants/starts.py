"""Starts: what may start, and the consequences."""

from __future__ import annotations

from prima.invariants.channel import channel_kept
from prima.invariants.extensions import (
    channel_connected,
    close_trees,
    note_resumed,
    stands_right,
    starts_again,
    words_said,
)
from prima.invariants.floor import carries_floor, check_floor, resume, starts_aside, take_floor
from prima.invariants.memory import Memory
from prima.invariants.model import AB, GONE, RUNNING, WAITING, Record, base
from prima.invariants.selection import allowed, decided_rightly, started_by


def note_start(memory: Memory, record: Record) -> None:
    """An AB, or a loop of it, starts."""
    ab = memory.abs.get(base(record["behavior"]))
    if ab is None:
        memory.report(3, "U1", f"{record['behavior']} starts and was never requested")
        return
    close_trees(memory)
    _may_run(memory, ab, record)
    if memory.halted:
        memory.report(2, "E5", f"{record['behavior']} starts during the emergency stop")
    _devices_free(memory, ab, record["behavior"])
    started_by(memory, ab, record)
    if ab.interrupted:
        starts_again(memory, ab, record)
    if ab.unit is None:
        _start_outside(memory, ab, record)
    else:
        _start_inside(memory, ab, record)


def _start_outside(memory: Memory, ab: AB, record: Record) -> None:
    shown = record["behavior"]
    if memory.prima and ab.phase == WAITING:
        allowed(memory, ab, shown)
        decided_rightly(memory, ab, shown)
    response, now = memory.third_turn(ab), ab.begins_now
    if not response:
        channel_connected(memory, ab)
        stands_right(memory, ab)
        words_said(memory, ab)
    reaction = _reaction_of(memory, ab, record)
    aside = starts_aside(memory, ab)
    beside = aside or carries_floor(memory, ab)
    _run(memory, ab)
    if not aside:
        resume(memory, ab)
    if not memory.prima:
        ab.tree.suspended = False
        return
    if reaction is not None or not beside:
        take_floor(memory, ab, reaction)
    note_resumed(memory, ab, response, now)
    check_floor(memory)


def _start_inside(memory: Memory, ab: AB, record: Record) -> None:
    unit = ab.unit
    assert unit is not None
    memory.started_inside.append(ab)
    if unit.phase != RUNNING:
        memory.report(4, "U5", f"{ab.shown} starts, but its unit {unit.shown} does not run")
    if memory.prima and ab.leaves:
        channel_kept(memory, ab, record["behavior"])
    _run(memory, ab)


def _run(memory: Memory, ab: AB) -> None:
    memory.waiting.pop(ab.name, None)
    if not ab.starts:  # what starts again still reacts to the same event
        ab.reacted = ab.cause
    if memory.third_turn(ab):  # it precedes all waiting reactions (X7)
        ab.reacted = max(one.cause or 0 for one in (ab, *memory.waiting.values()))
    memory.turn = None if ab is memory.turn else memory.turn
    ab.phase = RUNNING
    ab.starts += 1
    ab.started, ab.started_at = memory.place, memory.now
    ab.loop += 1 if ab.feedback else 0
    ab.cause = ab.fresh_until = None
    ab.listening = False
    memory.running[ab.name] = ab
    memory.driven = memory.driven or ab.drives
    ab.tree.started = memory.place
    ab.tree.spoken = ab.tree.spoken or (ab.says and ab.command != "iu")
    ab.tree.engaged = ab.tree.engaged or ab.engages


def _may_run(memory: Memory, ab: AB, record: Record) -> None:
    """Invariants 3 and 4: requested, not over, not running, and its parents have ended."""
    shown = record["behavior"]
    if ab.phase == GONE:
        memory.report(3, "U1", f"{shown} starts again: it was over")
    elif ab.phase == RUNNING:
        memory.report(3, "U1", f"{shown} starts and runs already")
    if ab.parents:
        memory.report(4, "U3", f"{shown} starts before {', '.join(sorted(ab.parents))} has ended")
    expected = f"{ab.name}.{ab.loop + 1}" if ab.feedback else ab.name
    if shown != expected:
        memory.report(3, "U2", f"{shown} starts where {expected} was due")
    if frozenset(record["devices"]) != ab.devices or record["tree"] != ab.tree.name:
        memory.report(3, "U1", f"{shown} starts as something else than was requested")
    if ab.app in memory.gone_apps and ab.unit is None:
        memory.report(3, "E2", f"{shown} starts, but {ab.app} has ended")


def _devices_free(memory: Memory, ab: AB, shown: str) -> None:
    """Invariant 1; a unit's own Commands run on its devices."""
    for other in memory.occupants(ab):
        what = ", ".join(sorted(ab.devices & other.devices))
        memory.report(1, "S1", f"{shown} starts while {other.shown} runs on {what}")


def _reaction_of(memory: Memory, ab: AB, record: Record) -> int | None:
    """The event that a starting AB reacts to. E4's bound makes a starving AB a reaction."""
    if ab.cause is None and record.get("reactive"):
        memory.extra_reactions -= 1
        return memory.extra_reactions
    return ab.cause
