"""The rules of selection (S2, E6, F2, F3, F6, K1), each in one function named after it.

``s2*`` and ``e6`` rank an AB: the smallest goes first. The others return what keeps a waiting AB
from starting as a :data:`Refusal`, or None.
"""

from __future__ import annotations

from typing import Any

from prima.scheduler.behavior import GONE, LINKED, RUNNING, WAITING, Behavior, Stream
from prima.scheduler.memory import WorkingMemory

Refusal = tuple[str, str]
"""The rule that keeps an AB from starting, and the AB or stream that it protects."""
Rank = tuple[Any, ...]
"""A waiting AB's rank, with a place for each rule of a policy: the smallest goes first."""
NO_REACTION = (1, 0, 0)


def s2a(ab: Behavior) -> int:
    """The higher priority goes first."""
    return -ab.priority


def s2b(ab: Behavior, memory: WorkingMemory) -> tuple[int, int, int]:
    """Then reactions, the latest event's first; of one event, the active application's."""
    if ab.reaction is None:
        return NO_REACTION
    return (0, -ab.reaction, 0 if memory.active is ab.app else 1)


def e6(ab: Behavior, memory: WorkingMemory, now: int) -> int:
    """Then ABs kept from the speaker for too long, after those that follow an answer."""
    if not ab.wait.overdue:
        return 1
    return 1 if any(acknowledges(other, now) for other in memory.waiting.values()) else 0


def acknowledges(ab: Behavior, now: int) -> bool:
    """E6: whether an AB says something, other than a question, to a user who has just answered."""
    asks = ab.type is not None and ab.asks
    return ab.stream.answered == now and ab.freed == now and "speaker" in ab.devices and not asks


def third_turn(ab: Behavior, memory: WorkingMemory) -> bool:
    """X7: whether an AB is the asker's response to an answer, or comes before it."""
    owed = memory.owed
    return owed is not None and (ab is owed or ab in before(owed, memory))


def before(ab: Behavior, memory: WorkingMemory) -> list[Behavior]:
    """All ABs that have to end before this one may start."""
    found: list[Behavior] = []
    names = [*ab.waits_for]
    while names:
        parent = memory.behaviors[names.pop()]
        if parent not in found:
            found.append(parent)
            names += parent.waits_for
    return found


def x7(ab: Behavior, memory: WorkingMemory) -> Refusal | None:
    """X7: nobody speaks between a user's answer and the asker's response.

    Once the response waits, it holds back the speaker itself (S3). If the devices of an AB that
    comes before it are occupied, nobody waits for it.
    """
    owed = memory.owed
    if owed is None or owed.state is not LINKED or "speaker" not in ab.devices:
        return None
    if any(one.state is WAITING and memory.conflict(one) for one in before(owed, memory)):
        return None
    return None if third_turn(ab, memory) else ("X7", owed.id)


def aside(ab: Behavior, memory: WorkingMemory) -> bool:
    """X7: whether an AB starts though another application holds the floor, without taking it."""
    return third_turn(ab, memory) and f2(ab, memory) is not None


def keeps_speaker(ab: Behavior, memory: WorkingMemory) -> bool:
    """E6: whether another application, and not a rule, keeps a waiting AB from the speaker.

    A floor (F2) and a channel (K1) count as rules; a topic between two utterances (F6) does not.
    """
    if "speaker" not in ab.devices or ab.reaction is not None:
        return False
    if f2(ab, memory) is not None or k1(ab, memory) is not None:
        return False
    other = memory.occupied.get("speaker")
    return f6(ab, memory) is not None if other is None else other.app is not ab.app


def s2c(ab: Behavior, now: int) -> int:
    """Then ABs that follow one that ended in this instant."""
    return 0 if ab.freed == now else 1


def s2d(ab: Behavior) -> int:
    """Then the stream suspended last; streams that are not suspended come after."""
    return -ab.stream.place


def s2e(ab: Behavior) -> int:
    """Then the earlier request."""
    return ab.requested


def s2f(ab: Behavior) -> tuple[int, int]:
    """Then the application declared first; of one application, the Command requested first."""
    return (ab.app.order, ab.serial)


def refusal(ab: Behavior, memory: WorkingMemory) -> Refusal | None:
    """The first rule, other than those on devices, that keeps a waiting AB from starting."""
    return f2(ab, memory) or f6(ab, memory) or k1(ab, memory)


def outranks(priority: int, stream: Stream, memory: WorkingMemory) -> bool:
    """F2: whether a priority is higher than that of all ABs in the floor's stream.

    A way back that X1 inserted and K1 keeps waiting counts as itself: otherwise the floor's
    stream would wait for the one that engages the user, and that one for the floor.
    """
    contending = stream.contending()
    if any(k1(ab, memory) is not None for ab in stream.present() if ab.inserted):
        contending = stream.present()
    return bool(contending) and all(priority > other.priority for other in contending)


def f2(ab: Behavior, memory: WorkingMemory) -> Refusal | None:
    """Another application's floor admits only a reaction to another event or a higher priority."""
    holder = memory.holder
    if holder is None or holder.app is ab.app:
        return None
    if ab.reaction is not None and ab.reaction not in holder.causes:
        return None
    priority = max(one.priority for one in ab.meant())
    return None if outranks(priority, holder, memory) else ("F2", holder.name)


def f3(ab: Behavior, memory: WorkingMemory) -> bool:
    """Whether an AB that starts by its priority takes the floor from another application.

    It does if it needs a device of a running or waiting AB of the floor's stream, or of an AB
    for which something was inserted (X1, X4); else it runs beside it.
    """
    holder = memory.holder
    if holder is None or holder.app is ab.app:
        return False
    own = (*holder.contending(), *holder.present())
    return any(ab.devices & other.devices for other in own)


def f6(ab: Behavior, memory: WorkingMemory) -> Refusal | None:
    """A topic is not interrupted: its speaker is reserved between two of its utterances."""
    if "speaker" not in ab.devices or ab.reaction is not None or ab.stream is memory.holder:
        return None
    for other in memory.running.values():
        between = other.unit is None and not other.feedback and other.stream.spoken
        if between and other.app is not ab.app and speaks_next(other):
            return ("F6", other.id)
    return None


def speaks_next(ab: Behavior) -> bool:
    """F6: whether a speaking AB is linked behind this one, with no looping AB in between."""
    return any(
        child.state is not GONE and (child.says or (not child.feedback and speaks_next(child)))
        for child in ab.children
    )


def k1(ab: Behavior, memory: WorkingMemory) -> Refusal | None:
    """ABs that leave the user wait while another application engages them."""
    if not ab.leaves:
        return None
    for stream in memory.engaged.values():
        if stream.app is ab.app or not engages(stream, memory):
            continue
        if not waits_in_turn(stream, ab, memory):
            return ("K1", stream.name)
    return None


def waits_in_turn(stream: Stream, ab: Behavior, memory: WorkingMemory) -> bool:
    """K1, X1: whether the stream only waits to go back, as the AB does, and would wait for it."""
    present = stream.present()
    if not ab.inserted or ab.stream.name not in memory.engaged:
        return False
    return any(one.inserted for one in present) and all(one.leaves for one in present)


def engages(stream: Stream, memory: WorkingMemory) -> bool:
    """K1: whether a stream in which an AB has engaged the user still engages them.

    It does not while all its ABs leave the user nor, unless it searches or tracks, while the
    user is absent.
    """
    contending = stream.contending()
    if memory.absent and not any(ab.feedback and ab.engages for ab in contending):
        return False
    return not contending or not all(ab.leaves for ab in contending)


def x5(ab: Behavior, memory: WorkingMemory) -> bool:
    """Whether the floor's stream does nothing but a motion with which this AB can be composed."""
    holder = memory.holder
    if holder is None or ab.motion != "free":
        return False
    contending = holder.contending()
    return bool(contending) and all(
        other.motion == "faithful" and other.state is RUNNING for other in contending
    )
