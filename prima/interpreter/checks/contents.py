"""Variables that content declares: each piece of content has its own, which end with it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from prima.errors import Hint, Problem
from prima.errors.diagnoses.names import UNDECLARED_VARIABLE
from prima.interpreter.acts import (
    HOLDING,
    Act,
    Assign,
    CommandRun,
    Declare,
    Expression,
    Foreach,
    If,
    Script,
    run_commands,
)
from prima.interpreter.checks.code import HELD, of_item
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Form
from prima.script.names import Names, expression_names, script_names

OF_OTHER_CONTENT = UNDECLARED_VARIABLE.says(
    'The variable "{name}" is declared in other content, and ends with it: this will be'
    " error.semantic.",
    severity="warning",
)


@dataclass(slots=True)
class Piece:
    """A piece of content: a block's, a filled's or a handler's, without handlers in its Commands."""

    form: Form | None
    acts: list[Act]

    def declared(self) -> set[str]:
        """The names that it declares."""
        names: set[str] = set()
        for act in self.acts:
            if isinstance(act, Declare):
                names.add(act.name)
            elif isinstance(act, Foreach):
                names.add(act.item)
            elif isinstance(act, Script):
                names |= script_names(act.code.code).declared
        return names

    def expressions(self) -> Iterator[Expression]:
        """Its code, scripts aside."""
        for act in self.acts:
            held = HELD[type(act)](act) if type(act) in HELD else ()
            yield from (one for one in held if isinstance(one, Expression))


def check_contents(facts: Facts) -> Iterator[Problem]:
    """Code that uses a variable which only other content has declared."""
    if not any(next(facts.acts.of(kind), None) for kind in (Declare, Foreach, Script)):
        return
    pieces = [
        piece for form, content, _ in facts.document.contents() for piece in _pieces(form, content)
    ]
    declared: defaultdict[str | None, set[str]] = defaultdict(set)
    for piece in pieces:
        declared[piece.form.id if piece.form else None] |= piece.declared()
    everywhere = set().union(*declared.values())
    for piece in pieces:
        if piece.form is not None:
            others = declared[piece.form.id] | declared[None]
            outside = facts.outside_content(piece.form)
        else:
            others = everywhere
            outside = set().union(*(facts.outside_content(form) for form, _ in facts.forms))
        yield from _used(piece, others - outside - piece.declared())
    for form, items in facts.forms:
        others = (declared[form.id] | declared[None]) - facts.outside_content(form)
        for item in items:
            yield from _in_expressions(of_item(item), others)


def _pieces(form: Form | None, content: Sequence[Act]) -> Iterator[Piece]:
    """Content as one piece, and the handlers inside its Commands as others."""
    found: list[Act] = []
    inner: list[Sequence[Act]] = []

    def add(acts: Sequence[Act]) -> None:
        for act in acts:
            found.append(act)
            if type(act) not in HOLDING:
                continue
            if isinstance(act, If):
                for _, branch in act.branches:
                    add(branch)
            elif isinstance(act, Foreach):
                add(act.content)
            elif isinstance(act, CommandRun):
                commands = run_commands(act.steps)
                inner.extend(one.content for command in commands for one in command.handlers)

    add(content)
    yield Piece(form, found)
    for one in inner:
        yield from _pieces(form, one)


def _used(piece: Piece, others: set[str]) -> Iterator[Problem]:
    """The names of other content that a piece uses or assigns."""
    if not others:
        return
    yield from _in_expressions(piece.expressions(), others)
    for act in piece.acts:
        if isinstance(act, Script):
            yield from _in_code(act.code, script_names(act.code.code), others)
        elif isinstance(act, Assign) and (name := act.name.partition(".")[0]) in others:
            place = act.node.attribute_place("name")
            yield OF_OTHER_CONTENT.at(place, _remedy(name), name=name)


def _in_expressions(expressions: Iterable[Expression], others: set[str]) -> Iterator[Problem]:
    for expr in expressions if others else ():
        yield from _in_code(expr, expression_names(expr.code), others)


def _in_code(code: Expression, names: Names, others: set[str]) -> Iterator[Problem]:
    for name, start in names.free.items():
        if name in others:
            yield OF_OTHER_CONTENT.at(place_in(code, start), _remedy(name), name=name)


def _remedy(name: str) -> Hint:
    return Hint(
        f'Declare it in the form, beside its items, and assign it there: <var name="{name}"/>.'
    )
