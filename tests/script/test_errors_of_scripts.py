"""Values that scripts throw: reporting them runs none of their code, as no limit holds then."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from prima.script.engine import Engine
from prima.script.evaluation import SCOPES, ScriptError

LOOP = "function () { for (;;); }"
LATE = "it took longer than 0.05 s"
THROWN = [
    (f"throw {{toString: {LOOP}}}", LATE),
    (f"throw {{[Symbol.toPrimitive]: {LOOP}}}", LATE),
    (f"var e = new Error('q'); Object.defineProperty(e, 'message', {{get: {LOOP}}}); throw e", LATE),
    (f"var e = new Error('q'); Object.defineProperty(e, 'stack', {{get: {LOOP}}}); throw e", LATE),
    (f"Error.prototype.toString = {LOOP}; nope.y", "ReferenceError: nope is not defined"),
    (f"Error.prototype.toString = {LOOP}; for (;;);", LATE),
    (f"InternalError.prototype.toString = {LOOP}; for (;;);", LATE),
    (f"InternalError.prototype[Symbol.toPrimitive] = {LOOP}; for (;;);", LATE),
    (f"Object.prototype[Symbol.toPrimitive] = {LOOP}; for (;;);", LATE),
    (f"Object.setPrototypeOf(InternalError.prototype, {{toString: {LOOP}}}); for (;;);", LATE),
    (f"Object.defineProperty(Error.prototype, 'stack', {{get: {LOOP}}}); 1", "TypeError: property"),
    (f"Error.prepareStackTrace = () => ({{toString: {LOOP}}}); for (;;);", LATE),
    (f"Error.stackTraceLimit = {{valueOf: {LOOP}}}; for (;;);", LATE),
    (f"String = {LOOP}; throw 'told'", "told"),
    (f"eval('var \\u01c0safe = function () {{ return {{toString: {LOOP}}}; }}'); null.x", "TypeError"),
    (f"eval('var \\u01c0 = 1'); throw {{toString: {LOOP}}}", LATE),
    (f"\\u0065val('var \\\\u01c0safe = 1'); throw {{toString: {LOOP}}}", LATE),
    ("throw 'a\\ud800b'", "a\ufffdb"),
    ("throw undefined", "undefined"),
    ("class E extends Error { constructor(m) { super(m); this.name = 'E'; } } throw new E('x')", "E: x"),
    ("function F(m) { this.message = m; } F.prototype = new Error(); F.prototype.name = 'F'; "
     "throw new F('x')", "F: x"),
    ("throw new Error('x'.repeat(900000))", "Error: x"),
]  # fmt: skip
HEAD = """
import json, sys
from prima.script import engine as expressions, tagengine as grammar, syntax
from prima.script.evaluation import SCOPES
expressions.TIME_LIMIT = grammar.TIME_LIMIT = syntax.TIME_LIMIT = 0.05
told = []
for code in json.load(sys.stdin):
    engine, sandbox = expressions.Engine(), grammar.TagEngine()
    scopes = tuple(engine.named(name) for name in SCOPES)
    environment = sandbox.environment('x', False)
    value = f'({{toJSON: function () {{ {code} }}}})'
    try:
        WAY
    except (expressions.ScriptError, grammar.ScriptError) as error:
        told.append(str(error))
json.dump(told, sys.stdout)
"""
WAYS = {
    "script": "engine.script(code, scopes[1], scopes)",
    "expression": "engine.assign(scopes[1], 'v', f'(function () {{ {code} }})()', scopes)",
    "helper": "engine.out(engine.raw(value, scopes))",
    "tag": "sandbox.rule(code, environment)",
    "global tag": "sandbox.run(code)",
    "value": "sandbox.json(sandbox.rule(f'out = {value}', environment))",
}


@pytest.mark.parametrize("way", WAYS)
def test_what_is_thrown_is_told_within_the_limits(way: str) -> None:
    """In a process of its own: what does not hold the limits cannot be stopped."""
    done = subprocess.run(
        [sys.executable, "-c", HEAD.replace("WAY", WAYS[way])],
        input=json.dumps([code for code, _ in THROWN]),
        capture_output=True,
        encoding="utf-8",
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    for (code, expected), told in zip(THROWN, json.loads(done.stdout), strict=True):
        assert told.startswith(expected), code


@pytest.mark.parametrize(
    ("thrown", "told"),
    [
        ("{a: 1}", "it threw an object that is not an Error"),
        ("Object.create(null)", "it threw a value that cannot be shown"),
        ("null", "it threw null, or used too much memory"),
    ],
)
def test_what_is_no_error_is_told_alike_of_tags_and_scripts(thrown: str, told: str) -> None:
    from prima.script import engine as expressions
    from prima.script import tagengine as grammar
    from prima.script.evaluation import SCOPES, ScriptError

    sandbox, engine = grammar.TagEngine(), expressions.Engine()
    with pytest.raises(ScriptError, match=told):
        sandbox.run(f"throw {thrown}")
    scopes = tuple(engine.named(name) for name in SCOPES)
    with pytest.raises(ScriptError, match=told):
        engine.script(f"throw {thrown}", scopes[1], scopes)


def test_what_a_grammars_script_declares_is_there_for_its_tags() -> None:
    from prima.script.tagengine import TagEngine

    sandbox = TagEngine()
    sandbox.run("'use strict'; let a = 1; const b = 2; var c = 3; class D { x() { return a; } }")
    sandbox.run("function f() { return a + b; } { let hidden = 1; } var x = class Inner {};")
    sandbox.run(
        "// the class for drinks\nvar price = 3, told = 'let if', re = /[/]const /, t = `let ${price}`;"
    )
    sandbox.run("let d = 4, {e, g} = {e: 5, g: 6}; const [h] = [7]; for (let i = 0; i < 2; i++) {}")
    sandbox.run(
        "let n = 0; function inc() { n++; } function get() { return n; } var q = n++ / 2 / 1;"
    )
    code = "n = 5; inc(); out = [a, b, c, new D().x(), f(), d, e, g, h, get(), told, t, q]"
    box = sandbox.rule(code, sandbox.environment("x", False))
    assert sandbox.json(box) == [1, 2, 3, 1, 3, 4, 5, 6, 7, 6, "let if", "let 3", 0]
    code = "out = [typeof hidden, typeof Inner, typeof i, typeof drinks]"
    box = sandbox.rule(code, sandbox.environment("x", False))
    assert sandbox.json(box) == ["undefined"] * 4


def test_a_bigint_is_told_in_words() -> None:
    engine = Engine()
    scopes = tuple(engine.named(name) for name in SCOPES)
    with pytest.raises(ScriptError, match="of a type that is absent here, such as BigInt"):
        engine.value("10n", scopes)


def test_functions_may_call_themselves_hundreds_of_times_and_no_more() -> None:
    engine = Engine()
    scopes = tuple(engine.named(name) for name in SCOPES)
    engine.script("function sum(n) { return n ? n + sum(n - 1) : 0 }", scopes[1], scopes)
    assert engine.value("sum(500)", scopes) == 125_250
    with pytest.raises(ScriptError, match="call stack"):
        engine.value("sum(100000)", scopes)
