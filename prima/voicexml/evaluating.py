"""Evaluates expressions of VoiceXML documents."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from prima.interpreter.content import MAX_REPEATS
from prima.interpreter.places import short, source
from prima.interpreter.transfers import Thrown, failure
from prima.markup.tree import Node
from prima.messages import Json
from prima.script.evaluation import Scope, ScriptError, statement_place
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context
from prima.voicexml.variablenames import wrong_name

SHOWN = """function (v) { return v === undefined ? 'undefined'
  : v === null || typeof v !== 'object' ? v : v.nodeType !== undefined ? v.textContent
  : typeof v.toString === 'function' && v.toString !== Object.prototype.toString ? String(v)
  : v; }""".replace("\n", "")
"""The spoken text of a value in the engine: the text of a node of ``data``, and an object's own
string form, such as an array's."""
WORD = "function (v) { return v === void 0 ? null : `${v}`; }"
"""The text of an attribute from a value in the engine; null for undefined (5.1)."""
NAME = "function (v) { return v === void 0 || v === null ? null : `${v}`; }"
"""Like the former, for names and URIs: null is refused."""
TOLD = frozenset(["message", "aai"])
"""Attributes that name nothing: their text is only reported."""
WRONG = {
    "not a name": "is not a name",
    "reserved": "is a name of the platform's",
    "scope": "names a scope; declare it there",
}
"""Why a variable cannot have a name, as messages of a run say it."""


def is_worded(node: Node) -> bool:
    """Whether an element gives its event a message, perhaps an empty one (5.2.2)."""
    return not node.attributes.keys().isdisjoint(("message", "messageexpr"))


class VoiceEvaluator:
    """Evaluates attributes, and gives the place of what fails."""

    def __init__(self, shared: SharedState) -> None:
        self.shared = shared
        self.engine = shared.engine

    def failure(self, error: ScriptError, node: Node, attribute: str) -> Thrown:
        """``error.semantic`` with the place of what failed (5.2.6).

        Raises:
            GoOut: the engine is lost.
        """
        line, column = error.line, error.column
        if (
            attribute not in ("", "cond")
            and not self.engine.lost
            and self.engine.lenient(node.get(attribute)) != node.get(attribute)
        ):
            line, column = statement_place(error)
        code = node.get(attribute) if attribute else node.tag
        return failure(error, code, short(node.code_place(attribute, line, column)))

    @contextmanager
    def failing(self, node: Node, attribute: str) -> Iterator[None]:
        """Raise the failure of what the engine evaluates meanwhile, by :meth:`failure`."""
        try:
            yield
        except ScriptError as error:
            raise self.failure(error, node, attribute) from None

    def code(self, node: Node, attribute: str) -> str:
        """An attribute's expression; several statements, as other platforms take them, give one."""
        return self.engine.lenient(node.get(attribute))

    def value(self, node: Node, attribute: str, context: Context, local: Scope) -> Json:
        """An attribute's expression as plain data."""
        with self.failing(node, attribute):
            return self.engine.value(self.code(node, attribute), context.scopes(local))

    def holds(self, node: Node, context: Context, local: Scope) -> bool:
        """An element's condition; one without holds."""
        if "cond" not in node.attributes:
            return True
        with self.failing(node, "cond"):
            found = self.engine.condition(node.get("cond"), context.scopes(local))
        self.shared.app.note(node, "true" if found else "false")
        return found

    def word(self, node: Node, name: str, context: Context, local: Scope) -> str:
        """An attribute, or its ``expr`` form, as a word.

        Raises:
            Thrown: ``error.semantic`` if the expression fails or gives none.
        """
        dynamic = {"next": "expr", "nextitem": "expritem"}.get(name, f"{name}expr")
        if name in node.attributes:
            return node.get(name)
        if dynamic not in node.attributes:
            return ""
        found = self.said(node, dynamic, WORD if name in TOLD else NAME, context, local)
        if found is None:
            raise self.failure(ScriptError("it has no value"), node, dynamic)
        return str(found)

    def event(self, node: Node, context: Context, local: Scope) -> str:
        """The event that an element throws, if it throws one.

        Raises:
            Thrown: ``error.semantic`` if it has no name, or the expression fails.
        """
        name = self.word(node, "event", context, local)
        if not name and not node.attributes.keys().isdisjoint(("event", "eventexpr")):
            raise Thrown.at(node, "error.semantic", "the event has no name")
        return name

    def raised(self, node: Node, context: Context, local: Scope) -> Thrown:
        """The event that an element throws, with its message (5.2.1)."""
        name = self.event(node, context, local)
        thrown = Thrown(name, self.word(node, "message", context, local), source(node))
        thrown.worded = is_worded(node)
        return thrown

    def said(self, node: Node, attribute: str, how: str, context: Context, local: Scope) -> Json:
        """Apply a function of the engine to the value of an attribute's expression."""
        code = self.code(node, attribute)
        with self.failing(node, attribute):
            self.engine.compile(code)  # code that does not compile is reported at its own place
            return self.engine.value(f"({how})(({code}\n))", context.scopes(local))

    def elements(self, node: Node, context: Context, local: Scope) -> list[Json]:
        """The elements of a foreach's array, as values of the engine."""
        self.check_name(node, "item")
        with self.failing(node, "array"):
            found = self.engine.elements(
                self.code(node, "array"), context.scopes(local), MAX_REPEATS
            )
        for _ in found:
            self.shared.app.count_step(node)
        return found

    @staticmethod
    def check_name(node: Node, attribute: str = "name") -> None:
        """Refuse to declare a variable whose name has a scope prefix or is invalid (5.1)."""
        name = node.get(attribute)
        if wrong := wrong_name(name):
            raise Thrown.at(node, "error.semantic", f'"{name}" {WRONG[wrong]}')

    def text(self, node: Node, context: Context, local: Scope) -> str:
        """The text of a value (4.1.4)."""
        code, scopes = self.code(node, "expr"), context.scopes(local)
        with self.failing(node, "expr"):
            self.engine.compile(code)  # code that does not compile is reported at its own place
            return self.engine.text(f"({SHOWN})(({code}\n))", scopes)
