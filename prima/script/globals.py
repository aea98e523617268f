"""Keywords of ECMAScript, and predefined names of scripts and values."""

from __future__ import annotations

import re
from typing import Final

STRANGE: Final = "\u01c0"
"""A letter in all names that we add to the code of documents, where it is rare."""
RESERVED = frozenset([
    "break", "case", "catch", "class", "const", "continue", "debugger", "default", "delete",
    "do", "else", "enum", "export", "extends", "false", "finally", "for", "function", "if",
    "import", "in", "instanceof", "new", "null", "return", "super", "switch", "this", "throw",
    "true", "try", "typeof", "var", "void", "while", "with", "let", "static", "yield", "await",
    "async", "of",
])  # fmt: skip
HANDLED = frozenset(["event", "_event", "_message"])
"""Variables that describe a handler's event."""
VARIABLES = HANDLED | {"session", "application", "document", "dialog", "sensor"}
"""Variables that the language itself declares."""
CONSTANTS = frozenset(["undefined", "NaN", "Infinity"])
ENGINES = frozenset([
    "Object", "Array", "String", "Number", "Boolean", "Math", "Date", "JSON", "RegExp", "Error",
    "TypeError", "RangeError", "Map", "Set", "Symbol", "parseInt", "parseFloat", "isNaN",
    "isFinite", "encodeURIComponent", "decodeURIComponent", "encodeURI", "decodeURI", "escape",
    "unescape", "globalThis", "arguments", "Function", "eval", "Promise", "Reflect", "WeakMap",
    "WeakSet", "SyntaxError", "ReferenceError", "EvalError", "URIError", "Iterator",
    "AggregateError",
])  # fmt: skip
GLOBALS = ENGINES | VARIABLES | CONSTANTS
"""Names visible to every script."""
BUILT_IN = ENGINES | {
    *("AsyncDisposableStack", "DisposableStack", "InternalError", "SuppressedError"),
    *("atob", "btoa"),
}
"""Names of the engine's own."""
INHERITED = frozenset([
    "constructor", "toString", "toLocaleString", "valueOf", "hasOwnProperty", "isPrototypeOf",
    "propertyIsEnumerable", "__proto__", "__defineGetter__", "__defineSetter__",
    "__lookupGetter__", "__lookupSetter__",
])  # fmt: skip
"""Names that every object, including scopes, inherits from its prototype."""
METHODS = frozenset([
    "at", "concat", "copyWithin", "fill", "find", "findIndex", "findLast", "findLastIndex",
    "lastIndexOf", "pop", "push", "reverse", "shift", "unshift", "slice", "sort", "splice",
    "includes", "indexOf", "join", "keys", "entries", "values", "forEach", "filter", "flat",
    "flatMap", "map", "every", "some", "reduce", "reduceRight", "toReversed", "toSorted",
    "toSpliced", "with", "charCodeAt", "charAt", "codePointAt", "endsWith", "isWellFormed",
    "toWellFormed", "localeCompare", "match", "matchAll", "normalize", "padEnd", "padStart",
    "repeat", "replace", "replaceAll", "search", "split", "startsWith", "substr", "substring",
    "toLowerCase", "toLocaleLowerCase", "toUpperCase", "toLocaleUpperCase", "trim", "trimEnd",
    "trimStart", "trimLeft", "trimRight", "anchor", "big", "blink", "bold", "fixed",
    "fontcolor", "fontsize", "italics", "link", "small", "strike", "sub", "sup",
    "toExponential", "toFixed", "toPrecision",
])  # fmt: skip
"""Members that texts, numbers and arrays inherit from theirs."""
WORD = r"(?:[^\W\d]|\$)[\w$]*"
IDENTIFIER = re.compile(WORD)
"""The name of a variable as documents write it."""
