"""The requirements of an interpreter's parts on the whole and on each other.

An interpreter of PRIMA's language is made of three parts: one runs content
(:mod:`~prima.interpreter.content`), one visits the items of forms
(:mod:`~prima.interpreter.form`), one finds and runs handlers
(:mod:`~prima.interpreter.handling`). Each knows the others, and the interpreter that owns
them all, by what is here alone.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, TypeAlias

from prima.interpreter.acts import Act, Expression, SendOut, Text
from prima.interpreter.elements import Document, Form, Item, Unit
from prima.interpreter.frame import Content, Fiber, Frame
from prima.interpreter.protocol import App
from prima.interpreter.transfers import Thrown, Transfer
from prima.markup.tree import Node
from prima.messages import Cue, Data, Json, Notice, Step
from prima.script.evaluation import Scope

if TYPE_CHECKING:
    from prima.interpreter.pyengine import PythonEngine
    from prima.script.isolated import AnyEngine

Evaluating: TypeAlias = "AnyEngine | PythonEngine"
"""The evaluator of an application's code."""
FORM_STEPS = 3
"""Beginning a form's own content, or a form item, counts as so many pieces of content."""


class ContentRunner(Protocol):
    """Runs content."""

    def run(self, content: Sequence[Act], fiber: Fiber) -> Content:
        """Run content in document order, waiting for Commands to end (O4)."""

    def run_at_once(self, content: Sequence[Act], fiber: Fiber) -> Transfer | None:
        """Run content without Commands; gives the transfer of control that ends it."""

    def condition(self, expr: Expression, fiber: Fiber) -> bool:
        """An expression as a condition."""

    def speech(self, parts: Text, fiber: Fiber, after: str = "") -> tuple[str, tuple[Cue, ...]]:
        """Speech following other text, with pauses as cues."""

    def check(self, notice: Notice, fiber: Fiber) -> None:
        """Check whether to continue after a run's end."""

    def passed(
        self, params: Sequence[tuple[str, str | Expression]], fiber: Fiber, node: Node
    ) -> dict[str, Json]:
        """Params of a call, copied, without those that are undefined."""


class Forms(Protocol):
    """Visits the items of forms."""

    def after_timeout(self, frame: Frame, fiber: Fiber, unit: Unit, thrown: Thrown) -> Content:
        """U5: throw an event in a unit that has ended, then continue after it."""


class Handlers(Protocol):
    """Finds and runs handlers."""

    def handle_thrown(
        self, frame: Frame, fiber: Fiber, item: Item | None, thrown: Thrown, depth: int
    ) -> Content:
        """Run the handler of an event thrown in content, in the same piece of content."""

    def tell_sensors(self) -> None:
        """Give the variable ``sensor`` its new values."""


class Owner(App[Evaluating]):
    """The interpreter, as its parts know it besides what every application has."""

    execute: ContentRunner
    handling: Handlers
    algorithm: Forms
    document: Document
    arguments: Mapping[str, frozenset[str]]
    """Motion arguments of the robot's own Commands."""
    application: Scope
    """The outermost scope."""
    frame: Frame | None = None
    """The form that is visited, if any."""
    cause: int | str | None = None
    """The event that the next request reacts to: its serial, or the name of an own one (C5)."""
    fresh: tuple[int | str, int] | None = None
    """A cause, and for how long (ms) a reaction to it is worth starting (X8)."""
    untold = False
    """Whether the variable ``sensor`` is outdated: it is updated when code runs."""
    reports = 0
    """How often sensors reported new values."""
    reported: dict[str, int]
    """The number of the latest report, by the first part of a sensor's name."""

    def fresh_for(self) -> int | None:
        """How long (ms) a reaction to the current cause is worth starting (X8)."""
        return self.fresh[1] if self.fresh and self.fresh[0] == self.cause else None

    # Its requests:

    @abstractmethod
    def request(self, steps: list[Step], fiber: Fiber) -> int:
        """Request Commands; gives the number of the run."""

    @abstractmethod
    def take_cause(self) -> int | None:
        """Take the serial of the event that a request reacts to; no later request does (C5)."""

    @abstractmethod
    def connects(self, frame: Frame) -> bool:
        """Whether the robot has to face the user before the state's next word (X4)."""

    @abstractmethod
    def delay(self, act: SendOut, data: Data, milliseconds: int, fiber: Fiber) -> None:
        """Raise an event later, unless the state is left before."""

    # States:

    @abstractmethod
    def frame_for(self, form: Form, before: Frame | None) -> Frame:
        """A frame for a form."""

    @abstractmethod
    def begin(self, frame: Frame, setup: bool = True) -> tuple[Frame, Transfer] | None:
        """Start a form's own content; gives the transfer of control if it ends at once."""

    @abstractmethod
    def set_up_document(self, frame: Frame) -> None:
        """Declare the document's variables and run its scripts."""

    @abstractmethod
    def initialise(self, frame: Frame, fiber: Fiber) -> None:
        """Declare the form's variables and items."""

    @abstractmethod
    def arm_watches(self, frame: Frame) -> None:
        """C6: arm a form's watches at its entry."""

    @abstractmethod
    def go_to(self, frame: Frame, transfer: Transfer) -> tuple[Frame, Transfer] | None:
        """Go to a form or an item; gives the transfer of control if that ends at once."""

    @abstractmethod
    def transfer(self, frame: Frame, transfer: Transfer) -> None:
        """Leave a state for another."""

    @abstractmethod
    def leave(self, frame: Frame) -> None:
        """O3: give up the content of a state."""

    @abstractmethod
    def close_units(self, frame: Frame) -> None:
        """U5: conclude the units in which nothing is going on any more."""

    @abstractmethod
    def drive(self, fiber: Fiber, notice: Notice | None) -> None:
        """Run a piece of content until it waits or ends, then carry out its transfer."""

    @abstractmethod
    def go_on(self, frame: Frame) -> None:
        """Visit items again after a handler's end."""

    @abstractmethod
    def forget(self, fiber: Fiber) -> None:
        """Give up a piece of content."""
