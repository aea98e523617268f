"""Endless behaviour while other applications wait (E4)."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import ENDLESS
from prima.interpreter.acts import (
    CommandRun,
    CommandTemplate,
    Exit,
    Foreach,
    Goto,
    If,
    Return,
    Throw,
    run_commands,
)
from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Block, Form

MANY_FORMS = 8
"""Maximum number of forms named in a cycle."""

NEVER_ENDS = ENDLESS.says(
    "tracking-human never ends by itself, and this state handles no event.",
    'Handle an event: <on event="touch"><goto .../></on>.',
)
GOES_ROUND = ENDLESS.says(
    "The forms {forms} go round without asking or waiting: no other application has a turn.",
    'Write <pause time="5s"/> before the goto, or wait for an event: <send event="..." delay="10s"/>.',
)
GOES_TO_ITSELF = ENDLESS.says(
    'The form "{forms}" goes to itself without asking or waiting: no other application has a turn.',
    GOES_ROUND.remedy,
)


def check_endless(facts: Facts) -> Iterator[Problem]:
    """Warn of a feedback Command without an end of its own in a state without handlers."""
    for form, run in facts.acts.of(CommandRun):
        for command in run_commands(run.steps):
            if command.type != "tracking-human" or form is None:
                continue
            document = facts.document
            if not (form.handlers or document.handlers or form.links or document.links):
                yield NEVER_ENDS.at(command.node.place)


def check_rounds(facts: Facts) -> Iterator[Problem]:
    """Warn of forms that go to each other for ever without asking or waiting."""
    gotos = {form.id: _always(form) for form, items in facts.forms if items}
    reported: set[str] = set()
    for start in gotos:
        way: list[str] = []
        passed: set[str] = set()
        name = start
        while name not in passed and name not in reported and (act := gotos.get(name)):
            way.append(name)
            passed.add(name)
            name = act.form if isinstance(act.form, str) else ""
        reported |= passed
        last = gotos[way[-1]] if way else None
        if last is not None and name in passed:
            yield _round(last, way[way.index(name) :])


def _round(last: Goto, ring: list[str]) -> Problem:
    diagnosis = GOES_TO_ITSELF if len(ring) == 1 else GOES_ROUND
    more = ", ..." if len(ring) > MANY_FORMS else ""
    forms = ", ".join(ring[:MANY_FORMS]) + more
    return diagnosis.at(last.node.attribute_place("next"), forms=forms)


def _always(form: Form) -> Goto | None:
    """The goto by which a form is certainly left, without a question, a wait or a last pause."""
    for item in form.items:
        if not isinstance(item, Block) or item.cond is not None or item.expr is not None:
            return None
        for act in item.content:
            if isinstance(act, If | Foreach | Throw | Exit | Return):
                return None
            if isinstance(act, CommandRun) and _rests(act):
                return None
            if isinstance(act, Goto):
                return act if isinstance(act.form, str) else None
    return None


def _rests(run: CommandRun) -> bool:
    """Whether it ends with a pause, beside and after which nothing of it is left (F6)."""
    followed = {index for step in run.steps for index in step.after}
    last = [step.what for index, step in enumerate(run.steps) if index not in followed]
    return [isinstance(one, CommandTemplate) and one.type for one in last] == ["pause"]
