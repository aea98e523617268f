"""The states of an application in PRIMA's own language."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import PurePath

from prima.graph.labels import (
    ASKED,
    condition,
    handled,
    joined,
    literals,
    otherwise,
    quoted,
    sayings,
)
from prima.graph.model import Graph, Node, clean, settle
from prima.graph.throws import Taker, Throws, chosen
from prima.interpreter.acts import (
    Act,
    CommandTemplate,
    Exit,
    Expression,
    Foreach,
    Goto,
    GroupTemplate,
    Handler,
    If,
    Return,
    Run,
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
from prima.interpreter.events import DEFAULTS
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2

ANY = ":any"
"""The key for all states; no form can have it as its id."""
QUESTIONS = 3
"""Number of questions of a state that are shown."""


def states(document: Document) -> Graph:
    """The states of an application and the transitions between them."""
    return _Reader(document).graph


class _Reader:
    def __init__(self, document: Document) -> None:
        self.document = document
        self.graph = Graph(f"The states of {clean(document.id)}")
        self.here = ANY
        self.hints: dict[str, list[str]] = {}
        self.scopes: list[Sequence[Handler]] = []
        """The handlers that may take a thrown event, innermost first."""
        self.throws = Throws()
        for form in document.forms.values():
            self._form(form)
        self._everywhere()
        settle(self.graph, {ANY: list(document.forms)})

    def _form(self, form: Form) -> None:
        node = self.graph.node(form.id, form.id, start=not self.graph.nodes)
        place = form.node.place
        node.source = f"{PurePath(place.file).name}:{place.line}"
        self.here = form.id
        self.hints = _hints(self.document, form)
        self._links(form.links)
        items = all_items(form.items)
        asked = [item for item in items if isinstance(item, Field)]
        around = _around(form.items)
        for item in items:
            self.scopes = [*around[id(item)], form.handlers, self.document.handlers]
            conditions = [condition(item.cond.code, "", False)] if item.cond else []
            if isinstance(item, Block):
                self._content(item.content, "then", conditions)
            elif isinstance(item, Subdialog):
                base = clean(item.node.get("name") or item.form)
                self._to(item.form, "call", joined(f"subdialog {base}", conditions))
                self._filleds(item.filled, f"{base} has returned", "", False)
            elif isinstance(item, Field):
                base = "answered" if len(asked) == 1 else f"{item.name} answered"
                self._filleds(item.filled, base, item.name, item.answers.type == "boolean")
            where = "" if len(asked) < 2 or not isinstance(item, Field) else f"{item.name}: "
            self._handlers(item.handlers, where)
        self.scopes = [form.handlers, self.document.handlers]
        for filled in form.filled:
            names = ", ".join(filled.names) or "all"
            self._content(filled.content, f"{names} answered", [])
        self._handlers(form.handlers)
        self._describe(node, form, items)

    def _describe(self, node: Node, form: Form, items: Sequence[Item]) -> None:
        """Describe a state: its marks, and what it asks or says."""
        commands = _commands(_contents(form))
        leaving = [one for one in commands if _leaves(one)]
        node.marks = _marks(form, items, bool(leaving))
        questions = [text for item in items if isinstance(item, Field) for text in _asked(item)]
        node.notes = [f"asks {quoted(text)}" for text in questions[:QUESTIONS]]
        if len(questions) > QUESTIONS:
            node.notes.append(f"and {len(questions) - QUESTIONS} more")
        said = [one for one in _commands(_blocks(form)) if one.text]
        if not questions and said:
            node.notes.append(f"says {quoted(_text(said[0].text or ()))}")
        goals = dict.fromkeys(_goal(one) for one in leaving)
        node.notes += [clean(goal) for goal in list(goals)[:2]]

    def _everywhere(self) -> None:
        """Add the document's own handlers and links, which are active in all states."""
        self.here = ANY
        self.hints = _hints(self.document, None)
        self.scopes = [self.document.handlers]
        self._handlers(self.document.handlers)
        self._links(self.document.links)
        if self.graph.out(ANY):
            self.graph.node(ANY, "in any state", kind="any")

    # What leads away ------------------------------------------------------------------------

    def _links(self, links: Iterable[Link]) -> None:
        for link in links:
            if link.form:
                self._to(link.form, "go", f"said {sayings(link.node.all('grammar'))}")

    def _filleds(self, filleds: Sequence[Filled], base: str, name: str, truth: bool) -> None:
        for filled in filleds:
            self._content(filled.content, base, [], name, truth)

    def _handlers(self, handlers: Sequence[Handler], where: str = "", of: str = "") -> None:
        for handler in handlers:
            cond = handler.cond.code if handler.cond else ""
            told = handled(handler.events, handler.count, cond, self.hints)
            self._content(handler.content, f"{where}{told}{of}", [])
            if not of and self.here != ANY and _stays(handler):
                self.graph.edge(self.here, self.here, "stay", told)

    def _content(
        self,
        content: Sequence[Act],
        base: str,
        conditions: list[str],
        name: str = "",
        truth: bool = False,
    ) -> bool:
        """Add all transitions of content; return whether it never reaches its end."""
        conditions = list(conditions)
        for act in content:
            told = joined(base, conditions)
            match act:
                case Goto():
                    self._goto(act, told)
                    return True
                case Exit():
                    self.graph.edge(self.here, "", "exit", told)
                    return True
                case Return():
                    thrown = f", throws {act.event}" if act.event else ""
                    self.graph.edge(self.here, "", "return", told + thrown)
                    return True
                case Throw():
                    self._throw(act.event, told)
                    return True
                case If():
                    over, left = self._branches(act, base, conditions, name, truth)
                    if over:
                        return True
                    conditions += left
                case Foreach():
                    self._content(act.content, base, conditions, name, truth)
                case Run():
                    for command in run_commands(act.steps):
                        self._handlers(command.handlers, of=f" of {_title(command)}")
        return False

    def _branches(
        self, act: If, base: str, conditions: list[str], name: str, truth: bool
    ) -> tuple[bool, list[str]]:
        """Add the transitions of an ``if``; return whether it never ends, and what holds after it."""
        ends: list[bool] = []
        told: list[str] = []
        for cond, branch in act.branches:
            one = condition(cond.code, name, truth) if cond else otherwise(told)
            ends.append(self._content(branch, base, [*conditions, one], name, truth))
            told.append(one)
        complete = act.branches[-1][0] is None
        return all(ends) and complete, [otherwise(told)] if any(ends) and not complete else []

    def _goto(self, act: Goto, told: str) -> None:
        if isinstance(act.form, Expression):
            for name in literals(act.form.code, self.document.forms):
                self.graph.edge(self.here, name, "guess", told)
            self.graph.edge(self.here, "", "computed", told, act.form.code)
        elif act.form:
            self._to(act.form, "go", told)

    def _throw(self, event: str | Expression, told: str) -> None:
        """Add the transitions of handlers that take a thrown event, unless it is computed."""
        if isinstance(event, Expression):
            return
        with self.throws.following(event) as followed:
            if not followed:
                return
            if self.here == ANY:
                self._throw_in_states(event, told)
            self._taken(event, told)

    def _throw_in_states(self, event: str, told: str) -> None:
        """Events that the document's handlers throw go to a state's own handlers first."""
        for form in self.document.forms.values():
            if any(takes(name, event) for handler in form.handlers for name in handler.events):
                self.here, self.scopes = form.id, [form.handlers]
                self._taken(event, told, ends=False)
        self.here, self.scopes = ANY, [self.document.handlers]

    def _taken(self, event: str, told: str, ends: bool = True) -> None:
        found, always = chosen(
            Taker(handler, handler.count, handler.cond.code if handler.cond else "")
            for scope in self.scopes
            for handler in scope
            if any(takes(name, event) for name in handler.events)
        )
        told = f"{told}, throws {event}"
        for one in found:
            self._content(one.handler.content, one.told(told), [])
            if self.here != ANY and _stays(one.handler):
                self.graph.edge(self.here, self.here, "stay", one.told(told))
        if ends and not always and not any(takes(name, event) for name in DEFAULTS):
            self.graph.edge(self.here, "", "exit", told)

    def _to(self, form: str, kind: str, told: str) -> None:
        if form in self.document.forms:
            self.graph.edge(self.here, form, kind, told)
        else:
            self.graph.edge(self.here, "", "missing", told, form)


def _marks(form: Form, items: Sequence[Item], leaving: bool) -> list[str]:
    """The special properties of a state, each in one or two words."""
    runs = _runs(_contents(form))
    fields = [item for item in items if isinstance(item, Field)]
    grouped = any(isinstance(step.what, GroupTemplate) for run in runs for step in run.steps)
    holds = [form.hold, *(item.hold for item in items)]
    marks = {
        "asks": bool(fields),
        "sleeps": not _leaves_at_its_end(form.items),
        "leaves the user": leaving,
        "unit": grouped or any(isinstance(item, Unit) for item in items),
        "holds its stream": any(hold is not None for hold in holds),
        "faces the user": form.connect or any(field.connect for field in fields),
    }
    return [mark for mark, applies in marks.items() if applies]


def _around(items: Sequence[Item], outer: Sequence[Sequence[Handler]] = ()) -> _Scopes:
    """The handlers of each item and of the units around it, innermost first, by its identity."""
    found: _Scopes = {}
    for item in items:
        found[id(item)] = [item.handlers, *outer]
        if isinstance(item, Unit):
            found |= _around(item.items, found[id(item)])
    return found


_Scopes = dict[int, list[Sequence[Handler]]]


def _hints(document: Document, form: Form | None) -> dict[str, list[str]]:
    """The known sources of events in a state: links, watches, its own delays."""
    found: dict[str, list[str]] = {}
    for link in [*document.links, *(form.links if form else [])]:
        if link.event:
            found.setdefault(link.event, []).append(f"said {sayings(link.node.all('grammar'))}")
    for watch in [*document.watches, *(form.watches if form else [])]:
        found.setdefault(watch.name, []).append(clean(watch.when.code))
    contents: list[Sequence[Act]] = [handler.content for handler in document.handlers]
    contents += _contents(form) if form else []
    for act in [act for content in contents for act in all_acts(content)]:
        if isinstance(act, SendOut) and act.event:
            told = f"after {act.delay / 1000:g} s" if isinstance(act.delay, int) else "later"
            found.setdefault(act.event, []).append(told)
    return {event: list(dict.fromkeys(hints)) for event, hints in found.items()}


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


def _runs(contents: list[Sequence[Act]]) -> list[Run]:
    """The runs of Commands in content."""
    return [act for content in contents for act in all_acts(content) if isinstance(act, Run)]


def _commands(contents: list[Sequence[Act]]) -> list[CommandTemplate]:
    """The Commands in content."""
    return [command for run in _runs(contents) for command in run_commands(run.steps)]


def _leaves_at_its_end(items: Sequence[Item]) -> bool:
    """Whether a state is left before its items end, so that it never waits for events."""
    for item in items:
        if item.cond is not None or item.expr is not None:
            continue
        if isinstance(item, Block):
            left = _never_ends(item.content)
        elif isinstance(item, Unit):
            left = _leaves_at_its_end(item.items)
        elif isinstance(item, Field | Subdialog):
            left = any(_never_ends(filled.content) for filled in item.filled)
        else:
            left = False
        if left:
            return True
    return False


def _never_ends(content: Sequence[Act]) -> bool:
    """Whether content always leaves its state."""
    for act in content:
        if isinstance(act, Goto | Exit | Return):
            return not (isinstance(act, Goto) and act.item is not None)
        complete = isinstance(act, If) and act.branches[-1][0] is None
        if isinstance(act, If) and complete and all(_never_ends(one) for _, one in act.branches):
            return True
    return False


def _stays(handler: Handler) -> bool:
    """Whether a handler does something without a transition."""
    acts = all_acts(handler.content)
    ways = any(isinstance(act, Goto | Exit | Return | Throw) for act in acts)
    return bool(acts) and not ways and not ASKED.issuperset(handler.events)


def _leaves(command: CommandTemplate) -> bool:
    row = TABLE_4_2.get(command.type)
    return row is not None and row.leaves


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
