"""How a session drives an application, whatever its language.

An application is notified of what happens (``start``, ``event``, ``notice``, ``sensed``, ...) and
appends its requests to ``actions``. A language inherits the defaults here for what it lacks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import count
from math import isfinite
from typing import TypeAlias

from prima.grammar.answers import Answers
from prima.interpreter.bounds import Bounds, Evaluator
from prima.interpreter.elements import Link
from prima.interpreter.transfers import Thrown
from prima.language.values import shown
from prima.messages import (
    Command,
    Data,
    Event,
    Fetched,
    Heard,
    Hypothesis,
    Json,
    Notice,
    Quit,
    Say,
    Send,
    Transferred,
    Understood,
)

Answer: TypeAlias = Fetched | Transferred
"""An answer that an application awaits from outside: a resource, or the outcome of a call."""


class App(Bounds[Evaluator], ABC):
    """Runs one document; between two calls it waits, and a call takes no simulated time."""

    def __init__(self, name: str, kind: str, engine: Evaluator) -> None:
        super().__init__(engine)
        self.name = name
        self.kind = kind
        self.connection: Data = {}
        """The user's connection, as far as known (VoiceXML 5.1.4)."""
        self.sensors: dict[str, Json] = {}
        self.runs = count(1)
        self.units = count(1)
        self.states = count(1)
        self.sends = count(1)
        """The serials of what it sends; loaded again, it goes on counting."""

    # Notifications of every application -----------------------------------------------

    @abstractmethod
    def start(self, now: int) -> None:
        """Begin with the first dialog."""

    @abstractmethod
    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event of the robot."""

    @abstractmethod
    def event(self, now: int, event: Event) -> None:
        """Deliver an event for every application, or for this one alone."""

    @abstractmethod
    def notice(self, now: int, notice: Notice) -> None:
        """The mediator reports what became of Commands."""

    @abstractmethod
    def sensed(self, now: int, values: Data) -> list[str]:
        """Note new sensor values; gives the events whose conditions turned true (C6)."""

    def heeds(self, text: str) -> bool:
        """Whether the input mode of an utterance, words or keys, is listened to."""
        return True

    @abstractmethod
    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """How a run's question interprets what the user said; None if it takes none of it."""

    @abstractmethod
    def expire(self, now: int) -> tuple[str, Data] | None:
        """Take the first of the application's own events that are due; None if there is none."""

    def stop(self) -> None:
        """The application is taken out of the robot."""
        self.quit("unloaded")

    # For some languages only ----------------------------------------------------------

    def listens_to(self, said: Sequence[Hypothesis]) -> Link | None:
        """The link that takes what the user said, of those that always listen (V1)."""
        return None

    def follow(self, now: int, link: Link, event: Event) -> None:
        """Follow a link whose words the user has said."""
        return

    def answers(self, run: int) -> Answers | None:
        """The answers that a run's question takes; None if it is not this application's."""
        return None

    def listening(self) -> Sequence[Answers]:
        """The utterances that its always-listening links take."""
        return ()

    def open_during(self, command: Command) -> Answers | None:
        """The answers to the question after a Command that are taken during the Command, if any."""
        return None

    def go_on_entering(self, state: int) -> None:
        """Continue after the events raised on entering a state have been handled (C6)."""
        return

    def before(self, command: Command) -> Command | None:
        """The awaited Command before a given one, if any."""
        return None

    def breaks_in(
        self, now: int, command: Command, heard: Heard, said: Sequence[Hypothesis]
    ) -> bool:
        """Whether what the user says during a Command answers the question after it."""
        return False

    def replied(self, now: int, answer: Answer) -> None:
        """The answer to an outside request."""
        return

    # Requests of both -----------------------------------------------------------------

    def send(self, service: str, data: Data, place: str) -> int:
        """Send something to a service, or to a URI; gives its serial."""
        serial = next(self.sends)
        self.actions.append(Send(service, sendable(data), serial, place))
        return serial

    @abstractmethod
    def leave_states(self) -> None:
        """O3: give up all that is requested and awaited."""

    def quit(self, reason: str, failed: bool = False) -> None:
        """End the application."""
        if self.over:
            return
        self.over = True
        self.leave_states()
        self.actions.append(Quit(reason, failed))

    def quit_unhandled(self, thrown: Thrown) -> None:
        """End the application by an unhandled event (5.2.5)."""
        self.actions.append(Say("error", thrown.reason, thrown.source))
        self.quit(thrown.reason, True)


def sendable(data: Data) -> Data:
    """The data to send; numbers that JSON lacks, such as NaN, are texts as in ECMAScript."""
    params = data.get("params")
    if not isinstance(params, dict):
        return data
    lacking = {
        name: shown(value)
        for name, value in params.items()
        if isinstance(value, float) and not isfinite(value)
    }
    return {**data, "params": {**params, **lacking}} if lacking else data
