"""Executable content as values, each with its element."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.messages import Json

Text = tuple["str | Expression | Pause", ...]
"""Text with expressions and pauses in it, in order."""


@dataclass(frozen=True, slots=True)
class Pause:
    """A silence within spoken text, in ms."""

    lasts: int


def pauses_in(text: Text | None) -> int:
    """The total duration of a text's pauses, in ms."""
    return sum(part.lasts for part in text or () if isinstance(part, Pause))


@dataclass(slots=True, eq=False)
class Expression:
    """ECMAScript code, and the element and attribute that contain it."""

    code: str
    node: Node
    attribute: str = "expr"


def type_of(command: Node) -> str:
    """The type of a Command's element."""
    return command.get("type") if command.tag == "command" else command.tag


def holder_of(command: Node, name: str) -> tuple[Node, str]:
    """The element and its attribute that have the value of a Command's argument: a param, or itself."""
    param = next((one for one in command.all("param") if one.get("name") == name), None)
    return (command, name) if param is None else (param, "value")


@dataclass(slots=True, eq=False)
class CommandTemplate:
    """A Command element; arguments are values or expressions."""

    type: str
    args: dict[str, Json | Expression]
    text: Text | None
    now: bool
    extra: tuple[tuple[str, str | Expression], ...]
    handlers: tuple[Handler, ...]
    node: Node
    lang: str = ""
    restartable: bool = False


@dataclass(slots=True, eq=False)
class GroupTemplate:
    """A unit around Commands (U4)."""

    steps: tuple[StepTemplate, ...]
    longest: int
    node: Node
    restartable: bool = False


@dataclass(slots=True, eq=False)
class StepTemplate:
    """A node of the tree built from a run of Commands (U3)."""

    what: CommandTemplate | GroupTemplate
    after: tuple[int, ...]


@dataclass(slots=True, eq=False)
class CommandRun:
    """Consecutive Commands, requested at once (O4)."""

    steps: tuple[StepTemplate, ...]
    node: Node


@dataclass(slots=True, eq=False)
class Declare:
    """A var."""

    name: str
    expr: Expression | None
    node: Node


@dataclass(slots=True, eq=False)
class Script:
    """A script."""

    code: Expression
    node: Node


@dataclass(slots=True, eq=False)
class Assign:
    """An assign."""

    name: str
    expr: Expression
    node: Node


@dataclass(slots=True, eq=False)
class Clear:
    """A clear; no names means all form items."""

    names: tuple[str, ...]
    node: Node


@dataclass(slots=True, eq=False)
class If:
    """Conditions with their content; the last may have none (else)."""

    branches: tuple[tuple[Expression | None, tuple[Act, ...]], ...]
    node: Node


@dataclass(slots=True, eq=False)
class Foreach:
    """A foreach."""

    item: str
    array: Expression
    content: tuple[Act, ...]
    node: Node


@dataclass(slots=True, eq=False)
class Log:
    """A log."""

    label: str
    text: Text
    node: Node


@dataclass(slots=True, eq=False)
class Throw:
    """A throw."""

    event: str | Expression
    message: str | Expression
    node: Node


@dataclass(slots=True, eq=False)
class Goto:
    """A goto: to a form, or to an item of this one."""

    form: str | Expression | None
    item: str | Expression | None
    node: Node


@dataclass(slots=True, eq=False)
class Return:
    """A return."""

    names: tuple[str, ...]
    event: str
    node: Node


@dataclass(slots=True, eq=False)
class Exit:
    """An exit."""

    node: Node


@dataclass(slots=True, eq=False)
class Reprompt:
    """A reprompt."""

    node: Node


@dataclass(slots=True, eq=False)
class SendOut:
    """A send: to a service, or an event to this application itself after a delay."""

    service: str | Expression
    event: str
    delay: int | Expression
    params: tuple[tuple[str, str | Expression], ...]
    node: Node


Act = (
    CommandRun
    | Declare
    | Script
    | Assign
    | Clear
    | If
    | Foreach
    | Log
    | Throw
    | Goto
    | Return
    | Exit
    | Reprompt
    | SendOut
)


@dataclass(slots=True, eq=False)
class Handler:
    """A handler of events, by their names or prefixes of them (VoiceXML 5.2.2)."""

    events: tuple[str, ...]
    cond: Expression | None
    count: int
    reactive: bool | None
    content: tuple[Act, ...]
    node: Node
    waits: bool = False
    """Whether it contains a Command, whose end is waited for."""
    fresh: int | None = None
    """How long (ms) the reaction is worth starting (X8)."""


HOLDING = frozenset([If, Foreach, CommandRun])
"""Kinds of content that hold other content."""


Made = TypeVar("Made")
Flattened = list[tuple[Made, tuple[int, ...]]]
"""Steps, each with the indices of those that it waits for."""


def arrange(
    nodes: Iterable[Node],
    make: Callable[[Node], Made | None],
    visit: Callable[[Node], None] = lambda _: None,
) -> Flattened[Made]:
    """Commands and units one after another (U3).

    Args:
        nodes: the elements, ``par`` and ``seq`` among them.
        make: makes a step of a Command or of an ``iu``, if it gives any.
        visit: is called for each element before what is in it.
    """
    found: Flattened[Made] = []

    def add(nodes: Iterable[Node], after: tuple[int, ...]) -> tuple[int, ...]:
        """Gives what whatever follows has to wait for."""
        for node in nodes:
            visit(node)
            if node.tag == "par":
                ends = [end for branch in node.nodes for end in add([branch], after)]
                after = tuple(dict.fromkeys(ends)) or after
            elif node.tag == "seq":
                after = add(node.nodes, after)
            elif (made := make(node)) is not None:
                found.append((made, after))
                after = (len(found) - 1,)
        return after

    add(nodes, ())
    return found


def all_acts(content: Sequence[Act]) -> list[Act]:
    """Executable content with nested content, in document order."""
    if HOLDING.isdisjoint(map(type, content)):
        return list(content)
    found: list[Act] = []
    for act in content:
        found.append(act)
        for held in _held(act) if type(act) in HOLDING else ():
            found += all_acts(held)
    return found


def _held(act: Act) -> Iterator[Sequence[Act]]:
    """The content nested in an act."""
    if isinstance(act, If):
        yield from (branch for _, branch in act.branches)
    elif isinstance(act, Foreach):
        yield act.content
    elif isinstance(act, CommandRun):
        for command in run_commands(act.steps):
            yield from (handler.content for handler in command.handlers)


def run_commands(steps: Sequence[StepTemplate]) -> list[CommandTemplate]:
    """The Commands of a run, those inside units included."""
    found: list[CommandTemplate] = []
    for step in steps:
        if isinstance(step.what, GroupTemplate):
            found += run_commands(step.what.steps)
        else:
            found.append(step.what)
    return found


def commands_of(content: Sequence[Act]) -> list[CommandTemplate]:
    """The Commands of executable content."""
    runs = [act for act in all_acts(content) if isinstance(act, CommandRun)]
    return [command for run in runs for command in run_commands(run.steps)]
