"""The channel (K1), and events: sensing the user, and the causes of reactions (C5, E5)."""

from __future__ import annotations

from prima.invariants.memory import Memory
from prima.invariants.model import AB, Record, Tree

PATIENCE = 20_000
"""Milliseconds without a sight, word or touch of the user after which streams engage nobody (K1)."""


def note_event(memory: Memory, record: Record) -> None:
    """An event: whether the user caused it (K1), and whether it may be a cause (C5)."""
    note_serial(memory, record)
    name = record["event"]
    if name in ("human.found", "human.lost"):
        if memory.in_view or name == "human.found":
            memory.sensed_at = memory.now
        memory.in_view = name == "human.found"
    elif name == "speech" or record["actor"] == "user":
        memory.sensed_at = memory.now


def note_serial(memory: Memory, record: Record) -> None:
    """Note an event that reactions may name as their cause; event numbers are unique."""
    serial = record.get("serial")
    if serial is None:
        return
    if serial in memory.serials:
        memory.report(15, "C5", f"two events have the number {serial}")
    memory.serials[serial] = memory.now


def note_emergency(memory: Memory, record: Record) -> None:
    """E5: the record has the number that reactions to it refer to."""
    memory.halted = record["outcome"] == "pressed"
    memory.released = memory.released or not memory.halted
    if not memory.halted and not (record.get("data") or {}).get("resume", True):
        for tree in memory.trees.values():
            tree.hold = None  # X3 does not hold streams that the operator does not resume
    if record.get("serial") is None:
        memory.report(15, "E5", f"the emergency stop is {record['outcome']} without a number")
    note_serial(memory, record)


def caused_rightly(memory: Memory, ab: AB, record: Record) -> None:
    """C5: a reaction names an event of this instant; other requests name none."""
    cause = record.get("cause")
    if bool(record.get("reactive")) != (cause is not None):
        memory.report(15, "C5", f"{ab.name} has the cause {cause}, reactive or not")
    elif cause is not None and memory.serials.get(cause, -1) != memory.now and memory.numbered:
        memory.report(
            15, "C5", f"{ab.name} reacts to {cause}, which did not happen in this instant"
        )


def lapses_at(memory: Memory) -> int:
    """When streams cease to engage the user, if the user is not sensed until then."""
    return memory.sensed_at + PATIENCE


def sensed(memory: Memory) -> bool:
    """K1: whether the user was seen, heard or felt recently."""
    return memory.in_view or memory.now < lapses_at(memory)


def refused_by_channel(memory: Memory, ab: AB) -> Tree | None:
    """K1: the stream that engages the user, so that ABs that leave the user wait."""
    if ab.leaves:
        for tree in memory.trees.values():
            if keeps_user(memory, tree, ab):
                return tree
    return None


def keeps_user(memory: Memory, tree: Tree, ab: AB) -> bool:
    """K1: whether a stream engages the user when another application's AB would leave them."""
    engages = tree.app != ab.app and tree.open and tree.engages(sensed(memory))
    return engages and not _both_go_back(memory, tree, ab)


def _both_go_back(memory: Memory, tree: Tree, ab: AB) -> bool:
    """X1: whether the AB and all that the stream does next are ways back, or leave the user, too.

    If both streams have engaged the user, each way back would wait for the other.
    """
    coming = [one for one in tree.members.values() if one.contends]
    back = any(one.inserted for one in coming) and all(one.leaves for one in coming)
    return bool(ab.inserted) and back and ab.tree.engaged


def channel_kept(memory: Memory, ab: AB, shown: str) -> None:
    """Invariant 7 at a start."""
    tree = refused_by_channel(memory, ab)
    if tree is not None:
        memory.report(7, "K1", f"{shown} starts while {tree.name} engages the user")
    units = {other for other in memory.running.values() if other.app != ab.app}
    memory.started_leaving.append((shown, units))


def channel_kept_inside(memory: Memory) -> None:
    """K1 at the end of an instant: a unit's Command ranks before a loop (S2a)."""
    for shown, others in memory.started_leaving:
        for inner in memory.started_inside:
            engages = inner.engages and inner.tree.engages(sensed(memory))
            if engages and any(inner.inside(unit) for unit in others):
                memory.report(
                    7, "K1", f"{shown} starts in the instant in which {inner.shown} engages"
                )
