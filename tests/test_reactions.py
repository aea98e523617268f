"""What an event does is the same, whether it is written as a function or found anew each time."""

from __future__ import annotations

import pickle
from copy import deepcopy
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prima.commands import TABLE_4_2
from prima.interpreter import handling, reactions
from prima.interpreter.application import Interpreter
from prima.interpreter.handling import known_of
from prima.interpreter.reader import read_document
from prima.messages import Loaded, Occurred, Sensed
from prima.scheduler.selection import Policy
from prima.session import Session

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">'
NAMES = ["n", "n", "t", "d", "l", "i", "dialog.d"]
CODES = [
    *("n + 1", "n - d", "t + n", "d", "'x'", "missing", "t.x.y", "!n", "n / 0", "[1, 2]", "l", "i"),
    *("typeof l", "n &lt; 3", "t == 'x'", "d === 2", "n % 2 == 0", "event.name", "event.data.k"),
    *("t + t + t + t + t + t", "sensor.touch.head", "undefined", "{k: 1}", "-n * 2", "n ? d : t"),
]
SCRIPTED = [
    *("next(n)", "next(next(n)) + calls", "(t + n).length", "JSON.stringify(o)", "o.x", "next"),
    *(
        "new Date().getTime()",
        "Object.keys(document).length",
        "hasOwnProperty('n')",
        "next(dialog)",
    ),
    *("missing()", "next(n).x.y", "typeof k", "dialog.k", "z", "n++ + n", "[n, d].concat(l)"),
    *("event.name + next(n)", "p + 1", "this === undefined", "eval('n + 1')", "(k = n)"),
]
"""Code that needs an engine."""
SCRIPTS = [
    *(
        "var z = n; n = z + 1;",
        "n = next(n);",
        "dialog.k = n;",
        "loose = n;",
        "throw n;",
        "o.x = n;",
    ),
    *("function next(x) { return x + 2; }", "n = missing.x;", "l = function () { return n; };"),
    "document.n = n + 1;",
]
CONDITIONS = [
    *(
        "true",
        "n % 2 == 0",
        "d &lt; 3",
        "t == 'x'",
        "l",
        "n != 1 &amp;&amp; t",
        "!l || d",
        "n &gt; d",
    ),
    *("typeof l != 'number'", "event.name == 'go'", "l.x.y"),
]
SHOWN = '<log>{}<value expr="n"/> <value expr="t"/> <value expr="d"/> <value expr="l"/></log>'
LEAVES = [
    *(f'<goto next="#f{form}"/>' for form in "abc"),
    *(f'<var name="{name}" expr="{code}"/>' for name in "lt" for code in CODES[:4]),
    '<var name="l"/>', '<throw event="own.one"/>', '<throw event="error.own" message="m"/>',
    "<reprompt/>", '<clear namelist="q"/>', '<clear namelist="d"/>', '<goto nextitem="q"/>',
    '<send event="later" delay="1s"/>', '<goto next-expr="\'#f\' + t"/>', SHOWN.format("here: "),
    '<if cond="n &gt; 9"><exit/></if>', '<if cond="n &gt; 7"><return namelist="n"/></if>',
]  # fmt: skip


class Some(Random):
    """Chance, which leaves out all that certain words stand in."""

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        words = [word for word in ("dialog", "event", "Date", "eval") if self.random() < 0.6]
        self.without = words if self.random() < 0.8 else []
        self.simple = self.random() < 0.5
        """Whether states only wait, and little is done in them."""

    def one(self, *lists: list[str]) -> str:
        """One of the texts of some list."""
        given = [one for one in self.choice(lists) if not any(word in one for word in self.without)]
        return self.choice(given)


def code_of(some: Some, scripted: bool) -> str:
    """An expression."""
    return some.one(CODES, SCRIPTED) if scripted else some.one(CODES)


def contents(some: Some, scripted: bool, depth: int = 0) -> str:
    """Content in which no Command stands."""
    made = []
    for _ in range(some.randint(1, 1 if some.simple else 4 - depth)):
        kind = some.random() if depth < 2 else 1
        if some.simple:
            kind = some.choice([0.3, 0.6, 0.6, 0.6, 0.9])
        inner = [contents(some, scripted, depth + 1) for _ in range(3)] if kind < 0.4 else []
        conds = [some.one(CONDITIONS) for _ in range(2)]
        if scripted and some.random() < 0.1:
            made.append(f"<script>{some.one(SCRIPTS)}</script>")
        if kind < 0.1:
            made.append(f'<foreach item="i" array="[1, \'b\']">{inner[0]}</foreach>')
        elif kind < 0.25:
            made.append(f'<if cond="{conds[0]}">{inner[0]}<else/>{inner[1]}</if>')
        elif kind < 0.4:
            more = f'<elseif cond="{conds[1]}"/>{inner[1]}<else/>{inner[2]}'
            made.append(f'<if cond="{conds[0]}">{inner[0]}{more}</if>')
        elif kind < 0.8 or depth == 2:
            name = some.one([*NAMES, "o.x", "p"] if scripted else NAMES)
            made.append(f'<assign name="{name}" expr="{code_of(some, scripted)}"/>')
        else:
            made.append(some.one(LEAVES))
    return "".join(made)


def handler(some: Some, scripted: bool) -> str:
    """A handler of one of a few events."""
    event = some.choice(["go", "go", "go", "go.on", "own", "error", "go own.one"])
    cond = f' cond="{some.one(CONDITIONS)}"' if some.random() < 0.5 else ""
    if scripted and some.random() < 0.2:
        cond = f' cond="{code_of(some, True)}"'
    reactive = ' reactive="false"' if some.random() < 0.1 else ""
    shown = SHOWN.format("")
    first, second = (contents(some, scripted) for _ in range(2))
    if some.simple:
        second = some.choice(["", *LEAVES[:3]])
    return f'<on event="{event}"{cond}{reactive}>{first}{shown}{second}</on>'


ITEMS = [
    *("", "", '<var name="d" expr="2"/>', '<var name="l" expr="\'y\'"/>'),
    '<field name="q"><prompt>Well?</prompt><option>yes</option></field>',
    "<block><speak>Hello.</speak></block>",
]


CALLED = """<form id="s">{}<subdialog name="sub" src="#called"><param name="p" expr="n"/></subdialog>
</form><form id="called">{}</form>"""
SCRIPT = """<script>var calls = 0, o = {x: 1};
function next(x) { calls = calls + 1; return x + 1; }</script>"""


def document_text(some: Some, scripted: bool = False) -> str:
    """A document with three forms, of which some only wait, and perhaps a subdialog."""
    own = handler(some, scripted) if some.random() < 0.5 else ""
    own += f'<on event="error">{SHOWN.format("failed: ")}</on>'
    forms = "".join(
        f'<form id="f{form}">{some.choice(ITEMS[:1] if some.simple else ITEMS)}'
        f"{''.join(handler(some, scripted) for _ in range(some.randint(1, 3)))}</form>"
        for form in "abc"
    )
    if scripted and some.random() < 0.3:
        forms = CALLED.format(handler(some, True), handler(some, True)) + forms
    variables = "".join(
        f'<var name="{name}" expr="{code}"/>'
        for name, code in (("n", "0"), ("t", "'x'"), ("d", "1"), ("l", "undefined"))
    )
    return f"{HEAD}{variables}{SCRIPT if scripted else ''}{own}{forms}</prima>"


EVENTS = ["go", "go.on", "own", "go", "go", "error.outside", "go", "go.on", "go.on", "own", "go"]


def run(text: str, quick: bool) -> tuple[list[Any], list[Any], int]:
    """The records of a run in which events occur, the variables after it, and how many functions."""
    document, problems = read_document("a.xml", f"{text}<!-- {quick} -->".encode())
    errors = {one.code for one in problems if one.severity == "error"}
    allowed = {"undeclared-variable", "no-such-item"}
    assert errors <= allowed, f"only what can be run is of interest: {problems}"
    session = Session([document], Policy(), TABLE_4_2)
    app = session.apps["a"]
    assert isinstance(app, Interpreter)
    assert app.quick
    app.quick = quick
    session.step(0, [Loaded("a")])
    session.step(1, [Sensed({"touch.head": True})])
    for now, name in enumerate(EVENTS, 2):
        session.step(now * 100, [Occurred(name, data={"k": now})])
        due = session.deadline()
        if due is not None and due <= now * 100 + 50:
            session.step(max(due, now * 100), [])
    scopes: list[Any] = []
    for scope in (app.frame.document, app.frame.dialog) if app.frame else ():
        names = [*"ntdlopkz", "calls", "loose"]
        found = {name: app.engine.get(scope, name) for name in names if app.engine.has(scope, name)}
        scopes.append(found)
    kept = sum(
        one is not None
        for form in document.forms.values()
        for one in (form.reactions or {}).values()
    )
    return session.drain(), scopes, kept


@pytest.mark.parametrize("scripted", [False, True])
@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**32))
def test_an_event_does_the_same_as_a_function(scripted: bool, seed: int) -> None:
    text = document_text(Some(seed), scripted)
    often, handling.OFTEN = handling.OFTEN, 1
    try:
        quick, slow = run(text, True), run(text, False)
    finally:
        handling.OFTEN = often
    assert quick[0] == slow[0]
    assert repr(quick[1]) == repr(slow[1])
    assert slow[2] == 0


CALLING = """<form id="s">
<subdialog name="sub" src="#f"><param name="p" expr="3"/></subdialog></form>"""
OTHER = """<form id="g">
<on event="go"><log expr="typeof dialog.k"/><log expr="n"/><goto next="#f"/></on></form>"""
SHOW_N = '<log expr="n"/>'
DEED = '<assign name="n" expr="{}"/>' + SHOW_N


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (DEED.format("hasOwnProperty('n') ? 1 : 2"), ["2"] * 8),
        (DEED.format("next(typeof o.hasOwnProperty === 'function' ? n : 0)"), list("12345678")),
        ("<script>var z = 5;</script>" + DEED.format("next(z)"), ["6"] * 8),
        (
            '<script>dialog.k = n;</script><goto next="#g"/>',
            ["undefined", "0", "undefined", "0"] * 2,
        ),
        ("<script>n = event.data.k;</script>" + SHOW_N, list("12345678")),
        ('<assign name="event.data.k" expr="7"/><log expr="event.data.k"/>', ["7"] * 8),
        ("<script>n = loose; loose = n;</script>" + SHOW_N, ["null"] * 8),
        (DEED.format("next(p)"), ["4"] * 8),
        ('<assign name="p" expr="next(p)"/><log expr="p"/>', [*list("456789"), "10", "11"]),
        (DEED.format("next(sensor.m)"), list("23456789")),
        (DEED.format("next(application.sensor.m)"), list("23456789")),
        (DEED.format("next(dialog.k === undefined ? n : 0)"), list("12345678")),
        ("<script>valueOf().n = 42;</script>" + DEED.format("next(n)"), ["43"] * 8),
        (
            DEED.format("new Date().getTime() - began"),
            [str(100 * number) for number in range(1, 9)],
        ),
    ],
)
@pytest.mark.parametrize("quick", [False, True])
def test_what_scripts_do_is_the_same(quick: bool, content: str, told: list[str]) -> None:
    script = SCRIPT.replace("<script>", "<script>var began = new Date().getTime();")
    text = f"""<!-- {quick} -->{HEAD}{script}<var name="n" expr="0"/><watch name="never" when="sensor.k &lt; 0"/>
{"" if "#g" in content else CALLING}<form id="f"><on event="go">{content}</on></form>
{OTHER if "#g" in content else ""}</prima>"""
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    app = session.apps["a"]
    assert isinstance(app, Interpreter) and app.quick
    app.quick = quick
    assert not document.plain, "it needs an engine"
    session.step(0, [Loaded("a")])
    often, handling.OFTEN = handling.OFTEN, 1
    try:
        for now in range(1, 17):
            session.step(
                now * 50, [Sensed({"m": (now + 1) // 2, **({"k": 1} if now == 1 else {})})]
            )
            if now % 2 == 0:
                session.step(now * 50, [Occurred("go", data={"k": now // 2})])
    finally:
        handling.OFTEN = often
    logs = [one["message"] for one in session.drain() if one["phase"] in ("log", "error")]
    assert logs[:8] == told
    assert bool(document.forms["f"].reactions) == quick


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("deed", ["valueOf().n = 42;", "toString = 1;"])
def test_a_script_puts_nothing_where_nothing_is_declared(deed: str, quick: bool) -> None:
    text = f"""<!-- {quick} -->{HEAD}<var name="n" expr="0"/><script>{deed}</script><form id="f">
<on event="go"><assign name="n" expr="Number(n) + 1"/>{SHOW_N}</on></form></prima>"""
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    app = session.apps["a"]
    assert isinstance(app, Interpreter)
    app.quick = quick
    session.step(0, [Loaded("a")])
    for now in range(1, 8):
        session.step(now, [Occurred("go")])
    assert [one["message"] for one in session.drain() if one["phase"] == "log"] == list("1234567")


def reaction(content: str, form: str = "", before: str = "") -> Any:
    """What an event has become that has happened often."""
    text = f'{HEAD}<var name="n" expr="0"/>{before}<form id="f">{form}<on event="go">{content}</on></form></prima>'
    document, problems = read_document("a.xml", text.encode())
    assert not [one for one in problems if one.severity == "error"]
    session = Session([document], Policy(), TABLE_4_2)
    session.step(0, [Loaded("a")])
    for now in range(1, handling.OFTEN):
        session.step(now, [Occurred("go")])
    assert not document.forms["f"].reactions
    session.step(handling.OFTEN, [Occurred("go")])
    return (document.forms["f"].reactions or {})["go"]


def test_what_happens_often_becomes_a_function() -> None:
    function, given = reaction('<assign name="n" expr="n + 1"/>')
    assert callable(function) and given


@pytest.mark.parametrize(
    ("content", "before"),
    [
        ("<speak>Hello.</speak>", ""),
        ('<assign name="n" expr="n + 1"/>' * (reactions.MOST_ACTS + 1), ""),
        ('<if cond="n">' * 40 + "</if>" * 40, ""),
        ('<assign name="n" expr="n + 1"/>', '<on event="go" count="2"/>'),
    ],
    ids=["Commands", "much", "deep", "counts"],
)
def test_what_is_beyond_it_stays_as_it_is(content: str, before: str) -> None:
    assert reaction(content, before=before) is None


def test_handlers_alike_are_compiled_once() -> None:
    reactions._function.cache_clear()
    for name in "abc":
        assert reaction(f'<log>{name}</log><assign name="n" expr="n + 1"/>') is not None
    assert reactions._function.cache_info().misses == 1


def test_what_many_events_do_is_not_all_kept() -> None:
    text = f'{HEAD}<form id="f"><on event=""><log>it</log></on></form></prima>'
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    session.step(0, [Loaded("a")])
    for now in range(1, 3 * handling.MOST_KEPT):
        session.step(now, [Occurred(f"e{now // 2}")])
    known = known_of(document.forms["f"])
    assert (
        max(len(known.seen), len(document.forms["f"].reactions or {}), len(known.taking))
        <= handling.MOST_KEPT
    )


def test_a_document_that_has_run_can_be_given_to_another_process() -> None:
    text = f'{HEAD}<form id="f"><on event="go"><log>it</log></on></form></prima>'
    document, _ = read_document("a.xml", text.encode())
    for copy in (document, pickle.loads(pickle.dumps(document)), deepcopy(document)):
        session = Session([copy], Policy(), TABLE_4_2)
        session.step(0, [Loaded("a")])
        for now in range(1, 8):
            session.step(now, [Occurred("go")])
        assert copy.forms["f"].reactions
        assert len([one for one in session.drain() if one["phase"] == "log"]) == 7
    assert not pickle.loads(pickle.dumps(document)).forms["f"].reactions


def test_a_state_that_is_left_for_one_alike_is_another_state() -> None:
    text = (
        f'{HEAD}<var name="n" expr="0"/><form id="f"><on event="go"><goto next="#g"/></on></form>'
        '<form id="g"><on event="go"><goto next="#f"/></on><on event="say"><speak>Yes.</speak></on>'
        "</form></prima>"
    )
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    session.step(0, [Loaded("a")])
    for now in range(1, 12):
        session.step(now, [Occurred("go")])
    assert document.forms["f"].reactions and document.forms["g"].reactions
    session.step(20, [Occurred("say")])
    session.step(21, [Occurred("say")])
    asked = [one["state"] for one in session.drain() if one["phase"] == "request"]
    assert len(asked) == 2 and asked[0] == asked[1]
    session.step(30, [Occurred("go")])
    session.step(31, [Occurred("go")])
    session.step(32, [Occurred("say")])
    records = session.drain()
    assert [one["behavior"] for one in records if one["phase"] == "cancel"], "O3: what waits goes"
    assert [one["state"] for one in records if one["phase"] == "request"] == [asked[0] + 2]


def test_an_error_in_it_is_told_with_its_place() -> None:
    text = f"""{HEAD}<var name="n" expr="0"/><form id="f">
<on event="go"><assign name="n" expr="n + 1"/>
<if cond="n &gt; 6"><log>now</log>
<assign name="n" expr="n.x.y"/></if></on>
<on event="error"><log><value expr="event.data.message"/></log></on></form></prima>"""
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    session.step(0, [Loaded("a")])
    for now in range(1, 8):
        session.step(now, [Occurred("go")])
    assert (document.forms["f"].reactions or {})["go"] is not None
    logs = [one["message"] for one in session.drain() if one["phase"] == "log"]
    assert logs == ["now", "a.xml:4:24: n.x.y: TypeError: cannot read property 'y' of undefined"]


def test_a_loop_of_ever_more_content_ends() -> None:
    inner = (
        '<foreach item="i" array="l">' * 4 + '<assign name="n" expr="n + 1"/>' + "</foreach>" * 4
    )
    elements = ", ".join(["1"] * 60)
    text = f'{HEAD}<var name="n" expr="0"/><var name="l" expr="[{elements}]"/><form id="f">'
    text += f'<on event="go"><if cond="n &gt; 5">{inner}</if><assign name="n" expr="n + 1"/></on></form></prima>'
    document, _ = read_document("a.xml", text.encode())
    session = Session([document], Policy(), TABLE_4_2)
    session.step(0, [Loaded("a")])
    for now in range(1, 9):
        session.step(now, [Occurred("go")])
    assert (document.forms["f"].reactions or {})["go"] is not None
    assert "loops without ever waiting" in session.failures[0]
