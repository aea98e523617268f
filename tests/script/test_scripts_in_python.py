"""Scripts that only declare data run in Python, and mean what they mean in the engine."""

from __future__ import annotations

from pathlib import Path
from time import process_time
from typing import Any

import pytest

from prima import api
from prima.interpreter import states
from prima.interpreter.pyengine import PythonEngine, is_python
from prima.interpreter.reader import read_document
from prima.script.data import MOST_CODE, declared
from prima.script.engine import Engine
from prima.script.evaluation import ScriptError
from prima.script.globals import INHERITED, METHODS
from tests import ROOT

ENGINE = Engine()
DOCUMENTS = ROOT / "documents"
SCENARIOS = sorted((DOCUMENTS / "scenarios").rglob("*.xml"))


def scopes_of(engine: Any) -> tuple[Any, ...]:
    made = (engine.named("application"), engine.named("document"), engine.named("dialog"))
    return (*made, engine.scope())


def values(engine: Any, code: str, names: list[str]) -> list[Any]:
    """What a script of the document declares, and where."""
    scopes = scopes_of(engine)
    engine.set(scopes[0], "outer", "mine")
    engine.script(code, scopes[1], scopes)
    told = [engine.value(name, scopes) for name in names]
    return [*told, [engine.has(scope, name) for scope in scopes for name in names]]


@pytest.mark.parametrize(
    ("code", "names"),
    [
        ("const rooms = { 'lab': 'The laboratory', hall: 'The hall' };", ["rooms"]),
        ("var a = 1, b = -2.5\nlet c = 'x'; // done\n/* and */ const d = [true, null]", [*"abcd"]),
        ("const panels = [{ place: 'p', parts: ['a', 'b'], at: { x: -1 } }, {}];", ["panels"]),
        ("var outer = [];", ["outer"]),
        ("let outer = {};", ["outer"]),
        ("", []),
        ("  // nothing\n", []),
        ("const a = 1\nconst b = '\\n\\t\\'é😀'", ["a", "b"]),
    ],
)
def test_data_is_declared_as_in_the_engine(code: str, names: list[str]) -> None:
    assert declared(code) is not None
    assert values(PythonEngine(), code, names) == values(ENGINE, code, names)


@pytest.mark.parametrize(
    "code",
    [
        *("function f() {}", "const f = () => 1;", "var a;", "let a;", "a = 1", "const a = b;", "f()"),
        *("const a = 1, b = a;", "const a = [b];", "const [a] = [1];", "const {a} = {a: 1};", "1"),
        *("const a = 1; const a = 2;", "var a = 1, a = 2;", "const constructor = 1;", "var Math = 1;"),
        *("var event = 1;", "var undefined = 1;", "const a = `x`;", "const a = /x/;", "if (1) {}"),
        *("const a = {get b() {}};", "const a = {[b]: 1};", "const a = {...b};", "const a = 1 + 1;"),
        *("const a = {1: 2};", "const é = 1;", "const a = '\\u0041';", "const a = ;", "const a = 1 2"),
        *("{ const a = 1; }", "class A {}", "'use strict'", "export const a = 1;", "a: 1", "debugger"),
        *("await 1", "const a = [1,,2];", "const a = {__proto__: 1};", "const \\u0061 = 1;"),
        *("[" * 60 + "]" * 60, f"const a = {'[' * 60}{']' * 60};", f"const a = '{'x' * MOST_CODE}';"),
    ],
)  # fmt: skip
def test_other_scripts_are_left_to_the_engine(code: str) -> None:
    assert declared(code) is None


def test_each_run_of_a_script_makes_its_data_anew() -> None:
    code = "const a = [[1], {b: []}];"
    for engine in (PythonEngine(), ENGINE):
        scopes = scopes_of(engine)
        engine.script(code, scopes[1], scopes)
        engine.assign(scopes[3], "before", "a[0]", scopes)
        engine.script(code, scopes[1], scopes)
        assert engine.condition("a[0] !== before && a[0][0] === before[0]", scopes)


@pytest.mark.parametrize("name", sorted(INHERITED | METHODS))
def test_a_computed_name_finds_no_built_in_function(name: str) -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[1], "name", name)
    engine.set(scopes[1], "table", {"lab": 1})
    engine.set(scopes[1], "row", [1])
    tables = ["row", "'text'", "table"] if name in INHERITED else ["row", "'text'"]
    for table in tables:
        with pytest.raises(ScriptError, match=f"'{name}' is the name of a function"):
            engine.value(f"{table}[name]", scopes)
    with pytest.raises(ScriptError, match=f"'{name}' is the name of a function"):
        engine.condition("name in row", scopes)
    engine.set(scopes[1], "table", {name: 2})
    assert engine.value("table[name]", scopes) == 2
    assert engine.condition("name in table", scopes)


@pytest.mark.parametrize(
    "name",
    ["smile[1]", "'a' + smile[2]", "lines", "nul", "long", "'x' + long", "'x' + long + smile[1]"],
)
def test_an_error_quotes_a_name_as_the_engine_does(name: str) -> None:
    """Whatever is in it, the message can be written into a transcript."""
    told = []
    for engine in (PythonEngine(), ENGINE):
        scopes = scopes_of(engine)
        engine.fill(
            scopes[1],
            {"smile": "a😀z", "nul": "a\0b", "lines": "a\nb", "long": "é" * 40, "nil": None},
        )
        with pytest.raises(ScriptError) as caught:
            engine.value(f"nil[{name}]", scopes)
        told.append(str(caught.value))
    assert told[0] == told[1]
    assert told[0].encode().decode() == told[0]


@pytest.mark.parametrize("value", [None, 5, "x"])
def test_a_variable_hides_a_conversion(value: Any) -> None:
    for engine in (PythonEngine(), ENGINE):
        scopes = scopes_of(engine)
        engine.set(scopes[1], "n", 1)
        engine.set(scopes[1], "Number", value)
        if value is None:
            engine.unset(scopes[1], "Number")
        with pytest.raises(ScriptError, match="TypeError: not a function"):
            engine.value("Number(n)", scopes)


def test_long_names_are_work() -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[1], "name", "x" * 90_000)
    engine.set(scopes[1], "table", {})
    with pytest.raises(ScriptError, match="too long"):
        for _ in range(10_000):
            engine.value("table[name]", scopes)


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda path: path.stem)
def test_a_run_is_the_same_whoever_evaluates(
    scenario: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded = api.load_scenario(scenario)
    plain = api.rehearse(loaded).dumps()
    monkeypatch.setattr(states, "evaluator_of", lambda _document, _shared: Engine())
    assert api.rehearse(loaded).dumps() == plain


@pytest.mark.parametrize(
    ("path", "simple"),
    [
        ("fa/follow.xml", True),
        ("fa/dance.xml", True),
        ("fa/scheduler.xml", True),
        ("ea/museum.xml", True),
        ("fa/video-timer.xml", False),
        ("ea/library.xml", False),
    ],
)
def test_documents_without_functions_of_their_own_need_no_engine(path: str, simple: bool) -> None:
    document, _ = read_document(path, (DOCUMENTS / path).read_bytes())
    assert is_python(document) == simple


def test_a_long_text_that_is_no_number_is_soon_known() -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[0], "t", "1" * 20_000 + "!")
    began = process_time()
    assert engine.value("t > 0", scopes) is False
    assert process_time() - began < 2, "10 ms on a quiet machine"
