"""How a session drives an application, whatever its language.

An application is told what happens (``start``, ``event``, ``notice``, ``sensed``, ...) and
appends what it wants to ``actions``. What a language does not have, it leaves as it is here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import count
from typing import TypeAlias

from prima.grammar.answers import Answers
from prima.interpreter.bounds import Bounds, Evaluator
from prima.interpreter.elements import Link
from prima.interpreter.transfers import Thrown
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
"""What is waited for outside: a resource, or what becomes of a call."""


class App(Bounds[Evaluator], ABC):
    """Runs one document; between two calls it waits, and a call takes no simulated time."""

    def __init__(self, name: str, kind: str, engine: Evaluator) -> None:
        super().__init__(engine)
        self.name = name
        self.kind = kind
        self.connection: Data = {}
        """What is known of the user's connection (VoiceXML 5.1.4)."""
        self.sensors: dict[str, Json] = {}
        self.runs = count(1)
        self.units = count(1)
        self.states = count(1)
        self._sends = count(1)

    # What every application is told ---------------------------------------------------

    @abstractmethod
    def start(self, now: int) -> None:
        """Begin with the first dialog."""

    @abstractmethod
    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event of the robot."""

    @abstractmethod
    def event(self, now: int, event: Event) -> None:
        """Something happened that concerns every application, or this one alone."""

    @abstractmethod
    def notice(self, now: int, notice: Notice) -> None:
        """The mediator tells the fate of Commands."""

    @abstractmethod
    def sensed(self, now: int, values: Data) -> list[str]:
        """Sensor values changed: gives the events whose conditions turned true (C6)."""

    def heeds(self, text: str) -> bool:
        """Whether what the user says comes in a way that is listened to: words, or keys."""
        return True

    @abstractmethod
    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """What the question of a run makes of what the user said, or None if it takes none of it."""

    @abstractmethod
    def expire(self, now: int) -> list[tuple[str, Data]]:
        """Something may be due: gives the application's own events that are."""

    def stop(self) -> None:
        """The application is taken out of the robot."""
        self.quit("unloaded")

    # What only some languages have ----------------------------------------------------

    def listens_to(self, said: Sequence[Hypothesis]) -> Link | None:
        """The link, of those that listen all the time, that takes what the user said (V1)."""
        return None

    def follow(self, now: int, link: Link, event: Event) -> None:
        """The user has said what a link listens for."""
        return

    def answers(self, run: int) -> Answers | None:
        """What the question of a run takes; None if it is not this application's."""
        return None

    def listening(self) -> Sequence[Answers]:
        """What its links take that listen all the time."""
        return ()

    def open_during(self, command: Command) -> Answers | None:
        """What the question behind a Command takes while that is carried out, if it listens then."""
        return None

    def go_on_entering(self, state: int) -> None:
        """The events raised on entering a state have been handled (C6)."""
        return

    def before(self, command: Command) -> Command | None:
        """Which of the Commands that are waited for comes before one of them, if any does."""
        return None

    def breaks_in(
        self, now: int, command: Command, heard: Heard, said: Sequence[Hypothesis]
    ) -> bool:
        """Whether what the user says during a Command answers the question behind it."""
        return False

    def replied(self, now: int, answer: Answer) -> None:
        """The answer to what was asked for outside."""
        return

    # What both ask for ----------------------------------------------------------------

    def send(self, service: str, data: Data, place: str) -> int:
        """Send something to a service, or to a URI; gives its serial."""
        serial = next(self._sends)
        self.actions.append(Send(service, data, serial, place))
        return serial

    @abstractmethod
    def leave_states(self) -> None:
        """O3: give up all that is asked for and waited for."""

    def quit(self, reason: str, failed: bool = False, place: str = "") -> None:
        """End the application."""
        if self.over:
            return
        self.over = True
        self.leave_states()
        self.actions.append(Quit(reason, failed, place))

    def quit_unhandled(self, thrown: Thrown) -> None:
        """End the application by an event that nothing handles (5.2.5)."""
        self.actions.append(Say("error", thrown.reason, thrown.source))
        self.quit(thrown.reason, True, thrown.source)
