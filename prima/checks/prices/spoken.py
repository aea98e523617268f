"""The speech of a VoiceXML document: what a question may ask with."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import chain

from prima.checks.prices.model import Price
from prima.interpreter.acts import Act, CommandRun
from prima.interpreter.elements import Block, Document, Field, Form, Item, Subdialog, all_items
from prima.language.values import milliseconds

TIMEOUT_MS = 5000


class DocumentSpeech:
    """The speech of a document, and how long questions wait for an answer after it."""

    def __init__(self, document: Document, steps: Callable[[Sequence[Act]], list[Price]]) -> None:
        self._document = document
        self._steps = steps
        self._kept: dict[tuple[str, str | int], list[Price]] = {}
        """What has been read, by what it belongs to."""
        self._waits: dict[str, int] = {}

    def _speech(self, contents: Iterable[Sequence[Act]]) -> list[Price]:
        steps = chain.from_iterable(map(self._steps, contents))
        return [one for one in steps if one.what == "speak"]

    @cached_property
    def all(self) -> list[Price]:
        """All speech of the document."""
        return self._speech(content for _, content, _ in self._document.contents())

    @cached_property
    def anywhere(self) -> list[Price]:
        """The speech of the handlers of the document and of its application root."""
        return most(self._speech(one.content for one in self._document.handlers))

    def asked_by(self, item: Item) -> list[Price]:
        """The prompts of a question or a call."""
        key = ("item", item.node.index)
        if key not in self._kept:
            asked = item.filled[-1:] if isinstance(item, Field | Subdialog) else ()
            self._kept[key] = self._speech(one.content for one in asked)
        return self._kept[key]

    def by_handlers(self, form: Form) -> list[Price]:
        """The speech of a dialog's handlers: if one fills its item, another one asks with it."""
        if ("handlers", form.id) not in self._kept:
            holders: list[Form | Item] = [form, *all_items(form.items)]
            handlers = chain.from_iterable(one.handlers for one in holders)
            said = self._speech(one.content for one in handlers)
            self._kept["handlers", form.id] = most(said)
        return self._kept["handlers", form.id]

    def said_in(self, form: Form) -> list[Price]:
        """The speech of a dialog and its handlers."""
        if ("form", form.id) not in self._kept:
            self._kept["form", form.id] = most(self._speech(self._contents.get(form.id, [])))
        return self._kept["form", form.id]

    @cached_property
    def _contents(self) -> dict[str, list[Sequence[Act]]]:
        """The content of each dialog."""
        found: dict[str, list[Sequence[Act]]] = {}
        for form, content, _ in self._document.contents():
            if form is not None:
                found.setdefault(form.id, []).append(content)
        return found

    def speaks_first(self, form: Form) -> bool:
        """Whether a dialog speaks before it asks, so that it asks with no prompt of another.

        One that calls others may ask with theirs at any time.
        """
        if any(one.node.tag == "subdialog" for one in all_items(form.items)):
            return False
        first = next(iter(form.items), None)
        if first is None or first.cond is not None or first.expr is not None:
            return False
        if isinstance(first, Block):
            return bool(self._speech([[one for one in first.content[:1] if _is_run(one)]]))
        return isinstance(first, Field) and any(map(is_certain, self.asked_by(first)))

    def timeout(self, item: Item | Form, form: Form) -> int:
        """How long (ms) a question waits for an answer after a prompt that does not say."""
        settings = (item.properties, form.properties, self._document.properties)
        usual = next((one["timeout"] for one in settings if "timeout" in one), "")
        return milliseconds(str(usual), TIMEOUT_MS)

    def longest_timeout(self, form: Form) -> int:
        """How long (ms) questions of a dialog wait at most, wherever their prompts are queued."""
        if form.id not in self._waits:
            places: list[Form | Item] = [form, *all_items(form.items)]
            self._waits[form.id] = max(self.timeout(one, form) for one in places)
        return self._waits[form.id]

    @cached_property
    def longest_wait(self) -> int:
        """How long (ms) questions of the document wait at most."""
        return max(map(self.longest_timeout, self._document.forms.values()), default=0)


class AllSpeech:
    """The speech of all documents of an application: prompts wait for the next question (4.1.8)."""

    def __init__(self, documents: Sequence[DocumentSpeech]) -> None:
        self._documents = documents

    @cached_property
    def said(self) -> list[Price]:
        """What they say."""
        return most([price for one in self._documents for price in one.all])

    @cached_property
    def timeout(self) -> int:
        """The longest time (ms) for an answer after a prompt that does not say."""
        return max((one.longest_wait for one in self._documents), default=0)


def most(said: Sequence[Price]) -> list[Price]:
    """What of some speech takes longest, waits longest for an answer, or may take longer."""
    longest = sorted(said, key=lambda one: one.lasts)[-1:]
    waits = sorted(said, key=lambda one: milliseconds(one.node.get("timeout"), 0))[-1:]
    return [*longest, *waits, *[one for one in said if one.unknown][:1]]


def is_certain(price: Price) -> bool:
    """Whether a prompt is always said before its question, at its first visit."""
    return not price.node.get("cond") and price.node.get("count", "1") == "1"


def _is_run(act: Act) -> bool:
    return isinstance(act, CommandRun)
