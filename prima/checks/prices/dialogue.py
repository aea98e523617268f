"""Prices of an application in PRIMA's language, and the order of its parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from prima.checks.prices.commands import command_price, group_price, unit_price
from prima.checks.prices.contents import (
    again,
    contents_of,
    handlers_of,
    hooks_of,
    inside,
    own_contents,
    sent_by,
    thrown_by,
)
from prima.checks.prices.firsts import Firsts, asks_at_most, is_left, responds
from prima.checks.prices.model import SPEECH, Gap, Outline, Price, Reaction, State, devices_of
from prima.checks.prices.own import OwnEvents
from prima.checks.prices.texts import Constants, words_of
from prima.devices.profile import Profile
from prima.devices.voice import duration
from prima.errors import Place
from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandTemplate,
    Expression,
    Foreach,
    Goto,
    Handler,
    Pause,
    Run,
    SendOut,
    StepTemplate,
    Text,
    all_acts,
    pauses_in,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Form,
    Item,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.rounds import leads_round, raised_in
from prima.interpreter.selection import takes
from prima.interpreter.units import reach_of
from prima.language.commands import TABLE_4_2

UNKNOWN_LETTERS = 20
"""The assumed text of an expression."""
ASKED_AGAIN = "the question is asked again until the user answers"
OFTEN = "an expression says how often it is done"
SAYS = "an expression gives its text"
QUESTION = TABLE_4_2["q-and-a"]
DEFAULT_TIMEOUT = int(QUESTION.arguments["timeout"].default or 0)
INNER = ("noinput", "nomatch", "help", "end", "cancel", "interrupted", "exit", "error")
"""What begins an event of the application's own: what it does about it is no reaction (C5)."""
BROKEN = ("error.device", "error.unsupported")
"""What happens where a device does not work: then no time holds."""
SERVICES = "error.service"


def outline(document: Document, profile: Profile) -> Outline:
    """The outline of an application in PRIMA's language."""
    return _Reader(document, profile).outline()


class _Reader:
    def __init__(self, document: Document, profile: Profile) -> None:
        self.document = document
        self.profile = profile
        self.of_items: dict[int, Price] = {}
        """Of fields and units, by the index of their element."""
        self.inside: set[int] = set()
        """What stands in a unit."""
        self.constants = Constants(document)
        self.sent = sent_by(document)
        self.thrown = thrown_by(document)
        for form in document.forms.values():
            for item in all_items(form.items):
                self._item(item, form)
        found = [price for index, price in self.of_items.items() if index not in self.inside]
        for _, content, node in document.contents():
            if node.index not in self.inside:
                found += self.steps(content)
        self.parts = sorted(found, key=lambda price: price.node.index)
        self.firsts = Firsts(document, self.of_items, self.step)
        self.responses = Firsts(document, self.of_items, self.step, response=True)
        self.own = OwnEvents(document, self.parts, self.steps)

    def _item(self, item: Item, form: Form) -> None:
        if isinstance(item, Field):
            self.of_items[item.node.index] = self.question(item, form)
        elif isinstance(item, Unit):
            for inner in item.items:
                self._item(inner, form)
            self.inside |= {one.node.index for one in inside(item)}
            self.of_items[item.node.index] = self.unit(item, form)

    # Times ------------------------------------------------------------------------------

    def steps(self, content: Sequence[Act]) -> list[Price]:
        """The parts of executable content."""
        runs = [act for act in all_acts(content) if isinstance(act, Run)]
        return [self.step(step) for run in runs for step in run.steps]

    def step(self, step: StepTemplate) -> Price:
        """A Command, or a unit of them (U4)."""
        what = step.what
        if isinstance(what, CommandTemplate):
            return self.command(what)
        inner = [self.step(one) for one in what.steps]
        return group_price(what.node, what.longest, inner, [one.after for one in what.steps])

    def command(self, command: CommandTemplate) -> Price:
        """A Command by itself."""
        args = {
            name: None if isinstance(value, Expression) else value
            for name, value in command.args.items()
        }
        lang = command.lang or self.document.lang
        speech = self.speech(command.text, lang) if command.text else None
        return command_price(command.node, command.type, args, speech, self.profile)

    def speech(self, text: Text, lang: str) -> tuple[int, str]:
        """The longest duration of a text (ms), and why it may be longer."""
        known = [self._texts(one) for one in text if not isinstance(one, Pause)]
        said = "".join(
            "x" * UNKNOWN_LETTERS if one is None else max(one, key=self._weight(lang), default="")
            for one in known
        )
        spoken = duration(said, lang, self.profile.voices) if known else 0
        return spoken + pauses_in(text), SAYS if None in known else ""

    def _texts(self, piece: str | Expression) -> list[str] | None:
        return self.constants.texts(piece.code) if isinstance(piece, Expression) else [piece]

    def _weight(self, lang: str) -> Callable[[str], int]:
        return lambda text: duration(f"{text} x", lang, self.profile.voices)

    def question(self, field: Field, form: Form) -> Price:
        """A question: its longest prompts and the time in which nobody answers (C4)."""
        settings = (field.properties, form.properties, self.document.properties)
        usual = next((one["timeout"] for one in settings if "timeout" in one), DEFAULT_TIMEOUT)
        lasts, unknown = 1 + int(usual) if self._unsaid(field, form) else 0, ""
        for count in {prompt.count for prompt in field.prompts}:
            said = [prompt for prompt in field.prompts if prompt.count == count]
            text = [piece for prompt in said for piece in (" ", *prompt.text)][1:]
            speech, why = self.speech(tuple(text), field.lang or self.document.lang)
            stated = [prompt.timeout for prompt in said]
            timeout = max(int(usual) if one is None else one for one in stated)
            unknown = unknown or why
            lasts = max(lasts, speech + max(timeout, 1))
        return Price(
            field.node, "question", QUESTION.devices, lasts, unknown, engages=True, listens=True
        )

    def _unsaid(self, field: Field, form: Form) -> bool:
        """Whether a question may be asked silently, as a handler may not repeat it aloud."""
        always = any(prompt.count == 1 and prompt.cond is None for prompt in field.prompts)
        handlers = [*field.handlers, *form.handlers, *self.document.handlers]
        return not always or any(self._inner(one) for one in handlers)

    def unit(self, unit: Unit, form: Form) -> Price:
        """A unit around form items: its longest duration, and what runs then to its end (U5)."""
        inner = [price for one in inside(unit) for price in self._within(one, unit)]
        reached = reach_of(self.document, form, unit).commands
        inner += [self.command(one.command) for one in reached if not one.inside]
        once = all(isinstance(item, Block) and not item.handlers for item in unit.items)
        last = max((one.lasts for one in inner), default=0)
        lasts = unit.longest + last
        if once and not unit.handlers and not any(again(item) for item in unit.items):
            lasts = min(lasts, sum(one.lasts for one in inner))
        return unit_price(unit.node, unit.devices | devices_of(inner), lasts, inner)

    def _within(self, part: Item | Handler, unit: Unit) -> list[Price]:
        own = self.of_items.get(part.node.index) if part is not unit else None
        return ([own] if own else []) + [
            price for content in contents_of(part) for price in self.steps(content)
        ]

    # States -----------------------------------------------------------------------------

    def outline(self) -> Outline:
        """All that is known of the application."""
        document = self.document
        states = {form.id: self._state(form) for form in document.forms.values()}
        reactions = [
            reaction
            for form, handler in handlers_of(document)
            for reaction in self._reactions(handler, form, self.own.leads_round(handler, form))
        ]
        for form, hook in hooks_of(document):
            reactions += self._reactions(hook, form, False)
        for scope in (None, *document.forms.values()):
            for link in document.links if scope is None else scope.links:
                content = () if link.form else self._hearing(link.event, scope)
                does = self._content(State(SPEECH, link.node), [content], scope)
                if link.form:
                    does.goes[link.form] = link.node
                begins = self._begins(content, scope, link.form)
                stays = None if link.form or is_left(content) else _name(scope)
                reactions.append(
                    Reaction(
                        (SPEECH,),
                        link.node,
                        *begins,
                        does,
                        stays,
                        words_of(link.node),
                        self._later(),
                    )
                )
        holds: list[tuple[Place, int]] = []
        for form in document.forms.values():
            holding: list[Form | Item] = [form, *all_items(form.items)]
            holds += [(one.node.attribute_place("stream"), one.hold) for one in holding if one.hold]
        return Outline(self.parts, states, reactions, self._wakes(), holds, [])

    def _begins(
        self, content: Sequence[Act], form: Form | None, name: str = ""
    ) -> tuple[list[Price], list[Price]]:
        """What content does first, or the form of a name; and up to its response."""
        found = []
        for firsts in (self.firsts, self.responses):
            found.append(firsts.of_form(name) if name else firsts.of(content, form))
        begins, until = found
        return begins, until if any(map(responds, until)) else []

    def _later(self) -> list[Gap]:
        """The delayed events after which a response may come that has been looked for."""
        return [_goes_on(act) for act in self.responses.later]

    def _wakes(self) -> list[State]:
        """What is done about its own delayed events."""
        return [
            self._content(State(one.events[0], one.node), [one.content], form)
            for form, one in handlers_of(self.document)
            if any(name in self.sent for name in one.events)
        ]

    def _hearing(self, event: str, form: Form | None) -> tuple[Act, ...]:
        """What is done about an event that a link throws."""
        scope = [*(form.handlers if form else ()), *self.document.handlers]
        return tuple(
            act for one in scope if any(takes(name, event) for name in one.events)
            for act in one.content
        )  # fmt: skip

    def _state(self, form: Form) -> State:
        """What a form does, and what its answers and its own events lead to."""
        state = State(form.id, form.node)
        contents: list[Sequence[Act]] = [filled.content for filled in form.filled]
        handlers = [*form.handlers, *self.document.handlers]
        for item in all_items(form.items):
            handlers += item.handlers
            self._add_item(state, item, form)
            contents += [] if item.node.index in self.inside else own_contents(item)
        inner = [one for one in handlers if self._inner(one)]
        state.repeats += [
            Gap(one.node.place, f"what is done about {one.events[0]} leads to it again")
            for one in inner
            if leads_round(one, inner, raised_in)
        ]
        contents += [one.content for one in inner]
        return self._content(state, contents, form)

    def _add_item(self, state: State, item: Item, form: Form) -> None:
        """What an item does itself: it asks, or calls another form, or is a unit."""
        price = self.of_items.get(item.node.index)
        if price is not None and item.node.index not in self.inside:
            state.parts.append(price)
        if isinstance(item, Subdialog):
            state.calls[item.form] = item.node
        elif isinstance(item, Field):
            state.raises |= {"noinput", "nomatch"}
            most = asks_at_most(item, form, self.document)
            state.times += max(most - 1, 0)
            if not most:
                state.repeats.append(Gap(item.node.place, ASKED_AGAIN))
        elif isinstance(item, Unit):
            for inner in all_items(item.items):
                self._content(state, [*own_contents(inner)], form, inside=True)

    def _content(
        self,
        state: State,
        contents: Iterable[Sequence[Act]],
        form: Form | None,
        inside: bool = False,
    ) -> State:
        """Add what pieces of content do, and where they lead."""
        for content in contents:
            state.raises |= self.own.raised(content)
            if not inside:
                state.parts += self.steps(content)
            for act in all_acts(content):
                self._lead(state, act, form)
        return state

    def _lead(self, state: State, act: Act, form: Form | None) -> None:
        place = act.node.place
        match act:
            case Goto(form=str(name)) if name:
                state.goes[name] = act.node
            case Goto(form=Expression()):
                state.goes |= dict.fromkeys(self.document.forms, act.node)
            case Goto():
                state.repeats.append(Gap(place, "an item of the form is visited again"))
            case Clear():
                state.repeats.append(Gap(place, "items of the form are visited again"))
            case Assign() if form and act.name in {one.name for one in all_items(form.items)}:
                state.repeats.append(Gap(place, "an item of the form may be visited again"))
            case Foreach() if self.steps(act.content):
                state.unknown.append(Gap(place, OFTEN))
            case SendOut() if act.event:
                state.unknown.append(_goes_on(act))

    # Events -----------------------------------------------------------------------------

    def _reactions(self, handler: Handler, form: Form | None, rounds: bool) -> Iterator[Reaction]:
        """What a handler does as a reaction: to events from outside, and where its author says so
        to the application's own (C5); ``rounds`` if it leads to itself again."""
        if handler.reactive is False:
            return
        foreign = tuple(name for name in handler.events if self._foreign(name))
        own = tuple(name for name in handler.events if name not in foreign)
        does = self._content(State(handler.events[0], handler.node), [handler.content], form)
        begins = self._begins(handler.content, form)
        later = self._later()
        stays = None if is_left(handler.content, back=False) else _name(form)
        if foreign:
            made = self._made(foreign[0], handler) if rounds and not own else None
            yield Reaction(foreign, handler.node, *begins, does, stays, later=later, made=made)
        if own and handler.reactive:
            made = self._made(own[0], handler) if rounds else None
            often = Gap(handler.node.place, f"how often its own event {own[0]} comes")
            yield Reaction(
                own, handler.node, *begins, does, stays, later=later, made=made, often=often
            )

    @staticmethod
    def _made(event: str, handler: Handler) -> Gap:
        return Gap(handler.node.place, f"what is done about {event} leads to it again")

    def _foreign(self, name: str) -> bool:
        """Whether an event comes from the user or the surroundings, not from itself."""
        own = name in self.sent or name in self.thrown or _is_inner(name)
        return not own or name == "error" or takes(SERVICES, name)

    def _inner(self, handler: Handler) -> bool:
        """Whether it may take an event of what the application is doing, without a wait."""
        names = [name for name in handler.events if not name.startswith((*BROKEN, SERVICES))]
        return any(_is_inner(name) or name in self.thrown for name in names)


def _goes_on(act: SendOut) -> Gap:
    return Gap(act.node.place, f"its own event {act.event} makes it go on later")


def _is_inner(name: str) -> bool:
    return any(takes(one, name) for one in INNER)


def _name(form: Form | None) -> str:
    return form.id if form is not None else ""
