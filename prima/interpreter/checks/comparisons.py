"""Comparisons of a field's variable with a text that none of its answers gives."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from itertools import islice

from prima.errors import Problem
from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.interpreter.acts import Assign, Declare, Expression, Foreach, If, Script
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Field
from prima.script.budget import Budget
from prima.script.conditions import Compared, compared, may_compare, may_equal, never_equal

NAME = re.compile(r"[\w$]+")
MOST_CHECKED = 100
"""Maximum number of comparisons checked: each may have to be matched by a grammar."""


def check_comparisons(facts: Facts) -> Iterator[Problem]:
    """Warn of conditions that compare a field's variable with what it never is."""
    values: dict[int, set[str]] = {}  # by field, as a grammar may have very many
    said: dict[int, set[str]] = {}
    budget = Budget()  # to list answers, in all grammars
    for expr, found, field in islice(_compared(facts), MOST_CHECKED):
        if id(field) not in values:
            values[id(field)] = _values(field)
        if not _possible(field, found.text, values[id(field)]):
            if id(field) not in said and budget.steps > 0:
                said[id(field)] = _said(field, budget)
            given = None if field.answers.type else values[id(field)] | said.get(id(field), set())
            yield never_equal(found, partial(place_in, expr), given)


def _compared(facts: Facts) -> Iterator[tuple[Expression, Compared, Field]]:
    """Each comparison of a field's variable with a text."""
    conditions = _conditions(facts)
    changed = _changed(facts) if conditions else set()
    for form, items in facts.forms:
        if form.id in conditions:
            fields = {
                item.name: item
                for item in items
                if isinstance(item, Field)
                and item.expr is None
                and item.name not in changed
                and _known(item.answers)
                and not any(one.get("src") for one in item.node.nodes)
            }
            for expr in conditions[form.id]:
                yield from _with_fields(expr, fields)


def _with_fields(
    expr: Expression, fields: dict[str, Field]
) -> Iterator[tuple[Expression, Compared, Field]]:
    for found in compared(expr.code) if fields else ():
        if found.name in fields:
            yield expr, found, fields[found.name]


def _conditions(facts: Facts) -> dict[str, list[Expression]]:
    """The conditions that may compare a text, by forms."""
    found: dict[str, list[Expression]] = {}
    for form, items in facts.forms:
        for item in items:
            if item.cond is not None and may_compare(item.cond.code):
                found.setdefault(form.id, []).append(item.cond)
    for holder, act in facts.acts.of(If):
        for cond, _ in act.branches:
            if holder is not None and cond is not None and may_compare(cond.code):
                found.setdefault(holder.id, []).append(cond)
    return found


def _changed(facts: Facts) -> set[str]:
    """The names of variables that a field may share, or that have other values than answers."""
    names = {act.name.rpartition(".")[2] for _, act in facts.acts.of(Assign)}
    names |= {act.name for _, act in facts.acts.of(Declare)}
    names |= {act.item for _, act in facts.acts.of(Foreach)}
    setups = [facts.document.setup, *(form.setup for form, _ in facts.forms)]
    scripts = [one for setup in setups for one in setup if isinstance(one, Script)]
    scripts += [act for _, act in facts.acts.of(Script)]
    return names.union(*(NAME.findall(one.code.code) for one in scripts))


def _known(answers: Answers) -> bool:
    """Whether the values of answers are options, what a grammar gives, or true and false."""
    if answers.type == "boolean":
        return not answers.options and not answers.grammars
    return not answers.type and bool(answers.options or answers.grammars)


def _possible(field: Field, text: str, values: set[str]) -> bool:
    """Whether some answer may give this value; where no grammar has a tag it is what is said."""
    if may_equal(text, values):
        return True
    said = Answers(grammars=field.answers.grammars).match(text)
    return said is not None and fold(str(said)) == fold(text)


def _said(field: Field, budget: Budget) -> set[str]:
    """Values of some answers that the field's grammars take, as far as the budget goes."""
    from prima.grammar.phrases import phrases  # few documents have such a mistake

    answers = Answers(grammars=field.answers.grammars)
    found = (answers.match(phrase, budget) for phrase in phrases(answers))
    return {str(value) for value in found if value is not None}


def _values(field: Field) -> set[str]:
    """The values of a field's options, and the texts of its tags."""
    tags = (one for one in field.node.walk() if one.tag == "tag")
    return {" ".join(one.text.split()) for one in tags} | {
        str(one) for one in field.answers.options.values()
    }
