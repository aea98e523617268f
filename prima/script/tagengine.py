"""The ECMAScript engine for the tags of grammars, in a process of its own.

``Date`` gives the time that was set and ``Math.random`` is seeded, so that a match is repeatable.
"""

from __future__ import annotations

import json
from time import thread_time
from typing import TYPE_CHECKING, Any

import _quickjs as quickjs

from prima.script.budget import TIME_LIMIT
from prima.script.evaluation import ScriptError, bounded, read_json
from prima.script.parse import parse_script, spliced
from prima.script.sandbox import (
    CLOCK,
    DATE,
    EVALUATE,
    GUARD,
    GUARDS,
    MEMORY_LIMIT,
    NEXT,
    PRELUDE,
    reason,
    source,
)
from prima.script.surrogates import well_formed, well_formed_json
from prima.script.syntax import confined
from prima.script.wrapping import Helpers

if TYPE_CHECKING:
    from prima.messages import Json

DONE = 1_000_000
"""The code after a rule's last tag."""
LEAST_MEMORY = 1024 * 1024
"""Bytes that the first sandbox may use: each further one has half as many."""

HELPERS = source("tags.js")

CHECK = source("check.js")
"""Compiles a script by itself without running it; it declares nothing outside."""


def shared(code: str) -> str:
    """A script with its top-level declarations moved to the global scope, where others see them.

    Otherwise ``let``, ``const`` and ``class`` would be local, as a function evaluates the code.
    """
    if not any(word in code for word in ("let", "const", "class")):
        return code
    parsed = parse_script(code)
    if parsed is None or not parsed.sound:
        return code
    edits = []
    for node in parsed.root.children:
        name = node.child_by_field_name("name")
        if node.type == "lexical_declaration":
            word = node.children[0]
            edits.append((parsed.start(word), parsed.end(word), "var"))
        elif node.type == "class_declaration" and name is not None:
            start, end = parsed.start(node), parsed.end(node)
            edits.append((start, end, f"var {parsed.of(name)} = {code[start:end]};"))
    return spliced(code, edits)


class TagEngine:
    """The ECMAScript of one grammar document while one utterance is interpreted."""

    def __init__(self, others: int = 0) -> None:
        """``others`` is how many sandboxes the same utterance has already."""
        self.now, self._told = 0, -1
        """The time that the tags see (ms since 1970, UTC)."""
        self.spent = 0.0
        """Seconds of processor time that the tags of this utterance have taken."""
        context = confined(max(MEMORY_LIMIT >> others, LEAST_MEMORY))
        context.eval(GUARDS)
        clock = context.eval(CLOCK)(DATE)
        context.eval(PRELUDE)
        clock()
        self._clock = clock
        self._context = context
        self._help = Helpers(context, HELPERS)
        self._check = context.eval(CHECK)
        self._functions: dict[str, Any] = {}

    def _call(self, function: Any, *given: Any) -> Any:
        if self.spent > TIME_LIMIT:
            raise ScriptError(f"the tags took longer than {TIME_LIMIT:g} s")
        began = thread_time()
        try:
            if self._told != self.now:
                self._told = self.now
                self._clock(float(self.now))
            return function(*given)
        except (quickjs.JSException, quickjs.StackOverflow) as error:
            raise ScriptError(reason(str(error), TIME_LIMIT)) from None
        except (TypeError, ValueError, OverflowError, MemoryError, SystemError) as error:
            raise ScriptError(f"it gives what cannot be used: {error}") from None
        finally:
            self.spent += thread_time() - began

    def run(self, code: str) -> None:
        """Run a script in the global scope (SISR 1.0: global tags)."""
        self._call(self._context.eval(EVALUATE), f";{shared(code)}\n;0")

    def box(self, value: Json) -> Any:
        """Box a value from outside for functions of the sandbox."""
        return self._call(self._help["box"], json.dumps(value))

    def environment(self, text: str, merges: bool) -> Any:
        """The environment of a rule's tags, for :meth:`rule`."""
        return self._call(self._help["environment"], well_formed(text), merges)

    def rule(self, code: str, environment: Any) -> Any:
        """Run the tags of a rule to where ``yield`` waits for one that it refers to, or to its end.

        Returns:
            The boxed value, or None if it waits.
        """
        function = self._functions.get(code)
        if function is None:
            end = f"{NEXT}.at = {DONE}; return {{ v: out }};"
            body = f"(function* (rules, meta, {NEXT}, out) {{\n{code}\n{end}\n}})"
            function = self._functions[code] = self._call(self._context.eval, body)
        return self._reach(environment, self._call(self._help["begin"], environment, function))

    def resume(self, environment: Any, name: str, box: Any, text: str) -> Any:
        """Go on with the tags of a rule, which waited for this value of one that it refers to."""
        given = environment, name, box, well_formed(text)
        return self._reach(environment, self._call(self._help["resume"], *given))

    def _reach(self, environment: Any, box: Any) -> Any:
        if box is not None and self.reached(environment) != DONE:
            raise ScriptError("return outside of a function")
        return box

    def reached(self, environment: Any) -> int:
        """The number of the rule's tag begun last."""
        try:
            at = self._context.eval(f"{GUARD}((e) => e.next.at | 0)")(environment)
        except (quickjs.JSException, quickjs.StackOverflow):
            return 0
        return max(int(at), 0)

    def fault(self, code: str) -> str:
        """Why a script is not well-formed by itself; empty if it is."""
        try:
            self._check(code)
        except (quickjs.JSException, quickjs.StackOverflow) as error:
            return reason(str(error), TIME_LIMIT)
        return ""

    def carry(self, box: Any) -> str:
        """A boxed value as text, for :meth:`take` of another sandbox; functions are undefined there."""
        return bounded(str(self._call(self._help["carry"], box)))

    def take(self, text: str) -> Any:
        """Unbox a value from another sandbox."""
        return self._call(self._help["take"], text)

    def json(self, box: Any) -> Json:
        """A boxed value as plain data; undefined and functions become None."""
        text = self._call(self._help["json"], box)
        return read_json(well_formed_json(text)) if isinstance(text, str) else None
