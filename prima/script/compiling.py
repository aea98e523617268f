"""Expressions that need no engine, written in Python: names, members, literals and operators.

Most expressions of documents are of this kind. Each is written as a Python expression of the scopes
that it sees (:func:`compiled`), or as a longer one that takes less time (:func:`quickly`).
Whatever could mean more (calls, functions, assignments, members that prototypes have) is beyond it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from prima.script.ecmascript import CONSTANTS, HELPERS, Scopes, index_of, number_text
from prima.script.globals import GLOBALS, RESERVED

Function = Callable[[Scopes], Any]
Where = Callable[[str], tuple[str, ...]]


@dataclass(slots=True)
class Compiled:
    """An expression as Python, and the names that it uses with where each first stands."""

    source: str
    """A Python expression of ``scopes``, and of document, dialog and local among them."""
    kind: str
    """``number``, ``boolean`` or ``text`` where its value can be nothing else."""
    names: Mapping[str, int]
    pieces: int
    """Of how many pieces of code it was made."""


MOST_TOKENS = 200
"""Pieces of code beyond which an expression is left to the engine: brackets nest so deep."""
DEEPEST = 100
"""Brackets and operators before an operand that may stand inside each other."""
DEEP, DEEPEST_BRACKETS = 60, 180
"""Brackets in Python inside each other: from the one on fewer are written, the other is too many."""
MOST_CODE = 1_000
"""Characters that code compiled here may have."""
AS_LONG = 200
"""Characters of kept code that is beyond all this which count for one piece more."""
VARIABLES = frozenset(
    ["event", "_event", "_message", "session", "application", "document", "dialog", "sensor"]
)
"""Variables that the language itself declares."""
MOST_KEPT = 100_000
"""Pieces of code of all expressions that are kept compiled; each is some hundred bytes then."""
WORDS = {"true": True, "false": False, "null": None}
INHERITED = frozenset(
    [
        *(
            "constructor",
            "toString",
            "toLocaleString",
            "valueOf",
            "hasOwnProperty",
            "isPrototypeOf",
        ),
        *("propertyIsEnumerable", "__proto__", "__defineGetter__", "__defineSetter__"),
        *("__lookupGetter__", "__lookupSetter__"),
    ]
)
"""Names that every object has from its prototype, scopes included."""
METHODS = frozenset(
    [
        *("at", "concat", "copyWithin", "fill", "find", "findIndex", "findLast", "findLastIndex"),
        *("lastIndexOf", "pop", "push", "reverse", "shift", "unshift", "slice", "sort", "splice"),
        *("includes", "indexOf", "join", "keys", "entries", "values", "forEach", "filter", "flat"),
        *("flatMap", "map", "every", "some", "reduce", "reduceRight", "toReversed", "toSorted"),
        *("toSpliced", "with", "charCodeAt", "charAt", "codePointAt", "endsWith", "isWellFormed"),
        *("toWellFormed", "localeCompare", "match", "matchAll", "normalize", "padEnd", "padStart"),
        *(
            "repeat",
            "replace",
            "replaceAll",
            "search",
            "split",
            "startsWith",
            "substr",
            "substring",
        ),
        *(
            "toLowerCase",
            "toLocaleLowerCase",
            "toUpperCase",
            "toLocaleUpperCase",
            "trim",
            "trimEnd",
        ),
        *("trimStart", "trimLeft", "trimRight", "anchor", "big", "blink", "bold", "fixed"),
        *("fontcolor", "fontsize", "italics", "link", "small", "strike", "sub", "sup"),
        *("toExponential", "toFixed", "toPrecision"),
    ]
)
"""Members that texts, numbers and arrays have from theirs."""
BUILT_IN = (GLOBALS - VARIABLES - CONSTANTS.keys()) | {
    *("AsyncDisposableStack", "DisposableStack", "InternalError", "SuppressedError"),
    *("atob", "btoa"),
}
"""Names of the engine's own."""
ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "b": "\b", "f": "\f", "v": "\v"}
DIGITS = frozenset("0123456789")
LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_$")
WORD = LETTERS | DIGITS
NUMBER = re.compile(
    r"(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![\w$.])", re.ASCII
)
ESCAPED = re.compile(r"""(["'])(?:\\[^ux0-9\n\r\u2028\u2029]|(?!\1)[^\\\n\r])*\1""", re.ASCII)
"""A text in which characters are escaped by what stands for themselves, or for white space."""
LONG_MARKS = ("===", "!==", "==", "!=", "<=", ">=", "&&", "||")
MARKS = {
    "+": "+=", "-": "-=", "*": "*=", "/": "/*=", "%": "=", "<": "<>", ">": "<>", "?": "?.",
    ".": ".0123456789", **dict.fromkeys("!:,()[]{}", ""),
}  # fmt: skip
"""Marks of one character, and what would make something else of it."""


def anywhere(_name: str) -> tuple[str, ...]:
    """The scopes in which most variables stand, of whatever document."""
    return ("document", "dialog", "local")


class _Beyond(Exception):
    """The code is none of what is compiled here."""


@dataclass(slots=True)
class _Token:
    kind: str
    text: str
    start: int


END = _Token("end", "", -1)


def _tokens(code: str) -> list[_Token]:
    """The names, literals and marks of which code consists.

    It goes by characters: to make one pattern of all this takes longer than most commands have.

    Raises:
        _Beyond: there is something else in it, or too much.
    """
    found: list[_Token] = []
    at, size = 0, len(code)
    while at < size:
        if len(found) > MOST_TOKENS:
            raise _Beyond
        first, end = code[at], at + 1
        if first in " \t\n\r":
            at = end
            continue
        if first in LETTERS:
            kind = "name"
            while end < size and code[end] in WORD:
                end += 1
        elif first in DIGITS or (first == "." and code[end : end + 1] in DIGITS):
            kind = "number"
            end = _number_end(code, at)
        elif first in "\"'":
            kind, end = _text_end(code, at)
        else:
            kind = "mark"
            end += len(_mark(code, at)) - 1
        found.append(_Token(kind, code[at:end], at))
        at = end
    found.append(END)
    return found


def _number_end(code: str, at: int) -> int:
    end = at
    while code[end : end + 1] in DIGITS:
        end += 1
    simple = end == at + 1 or (end > at and code[at] != "0")
    if simple and code[end : end + 1] not in WORD and code[end : end + 1] != ".":
        return end
    match = NUMBER.match(code, at)
    if match is None:
        raise _Beyond
    return int(match.end())


def _text_end(code: str, at: int) -> tuple[str, int]:
    end = code.find(code[at], at + 1) + 1
    if end and not {"\\", "\n", "\r"}.intersection(code[at:end]):
        return "text", end
    match = ESCAPED.match(code, at)
    if match is None:
        raise _Beyond
    return "escaped", int(match.end())


def _mark(code: str, at: int) -> str:
    for mark in LONG_MARKS:
        if code.startswith(mark, at):
            return mark
    first, after = code[at], code[at + 1 : at + 2]
    if first == "?" and after == "." and code[at + 2 : at + 3] not in DIGITS:
        return "?."
    spoilers = MARKS.get(first)
    if spoilers is None or (after and after in spoilers):
        raise _Beyond
    return first


LEVELS: dict[str, int] = {
    "||": 1, "&&": 2, "==": 3, "!=": 3, "===": 3, "!==": 3, "<": 4, ">": 4, "<=": 4, ">=": 4,
    "+": 5, "-": 5, "*": 6, "/": 6, "%": 6,
}  # fmt: skip
"""How strongly operators bind."""
EQUALITIES = {
    "===": ("identical", ""), "!==": ("identical", "not "), "==": ("equal", ""), "!=": ("equal", "not "),
}  # fmt: skip
"""What compares two values in Python, and what stands before it."""
OPERATIONS = {
    "<": ("less", "boolean"), ">": ("more", "boolean"), "<=": ("at_most", "boolean"),
    ">=": ("at_least", "boolean"), "+": ("add", ""), "-": ("subtract", "number"),
    "*": ("multiply", "number"), "/": ("divided", "number"), "%": ("remaining", "number"),
}  # fmt: skip
"""What calculates with two values in Python, and what kind of value it gives."""
PYTHON = {"number": "float", "text": "str"}
"""Of which type a value is in Python."""


def compiled(code: str) -> Compiled | None:
    """An expression as a function of the scopes it sees, or None if it needs an engine."""
    if len(code) > MOST_CODE:
        return None
    if code not in KEPT:
        found = _compile(code)
        _Kept.pieces += found.pieces if found else 1 + len(code) // AS_LONG
        if _Kept.pieces > MOST_KEPT:
            _Kept.pieces = 0
            KEPT.clear()
            FUNCTIONS.clear()
        KEPT[code] = found
        return found
    return KEPT[code]


KEPT: dict[str, Compiled | None] = {}
"""What has been compiled lately, by its code."""
FUNCTIONS: dict[str, Function] = {}
"""What has been evaluated lately, by its code."""


class _Kept:
    pieces = 0
    """Of all that is kept."""


def quickly(code: str, scopes: str, where: Where) -> Compiled | None:
    """An expression as Python that takes longer to be compiled, and less long to be evaluated.

    ``scopes`` is what the tuple of all scopes is in Python where the expression will stand, and
    ``where`` gives the scopes that may have a variable of a name, outermost first.
    """
    return _compile(code, scopes, where)


def _compile(code: str, scopes: str = "scopes", where: Where | None = None) -> Compiled | None:
    try:
        parser = _Parser(code, scopes, where)
        found = parser.conditional()
        parser.expect("")
    except _Beyond:
        return None
    return Compiled(found.source, found.kind, parser.names, len(parser.tokens))


def function_of(source: str) -> Function:
    """The function of the scopes that an expression's source is the value of."""
    held: dict[str, Any] = {}
    head = "def call(scopes):\n _, document, dialog, local = scopes\n return "
    exec(head + source, HELPERS, held)
    return held["call"]  # type: ignore[no-any-return]


@dataclass(slots=True)
class _Piece:
    """Part of an expression in Python."""

    source: str
    kind: str = ""
    """``number``, ``boolean`` or ``text`` where its value can be nothing else."""
    depth: int = 0
    """How deep brackets stand inside each other."""
    literal: bool = False
    place: str = ""
    """Line and column, as two arguments, of the last operator or name in it: an error of a member
    of it is told there, as the engine tells it."""


def _joined(kind: str, *parts: str | _Piece) -> _Piece:
    """A piece made of code and other pieces.

    Raises:
        _Beyond: more brackets stand inside each other than Python reads.
    """
    source, opened, depth = [], 0, 0
    for part in parts:
        if isinstance(part, str):
            source.append(part)
            opened += part.count("(") - part.count(")")
        else:
            source.append(part.source)
        depth = max(depth, opened + (part.depth if isinstance(part, _Piece) else 0))
    if depth > DEEPEST_BRACKETS:
        raise _Beyond
    places = [part.place for part in parts if isinstance(part, _Piece) and part.place]
    place = places[-1] if places else ""
    return _Piece("".join(source), kind, depth, False, place)


class _Parser:
    """Reads an expression by the strength of its operators, and writes it in Python.

    Nothing of the code gets there but by ``repr``: names, texts and numbers.
    """

    def __init__(self, code: str, scopes: str = "scopes", where: Where | None = None) -> None:
        self.code = code
        self.scopes = f", {scopes}"
        """The last argument of what an expression calls."""
        self.where = where
        self.quick = where is not None
        """Whether it is worth more Python that takes less time."""
        self.names: dict[str, int] = {}
        self.tokens = _tokens(code)
        self.at = self.depth = self.held = 0

    def take(self) -> _Token:
        """The next piece."""
        token = self.tokens[self.at]
        self.at += token is not END
        return token

    def comes(self, text: str) -> bool:
        """Take a mark if it comes next."""
        token = self.tokens[self.at]
        if token.kind == "mark" and token.text == text:
            self.at += 1
            return True
        return False

    def expect(self, text: str) -> None:
        """Take a mark, or with none see that the code is over."""
        token = self.take()
        if token.text != text or token.kind not in ("mark", "end"):
            raise _Beyond

    def place(self, start: int) -> str:
        """Line and column of a piece of the code, as two arguments."""
        before = self.code[:start]
        line_start = before.rfind("\n")
        return f"{before.count(chr(10)) + 1}, {start - line_start}"

    def holder(self) -> str:
        """A variable of the function, for a value that is looked at more than once."""
        self.held += 1
        return f"v{self.held}"

    def conditional(self) -> _Piece:
        """``a ? b : c``, and what binds more strongly."""
        test = self.binary(1)
        if not self.comes("?"):
            return test
        first = self.conditional()
        self.expect(":")
        second = self.conditional()
        kind = first.kind if first.kind == second.kind else ""
        made = _joined(kind, "(", first, " if ", _truth(test), " else ", second, ")")
        made.place = second.place or first.place or test.place
        return made

    def binary(self, level: int) -> _Piece:
        """Operators of a level or above, those of one level from the left."""
        left = self.unary()
        while True:
            token = self.tokens[self.at]
            strength = LEVELS.get(token.text, 0) if token.kind == "mark" else 0
            if strength < level:
                return left
            self.at += 1
            right = self.binary(strength + 1)
            if token.text in ("&&", "||"):
                left = self.logical(token.text, left, right)
            else:
                equal = token.text in EQUALITIES
                left = (self.equality if equal else self.operation)(token.text, left, right)
                left.place = self.place(token.start)

    def logical(self, mark: str, left: _Piece, right: _Piece) -> _Piece:
        """``a && b`` or ``a || b``: one of the two values."""
        kind = left.kind if left.kind == right.kind else ""
        if left.kind == "boolean":
            return _joined(kind, "(", left, " and " if mark == "&&" else " or ", right, ")")
        held = self.holder()
        if mark == "&&":
            made = _joined(kind, "(", right, f" if truth({held} := ", left, f") else {held})")
        else:
            made = _joined(kind, f"({held} if truth({held} := ", left, ") else ", right, ")")
        made.place = right.place or left.place
        return made

    def equality(self, mark: str, left: _Piece, right: _Piece) -> _Piece:
        """``a == b`` and the like; a text or number that is written out is compared at once."""
        name, no = EQUALITIES[mark]
        plain = PYTHON.get(right.kind) if right.literal else None
        if plain is None or not self.quick or left.depth > DEEP:
            return _joined("boolean", f"({no}{name}(", left, ", ", right, f"{self.scopes}))")
        held = self.holder()
        return _joined(
            "boolean",
            *(f"({no}({held} == ", right, f" if type({held} := ", left, f") is {plain}"),
            *(f" else {name}({held}, ", right, f"{self.scopes})))"),
        )

    def operation(self, mark: str, left: _Piece, right: _Piece) -> _Piece:
        """What is calculated or compared; with numbers, as mostly, at once."""
        name, kind = OPERATIONS[mark]
        kinds = left.kind, right.kind
        if kinds == ("number", "number") and mark not in "/%":
            return _joined(kind or "number", "(", left, f" {mark} ", right, ")")
        known = "text" in kinds or "boolean" in kinds or mark in "/%"
        if known or not self.quick or max(left.depth, right.depth) > DEEP:
            return _joined(kind, f"{name}(", left, ", ", right, f"{self.scopes})")
        first = self.holder()
        if right.literal:
            return _joined(
                kind,
                *(f"({first} {mark} ", right, f" if type({first} := ", left, ") is float"),
                *(f" else {name}({first}, ", right, f"{self.scopes}))"),
            )
        second = self.holder()
        return _joined(
            kind,
            *(f"({first} {mark} {second} if (type({first} := ", left, ") is float)"),
            *(f" & (type({second} := ", right, ") is float)"),
            f" else {name}({first}, {second}{self.scopes}))",
        )

    def unary(self) -> _Piece:
        """``!a``, ``-a``, ``+a``, ``typeof a``, and what binds more strongly."""
        self.depth += 1
        if self.depth > DEEPEST:
            raise _Beyond
        found = self.operand()
        self.depth -= 1
        return found

    def operand(self) -> _Piece:
        """What an operator before it, if any, makes of a member."""
        token = self.tokens[self.at]
        if token.kind == "mark" and token.text in "!-+":
            self.at += 1
            inner = self.unary()
            if token.text == "!":
                return _joined("boolean", "(not ", _truth(inner), ")")
            if inner.kind != "number":
                inner = _joined("number", "numeric(", inner, f"{self.scopes})")
            if token.text == "-":
                negative = _joined("number", "(-", inner, ")")
                negative.literal = inner.literal
                return negative
            return inner
        if token.kind == "name" and token.text == "typeof":
            self.at += 1
            return self.type_of()
        return self.member()

    def type_of(self) -> _Piece:
        """``typeof a``; a name that nothing declares is no error here."""
        start = self.at
        inner = self.unary()
        read = [token for token in self.tokens[start : self.at] if token.text not in "()"]
        if len(read) > 1 or read[0].kind != "name" or read[0].text in WORDS:
            return _joined("text", "kind_of(", inner, ")")
        return _Piece(f"kind_of(found({read[0].text!r}{self.scopes}))", "text", 3)

    def member(self) -> _Piece:
        """``a.b``, ``a["b"]`` and ``a?.b``; which member it is must be written out."""
        start = self.place(self.tokens[self.at].start)
        value = self.primary()
        found = self.chain(value, value.place or start)
        found.place = value.place
        return found

    def chain(self, value: _Piece, start: str) -> _Piece:
        """Members of members of a value; ``?.`` ends the chain where there is no value."""
        while True:
            if self.comes("?."):
                held = self.holder()
                bracket = self.comes("[")
                rest = self.chain(self.one(_Piece(held), start, bracket), start)
                absent = f") is None or {held} is undefined else "
                return _joined("", f"(undefined if ({held} := ", value, absent, rest, ")")
            bracket = self.comes("[")
            if not bracket and not self.comes("."):
                return value
            value = self.one(value, start, bracket)

    def one(self, value: _Piece, start: str, bracket: bool) -> _Piece:
        """The member of a value whose name comes next, perhaps in brackets."""
        token = self.take()
        if bracket and token.kind in ("number", "text"):
            self.expect("]")
            number = token.kind == "number"
            key = number_text(float(token.text)) if number else token.text[1:-1]
        elif not bracket and token.kind == "name":
            key = token.text
        else:
            raise _Beyond
        return self.part(value, key, start)

    def part(self, value: _Piece, key: str, start: str) -> _Piece:
        """A member of a value, which mostly is an object that has it."""
        if key in INHERITED or key in METHODS:
            raise _Beyond
        held, name = self.holder(), _Piece(repr(key))
        more = f", {index_of(key)}, {start}{self.scopes})"
        if not self.quick or value.depth > DEEP:
            return _joined("", "member(", value, ", ", name, more)
        return _joined(
            "",
            *(f"({held}[", name, f"] if type({held} := ", value, ") is dict and ", name),
            *(f" in {held} else member({held}, ", name, f"{more})"),
        )

    def primary(self) -> _Piece:
        """A literal, a name, or an expression in brackets."""
        token = self.take()
        match token.kind:
            case "number":
                return _Piece(_number_source(float(token.text)), "number", literal=True)
            case "text":
                return _Piece(repr(token.text[1:-1]), "text", literal=True)
            case "escaped":
                unescape = lambda match: ESCAPES.get(match[1], match[1])  # noqa: E731
                value = re.sub(r"\\(.)", unescape, token.text[1:-1])
                return _Piece(repr(value), "text", literal=True)
            case "name":
                return self.name(token)
        if token.text == "(":
            inner = self.conditional()
            self.expect(")")
            return inner
        if token.text == "[":
            return self.array()
        if token.text == "{":
            return self.object()
        raise _Beyond

    def name(self, token: _Token) -> _Piece:
        """A variable or a word that stands for a value."""
        name = token.text
        if name in WORDS:
            return _Piece(repr(WORDS[name]), "" if name == "null" else "boolean")
        if name in RESERVED or name in INHERITED or name in BUILT_IN:
            raise _Beyond
        if name not in CONSTANTS and name not in VARIABLES:
            self.names.setdefault(name, token.start)
        place = self.place(token.start)
        where = f"sought({name!r}, {place}{self.scopes})"
        if self.where is None:
            return _Piece(where, "", 2, False, place)
        for scope in self.where(name):
            where = f"{scope}[{name!r}] if {name!r} in {scope} else {where}"
        return _Piece(f"({where})", "", 3, False, place)

    def literal(self) -> str:
        """A number, text or word in an array or object: nothing that is computed."""
        token = self.take()
        sign = token.text == "-" and token.kind == "mark"
        token = self.take() if sign else token
        if token.kind == "number":
            return "-" * sign + _number_source(float(token.text))
        if sign or token.kind not in ("text", "name"):
            raise _Beyond
        if token.kind == "text":
            return repr(token.text[1:-1])
        if token.text not in WORDS:
            raise _Beyond
        return repr(WORDS[token.text])

    def array(self) -> _Piece:
        """An array of literals: a new one at every evaluation."""
        values: list[str] = []
        while not self.comes("]"):
            values.append(self.literal())
            if not self.comes(","):
                self.expect("]")
                break
        return _Piece(f"[{', '.join(values)}]", "", 1)

    def object(self) -> _Piece:
        """An object of literals: a new one at every evaluation."""
        values: list[str] = []
        while not self.comes("}"):
            token = self.take()
            key = token.text[1:-1] if token.kind == "text" else token.text
            if token.kind not in ("text", "name") or key.isdigit() or key == "__proto__":
                raise _Beyond
            self.expect(":")
            values.append(f"{key!r}: {self.literal()}")
            if not self.comes(","):
                self.expect("}")
                break
        return _Piece(f"{{{', '.join(values)}}}", "", 1)


def _truth(piece: _Piece) -> _Piece:
    """A piece as a condition."""
    return piece if piece.kind == "boolean" else _joined("boolean", "truth(", piece, ")")


def _number_source(value: float) -> str:
    return repr(value) if value < math.inf else "infinity"
