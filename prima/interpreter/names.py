"""Names that ECMAScript code uses and declares, as far as its text tells."""

from __future__ import annotations

import re

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
TOKEN = re.compile(
    r"""//[^\n]*|/\*[\s\S]*?\*/|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|`(?:\\.|[^`\\])*`"""
    r"""|(?<![\w$)\]\s])\s*+/(?![/*])(?:\\.|\[(?:\\.|[^\]\\])*\]|[^/\\\n])+/[a-z]*"""
    r"""|[0-9][\w.]*|[^\W\d][\w$]*|\$[\w$]*|\.\.\.|=>|\?\.|\S"""
)
IDENTIFIER = re.compile(r"(?:[^\W\d]|\$)[\w$]*")
DECLARED = re.compile(r"\b(?:var|let|const)\s+([^;\n]+)|\bfunction\s+([\w$]+)|\bclass\s+([\w$]+)")


def free_names(code: str) -> set[str]:
    """Names that an expression or script uses without declaring them, as far as can be seen."""
    used: set[str] = set()
    tokens = [token.strip() for token in TOKEN.findall(code)]
    own = declared_names(code)
    for position, token in enumerate(tokens):
        before = tokens[position - 1] if position else ""
        after = tokens[position + 1] if position + 1 < len(tokens) else ""
        if not IDENTIFIER.fullmatch(token) or token in RESERVED or before in (".", "?."):
            continue
        if after == ":" and before in ("{", ","):
            continue
        if after == "=>":
            own.add(token)
        if before in ("function", "class"):
            own.add(token)
        used.add(token)
    own |= _parameters(tokens)
    return used - own - GLOBALS


def _parameters(tokens: list[str]) -> set[str]:
    """Names of function parameters: what stands in brackets after function or before an arrow."""
    names: set[str] = set()
    for position, token in enumerate(tokens):
        if token == "function":
            start = tokens.index("(", position) if "(" in tokens[position:] else position
            end = tokens.index(")", start) if ")" in tokens[start:] else start
            names.update(tokens[start + 1 : end])
        elif token == "=>" and position and tokens[position - 1] == ")":
            start = position - 1
            while start and tokens[start] != "(":
                start -= 1
            names.update(tokens[start + 1 : position - 1])
        elif token == "catch" and tokens[position + 1 : position + 2] == ["("]:
            names.update(tokens[position + 2 : position + 3])
    return names


def declared_names(code: str) -> set[str]:
    """Names that a script declares at its top level (and perhaps deeper)."""
    names: set[str] = set()
    for match in DECLARED.finditer(code):
        if match[2] or match[3]:
            names.add(match[2] or match[3])
            continue
        depth = 0
        expecting = True
        for token in TOKEN.findall(match[1]):
            if token in "([{":
                depth += 1
            elif token in ")]}":
                depth -= 1
            elif depth == 0 and token == ",":
                expecting = True
            elif expecting and IDENTIFIER.fullmatch(token):
                names.add(token)
                expecting = False
    return names
