"""Hints without effect, and the cost of held streams to others (X3, X4, X8)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from prima.errors import Diagnosis, Problem
from prima.interpreter.acts import CommandRun, run_commands
from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Field, Form, Item, Subdialog
from prima.language.commands import TABLE_4_2
from prima.language.values import read_value
from prima.markup.tree import Node

NO_CAUSES = frozenset(
    ["end", "cancel", "interrupted", "expired", "suspended", "resumed", "noinput", "nomatch"]
)
"""Prefixes of events to which nothing is a reaction (C5)."""
IDLE_HINT = Diagnosis(
    "idle-hint",
    "Hint without effect",
    "A hint that can never have an effect: hold-for without stream, or a stream held in a state"
    " that handles no event to wait for, or that asks for no Command, or the time of a reaction"
    " on something that is not one.",
    rule="X3, X4, X8",
    severity="warning",
)
NOTHING_HELD = IDLE_HINT.says("hold-for has no effect: no stream is held.", 'Add stream="hold".')
NO_EVENT = IDLE_HINT.says(
    "The stream is held, but no event is waited for here.",
    'Handle the event with <on event="...">.',
)
NO_WORD = IDLE_HINT.says(
    "The robot is to turn to the user before its first word, but never speaks here.",
    "Remove the hint.",
)
NO_REACTION = IDLE_HINT.says(
    "fresh-for limits how long a reaction is worth starting, but this is not a reaction.",
    "Remove the hint.",
)
HOLD_PRICE = Diagnosis(
    "hold-price",
    "What a held stream costs others",
    "A stream hint (rule X3) keeps other applications out while this one waits for an event: all"
    " but their reactions wait for as long as hold-for says, after each last Command of the"
    " state. The note says for how long; it applies only to a run with the extension x3.",
    rule="X3",
    severity="note",
    message="With the extension x3 another application waits up to {seconds} s for each event"
    " awaited here, unless it reacts to one itself.",
)


def check_hints(facts: Facts) -> Iterator[Problem]:
    """Check hints of forms, items and handlers (X3, X4, X8)."""
    speaking = _speaking(facts)
    for handler in facts.handlers:
        if "fresh-for" in handler.node.attributes and _is_no_reaction(handler.node):
            yield NO_REACTION.at(handler.node.attribute_place("fresh-for"))
    for form, items in facts.forms:
        yield from _stream(facts, form, form)
        for item in items:
            yield from _stream(facts, form, item)
        silent = not facts.document.handlers and form.id not in speaking
        if form.connect and silent and not _asks(items):
            yield NO_WORD.at(form.node.attribute_place("channel"))


def _stream(facts: Facts, form: Form, one: Form | Item) -> Iterator[Problem]:
    node, document = one.node, facts.document
    if "hold-for" in node.attributes and "stream" not in node.attributes:
        yield NOTHING_HELD.at(node.attribute_place("hold-for"))
    if not one.hold or "stream" not in node.attributes or _bad_hold(node):
        return
    handlers = (*form.handlers, *document.handlers)
    if handlers or form.watches or form.links or document.links:
        yield HOLD_PRICE.at(node.attribute_place("stream"), seconds=f"{one.hold / 1000:g}")
    else:
        yield NO_EVENT.at(node.attribute_place("stream"))


def _is_no_reaction(node: Node) -> bool:
    """Whether a handler is not a reaction, by its attribute or by each of its events (C5)."""
    said = node.get("reactive")
    own = {name.partition(".")[0] for name in node.get("event", "").split()} <= NO_CAUSES
    return said == "false" or (said != "true" and own)


def _asks(items: Sequence[Item]) -> bool:
    return any(isinstance(item, Field | Subdialog) for item in items)


def _speaking(facts: Facts) -> set[str]:
    """The forms whose content certainly makes the robot speak."""
    return {
        form.id
        for form, run in facts.acts.of(CommandRun)
        if form and any(one.text or one.type not in TABLE_4_2 for one in run_commands(run.steps))
    }


def _bad_hold(node: Node) -> bool:
    """Whether an element's hold-for is not a time, which the schema reports."""
    try:
        return int(read_value("duration", node.get("hold-for", "1s"))) <= 0
    except ValueError:
        return True
