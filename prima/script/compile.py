"""Compiles expressions that need no engine (names, members, literals, operators) to Python.

Most expressions in documents are of this kind. Anything else (functions, assignments, members of
prototypes, calls other than ``Number``, ``String`` and ``Boolean``) is left to the engine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from prima.script.ecmascript import UNDEFINED, Scopes, index_of, kind_of, number_text, truth
from prima.script.evaluation import ScriptError
from prima.script.globals import BUILT_IN, INHERITED, METHODS, RESERVED
from prima.script.literals import WORDS, Beyond, fresh, literal, number, string
from prima.script.operations import (
    MISSING,
    OPERATIONS,
    found,
    has_member,
    member,
    member_of,
    numeric,
    sought,
    textual,
)
from prima.script.parse import Code, Node, inner, parse_bracketed

Function = Callable[[Scopes], Any]

MOST_CODE = 1_000
"""Maximum length of code compiled here."""
MOST_PIECES = 200
"""Maximum number of pieces of code; larger expressions are left to the engine."""
DEEPEST = 100
"""Maximum depth of operators, members and brackets."""
AS_LONG = 200
"""How many characters of cached code beyond these limits count as one more piece."""
MOST_KEPT = 100_000
"""Maximum number of pieces of code in the cache; each takes some hundred bytes."""


@dataclass(slots=True)
class Compiled:
    """An expression as a function of the scopes that it sees."""

    call: Function
    pieces: int
    """The approximate number of pieces of code in it."""


class _Cache:
    expressions: dict[str, Compiled | None] = {}  # noqa: RUF012
    """Recently compiled expressions, by their code."""
    pieces = 0
    """Of all that is kept."""


def compiled(code: str) -> Compiled | None:
    """An expression as a function of the scopes it sees, or None if it needs an engine."""
    if len(code) > MOST_CODE:
        return None
    if code not in _Cache.expressions:
        made = _compile(code)
        _Cache.pieces += made.pieces if made else 1 + len(code) // AS_LONG
        if _Cache.pieces > MOST_KEPT:
            _Cache.pieces = 0
            _Cache.expressions.clear()
        _Cache.expressions[code] = made
        return made
    return _Cache.expressions[code]


def _compile(code: str) -> Compiled | None:
    parsed = parse_bracketed(code)
    node = inner(parsed) if parsed is not None else None
    if parsed is None or node is None:
        return None
    pieces = 1 + node.descendant_count // 2
    if pieces > MOST_PIECES:
        return None
    try:
        return Compiled(_Builder(parsed).build(node, 0).call, pieces)
    except Beyond:
        return None


@dataclass(slots=True)
class _Piece:
    """Part of an expression."""

    call: Function
    optional: bool = False
    """Whether it is an optional chain (``?.``): its value may be :data:`CUT`."""


CUT = object()
"""The value of a short-circuited chain."""


class _Builder:
    """Builds functions from the nodes of an expression's tree."""

    def __init__(self, code: Code) -> None:
        self.code = code
        self.last = (1, 1)
        """Line and column of the last name, or of the operand after the last operator: errors of a
        member are reported there, as in the engine."""

    def build(self, node: Node, depth: int) -> _Piece:
        """The function of an expression.

        Raises:
            Beyond: it needs an engine.
        """
        make = MAKERS.get(node.type)
        if make is None or depth > DEEPEST:
            raise Beyond
        return make(self, node, depth + 1)

    def part(self, node: Node, name: str, depth: int) -> _Piece:
        """The function of a subexpression."""
        held = node.child_by_field_name(name)
        if held is None:
            raise Beyond
        return self.build(held, depth)

    def place(self, node: Node) -> tuple[int, int]:
        """Line and column of a node.

        Raises:
            Beyond: the engine counts other line ends as well.
        """
        before = self.code.text[: self.code.start(node)]
        if "\u2028" in before or "\u2029" in before:
            raise Beyond
        return before.count("\n") + 1, len(before) - before.rfind("\n")

    # Literals and names -----------------------------------------------------------------------

    def literal(self, node: Node, _depth: int) -> _Piece:
        """A number, text, word, array or object; arrays and objects are new at every evaluation."""
        value = literal(self.code, node)
        if isinstance(value, list | dict):
            return _Piece(lambda _scopes: fresh(value))
        return _Piece(lambda _scopes: value)

    def name(self, node: Node, _depth: int) -> _Piece:
        """A variable, looked up from the innermost scope outwards."""
        name = self._name(node)
        line, column = self.last = self.place(node)

        def call(scopes: Scopes) -> Any:
            _, document, dialog, local = scopes
            if name in local:
                return local[name]
            if name in dialog:
                return dialog[name]
            if name in document:
                return document[name]
            return sought(name, line, column, scopes)

        return _Piece(call)

    def _name(self, node: Node) -> str:
        name = self.code.of(node)
        if not name.isascii() or "\\" in name or name in BEYOND:
            raise Beyond
        return name

    # Operators --------------------------------------------------------------------------------

    def brackets(self, node: Node, depth: int) -> _Piece:
        """An expression in brackets, which limit the effect of ``?.``."""
        held = node.named_children
        if len(held) != 1:
            raise Beyond
        return _Piece(self.build(held[0], depth).call)

    def conditional(self, node: Node, depth: int) -> _Piece:
        """``a ? b : c``."""
        asks, one, other = (
            self.part(node, name, depth).call
            for name in ("condition", "consequence", "alternative")
        )
        return _Piece(lambda scopes: one(scopes) if truth(asks(scopes)) else other(scopes))

    def binary(self, node: Node, depth: int) -> _Piece:
        """``a + b`` and the like."""
        operator, held = (node.child_by_field_name(name) for name in ("operator", "right"))
        if operator is None or held is None:
            raise Beyond
        first = self.part(node, "left", depth).call
        logical = operator.type in ("&&", "||")
        if not logical:
            self.last = self.place(held)
        second = self.build(held, depth).call
        if logical:
            return _Piece(self._logical(operator.type, first, second))
        if operator.type == "in":
            place = self.last
            return _Piece(lambda scopes: has_member(first(scopes), second(scopes), *place, scopes))
        if operator.type not in OPERATIONS:
            raise Beyond
        act = OPERATIONS[operator.type]
        return _Piece(lambda scopes: act(first(scopes), second(scopes), scopes))

    @staticmethod
    def _logical(mark: str, first: Function, second: Function) -> Function:
        """``a && b`` or ``a || b``: one of the two values."""

        def both(scopes: Scopes) -> Any:
            value = first(scopes)
            return second(scopes) if truth(value) else value

        def either(scopes: Scopes) -> Any:
            value = first(scopes)
            return value if truth(value) else second(scopes)

        return both if mark == "&&" else either

    def unary(self, node: Node, depth: int) -> _Piece:
        """``!a``, ``-a``, ``+a`` and ``typeof a``."""
        operator = node.children[0].type
        operand = node.child_by_field_name("argument")
        while operator == "typeof" and operand is not None and operand.type == BRACKETS:
            operand = operand.named_children[0]
        if operator == "typeof" and operand is not None and operand.type == "identifier":
            name = self._name(operand)  # an undeclared one is not an error here
            self.last = self.place(operand)
            return _Piece(lambda scopes: kind_of(found(name, scopes)))
        call = self.part(node, "argument", depth).call
        made: dict[str, Function] = {
            "!": lambda scopes: not truth(call(scopes)),
            "-": lambda scopes: -numeric(call(scopes), scopes),
            "+": lambda scopes: numeric(call(scopes), scopes),
            "typeof": lambda scopes: kind_of(call(scopes)),
        }
        if operator not in made:
            raise Beyond
        return _Piece(made[operator])

    def conversion(self, node: Node, depth: int) -> _Piece:
        """``Number(a)``, ``String(a)`` and ``Boolean(a)``."""
        called, given = (node.child_by_field_name(name) for name in ("function", "arguments"))
        if called is None or given is None or len(node.children) != 2:
            raise Beyond
        name, values = self.code.of(called), given.named_children
        if name not in CONVERSIONS or len(values) != 1 or values[0].type not in CONVERTED:
            raise Beyond
        convert, call = CONVERSIONS[name], self.build(values[0], depth).call
        place = self.last

        def converted(scopes: Scopes) -> Any:
            value = call(scopes)
            if found(name, scopes, MISSING) is not MISSING:
                raise ScriptError("TypeError: not a function", [place])  # a variable hides it
            return convert(value, scopes)

        return _Piece(converted)

    # Members ----------------------------------------------------------------------------------

    def member(self, node: Node, depth: int) -> _Piece:
        """``a.b``, ``a["b"]``, ``a[b]`` and ``a?.b``."""
        piece = self._chain(node, depth)
        if not piece.optional:
            return piece
        call = piece.call

        def whole(scopes: Scopes) -> Any:
            value = call(scopes)
            return UNDEFINED if value is CUT else value

        return _Piece(whole)

    def _chain(self, node: Node, depth: int) -> _Piece:
        """A member chain; ``?.`` short-circuits on null and undefined."""
        holder = node.child_by_field_name("object")
        part = node.child_by_field_name("property") or node.child_by_field_name("index")
        if holder is None or part is None or depth > DEEPEST:
            raise Beyond
        inside = self._chain if holder.type in MEMBERS else self.build
        value = inside(holder, depth + 1)
        look = self._look(part, depth)
        asks, cuts = node.child_by_field_name("optional_chain") is not None, value.optional
        call = value.call

        def look_on(scopes: Scopes) -> Any:
            held = call(scopes)
            if held is CUT or (asks and (held is None or held is UNDEFINED)):
                return CUT
            return look(held, scopes)

        if asks or cuts:
            return _Piece(look_on, True)
        return _Piece(lambda scopes: look(call(scopes), scopes))

    def _look(self, part: Node, depth: int) -> Callable[[Any, Scopes], Any]:
        """The function that looks up a member, by a literal or a computed name."""
        if part.type not in ("number", "string", "property_identifier"):
            name = self.build(part, depth + 1).call
            place = self.last
            return lambda held, scopes: member_of(held, name(scopes), *place, scopes)
        key = self._key(part)
        index, (line, column) = index_of(key), self.last

        def look(held: Any, scopes: Scopes) -> Any:
            if type(held) is dict and key in held:
                return held[key]
            return member(held, key, index, line, column, scopes)

        return look

    def _key(self, part: Node) -> str:
        """The name of the member, if it is literal."""
        if part.type == "number":
            key = number_text(number(self.code, part))
        else:
            key = string(self.code, part) if part.type == "string" else self.code.of(part)
        if key in INHERITED or key in METHODS or "\\" in key or not key.isprintable():
            raise Beyond
        return key


MEMBERS = ("member_expression", "subscript_expression")
CONVERSIONS: dict[str, Callable[[Any, Scopes], Any]] = {
    "Number": numeric,
    "String": textual,
    "Boolean": lambda value, _scopes: truth(value),
}
"""Functions of the engine that are equivalent here."""
CONVERTED = ("identifier", *MEMBERS)
"""Their arguments."""
BEYOND = RESERVED | INHERITED | BUILT_IN
BRACKETS = "parenthesized_expression"
MAKERS: dict[str, Callable[[_Builder, Node, int], _Piece]] = {
    **dict.fromkeys(("number", "string", *WORDS, "array", "object"), _Builder.literal),
    "identifier": _Builder.name,
    "undefined": _Builder.name,
    BRACKETS: _Builder.brackets,
    "ternary_expression": _Builder.conditional,
    "binary_expression": _Builder.binary,
    "unary_expression": _Builder.unary,
    "call_expression": _Builder.conversion,
    "member_expression": _Builder.member,
    "subscript_expression": _Builder.member,
}
"""The builder for each type of node."""
