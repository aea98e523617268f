"""The floor: its holder, the ABs that it keeps waiting, and its records (F1 to F6, C2)."""

from __future__ import annotations

from prima.invariants.channel import refused_by_channel
from prima.invariants.memory import Memory
from prima.invariants.model import AB, LINKED, RUNNING, Record, Tree, base

# Who may start ----------------------------------------------------------------


def carries_floor(memory: Memory, ab: AB) -> bool:
    """X5: whether the floor's stream does nothing but a motion that the AB can carry."""
    contending = memory.floor[-1].contending() if memory.floor else []
    return bool(contending) and all(
        ab.motion == "free" and memory.composes(ab, other) and other.phase == RUNNING
        for other in contending
    )


def refused_by_floor(memory: Memory, ab: AB, surely: bool = False) -> Tree | None:
    """F2, X7: the stream that keeps, or may keep, the AB from starting."""
    return None if memory.third_turn(ab) else kept_by_floor(memory, ab, surely)


def starts_aside(memory: Memory, ab: AB) -> bool:
    """X7: whether it starts although another has the floor, without taking or ending it."""
    return memory.third_turn(ab) and kept_by_floor(memory, ab) is not None


def kept_by_floor(memory: Memory, ab: AB, surely: bool = False) -> Tree | None:
    """F2: the stream that keeps, or may keep, the AB from starting.

    F2 leaves "another event" open if the floor's stream goes on from one reaction to
    the next (O2, O3): an event other than the last certainly counts, one other than an
    earlier one perhaps. A reaction to an earlier one may start or wait.
    """
    holder = memory.holder
    if holder is None or holder.app == ab.app:
        return None
    held = {holder.cause} if surely else holder.causes
    if ab.cause is not None and ab.cause not in held:
        return None
    high = any(one.high for one in ab.tree.meant(ab))
    contending = _contending(memory, holder)
    if contending and all(high and not other.high for other in contending):
        return None
    return None if carries_floor(memory, ab) else holder


def _contending(memory: Memory, holder: Tree) -> list[AB]:
    """F2: the ABs of the floor's stream that keep others from starting."""
    members = holder.members.values()
    if any(one.inserted and refused_by_channel(memory, one) for one in members):
        # A way back that K1 keeps counts as itself, so that the two do not wait for each other.
        return [one for one in members if one.contends]
    return holder.contending()


def refused_by_topic(memory: Memory, ab: AB) -> Tree | None:
    """F6: the stream that the AB would interrupt by speaking."""
    if "speaker" not in ab.devices or ab.cause is not None or memory.holder is ab.tree:
        return None
    return None if memory.third_turn(ab) else _topic_kept(memory, ab)


def _topic_kept(memory: Memory, ab: AB) -> Tree | None:
    for other in memory.running.values():
        if keeps_topic(memory, other, ab):
            return other.tree
    return None


def kept_otherwise(memory: Memory, ab: AB) -> bool:
    """Whether F2 or F6 would keep it waiting if not for X7."""
    if kept_by_floor(memory, ab) is not None:
        return True
    speaks = "speaker" in ab.devices and memory.holder is not ab.tree
    return speaks and _topic_kept(memory, ab) is not None


def keeps_topic(memory: Memory, other: AB, ab: AB) -> bool:
    """F6: whether a running AB is between two utterances of another application's topic."""
    between = other.phase == RUNNING and not other.feedback and other.unit is None
    return between and other.app != ab.app and other.tree.spoken and _speaks_next(other)


def _speaks_next(ab: AB) -> bool:
    """F6: whether a speaking AB is linked behind it, without a looping AB in between."""
    reached = [ab]
    for before in reached:  # the list grows
        for child in ab.tree.members.values():
            if child.phase != LINKED or before.name not in child.parents:
                continue
            if child.says:
                return True
            if not child.feedback and child not in reached:
                reached.append(child)
    return False


# Who has it -------------------------------------------------------------------


def take_floor(memory: Memory, ab: AB, reaction: int | None) -> None:
    """F1: a reaction takes the floor. F3: so does an AB that needs the floor's devices."""
    tree, holder = ab.tree, memory.holder
    if reaction is not None:
        tree.cause = reaction
        tree.causes.add(reaction)
    elif holder is None or holder.app == ab.app or not _in_the_way(ab, holder):
        return
    give_floor(memory, tree, "F1" if reaction is not None else "F3")


def _in_the_way(ab: AB, holder: Tree) -> bool:
    """F3: whether a running or waiting AB of the floor's stream needs one of the devices."""
    own = [other for other in holder.members.values() if other.contends]
    return any(ab.devices & other.devices for other in (*own, *holder.contending()))


def give_floor(memory: Memory, tree: Tree, rule: str) -> None:
    """C2: the stream that takes the floor suspends others' streams, which rank alike (S2d)."""
    if memory.holder is tree:
        return
    memory.turned.append((tree.name, "taken", rule))
    if tree in memory.floor:
        memory.floor.remove(tree)
    memory.floor.append(tree)
    for other in memory.trees.values():
        if other.app != tree.app and other.started >= 0 and not other.suspended:
            other.suspended = other.moved_away = True
            other.rank = memory.place + 1
            memory.suspended_by[other.name] = tree.name


def resume(memory: Memory, ab: AB) -> None:
    """C2: a suspended stream resumes. It keeps its place until the instant is over (S2d)."""
    tree = ab.tree
    if tree.suspended:
        tree.suspended = False
        memory.resumed.append(tree)
        if tree.waits:
            memory.turns[tree.name].append(memory.now)
        tree.waits = False
        named = memory.resumptions.pop(tree.name, None)
        if named != ab.shown:
            memory.report(13, "C2", f"{tree.name} resumes by {ab.shown}; the records name {named}")


def waits_suspended(memory: Memory, ab: AB) -> None:
    """C2: an application is notified that another's stream keeps its suspended one waiting."""
    by = ab.said[1] if ab.said is not None else ""
    other = by.replace("#", ":").partition(":")[0]
    if ab.tree.suspended and not ab.tree.waits and other not in ("", ab.app):
        ab.tree.waits = True
        memory.turns[ab.tree.name].append(memory.now)


# What the records say -----------------------------------------------------------


def note_floor(memory: Memory, record: Record) -> None:
    """F3: the floor is a stack; only the named stream is pushed, or removed."""
    tree, recorded = record["tree"], list(record.get("floor") or ())
    rest = [name for name in memory.recorded_floor if name != tree]
    if recorded != (rest if record["outcome"] == "returned" else [*rest, tree]):
        memory.report(13, "F3", f"the floor is {recorded}, after {memory.recorded_floor}")
    memory.recorded_floor = recorded
    memory.told_turns.append((tree, record["outcome"], record["rule"]))


def note_suspend(memory: Memory, record: Record) -> None:
    """A record says that a stream is suspended."""
    memory.suspensions[record["tree"]] = record["by"]


def note_resume(memory: Memory, record: Record) -> None:
    """A record says that a stream is resumed."""
    memory.resumptions[record["tree"]] = record["behavior"]


def note_stop(memory: Memory, record: Record) -> None:
    """A record says that an AB that moves the robot is stopped (F5)."""
    memory.stops.add(base(record["behavior"]))


def check_floor(memory: Memory) -> None:
    """After a start, and at an instant's end: the records show all changes, and no others."""
    names = [tree.name for tree in memory.floor]
    if names != memory.recorded_floor:
        memory.report(13, "F3", f"the floor is {names}; the records say {memory.recorded_floor}")
        memory.recorded_floor = names
    _check_turns(memory)
    for tree, by in memory.suspended_by.items():
        named = memory.suspensions.pop(tree, None)
        if named != by:
            memory.report(13, "C2", f"{by} suspends {tree}; the records name {named}")
    for tree, by in memory.suspensions.items():
        memory.report(13, "C2", f"{tree} is not suspended by {by}, as a record says")
    for tree in sorted(memory.resumptions):
        memory.report(13, "C2", f"{tree} does not resume, as a record says")
    memory.suspensions, memory.suspended_by, memory.resumptions = {}, {}, {}


def _check_turns(memory: Memory) -> None:
    """F1, F3, X3: which streams took the floor and gave it back, and by which rule.

    The stack shows their order; for several that end at once it is not defined.
    """
    if sorted(memory.told_turns) != sorted(memory.turned):
        text = f"the floor was {memory.turned}; the records say {memory.told_turns}"
        memory.report(13, "F3", text)
    memory.turned, memory.told_turns = [], []


# Stops --------------------------------------------------------------------------


def stopped_rightly(memory: Memory) -> None:
    """F5: a body that moved and gets no next loop is stopped; there are no other stops.

    In an emergency every device goes to its safe state anyway (E5).
    """
    if memory.halted:
        return
    driven = memory.driven or any(ab.drives for ab in memory.running.values())
    due = set() if driven else set(memory.halting)
    for name in sorted(due - memory.stops):
        memory.report(14, "F5", f"{name} is moved on by nobody and not stopped")
    for name in sorted(memory.stops - due):
        memory.report(14, "F5", f"{name} is stopped for no reason")
