"""A run as its user perceives it: streams that talk, answers awaited, events to react to."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

from prima.transcript.criteria import ReactionDelay
from prima.transcript.record import Entry

NEVER = inf
"""The time of what has not happened."""


@dataclass(slots=True)
class PerceivedStream:
    """A Communication Stream as a user perceives it."""

    name: str
    app: str
    pending: dict[str, Entry] = field(default_factory=dict)
    """Its requests that have not ended, by AB."""
    topics: set[str] = field(default_factory=set)
    """Those of them that do not leave the user."""
    running: set[str] = field(default_factory=set)
    leaving: set[str] = field(default_factory=set)
    """Its running ABs that leave the user."""
    looping: set[str] = field(default_factory=set)
    """Its running ABs that work in a feedback loop."""
    speaking: set[str] = field(default_factory=set)
    """Its running ABs that speak."""
    spoken: bool = False
    """Whether it has spoken, and no break has been counted since."""
    spoken_into: float = NEVER
    """When another application first spoke, other than by a reaction, since it last did."""
    entered: float = NEVER
    """When another application entered it, if ``broken_by`` is one."""
    has_spoken: bool = False
    """Whether it has ever spoken."""
    talked_over: bool = False
    """Whether another application has spoken since it last did."""
    owed: list[tuple[float, ReactionDelay]] = field(default_factory=list)
    """Events that it reacts to and has not responded to, with their times."""
    begun: bool = False
    engaged: bool = False
    broken_by: str = ""
    """The application that has entered since it last did something, if any."""
    by_reaction: bool = False
    left_by: set[str] = field(default_factory=set)
    reacting: float = -1.0
    """When its latest reaction started, if no other application has entered since; else below 0."""
    asks: bool = False
    """Whether it has asked the user something."""
    faced: bool | None = None
    """Whether robot and user faced each other at its first word, if that has been said."""

    @property
    def unfaced(self) -> bool:
        """Whether it is a conversation that was begun without the channel."""
        return self.asks and self.faced is False

    def run(self, name: str, request: Entry) -> None:
        """One of its ABs starts."""
        self.begun = True
        self.running.add(name)
        if request.leaves:
            self.leaving.add(name)
        if request.feedback:
            self.looping.add(name)
        self.engaged = self.engaged or bool(request.engages)
        self.asks = self.asks or request.command == "q-and-a"

    def reacts(self, request: Entry) -> bool:
        """Whether one of its ABs, or a unit around it, reacts to an event."""
        around: Entry | None = request
        while around is not None and around.cause is None:
            around = self.pending.get(around.unit)
        return around is not None


def does_speak(request: Entry) -> bool:
    """Whether an AB says something: a question may only listen, and of a unit its parts speak."""
    return bool(request.text) and "speaker" in request.devices and request.command != "iu"


@dataclass(slots=True)
class AwaitedAnswer:
    """An application waits for a service's answer."""

    talked: bool
    """Whether it was or has been doing something for the user: else nobody notices."""
    since: float
    broken: bool = False
    """Whether another application came in, by no reaction."""


@dataclass(slots=True)
class AwaitingEvent:
    """An event that applications may react to."""

    name: str
    time: float
    answered: set[str] = field(default_factory=set)
    """Applications that have reacted."""
    waited: str = ""
    """The application whose wait was broken and that this answers, until it is taken up."""
