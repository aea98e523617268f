"""X7: nobody speaks between a user's answer and the asker's response."""

from __future__ import annotations

from prima.scheduler.behavior import RUNNING, Behavior, Stream
from prima.scheduler.mediation import Mediation
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.rules import before, third_turn


def owe(mediation: Mediation) -> None:
    """X7: when a question has been answered, note its asker's response."""
    memory = mediation.memory
    stream, memory.answered = memory.answered, None
    if stream is not None and "x7" in mediation.policy.extensions:
        memory.owed = acknowledgement(stream, memory)


def acknowledgement(stream: Stream, memory: WorkingMemory) -> Behavior | None:
    """The stream's next utterance, if it and everything before it are short.

    A further question does not count: it lasts as long as the user takes.
    """
    coming = (ab for ab in stream.members.values() if ab.state is not RUNNING)
    first = next((ab for ab in coming if ab.unit is None and "speaker" in ab.devices), None)
    if first is None or not all(map(_soon_over, [first, *before(first, memory)])):
        return None
    return first


def goes_before(ab: Behavior, reaction: int | None, memory: WorkingMemory) -> int:
    """X2: the event to which a starting AB reacts; only a reaction to a later one interrupts it.

    It stays so though the AB starts again. The response to an answer goes before all waiting
    reactions (X7).
    """
    reactions = [reaction]
    if third_turn(ab, memory):
        reactions += [one.reaction for one in memory.waiting.values()]
    return max([ab.reacted, *(one for one in reactions if one is not None)])


def _soon_over(ab: Behavior) -> bool:
    lasting = ab.feedback or ab.leaves or ab.asks or ab.spans
    return not lasting and ab.reaction is None  # what is wanted now may be a reaction in the stream
