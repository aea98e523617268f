"""Expressions and scripts that are not ECMAScript, and conditions that assign."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from itertools import chain
from typing import Any

from prima.errors import Problem
from prima.errors.diagnoses.names import BAD_EXPRESSION
from prima.interpreter.acts import (
    Act,
    Assign,
    CommandRun,
    Declare,
    Expression,
    Foreach,
    Goto,
    Handler,
    If,
    Log,
    Script,
    SendOut,
    Throw,
    run_commands,
)
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import Variables, place_in
from prima.interpreter.elements import Document, Field, Form, Item, Prompt, Subdialog
from prima.interpreter.steps import no_step
from prima.script.compile import compiled
from prima.script.conditions import assigning
from prima.script.data import declared
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.known import Known
from prima.script.slips import code_remedy

CONDITIONS = frozenset({"cond", "when"})
"""Attributes with conditions."""
WIDEST = 60
"""Characters of code that a message quotes."""

NOT_ECMASCRIPT = BAD_EXPRESSION.says('"{code}" is not ECMAScript: {error}.')
NOT_CHECKED = BAD_EXPRESSION.says('"{code}" cannot be checked: {error}.', severity="warning")


def of_requests(run: CommandRun) -> Iterator[object]:
    """What the Commands of a run are requested with, without their handlers."""
    for command in run_commands(run.steps):
        yield from command.args.values()
        yield from command.text or ()
        yield from (value for _, value in command.extra)


def _of_run(run: CommandRun) -> Iterator[object]:
    yield from of_requests(run)
    for command in run_commands(run.steps):
        yield from conditions(command.handlers)


HELD: Mapping[type[Act], Callable[[Any], Iterable[object]]] = {
    Declare: lambda act: (act.expr,),
    Assign: lambda act: (act.expr,),
    If: lambda act: [cond for cond, _ in act.branches],
    Foreach: lambda act: (act.array,),
    Log: lambda act: act.text,
    Throw: lambda act: (act.event, act.message),
    Goto: lambda act: (act.form, act.item),
    SendOut: lambda act: (act.service, act.delay, *(value for _, value in act.params)),
    CommandRun: _of_run,
}
"""Fields of acts that may be expressions, by kinds; scripts are checked separately."""


def check_code(facts: Facts) -> Iterator[Problem]:
    """Check all code of a document, and the variables that it uses."""
    variables = Variables(facts)
    waiting: list[tuple[Expression, Known, bool]] = []
    for expr, known, script in all_code(facts):
        if (declared if script else compiled)(expr.code) is None:
            waiting.append((expr, known, script))  # needs an engine
        else:
            yield from _used(variables, expr, known, script)
    _look_ahead([(expr.code, script) for expr, _, script in waiting])
    for expr, known, script in waiting:
        if expr.attribute and not expr.node.get(expr.attribute).strip():
            continue  # missing or empty, which the schema reports
        problem = _compiled(expr, script)
        if problem is not None:
            yield problem
        else:
            yield from _used(variables, expr, known, script)
    yield from variables.given()
    yield from variables.hidden()
    for _, act in facts.acts.of(Assign):
        yield from no_step(act.node)


def _used(variables: Variables, expr: Expression, known: Known, script: bool) -> Iterator[Problem]:
    if script:
        return variables.of_script(expr, known)
    found = variables.of_expression(expr, known)
    if expr.attribute not in CONDITIONS:
        return found
    return chain(found, assigning(expr.code, partial(place_in, expr)))


# All code, with the names that it may use and whether it is a script


Code = tuple[Expression, Known, bool]


def all_code(facts: Facts) -> Iterator[Code]:
    """All code of a document, with the variables that it sees, and whether it is a script."""
    yield from outside(facts.document, Known(facts.shared), facts.known_in(None))
    for form, items in facts.forms:
        known = facts.known_in(form)
        yield from outside(form, known, known)
        for item in items:
            for one in of_item(item):
                yield one, known, False
    for kind, held in HELD.items():
        for holder, act in facts.acts.of(kind):
            for code in expressions(held(act)):
                yield code, facts.known_in(holder), False
    for holder, script in facts.acts.of(Script):
        yield script.code, facts.known_in(holder), True


def expressions(held: Iterable[object]) -> Iterator[Expression]:
    """The expressions among some values."""
    return (one for one in held if isinstance(one, Expression))


def outside(holder: Document | Form, known: Known, later: Known) -> Iterator[Code]:
    """Code of a document or form outside of content; ``later`` is visible to its handlers."""
    for act in holder.setup:
        if isinstance(act, Script):
            yield act.code, known, True
        elif act.expr is not None:
            yield act.expr, known, False
    for watch in holder.watches:
        yield watch.when, known, False
    for cond in conditions(holder.handlers):
        yield cond, later, False


def conditions(conditional: Iterable[Handler | Prompt]) -> Iterator[Expression]:
    """The conditions of handlers or prompts."""
    return (one.cond for one in conditional if one.cond is not None)


def of_item(item: Item) -> Iterator[Expression]:
    """Code of a form item outside of content."""
    yield from conditions(item.handlers)
    held: list[object] = [item.expr, item.cond]
    if isinstance(item, Field):
        yield from conditions(item.prompts)
        held += [part for prompt in item.prompts for part in prompt.text]
    elif isinstance(item, Subdialog):
        held += [value for _, value in item.params]
    yield from expressions(held)


# Checks by an engine


def _look_ahead(codes: list[tuple[str, bool]]) -> None:
    """Let the engine check all code that needs it in one call, as each call takes time."""
    if len(codes) > 1:
        from prima.script.shared import syntax

        with suppress(ScriptError):  # the check of each piece reports that there is no engine
            syntax().look_ahead(codes)


def _compiled(expr: Expression, script: bool) -> Problem | None:
    from prima.script.shared import syntax

    try:
        (syntax().script if script else syntax().expression)(expr.code)
    except ScriptError as error:
        shown = " ".join(expr.code.split())
        shown = shown if len(shown) <= WIDEST else shown[: WIDEST - 3] + "..."
        place = expr.node.code_place(expr.attribute, error.line, error.column)
        if isinstance(error, EngineLost):  # perhaps from outside: a run may still succeed
            return NOT_CHECKED.at(place, code=shown, error=error)
        found = NOT_ECMASCRIPT.at(place, code=shown, error=error)
        plain = script or expr.attribute in CONDITIONS
        remedy = code_remedy(expr.code, error, statements=script, text=not plain)
        return found._replace(remedy=remedy) if remedy else found
    return None
