"""Sentences that a subdialog says twice because a handler ends it with an event (O3).

The form that called it handles the event, goes on, and calls it again.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import TOLD_TWICE
from prima.interpreter.acts import Assign, Handler, Return, all_acts
from prima.interpreter.elements import Form, Subdialog, all_items
from prima.interpreter.entering import EnteredDocument, FormTarget, forms_of, is_left
from prima.interpreter.selection import beginnings

REMEDY = (
    "Handle the event here without <return>: the speech then continues. Or give the speech a cond."
)

Callers = dict[FormTarget, list[tuple[EnteredDocument, Form, Subdialog]]]

CALLED_AGAIN = TOLD_TWICE.says(
    'If "{event}" comes while this is {said} (line {line}), it is said twice: the form that called'
    ' this one handles "{returned}" and calls it again.',
    REMEDY,
)


def callers_of(sources: Sequence[EnteredDocument]) -> Callers:
    """The items that call each form as a subdialog."""
    found: Callers = defaultdict(list)
    for source, form in forms_of(sources):
        for item in all_items(form.items):
            if not isinstance(item, Subdialog) or item.expr is not None:
                continue
            for target in source.leads(item):
                found[target].append((source, form, item))
    return found


def returns_of(form: Form, source: EnteredDocument) -> Iterator[tuple[str, Return]]:
    """Outside events on which a form's handlers return with an event, and how."""
    inner = [handler for item in all_items(form.items) for handler in item.handlers]
    for handler in (*form.handlers, *inner):
        event = next(filter(source.foreign, handler.events), "")
        for act in all_acts(handler.content) if event else ():
            if isinstance(act, Return) and act.event:
                yield event, act


def calls_again(source: EnteredDocument, form: Form, item: Subdialog, event: str) -> bool:
    """Whether a form handles an event of its subdialog, and then visits the item again."""
    names = set(beginnings(event))
    scope = (*item.handlers, *form.handlers, *source.document.handlers)
    taking = next((one for one in scope if not names.isdisjoint(one.events)), None)
    return taking is not None and _goes_on(taking, item)


def _goes_on(handler: Handler, item: Subdialog) -> bool:
    """Whether a handler neither leaves the form nor gives the item a value."""
    if handler.cond is not None or handler.count > 1 or is_left(handler.content):
        return False
    given = (act.name for act in all_acts(handler.content) if isinstance(act, Assign))
    return item.name not in given


def told_again(event: str, line: int, asks: bool, way: Return) -> Problem:
    """The warning for one of them."""
    said = "asked" if asks else "said"
    return CALLED_AGAIN.at(way.node.place, event=event, said=said, line=line, returned=way.event)
