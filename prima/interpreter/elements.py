"""A document as values: what an interpreter runs, each with the place it was written at."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from prima.grammar.answers import Answers
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.messages import Json

Text = tuple["str | Expression | Pause", ...]
"""Text with expressions and pauses in it, in order."""


@dataclass(frozen=True, slots=True)
class Pause:
    """A silence inside of what is said, in ms."""

    lasts: int


def pauses_in(text: Text | None) -> int:
    """How long all pauses of a text last together, in ms."""
    return sum(part.lasts for part in text or () if isinstance(part, Pause))


@dataclass(slots=True, eq=False)
class Expression:
    """ECMAScript, and the element and attribute that hold it."""

    code: str
    node: Node
    attribute: str = "expr"


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
    """A node of the tree that a run of Commands becomes (U3)."""

    what: CommandTemplate | GroupTemplate
    after: tuple[int, ...]


@dataclass(slots=True, eq=False)
class Run:
    """Commands that follow one another: requested at once (O4)."""

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
    Run
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
    """Whether there is a Command in it, whose end is waited for."""
    fresh: int | None = None
    """For how long (ms) the reaction is worth starting (X8)."""


@dataclass(slots=True, eq=False)
class Link:
    """Something the user may say at any time in its scope."""

    form: str
    event: str
    answers: Answers
    node: Node


@dataclass(slots=True, eq=False)
class Watch:
    """An event defined by a condition on sensor values (C6)."""

    name: str
    when: Expression
    node: Node


@dataclass(slots=True, eq=False)
class Filled:
    """A filled: its fields; none means those of the form."""

    mode: str
    names: tuple[str, ...]
    content: tuple[Act, ...]
    node: Node


@dataclass(slots=True, eq=False)
class Prompt:
    """A prompt of a field."""

    text: Text
    count: int
    cond: Expression | None
    timeout: int | None
    bargein: bool | None
    node: Node


@dataclass(slots=True, eq=False)
class Item:
    """What every form item has."""

    name: str
    expr: Expression | None
    cond: Expression | None
    handlers: tuple[Handler, ...]
    properties: dict[str, Json]
    node: Node
    hold: int | None
    """How long (ms) its stream is kept open for an event afterwards (X3)."""


@dataclass(slots=True, eq=False)
class Block(Item):
    """Content that runs once."""

    content: tuple[Act, ...] = ()


@dataclass(slots=True, eq=False)
class Field(Item):
    """A question."""

    prompts: tuple[Prompt, ...] = ()
    answers: Answers = field(default_factory=Answers)
    filled: tuple[Filled, ...] = ()
    lang: str = ""
    connect: bool = False
    """Whether the robot turns to the user before it asks (X4)."""


@dataclass(slots=True, eq=False)
class Subdialog(Item):
    """A call of another form."""

    form: str = ""
    params: tuple[tuple[str, str | Expression], ...] = ()
    filled: tuple[Filled, ...] = ()


@dataclass(slots=True, eq=False)
class Unit(Item):
    """A unit around form items (U5), with the devices and Commands of all its content."""

    items: tuple[Item, ...] = ()
    devices: frozenset[str] = frozenset()
    types: tuple[str, ...] = ()
    longest: int = 60000


@dataclass(slots=True, eq=False)
class Form:
    """A state of the application."""

    id: str
    items: tuple[Item, ...]
    handlers: tuple[Handler, ...]
    links: tuple[Link, ...]
    watches: tuple[Watch, ...]
    setup: tuple[Declare | Script, ...]
    filled: tuple[Filled, ...]
    properties: dict[str, Json]
    node: Node
    hold: int | None = None
    connect: bool = False
    words: str = ""
    """What is said when its stream resumes after others have spoken (X9)."""
    takers: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)
    """The handlers that take an event in it, as far as it has happened: by the event's name, or by
    the name of the item that was being visited and the event's."""
    bare: bool = False
    """Whether there is nothing to do when it is entered but to wait for events."""

    def __post_init__(self) -> None:
        self.bare = not (self.items or self.setup or self.watches)


Holder = Handler | Filled | Block
"""What holds executable content."""
Content = tuple[Form | None, tuple[Act, ...], Node]
"""A piece of executable content, with its form and the element that holds it."""


@dataclass(slots=True, eq=False)
class Document:
    """A whole application."""

    id: str
    kind: str
    lang: str
    file: str
    forms: dict[str, Form]
    handlers: tuple[Handler, ...]
    links: tuple[Link, ...]
    watches: tuple[Watch, ...]
    setup: tuple[Declare | Script, ...]
    properties: dict[str, Json]
    node: Node
    expressions: list[Expression] = field(default_factory=list)
    """All its code, but for scripts."""
    scripted: bool = False
    """Whether there is a script, or something is assigned to a part of a variable."""
    counting: bool = False
    """Whether any handler looks at how often its event has occurred."""
    plain: bool | None = None
    """Whether all its code can be evaluated without an engine; None until somebody has looked."""
    curious: bool = False
    """Whether any code may look at the event that is being handled."""
    sensors: tuple[frozenset[str] | None] | None = None
    """Which sensors any code may look at; None until somebody has looked: see :mod:`prima.interpreter.sensors`."""
    _holders: tuple[list[Form | None], list[Holder]] | None = field(
        default=None, repr=False, compare=False
    )

    def contents(self) -> Iterator[Content]:
        """Every piece of executable content, with its form and the element that holds it."""
        if self._holders is None:  # every check asks again; a document does not change
            self._holders = self._gather()
        return ((form, one.content, one.node) for form, one in zip(*self._holders, strict=True))

    def _gather(self) -> tuple[list[Form | None], list[Holder]]:
        """What holds content, and beside it the forms in which it stands."""
        holders: list[Holder] = [*self.handlers]
        forms: list[Form | None] = [None] * len(holders)
        for form in self.forms.values():
            held: list[Holder] = [*form.handlers, *form.filled]
            for item in all_items(form.items):
                held += item.handlers
                if isinstance(item, Block):
                    held.append(item)
                elif isinstance(item, Field | Subdialog):
                    held += item.filled
            holders += held
            forms += [form] * len(held)
        return forms, holders


Kind = TypeVar("Kind", bound=Act)


class Acts:
    """The executable content of a document by kinds, gathered once; with the forms it stands in."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._found: dict[type, tuple[list[Form | None], list[Any]]] = {}
        """Acts by kinds, and beside them their forms: a pair for each would be many objects."""
        found = self._found
        for form, content, _ in document.contents():
            for act in all_acts(content):
                kind = type(act)
                if kind not in found:
                    found[kind] = [], []
                forms, acts = found[kind]
                forms.append(form)
                acts.append(act)

    def of(self, kind: type[Kind]) -> Iterator[tuple[Form | None, Kind]]:
        """All of a kind in document order, each with its form; None stands for the document."""
        return zip(*self._found.get(kind, ((), ())), strict=True)

    def among(self, *kinds: type[Act]) -> list[Act]:
        """All of some kinds, in document order."""
        if self._found.keys().isdisjoint(kinds):
            return []
        contents = self._document.contents()
        return [act for _, one, _ in contents for act in all_acts(one) if isinstance(act, kinds)]


def all_items(items: Sequence[Item]) -> Sequence[Item]:
    """Form items, those inside units included, in document order."""
    if Unit not in map(type, items):
        return items
    found: list[Item] = []
    for item in items:
        found.append(item)
        if isinstance(item, Unit):
            found += all_items(item.items)
    return found


def all_acts(content: Sequence[Act]) -> list[Act]:
    """Executable content with all that it holds, in document order."""
    if HOLDING.isdisjoint(map(type, content)):
        return list(content)
    found: list[Act] = []
    for act in content:
        found.append(act)
        if isinstance(act, If):
            for _, branch in act.branches:
                found += all_acts(branch)
        elif isinstance(act, Foreach):
            found += all_acts(act.content)
        elif isinstance(act, Run):
            for command in run_commands(act.steps):
                for handler in command.handlers:
                    found += all_acts(handler.content)
    return found


HOLDING = frozenset([If, Foreach, Run])
"""What holds other content."""


def run_commands(steps: Sequence[StepTemplate]) -> list[CommandTemplate]:
    """The Commands of a run, those inside units included."""
    found: list[CommandTemplate] = []
    for step in steps:
        if isinstance(step.what, GroupTemplate):
            found += run_commands(step.what.steps)
        else:
            found.append(step.what)
    return found
