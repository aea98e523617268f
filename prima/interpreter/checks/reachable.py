"""Unreachable forms and handlers, and forms that are never left."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prima.digraphs import led_to
from prima.errors import Diagnosis, Problem
from prima.errors.diagnoses.behaviour import UNREACHABLE
from prima.interpreter.acts import Exit, Goto, Handler, Return, Throw, all_acts
from prima.interpreter.checks.facts import Facts, name_of
from prima.interpreter.deadcontent import DEAD_CONTENT
from prima.interpreter.elements import Field, Form, all_items
from prima.interpreter.events import DEFAULTS, event_place, scopes_of
from prima.interpreter.selection import beginnings

UNREACHABLE_FORM = UNREACHABLE.says(
    'Nothing leads to the form "{form}".', "Go to it from somewhere, or remove it."
)
DEAD_END = Diagnosis(
    "dead-end",
    "Form that cannot be left",
    "Nothing in the form or its handlers, but for those of errors, is a goto, exit, return, throw"
    " or link, and no subdialog that it calls can exit: once in it, the application waits for"
    " ever. That may be intended; if the application is over there, say so with <exit/>, or in a"
    " subdialog with <return/>.",
    severity="warning",
    message='The form "{form}" can never be left.',
    remedy="If the application is over here, write <exit/>.",
)
DEAD_END_INSIDE = DEAD_END.says(
    DEAD_END.message, "To come back from the subdialog, write <return/>."
)
SHADOWED = DEAD_CONTENT.says(
    'The handler in line {line} takes "{name}" first: this one is never reached.',
    "Remove one of them, or put the content of both into one.",
)
SHADOWED_PART = DEAD_CONTENT.says(SHADOWED.message, "Put this one before it.")
NO_CALLER = Diagnosis(
    "no-caller",
    "Return to nobody",
    "A <return> is in a form that no subdialog calls, and to which no called form leads. There"
    " is nothing to come back to: the application ends.",
    rule="VoiceXML 2.0, 5.3.10",
    severity="warning",
    message='No subdialog leads to the form "{form}": this ends the application.',
    remedy="Write <exit/> to end it, or call the form by a <subdialog>.",
)


def check_reachable(facts: Facts) -> Iterator[Problem]:
    """Warn of unreachable forms, and of forms that are never left."""
    forms, leads = facts.document.forms, facts.leads
    if not forms:
        return
    starts = [next(iter(forms)), *leads.targets.get(None, ())]
    starts = [*forms] if None in leads.anywhere else starts
    reached = _reached(facts, starts, calls=True)
    called = {name for calls in leads.calls.values() for name in calls}
    inside = _reached(facts, called, calls=False)
    left = _left(facts)
    for name, form in forms.items():
        if not name:
            continue  # nothing can name it, which the schema reports
        if name not in reached:
            yield UNREACHABLE_FORM.at(form.node.attribute_place("id"), form=name)
        elif name not in left:
            diagnosis = DEAD_END_INSIDE if name in inside else DEAD_END
            yield diagnosis.at(form.node.attribute_place("id"), form=name)
    yield from _returning(facts, reached - inside)


def _returning(facts: Facts, uncalled: set[str]) -> Iterator[Problem]:
    """Returns from forms that no subdialog calls."""
    for holder, act in facts.acts.of(Return):
        if holder is not None and holder.id in uncalled:
            yield NO_CALLER.at(act.node.place, form=holder.id)


def _reached(facts: Facts, names: Iterable[str], calls: bool) -> set[str]:
    """The forms that some forms lead to, themselves included; with subdialogs or without."""
    forms, leads = set(facts.document.forms), facts.leads
    reached = led_to(names, leads.of if calls else lambda name: leads.targets.get(name, ()))
    return forms & reached if leads.anywhere.isdisjoint(reached) else forms


def _left(facts: Facts) -> set[str]:
    """The forms that can be left."""
    exiting, ways = _exiting(facts), _ways(facts)

    def may_leave(form: Form) -> bool:
        way = form.id in ways or None in ways or ("" in ways and _asks(form))
        return way or not exiting.isdisjoint(facts.leads.calls.get(form.id, ()))

    return {name for name, form in facts.document.forms.items() if may_leave(form)}


def _asks(form: Form) -> bool:
    return any(isinstance(item, Field) for item in all_items(form.items))


def _ways(facts: Facts) -> set[str | None]:
    """Forms that can be left other than by an error; None: every form can, "": all that ask can.

    A handler of errors does not count: no state is meant to be left only when it fails.
    """
    failing = _acts_in(one for one in facts.handlers if _fails(one))
    asking = _acts_in(one for one in facts.document.handlers if DEFAULTS.issuperset(one.events))
    found = _linking(facts)
    for kind in (Goto, Exit, Return, Throw):
        for holder, act in facts.acts.of(kind):
            stays = isinstance(act, Goto) and act.form is None
            if not stays and id(act) not in failing:
                found.add("" if id(act) in asking else name_of(holder))
    return found


def _fails(handler: Handler) -> bool:
    """Whether a handler takes errors alone."""
    return all(event.partition(".")[0] == "error" for event in handler.events)


def _acts_in(handlers: Iterable[Handler]) -> set[int]:
    """The acts of some handlers, by their id()."""
    return {id(act) for handler in handlers for act in all_acts(handler.content)}


def _linking(facts: Facts) -> set[str | None]:
    """The forms with links to forms; None if the document itself has one."""
    return {name for name, links in facts.links if any(link.form for link in links)}


def _exiting(facts: Facts) -> set[str]:
    """The forms from which an exit can be reached, through gotos and subdialogs."""
    forms, leads = facts.document.forms, facts.leads
    waiting = [name for name in forms if name in leads.exits]
    if not waiting:
        return set()
    waiting += [name for name in forms if name in leads.anywhere]
    leading: dict[str, list[str]] = {}
    for name in forms:
        for target in leads.of(name):
            leading.setdefault(target, []).append(name)
    return led_to(waiting, lambda name: leading.get(name, ()))


def check_handlers(facts: Facts) -> Iterator[Problem]:
    """Warn of handlers whose events an earlier one of the same scope always takes."""
    for scope in scopes_of(facts.document, facts.acts):
        if len(scope) < 2:
            continue
        earlier: dict[tuple[str, int], Handler] = {}
        for handler in scope:
            takers = [_taker(earlier, name, handler.count) for name in handler.events]
            first = takers[0] if takers else None
            if first is not None and all(takers):
                name = handler.events[0]
                place = event_place(handler.node, name)
                diagnosis = SHADOWED if set(handler.events) <= set(first.events) else SHADOWED_PART
                yield diagnosis.at(place, line=first.node.place.line, name=name)
            elif handler.cond is None:
                earlier.update(((name, handler.count), handler) for name in handler.events)


def _taker(earlier: Mapping[tuple[str, int], Handler], name: str, count: int) -> Handler | None:
    """The earlier handler that takes an event, with the same count and without a condition."""
    return next((earlier[one, count] for one in beginnings(name) if (one, count) in earlier), None)
