"""Words of ECMAScript, and names that every script sees or every value has."""

from __future__ import annotations

import re
from typing import Final

STRANGE: Final = "\u01c0"
"""A letter in all names that we put into the code of documents beside their own: few have one."""
RESERVED = frozenset([
    "break", "case", "catch", "class", "const", "continue", "debugger", "default", "delete",
    "do", "else", "enum", "export", "extends", "false", "finally", "for", "function", "if",
    "import", "in", "instanceof", "new", "null", "return", "super", "switch", "this", "throw",
    "true", "try", "typeof", "var", "void", "while", "with", "let", "static", "yield", "await",
    "async", "of",
])  # fmt: skip
HANDLED = frozenset(["event", "_event", "_message"])
"""Variables that tell a handler of its event."""
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
"""Names that every script sees."""
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
"""Names that every object has from its prototype, scopes included."""
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
"""Members that texts, numbers and arrays have from theirs."""
WORD = r"(?:[^\W\d]|\$)[\w$]*"
IDENTIFIER = re.compile(WORD)
"""A name of a variable as documents write it."""
