"""Names that ECMAScript code uses and declares, as far as its text tells."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import islice
from types import MappingProxyType
from typing import Final

from prima.errors import MANY_WORDS

STRANGE: Final = "\u01c0"
"""A letter in all names that we put into the code of documents beside their own: few have one."""
RESERVED = frozenset(
    [
        "break",
        "case",
        "catch",
        "class",
        "const",
        "continue",
        "debugger",
        "default",
        "delete",
        "do",
        "else",
        "enum",
        "export",
        "extends",
        "false",
        "finally",
        "for",
        "function",
        "if",
        "import",
        "in",
        "instanceof",
        "new",
        "null",
        "return",
        "super",
        "switch",
        "this",
        "throw",
        "true",
        "try",
        "typeof",
        "var",
        "void",
        "while",
        "with",
        "let",
        "static",
        "yield",
        "await",
        "async",
        "of",
    ]
)
PASSED = r"""
    "(?:\\.|[^"\\])*" | '(?:\\.|[^'\\])*' | `(?:\\.|[^`\\])*`
    | //[^\n]* | /\*.*?(?:\*/|\Z)
    | (?:(?<=[=(,:;!&|?{}\[+\-*%<>~^])(?<!\+\+)(?<!--)|(?<![\w$.])(?:return|typeof|case)|\A)\s*
      /(?:\\[^\n]|\[(?:\\[^\n]|[^\]\\\n])*+\]?+|[^/\\\n\[])++(?:/\w*|(?=\n)|\Z)
    | \\."""
"""Strings, templates, comments and regular expressions of a script, in which names and brackets mean
nothing; a verbose pattern."""
HANDLED = frozenset(["event", "_event", "_message"])
"""Variables that tell a handler of its event."""
GLOBALS = frozenset(
    [
        "undefined",
        "NaN",
        "Infinity",
        "Object",
        "Array",
        "String",
        "Number",
        "Boolean",
        "Math",
        "Date",
        "JSON",
        "RegExp",
        "Error",
        "TypeError",
        "RangeError",
        "Map",
        "Set",
        "Symbol",
        "parseInt",
        "parseFloat",
        "isNaN",
        "isFinite",
        "encodeURIComponent",
        "decodeURIComponent",
        "encodeURI",
        "decodeURI",
        "escape",
        "unescape",
        "globalThis",
        "arguments",
        "Function",
        "event",
        "_event",
        "_message",
        "session",
        "application",
        "document",
        "dialog",
        "sensor",
        "eval",
        "Promise",
        "Reflect",
        "WeakMap",
        "WeakSet",
        "SyntaxError",
        "ReferenceError",
        "EvalError",
        "URIError",
        "Iterator",
        "AggregateError",
    ]
)
WORD = r"(?:[^\W\d]|\$)[\w$]*"
TEMPLATE = (
    r"`(?:\\.|\$\{(?:[^`{}]|`(?:\\.|[^`\\])*+`|\{[^{}]*+\})*+\}|[^`\\])*+`?"  # one in another
)
TOKEN = re.compile(
    rf"""//[^\n]*+|/\*(?:[\s\S]*?\*/|[\s\S]*)|"(?:\\[\s\S]|[^"\\\n])*+"?|'(?:\\[\s\S]|[^'\\\n])*+'?"""
    rf"""|{TEMPLATE}|[0-9][\w.]*+|#?{WORD}|\.\.\.|=>|[=!]==?|[<>]=|\?\.(?![0-9])|\S"""
)
PATTERN = re.compile(r"/(?![/*])(?:\\.|\[(?:\\.|[^\]\\\n]){0,99}+\]|[^/\\\n\[])++/[a-z]*")
"""A regular expression, where a division cannot stand."""
INSERTED = re.compile(r"\$\{((?:[^`{}]|\{[^{}]*\})*)\}")
"""An expression in a template."""
IDENTIFIER = re.compile(WORD)
OPERAND = re.compile(r"[\w$)\]\"'`]")
"""How something ends behind which a stroke divides."""
BEFORE_OPERAND = frozenset(["return", "typeof", "case", "in", "of", "do", "else", "void", "delete"])
PAIRS = {"(": ")", "[": "]", "{": "}"}
NO_METHOD = frozenset(["if", "for", "while", "switch", "with", "catch", "function"])


class Scope(set[str]):
    """The names of the variables of one scope."""

    @cached_property
    def written(self) -> list[str]:
        """Those that code can hold and that are not our own, as many as are guessed among.

        Asked for once all names are there.
        """
        meant = (one for one in self if IDENTIFIER.fullmatch(one) and not one.startswith("$"))
        return list(islice(meant, MANY_WORDS + 1))


class Known:
    """The variables that some code may see: looked up in their scopes, which are never joined."""

    __slots__ = ("_scopes",)

    def __init__(self, *scopes: Scope) -> None:
        self._scopes = scopes

    def __contains__(self, name: object) -> bool:
        return any(name in scope for scope in self._scopes)

    def written(self) -> Iterator[str]:
        """Variables that an author may have meant."""
        return (name for scope in self._scopes for name in scope.written)


@dataclass(slots=True)
class Token:
    """A piece of code: its text, where it begins, and whether a line begins before it."""

    text: str
    start: int
    fresh: bool


def tokens_of(code: str) -> list[Token]:
    """The pieces of code, comments left out."""
    found: list[Token] = []
    position, end = 0, 0
    heads: list[bool] = []
    """Of the round brackets that are open, whether they are the head of an if or a loop."""
    head = False
    while match := TOKEN.search(code, position):
        last = found[-1].text if found else ""
        if match[0] == "/" and (head or not _ends_operand(found)):
            match = PATTERN.match(code, match.start()) or match
        position = match.end()
        if match[0] == "(":
            heads.append(last in HEADED)
        head = match[0] == ")" and bool(heads) and heads.pop()
        if match[0].startswith(("//", "/*")):
            continue
        fresh = not found or "\n" in code[end : match.start()]
        found.append(Token(match[0], match.start(), fresh))
        end = position
    return found


HEADED = frozenset(["if", "while", "for", "with"])
"""Behind the bracket that follows these a statement begins."""


def _ends_operand(before: list[Token]) -> bool:
    """Whether code may end an operand, so that a stroke behind it divides."""
    if not before:
        return False
    last = before[-1]
    if last.text in ("+", "-") and len(before) > 1:  # i++ is one, and a prefix has none behind it
        return before[-2].text == last.text and before[-2].start + 1 == last.start
    regular = last.text[0] == "/" and len(last.text) > 1
    return regular or (
        OPERAND.match(last.text[-1:]) is not None and last.text not in BEFORE_OPERAND
    )


LONG_CODE = 500
"""Characters of code beyond which what is found in it is not kept, but of the last."""


def free_names(code: str) -> Mapping[str, int]:
    """Names that code uses without declaring them, as far as can be seen, and where first."""
    return _last_names(code)[1] if len(code) > LONG_CODE else _kept_names(code)


@lru_cache(maxsize=10_000)
def _kept_names(code: str) -> Mapping[str, int]:
    return _names(code)[1]


@lru_cache(maxsize=1)
def _last_names(code: str) -> tuple[frozenset[str], Mapping[str, int]]:
    return _names(code)


def _names(code: str) -> tuple[frozenset[str], Mapping[str, int]]:
    """The names that code declares, and those that it uses without."""
    reader = Reader(code)
    used, declared = reader.used(), reader.declared()
    own = declared | reader.parameters() | GLOBALS
    free = {name: start for name, start in used.items() if name not in own}
    return frozenset(declared), MappingProxyType(free)


def handled_names(code: str) -> dict[str, int]:
    """Variables of an event that code uses, and where first."""
    if "event" not in code and "_message" not in code:
        return {}
    reader = Reader(code)
    own = reader.declared() | reader.parameters()
    return {name: at for name, at in reader.used().items() if name in HANDLED and name not in own}


def is_only_asked(code: str, start: int) -> bool:
    """Whether a name in code is asked for its type alone, which it may be without being declared."""
    while start and code[start - 1].isspace():
        start -= 1
    return code.startswith("typeof", max(start - 6, 0), start)


def declared_names(code: str) -> Set[str]:
    """Names that a script declares at its top level (and perhaps deeper)."""
    if DECLARES.search(code) is None:
        return frozenset()
    return _last_names(code)[0] if len(code) > LONG_CODE else Reader(code).declared()


def assigned_names(code: str) -> set[str]:
    """Names that code gives a value, and loops theirs, without declaring them.

    Some that the code declares outside of functions are among them.
    """
    if not ASSIGNS.search(code):
        return set()
    reader = Reader(code)
    outside, inside = reader.assigned()
    return (outside | inside - reader.declared() - reader.parameters()) - GLOBALS


ASSIGNS = re.compile(rf"{WORD}\s*(?:=(?!=)|(?:in|of)\b)")
DECLARES = re.compile(r"\b(?:var|let|const|function|class)\b")


class Reader:
    """Reads names from tokens; where it cannot tell, it takes a name for declared."""

    def __init__(self, code: str) -> None:
        self.code = code
        self.tokens = tokens_of(code)
        self.texts = [token.text for token in self.tokens] + [""]
        self.ends = self._pairs()
        """Where a bracket's partner stands, both ways."""

    def _pairs(self) -> dict[int, int]:
        ends: dict[int, int] = {}
        waiting: list[int] = []
        for index, text in enumerate(self.texts):
            if text in PAIRS:
                waiting.append(index)
            elif text in (")", "]", "}") and waiting:
                ends[index] = waiting.pop()
                ends[ends[index]] = index
        return ends

    def _text(self, index: int) -> str:
        return self.texts[index] if 0 <= index < len(self.texts) else ""

    @staticmethod
    def _is_name(text: str) -> bool:
        return text not in RESERVED and IDENTIFIER.fullmatch(text) is not None

    def used(self) -> dict[str, int]:
        """Names that are read or called, with where they first stand."""
        found: dict[str, int] = {}
        members = self._members()
        for index, token in enumerate(self.tokens):
            if token.text.startswith("`"):
                for inside in INSERTED.finditer(token.text):
                    for name, start in free_names(inside[1]).items():
                        found.setdefault(name, token.start + inside.start(1) + start)
            elif self._is_name(token.text) and index not in members and self._reads(index):
                found.setdefault(token.text, token.start)
        return found

    def assigned(self) -> tuple[set[str], set[str]]:
        """Names before ``=``, and those of ``for (NAME in ...)``: outside of functions, and inside."""
        outside: set[str] = set()
        inside: set[str] = set()
        members = self._members()
        end = 0
        """Where the outermost function ends."""
        for index, text in enumerate(self.texts):
            if text == "function" and index >= end:
                end = self._function_end(index)
            after, before = self._text(index + 1), self._text(index - 1)
            loops = after in ("in", "of") and self._text(index - 2) == "for"
            takes = (after == "=" or loops) and before not in (".", "?.")
            if takes and self._is_name(text) and index not in members:
                (inside if index < end else outside).add(text)
        return outside, inside

    def _function_end(self, index: int) -> int:
        """Where a function ends that begins at an index."""
        opening = next((at for at in range(index, index + 4) if self._text(at) == "("), index)
        return self.ends.get(self.ends.get(opening, opening) + 1, index)

    def _reads(self, index: int) -> bool:
        """Whether a name at an index is neither a member's nor a label's."""
        before, after = self._text(index - 1), self._text(index + 1)
        if before in (".", "?.", "break", "continue") and not (
            self.tokens[index].fresh and before in ("break", "continue")
        ):
            return False
        if after == ":":  # a label or a member's name, unless it stands between ? and :
            plain = before in ("", "{", "}", ",", ";", ")", ":")
            return not (plain or (self.tokens[index].fresh and OPERAND.match(before[-1:])))
        if self.texts[index] in ("get", "set") and not (after in PAIRS or not after):
            return not (self._is_name(after) or after[:1] in "\"'#")
        return not self._is_method(index)

    def _is_method(self, index: int) -> bool:
        """Whether ``name ( ... ) {`` stands there."""
        end = self.ends.get(index + 1)
        opens = self._text(index + 1) == "(" and end is not None
        return opens and end is not None and self._text(end + 1) == "{"

    def _members(self) -> set[int]:
        """The names of members that stand in the bodies of classes."""
        found: set[int] = set()
        for index, text in enumerate(self.texts):
            if text != "class" or not self._is_keyword(index):
                continue
            start = next((at for at in range(index, len(self.texts)) if self.texts[at] == "{"), -1)
            at, end = start + 1, self.ends.get(start, -1)
            while 0 < at < end:
                before = self.texts[at - 1]
                if self.tokens[at].fresh or before in ("{", "}", ";", "static", "get", "set"):
                    found.add(at)
                at = self.ends.get(at, at) + 1
        return found

    def _is_keyword(self, index: int) -> bool:
        """Whether ``function`` or ``class`` is no member's name there."""
        return self._text(index - 1) not in (".", "?.") and self._text(index + 1) != ":"

    def declared(self) -> set[str]:
        """Names that var, let, const, function and class declare."""
        names: set[str] = set()
        for index, text in enumerate(self.texts):
            if text in ("var", "let", "const") and self._text(index - 1) != ".":
                names |= self._declaration(index + 1)
            elif text in ("function", "class"):
                name = index + 1 + (self._text(index + 1) == "*")
                names |= {self._text(name)} if self._is_name(self._text(name)) else set()
        return names

    def _declaration(self, index: int) -> set[str]:
        """The names of a list of declarators."""
        names: set[str] = set()
        loop = self._text(index - 2) == "(" and self._text(index - 3) in ("for", "await")
        ending = ("var", "let", "const", "of", "in") if loop else ("var", "let", "const")
        while index < len(self.tokens):
            if self.texts[index] in RESERVED:
                return names
            names |= self._targets(index)
            index = self.ends.get(index, index) + 1
            while (text := self._text(index)) not in (",", ";", ")", "]", "}", ""):
                if text in ending or self._next_statement(index):
                    return names  # what stands there is no declarator, or the loop's own
                index = self.ends.get(index, index) + 1
            if text != ",":
                return names
            index += 1
        return names

    def _next_statement(self, index: int) -> bool:
        """Whether a line begins there that does not go on with the one before."""
        word = IDENTIFIER.match(self.texts[index]) and self.texts[index] not in ("in", "instanceof")
        return bool(word) and self._begins_line(index)

    def _begins_line(self, index: int) -> bool:
        """Whether a line begins there, and the one before may be over."""
        return self.tokens[index].fresh and _ends_operand(self.tokens[max(index - 2, 0) : index])

    def parameters(self) -> set[str]:
        """Names of the parameters of functions, arrows, methods and catches."""
        names: set[str] = set()
        for index, text in enumerate(self.texts):
            if text == "=>":
                start = self.ends.get(index - 1, index - 1)
                names |= self._targets(start)
            elif text == "(" and index in self.ends:
                before = self._text(index - 1)
                opens = self._text(self.ends[index] + 1) == "{"
                method = opens and before not in NO_METHOD
                if method or before == "catch" or "function" in (before, self._text(index - 2)):
                    names |= self._targets(index)
        return names

    def _targets(self, start: int) -> set[str]:
        """The names that a binding at an index gives: one, or those of a pattern in brackets."""
        if start not in self.ends:
            return {self.texts[start]} if self._is_name(self._text(start)) else set()
        names: set[str] = set()
        waiting = [start]
        while waiting:
            opening = waiting.pop()
            at, takes = opening + 1, True
            while at < self.ends[opening]:
                text = self.texts[at]
                if text == ",":
                    takes = True
                elif takes and text in PAIRS and at in self.ends:
                    computed = text == "[" and self.texts[opening] == "{"
                    waiting += [] if computed and self._text(self.ends[at] + 1) == ":" else [at]
                elif takes and self._is_name(text) and self._text(at + 1) != ":":
                    names.add(text)
                takes = takes and text != "=" and text not in RESERVED
                at = self.ends.get(at, at) + 1
        return names
