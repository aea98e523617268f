"""Handlers of events that an application makes for itself, and which of them lead to themselves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import ENDLESS
from prima.interpreter.acts import (
    Act,
    Assign,
    CommandTemplate,
    Handler,
    Log,
    Run,
    SendOut,
    StepTemplate,
    Throw,
    all_acts,
)
from prima.interpreter.elements import Document, Form, all_items
from prima.interpreter.selection import takes

AGAIN = ENDLESS.says(
    "This reaction to {event} leads to itself again without a wait: no other application has a turn.",
    'Leave out reactive="true", or put <pause time="..."/> first.',
)

PAUSE = "pause"


Raised = Callable[[Sequence[Act]], set[str]]
"""Finds the events that content raises."""


def leads_round(handler: Handler, handlers: Sequence[Handler], raised: Raised) -> bool:
    """Whether what a handler does ends in events that lead, by others perhaps, to itself again."""
    return handler in _led_to(handler, handlers, raised)


def _led_to(handler: Handler, handlers: Sequence[Handler], raised: Raised) -> list[Handler]:
    """The handlers of the events that a handler raises, by others perhaps."""
    found: list[Handler] = []
    left = [handler]
    while left:
        names = raised(left.pop().content)
        for one in handlers:
            if one not in found and any(takes(own, name) for own in one.events for name in names):
                found.append(one)
                left.append(one)
    return found


def raised_in(content: Sequence[Act]) -> set[str]:
    """The events that content raises without a wait: ends of its Commands, and what it throws."""
    acts = all_acts(content)
    ends = {f"end.{name}" for act in acts if isinstance(act, Run) for name in _types(act.steps)}
    thrown = [act.event for act in acts if isinstance(act, Throw)]
    return ends | {name for name in thrown if isinstance(name, str)}


def _types(steps: Sequence[StepTemplate]) -> Iterator[str]:
    """The Commands of steps, those in units included."""
    for step in steps:
        if isinstance(step.what, CommandTemplate):
            yield step.what.type
        else:
            yield from _types(step.what.steps)


def endless_reactions(document: Document) -> Iterator[Problem]:
    """Warn of reactions to own events that lead to themselves again: nobody else has a turn (S2b).

    Only what is certain: without a condition, and with nothing in between for which a reaction of
    another application would go first, as a question, a pause or a second Command.
    """
    told: list[Handler] = []
    for form in document.forms.values():
        scope = _reacting(document, form)
        for handler in scope:
            led_to = _led_to(handler, scope, raised_first)
            if handler in led_to and not any(one in told for one in led_to):
                told.append(handler)
                yield _problem(handler)


def _problem(handler: Handler) -> Problem:
    return AGAIN.at(handler.node.attribute_place("reactive"), event=handler.events[0])


def _reacting(document: Document, form: Form) -> list[Handler]:
    """The handlers in a form's scope whose Commands are reactions because they say so."""
    scope = [*form.handlers, *document.handlers]
    for item in all_items(form.items):
        scope += item.handlers
    return [one for one in scope if one.reactive and one.cond is None and one.count <= 1]


def raised_first(content: Sequence[Act]) -> set[str]:
    """The events that content certainly raises at once, or when its first Command has ended."""
    found: set[str] = set()
    ran = False
    for act in content:
        match act:
            case Run() if not ran:
                first = set(_types([step for step in act.steps if not step.after]))
                if PAUSE in first:
                    return found
                found |= {f"end.{name}" for name in first}
                ran = True
                if any(step.after for step in act.steps):
                    return found
            case Throw(event=str(name)):
                return found | {name}
            case Assign() | Log() | SendOut():
                continue
            case _:
                return found
    return found
