"""Comparisons of a field's variable with a text that none of its answers gives."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING

from prima.errors import Diagnosis, Hint, Problem, Span, one_of, suggestion
from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.interpreter.acts import Assign, Declare, Expression, Foreach, If, Script
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Field
from prima.script.parse import parse_expression

if TYPE_CHECKING:
    from tree_sitter import Node

NEVER_EQUAL = Diagnosis(
    "never-equal",
    "Comparison with no answer",
    "A condition compares the variable of a question with a text that is the value of none of its"
    " answers. It never holds, or with != always. A question of the type boolean gives true or false"
    " and no text; an option its value, or else its own text; a grammar what its tags say. Upper and"
    " lower case count.",
    severity="warning",
    message='No answer to "{field}" gives it the value "{text}".',
)
TRUE_OR_FALSE = 'It is true or false: write "{field}" or "!{field}".'
EQUALITY = frozenset(("==", "===", "!=", "!=="))
NAME = re.compile(r"[\w$]+")
NUMERIC = re.compile(r"\s*([-+.\d].*)?", re.DOTALL)
"""A text that may equal true, false or a number; an empty one may stand for no answer."""
PLAIN = re.compile(r"[\w .-]*")
"""A text that is written in an attribute as it is."""
MOST = 5
"""Maximum number of values that a message lists."""
LONGEST = 100
"""Characters of a text above which a comparison is not checked."""
MOST_CHECKED = 100
"""Maximum number of comparisons checked: each may have to be matched by a grammar."""


def check_comparisons(facts: Facts) -> Iterator[Problem]:
    """Warn of conditions that compare a field's variable with what it never is."""
    values: dict[int, set[str]] = {}  # by field, as a grammar may have very many
    for expr, start, field, text in islice(_compared(facts), MOST_CHECKED):
        if id(field) not in values:
            values[id(field)] = _values(field)
        if not _possible(field, text, values[id(field)]):
            span = Span.of(place_in(expr, start + 1), text)
            hint = _remedy(field, text, values[id(field)], span)
            yield NEVER_EQUAL.at(place_in(expr, start), hint, field=field.name, text=text)


def _compared(facts: Facts) -> Iterator[tuple[Expression, int, Field, str]]:
    """Each comparison of a field's variable with a text, and where the text begins."""
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
                yield from _comparisons(expr, fields)


def _conditions(facts: Facts) -> dict[str, list[Expression]]:
    """The conditions that may compare a text, by forms."""
    found: dict[str, list[Expression]] = {}
    for form, items in facts.forms:
        for item in items:
            if item.cond is not None and _compares(item.cond.code):
                found.setdefault(form.id, []).append(item.cond)
    for holder, act in facts.acts.of(If):
        for cond, _ in act.branches:
            if holder is not None and cond is not None and _compares(cond.code):
                found.setdefault(holder.id, []).append(cond)
    return found


def _compares(code: str) -> bool:
    return ("==" in code or "!=" in code) and ("'" in code or '"' in code)


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


def _comparisons(
    expr: Expression, fields: dict[str, Field]
) -> Iterator[tuple[Expression, int, Field, str]]:
    parsed = parse_expression(expr.code) if fields else None
    for node in parsed.walk() if parsed is not None else ():
        sides = _sides(node)
        if parsed is not None and sides is not None:
            name, text = sides
            if (field := fields.get(parsed.of(name))) is not None:
                yield expr, parsed.start(text), field, parsed.of(text)[1:-1]


def _sides(node: Node) -> tuple[Node, Node] | None:
    """The name and the text that a comparison compares."""
    if node.type != "binary_expression" or node.children[1].type not in EQUALITY:
        return None
    left, _, right = node.children
    if left.type == "string":
        left, right = right, left
    return (left, right) if (left.type, right.type) == ("identifier", "string") else None


def _possible(field: Field, text: str, values: set[str]) -> bool:
    """Whether some answer may give this value; where no grammar has a tag it is what is said."""
    if "\\" in text or NUMERIC.fullmatch(text) or len(text) > LONGEST or text in values:
        return True
    said = Answers(grammars=field.answers.grammars).match(text)
    return said is not None and fold(str(said)) == fold(text)


def _values(field: Field) -> set[str]:
    """The values of a field's options, and the texts of its tags."""
    tags = (one for one in field.node.walk() if one.tag == "tag")
    return {" ".join(one.text.split()) for one in tags} | {
        str(one) for one in field.answers.options.values()
    }


def _remedy(field: Field, text: str, values: set[str], span: Span) -> Hint:
    if field.answers.type:
        return Hint(TRUE_OR_FALSE.format(field=field.name))
    plain = filter(PLAIN.fullmatch, values) if PLAIN.fullmatch(text) else ()
    return suggestion(text, plain, span) or Hint(f"It is {one_of(values, MOST)}.")
