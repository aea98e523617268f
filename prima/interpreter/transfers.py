"""Events and transfers of control, which end a piece of content in either language."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from prima.interpreter.places import source
from prima.markup.tree import Node
from prima.messages import Event, Json
from prima.script.evaluation import EngineLost, ScriptError

MAX_DEPTH = 32
"""Maximum nesting of subdialogs, and of events thrown while one is handled."""
NO_DATA: Mapping[str, Json] = MappingProxyType({})


class Thrown(Exception):
    """An event thrown in the application (VoiceXML 5.2.1)."""

    sought = False
    """Whether no handler was found for it."""
    shared = False
    """Whether it comes from the robot or its surroundings, for every application: in VoiceXML,
    which has no such events, only handlers that name it take it (5.2)."""
    outside = False
    """Whether it arrived from outside while the application waited for something else."""
    worded = False
    """Whether it was thrown with a message, perhaps an empty one."""

    def __init__(
        self, name: str, message: str = "", source: str = "", data: Mapping[str, Json] = NO_DATA
    ) -> None:
        super().__init__(name)
        self.name = name
        self.message = message
        self.source = source
        self.data = data
        """Data for PRIMA's handlers besides its message."""

    @classmethod
    def at(cls, node: Node, name: str, message: str) -> Thrown:
        """The event for an error at an element; its message includes the place."""
        place = source(node)
        return cls(name, f"{place}: {message}", place)

    @property
    def event(self) -> Event:
        """The same as an event of the application's own, to which nothing is a reaction (C5)."""
        return Event(self.name, 0, {"message": self.message, **self.data}, reactive=False)

    @property
    def reason(self) -> str:
        """Why the application ends if it is unhandled (5.2.5)."""
        place, message = self.source, self.message
        if place and not message.startswith(place):
            message = f"{place}: {message}" if message else place
        return f"{self.name}: {message}"


class Transfer(Exception):
    """Control leaves the content: to a dialog or an item, by a return, or at the end."""


class GoItem(Transfer):
    """A goto to an item of this form (5.3.7)."""

    def __init__(self, item: str) -> None:
        super().__init__(item)
        self.item = item


class GoBack(Transfer):
    """A return from a subdialog, with its values or an event (5.3.10)."""

    def __init__(
        self, values: Json, event: str = "", message: str = "", worded: bool = False
    ) -> None:
        super().__init__(event)
        self.values = values
        self.event = event
        self.message = message
        self.worded = worded
        """Whether the event has a message, perhaps an empty one."""


class GoOut(Transfer):
    """An exit, or the end caused by a limit or an unhandled event."""

    def __init__(self, reason: str = "exit", failed: bool = False, source: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.failed = failed
        self.source = source


def thrown_of(error: Thrown | ScriptError) -> Thrown:
    """The event for an exception, including an error of the engine itself.

    Its traceback is dropped: content that handles it may wait, and would keep alive all that led
    to it, including earlier exceptions.

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
    """The event of a clear of an undeclared variable (5.3.3)."""
    return Thrown.at(node, "error.semantic", f'the variable "{name}" is not declared')


def no_item(node: Node, name: str) -> Thrown:
    """The event of a goto to an item that the form lacks (5.3.7)."""
    return Thrown.at(node, "error.badfetch", f'there is no form item "{name}"')


def check_depth(depth: int, node: Node) -> None:
    """Bound the nesting of subdialogs.

    Raises:
        Thrown: there are too many.
    """
    if depth >= MAX_DEPTH:
        message = f"more than {MAX_DEPTH} subdialogs inside each other"
        raise Thrown.at(node, "error.semantic", message)
