"""Comparisons of an answer with a text that it never is."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from prima.errors import Problem, Span, meant, nearest_word
from prima.errors.diagnoses.values import BAD_VALUE
from prima.interpreter.acts import Assign, Declare, Expression, If
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Field, Item

WORD = re.compile(r"[\w$]+")
COMPARED = re.compile(r"""(?<![\w$.])([A-Za-z_$][\w$]*)\s*[!=]==?\s*(['"])([^'"\\]*)\2""")

NO_ANSWER = BAD_VALUE.says(
    '"{name}" is never "{text}": no option has that value.', severity="warning"
)


def check_comparisons(facts: Facts) -> Iterator[Problem]:
    """Warn of a comparison with a misspelt value of a question's options."""
    others = {act.name.rpartition(".")[2] for _, act in facts.acts.of(Assign)}
    others |= {act.name for _, act in facts.acts.of(Declare)}
    others.update(*(WORD.findall(code) for code in facts.document.scripts))
    values = {form.id: _values(items, others) for form, items in facts.forms}
    for holder, act in facts.acts.of(If):
        known = values.get(holder.id, {}) if holder is not None else {}
        for cond in (one for one, _ in act.branches if one is not None and known):
            yield from _compared(cond, known)


def _values(items: Sequence[Item], others: set[str]) -> dict[str, set[str]]:
    """The values of questions that options alone give, by the names of their fields.

    ``others`` are names to which something else is given, or may be.
    """
    return {
        one.name: {str(value) for value in one.answers.options.values()}
        for one in items
        if isinstance(one, Field) and one.name not in others
        if not (one.expr or one.answers.grammars or one.answers.type)
    }


def _compared(cond: Expression, known: dict[str, set[str]]) -> Iterator[Problem]:
    for found in COMPARED.finditer(cond.code):
        name, text = found[1], found[3]
        right = nearest_word(text, known[name]) if name in known else ""
        if right and text not in known[name]:
            place = place_in(cond, found.start(3))
            yield NO_ANSWER.at(place, meant(right, Span.of(place, text)), name=name, text=text)
