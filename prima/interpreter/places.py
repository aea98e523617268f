"""Places of elements and of code, as messages and records name them."""

from __future__ import annotations

from prima.errors import Place
from prima.interpreter.acts import Expression
from prima.markup.tree import Node
from prima.script.evaluation import ScriptError


def source(node: Node) -> str:
    """The document, line and column of an element, for messages; records have its line."""
    return short(node.place)


def short(place: Place) -> str:
    """A place with its document's name without folders: ``FILE:LINE:COLUMN``."""
    return f"{place.file.replace(chr(92), '/').rpartition('/')[2]}:{place.line}:{place.column}"


def where(expr: Expression, error: ScriptError) -> str:
    """The document, line and column of a failure in an expression or script."""
    return short(expr.node.code_place(expr.attribute, error.line, error.column))
