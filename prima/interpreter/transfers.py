"""What ends a piece of content in either language: events thrown in it, transfers of control."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from prima.interpreter.places import source
from prima.markup.tree import Node
from prima.messages import Event, Json
from prima.script.evaluation import EngineLost, ScriptError

MAX_DEPTH = 32
"""Subdialogs inside each other, and events thrown while one is handled."""
NO_DATA: Mapping[str, Json] = MappingProxyType({})


class Thrown(Exception):
    """An event thrown in the application (VoiceXML 5.2.1)."""

    sought = False
    """Whether its handlers have been looked for in vain."""
    shared = False
    """Whether it is of the robot or its surroundings, for every application: in VoiceXML only
    handlers that name it take it, as that knows no such events (5.2)."""
    outside = False
    """Whether it has come from outside while the application waited for something else."""

    def __init__(
        self, name: str, message: str = "", source: str = "", data: Mapping[str, Json] = NO_DATA
    ) -> None:
        super().__init__(name)
        self.name = name
        self.message = message
        self.source = source
        self.data = data
        """What PRIMA's handlers find beside its message."""

    @classmethod
    def at(cls, node: Node, name: str, message: str) -> Thrown:
        """An event that something wrong at an element throws; its message has the place."""
        place = source(node)
        return cls(name, f"{place}: {message}", place)

    @property
    def event(self) -> Event:
        """The same as an event of the application's own, which nothing reacts to (C5)."""
        return Event(self.name, 0, {"message": self.message, **self.data}, reactive=False)

    @property
    def reason(self) -> str:
        """Why the application ends, if nothing handles it (5.2.5)."""
        place, message = self.source, self.message
        if place and not message.startswith(place):
            message = f"{place}: {message}" if message else place
        return f"{self.name}: {message}"


class Transfer(Exception):
    """Control leaves the content: a dialog, an item, a return, or the end."""


class GoItem(Transfer):
    """A goto to an item of this form (5.3.7)."""

    def __init__(self, item: str) -> None:
        super().__init__(item)
        self.item = item


class GoBack(Transfer):
    """A return from a subdialog, with its values or an event (5.3.10)."""

    def __init__(self, values: Json, event: str = "", message: str = "") -> None:
        super().__init__(event)
        self.values = values
        self.event = event
        self.message = message


class GoOut(Transfer):
    """An exit, or the end that a limit or an unhandled event makes."""

    def __init__(self, reason: str = "exit", failed: bool = False, source: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.failed = failed
        self.source = source


def thrown_of(error: Thrown | ScriptError) -> Thrown:
    """An error of the engine itself is an event as well.

    What was thrown forgets where: content that handles it may wait, and would keep all that
    led to it, what was thrown before included, without end.

    Raises:
        GoOut: the engine is lost.
    """
    if isinstance(error, EngineLost):
        raise GoOut(f"error.semantic: {error}", True)
    if not isinstance(error, Thrown):
        return Thrown("error.semantic", str(error))
    error.__context__ = error.__traceback__ = None
    return error


def failure(error: ScriptError, code: str, place: str) -> Thrown:
    """``error.semantic`` with the place of the code that failed (5.2.6).

    Raises:
        GoOut: the engine is lost.
    """
    message = f"{place}: {code.strip()[:80]}: {error}"
    if isinstance(error, EngineLost):
        raise GoOut(f"error.semantic: {message}", True, place)
    return Thrown("error.semantic", message, place)


def undeclared(node: Node, name: str) -> Thrown:
    """What a clear of a variable throws that no scope has (5.3.3)."""
    return Thrown.at(node, "error.semantic", f'the variable "{name}" is not declared')


def no_item(node: Node, name: str) -> Thrown:
    """What a goto to an item throws that the form does not have (5.3.7)."""
    return Thrown.at(node, "error.badfetch", f'there is no form item "{name}"')


def check_depth(depth: int, node: Node) -> None:
    """Bound subdialogs inside each other.

    Raises:
        Thrown: there are too many.
    """
    if depth >= MAX_DEPTH:
        message = f"more than {MAX_DEPTH} subdialogs inside each other"
        raise Thrown.at(node, "error.semantic", message)
