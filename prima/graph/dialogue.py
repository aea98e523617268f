"""The states of an application in PRIMA's own language."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import PurePath

from prima.graph.labels import (
    ASKED,
    LEAVES_USER,
    NO_REPLY,
    AnswerLabel,
    answered,
    condition,
    joined,
    known,
    literals,
    notes,
    sayings,
)
from prima.graph.model import Graph, GraphNode, clean, settle
from prima.graph.throws import Taker
from prima.graph.transitions import ANY, Branches, Transitions
from prima.interpreter.acts import (
    Act,
    CommandRun,
    CommandTemplate,
    Exit,
    Expression,
    Foreach,
    Goto,
    GroupTemplate,
    Handler,
    If,
    Return,
    SendOut,
    Text,
    Throw,
    all_acts,
    run_commands,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Link,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.entering import goes_to_item, is_left
from prima.interpreter.events import DEFAULTS
from prima.language.commands import TABLE_4_2


def states(document: Document) -> Graph:
    """The states of an application and the transitions between them."""
    return _DialogueGraph(document).graph


class _DialogueGraph(Transitions[Act]):
    goes_on = DEFAULTS

    def __init__(self, document: Document) -> None:
        super().__init__(f"The states of {clean(document.id)}")
        self.document = document
        self.own = _takers(document.handlers)
        for form in document.forms.values():
            self._form(form)
        self._everywhere()
        settle(self.graph, {ANY: list(document.forms)})

    def _form(self, form: Form) -> None:
        """Add a state and all transitions of it."""
        node = self.graph.node(form.id, form.id, start=not self.graph.nodes)
        place = form.node.place
        node.source = f"{PurePath(place.file).name}:{place.line}"
        self.here = form.id
        self.hints = _hints(self.document, form)
        self._links(form.links)
        items = all_items(form.items)
        many = sum(isinstance(item, Field) for item in items) > 1
        handlers = _takers(form.handlers)
        around = _around(form.items)
        for item in items:
            self.scopes = [*around[id(item)], handlers, self.own]
            self._item(item, many)
        self.scopes = [handlers, self.own]
        for filled in form.filled:
            self.content(filled.content, answered(filled.names, filled.mode))
        self.handlers(handlers)
        _describe(node, form, items)

    def _item(self, item: Item, many: bool) -> None:
        """Add the transitions of an item; with ``many`` questions, those of one have its name."""
        conditions = [condition(item.cond.code)] if item.cond else []
        where = ""
        if isinstance(item, Block):
            self.content(item.content, "then", conditions)
        elif isinstance(item, Subdialog):
            name = clean(item.node.get("name") or item.form)
            label = joined(f"subdialog {name}", conditions)
            self.graph.edge(self.here, item.form, "call", label)
            self._filleds(item.filled, f"{name} has returned", NO_REPLY)
        elif isinstance(item, Field):
            where = f"{item.name}: " if many else ""
            reply = AnswerLabel(item.name, item.answers.type == "boolean")
            self._filleds(item.filled, f"{item.name} answered" if many else "answered", reply)
        self.handlers(_takers(item.handlers), where)

    def _everywhere(self) -> None:
        """Add the document's own handlers and links, which are active in all states."""
        self.here = ANY
        self.hints = _hints(self.document, None)
        self.scopes = [self.own]
        self.handlers(self.own)
        self._links(self.document.links)
        if self.graph.out(ANY):
            self.graph.node(ANY, "in any state", kind="any")

    def _states(self) -> Iterable[tuple[str, Sequence[Taker[Act]]]]:
        return ((form.id, _takers(form.handlers)) for form in self.document.forms.values())

    # Transitions ------------------------------------------------------------------------------

    def _links(self, links: Iterable[Link]) -> None:
        for link in links:
            if link.form:
                label = f"said {sayings(link.node.all('grammar'))}"
                self.graph.edge(self.here, link.form, "go", label)

    def _filleds(self, filleds: Sequence[Filled], base: str, reply: AnswerLabel) -> None:
        for filled in filleds:
            self.content(filled.content, base, (), reply)

    def _leaves(self, act: Act, label: str) -> bool:
        match act:
            case Goto():
                self._goto(act, label)
            case Exit():
                self.graph.edge(self.here, "", "exit", label)
            case Return():
                thrown = f", throws {act.event}" if act.event else ""
                self.graph.edge(self.here, "", "return", label + thrown)
            case Throw():
                if not isinstance(act.event, Expression):
                    self.throw(act.event, label)
            case _:
                return False
        return True

    def _passes(self, act: Act, base: str, conditions: list[str], reply: AnswerLabel) -> None:
        if isinstance(act, Foreach):
            self.content(act.content, base, conditions, reply)
        elif isinstance(act, CommandRun):
            for command in run_commands(act.steps):
                self.handlers(_takers(command.handlers), of=f" of {_title(command)}")

    def _branches(self, act: Act) -> Branches[Act]:
        if not isinstance(act, If):
            return ()
        return [(cond.code if cond else None, acts) for cond, acts in act.branches]

    def _goto(self, act: Goto, label: str) -> None:
        if isinstance(act.form, Expression):
            for name in literals(act.form.code, self.document.forms):
                self.graph.edge(self.here, name, "guess", label)
            self.graph.edge(self.here, "", "computed", label, act.form.code)
        elif act.form:
            self.graph.edge(self.here, act.form, "go", label)


def _describe(node: GraphNode, form: Form, items: Sequence[Item]) -> None:
    """Describe a state: its marks, and what it asks or says."""
    leaving = [one for one in _commands(_contents(form)) if one.type in LEAVES_USER]
    questions = [text for item in items if isinstance(item, Field) for text in _asked(item)]
    said = [one.text for one in _commands(_blocks(form)) if one.text]
    goals = dict.fromkeys(_goal(one) for one in leaving)
    node.marks = _marks(form, items, bool(leaving))
    node.notes = notes(questions, _text(said[0]) if said and not questions else "", [*goals][:2])


def _marks(form: Form, items: Sequence[Item], leaving: bool) -> list[str]:
    """The special properties of a state, each in one or two words."""
    fields = [item for item in items if isinstance(item, Field)]
    steps = [step.what for run in _runs(_contents(form)) for step in run.steps]
    marks = {
        "asks": bool(fields),
        "sleeps": not _leaves_at_its_end(form.items),
        "leaves the user": leaving,
        "unit": any(isinstance(one, Unit | GroupTemplate) for one in [*items, *steps]),
        "holds its stream": any(
            hold is not None for hold in [form.hold, *(item.hold for item in items)]
        ),
        "faces the user": form.connect or any(field.connect for field in fields),
    }
    return [mark for mark, applies in marks.items() if applies]


def _takers(handlers: Iterable[Handler]) -> list[Taker[Act]]:
    return [
        Taker(one.content, one.events, one.count, one.cond.code if one.cond else "", _stays(one))
        for one in handlers
    ]


def _around(items: Sequence[Item], outer: Sequence[_Scope] = ()) -> dict[int, list[_Scope]]:
    """The handlers of each item and of the units around it, innermost first, by its identity."""
    found: dict[int, list[_Scope]] = {}
    for item in items:
        found[id(item)] = [_takers(item.handlers), *outer]
        if isinstance(item, Unit):
            found |= _around(item.items, found[id(item)])
    return found


_Scope = Sequence[Taker[Act]]


def _hints(document: Document, form: Form | None) -> dict[str, list[str]]:
    """The known sources of events in a state: links, watches, its own delays."""
    parts: list[Document | Form] = [document, form] if form else [document]
    contents: list[Sequence[Act]] = [handler.content for handler in document.handlers]
    contents += _contents(form) if form else []
    sources: list[tuple[str, str]] = []
    for link in chain.from_iterable(part.links for part in parts):
        sources.append((link.event, f"said {sayings(link.node.all('grammar'))}"))
    for watch in chain.from_iterable(part.watches for part in parts):
        sources.append((watch.name, clean(watch.when.code)))
    for act in chain.from_iterable(map(all_acts, contents)):
        if isinstance(act, SendOut):
            sources.append((act.event, _when(act)))
    return known(source for source in sources if source[0])


def _when(act: SendOut) -> str:
    return f"after {act.delay / 1000:g} s" if isinstance(act.delay, int) else "later"


def _blocks(form: Form) -> list[Sequence[Act]]:
    """The content of a state's blocks."""
    return [item.content for item in all_items(form.items) if isinstance(item, Block)]


def _contents(form: Form) -> list[Sequence[Act]]:
    """All executable content of a state."""
    found = _blocks(form)
    found += [handler.content for handler in form.handlers]
    found += [filled.content for filled in form.filled]
    for item in all_items(form.items):
        found += [handler.content for handler in item.handlers]
        if isinstance(item, Field | Subdialog):
            found += [filled.content for filled in item.filled]
    return found


def _runs(contents: list[Sequence[Act]]) -> list[CommandRun]:
    """The runs of Commands in content."""
    return [act for content in contents for act in all_acts(content) if isinstance(act, CommandRun)]


def _commands(contents: list[Sequence[Act]]) -> list[CommandTemplate]:
    """The Commands in content."""
    return [command for run in _runs(contents) for command in run_commands(run.steps)]


def _leaves_at_its_end(items: Sequence[Item]) -> bool:
    """Whether a state is left before its items end, so that it never waits for events."""
    return any(_leaves_state(item) for item in items if item.cond is None and item.expr is None)


def _leaves_state(item: Item) -> bool:
    match item:
        case Block():
            return is_left(item.content, goes_to_item)
        case Unit():
            return _leaves_at_its_end(item.items)
        case Field() | Subdialog():
            return any(is_left(filled.content, goes_to_item) for filled in item.filled)
    return False


def _stays(handler: Handler) -> bool:
    """Whether a handler does something without a transition."""
    acts = all_acts(handler.content)
    ways = any(isinstance(act, Goto | Exit | Return | Throw) for act in acts)
    return bool(acts) and not ways and not ASKED.issuperset(handler.events)


def _title(command: CommandTemplate) -> str:
    row = TABLE_4_2.get(command.type)
    return row.title if row else clean(command.type)


def _goal(command: CommandTemplate) -> str:
    """A Command that leaves the user, and its goal."""
    to = command.args.get("to")
    goal = f"{{{to.code}}}" if isinstance(to, Expression) else str(to or "")
    return f"{_title(command)}{' to ' + goal if goal else ''}"


def _asked(field: Field) -> list[str]:
    """The first words of a question; none if it has no prompt."""
    first = [prompt.text for prompt in field.prompts if prompt.count == 1][:1]
    return [_text(text) for text in first or [prompt.text for prompt in field.prompts[:1]]]


def _text(text: Text) -> str:
    """Text with its expressions in braces."""
    shown = [f"{{{part.code}}}" if isinstance(part, Expression) else part for part in text]
    return "".join(part if isinstance(part, str) else " " for part in shown)
