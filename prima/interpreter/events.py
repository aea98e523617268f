"""Events by name: possible ones, those never raised, those never handled."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

from prima.errors import Diagnosis, Place, Problem, Span, guessable, meant
from prima.errors.diagnoses.names import UNHEARD_EVENT, UNKNOWN_EVENT
from prima.interpreter.acts import (
    CommandRun,
    CommandTemplate,
    Expression,
    GroupTemplate,
    Handler,
    Return,
    SendOut,
    Throw,
    run_commands,
)
from prima.interpreter.elements import Acts, Document, Field, Item, all_items
from prima.interpreter.selection import beginnings, takes
from prima.language.commands import DEVICES, WRITTEN
from prima.language.values import EVENT
from prima.markup.spans import value_span
from prima.markup.tree import Node

NEVER_RAISED = UNKNOWN_EVENT.says("{wrong}", "Remove the handler.")
NO_HELP = UNKNOWN_EVENT.says(
    'Nothing raises an event "help" here: a user who says it is not understood.',
    'Write <link event="help"><grammar>help</grammar></link>.',
)
NOT_ITS_OWN = UNKNOWN_EVENT.says(
    'A handler in a Command takes only its own events, not "{name}".',
    "Remove it, or write it in the form.",
)
NOT_ITS_ERROR = UNKNOWN_EVENT.says(
    'A handler in a Command of a unit takes only its errors, not "{name}".', NOT_ITS_OWN.remedy
)
NOT_HANDLED = UNHEARD_EVENT.says(
    'No handler takes the event "{name}".', 'Write <on event="{name}">.'
)
ENDS_APPLICATION = UNHEARD_EVENT.says(
    f"{NOT_HANDLED.message} It ends the application.", NOT_HANDLED.remedy
)

STANDARD = frozenset(
    [
        *("touch", "message", "human.found", "human.lost", "corner", "noinput", "nomatch", "help"),
        *("suspended", "resumed", "emergency.stop", "emergency.release"),
        *("connection.disconnect.hangup", "error"),
        *("error.semantic", "error.badfetch", "error.unsupported", "error.unit.timeout"),
        *("error.service", "end", "cancel", "interrupted", "expired", "late", "reply"),
        *(f"error.device.{device}" for device in DEVICES),
    ]
)
"""Events of the language itself, besides those with the name of a sensor, Command or service."""
STANDARD_NAMES = frozenset(name for one in STANDARD for name in beginnings(one))
"""These events, and the beginnings of their names by which handlers take them."""
HABITS = {
    "timeout": "noinput",
    "silence": "noinput",
    "click": "touch",
    "person.found": "human.found",
    "person.lost": "human.lost",
    "human.seen": "human.found",
    "human.gone": "human.lost",
    "hangup": "connection.disconnect.hangup",
    "done": "end",
    "finished": "end",
}
"""Names that authors expect, with the language's names."""
ANSWERS = {
    **dict.fromkeys(("", "answer", "reply", "response"), "reply"),
    **dict.fromkeys(("error", "failure"), "error.service"),
}
"""Ends of names that authors give to the events of a service, with the right beginnings."""
DEFAULTS = frozenset(["noinput", "nomatch", "help"])
"""Thrown events that end nothing if unhandled."""
MOST_GUESSES = 200
"""Maximum number of handlers of a document checked for misspelt names: each guess takes time."""
NEAR = 0.8
"""The similarity above which one name is taken for a misspelling of the other."""
FIRST = frozenset(name.partition(".")[0] for name in STANDARD)
"""Prefixes of standard events."""
OWN = ("end", "cancel", "interrupted", "expired")
"""Prefixes of events of the application's own Commands."""
OPEN = (*OWN, "touch", "reply")
"""Prefixes of events with the name of a sensor, a Command or a service."""


@dataclass(slots=True)
class RaisedEvent:
    """An event that a document raises itself: its name, and the attribute that names it."""

    name: str
    node: Node
    attribute: str
    fatal: bool
    """Whether it ends the application if no handler takes it."""


def near(word: str, known: Iterable[str]) -> str:
    """The known name of which a word is most likely a misspelling, or nothing."""
    words = guessable(word, known)
    if not words:
        return ""
    from difflib import get_close_matches  # takes long to import, and few documents need it

    folded = word.casefold().replace("-", "").replace("_", "")
    plain = {one.replace("-", ""): one for one in words}
    swapped = [one for one in plain if sorted(one) == sorted(folded)]
    found = swapped or get_close_matches(folded, plain, n=1, cutoff=NEAR)
    return plain[found[0]] if found else ""


def slip_of(name: str, known: Iterable[str]) -> str:
    """The event whose name another one most likely misspells, or nothing."""
    device = name.removeprefix("error.device.")
    if device != name:  # it may be one of the robot's own
        meant = near(device, DEVICES)
        return f"error.device.{meant}" if meant else ""
    if found := near(name, known):
        return found
    first, _, rest = name.partition("_")
    if rest and first in OPEN:
        return f"{first}.{rest}"
    first, _, rest = name.partition(".")
    meant = near(first, FIRST) if rest and first not in FIRST else ""
    return f"{meant}.{rest}" if meant else ""


def handlers_of(document: Document, acts: Acts | None = None) -> Iterator[Handler]:
    """Every handler of a document; ``acts`` are its acts, where they have been gathered."""
    return chain.from_iterable(scopes_of(document, acts or Acts(document)))


def scopes_of(document: Document, acts: Acts) -> Iterator[Sequence[Handler]]:
    """The handlers of a document, scope by scope."""
    yield document.handlers
    for form in document.forms.values():
        yield form.handlers
        yield from (item.handlers for item in all_items(form.items))
    yield from (command.handlers for command in _commands(acts))


def _commands(acts: Acts) -> Iterator[CommandTemplate]:
    for _, run in acts.of(CommandRun):
        yield from run_commands(run.steps)


def groups_of(acts: Acts) -> Iterator[GroupTemplate]:
    """The units around Commands (U4)."""
    for _, run in acts.of(CommandRun):
        yield from (step.what for step in run.steps if isinstance(step.what, GroupTemplate))


def _never_taken(acts: Acts) -> Iterator[tuple[Handler, str, Diagnosis]]:
    """The handlers in Commands of events that do not reach them, with the name and the problem."""
    inside = {id(one) for group in groups_of(acts) for one in run_commands(group.steps)}
    for command in _commands(acts):
        own = [] if id(command) in inside else [f"{kind}.{command.type}" for kind in OWN]
        diagnosis = NOT_ITS_OWN if own else NOT_ITS_ERROR
        yield from (
            (handler, name, diagnosis)
            for handler in command.handlers
            for name in handler.events
            if not takes("error", name) and not any(takes(name, one) for one in own)
        )


def items_of(document: Document) -> Iterator[Item]:
    """The items of all forms of a document."""
    return (item for form in document.forms.values() for item in all_items(form.items))


def _asked(acts: Acts) -> Iterator[tuple[Node, str]]:
    """The services that are asked by their names, and where."""
    for _, sent in acts.of(SendOut):
        if sent.service and isinstance(sent.service, str):
            yield sent.node, sent.service


def _is_dynamic(acts: Acts) -> bool:
    """Whether a service or an event is named by an expression."""
    named = [sent.service for _, sent in acts.of(SendOut)]
    named += [throw.event for _, throw in acts.of(Throw)]
    return any(isinstance(one, Expression) for one in named)


def raised_by(document: Document, acts: Acts) -> Iterator[RaisedEvent]:
    """The events that a document raises itself by literal names."""
    for act in acts.among(Throw, SendOut, Return):
        if isinstance(act, Throw | SendOut | Return) and isinstance(act.event, str) and act.event:
            yield RaisedEvent(act.event, act.node, "event", not isinstance(act, SendOut))
    forms = document.forms.values()
    for link in [*document.links, *(one for form in forms for one in form.links)]:
        if link.event:
            yield RaisedEvent(link.event, link.node, "event", False)
    for watch in [*document.watches, *(one for form in forms for one in form.watches)]:
        yield RaisedEvent(watch.name, watch.node, "name", False)


class KnownEvents:
    """The events of a document, gathered once."""

    def __init__(self, document: Document, acts: Acts | None = None) -> None:
        acts = acts or Acts(document)
        self.handlers = list(handlers_of(document, acts))
        self.heard = {name for handler in self.handlers for name in handler.events}
        self.raised = list(raised_by(document, acts))
        self.commands = {command.type for command in _commands(acts)}
        if any(isinstance(item, Field) for item in items_of(document)):
            self.commands.add("q-and-a")
        self.units = {"iu"} if any(groups_of(acts)) else set()
        """The name of units around Commands, which have no event at their end."""
        self._never_taken = [*_never_taken(acts)]
        self.asked = [*_asked(acts)]
        """The services that are asked by their names, and where."""
        self.dynamic = _is_dynamic(acts)
        """Whether a service or an event is named by an expression."""
        self.services = {name for _, name in self.asked}
        self._own = {one.name for one in self.raised}
        self._begun = {name for one in self._own for name in beginnings(one)}
        self._known = STANDARD_NAMES | self._begun
        self._guesses = 0
        self._told: dict[str, tuple[str, str] | None] = {}
        self._near: dict[str, str] = {}
        """Results by name: guesses take time, and names recur."""

    def problems(self) -> list[Problem]:
        """Handlers of events that are never raised, and events that no handler takes."""
        found: list[Problem] = []
        wanted: set[str] = set()
        for handler in self.handlers:
            for name in handler.events:
                suggested = self._unraised(name)
                if suggested is not None:
                    message, nearest = suggested
                    wanted.add(nearest)
                    place = event_place(handler.node, name)
                    hint = meant(nearest, Span.of(place, name))
                    found.append(NEVER_RAISED.at(place, hint, wrong=message))
                elif name == "help" and not (name in self._begun or self.dynamic):
                    found.append(NO_HELP.at(event_place(handler.node, name)))
        for handler, name, diagnosis in self._never_taken:
            if self._unraised(name) is None:
                found.append(diagnosis.at(event_place(handler.node, name), name=name))
        found += [problem for one in self.raised if (problem := self._unheard(one, wanted))]
        return found

    def _unraised(self, name: str) -> tuple[str, str] | None:
        """The problem of a handler's event name, and the name probably meant."""
        self._guesses += name not in self._known
        if "," in name or name in self._known or self._guesses > MOST_GUESSES:
            return None
        if name not in self._told:
            self._told[name] = self._guess(name)
        return self._told[name]

    def _guess(self, name: str) -> tuple[str, str] | None:
        first, _, rest = name.partition(".")
        if first in OWN:
            wrong = f'no Command "{rest}" is asked for here'
            known = self.commands if first == "end" else self.commands | self.units
            return self._missing(name, rest, known, wrong)
        service = name.removeprefix("error.service.").removeprefix("reply.")
        if service != name:
            wrong = f'nothing is sent to "{service}" here'
            return None if self.dynamic else self._missing(name, service, self.services, wrong)
        if first == "touch" or name.startswith(("error.unsupported.", "error.badfetch.")):
            return None
        if first in self.services and rest in ANSWERS:
            nearest = f"{ANSWERS[rest]}.{first}"
        else:
            nearest = HABITS.get(name, "") or slip_of(name, self._known)
        return (f'Nothing raises an event "{name}".', nearest) if nearest else None

    @staticmethod
    def _missing(name: str, end: str, known: Collection[str], wrong: str) -> tuple[str, str] | None:
        """The problem of a name that ends with an unknown Command or service."""
        if any(takes(end, one) for one in known):
            return None
        nearest = WRITTEN.get(end, "")
        nearest = nearest if nearest in known else near(end, known)
        right = name.removesuffix(end) + nearest if nearest else ""
        return f'"{name}" is never raised: {wrong}.', right

    def _unheard(self, one: RaisedEvent, wanted: set[str]) -> Problem | None:
        heard = any(name in self.heard or name in DEFAULTS for name in beginnings(one.name))
        if one.name in wanted or heard or not re.fullmatch(EVENT, one.name):
            return None  # or it is not a name, which is reported already
        self._guesses += 1
        nearest = ""
        if self._guesses <= MOST_GUESSES:
            if one.name not in self._near:
                self._near[one.name] = near(one.name, self.heard)
            nearest = self._near[one.name]
        place = one.node.attribute_place(one.attribute)
        spans = value_span(one.node, one.attribute, one.name) if nearest else ()
        diagnosis = ENDS_APPLICATION if one.fatal else NOT_HANDLED
        return diagnosis.at(place, meant(nearest, *spans), name=one.name)


def event_place(node: Node, name: str) -> Place:
    """Where a handler names an event: one of several in its attribute."""
    if "event" not in node.attributes:
        return node.place
    words = node.get("event")
    at = words.find(name)
    return node.source.inside(node.index, "event", max(at, 0))


def silent_fields(document: Document) -> list[Field]:
    """The fields in whose scope nothing handles noinput."""

    def handled(handlers: Iterable[Handler]) -> bool:
        return any("noinput" in handler.events for handler in handlers)

    found: list[Field] = []

    def look(items: Sequence[Item]) -> None:
        for item in items:
            if handled(item.handlers):
                continue
            if isinstance(item, Field):
                found.append(item)
            look(getattr(item, "items", []))

    if handled(document.handlers):
        return []
    for form in document.forms.values():
        if form.items and not handled(form.handlers):
            look(form.items)
    return found
