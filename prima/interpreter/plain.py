"""Expressions that need no engine: names, members, literals and operators, as functions.

Most expressions of documents are of this kind, and an application that has no others
(:func:`is_plain`) is evaluated here: each expression is written once in Python, as a
function of the scopes that it sees, and the values are Python's: ``float``, ``str``, ``bool``, ``None``
(null), :data:`UNDEFINED`, ``list`` and ``dict``. They mean what ECMAScript 2024 says of them.
Whatever could mean more (calls, functions, assignments, members that prototypes have) is
beyond it, and its whole application runs in an :class:`~prima.interpreter.expressions.Engine`.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from prima.deferred import dataclass, pattern
from prima.interpreter.elements import Document
from prima.interpreter.evaluation import (
    LARGEST,
    MAX_SCRIPT_SECONDS,
    SCOPES,
    ScriptError,
    bounded,
    plain_number,
    whole,
)
from prima.interpreter.names import GLOBALS, RESERVED

if TYPE_CHECKING:
    from prima.messages import Json


class Undefined:
    """The type of :data:`UNDEFINED`."""

    def __repr__(self) -> str:
        return "undefined"


UNDEFINED = Undefined()
"""What a variable without a value has."""


class Scope(dict[str, Any]):
    """The variables of an application, document, dialog or piece of content."""

    __slots__ = ("__weakref__",)


class Named(Scope):
    """A scope that its own expressions know by name: ``application``, ``document``, ``dialog``."""

    __slots__ = ("evaluator",)
    evaluator: PlainEngine
    """Who counts the work, in an application's scope."""


Scopes = tuple[Scope, Scope, Scope, Scope]
"""The scopes that an expression sees: application, document, dialog and local."""
Function = Callable[[Scopes], Any]
Where = Callable[[str], tuple[str, ...]]
Operation = Callable[[Any, Any, Scopes], Any]


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
LONGEST = 100_000
"""Characters that a text may have; nothing longer could leave the scopes."""
MOST_HELD = 4_000_000
"""Characters of long texts that all variables of an application may have together."""
LONG = 1_000
"""Characters from which on a text counts as long."""
SHORT = 200
"""Characters up to which a text is no work worth counting."""
SECONDS = 4e-9
"""What a character takes at most to be compared, joined or read."""
COUNTED = 10
"""As many characters is the work of counting a variable."""

VARIABLES = frozenset(
    ["event", "_event", "_message", "session", "application", "document", "dialog", "sensor"]
)
"""Variables that the language itself declares."""
MOST_KEPT = 100_000
"""Pieces of code of all expressions that are kept compiled; each is some hundred bytes then."""
MOST_PIECES = 50_000
"""Pieces of code that a document may have to be evaluated here."""
SELDOM = 30
"""Evaluations after which an expression is compiled to what takes less time."""
WORDS = {"true": True, "false": False, "null": None}
CONSTANTS = {"undefined": UNDEFINED, "NaN": math.nan, "Infinity": math.inf}
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
SPACE = " \t\n\v\f\r\xa0\ufeff\u1680\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u2028\u2029\u202f\u205f\u3000"
"""What ECMAScript takes for white space."""
TOKEN = pattern(
    r"""(?P<space>[ \t\n\r]+)"""
    r"""|(?P<number>(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![\w$.]))"""
    r"""|(?P<name>[A-Za-z_$][\w$]*)|(?P<text>"[^"\\\n\r]*"|'[^'\\\n\r]*')"""
    r"""|(?P<escaped>"(?:\\[^ux0-9\n\r\u2028\u2029]|[^"\\\n\r])*"|'(?:\\[^ux0-9\n\r\u2028\u2029]|[^'\\\n\r])*')"""
    r"""|(?P<mark>[=!]==?|[<>]=|&&|\|\||\+(?![+=])|-(?![-=])|\*(?![*=])|/(?![/*=])|%(?!=)|[<>](?![<>])"""
    r"""|\?\.(?![0-9])|\?(?![?.])|\.(?![.0-9])|[!:,()\[\]{}])""",
    re.ASCII,
)
NUMERIC = pattern(
    r"[+-]?(?:Infinity|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)|0[xX][0-9a-fA-F]+|0[oO][0-7]+|0[bB][01]+"
)
INDEX = pattern("0|[1-9][0-9]{0,9}")
MOST_INDEX = 2**32 - 2
SURROGATE = pattern("[\ud800-\udfff]")


def is_plain(document: Document) -> bool:
    """Whether all the code of a document can be evaluated here."""
    if document.plain is None:
        document.plain = not document.scripted and _are_plain(
            {one.code: None for one in document.expressions}
        )
    return document.plain


def _are_plain(codes: Iterable[str]) -> bool:
    pieces = 0
    for code in codes:
        found = compiled(code)
        pieces += found.pieces if found else 0
        if found is None or pieces > MOST_PIECES:
            return False
    return True


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
MISSING = object()
"""Stands for the value of what nothing declares."""


def compiled(code: str) -> Compiled | None:
    """An expression as a function of the scopes it sees, or None if it needs an engine."""
    if len(code) > LONG:
        return None
    if code not in KEPT:
        found = _compile(code)
        _Kept.pieces += found.pieces if found else 1 + len(code) // SHORT
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
        self.tokens: list[_Token] = []
        position = 0
        while position < len(code):
            match = TOKEN.match(code, position)
            if match is None or len(self.tokens) > MOST_TOKENS:
                raise _Beyond
            position = match.end()
            if match.lastgroup != "space":
                self.tokens.append(_Token(match.lastgroup or "", match[0], match.start()))
        self.tokens.append(END)
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


# What an expression in Python calls --------------------------------------------------------


def sought(name: str, line: int, column: int, scopes: Scopes) -> Any:
    """A variable that stands in none of the scopes in which most stand.

    Raises:
        ScriptError: nothing declares it.
    """
    value = found(name, scopes, MISSING)
    if value is MISSING:
        raise ScriptError(f"ReferenceError: {name} is not defined", [(line, column)])
    return value


def found(name: str, scopes: Scopes, otherwise: Any = UNDEFINED) -> Any:
    """A variable's value, or what stands for one that nothing declares."""
    for scope in reversed(scopes):
        if name in scope:
            return scope[name]
    if name in CONSTANTS:
        return CONSTANTS[name]
    if name in SCOPES and isinstance(scope := scopes[SCOPES.index(name)], Named):
        return scope
    return otherwise


def holder_of(name: str, scopes: Scopes) -> Scope:
    """The innermost scope that has a variable, by its name as written.

    Raises:
        ScriptError: no scope declares it.
    """
    inner, _, last = name.rpartition(".")
    for scope in (scopes[SCOPES.index(inner)],) if inner else reversed(scopes):
        if last in scope:
            return scope
    raise ScriptError(f'ReferenceError: the variable "{name}" is not declared')


def member(value: Any, key: str, index: int, line: int, column: int, scopes: Scopes) -> Any:
    """A member of a value, by its name and the index that the name is."""
    if isinstance(value, dict):
        return value.get(key, UNDEFINED)
    if value is None or value is UNDEFINED:
        what = "null" if value is None else "undefined"
        message = f"TypeError: cannot read property '{key}' of {what}"
        raise ScriptError(message, [(line, column)])
    if not isinstance(value, list | str):
        return UNDEFINED
    if len(value) > SHORT and isinstance(value, str):
        work(scopes, value)
    if key == "length":
        return float(len(value) if isinstance(value, list) else units(value))
    if isinstance(value, str):
        return unit(value, index)
    return value[index] if 0 <= index < len(value) else UNDEFINED


def work(scopes: Scopes, value: Any) -> None:
    """Count the work with a value that may be long.

    Raises:
        ScriptError: the application has taken too long in this instant.
    """
    if isinstance(value, str | list) and len(value) > SHORT:
        evaluator = getattr(scopes[0], "evaluator", None)
        if evaluator is not None:
            evaluator.work(len(value))


def equal(first: Any, second: Any, scopes: Scopes) -> bool:
    """``==``, with the work counted."""
    work(scopes, first)
    work(scopes, second)
    return alike(first, second)


def identical(first: Any, second: Any, scopes: Scopes) -> bool:
    """``===``, with the work counted."""
    work(scopes, first)
    work(scopes, second)
    return same(first, second)


def numeric(value: Any, scopes: Scopes) -> float:
    """A value as a number, with the work counted."""
    if type(value) is float:
        return value
    work(scopes, value)
    return number(value)


def add(first: Any, second: Any, scopes: Scopes) -> Any:
    """``+``, which joins texts as well."""
    first, second = primitive(first), primitive(second)
    if not isinstance(first, str) and not isinstance(second, str):
        return number(first) + number(second)
    joined = text(first) + text(second)
    if len(joined) > SHORT:
        if len(joined) > LONGEST:
            raise ScriptError("it used too much memory")
        work(scopes, joined)
    return joined


def _arithmetic(act: Callable[[float, float], float]) -> Operation:
    def calculate(first: Any, second: Any, scopes: Scopes) -> float:
        return act(numeric(first, scopes), numeric(second, scopes))

    return calculate


def _comparison(act: Callable[[Any, Any], bool]) -> Operation:
    def compare(first: Any, second: Any, scopes: Scopes) -> bool:
        first, second = primitive(first), primitive(second)
        if isinstance(first, str) and isinstance(second, str):
            if first.isascii() and second.isascii():
                return act(first, second)
            work(scopes, first)
            work(scopes, second)
            return act(order(first), order(second))
        return act(numeric(first, scopes), numeric(second, scopes))

    return compare


def divide(first: float, second: float) -> float:
    """Division, which has a value by nought as well."""
    if second:
        return first / second
    if first == 0 or first != first or second != second:
        return math.nan
    return math.copysign(math.inf, first) * math.copysign(1, second)


def remainder(first: float, second: float) -> float:
    """The remainder, with the sign of what is divided."""
    if second == 0 or math.isinf(first):
        return math.nan
    return math.fmod(first, second)


# Values (ECMAScript 2024, chapter 7) --------------------------------------------------------


def truth(value: Any) -> bool:
    """A value as a condition (7.1.2)."""
    if value is True or value is False:
        return bool(value)
    if isinstance(value, list | dict):
        return True
    return value is not UNDEFINED and bool(value) and value == value


def primitive(value: Any) -> Any:
    """An array or object as the text that it is where a plain value is needed (7.1.1)."""
    return text(value) if isinstance(value, list | dict) else value


def number(value: Any) -> float:
    """A value as a number (7.1.4)."""
    if isinstance(value, float):
        return value
    if value is None or isinstance(value, bool):
        return float(value or 0)
    if value is UNDEFINED:
        return math.nan
    code = text(value).strip(SPACE)
    if not code:
        return 0.0
    if NUMERIC.fullmatch(code) is None:
        return math.nan
    return whole(int(code, 0)) if code[1:2] in tuple("xXoObB") else float(code)


def text(value: Any) -> str:
    """A value as text (7.1.17)."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return number_text(value)
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, list):
        return ",".join("" if one is None or one is UNDEFINED else text(one) for one in value)
    if isinstance(value, dict):
        if "toString" in value:  # it is no function
            raise ScriptError("TypeError: toPrimitive")
        return "[object Object]"
    return "undefined"


def number_text(value: float) -> str:
    """A number as text (6.1.6.1.20)."""
    if value != value or math.isinf(value):
        return "NaN" if value != value else "Infinity" if value > 0 else "-Infinity"
    if value == int(value) and abs(value) < LARGEST:
        return str(int(value))
    found, _, exponent = repr(value).partition("e")
    power = int(exponent or 0)
    sign, digits = ("-", found[1:]) if found[0] == "-" else ("", found)
    if -7 < power < 0:
        return f"{sign}0.{'0' * (-power - 1)}{digits.replace('.', '')}"
    if 0 < power < 21:
        return sign + digits.replace(".", "").ljust(power + 1, "0")
    return f"{sign}{digits}e{power:+d}" if exponent else sign + digits.removesuffix(".0")


def kind_of(value: Any) -> str:
    """What ``typeof`` says of a value."""
    if isinstance(value, bool):
        return "boolean"
    if isinstance(value, float | str):
        return "number" if isinstance(value, float) else "string"
    return "undefined" if value is UNDEFINED else "object"


def same(first: Any, second: Any) -> bool:
    """``===`` (7.2.14)."""
    if type(first) is not type(second):
        return False
    return first is second if isinstance(first, list | dict) else bool(first == second)


def alike(first: Any, second: Any) -> bool:
    """``==`` (7.2.13)."""
    if type(first) is type(second):
        return same(first, second)
    absent = (None, UNDEFINED)
    if first in absent or second in absent:
        return first in absent and second in absent
    if isinstance(first, list | dict) and isinstance(second, list | dict):
        return first is second
    first, second = primitive(first), primitive(second)
    if isinstance(first, str) and isinstance(second, str):
        return first == second
    return number(first) == number(second)


def index_of(key: str) -> int:
    """The index that a member's name is (6.1.7), or -1."""
    return index if INDEX.fullmatch(key) and (index := int(key)) <= MOST_INDEX else -1


def unit(value: str, index: int) -> Any:
    """One of the 16 bits that a text is made of for ECMAScript."""
    if value.isascii():
        return value[index] if 0 <= index < len(value) else UNDEFINED
    found = value.encode("utf-16-be", "surrogatepass")[max(2 * index, 0) : 2 * index + 2]
    return found.decode("utf-16-be", "surrogatepass") if found else UNDEFINED


def units(value: str) -> int:
    """How long ECMAScript takes a text for."""
    return len(value) if value.isascii() else len(value.encode("utf-16-le", "surrogatepass")) // 2


def order(value: str) -> str | bytes:
    """What texts are compared by."""
    return value.encode("utf-16-be", "surrogatepass")


def well_formed(value: str) -> str:
    """Text in which halves of letters are whole again, or replaced."""
    if SURROGATE.search(value) is None:
        return value
    return value.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def escaped(value: str) -> str:
    """Text in which halves of letters are whole again, or written as JSON escapes."""
    if SURROGATE.search(value) is None:
        return value
    value = value.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")
    return SURROGATE.sub(lambda found: f"\\u{ord(found[0]):04x}", value)


def stringify(value: Any, around: tuple[int, ...] = ()) -> str:
    """A value as JSON (25.5.2); what it cannot have is left out, or null.

    Raises:
        ScriptError: something holds itself, as a scope does.
    """
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, float) and not math.isfinite(value):
        return "null"
    if not isinstance(value, list | dict):
        return "null" if value is UNDEFINED else text(value)
    if id(value) in around or isinstance(value, Named):
        raise ScriptError("TypeError: circular reference")
    around = (*around, id(value))
    if isinstance(value, list):
        return f"[{','.join(stringify(one, around) for one in value)}]"
    pairs = [
        f"{_quoted(key)}:{stringify(one, around)}"
        for key, one in sorted(value.items(), key=_position)
        if one is not UNDEFINED
    ]
    return f"{{{','.join(pairs)}}}"


def _quoted(value: str) -> str:
    """A text as JSON, which few documents need."""
    from json import dumps

    return dumps(value, ensure_ascii=False)


def _position(pair: tuple[str, Any]) -> tuple[bool, int]:
    """Names that are numbers stand before others, in their order (10.1.11.1)."""
    index = index_of(pair[0])
    return (index < 0, index)


def inward(value: Json, depth: int = 0) -> Any:
    """A value from outside as one of those here: a copy, in which numbers are ``float``.

    Raises:
        ScriptError: it has lists or objects too deep inside each other.
    """
    if isinstance(value, str):
        return value if type(value) is str else str.__str__(value)
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return whole(value) if isinstance(value, int) else float(value)
    if depth > DEEPEST:
        raise ScriptError("it is nested too deep")
    if isinstance(value, list | tuple):
        return [inward(one, depth + 1) for one in value]
    if isinstance(value, Mapping):
        return {str(key): inward(one, depth + 1) for key, one in value.items()}
    return value


def outward(value: Any) -> Json:
    """A value as plain data; undefined becomes None.

    Raises:
        ScriptError: it is too long, or holds itself.
    """
    if value is UNDEFINED:
        return None
    if isinstance(value, str):
        return bounded(well_formed(value))
    if isinstance(value, list | dict):
        from json import loads

        return loads(bounded(well_formed(stringify(value))))
    return plain_number(value)


HELPERS: dict[str, Any] = {
    "infinity": math.inf, "undefined": UNDEFINED, "sought": sought, "found": found, "member": member, "truth": truth,
    "kind_of": kind_of, "equal": equal, "identical": identical, "numeric": numeric, "add": add,
    "subtract": _arithmetic(operator.sub), "multiply": _arithmetic(operator.mul),
    "divided": _arithmetic(divide), "remaining": _arithmetic(remainder),
    "less": _comparison(operator.lt), "more": _comparison(operator.gt),
    "at_most": _comparison(operator.le), "at_least": _comparison(operator.ge),
}  # fmt: skip
"""What expressions in Python know."""


class PlainEngine:
    """What an :class:`~prima.interpreter.expressions.Engine` does, for applications without scripts."""

    nothing = Scope()
    """A scope in which nothing is declared."""

    def __init__(self) -> None:
        self.now = 0
        """The time by the run's calendar: nothing here asks for it."""
        self.spent = 0.0
        """Seconds of work with long texts, by their lengths: nothing else here takes long."""
        self._long: WeakValueDictionary[int, Scope] | None = None
        """Scopes in which a long text has been put, by their id()."""
        self._added = 0

    def _call(self, code: str) -> Function:
        found = compiled(code)
        if found is None:
            raise ScriptError(f"SyntaxError: {code} needs an engine")
        call = function_of(found.source)
        left = SELDOM

        def counted(scopes: Scopes) -> Any:
            nonlocal left
            left -= 1
            if left == 0:
                FUNCTIONS[code] = function_of((quickly(code, "scopes", anywhere) or found).source)
            return call(scopes)

        FUNCTIONS[code] = counted
        return counted

    def scope(self, **values: Json) -> Scope:
        """A new scope."""
        return Scope({name: inward(value) for name, value in values.items()})

    def named(self, name: str) -> Scope:
        """A new scope that its expressions know as ``application``, ``document`` or ``dialog``."""
        made = Named()
        if name == "application":
            made.evaluator = self
        return made

    def work(self, characters: int) -> None:
        """Count work with so many characters.

        Raises:
            ScriptError: it is too much for one instant.
        """
        self.spent += characters * SECONDS
        if self.spent > MAX_SCRIPT_SECONDS:
            raise ScriptError("it works too long on long texts")

    def event(self, name: str, message: str, data: Json) -> Scope:
        """The scope of an event's handler: ``event``, ``_event`` and ``_message``."""
        given = inward(data) if data else {}
        event = {"name": name, "message": message, "data": given}
        return Scope(event=event, _event=name, _message=message)

    def clock(self, scope: Scope, seconds: float) -> None:
        """Tell a scope the time of the run, as ``session.time``."""
        scope["session"] = {"time": float(seconds)}

    def set(self, scope: Scope, name: str, value: Json) -> None:
        """Give a variable of a scope a value from outside."""
        scope[name] = inward(value)

    def unset(self, scope: Scope, name: str) -> None:
        """Make a variable of a scope undefined."""
        scope[name] = UNDEFINED

    def has(self, scope: Scope, name: str) -> bool:
        """Whether a scope has a variable of that name."""
        return name in scope

    def defined(self, scope: Scope, name: str) -> bool:
        """Whether a variable of a scope has a value other than undefined."""
        return scope.get(name, UNDEFINED) is not UNDEFINED

    def condition(self, code: str, scopes: Scopes) -> bool:
        """Evaluate an expression as a condition."""
        return truth((FUNCTIONS.get(code) or self._call(code))(scopes))

    def text(self, code: str, scopes: Scopes) -> str:
        """Evaluate an expression and give its value as text for speech or a log."""
        value = (FUNCTIONS.get(code) or self._call(code))(scopes)
        if value is UNDEFINED:
            return "null"
        if isinstance(value, list | dict):
            return bounded(escaped(stringify(value)))
        return bounded(well_formed(text(value)))

    def value(self, code: str, scopes: Scopes) -> Json:
        """Evaluate an expression and give its value as plain data."""
        return outward((FUNCTIONS.get(code) or self._call(code))(scopes))

    def get(self, scope: Scope, name: str) -> Json:
        """A variable's value as plain data."""
        return outward(scope.get(name, UNDEFINED))

    def elements(self, code: str, scopes: Scopes, most: int) -> list[Any]:
        """Evaluate an expression that gives an array; its elements as they are here.

        Raises:
            ScriptError: it is no array.
        """
        array = (FUNCTIONS.get(code) or self._call(code))(scopes)
        if not isinstance(array, list):
            raise ScriptError(f"{code} is not an array")
        if len(array) > most:
            raise ScriptError(f"it has more than {most:,} elements")
        return array

    def assign(self, scope: Scope, name: str, code: str, scopes: Scopes) -> None:
        """Evaluate an expression and give its value to a variable of a scope."""
        self.put(scope, name, (FUNCTIONS.get(code) or self._call(code))(scopes))

    def assign_declared(self, name: str, code: str, scopes: Scopes) -> None:
        """Give a declared variable, by its name as written, a value (VoiceXML 5.3.2).

        Raises:
            ScriptError: no scope declares it, or the expression fails.
        """
        scope = holder_of(name, scopes)
        self.put(scope, name.rpartition(".")[2], (FUNCTIONS.get(code) or self._call(code))(scopes))

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """Give a variable one of the values that there are here.

        Raises:
            ScriptError: the variables would hold too much.
        """
        if type(value) is str and len(value) > LONG:
            self.hold(scope, value)
        scope[name] = value

    def hold(self, scope: Scope, value: str) -> None:
        """Bound what all variables hold together; it is counted anew only now and then."""
        if self._long is None:
            self._long = WeakValueDictionary()
        self._added += len(value)
        if self._added > MOST_HELD:
            held = {
                id(one): len(one)
                for kept in self._long.values()
                for one in kept.values()
                if isinstance(one, str)
            }
            self.work(COUNTED * len(held))
            held[id(value)] = len(value)
            self._added = sum(held.values())
            if self._added > MOST_HELD:
                raise ScriptError("it used too much memory")
        self._long[id(scope)] = scope
