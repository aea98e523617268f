"""Expressions evaluated in Python have the value that the ECMAScript engine gives them."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prima.interpreter.pyengine import MOST_HELD, PythonEngine, is_python
from prima.interpreter.reader import read_document
from prima.script import compile as compiling
from prima.script.compile import compiled
from prima.script.ecmascript import CONSTANTS
from prima.script.engine import Engine
from prima.script.evaluation import SCOPES, ScriptError
from prima.script.globals import BUILT_IN, INHERITED, METHODS, STRANGE, VARIABLES
from prima.script.isolated import Engines

ENGINE = Engine()
VALUES: dict[str, Any] = {
    "n": 3,
    "half": 0.5,
    "big": 2**40,
    "t": "four",
    "digits": " 12 ",
    "empty": "",
    "smile": "a😀z",
    "yes": True,
    "no": False,
    "nil": None,
    "list": [1, "b", None, [2, 3]],
    "o": {"t": "x", "10": 1, "2": {"deep": [0.25]}, "n": None, "length": 7},
}


def scopes_of(engine: Any) -> tuple[Any, ...]:
    """Scopes with the same variables in either evaluator; some hide others, one is undefined."""
    made = (
        engine.named("application"),
        engine.named("document"),
        engine.named("dialog"),
        engine.event("touch.head", "m", {"n": 9}),
    )
    for index, (name, value) in enumerate(VALUES.items()):
        engine.set(made[index % 3], name, value)
    engine.set(made[0], "n", 99)
    engine.set(made[2], "t", "hidden")
    engine.unset(made[1], "u")
    engine.clock(made[0], 1.5)
    return made


def outcome(act: Any) -> Any:
    """What an evaluation gives, or how it fails."""
    try:
        found = act()
    except ScriptError as error:
        # The engine tells a place of its own for what an operator does with a whole value.
        own = "circular" in str(error) or "toPrimitive" in str(error)
        return "fails", str(error), None if own else (error.line, error.column)
    if isinstance(found, float) and math.isnan(found):
        return "nan"
    return type(found).__name__, found


def both(code: str) -> None:
    """An expression gives the same in both, as data, as text and as a condition."""
    assert compiled(code) is not None, f"{code} is left to the engine"
    for method in ("value", "text", "condition"):
        found = []
        for engine in (PythonEngine(), ENGINE):
            scopes = scopes_of(engine)
            found.append(outcome(lambda: getattr(engine, method)(code, scopes)))  # noqa: B023
        assert found[0] == found[1], (code, method)


NAMES = [*VALUES, "u", "missing", "undefined", "NaN", "Infinity", "document", "dialog", "event"]
LITERALS = [
    *("0", "1", "2.50", ".5", "3.", "1e3", "1e21", "1e-7", "123456789012345680000", "4294967296"),
    *("'four'", '"x"', "''", "' 0x1F '", "'1e2'", "'Infinity'", r"'it\'s\n\\'", "true", "false"),
    *("null", "[]", "[1, -2, 'a', null]", "{}", "{a: 1, 'b': 'c', n: true}", "'😀'"),
    *("[[1, ['a']], {b: [-2]}]", "{t: {n: [1, 2]}, '': []}"),
]
MEMBERS = [
    ".t",
    ".n",
    ".length",
    "[0]",
    "[1]",
    "[3]",
    "?.t",
    "?.[1]",
    "?.n",
    "['t']",
    "['2']",
    '["10"]',
    "[1.5]",
    ".deep",
    "[n]",
    "[t]",
    "[u]",
    "[o.t]",
    "[list]",
    "[digits * 1]",
    "?.[half]",
    "[yes ? 't' : 'n']",
]
OPERATORS = [
    *("+", "-", "*", "/", "%", "<", ">", "<=", ">=", "==", "!=", "===", "!==", "&&", "||", "in"),
]


def codes() -> st.SearchStrategy[str]:
    """Expressions of all that is compiled."""
    leaves = st.sampled_from(NAMES) | st.sampled_from(LITERALS)

    def grow(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        inside = inner.map(lambda code: f"({code})")
        operand = leaves.filter(lambda code: code[0] != "{") | inside
        return st.one_of(
            st.builds("{} {} {}".format, operand, st.sampled_from(OPERATORS), operand),
            st.builds("{}{}".format, st.sampled_from(["!", "-", "+", "typeof "]), operand),
            st.builds("{} ? {} : {}".format, operand, operand, operand),
            st.builds("{}{}".format, st.sampled_from(NAMES) | inside, st.sampled_from(MEMBERS)),
            st.builds(
                "{} {} {} {} {}".format,
                operand,
                st.sampled_from(OPERATORS),
                operand,
                st.sampled_from(OPERATORS),
                operand,
            ),
            st.builds(
                "{}({})".format,
                st.sampled_from(["Number", "String", "Boolean"]),
                st.sampled_from(
                    [
                        *(one for one in NAMES if one != "undefined"),
                        "o.t",
                        "o?.t",
                        "list[n]",
                        "event.data.n",
                        "nil.x",
                        "o[t].x",
                    ]
                ),
            ),
            st.builds("{}\n {} {}".format, operand, st.sampled_from(OPERATORS), operand),
        )

    return st.recursive(leaves, grow, max_leaves=8)


@given(codes())
def test_both_evaluators_agree(code: str) -> None:
    both(code)


@pytest.mark.parametrize(
    "code",
    [
        "n?.5:1", "typeof missing", "typeof missing.x", "typeof sensor", "typeof NaN", "typeof undefined", "typeof event", "typeof true", "typeof (missing)", "typeof u", "typeof nil", "typeof o", "typeof yes", "typeof typeof n", "smile.length", "smile[1]", "smile[2]",
        "smile[1] + smile[2]", "(n ? (n.t) : (n\n + n)).t", "((n\n + n).t).t", "(n ? n\n + 1 : n).t.t", "(!(n\n + n)).t.t", "(-(n\n + n)).t.t", "(n\n && u).t", "o?.t", "nil?.x", "u?.x.y.z", "o.q?.x", "o?.q.x", "missing?.x", "o?.['t']", "list?.[0]", "u?.['t'].x", "o.q?.x?.y.z",
        "o?.['2'].deep[0]", "(u?.x).y", "typeof u?.x", "o.n?.length < 3", "o?.t?.length + 1", "!o?.q?.x", "nil?.x ? 1 : 2", "smile[1] + 'x'", "'a' < smile", "'\uff61' < smile", "o", "document", "list", "list + list", "o + 1", "n + document", "+document", "document == '[object Object]'", "list == document", "document == list", "[] == []", "['[object Object]'] == {}",
        "o == '[object Object]'", "list == '1,b,,2,3'", "nil == u", "nil == 0", "u == 0", "nil >= 0", "'10' < '9'", "'10' < 9", "digits * 1",
        "' ' == 0", "'abc' * 1", "-digits", "+nil", "+u", "+list", "+[]", "+[7]", "n % 0", "-n % 3", "n / 0", "-n / 0", "0 / 0",
        "n / -0", "-0", "0 * -1", "1e308 * 10", "9007199254740993", "0.1 + 0.2", "event.name", "event.data.n + 1", "_event", "_message", "session.time",
        "dialog.n", "application.n", "document.half", "missing", "u.x", "nil.x", "o.q.x", "n.x", "yes.x", "o[ 't' ]", "n ? yes : no ? 1 : 2", "!n || !u && yes",
        "'' || 'b'", "0 && n", "(n)", "((n + 1)) * 2", "'a\\tb'", "1 - - 1", "[1] == 1", "[[1]] + ''".replace("[[1]]", "list"), "'1' == 1.0", "true == 1", "true == '1'", "'0x10' * 1", "'+0x10' * 1",
        "list[n]", "list [ n - 2 ] [ 0 ]", "nil[n + n]", "(nil)[t]", "o.q[ (t) ]", "u[\nt\n][n]", "o[n][t]", "nil[list]", "nil[o]", "missing[n]", "list[missing]", "o.q?.[missing]", "list[-0]",
        "t[1 - 1]", "smile[1 + 1]", "o['1' + '0']", "n[t]", "yes[t]", "[[1]][0][0]", "{a: [1]}['a' + ''][0]", "o['le' + 'ngth']", "dialog['dia' + 'log'] == dialog", "dialog[t]", "document[missing]",
        "'t' in o", "n in list", "3 in list", "4 in list", "'length' in list", "u in o", "2 in o", "'n' in n", "nil in nil", "t  in   t", "'x' in missing", "missing in o", "'n' in dialog", "'dialog' in dialog",
        "Number(digits)", "Number(t).x.y", "String ( n ).x.y", "Boolean(n).x.y", "Number(o)", "String(o)", "Number(list)", "Number(missing)", "String(u)", "String(nil)", "Boolean(empty)", "typeof Number(n)",
        "nil[Number(n)]", "Number(n) in n", "n + n in (Number(n))", "-Number(digits)", "Number(\nn).x.y", "String(document)", "Number(n) + String(n)",
        "'-5' * 1", "'.5' * 1", "'5.' * 1", "'.' * 1", "'1_0' * 1", "'１' * 1", "'\u3000 7\ufeff' * 1", "'0b11' * 1", "1e5", "12345678.125", "1e-6", "1.5e-7", "-1e21", "1e300",
    ],
)  # fmt: skip
def test_an_expression_means_the_same(code: str) -> None:
    both(code)


@pytest.mark.parametrize(
    "code",
    [
        *("Number()", "Number(n, 1)", "Number(...list)", "Number", "new Number(n)", "o.Number(1)"),
        *("Number?.(n)", "Number(true)", "String('')", "Number((n))", "Number(n + n)", "(Number)(n)", "Number(n)(n)", "Number(n = 1)", "Number`1`", "Symbol(n)"),
        *("f()", "n = 1", "n += 1", "n++", "--n", "a, b", "x => x", "`${n}`", "/a/", "n & 1", "n | 1"),
        *("n ** 2", "n << 1", "n >> 1", "~n", "a ?? b", "a?.()", "a?.b()", "a?.", "a?.toString", "new X", "this", "[...a]", "[-[1]]"),
        *("o['a\nb']", "nil['\xa0']", "n\u2028 + t"),
        *("o.toString", "o.constructor", "o['__proto__']", "list.map", "t.trim", "toString", "Math"),
        *("Math.max", "list[n = 1]", "[n]", "[[n]]", "{a: {b: n}}", "f() in o", "list[f()]", "{a: n}", "{n}", "{2: 1}", "'\\u0041'", "'\\x41'", "08", "0x1F"),
        *("1_000", "10n", "1.toString", "n // x", "n /* x */", "n <!-- x", "(n", "n)", "", " ", "n n"),
        *("'open", "n..x", "n.1", "void 0", "delete n", "async", "let", "class", "arguments", "é", "n;"),
        "+".join(["n"] * 200), "(" * 150 + "n" + ")" * 150, "n" * 2000,
    ],
)  # fmt: skip
def test_what_may_mean_more_is_left_to_the_engine(code: str) -> None:
    assert compiled(code) is None


@pytest.mark.parametrize(
    "text",
    [
        *("it's", '"""', "'''", "{}", "{0}", "%s", "\\", "x\\", "\\'", "', __import__('os'), '"),
        *(
            "#",
            "v1",
            "scopes",
            "\u2028",
            "\ud800",
            "😀",
            "\\n",
            "{v1}",
            "\x00",
            "\x7f",
            "a\tb",
            '"',
        ),
    ],
)
def test_no_text_becomes_code(text: str) -> None:
    """A text means itself, whatever it would be as code."""
    inside = text.replace("\\", "\\\\").replace('"', '\\"')
    literals = (f'"{inside}"', f't + "{inside}"', f'["{inside}"]', f'{{"k": "{inside}"}}')
    for code in literals:
        found = compiled(code)
        if found is None:
            assert {"\\", "\0"} & {*inside}, "only what is escaped may be left to the engine"
            continue
        value = found.call(scopes_of(PythonEngine()))
        assert value in (text, f"hidden{text}", [text], {"k": text})


def test_the_engines_own_names_are_known() -> None:
    scopes = scopes_of(ENGINE)
    every = ENGINE.value("Object.getOwnPropertyNames(globalThis)", scopes)
    own = {name for name in every if STRANGE not in name}
    assert own <= BUILT_IN | CONSTANTS.keys() | VARIABLES
    for value in ("{}", "[]", "''", "0", "true"):
        code = f"Object.getOwnPropertyNames(Object.getPrototypeOf({value}))"
        assert set(ENGINE.value(code, scopes)) <= INHERITED | METHODS | {"length"}


def test_deep_brackets_are_no_trouble() -> None:
    code = "(" * 90 + "n" + ")" * 90
    both(code)


def test_texts_do_not_grow_without_end() -> None:
    engine = PythonEngine()
    scopes = (
        engine.scope(),
        engine.scope({"s": "x" * 60_000}),
        engine.named("dialog"),
        engine.scope(),
    )
    with pytest.raises(ScriptError, match="memory"):
        engine.value("s + s", scopes)
    with pytest.raises(ScriptError, match="memory"):
        for index in range(200):
            engine.assign(scopes[1], f"v{index}", f"s + {index}", scopes)
    assert sum(len(value) for value in scopes[1].values()) < 3 * MOST_HELD
    engine.assign(scopes[1], "w", "'short'", scopes)


def test_long_texts_that_are_gone_count_no_more() -> None:
    engine = PythonEngine()
    document = engine.scope({"s": "x" * 60_000})
    for index in range(500):
        scopes = (engine.scope(), document, engine.named("dialog"), engine.scope())
        engine.assign(scopes[2], "v", f"s + {index}", scopes)
        engine.assign(document, "last", "v", scopes)


def test_assignments_reach_the_innermost_variable() -> None:
    engine = PythonEngine()
    scopes = (
        engine.scope({"n": 0}),
        engine.scope({"n": 1}),
        engine.named("dialog"),
        engine.scope(),
    )
    engine.assign_declared("n", "n + 10", scopes)
    engine.assign_declared("application.n", "n + 100", scopes)
    assert [engine.value("n", (scope,) * 4) for scope in scopes[:2]] == [111, 11]
    with pytest.raises(ScriptError, match='the variable "m" is not declared'):
        engine.assign_declared("m", "1", scopes)
    with pytest.raises(ScriptError, match=r'the variable "dialog\.n" is not declared'):
        engine.assign_declared("dialog.n", "1", scopes)


def test_values_from_outside_are_copies() -> None:
    engine, data = PythonEngine(), {"rooms": [1, 2]}
    scope = engine.event("message", "", data)
    data["rooms"].append(3)
    assert engine.value("event", (scope,) * 4) == {
        "name": "message",
        "message": "",
        "data": {"rooms": [1, 2]},
    }


@pytest.mark.parametrize(
    "code",
    [
        *('o["²"]', "o['٣']", "'0x" + "f" * 300 + "' * 1", "'0o" + "7" * 400 + "' * 1"),
        *("'0x" + "123456789abcdef" * 3 + "' * 1", "'" + "9" * 400 + "' * 1", "9" * 400),
        *("o[4294967295]", "list[4294967296]", "list['00']", "smile[1e400]", "t[99999999999999999999]"),
        "!" * 90 + "n", "- " * 60 + "n", "n ? " * 45 + "n" + " : 2" * 45,
    ],
)  # fmt: skip
def test_odd_numbers_and_names_mean_the_same(code: str) -> None:
    both(code)


@pytest.mark.parametrize(
    "code",
    ["'a\\\u2028b'", "'a\\\u2029b'", "(" * 200, "[" * 200, "-(" * 100, "!" * 200, "'a" * 200],
)
def test_what_is_too_deep_or_too_odd_is_left_to_the_engine(code: str) -> None:
    assert compiled(code) is None


ODD_DATA: list[Any] = [
    *({"²": 1, "٣": 2, "0": 3}, {"1" * 5000: 1, "b": 2}, {"toString": 1}, {"valueOf": 1}),
    *({"99999999999": 1, "2147483648": 2, "b": 0, "2147483647": 3, "-1": 4, "01": 5, "1.5": 6},),
    *({"__proto__": {"x": 1}}, {"toJSON": 1}, {"length": "x"}, {"\ud800": "\udc00"}, {"": {"": 0}}),
    *({"x": math.nan, "n": math.inf}, {"x": [{"__proto__": -math.inf}], "n": "NaN"}),
    *({"x": 10**400, "n": -(10**400)}, {"x": -0.0, "n": 2**53 + 1}, {"x": "\x7f", "n": "\u2028"}),
]
ODD_CODES = [
    *("o", "o + ''", "o - 1", "o == 1", "o < 'x'", "+o", "o.x", "1 / o.x", "o.n + o.x", "o.length", "l"),
    *("l + ''", "l - 1", "l == ','", "l < o", "[1] + l", "o['1.5'] + o['-1']", "typeof o.x", "o == o"),
]  # fmt: skip


@pytest.mark.parametrize(
    "code",
    [
        *("null.x", "n ? null.x : 1", "(n +  (t)).x.y", "n +\n (1).x.y", "(o.t +  'a').x.y", "'é' - missing"),
        *("(n  ==  t).x.y", "(t + n * 2).x.y", "(typeof  n).x.y", "n && [].x.y", "('é' + u).x.y", "-- missing"),
        *("'😀' +\n'é' + u.x", "!missing", "(n < u) || null.x", "1['a'].b", "-(n ? missing : 1)"),
    ],
)  # fmt: skip
def test_errors_have_the_same_line_and_column(code: str) -> None:
    if compiled(code) is not None:
        both(code)
    scopes = scopes_of(ENGINE)
    told = {outcome(lambda: getattr(ENGINE, name)(code, scopes)) for name in ("value", "condition")}  # noqa: B023
    told.add(outcome(lambda: ENGINE.assign(scopes[3], "x", code, scopes)))
    assert len(told) == 1


@pytest.mark.parametrize(
    "data",
    ["\ud83d", "\ud83d\ude00", "\ude00\ud83d", {"\ud83d": "\ude00"}, ["\ud83d\ude00"], {"a": ["\ud83d"]}],
)  # fmt: skip
@pytest.mark.parametrize(
    "code", ["o", "o == '😀'", "o[0] == '😀'", "o == '\ufffd'", "o.length", "o.a + 'x'", "o == event.data"]
)  # fmt: skip
def test_halves_of_letters_from_outside_mean_the_same(data: Any, code: str) -> None:
    found = []
    for engine in (PythonEngine(), ENGINE):
        scopes: Any = (*scopes_of(engine)[:3], engine.event("message", "a\ud83d", data))
        engine.set(scopes[2], "o", data)
        found.append([outcome(lambda: engine.value(one, scopes)) for one in (code, "_message")])  # noqa: B023
    assert found[0] == found[1]


@pytest.mark.parametrize("code", ODD_CODES)
@pytest.mark.parametrize("data", ODD_DATA, ids=range(len(ODD_DATA)))
def test_odd_data_means_the_same(data: Any, code: str) -> None:
    for method in ("value", "text", "condition"):
        found = []
        for engine in (PythonEngine(), ENGINE):
            scopes = scopes_of(engine)
            engine.set(scopes[2], "o", data)
            engine.set(scopes[2], "l", [data, [data]])
            one = outcome(lambda: getattr(engine, method)(code, scopes))  # noqa: B023
            found.append(one[:2] if one[0] == "fails" else one)
        assert found[0] == found[1]


class Word(str):
    """A kind of text."""

    __slots__ = ()


def test_kinds_of_numbers_and_texts_are_numbers_and_texts() -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[2], "o", {"word": Word("four"), "whole": 10**400, "yes": True})
    assert engine.condition("o.word === 'four' && o.whole === Infinity && o.yes === true", scopes)


@pytest.mark.parametrize("engine", [PythonEngine(), ENGINE], ids=["plain", "engine"])
@pytest.mark.parametrize("depth", [150, 900, 20_000])
def test_data_too_deep_is_an_error_of_its_own(engine: Any, depth: int) -> None:
    scopes = scopes_of(engine)
    data: Any = []
    for _ in range(depth):
        data = [data]
    try:
        engine.set(scopes[2], "deep", data)
        engine.text("deep + ''", scopes)
        engine.value("deep", scopes)
    except ScriptError:
        pass


def test_long_texts_do_not_take_long_again_and_again() -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[1], "a", "é" * 99_999)
    engine.set(scopes[1], "b", "é" * 99_999)
    with pytest.raises(ScriptError, match="too long"):
        for _ in range(1000):
            engine.condition(" && ".join(["a <= b"] * 49), scopes)
    assert engine.spent > 0
    engine.spent = 0.0
    engine.condition("a <= b", scopes)


@pytest.mark.parametrize(
    "code", ["a == b", "a != 1", "1 == a", "a + ''", "+a", "a * 1", "a[9]", "a < b", "a.length"]
)
def test_work_with_long_texts_is_counted(code: str) -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)
    engine.set(scopes[1], "a", "é" * 5_000)
    engine.set(scopes[1], "b", "é" * 5_000)
    engine.value(code, scopes)
    assert engine.spent > 0


def test_a_variable_that_would_be_too_much_is_not_kept() -> None:
    engine = PythonEngine()
    scopes = scopes_of(engine)

    def assign_declared(_scope: Any, name: str, code: str, scopes: Any) -> None:
        engine.assign_declared(name, code, scopes)

    engine.set(scopes[1], "s", "x" * 60_000)
    for index in range(200):
        engine.unset(scopes[1], f"v{index}")
        for give in (engine.assign, assign_declared):
            try:
                give(scopes[1], f"v{index}", f"s + {index}", scopes)
            except ScriptError:
                engine.spent = 0.0
    held = sum(len(value) for value in scopes[1].values() if isinstance(value, str))
    assert held < MOST_HELD + 200_000


def test_compiled_code_does_not_grow_without_end() -> None:
    for index in range(1000):
        assert compiled("+".join(["a", *["b"] * 98, str(index)])) is not None
    kept = compiling._Cache.expressions.values()
    assert sum(one.pieces for one in kept if one is not None) <= compiling.MOST_KEPT
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><var name="b"/><form id="f">'
    logs = "".join(f'<log><value expr="{"b+" * 98}{index}"/></log>' for index in range(600))
    text = f"{head}<block>{logs}</block></form></prima>"
    document, problems = read_document("a.xml", text.encode())
    assert not [one for one in problems if one.severity == "error"]
    assert not is_python(document), "so much code is compiled only where it is run"


@pytest.mark.parametrize(
    "code",
    [
        "(s[1] + s[2]) == '😀'", "s[1] + s[2] + s[0]", "s[2] + s[1]", "document.document == document",
        "document.document.document.t", "dialog.dialog.dialog == application.application", "z", "z.length",
        "z + z", "odd", "marked", "z == 'a'",
    ],
)  # fmt: skip
def test_values_mean_the_same_whoever_has_them(code: str) -> None:
    """Halves of letters, scopes in themselves, and texts that hold NUL."""
    outside = {
        "s": "a😀",
        "z": "a\0b",
        "t": 1,
        "odd": {"\0": "NaN", "k\0": 1},
        "marked": {"\0": "x"},
    }
    found = []
    for how in ("plain", "none", "all"):
        engine = PythonEngine() if how == "plain" else Engines(how).engine("a", "ea")
        scopes: Any = (*map(engine.named, SCOPES[:3]), engine.scope())
        for name, value in outside.items():
            engine.set(scopes[1], name, value)
        found.append((engine.value(code, scopes), engine.text(code, scopes)))
    assert found[0] == found[1] == found[2]
