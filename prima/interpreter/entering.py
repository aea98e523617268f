"""A form's actions on entry, up to a question or a wait for events."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from prima.interpreter.acts import Act, Exit, Expression, Goto, Handler, If, Return, Throw, all_acts
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Subdialog,
    all_items,
)
from prima.interpreter.selection import beginnings
from prima.script.choices import choices

MOST_STEPS = 100_000
"""Maximum number of paths followed in an application; beyond, only gotos to the same form count."""


class FormTarget(NamedTuple):
    """The full name of a form, or the prefix of those that an expression may name.

    A full name that ends with ``#`` names the document's first form.
    """

    name: str
    known: bool = True


@dataclass(frozen=True, slots=True)
class EnteredDocument:
    """A document with the semantics of its language."""

    document: Document
    foreign: Callable[[str], bool]
    """Whether a handler's event may come from outside, other than as an answer."""
    leads: Callable[[Goto | Subdialog], list[FormTarget]]
    """The forms that a goto or the call of a subdialog leads to."""
    queues: bool = False
    """Whether blocks are played with the next question, and a goto from a handler does not repeat
    a question (VoiceXML 4.1.8, 5.3.6)."""

    def target(self, form: Form) -> FormTarget:
        """One of its forms, by its full name."""
        return FormTarget(f"{self.document.file}#{form.id}")


def forms_of(sources: Iterable[EnteredDocument]) -> Iterator[tuple[EnteredDocument, Form]]:
    """All forms of some documents, each with its document."""
    return ((source, form) for source in sources for form in source.document.forms.values())


class ContentFacts:
    """Looks up facts about an application's content, up to a limit."""

    def __init__(self) -> None:
        self.left = MOST_STEPS
        self._items: dict[int, dict[str, Item]] = {}
        self._asked: dict[int, Field | None] = {}

    def acts(self, content: Sequence[Act], scope: Callable[[], Sequence[Handler]]) -> list[Act]:
        """The acts of content, and the handlers in its scope that take what it throws."""
        found: list[Act] = []
        contents, taken = [content], set[int]()
        while contents:
            for act in all_acts(contents.pop()):
                found.append(act)
                thrown = act.event if isinstance(act, Throw) else None
                taker = self.taker(thrown, scope()) if isinstance(thrown, str) else None
                if taker is not None and id(taker) not in taken:
                    taken.add(id(taker))
                    contents.append(taker.content)
        return found

    def taker(self, event: str, scope: Sequence[Handler]) -> Handler | None:
        """The first handler of a scope that takes an event that is thrown."""
        if self.left <= 0:
            return None
        self.left -= len(scope)
        names = set(beginnings(event))
        return next((one for one in scope if not names.isdisjoint(one.events)), None)

    def items(self, form: Form) -> dict[str, Item]:
        """The items of a form by their names."""
        if id(form) not in self._items:
            self._items[id(form)] = {one.name: one for one in all_items(form.items)}
        return self._items[id(form)]

    def asked(self, form: Form) -> Field | None:
        """The first question of a form."""
        if id(form) not in self._asked:
            fields = (one for one in form.items if isinstance(one, Field))
            self._asked[id(form)] = next(fields, None)
        return self._asked[id(form)]

    def named(self, act: Goto, form: Form) -> list[Item]:
        """The items of a form that a goto certainly names."""
        items = self.items(form)
        return [items[name] for name in _named(act) if name in items]

    def gone(self, acts: Iterable[Act], form: Form) -> list[Item]:
        """The items of a form that acts certainly go to."""
        return [one for act in acts if isinstance(act, Goto) for one in self.named(act, form)]


@dataclass(slots=True)
class _Entry:
    """A form entered up to its first question, or a call that asks one."""

    source: EnteredDocument
    form: Form
    todo: list[Item]
    """The items still to visit, in reverse order."""
    seen: set[int] = field(default_factory=set)
    called: set[str] = field(default_factory=set)
    """The names of the subdialogs that have been called, and of those that have returned."""
    returned: set[str] = field(default_factory=set)
    leads: dict[FormTarget, None] = field(default_factory=dict)
    waiting: dict[str, list[tuple[set[str], Filled]]] | None = None
    """The form's actions on answers, by the names of the items; computed on demand."""

    @property
    def name(self) -> FormTarget:
        """The form as a target."""
        return self.source.target(self.form)

    def scope(self, item: Item) -> Callable[[], list[Handler]]:
        """The handlers that may take what is thrown in an item."""
        return lambda: [*item.handlers, *self.form.handlers, *self.source.document.handlers]


class Entering:
    """Enters every form; one that waits for a subdialog continues once that is known to return."""

    def __init__(self, sources: Sequence[EnteredDocument], contents: ContentFacts) -> None:
        self._contents = contents
        self._entries = [
            _Entry(source, form, [*reversed(form.items)]) for source, form in forms_of(sources)
        ]
        self._firsts = {f"{one.source.document.file}#": one for one in reversed(self._entries)}
        """The first forms of documents."""
        self._before: dict[FormTarget, list[FormTarget]] = defaultdict(list)
        """The forms with a goto to one."""
        self._callers: dict[FormTarget, list[tuple[_Entry, Subdialog]]] = defaultdict(list)
        self._returns: dict[FormTarget, set[str]] = defaultdict(set)
        """How a called form returns: without an event, or with which ones."""
        self._told: list[tuple[FormTarget, str]] = []
        """Forms that return, and how, still to be processed."""

    def exact(self, target: FormTarget) -> FormTarget:
        """A target with the name of its form, also if that is its document's first."""
        first = self._firsts.get(target.name) if target.known else None
        return first.name if first is not None else target

    def onward(self) -> dict[FormTarget, list[FormTarget]]:
        """Where each form leads on its own."""
        for entry in self._entries:
            self._advance(entry)
        while self._told:
            self._tell(*self._told.pop())
        return {one.name: [*one.leads] for one in self._entries}

    def _tell(self, name: FormTarget, event: str) -> None:
        """A form returns: so do those that go to it, and its callers continue."""
        if event in self._returns[name]:
            return
        self._returns[name].add(event)
        self._told += [(one, event) for one in self._before[name]]
        for entry, item in self._callers[name]:
            self._come_back(entry, item, event)
            self._advance(entry)

    def _come_back(self, entry: _Entry, item: Subdialog, event: str) -> None:
        """A subdialog returns, with an event to throw in its caller or without."""
        if not event:
            entry.returned.add(item.name)
            return
        scope = entry.scope(item)
        taker = self._contents.taker(event, scope())
        self._take(entry, self._contents.acts(taker.content if taker else (), scope))

    def _advance(self, entry: _Entry) -> None:
        """Visit the items of a form until one waits."""
        while entry.todo:
            item = entry.todo[-1]
            if isinstance(item, Subdialog) and item.expr is None:
                self._call(entry, item)
            if not isinstance(item, Block) and item.name not in entry.returned:
                return
            entry.todo.pop()
            if id(item) not in entry.seen and item.expr is None:
                entry.seen.add(id(item))
                self._visit(entry, item)

    def _call(self, entry: _Entry, item: Subdialog) -> None:
        if item.name in entry.called:
            return
        entry.called.add(item.name)
        for target in map(self.exact, entry.source.leads(item)):
            entry.leads[target] = None
            self._callers[target].append((entry, item))
            for event in sorted(self._returns[target]):
                self._come_back(entry, item, event)

    def _visit(self, entry: _Entry, item: Item) -> None:
        """Follow an item's content: it may leave the form, or go to another item."""
        contents = [item.content] if isinstance(item, Block) else [*self._answered(entry, item)]
        scope = entry.scope(item)
        acts = [act for content in contents for act in self._contents.acts(content, scope)]
        left = item.cond is None and any(map(is_left, contents))
        gone = self._contents.gone(acts, entry.form)
        self._take(entry, acts)
        if left and not gone:
            entry.todo.clear()
        entry.todo += [one for one in reversed(gone) if left or isinstance(one, Block)]

    def _answered(self, entry: _Entry, item: Item) -> Iterator[tuple[Act, ...]]:
        """The content executed once a subdialog has returned."""
        if isinstance(item, Subdialog):
            yield from (one.content for one in item.filled)
        if entry.waiting is None:
            items = self._contents.items(entry.form).values()
            entry.waiting = _waiting(entry.form, items)
        for names, filled in entry.waiting.get(item.name, ()) if self._contents.left > 0 else ():
            self._contents.left -= len(names)
            if filled.mode == "any" or entry.returned >= names:
                yield filled.content

    def _take(self, entry: _Entry, acts: Iterable[Act]) -> None:
        """Note where acts lead."""
        for act in acts:
            if isinstance(act, Return):
                self._told.append((entry.name, act.event))
            elif isinstance(act, Goto) and act.item is None:
                for target in map(self.exact, entry.source.leads(act)):
                    entry.leads[target] = None
                    self._before[target].append(entry.name)
                    self._told += [(entry.name, one) for one in sorted(self._returns[target])]


def _named(act: Goto) -> list[str]:
    if act.item is None or isinstance(act.item, str):
        return [act.item] if act.item else []
    return [one.text for one in choices(act.item.code) if one.whole]


def is_open(act: Goto) -> bool:
    """Whether only a run determines to which item a goto leads."""
    item = act.item
    return isinstance(item, Expression) and not all(one.whole for one in choices(item.code))


def is_left(content: Sequence[Act], stays: Callable[[Act], bool] = lambda _: False) -> bool:
    """Whether content always goes elsewhere, by an act that does not count as staying."""
    for act in content:
        if isinstance(act, Goto | Exit | Return):
            return not stays(act)
        complete = isinstance(act, If) and act.branches[-1][0] is None
        if isinstance(act, If) and complete and all(is_left(one, stays) for _, one in act.branches):
            return True
    return False


def goes_to_item(act: Act) -> bool:
    """Whether an act goes to an item of its own form."""
    return isinstance(act, Goto) and act.item is not None


def _waiting(form: Form, items: Iterable[Item]) -> dict[str, list[tuple[set[str], Filled]]]:
    """A form's actions on answers, by each item that gives one, with the items that it awaits."""
    inputs = {one.name for one in items if isinstance(one, Field | Subdialog)}
    found: dict[str, list[tuple[set[str], Filled]]] = defaultdict(list)
    for filled in form.filled:
        names = set(filled.names) or inputs
        for name in names:
            found[name].append((names, filled))
    return found
