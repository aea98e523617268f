"""The thesis's criteria for a mediated order, counted in a transcript (docs/measures.md).

They use requests, starts, ends and events, which a user can see, and not the mediator's floor
or suspensions, so that all policies are measured alike. Times in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields


@dataclass(slots=True)
class ReactionDelay:
    """An event, and the time (s) until an application's first Command in reaction to it."""

    event: str
    serial: int
    app: str
    seconds: float
    response: float | None = None
    """How long (s) until the first word or movement towards the user; None if there was none."""


@dataclass(slots=True)
class Criteria:
    """The effects of a run on units, streams and the channel, and its reaction times."""

    units_cut: int = 0
    """Commands that lost a device to another application while they ran."""
    restarts: int = 0
    """Behaviors that gave way because their author allowed it (X2)."""
    broken: int = 0
    """Streams broken other than by a reaction."""
    broken_waiting: int = 0
    """Waits for a server broken by another application without a reaction (first pattern)."""
    unfaced: int = 0
    """Conversations begun without the channel (second pattern)."""
    left: int = 0
    """Conversations that the robot left before their end."""
    third_turns: int = 0
    """Answers before whose acknowledgement another application spoke (X7)."""
    misanswered: int = 0
    """Questions that took what the user said just after another application's timeout (X10)."""
    wordless: int = 0
    """Topics resumed after another application has spoken, without words that say so (X9)."""
    reactions: int = 0
    """Events that some application reacted to; without one the times below are None."""
    reaction_mean: float | None = None
    reaction_max: float | None = None
    late_reactions: int = 0
    """Reactions that began more than 3 s after their event (X8)."""
    responses: int = 0
    """Reactions in which the robot said something or turned to the user; likewise."""
    response_mean: float | None = None
    response_max: float | None = None
    delays: list[ReactionDelay] = field(default_factory=list)
    """The delay of each application's reaction to each event."""


CRITERIA = tuple(one.name for one in fields(Criteria) if one.name != "delays")
"""The criteria that are numbers, in order."""


def shown_time(seconds: float | None) -> str:
    """A time as text; ``-`` if there was no reaction."""
    return "-" if seconds is None else f"{seconds:.2f}"


def shown_times(mean: float | None, longest: float | None) -> str:
    """The mean and the longest time, likewise."""
    return "-" if mean is None else f"{shown_time(mean)}/{shown_time(longest)} s"
