"""Sentences that are said twice because an event made the application leave in mid-speech (O3)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from posixpath import basename

from prima.errors import Hint, Problem
from prima.errors.diagnoses.behaviour import TOLD_TWICE
from prima.interpreter.acts import Expression, Goto, Handler, SendOut, Throw
from prima.interpreter.elements import (
    Acts,
    Block,
    Document,
    Field,
    Form,
    Item,
    Subdialog,
    all_items,
)
from prima.interpreter.entering import EnteredDocument, FormTarget, forms_of, is_open
from prima.interpreter.leaving import Leaving, brings_news, cleared_by, goes_by, said_first
from prima.interpreter.returning import callers_of, calls_again, returns_of, told_again
from prima.interpreter.selection import beginnings
from prima.interpreter.ways import Ways
from prima.markup.tree import Node
from prima.script.choices import choices

SAID_AGAIN = TOLD_TWICE.says(
    'If "{event}" comes while the {form} {asks} this ({line}), it {told} said twice: {why}'
)

OWN = (
    *("noinput", "nomatch", "help", "end", "cancel", "interrupted", "expired", "exit", "error"),
    "emergency",
)
"""Prefixes of events that the application causes itself, or that end everything."""
LOST = "human.lost"
MOST_FOUND = 5_000
"""Maximum number of repetitions searched for: a list of problems ends long before."""
STEPS_OF_AN_ITEM = 20
"""Checking an item counts as so many steps."""
REMEDY = "Leave out the <goto>: the speech then continues. Or give the speech a cond."
GUESSED = " If it never leads there, name its targets in the expression: x ? '{0}this' : '{0}that'."


@dataclass(frozen=True, slots=True)
class _Back:
    """How something is said twice: an event interrupts it, and a goto leads back."""

    form: Form
    said: Node
    asks: bool
    event: str
    way: Goto
    certain: bool
    """Whether the goto's target is known without a run, and the target."""


def source_of(document: Document, acts: Acts) -> EnteredDocument:
    """The source for a document in PRIMA's own language."""

    def leads(act: Goto | Subdialog) -> list[FormTarget]:
        if isinstance(act.form, Expression):
            named = [(one.text.removeprefix("#"), one.whole) for one in choices(act.form.code)]
            return [FormTarget(f"{document.file}#{text}", whole) for text, whole in named]
        return [FormTarget(f"{document.file}#{act.form}")]

    return EnteredDocument(document, _foreign(document, acts), leads)


def told_twice(sources: Sequence[EnteredDocument], remedy: str = REMEDY) -> Iterator[Problem]:
    """Warn of handlers that leave a state and come back to what it says or asks.

    An event may come while that is being said. Where the user has been asked something else on
    the way back, or the state waits for another event, the repetition is intended. So is a question
    asked anew because its user has gone.

    Args:
        sources: the documents of an application.
        remedy: what to do about it.
    """
    ways = Ways(sources)
    backs = chain.from_iterable(_Leavings(source, ways).back() for source in sources)
    told = (one for one in backs if not (one.asks and one.event == LOST))
    found = [*islice(told, MOST_FOUND)]  # as many handlers may lead to each of as many forms
    reported: set[int] = set()
    for one in sorted(found, key=lambda one: not one.certain):
        if one.certain or id(one.way.node) not in reported:  # one example of a guess will do
            reported.add(id(one.way.node))
            yield _problem(one, remedy)
    yield from _returning(sources)


def _returning(sources: Sequence[EnteredDocument]) -> Iterator[Problem]:
    """Warn of handlers that end a subdialog in mid-speech when it will be called again."""
    callers = callers_of(sources)
    for source, form in forms_of(sources) if callers else ():
        said, calls = said_first(form), callers.get(source.target(form), ())
        if said is None or not calls:
            continue
        for event, way in returns_of(form, source):
            if any(calls_again(*one, way.event) for one in calls):
                yield told_again(event, said[0].place.line, said[1], way)


class _Leavings:
    """The handlers of a document that leave its speech because of an outside event."""

    def __init__(self, source: EnteredDocument, ways: Ways) -> None:
        self._source = source
        self._ways = ways
        document = source.document
        self._handlers = [*self._leaving(document.handlers, document.handlers)]
        """The document's own."""
        self._to_any = [one for one in self._handlers if any(way.item for way in one.gotos)]
        """Those that go to items of any form."""
        self._shared: dict[FormTarget, list[tuple[Leaving, Goto, bool]]] = {}
        """The targets of their gotos back, by form."""
        for one in self._handlers:
            for form, way in self._led(one).items():
                self._shared.setdefault(form, []).append((one, *way))

    def back(self) -> Iterator[_Back]:
        """Everything that is said twice."""
        speaking = (form for form in self._source.document.forms.values() if form.items)
        for form in speaking:
            own = [*self._own(form)]
            said = said_first(form)
            if said is not None:
                for leaving, way, certain in self._to_form(form, own):
                    yield _Back(form, *said, leaving.event, way, certain)
            for leaving in own:
                yield from self._to_items(form, leaving)
            for leaving in self._to_any:
                if not leaving.hidden(form):
                    yield from self._to_items(form, leaving)

    def _own(self, form: Form) -> Iterator[Leaving]:
        """The leaving handlers of a form and its items."""
        scope = [*form.handlers, *self._source.document.handlers]
        yield from self._leaving(form.handlers, scope)
        for item in all_items(form.items):
            yield from self._leaving(item.handlers, scope, item)

    def _leaving(
        self, handlers: Iterable[Handler], scope: Sequence[Handler], item: Item | None = None
    ) -> Iterator[Leaving]:
        for handler in handlers:
            event = next(filter(self._source.foreign, handler.events), "")
            if not event or brings_news(handler):
                continue
            acts = self._ways.contents.acts(handler.content, lambda: scope)
            gotos = [act for act in acts if isinstance(act, Goto)]
            if gotos:
                yield Leaving(event, handler.count, gotos, cleared_by(acts), item)

    # Back to a form's beginning -----------------------------------------------------------

    def _led(self, leaving: Leaving) -> dict[FormTarget, tuple[Goto, bool]]:
        """The forms to which a document's handler leads, by which goto, and whether certainly."""
        found: dict[FormTarget, tuple[Goto, bool]] = {}
        for certain in (True, False):
            for way in leaving.gotos if self._ways.contents.left > 0 else ():
                targets = self._source.leads(way) if way.item is None else ()
                for target in targets:
                    forms = self._ways.reached(target, guess=not certain)
                    self._ways.contents.left -= len(forms)
                    found |= {one: (way, certain) for one in forms if one not in found}
        return found

    def _to_form(self, form: Form, own: list[Leaving]) -> Iterator[tuple[Leaving, Goto, bool]]:
        """The handlers that may run while a form speaks, and the gotos back to it."""
        goal = self._source.target(form)
        yield from (one for one in self._shared.get(goal, ()) if not one[0].hidden(form))
        for leaving in own:
            for certain in (True, False):
                way = next((one for one in leaving.gotos if self._leads(one, goal, certain)), None)
                if way is not None:
                    yield leaving, way, certain
                    break

    def _leads(self, way: Goto, goal: FormTarget, certain: bool) -> bool:
        targets = self._source.leads(way) if way.item is None else ()
        return any(self._ways.lead(one, goal, not certain) for one in targets)

    # Back to an item ------------------------------------------------------------------------

    def _to_items(self, form: Form, leaving: Leaving) -> Iterator[_Back]:
        """The speech that a form repeats because a handler goes to one of its items."""
        for way in leaving.gotos:
            self._ways.contents.left -= STEPS_OF_AN_ITEM
            if way.item is None or self._ways.contents.left < 0:
                continue
            for certain in (True, False) if is_open(way) else (True,):
                said = self._said_again(form, way, leaving, certain)
                if said is not None:
                    yield _Back(form, *said, leaving.event, way, certain)
                    return

    def _said_again(
        self, form: Form, way: Goto, leaving: Leaving, certain: bool
    ) -> tuple[Node, bool] | None:
        """The speech that a goto to an item repeats: of the item that it names, or perhaps of any."""
        if certain:
            named = self._ways.contents.named(way, form)
            return next(filter(None, (self._again(form, one, leaving) for one in named)), None)
        items = self._ways.contents.items(form).values()
        return next(filter(None, (self._visited_again(one, leaving) for one in items)), None)

    def _again(self, form: Form, item: Item, leaving: Leaving) -> tuple[Node, bool] | None:
        """The speech that a handler's goto to an item repeats, of that item or of later ones."""
        said = self._visited_again(item, leaving)
        if said is not None or not goes_by(item):
            return said
        for one in self._behind(form, leaving):
            self._ways.contents.left -= STEPS_OF_AN_ITEM
            if one is item:
                continue
            if one.cond is None and one.expr is None and self._heard(one, leaving):
                said = leaving.repeated(one)
            if said is not None or not goes_by(one) or self._ways.contents.left < 0:
                return said
        return None

    def _behind(self, form: Form, leaving: Leaving) -> Iterable[Item]:
        """The items visited after a handler's target: those already asked, and those it clears."""
        items = self._ways.contents.items(form)
        if leaving.cleared is None:
            return items.values()
        found = [items[name] for name in leaving.cleared if name in items]
        asked = leaving.item or self._ways.contents.asked(form)
        if isinstance(asked, Field) and asked.name not in leaving.cleared:
            found.append(asked)
        return sorted(found, key=lambda one: one.node.index)

    def _visited_again(self, item: Item, leaving: Leaving) -> tuple[Node, bool] | None:
        """The speech that an item repeats when a handler goes to it meanwhile."""
        quiet = self._source.queues and isinstance(item, Field)
        return leaving.repeated(item) if not quiet and self._heard(item, leaving) else None

    def _heard(self, item: Item, leaving: Leaving) -> bool:
        """Whether a handler, the item's own or a form's, takes events while the item speaks."""
        queued = self._source.queues and isinstance(item, Block)
        return leaving.item is None or leaving.item is item or queued


def _problem(back: _Back, remedy: str) -> Problem:
    form, place, way = back.form, back.said.place, back.way.node.place
    tag = form.node.tag
    it = f"{tag} {form.id}" if form.id[:1] == "#" else f'{tag} "{form.id}"'
    line = f"line {place.line}" + ("" if place.file == way.file else f" of {basename(place.file)}")
    more = "" if back.certain else GUESSED.format("#" if back.way.item is None else "")
    return SAID_AGAIN.at(
        way,
        Hint(remedy + more),
        event=back.event,
        form=it,
        asks="asks" if back.asks else "says",
        line=line,
        told="is" if back.certain else "may be",
        why=_why(back),
    )


def _why(back: _Back) -> str:
    if back.way.item is None:
        beginning = f"the {back.form.node.tag}'s beginning."
        if back.certain:
            return f"this leads back to {beginning}"
        return f"where this leads depends on an expression, and may be {beginning}"
    if back.certain:
        return f"the {back.form.node.tag} visits it again after this."
    return "which item is next depends on an expression, and may be this one."


def _foreign(document: Document, acts: Acts) -> Callable[[str], bool]:
    """Decides which events may come from outside other than as an answer."""
    chosen = _chosen(document, acts)
    return lambda event: chosen.isdisjoint(beginnings(event))


def _chosen(document: Document, acts: Acts) -> set[str]:
    """Events that the application causes itself, or the user by a link."""
    found = set(OWN)
    for act in acts.among(SendOut, Throw):
        if isinstance(act, SendOut | Throw) and isinstance(act.event, str) and act.event:
            found.add(act.event)
    links = [*document.links, *(one for form in document.forms.values() for one in form.links)]
    return found | {link.event for link in links if link.event}
