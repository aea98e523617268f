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


def _count(heading: str, meaning: str) -> int:
    """A criterion that is a number, with its heading and its meaning in tables."""
    return field(default=0, metadata={"heading": heading, "meaning": meaning})


def _time(heading: str, meaning: str) -> float | None:
    """A criterion in seconds; None if there was nothing to measure."""
    return field(default=None, metadata={"heading": heading, "meaning": meaning})


@dataclass(slots=True)
class Criteria:
    """The effects of a run on units, streams and the channel, and its reaction times."""

    units_cut: int = _count("units cut", "behaviors that lost a device while they ran")
    restarts: int = _count("restarts", "behaviors that gave way and started again (X2)")
    broken: int = _count("broken", "streams broken by no reaction")
    broken_waiting: int = _count(
        "waiting", "waits for a server that another application broke into"
    )
    unfaced: int = _count("unfaced", "conversations begun without the channel")
    left: int = _count("left", "conversations that the robot left")
    third_turns: int = _count(
        "stolen", "answers before whose acknowledgement another application spoke"
    )
    misanswered: int = _count(
        "astray", "questions that took a late answer to another application's"
    )
    wordless: int = _count(
        "wordless", "topics taken up after another application has spoken, without words for it"
    )
    reactions: int = _count("reactions", "events that an application answered with a Command")
    reaction_mean: float | None = _time("mean s", "mean time from an event to the first Command")
    reaction_max: float | None = _time("max s", "longest time from an event to the first Command")
    late_reactions: int = _count("late", "reactions that began more than 3 s after their event")
    responses: int = _count("responses", "reactions with a word or a movement towards the user")
    response_mean: float | None = _time(
        "mean s", "mean time from an event to that word or movement"
    )
    response_max: float | None = _time(
        "max s", "longest time from an event to that word or movement"
    )
    delays: list[ReactionDelay] = field(default_factory=list)
    """The delay of each application's reaction to each event."""


CRITERIA = tuple(one.name for one in fields(Criteria) if one.metadata)
"""The criteria that are numbers, in order."""
HEADINGS = {one.name: one.metadata["heading"] for one in fields(Criteria) if one.metadata}
"""Their headings in tables."""
MEANINGS = {one.name: one.metadata["meaning"] for one in fields(Criteria) if one.metadata}
"""What they count or measure."""


def shown_time(seconds: float | None) -> str:
    """A time as text; ``-`` if there was no reaction."""
    return "-" if seconds is None else f"{seconds:.2f}"


def shown_times(mean: float | None, longest: float | None) -> str:
    """The mean and the longest time, likewise."""
    return "-" if mean is None else f"{shown_time(mean)}/{shown_time(longest)} s"
