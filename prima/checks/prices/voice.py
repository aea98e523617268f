"""Prices of a VoiceXML application, by the sketches of its documents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Self

from prima.checks.prices.dialogue import DialoguePrices
from prima.checks.prices.firsts import responds
from prima.checks.prices.model import (
    Outline,
    Price,
    PricedReaction,
    PricedState,
    add_longer,
    chains,
)
from prima.checks.prices.pages import PricedPages
from prima.checks.prices.speech import SpeechReader, says
from prima.checks.prices.spoken import AllSpeech, DocumentSpeech, is_certain
from prima.checks.prices.times import ASKED_AGAIN, QUESTION, SERVICES
from prima.devices.profile import Profile
from prima.devices.voice import SENTENCE_MS, duration
from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Goto,
    Handler,
    Script,
    all_acts,
)
from prima.interpreter.elements import Field, Form, Item, Subdialog, Unit
from prima.interpreter.entering import goes_to_item, is_left
from prima.interpreter.selection import takes
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.voicexml.acting import VoiceCommand
from prima.voicexml.calls import CONNECT_MS, kind_of
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.pages import TARGETS
from prima.voicexml.platform import own_words
from prima.voicexml.recorder import BEEP_MS
from prima.voicexml.sketch import FETCHING, Sketch
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

LISTENING_MS = 600_000
"""How long a question during a call listens at most, before it is repeated."""
OWN = ("noinput", "nomatch", "help", "cancel", "exit", "error", "maxspeechtimeout")
"""VoiceXML's own events: handling them is not a reaction."""


class VoicePrices:
    """The outline of a VoiceXML application and its further documents."""

    def __init__(self, document: VoiceDocument, profile: Profile) -> None:
        self.pages = PricedPages(document)
        self.documents = [PagePrices(page, self.pages, profile) for page in self.pages]
        everywhere = AllSpeech([one.spoken for one in self.documents])
        for one in self.documents:
            one.everywhere = everywhere
            one.price()

    def outline(self) -> Outline:
        """All that is known of the application.

        Raises:
            UsageError: a document has too many dialogs and handlers.
        """
        parts = [part for one in self.documents for part in one.parts]
        branches: dict[frozenset[str], int] = {}
        for one in self.documents:
            one.add_beginnings(branches)
        states: dict[str, PricedState] = {}
        reactions: list[PricedReaction] = []
        for one in self.documents:
            one.everything, one.branches = parts, branches
            found = one.outline()
            states |= found.states
            reactions += found.reactions
        return Outline(parts, states, reactions, [], [], self.pages.gaps)


class PagePrices(DialoguePrices):
    """The indivisible parts of a VoiceXML document, and its outline, by its sketch.

    What VoiceXML has of its own: prompts with markup, which are queued until the next question;
    recordings and calls; targets in other documents; links and choices; the platform's own
    handlers; reactions after which the dialog goes on.
    """

    form_word = "dialog"

    everywhere: AllSpeech
    """The speech of all documents of the application."""

    def __init__(self, page: Page, pages: PricedPages, profile: Profile) -> None:
        self.page, self.pages = page, pages
        self.everything: list[Price] = []
        """The parts of all documents of the application."""
        self.branches: Mapping[frozenset[str], int] = {}
        """How long (ms) Commands of all documents that begin at once keep devices."""
        self.sketch = Sketch(page, pages.root(page))
        self._reader = SpeechReader(partial(pages.recording, page), pages.longest_choices)
        self._units: set[int] = set()
        """The items in units, by their identities."""
        document = self.sketch.document
        # What the platform's own handlers say is a part of each question.
        handlers = tuple(one for one in document.handlers if one.node is not page.root)
        super().__init__(replace(document, handlers=handlers), profile, self.sketch.finder)
        self.spoken = DocumentSpeech(self.document, self.steps)

    def price(self) -> Self:
        """Find all parts of the document, and those of its links."""
        super().price()
        root = self.page.root
        # Handlers of the application root document are priced with that document.
        self.parts = [one for one in self.parts if one.node.source is root.source]
        links = (one for one in root.walk() if one.tag == "link")
        self.parts += [price for link in links for price in self._fetched(link)]
        return self

    # Prices of parts ----------------------------------------------------------------------

    def _item(self, item: Item, form: Form) -> None:
        """Price an item; a call to somebody else has a price as well."""
        if isinstance(item, Unit):
            self._units |= set(map(id, item.items))
        super()._item(item, form)
        call = self._call(item) if item.node.tag == "transfer" else None
        if call is not None:
            self.of_items[item.node.index] = call

    def said(self, command: CommandTemplate) -> tuple[int, str] | None:
        """How long a prompt or a Command speaks at most (ms), and why it may be longer."""
        if not isinstance(command, VoiceCommand) or not says(command.pieces):
            return None
        holder = command.holder
        choosing = None if holder is None else self._owners.get(id(holder))
        lang = command.node.get("xml:lang") or self.page.lang
        base = command.node.get("xml:base")
        said = self._reader.read(command.pieces, lang, base, choosing)
        return max(said.lasts(self.profile.voices), 1), said.unknown

    @cached_property
    def _owners(self) -> dict[int, Node]:
        """The items with choices, by the identities of what is in them."""
        items = (one for one in self.pages.choosing if one.source is self.page.root.source)
        return {id(inner): item for item in items for inner in item.walk()}

    def question(self, field: Field, form: Form) -> Price:
        """A question: the longest speech that may precede it, and the time for an answer."""
        item, own = field.node, self.spoken.asked_by(field)
        heard = [*own, *self.spoken.by_handlers(form), *self.spoken.anywhere]
        usual = self.spoken.timeout(field, form)
        if not any(map(is_certain, own)):
            heard += self.spoken.said_in(form)
            usual = self.spoken.longest_timeout(form)
            if id(field) not in self._units and not self.spoken.speaks_first(form):
                heard += self.everywhere.said
                usual = max(usual, self.everywhere.timeout)
        stated = [milliseconds(one.node.get("timeout"), usual) for one in heard]
        words = max(own_words(self.page.lang).values(), key=len, default="")
        platform = duration(words, self.page.lang, self.profile.voices)
        lasts = max([platform, *(one.lasts for one in heard)]) + max([usual, *stated, 1]) + 1
        if item.tag == "record":
            lasts += milliseconds(item.get("finalsilence"), 0)
            lasts += BEEP_MS + SENTENCE_MS if item.get("beep") == "true" else 0
        unknown = next((one.unknown for one in heard if one.unknown), "")
        what = "recording" if item.tag == "record" else "question"
        return Price(item, what, QUESTION.devices, lasts, unknown, engages=True, listens=True)

    def _call(self, item: Item) -> Price | None:
        """A call to somebody else: throughout it the robot listens for the user to end it."""
        node, kind = item.node, kind_of(item.node)
        if not isinstance(item, Subdialog) or kind == "blind" or not node.all("grammar"):
            return None
        said = max((one.lasts for one in self.spoken.asked_by(item)), default=0)
        connect = milliseconds(node.get("connecttimeout"), CONNECT_MS)
        longest = milliseconds(node.get("maxtime"), 0) if kind == "bridge" else 1
        lasts = max(min(connect, LISTENING_MS) + said, min(longest or LISTENING_MS, LISTENING_MS))
        return Price(node, "call", QUESTION.devices, lasts, engages=True, listens=True)

    # Dialogs ------------------------------------------------------------------------------

    def name_of(self, form: Form) -> str:
        """The name of a dialog's state."""
        return f"{self.page.uri}#{form.id}"

    def leads(self, act: Goto | Subdialog) -> list[str]:
        """The states to which an act or a call leads."""
        return self.leads_from(act.node)

    def leads_from(self, node: Node) -> list[str]:
        """The states to which an element leads, in any document of the application."""
        return self.pages.leads(self.page, node)[0] if node.key in TARGETS else []

    def _state(self, form: Form) -> PricedState:
        """The activity of a dialog, and where answers, links and its own events lead."""
        state = super()._state(form)
        links = [node for holder in (form.node, *self.sketch.wider) for node in holder.all("link")]
        state.parts += [price for node in links for price in self._fetched(node)]
        for node in [*links, *form.node.all("choice")]:
            state.goes = dict.fromkeys(self.leads_from(node), node) | state.goes
        # What a dialog repeats by itself is told before what it repeats for want of an answer.
        state.repeats.sort(key=lambda one: one.reason == ASKED_AGAIN)
        return state

    def _fetched(self, link: Node) -> list[Price]:
        """What may be played while a link's document is fetched."""
        return self.steps(tuple(self.sketch.fetching(link)))

    def raised(self, content: Sequence[Act]) -> set[str]:
        """No event that makes a dialog go on by itself: what is said waits for a question."""
        return set()

    # Events -------------------------------------------------------------------------------

    def takes_inner(self, handler: Handler) -> bool:
        """Whether it may take an event of the application's own activity."""
        return not all(self._is_outside(name) for name in handler.events)

    def _is_outside(self, name: str) -> bool:
        own = self.pages.throws_any or any(takes(name, one) for one in self.pages.thrown)
        return bool(name) and is_foreign(name) and not own

    def _reactions(
        self, handler: Handler, form: Form | None, rounds: bool
    ) -> Iterator[PricedReaction]:
        """The reaction of a handler to events from outside; it goes on with its dialog."""
        names = tuple(name or "message" for name in handler.events if is_foreign(name))
        if not names or handler.node.source is not self.page.root.source:
            return
        node, content = handler.node, handler.content
        does = self._content(PricedState(node.get("event") or node.tag, node), [content], form)
        left = is_left(content, goes_to_item)
        if form is not None and not left:
            does.goes.setdefault(self.name_of(form), node)
        returns = any(act.node.tag == "return" for act in all_acts(content))
        stays = None if left and not returns else ""
        yield PricedReaction(names, node, *self._after(handler), does, stays)

    def _after(
        self, handler: Handler
    ) -> tuple[list[Price], list[Price], Mapping[frozenset[str], int]]:
        """The first Commands of a handler, and those up to its response: perhaps anything."""
        first = self._first(handler)
        firsts = first or self.everything
        until = firsts if all(map(responds, firsts)) else [*firsts, *self.everything]
        together = chains(first) if first else self.branches
        return firsts, until if any(map(responds, until)) else [], together

    def _first(self, handler: Handler) -> list[Price]:
        """The first Commands of a handler, if they are the same in each case; otherwise nothing."""
        acts = (act for act in handler.content if not isinstance(act, Assign | Clear | Script))
        first = next(acts, None)
        if not isinstance(first, CommandRun) or first.node.tag in FETCHING:
            return []
        if first.node.namespace != PRIMA_NAMESPACE:
            return [self._asked_anew(handler.node)]
        return [self.step(step) for step in first.steps if not step.after]

    def add_beginnings(self, branches: dict[frozenset[str], int]) -> None:
        """Add how long Commands of the document that begin at once, in branches, keep devices."""
        acts = (act for _, content, _ in self.document.contents() for act in all_acts(content))
        for run in acts:
            if isinstance(run, CommandRun) and len(run.steps) > 1:
                begin = [self.step(step) for step in run.steps if not step.after]
                add_longer(branches, chains(begin))

    def _asked_anew(self, handler: Node) -> Price:
        """The question that listened, asked again from its beginning with the handler's speech."""
        lasts = max((one.lasts for one in self.everything if one.listens), default=1)
        return Price(handler, "question", QUESTION.devices, lasts, engages=True)


def is_foreign(name: str) -> bool:
    """Whether an event may come from the user or the surroundings."""
    return takes(SERVICES, name) or not any(takes(one, name) for one in OWN)
