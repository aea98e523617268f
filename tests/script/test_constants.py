"""Constants of scripts, paths into them, and code that changes them."""

from __future__ import annotations

from time import process_time

import pytest

from prima.script.comparison import comparison
from prima.script.constants import Path, changed_names, constants, path
from prima.script.literals import strings
from prima.script.names import expression_names


def test_literal_arrays_and_objects_of_a_script_are_its_constants() -> None:
    script = """// const none = [0];
      const a = [1, 'x', {k: -2}], b = {q: null};
      const rest = 1, call = f(); let c = [1]; var d = {};
      function g() { const inner = [1]; }
      const last = ['\\n']"""
    held = {"a": [1.0, "x", {"k": -2.0}], "b": {"q": None}, "last": ["\n"]}
    assert dict(constants(script)) == held


@pytest.mark.parametrize(
    ("expression", "steps"),
    [
        ("panels[at].parts[0]", ("panels", [None, "parts", "0"])),
        ("a['x y'].b", ("a", ["x y", "b"])),
        (" a . b ", ("a", ["b"])),
        ("a[b[0]].c", ("a", [None, "c"])),
        ("a[-1].c", ("a", [None, "c"])),
        (r"a['\x62'].c", ("a", [None, "c"])),
        ("a", None),
        ("a.b()", None),
        ("a?.b", None),
        ("f(a).b", None),
        ("a.b + 1", None),
        ("a.b)(", None),
    ],
)
def test_paths(expression: str, steps: tuple[str, list[str | None]] | None) -> None:
    assert path(expression) == (None if steps is None else Path(*steps))


@pytest.mark.parametrize(
    "piece",
    [
        "a.b", "!a.b", "typeof a.b", "b.c[a.d]", "f(a.b)", "const a = [1];",
        "for (const key in a) { }", "const f = () => a.b", "a.b == 1 ? a.c : a.d",
        "'a = 1'", "x.a = 1", "/* a = 1 */ 1",
    ],
)  # fmt: skip
def test_code_that_only_reads_a_constant(piece: str) -> None:
    changed = changed_names(piece)
    assert changed is not None and "a" not in changed


@pytest.mark.parametrize(
    "piece",
    [
        "a", "f(a)", "({a})", "({x: a})", "a[0].b = 1", "a.b += 1", "a.b++", "--a.b",
        "delete a.b", "a.push(1)", "a.c`x`", "new a.b()", "[a.b] = [1]", "({x: a.b} = y)",
        "for (a.b of c) {}", "for (const one of a) {}", "const f = () => { a.b = x }", "b[a]",
    ],
)  # fmt: skip
def test_code_that_may_change_a_constant_or_passes_it_on(piece: str) -> None:
    assert "a" in (changed_names(piece) or ())


def test_code_too_long_to_be_parsed_may_change_everything() -> None:
    assert changed_names("(" * 2_000 + ")" * 2_000) is None
    assert list(constants("[" * 2_000)) == [] and path("(" * 2_000) is None


@pytest.mark.parametrize(
    ("condition", "compared"),
    [
        ("x", ("x", True)),
        ("!x", ("x", False)),
        (r"x == '\x61'", None),
        ("dialog.x", ("dialog.x", True)),
        ("x == true", ("x", True)),
        ("x === false", ("x", False)),
        ("!x == false", ("x", True)),
        ("!x == 'word'", None),
        ("x == 'word'", ("x", "word")),
        ('x === "two words"', ("x", "two words")),
        ("x != 'word'", None),
        ("x == y", None),
        ("x == 1", None),
        ("f(x)", None),
        ("x == 'w' && y", None),
        ("x = ", None),
    ],
)
def test_simple_conditions(condition: str, compared: tuple[str, str | bool] | None) -> None:
    assert comparison(condition) == compared


def test_texts_in_quotes() -> None:
    assert list(strings("late ? '#end' : \"go \\'on\" + f('x')")) == ["#end", "go 'on", "x"]
    assert list(strings("'\\u0041'")) == [], "an uncommon escape is left to the engine"


def test_what_follows_a_name() -> None:
    names = expression_names("event.nme + f(event.data.x) + event.trim() + g")
    assert [(one.name, one.part) for one in names.uses if one.name == "event"] == [
        ("event", (6, "nme")),
        ("event", (20, "data")),
        ("event", None),
    ]
    assert names.called == {names.read["f"]}


def test_long_chains_are_looked_at_in_time() -> None:
    began = process_time()
    assert changed_names("a" + ".a" * 40_000) == set()
    assert process_time() - began < 5
