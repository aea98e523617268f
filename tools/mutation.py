"""Mutants of a module: the same code with one small change each.

A mutant is known by its file, its function and the statement before and after the change, not by
its line: it stays the same while other code moves.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
COUNTED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
}
CALLED = {"any": "all", "all": "any", "min": "max", "max": "min", "sorted": "list"}
"""A function, and the one called in its place; ``reversed`` is left out."""
UNTOUCHED = ("annotation", "returns", "decorator_list", "type_params")
"""Fields in which nothing is decided at run time."""


@dataclass(frozen=True)
class Change:
    """One change to a tree, not made yet."""

    parent: ast.AST
    field: str
    index: int | None
    new: ast.AST
    statement: ast.stmt
    function: str

    def swap(self, node: ast.AST) -> ast.AST:
        """Put a node in the place; gives what was there."""
        held = getattr(self.parent, self.field)
        if self.index is None:
            setattr(self.parent, self.field, node)
            return held  # type: ignore[no-any-return]
        old, held[self.index] = held[self.index], node
        return old  # type: ignore[no-any-return]


@dataclass(frozen=True)
class Mutant:
    """One change to one file."""

    file: str
    """Its path from the root of the checkout."""
    position: int
    """Which of the file's changes it is."""
    line: int
    name: str
    """File, function, the statement before and after."""


def mutants(file: str, text: str) -> list[Mutant]:
    """All mutants of a file, in the order of its text."""
    tree = ast.parse(text)
    seen: Counter[str] = Counter()
    made = []
    for position, change in enumerate(changes(tree)):
        name = f"{file.rpartition('/')[2]} {change.function}: {described(change)}"
        seen[name] += 1
        number = f" ({seen[name]})" if seen[name] > 1 else ""
        made.append(Mutant(file, position, change.statement.lineno, name + number))
    return made


def mutated(text: str, position: int) -> ast.Module:
    """The tree of a file with one of its changes made."""
    tree = ast.parse(text)
    change = list(changes(tree))[position]
    change.swap(change.new)
    return ast.fix_missing_locations(tree)


def described(change: Change) -> str:
    """The statement before and after a change, each as one line."""
    before = header(change.statement)
    if isinstance(change.new, ast.stmt):
        return f"{before}  ->  {header(change.new)}"
    old = change.swap(change.new)
    after = header(change.statement)
    change.swap(old)
    return f"{before}  ->  {after}"


def header(statement: ast.AST) -> str:
    """A statement as one line; of one that holds others its first line."""
    kept = {
        name: [ast.Pass()] if name == "body" else []
        for name in ("body", "orelse", "finalbody", "decorator_list")
        if isinstance(getattr(statement, name, None), list)
    }
    copy = type(statement)(**(dict(ast.iter_fields(statement)) | kept))
    return ast.unparse(ast.fix_missing_locations(copy)).partition("\n")[0]


def changes(tree: ast.Module) -> Iterator[Change]:
    """All changes to a tree."""
    for index, statement in enumerate(tree.body):
        yield from _at(tree, "body", index, statement, statement, "module")


def _at(
    parent: ast.AST, field: str, index: int | None, node: ast.AST, within: ast.stmt, function: str
) -> Iterator[Change]:
    """The changes to a node and to all in it."""
    if _untouched(node):
        return
    statement = node if isinstance(node, ast.stmt) else within
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        function = node.name if function == "module" else f"{function}.{node.name}"
    for new in (*_conditions(parent, field, node), *_variants(node), *_shortened(parent, node)):
        yield Change(parent, field, index, new, statement, function)
    for name, value in ast.iter_fields(node):
        if name in UNTOUCHED:
            continue
        for place, child in enumerate(value if isinstance(value, list) else [value]):
            if isinstance(child, ast.AST):
                number = place if isinstance(value, list) else None
                yield from _at(node, name, number, child, statement, function)


def _untouched(node: ast.AST) -> bool:
    """Whether a node decides nothing: a docstring, a type, an assertion, a message's text."""
    match node:
        case ast.Expr(value=ast.Constant()) | ast.Assert() | ast.JoinedStr():
            return True
        case ast.Import() | ast.ImportFrom():
            return True
        case ast.Subscript(value=ast.Name(id="Literal" | "tuple" | "dict")):
            return True
    return False


def _conditions(parent: ast.AST, field: str, node: ast.AST) -> Iterator[ast.AST]:
    """A condition reversed or left out; comparisons and such have changes of their own."""
    if isinstance(parent, ast.comprehension) and field == "ifs":
        yield ast.Constant(True)
    elif field == "test" and isinstance(node, ast.Name | ast.Attribute | ast.Call):
        yield ast.UnaryOp(ast.Not(), node)


def _variants(node: ast.AST) -> Iterator[ast.AST]:
    """The replacements for a node."""
    if isinstance(node, ast.stmt):
        yield from _dropped(node)
        return
    match node:
        case ast.Compare(left, [op], [right]):
            yield from (ast.Compare(left, [other()], [right]) for other in COMPARED[type(op)])
        case ast.BoolOp(op, values):
            rest = [values[:at] + values[at + 1 :] for at in range(len(values))]
            yield from (ast.BoolOp(op, some) if some[1:] else some[0] for some in rest)
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield operand
        case ast.BinOp(left, op, right) if type(op) in COUNTED:
            yield ast.BinOp(left, COUNTED[type(op)](), right)
        case ast.Constant(value):
            yield from _constants(value)
        case ast.Call(ast.Name("reversed"), [given]):
            yield given
        case ast.Call(ast.Name(name), given, named) if name in CALLED:
            kept = [] if name == "sorted" else named
            yield ast.Call(ast.Name(CALLED[name], ast.Load()), given, kept)


def _shortened(parent: ast.AST, node: ast.AST) -> Iterator[ast.AST]:
    """A call without one of its named arguments, a tuple without one of its elements."""
    match node:
        case ast.Call(called, given, named):
            for at, one in enumerate(named):
                if one.arg != "strict":  # it only guards
                    yield ast.Call(called, given, named[:at] + named[at + 1 :])
        case ast.Tuple([_, _, *_] as elements, ast.Load()) if not isinstance(parent, ast.Subscript):
            for at in range(len(elements)):
                yield ast.Tuple(elements[:at] + elements[at + 1 :], ast.Load())


def _constants(value: object) -> Iterator[ast.AST]:
    if isinstance(value, bool):
        yield ast.Constant(not value)
    elif isinstance(value, int):
        yield ast.Constant(value + 1)
    elif isinstance(value, str):
        yield ast.Constant("" if value else "x")


def _dropped(node: ast.stmt) -> Iterator[ast.AST]:
    """A statement left out, where the code after it still has its variables; a loop left early."""
    match node:
        case ast.While(test, body, orelse):
            yield ast.If(test, body, orelse)
        case ast.Continue():
            yield ast.Break()
    match node:
        case ast.Expr() | ast.Delete() | ast.Continue() | ast.Break() | ast.Raise():
            yield ast.Pass()
        case ast.Return(value=None):
            yield ast.Pass()
        case ast.AugAssign():
            yield ast.Pass()
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript(), *_]):
            yield ast.Pass()
