"""Scripts declare variables of the scope that they stand in, which all other code shares."""

from __future__ import annotations

import contextlib

import pytest

from prima.script.choices import choices
from prima.script.engine import Engine
from prima.script.evaluation import SCOPES, ScriptError
from prima.script.hoisting import hoisted
from prima.script.names import expression_names, script_names
from tests.helpers.work import steps


class Scopes:
    """An engine with one scope of each kind; scripts stand in the document's."""

    def __init__(self) -> None:
        self.engine = Engine()
        self.all = tuple(self.engine.named(name) for name in SCOPES)
        self.document = self.all[SCOPES.index("document")]

    def run(self, *scripts: str) -> None:
        for code in scripts:
            self.engine.script(code, self.document, self.all)

    def value(self, code: str) -> object:
        return self.engine.value(code, self.all)


@pytest.mark.parametrize(
    ("scripts", "code", "value"),
    [
        (["var t = 0; function add(x) { t += x; }", "add(5)", "add(7)"], "t", 12),
        (["var x;"], "'x' in document && x === undefined", True),
        (["var x = 1;", "var x;"], "x", 1),
        (["var A = A || {n: 0}; A.n++", "var A = A || {n: 0}; A.n++"], "A.n", 2),
        (["function f() { return later; }", "var later = 3;"], "f()", 3),
        (["function f() { return g(); } function g() { return 1; }", "function g() { return 2; }"], "f()", 2),
        (["var f = 1; function f() {}"], "f", 1),
        (["function f() { return 1; } function f() { return 2; }"], "f()", 2),
        (["function f(n) { return n <= 1 ? 1 : n * f(n - 1); }"], "f(5)", 120),
        (["for (var i = 0, n = 3; i < n; i++) { var q = i; } for (var k in {z: 1});"], "[i, q, k]", [3, 2, "z"]),
        (["if (true) { function f() { return 8; } var y = 1; }"], "[f(), y]", [8, 1]),
        (["var [p, r] = [1, 2]; let l = 5; const c = 6; class K {}"], "[p, r, l, c, typeof K]", [1, 2, 5, 6, "function"]),
        (["for (var [a, b] of [[1, 2]]);"], "[a, b]", [1, 2]),
        (["var x\n(function () { x = 9; })()"], "x", 9),
        (["var x\n[1].forEach(function (n) { x = n; })"], "x", 1),
        (["var a = 1\nb = 2, c = 3"], "[a, b, c]", [1, 2, 3]),
        (["'use strict'; var x = 4; function f() { return x; }"], "f()", 4),
        (["async function f() {} function* g() { yield 1; }"], "[typeof f, g().next().value]", ["function", 1]),
        (["var o = {m() { var inner = 1; return inner; }, f: function g() { var inner; }}"], "[o.m(), typeof inner, typeof g]", [1, "undefined", "undefined"]),
        (["var f = function (x) { var y = x; return y; }, g = x => { var z = x; return z; }"], "[f(1), g(2), typeof y, typeof z]", [1, 2, "undefined", "undefined"]),
        (["var s = 'var no = 1', r = /var no/, t = `var no`; // var no"], "typeof no", "undefined"),
        (["(function named() { var x = 1; })()"], "[typeof named, typeof x]", ["undefined", "undefined"]),
        (["this.foo = 3; (function (root) { root.Lib = {v: 1}; })(this);"], "[foo, Lib.v]", [3, 1]),
        (["let count = 0; function next() { return ++count; }", "next(); next();"], "count", 2),
        (["let n = 1; { let n = 2; const q = 3; } function f() { return n; }"], "[f(), n, typeof q]", [1, 1, "undefined"]),
        (["if (1) /a(){/.test('a'); var x = 1;"], "x", 1),
        (["function pct() { return (4 / 2) * 100; } var i = 6, p = i++ / 3; var path = 'x/y';"], "[pct(), p, path]", [200, 2, "x/y"]),
        (["var re = /^\\d+$/\nfunction f() { return 1; }\nvar n = 1\nn++\nfunction g() { return 2; }"], "[f(), g(), n]", [1, 2, 2]),
        (["var a = {class: 'x', function: 1}; function f() { return a.class; }"], "f()", "x"),
        (["var e = {}; e.class = 'a'; if (1) { var j = 1; } e.function = 2; function f() {}"], "[j, typeof f]", [1, "function"]),
        (["var o = {delete(n) { var i = n; if (n > 0) o.delete(n - 1); return i; }, 'm'() { var q; }, 1() { var q; }, ['x']() { var q; }}; var r = o.delete(3);"], "[r, typeof q]", [3, "undefined"]),
        (["var x = 1; var [x] = [2];"], "x", 2),
        (["for (var [k, v] of [[1, 2]]); for (var k in {z: 1});"], "k", "z"),
        (["var f; if (true) { function f() { return 1; } }"], "f()", 1),
        (["function f() { return 1; } if (true) { function f() { return 2; } }"], "f()", 2),
        (["if (false) { function log() {} } else { var log = null; }"], "log === null", True),
        (["var has = 'x' in {x: 1}, n = 0, list;"], "[has, n, list === undefined]", [True, 0, True]),
        (["var s = 1; if (s) /\"/.test('a'); var t = 'var x = 1'; var u = 2;"], "[t, u]", ["var x = 1", 2]),
        (["if (true)\n function f() { return 1; }"], "f()", 1),
        (["var $$ = 1; x = 3; function $f() { return $$; }"], "[$$, x, $f()]", [1, 3, 1]),
        (["function b() { return 1; } var b$_ = 3;"], "[b(), b$_]", [1, 3]),
        (["function outer() { class A extends (class B {}) { m() { var w; } } } var z = 1;"], "[typeof w, z]", ["undefined", 1]),
        (["function f() { return f.name; } function* g() {}", "var h = f;"], "[f(), g.name, h.name]", ["f", "g", "f"]),
        (["var ap_ = 1, do_ = 2, di_ = 3, lo_ = 4; function f() { return di_; }", "di_ = 5; lo_++;"], "[ap_, do_, f(), lo_]", [1, 2, 5, 5]),
        (["class K { m() { var x = 1; return x; } }"], "[new K().m(), typeof x]", [1, "undefined"]),
        (["var a = 1; let b = 2; function f() {} c = 3; var all = [delete a, delete b, delete document.f, delete c];"], "[all, a, b, typeof f, typeof c]", [[False, False, False, True], 1, 2, "function", "undefined"]),
        (["var {a, b: {c = 2}, ...rest} = {a: 1, b: {}, z: 3}, n = 4"], "[a, c, rest, n]", [1, 2, {"z": 3}, 4]),
        (["var [p] = [1]; function f() { return p; } p = 2;", "p = 3;"], "[f(), p]", [3, 3]),
        (["var a = 1\nvar [b] = [2]\nvar {c} = {c: 3}\na++"], "[a, b, c]", [2, 2, 3]),
        (["const {a, b} = {a: 1, b: 2}; let [c] = [3]; function f() { return a + b + c++; }", "f();"], "c", 4),
        (["for (var {n} = {n: 0}, i = 5; n < 3; n++); for (var {length} of ['ab']); if (n) var [m] = [6]"], "[n, i, length, m]", [3, 5, 2, 6]),
        (["var d = {h: 1}; with (d) { h = 2; g = h + 1; } function f() { with (Math) { three = floor(PI); } } f();"], "[d, g, three]", [{"h": 2}, 3, 3]),
        (["function sum() { return a + b; }", "let a = 1; const b = 2; var c = sum();"], "c", 3),
        (["function make() { return new K(); }", "class K { m() { return 1; } }\n(make()).m(); var k = make(); class L extends K {} var l = new L()"], "[k.m(), l.m(), l instanceof K, K.name, L.name]", [1, 1, True, "K", "L"]),
        ([r"var \u0061b = 1; function f\u0061() { return \u{61}b; } l\u{6f}ose = 2; let \u0063 = 3;"], "[ab, fa(), loose, c]", [1, 1, 2, 3]),
    ],
)  # fmt: skip
def test_what_a_script_declares_is_a_variable_of_its_scope(
    scripts: list[str], code: str, value: object
) -> None:
    scopes = Scopes()
    scopes.run(*scripts)
    assert scopes.value(code) == value


def test_names_in_our_own_code_are_free_for_documents() -> None:
    scopes = Scopes()
    names = ["$n", "$s", "$v", "$into$", "last"]
    for name in names:
        scopes.engine.assign(scopes.document, name, "1", scopes.all)
    scopes.run("function f() { return $v + $n + $s + $into$; }")
    assert scopes.value("[f(), $v + $n + $s + $into$]") == [4, 4]
    assert scopes.value("Object.keys(document)") == [*names, "f"]


@pytest.mark.parametrize(
    "code", ["arguments", "arguments[1]", "(() => arguments)()", "eval('arguments')"]
)
def test_an_expression_has_no_arguments(code: str) -> None:
    """It is code of its scope: the function of ours around it does not show."""
    scopes = Scopes()
    for evaluate in (scopes.engine.value, scopes.engine.condition):
        with pytest.raises(ScriptError, match="arguments is not defined"):
            evaluate(code, scopes.all)


@pytest.mark.parametrize(
    "code",
    [
        "y = 1",
        "0 || (y = 1)",
        "(() => { y = 1; })()",
        "[x, y] = [1, 2]",
        "y ||= 1",
        "y &&= 1",
        "y++",
    ],
)
def test_an_expression_cannot_assign_what_nobody_declares(code: str) -> None:
    """It has no scope of its own in which that could become a variable."""
    scopes = Scopes()
    scopes.run("var x = 0;")
    engine = scopes.engine
    for evaluate in (
        engine.value,
        engine.condition,
        lambda *one: engine.assign_declared("x", *one),
    ):
        with pytest.raises(ScriptError, match="ReferenceError: y is not defined"):
            evaluate(code, scopes.all)
    with pytest.raises(ScriptError, match="ReferenceError: y is not defined"):
        engine.assign(scopes.document, "z", code, scopes.all)
    assert "y" in expression_names(code).free or "y" in expression_names(code).changed
    scopes.run("var y = 0;")
    scopes.value(code)
    assert scopes.value("typeof y") == "number"


def test_what_an_expression_assigns_may_stay_within_it() -> None:
    scopes = Scopes()
    assert scopes.value("(function () { var y; y = 1; return y; })()") == 1
    assert scopes.value("typeof y === 'undefined' ? 2 : (y = 3)") == 2
    assert scopes.value("(document.y = 4, y = y + 1)") == 5


def test_functions_see_what_becomes_of_their_scripts_variables() -> None:
    scopes = Scopes()
    scopes.run("var lang = 'en'; function greet() { return lang; }")
    scopes.engine.assign_declared("lang", "'ja'", scopes.all)
    assert scopes.value("greet()") == "ja"
    scopes.engine.unset(scopes.document, "lang")
    assert scopes.value("greet()") is None


def test_what_a_script_declares_hides_what_is_further_out() -> None:
    scopes = Scopes()
    application = scopes.all[SCOPES.index("application")]
    scopes.engine.set(application, "n", 1)
    scopes.run("var n = 2;")
    assert scopes.value("[n, application.n]") == [2, 1]
    scopes.run("function f() { var m = 3; return m; }")
    scopes.engine.set(application, "m", 4)
    scopes.run("f();")
    assert scopes.value("'m' in document") is False


def test_a_scope_does_not_list_itself() -> None:
    scopes = Scopes()
    scopes.run("var a = 1, all = []; for (var name in document) all.push(name);")
    assert scopes.value("all") == ["a", "all", "name"]
    assert scopes.value("JSON.stringify(dialog)") == "{}"
    assert scopes.value("dialog.dialog === dialog") is True


def test_variables_of_a_scope_are_kept_by_its_owner_as_well() -> None:
    scopes = Scopes()
    scopes.engine.set(scopes.document, "a", 1)
    scopes.engine.unset(scopes.document, "b")
    scopes.engine.assign(scopes.document, "c", "3", scopes.all)
    assert scopes.value("[delete a, delete b, delete document.c]") == [False] * 3
    assert scopes.value("[a, 'b' in document, c]") == [1, True, 3]


def test_what_was_declared_before_an_error_is_there() -> None:
    scopes = Scopes()
    with pytest.raises(ScriptError) as caught:
        scopes.run("var a = 1; function f() { return 3; }\nfunction g() {} class K {}   nope();")
    assert (caught.value.line, caught.value.column) == (2, 30)
    assert scopes.value("[a, f(), typeof K]") == [1, 3, "function"]


def test_what_a_pattern_declared_before_an_error_is_there() -> None:  # ECMA-262, 14.3.3
    scopes = Scopes()
    scopes.run("var a = 0; function f() { return a; }")
    with pytest.raises(ScriptError) as caught:
        scopes.run("var [a] = [1], {b} = {b: f()};\n  nope();")
    assert (caught.value.line, caught.value.column) == (2, 3)
    assert scopes.value("[a, b, f()]") == [1, 1, 1]


def test_a_script_keeps_its_lines() -> None:
    code = "var a = 1, b\n(f)\nfunction f(x) { var c }\n  async function g() {}\nfunction* h() {}"
    script = hoisted(code)
    assert script is not None
    assert script.code == (
        "    a = 1, b;\n(f)\nfunction f$_(x) { var c }\n  async function g$_() {}\nfunction* h$_() {}"
    )
    assert (script.variables, script.functions) == (["a", "b", "f", "g", "h"], ["f", "g", "h"])


def test_code_that_seems_to_be_a_text_stays_within_its_function() -> None:
    """A template that is misread must not become code of ours."""
    scopes = Scopes()
    code = "if(0)/`/;\n`\nfunction f{ `; `+'`;'}`;})()}});Array.prototype.EVIL=5;(function(){{(function(){//'`"
    with contextlib.suppress(ScriptError):
        scopes.run(code)
    assert scopes.value("[].EVIL === undefined") is True


def work(code: str) -> int:
    """Steps that it takes to look through a script."""
    return steps(lambda: (hoisted(code), script_names(code)))


@pytest.mark.parametrize(
    "line",
    ["v{n} = {n};", "var v{n} = /a/", "o.class = {n};", "function f{n}() {{ var i; return {n}; }}"],
    ids=["assigned", "without semicolons", "members", "functions"],
)
def test_the_work_for_a_script_grows_with_its_length(line: str) -> None:
    short, long = (
        "var o = {};" + "\n".join(line.format(n=n) for n in range(count)) for count in (50, 600)
    )
    assert work(long) < 13 * work(short)


def test_thousands_of_variables_are_no_reason_to_end() -> None:
    scopes = Scopes()
    scopes.run("\n".join(f"v{n} = {n};" for n in range(6000)))
    assert scopes.value("v5999") == 5999


@pytest.mark.parametrize(
    ("code", "texts"),
    [
        ("'#a'", ["#a"]),
        ("( '#a' )", ["#a"]),
        ("x ? '#a' : (y ? '#b' : '#c')", ["#a", "#b", "#c"]),
        ("x ? y ? '#a' : '#b' : '#a'", ["#a", "#b"]),
        ("f('?')['x'] ? '#a' : next", ["#a", "..."]),
        ("'#s' + n.x[1] + 'a'", ["#s..."]),
        ("x ? '#a' : '#s' + (n ? 1 : 2)", ["#a", "#s..."]),
        *((one, ["..."]) for one in ("", "next", "f('a')", "'a' == b", "'a' + b == c", "x || 'a'")),
        *((one, ["..."]) for one in ("a ? 'b' :", "'x'.length", "('a', 'b')", "var a = 1; 'x'")),
        *((one, ["..."]) for one in (r"'\u0061'", "(x ? 'a' : 'b') + 'c'", "`a${b}`")),
        ("x ? " * 300 + "'a'" + " : 'b'" * 300, ["a", "b"]),
    ],
)
def test_the_texts_that_an_expression_may_give(code: str, texts: list[str]) -> None:
    assert [one.text + "..." * (not one.whole) for one in choices(code)] == texts
