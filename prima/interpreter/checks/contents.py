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
    Clear,
    CommandRun,
    CommandTemplate,
    Declare,
    Expression,
    Foreach,
    If,
    Return,
    Script,
    run_commands,
)
from prima.interpreter.checks.code import (
    HELD,
    conditions,
    expressions,
    of_item,
    of_requests,
    outside,
)
from prima.interpreter.checks.facts import Facts, name_of
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Form
from prima.markup.tree import Node
from prima.script.known import Known, NameScope
from prima.script.names import Names, expression_names, script_names

OF_OTHER_CONTENT = UNDECLARED_VARIABLE.says(
    'The variable "{name}" is declared in other content, and ends with it: this will be'
    " error.semantic.",
    severity="warning",
)


@dataclass(slots=True)
class Others:
    """The variables that only content declares, of all content that some code might mean."""

    declared: Known
    """Those of content."""
    outside: Known
    """Those that no content declares, which hide them."""

    def __contains__(self, name: str) -> bool:
        return name in self.declared and name not in self.outside


@dataclass(slots=True)
class Piece:
    """A piece of content: a block's, a filled's or a handler's, without handlers in its Commands."""

    form: Form | None
    acts: list[Act]
    conds: list[Expression]
    """The conditions of the handlers in its Commands, which see none of its variables."""

    def declared(self) -> NameScope:
        """The names that it declares."""
        names = NameScope()
        for act in self.acts:
            if isinstance(act, Declare):
                names.add(act.name)
            elif isinstance(act, Foreach):
                names.add(act.item)
            elif isinstance(act, Script):
                names |= script_names(act.code.code).declared
        return names

    def expressions(self) -> Iterator[Expression]:
        """Its code, scripts and conditions of handlers aside."""
        for act in self.acts:
            if isinstance(act, CommandRun):
                yield from expressions(of_requests(act))
            elif type(act) in HELD:
                yield from expressions(HELD[type(act)](act))


def check_contents(facts: Facts) -> Iterator[Problem]:
    """Code that uses a variable which only other content has declared."""
    if not any(next(facts.acts.of(kind), None) for kind in (Declare, Foreach, Script)):
        return
    pieces = [
        piece for form, content, _ in facts.document.contents() for piece in _pieces(form, content)
    ]
    others = _others(facts, pieces)
    for piece in pieces:
        yield from _used(piece, others[name_of(piece.form)])
    # The variables and watches of the document are checked with those that it declares itself.
    yield from _in_expressions(conditions(facts.document.handlers), others[None], NameScope())
    for form, items in facts.forms:
        known = Known()  # the variables that it sees are checked elsewhere
        for code, _, script in outside(form, known, known):
            names = script_names(code.code) if script else expression_names(code.code)
            yield from _in_code(code, names, others[form.id], NameScope())
        for item in items:
            yield from _in_expressions(of_item(item), others[form.id], NameScope())


def _others(facts: Facts, pieces: list[Piece]) -> dict[str | None, Others]:
    """By form: the variables of its content and of the document's. None: those of all content."""
    declared: defaultdict[str | None, NameScope] = defaultdict(NameScope)
    for piece in pieces:
        declared[name_of(piece.form)].update(piece.declared())
    found: dict[str | None, Others] = {}
    every, outside = NameScope(declared[None]), NameScope(facts.shared)
    for form, _ in facts.forms:
        own = facts.outside_content(form)
        found[form.id] = Others(Known(declared[form.id], declared[None]), Known(facts.shared, own))
        every |= declared[form.id]
        outside |= own
    found[None] = Others(Known(every), Known(outside))
    return found


def _pieces(form: Form | None, content: Sequence[Act]) -> Iterator[Piece]:
    """Content as one piece, and the handlers inside its Commands as others."""
    found: list[Act] = []
    commands: list[CommandTemplate] = []

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
                commands.extend(run_commands(act.steps))

    add(content)
    inner = [one for command in commands for one in command.handlers]
    yield Piece(form, found, [*conditions(inner)])
    for one in inner:
        yield from _pieces(form, one.content)


def _used(piece: Piece, others: Others) -> Iterator[Problem]:
    """The names of other content that a piece uses, assigns, clears or returns."""
    own = piece.declared()
    yield from _in_expressions(piece.expressions(), others, own)
    yield from _in_expressions(piece.conds, others, NameScope())
    for act in piece.acts:
        if isinstance(act, Script):
            yield from _in_code(act.code, script_names(act.code.code), others, own)
        elif isinstance(act, Assign):
            yield from _named(act.node, "name", [act.name.partition(".")[0]], others, own)
        elif isinstance(act, Clear | Return):
            yield from _named(act.node, "namelist", act.names, others, own)


def _named(
    node: Node, attribute: str, names: Iterable[str], others: Others, own: NameScope
) -> Iterator[Problem]:
    """The names of other content that an attribute lists."""
    for name in names:
        if name in others and name not in own:
            yield OF_OTHER_CONTENT.at(node.attribute_place(attribute), _remedy(name), name=name)


def _in_expressions(
    expressions: Iterable[Expression], others: Others, own: NameScope
) -> Iterator[Problem]:
    for expr in expressions:
        yield from _in_code(expr, expression_names(expr.code), others, own)


def _in_code(code: Expression, names: Names, others: Others, own: NameScope) -> Iterator[Problem]:
    for name, start in names.free.items():
        if name in others and name not in own:
            yield OF_OTHER_CONTENT.at(place_in(code, start), _remedy(name), name=name)


def _remedy(name: str) -> Hint:
    return Hint(
        f'Declare it in the form, beside its items, and assign it there: <var name="{name}"/>.'
    )
