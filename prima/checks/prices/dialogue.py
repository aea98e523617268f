"""Prices of an application in PRIMA's language, and the order of its parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Self

from prima.checks.prices.contents import handlers_of, hooks_of, own_contents, sent_by
from prima.checks.prices.firsts import Firsts, asks_at_most, responds
from prima.checks.prices.model import SPEECH, Gap, Outline, Price, PricedReaction, PricedState
from prima.checks.prices.own import OwnEvents
from prima.checks.prices.texts import words_of
from prima.checks.prices.times import ASKED_AGAIN, OFTEN, SERVICES, Times, is_inner
from prima.devices.profile import Profile
from prima.errors import Place, UsageError
from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    Expression,
    Foreach,
    Goto,
    Handler,
    Return,
    SendOut,
    all_acts,
)
from prima.interpreter.elements import Document, Field, Form, Item, Link, Subdialog, Unit, all_items
from prima.interpreter.entering import goes_to_item, is_left
from prima.interpreter.rounds import EventLeads, raised_in
from prima.interpreter.selection import takes
from prima.interpreter.units import Finder
from prima.script.choices import choices
from prima.script.literals import WORDS

MOST_INNER, MOST_SCOPES = 40_000, 16_000_000
"""Maximum number of pairs of a form and a handler for all forms that are followed: for events of
the application's own, and for any."""


class DialoguePrices(Times):
    """The indivisible parts of an application in PRIMA's language, and its outline."""

    form_word = "form"
    """What its language calls a form in messages."""

    def __init__(self, document: Document, profile: Profile, finder: Finder | None = None) -> None:
        super().__init__(document, profile, finder or Finder(document))
        self.inside: set[int] = set()
        """The elements in units, by their identities."""
        self.sent = sent_by(document)
        self.parts: list[Price] = []
        """All indivisible parts, in document order."""

    def price(self) -> Self:
        """Find all parts and what they last."""
        document = self.document
        for form in document.forms.values():
            for item in all_items(form.items):
                self._item(item, form)
        self.parts = self._parts()
        self.firsts = Firsts(document, self.of_items, self.step)
        self.responses = Firsts(document, self.of_items, self.step, response=True)
        self.own = OwnEvents(document, self.parts, self.steps, self.raised)
        self._leads = EventLeads(self.raised)
        self._inner = {id(one) for _, one in handlers_of(document) if self.takes_inner(one)}
        """The handlers of events that the application causes itself, by their identities."""
        self._everywhere = [one for one in document.handlers if id(one) in self._inner]
        return self

    def _parts(self) -> list[Price]:
        """What items and content outside of units consist of, each once."""
        found = [one for one in self.of_items.values() if id(one.node) not in self.inside]
        for _, content, node in self.document.contents():
            if id(node) not in self.inside:
                found += self.steps(content)
        once = {id(price): price for price in found}.values()
        return sorted(once, key=lambda price: price.node.index)

    def _item(self, item: Item, form: Form) -> None:
        if isinstance(item, Field):
            self.of_items[item.node.index] = self.question(item, form)
        elif isinstance(item, Unit):
            for inner in item.items:
                self._item(inner, form)
            self.inside |= {id(one) for node in item.node.nodes for one in node.walk()}
            self.of_items[item.node.index] = self.unit(item, form)

    # States -----------------------------------------------------------------------------

    def outline(self) -> Outline:
        """All that is known of the application.

        Raises:
            UsageError: it has too many forms and handlers.
        """
        forms = self.document.forms.values()
        self._check_size(len(forms), sum(1 for _ in handlers_of(self.document)))
        states = {self.name_of(form): self._state(form) for form in forms}
        reactions: list[PricedReaction] = []
        joins: list[PricedReaction] = []
        for form, handler in handlers_of(self.document):
            does = joins if handler.reactive is False else reactions
            does += self._reactions(handler, form, self.own.leads_round(handler, form))
        for form, hook in hooks_of(self.document):
            if hook.reactive is not False:
                reactions += self._reactions(hook, form, False)
        reactions += [self._link(link, None) for link in self.document.links]
        reactions += [self._link(link, form) for form in forms for link in form.links]
        holds = [hold for form in forms for hold in _holds(form)]
        return Outline(self.parts, states, reactions, self._wakes(), holds, [], joins)

    def _check_size(self, forms: int, handlers: int) -> None:
        scopes = (forms + handlers) * len(self.document.handlers)
        if forms * len(self._everywhere) > MOST_INNER or scopes > MOST_SCOPES:
            raise UsageError(
                f"{self.document.node.place.file}: there are {forms:,} forms and {handlers:,} handlers,"
                " too many to follow what leads where. Split the document."
            )

    def _link(self, link: Link, form: Form | None) -> PricedReaction:
        """The effect of a link, in a form or in all."""
        content = () if link.form else self._hearing(link.event, form)
        does = self._content(PricedState(SPEECH, link.node), [content], form)
        if link.form:
            does.goes[link.form] = link.node
        begins = self._begins(content, form, link.form)
        stays = None if link.form or is_left(content, goes_to_item) else _name(form)
        words = words_of(link.node)
        return PricedReaction((SPEECH,), link.node, *begins, does, stays, words, self._later())

    def _begins(
        self, content: Sequence[Act], form: Form | None, name: str = ""
    ) -> tuple[list[Price], list[Price], Mapping[frozenset[str], int]]:
        """The first Commands of content or of a named form, those up to its response, and how long
        those that begin at once keep devices.

        Raises:
            UsageError: too many forms lead to one another before the first Command.
        """
        found = []
        try:
            for firsts in (self.firsts, self.responses):
                found.append(firsts.of_form(name) if name else firsts.of(content, form))
        except RecursionError:
            file = self.document.node.place.file
            raise UsageError(
                f"{file}: too many {self.form_word}s lead to one another before anything is done."
                " Go there more directly."
            ) from None
        begins, until = found
        return begins, until if any(map(responds, until)) else [], self.firsts.together

    def _later(self) -> list[Gap]:
        """The delayed events after which the response searched for may come."""
        return [_goes_on(act) for act in self.responses.later]

    def _wakes(self) -> list[PricedState]:
        """The reactions to its own delayed events."""
        return [
            self._content(PricedState(one.events[0], one.node), [one.content], form)
            for form, one in handlers_of(self.document)
            if any(name in self.sent for name in one.events)
        ]

    def _hearing(self, event: str, form: Form | None) -> tuple[Act, ...]:
        """The reactions to an event that a link throws."""
        scope = [*(form.handlers if form else ()), *self.document.handlers]
        return tuple(
            act for one in scope if any(takes(name, event) for name in one.events)
            for act in one.content
        )  # fmt: skip

    def _state(self, form: Form) -> PricedState:
        """The activity of a form, and the states that its answers and its own events lead to."""
        state = PricedState(self.name_of(form), form.node)
        contents: list[Sequence[Act]] = []
        answers: list[Sequence[Act]] = [
            filled.content for filled in form.filled if id(filled.node) not in self.inside
        ]
        handlers = [*form.handlers, *self._everywhere]
        for item in all_items(form.items):
            handlers += item.handlers
            self._add_item(state, item, form)
            if id(item.node) not in self.inside:
                (answers if isinstance(item, Field) else contents).extend(own_contents(item))
        inner = [one for one in handlers if id(one) in self._inner]
        self._leads.among(inner)
        state.repeats += [
            Gap(one.node.place, f"what is done about {one.events[0]} leads to it again")
            for one in inner
            if self._leads.round(one)
        ]
        self._content(state, contents, form)
        for one in inner:
            self._content(state, [one.content], form, inside=id(one.node) in self.inside)
        state.onward, brought = set(state.goes), set(state.brings)
        self._content(state, {id(one): one for one in answers}.values(), form)
        state.brings = brought
        return state

    def _add_item(self, state: PricedState, item: Item, form: Form) -> None:
        """Add the activity of an item: it asks, calls another form, or is a unit."""
        if isinstance(item, Field):
            state.raises |= {"noinput", "nomatch"}
        if id(item.node) in self.inside:
            return  # it ends with its unit
        price = self.of_items.get(item.node.index)
        if price is not None:
            state.parts.append(price)
        if isinstance(item, Subdialog):
            state.calls |= dict.fromkeys(self.leads(item), item.node)
        elif isinstance(item, Field):
            most = asks_at_most(item, form, self.document)
            state.times += max(most - 1, 0)
            if not most:
                state.repeats.append(Gap(item.node.place, ASKED_AGAIN))
        elif isinstance(item, Unit):
            for inner in all_items(item.items):
                self._content(state, [*own_contents(inner)], form, inside=True)

    def _content(
        self,
        state: PricedState,
        contents: Iterable[Sequence[Act]],
        form: Form | None,
        inside: bool = False,
    ) -> PricedState:
        """Add the activity of pieces of content, and where they lead."""
        for content in contents:
            state.raises |= self.own.raised(content)
            state.brings |= self.own.brought(content)
            if not inside:
                state.parts += self.steps(content)
            for act in all_acts(content):
                self._lead(state, act, form)
        return state

    def _lead(self, state: PricedState, act: Act, form: Form | None) -> None:
        place = act.node.place
        match act:
            case Goto() if goes_to_item(act):
                state.repeats.append(
                    Gap(place, f"an item of the {self.form_word} is visited again")
                )
            case Goto():
                state.goes |= dict.fromkeys(self.leads(act), act.node)
            case Clear():
                state.repeats.append(Gap(place, f"items of the {self.form_word} are visited again"))
            case Assign() if form and _may_unset(act, form):
                again = f"an item of the {self.form_word} may be visited again"
                state.repeats.append(Gap(place, again))
            case Foreach() if self.steps(act.content):
                state.unknown.append(Gap(place, OFTEN))
            case SendOut() if act.event:
                state.unknown.append(_goes_on(act))

    def leads(self, act: Goto | Subdialog) -> Iterable[str]:
        """The states to which an act or a call leads."""
        return self.document.forms if isinstance(act.form, Expression) else [act.form or ""]

    def name_of(self, form: Form) -> str:
        """The name of a form's state."""
        return form.id

    # Events -----------------------------------------------------------------------------

    def raised(self, content: Sequence[Act]) -> set[str]:
        """The application's own events after which content goes on by itself."""
        return raised_in(content)

    def _reactions(
        self, handler: Handler, form: Form | None, rounds: bool
    ) -> Iterator[PricedReaction]:
        """What a handler does about events from outside and, if it is declared to react to them,
        about the application's own (C5); ``rounds`` if it leads to itself again."""
        foreign, own = self._divided(handler.events)
        does = self._content(PricedState(handler.events[0], handler.node), [handler.content], form)
        begins = self._begins(handler.content, form)
        later = self._later()
        stays = None if is_left(handler.content, _stays) else _name(form)
        if foreign:
            made = self._made(foreign[0], handler) if rounds and not own else None
            yield PricedReaction(
                foreign, handler.node, *begins, does, stays, later=later, made=made
            )
        if own and handler.reactive:
            made = self._made(own[0], handler) if rounds else None
            often = Gap(handler.node.place, f"how often its own event {own[0]} comes")
            yield PricedReaction(
                own, handler.node, *begins, does, stays, later=later, made=made, often=often
            )

    @staticmethod
    def _made(event: str, handler: Handler) -> Gap:
        return Gap(handler.node.place, f"what is done about {event} leads to it again")

    def _divided(self, events: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Events from outside, and the application's own."""
        foreign = tuple(name for name in events if self._foreign(name))
        return foreign, tuple(name for name in events if name not in foreign)

    def _foreign(self, name: str) -> bool:
        """Whether an event comes from the user or the surroundings, not from itself."""
        own = name in self.sent or name in self.thrown or is_inner(name)
        return not own or name == "error" or takes(SERVICES, name)


def _goes_on(act: SendOut) -> Gap:
    return Gap(act.node.place, f"its own event {act.event} makes it go on later")


def _may_unset(act: Assign, form: Form) -> bool:
    """Whether an assign may make the variable of an item undefined, as no text or word does."""
    code = act.expr.code
    known = code in WORDS or all(one.whole or one.text for one in choices(code))
    return not known and act.name in {one.name for one in all_items(form.items)}


def _stays(act: Act) -> bool:
    return isinstance(act, Return) or goes_to_item(act)


def _name(form: Form | None) -> str:
    return form.id if form is not None else ""


def _holds(form: Form) -> list[tuple[Place, int]]:
    """How long the stream of a form or its items is held (ms), by their attributes."""
    holding: list[Form | Item] = [form, *all_items(form.items)]
    return [(one.node.attribute_place("stream"), one.hold) for one in holding if one.hold]
