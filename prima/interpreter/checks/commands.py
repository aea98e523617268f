"""Texts of Commands, and devices that runs of Commands share."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from prima.digraphs import led_to
from prima.errors import Diagnosis, Problem
from prima.errors.diagnoses.behaviour import SHARED_DEVICE
from prima.errors.diagnoses.values import NOTHING_TO_SAY
from prima.interpreter.acts import CommandRun, StepTemplate, Text, run_commands
from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Field, Form, Prompt, Unit
from prima.interpreter.events import groups_of
from prima.interpreter.speaking import long_group, long_unit, speak, unit_speaks
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node

MANY_STEPS = 200
"""Maximum number of steps of a run whose branches are compared."""
BRACES = re.compile(r"\$?\{\{?\s*((\w+)(?:[.(\[][^{}]*?)?)\s*\}\}?")
DOLLAR = re.compile(r"\$(([^\W\d]\w*))")
OWN = ("event.", "session.", "sensor.")
"""Beginnings of values that the language itself gives."""

LITERAL_VALUE = Diagnosis(
    "literal-value",
    "Variable's name said as text",
    "A text holds a variable's name in braces or behind a dollar sign, as other languages write a"
    ' value. The robot says it as it is written; a value is written <value expr="..."/>.',
    severity="warning",
    message='"{text}" is said as it is written.',
    remedy='Write <value expr="{name}"/>.',
)
ASKS_NOTHING = NOTHING_TO_SAY.says(
    "<prompt> has nothing to say.", "Write its text inside it, or remove it.", severity="warning"
)
ONE_AFTER_THE_OTHER = SHARED_DEVICE.says(
    "This branch shares {devices} with another: they run one after the other.",
    "Write them one after the other, in a <seq>.",
)


def check_texts(facts: Facts) -> Iterator[Problem]:
    """Warn of text with a variable in braces or behind "$", the notations of other languages."""
    for form, run in facts.acts.of(CommandRun):
        for command in run_commands(run.steps):
            yield from _literal(facts, command.node, command.text, form)
    for form, items in facts.forms:
        for field in (item for item in items if isinstance(item, Field)):
            for prompt in field.prompts:
                yield from _silent(prompt)
                yield from _literal(facts, prompt.node, prompt.text, form)


def _silent(prompt: Prompt) -> Iterator[Problem]:
    """A prompt without a text; behind another, it is how a question is asked again in silence."""
    says = prompt.text or prompt.timeout or prompt.bargein is not None
    if prompt.count == 1 and not says:
        yield ASKS_NOTHING.at(prompt.node.place)


def _literal(facts: Facts, node: Node, text: Text | None, form: Form | None) -> Iterator[Problem]:
    known = facts.known_in(form) if form else facts.shared
    for part in text or ():
        found = None
        if isinstance(part, str) and ("{" in part or "$" in part):
            found = BRACES.search(part) or DOLLAR.search(part)
        if found and (found[2] in known or found[1].startswith(OWN)):
            yield LITERAL_VALUE.at(node.place, text=found[0], name=found[1].replace('"', "'"))


def check_units(facts: Facts) -> Iterator[Problem]:
    """Warn of units that speak for long (4.5)."""
    lang = facts.document.lang
    for _, items in facts.forms:
        for item in items:
            if isinstance(item, Unit):
                yield from long_unit(item.node, unit_speaks(item, lang))
    for group in groups_of(facts.acts):
        ms = speak(run_commands(group.steps), lang)
        yield from long_group(group.node, ms, group.longest)


def check_branches(facts: Facts) -> Iterator[Problem]:
    """U3: branches of a par that share a device run one after the other."""
    for _, run in facts.acts.of(CommandRun):
        steps = run.steps
        chained = all(step.after == ((n - 1,) if n else ()) for n, step in enumerate(steps))
        if not chained and len(steps) <= MANY_STEPS:
            yield from _shared(steps)


def _shared(steps: Sequence[StepTemplate]) -> Iterator[Problem]:
    before = [led_to([index], lambda one: steps[one].after) for index in range(len(steps))]
    for index, step in enumerate(steps):
        for second, other in enumerate(steps[index + 1 :], index + 1):
            both = _devices(step) & _devices(other) if index not in before[second] else ()
            if both:
                yield ONE_AFTER_THE_OTHER.at(other.what.node.place, devices=", ".join(sorted(both)))
                return


def _devices(step: StepTemplate) -> frozenset[str]:
    devices: frozenset[str] = frozenset()
    for command in run_commands([step]):
        row = TABLE_4_2.get(command.type)
        if row is not None:
            devices |= row.occupied("x" if command.text else None)
    return devices
