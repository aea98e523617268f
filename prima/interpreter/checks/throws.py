"""Events that a form throws and only handlers of other forms take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.errors import Problem
from prima.errors.diagnoses.names import UNHEARD_EVENT
from prima.interpreter.acts import Handler, Throw
from prima.interpreter.checks.facts import Facts
from prima.interpreter.events import DEFAULTS
from prima.interpreter.selection import beginnings

ELSEWHERE = UNHEARD_EVENT.says(
    'No handler of this form or of the document takes the event "{name}". It ends the application.',
    'Write <on event="{name}"> there; in a subdialog, <return event="{name}"/> gives it to the'
    " caller.",
)


def check_throws(facts: Facts) -> Iterator[Problem]:
    """Warn of thrown events that only handlers of other forms take.

    Handlers are looked for in the form's items, the form and the document (VoiceXML 2.0, 5.2.4).
    """
    heard, shared = _taken(facts.handlers), _taken(facts.document.handlers) | DEFAULTS
    own = {
        form.id: _taken([*form.handlers, *(handler for one in items for handler in one.handlers)])
        for form, items in facts.forms
    }
    for form, act in facts.acts.of(Throw):
        if form is None or not isinstance(act.event, str):
            continue
        names = {*beginnings(act.event)}
        here = not names.isdisjoint(shared) or not names.isdisjoint(own[form.id])
        if not here and not names.isdisjoint(heard):
            yield ELSEWHERE.at(act.node.attribute_place("event"), name=act.event)


def _taken(handlers: Iterable[Handler]) -> set[str]:
    """The names of the events that handlers take."""
    return {name for one in handlers for name in one.events}
