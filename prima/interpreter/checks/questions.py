"""Questions that the user cannot answer, and questions that are repeated for ever."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Diagnosis, Problem
from prima.errors.diagnoses.values import ASKED_LATER
from prima.interpreter.acts import Exit, Goto, Handler, Return, Throw, all_acts, commands_of
from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Field, Form, Prompt
from prima.interpreter.events import DEFAULTS, silent_fields
from prima.language.commands import TABLE_4_2

LEAVES_QUESTION = Diagnosis(
    "leaves-question",
    "Robot leaves a question",
    "The robot drives away from the user in the middle of a question, and then asks it again"
    " where the user is not (thesis 3.3, the Communication Channel).",
    rule="thesis, 3.3",
    severity="warning",
    message="<{tag}> leaves the user, and then the question is asked again.",
    remedy="Leave the question with <goto>, or look for the user first:"
    " <active-sensing-human/> behind it.",
)
NO_NOINPUT = Diagnosis(
    "no-noinput",
    "Question without noinput",
    "A question that nobody answers is asked again and again if nothing handles noinput. The"
    " conversation stays open meanwhile, so that no other application can drive the robot"
    " anywhere (rule K1).",
    rule="K1",
    severity="warning",
    message='If nobody answers "{field}", it is asked for ever, and other applications cannot drive'
    " anywhere.",
    remedy='Write <noinput count="3"><exit/></noinput>, or where else to go.',
)

ANY = "#"
"""Stands for the forms to which a goto with an expression may lead."""


def check_leaving(facts: Facts) -> Iterator[Problem]:
    """Warn of a Command that leaves the user before a question is asked again (3.3)."""
    every = list(facts.document.handlers)
    for form, items in facts.forms:
        fields = [item for item in items if isinstance(item, Field)]
        every += form.handlers if fields else []
        for field in fields:
            for handler in field.handlers:
                yield from _leaves(handler)
    for handler in every:
        if not DEFAULTS.isdisjoint(handler.events):
            yield from _leaves(handler)


def _leaves(handler: Handler) -> Iterator[Problem]:
    """Whether a handler leaves the user during a question and returns to it."""
    if any(isinstance(act, Goto | Exit | Return | Throw) for act in all_acts(handler.content)):
        return
    commands = commands_of(handler.content)
    leaving = [one for one in commands if one.type in TABLE_4_2 and TABLE_4_2[one.type].leaves]
    if leaving and not any(one.type == "active-sensing-human" for one in commands):
        node = leaving[0].node
        yield LEAVES_QUESTION.at(node.place, tag=node.tag)


def check_silence(facts: Facts) -> Iterator[Problem]:
    """Warn of questions that are repeated for ever while nobody answers (K1)."""
    for field in silent_fields(facts.document):
        if not field.node.get("name"):
            continue  # missing, which the schema reports
        yield NO_NOINPUT.at(field.node.place, field=field.name)


def check_first_prompts(facts: Facts) -> Iterator[Problem]:
    """Warn of questions that listen without a word the first time, when nothing is said before."""
    late = [(form, prompt) for form, _ in facts.forms if (prompt := _late_prompt(form))]
    begun = [*facts.document.forms.values()][:1]
    spoken = _spoken_before(facts) if late else set()
    for form, prompt in late:
        if form in begun or not {form.id, ANY} & spoken:
            yield ASKED_LATER.at(prompt.node.attribute_place("count"), count=prompt.count)


def _late_prompt(form: Form) -> Prompt | None:
    """The first prompt of a question with which a form begins, if its count is above 1."""
    first = form.items[0] if form.items else None
    if not isinstance(first, Field) or first.cond is not None or first.expr is not None:
        return None
    prompt = min(first.prompts, key=lambda one: one.count, default=None)
    return prompt if prompt is not None and prompt.count > 1 else None


def _spoken_before(facts: Facts) -> set[str]:
    """The forms that are called, or to which content goes after it has said something."""
    found = {name for calls in facts.leads.calls.values() for name in calls}
    for _, content, _ in facts.document.contents():
        ways = [act for act in all_acts(content) if isinstance(act, Goto) and act.form is not None]
        if ways and any(command.text for command in commands_of(content)):
            found |= {way.form if isinstance(way.form, str) else ANY for way in ways}
    return found
