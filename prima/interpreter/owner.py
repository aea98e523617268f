"""What the parts of an interpreter need of the whole, and of each other.

An interpreter of PRIMA's language is made of three parts: one runs content
(:mod:`~prima.interpreter.content`), one visits the items of forms
(:mod:`~prima.interpreter.form`), one finds and runs handlers
(:mod:`~prima.interpreter.handling`). Each knows the others, and the interpreter that owns
them all, by the protocols here alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Literal, NoReturn, Protocol

from prima.interpreter.acts import Act, Expression, SendOut, Text
from prima.interpreter.elements import Document, Form, Item, Unit
from prima.interpreter.frame import Content, Fiber, Frame
from prima.interpreter.transfers import GoItem, Thrown, Transfer
from prima.markup.tree import Node
from prima.messages import Action, Cue, Data, Json, Notice, Step
from prima.script.evaluation import Scope

if TYPE_CHECKING:
    from prima.interpreter.pyengine import PythonEngine
    from prima.script.isolated import AnyEngine

FORM_STEPS = 3
"""The work of beginning a form's own content, or a form item, in pieces of content."""


class ContentRunner(Protocol):
    """Runs content."""

    def run(self, content: Sequence[Act], fiber: Fiber) -> Content:
        """Run content in document order; waits where Commands have to end (O4)."""

    def run_at_once(self, content: Sequence[Act], fiber: Fiber) -> Transfer | None:
        """Run content without Commands; gives the transfer of control that ends it."""

    def condition(self, expr: Expression, fiber: Fiber) -> bool:
        """An expression as a condition."""

    def speech(self, parts: Text, fiber: Fiber, after: str = "") -> tuple[str, tuple[Cue, ...]]:
        """What is said behind other text, and its pauses as cues."""

    def check(self, notice: Notice, fiber: Fiber) -> None:
        """Go on after a run's end, or not."""


class Forms(Protocol):
    """Visits the items of forms."""

    def after_timeout(self, frame: Frame, fiber: Fiber, unit: Unit, thrown: Thrown) -> Content:
        """U5: throw an event in a unit that has ended, then go on behind it."""


class Handlers(Protocol):
    """Finds and runs handlers."""

    def handle_thrown(
        self, frame: Frame, fiber: Fiber, item: Item | None, thrown: Thrown, depth: int
    ) -> Content:
        """Run the handler of an event thrown in content, in the same piece of content."""

    def tell_sensors(self) -> None:
        """Give the variable ``sensor`` its new values."""


class Owner(Protocol):
    """The interpreter of one application."""

    frame: Frame | None
    """The form that is visited, if any."""
    cause: int | str | None
    """The event that is reacted to next (C5)."""
    fresh: tuple[int | str, int] | None
    """A cause, and for how long (ms) a reaction to it is worth starting (X8)."""
    untold: bool
    """Whether the variable ``sensor`` has old values."""

    # Its parts and what it keeps:

    @property
    def execute(self) -> ContentRunner:
        """Runs its content."""

    @property
    def algorithm(self) -> Forms:
        """Visits its items."""

    @property
    def handling(self) -> Handlers:
        """Finds its handlers."""

    @property
    def engine(self) -> AnyEngine | PythonEngine:
        """Evaluates its code."""

    @property
    def document(self) -> Document:
        """What it runs."""

    @property
    def application(self) -> Scope:
        """The outermost scope."""

    @property
    def arguments(self) -> Mapping[str, frozenset[str]]:
        """Motion arguments of the robot's own Commands."""

    @property
    def actions(self) -> list[Action]:
        """What its application wants."""

    @property
    def units(self) -> Iterator[int]:
        """Numbers for units."""

    @property
    def sensors(self) -> Mapping[str, Json]:
        """The latest values."""

    @property
    def reports(self) -> int:
        """How often sensors have had new values."""

    @property
    def reported(self) -> Mapping[str, int]:
        """Which report was the latest, by the first part of a sensor's name."""

    # Bounds:

    def note(self, node: Node, what: Literal["in", "true", "false", "heard"] = "in") -> None:
        """An element is gone through, or its condition has been evaluated."""

    def count_step(self, node: Node, steps: int = 1) -> None:
        """Bound what is done in one instant."""

    def count_output(self, characters: int, node: Node) -> None:
        """Bound what is said, logged, sent and passed on."""

    def count_value(self, value: Json, node: Node) -> None:
        """Count a value that leaves its variables."""

    def give_up(self, node: Node, reason: str) -> NoReturn:
        """End the application: it has gone past a limit."""

    # What it asks for:

    def request(self, steps: list[Step], fiber: Fiber) -> int:
        """Ask for Commands; gives the number of the run."""

    def take_cause(self) -> int | None:
        """The serial of the event that a request reacts to, which no further one does (C5)."""

    def connects(self, frame: Frame) -> bool:
        """Whether the robot has to face the user before the state's next word (X4)."""

    def send(self, service: str, data: Data, place: str) -> int:
        """Ask a service something."""

    def delay(self, act: SendOut, data: Data, milliseconds: int, fiber: Fiber) -> None:
        """Raise an event later, unless the state is left before."""

    # States:

    def frame_for(self, form: Form, before: Frame | None) -> Frame:
        """A frame for a form."""

    def begin(self, frame: Frame, setup: bool = True) -> tuple[Frame, Transfer] | None:
        """Start a form's own content; gives a transfer of control that it ends in at once."""

    def set_up_document(self, frame: Frame) -> None:
        """Declare the document's variables and run its scripts."""

    def initialise(self, frame: Frame, fiber: Fiber) -> None:
        """Declare the form's variables and items."""

    def arm_watches(self, frame: Frame) -> None:
        """C6: what a form watches for counts from its entry."""

    def go_item(self, frame: Frame, transfer: GoItem) -> tuple[Frame, Transfer] | None:
        """Go on with another item of the same form."""

    def transfer(self, frame: Frame, transfer: Transfer) -> None:
        """Leave a state for another."""

    def leave(self, frame: Frame) -> None:
        """O3: give up what a state does."""

    def close_units(self, frame: Frame) -> None:
        """U5: conclude every unit that a state is in."""

    def drive(self, fiber: Fiber, notice: Notice | None) -> None:
        """Run a piece of content until it waits or ends, then carry out its transfer."""

    def go_on(self, frame: Frame) -> None:
        """A handler has ended: visit items again."""

    def forget(self, fiber: Fiber) -> None:
        """Give up a piece of content."""
