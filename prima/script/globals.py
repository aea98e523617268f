"""Words of ECMAScript and names that every script sees."""

from __future__ import annotations

import re
from typing import Final

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
IDENTIFIER = re.compile(WORD)
"""A name of a variable as documents write it."""
