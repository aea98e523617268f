"""Patience (E6): ABs kept from the speaker for too long, recomputed from the records."""

from __future__ import annotations

from prima.invariants.channel import refused_by_channel
from prima.invariants.floor import kept_by_floor, refused_by_topic
from prima.invariants.memory import Memory
from prima.invariants.model import AB, LINKED, WAITING, Record, base


def pass_time(memory: Memory, time: int) -> None:
    """Count the time that passes without changes."""
    for name in memory.kept_now:
        memory.kept[name] = memory.kept.get(name, 0) + time - memory.now


def note_keepers(memory: Memory) -> None:
    """At the end of an instant: note which ABs are kept from the speaker from now on."""
    memory.kept = {name: time for name, time in memory.kept.items() if _waits(memory, name)}
    memory.starving = {name for name in memory.starving if _waits(memory, name)}
    memory.kept_now = set()
    if memory.halted:
        return
    waiting = [ab for ab in memory.waiting.values() if ab.unit is None]
    memory.kept_now = {ab.waits_as for ab in waiting if _kept_from_speaker(memory, ab)}
    for ab in sorted(waiting, key=lambda one: one.name):
        if _starves_untold(memory, ab):
            memory.report(13, "E6", f"{ab.name} starves, and nothing says so")


def _starves_untold(memory: Memory, ab: AB) -> bool:
    return overdue(memory, ab) and ab.waits_as not in memory.starving


def _waits(memory: Memory, name: str) -> bool:
    """Whether an AB has yet to start, be it behind a way back of its stream (X1)."""
    return memory.abs[name].phase in (WAITING, LINKED)


def _kept_from_speaker(memory: Memory, ab: AB) -> bool:
    if not memory.prima or "speaker" not in ab.devices or ab.cause is not None:
        return False
    by = ab.said[1] if ab.said is not None else ""
    if by.replace("#", ":").partition(":")[0] in ("", ab.app):
        return False  # its own application keeps it waiting
    if kept_by_floor(memory, ab) or refused_by_channel(memory, ab):
        return False
    speaks = [
        one for one in memory.running.values() if one.unit is None and "speaker" in one.devices
    ]
    if speaks:
        return speaks[0].app != ab.app
    return refused_by_topic(memory, ab) is not None


def overdue(memory: Memory, ab: AB) -> bool:
    """Whether others have kept it from the speaker for the maximum time."""
    return memory.patience > 0 and memory.kept.get(ab.waits_as, 0) >= memory.patience


def its_turn(memory: Memory, ab: AB) -> bool:
    """E6: whether it precedes all but reactions, since no response to an answer waits."""
    return overdue(memory, ab) and not any(
        _acknowledges(memory, one) for one in memory.waiting.values()
    )


def _acknowledges(memory: Memory, ab: AB) -> bool:
    just = ab.followed_at == memory.now == memory.answered.get(ab.tree.name)
    return ab.unit is None and just and "speaker" in ab.devices and not ab.asks


def note_answer(memory: Memory, record: Record) -> None:
    """Note that a question was answered without a device's end."""
    ab = memory.abs.get(base(record["behavior"]))
    if ab is not None and ab.asks and not record.get("inbound"):
        memory.answered[ab.tree.name] = memory.now


def answered_now(memory: Memory, ab: AB) -> None:
    """X8, X10: a question was answered before it was asked."""
    memory.answered[ab.tree.name] = memory.now
    if ab.unit is None:
        memory.answered_tree = ab.tree


def note_starve(memory: Memory, record: Record) -> None:
    """An AB recorded as starving is waiting, and by E6 for the required time."""
    ab = memory.abs.get(base(record["behavior"]))
    if ab is None or ab.name not in memory.waiting:
        memory.report(13, "E6", f"{record['behavior']} is said to starve, but does not wait")
        return
    memory.starving.add(ab.waits_as)
    if record["rule"] == "E6" and not overdue(memory, ab):
        memory.report(13, "E6", f"{ab.name} is said to starve, but nobody kept it so long")
