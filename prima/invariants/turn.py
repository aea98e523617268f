"""The third turn (X7): the asker's response to an answer, recomputed from the records."""

from __future__ import annotations

from prima.invariants.memory import Memory
from prima.invariants.model import AB, LINKED, WAITING, Record, Tree, base


def note_turn(memory: Memory, record: Record) -> None:
    """A question ends, with the user's answer or otherwise."""
    ab = memory.abs.get(base(record["behavior"]))
    answered = not record.get("inbound") and record.get("outcome") == "filled"
    if ab is not None and ab.asks and answered:
        memory.answered_tree = ab.tree


def look_for_turn(memory: Memory) -> None:
    """When selection begins: note the asker's response, if any."""
    if memory.halted:
        return
    if memory.turn is not None and memory.turn.phase not in (LINKED, WAITING):
        memory.turn = None
    tree, memory.answered_tree = memory.answered_tree, None
    if tree is not None and "x7" in memory.extensions and memory.prima:
        memory.turn = _acknowledgement(memory, tree)
        for ab in memory.way_to(memory.turn) if memory.turn is not None else ():
            memory.go_without(ab)


def _acknowledgement(memory: Memory, tree: Tree) -> AB | None:
    coming = [
        one
        for one in tree.members.values()
        if one.phase in (LINKED, WAITING) and one.unit is None and "speaker" in one.devices
    ]
    if not coming or not all(map(_soon_over, memory.way_to(coming[0]))):
        return None
    return coming[0]


def _soon_over(ab: AB) -> bool:
    lasts = ab.feedback or ab.leaves or "speech-recognition" in ab.devices
    return not (lasts or ab.spans) and ab.cause is None


def refused_by_turn(memory: Memory, ab: AB) -> AB | None:
    """X7: the utterance that precedes everything else to be said."""
    turn = memory.turn
    if turn is None or turn.phase != LINKED or "speaker" not in ab.devices:
        return None
    if memory.third_turn(ab) or any(_is_kept(memory, one) for one in memory.way_to(turn)):
        return None
    return turn


def _is_kept(memory: Memory, ab: AB) -> bool:
    """Whether a waiting AB's devices are occupied: nobody waits for such an AB (X7)."""
    others = (other for other in memory.running.values() if other.devices & ab.devices)
    return ab.phase == WAITING and any(other.unit is None for other in others)
