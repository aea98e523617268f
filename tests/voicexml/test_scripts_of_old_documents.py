"""Code as old documents have it: several statements, methods in capitals, variables of scripts."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.old_documents import HEAD, problems, run, said
from tests.helpers.voice import Call, Online, vxml

# Scripts of the third edition ------------------------------------------------------------------
SCRIPT = """<![CDATA[
<!-- hidden from what knows no scripts
counter = 0;
for (i = 0; i < 4; i++) counter += i;
for (key in { one: 1 }) found = key;
function Person(name) { this.name = name; }
Person.prototype.greet = function () { return 'Hi ' + this.name; };
function sum() { total = 0; for (var i = 0; i < arguments.length; i++) total += arguments[i]; return total; }
outer: for (var j = 0; j < 3; j++) { while (true) { if (j == 1) break outer; continue outer; } }
with (Math) { var three = floor(PI); }
try { throw new Error('boom'); } catch (error) { var message = error.message; }
hours = 010;
var words = escape('a b') + unescape('%21') + String.fromCharCode(65) + 'hello'.substr(1, 2);
// -->
]]>"""
FOUND = [
    ("counter", "6"), ("found", "one"), ("new Person('Bob').greet()", "Hi Bob"), ("sum(1, 2)", "3"),
    ("(sum(3), total)", "3"), ("j + ' ' + three + ' ' + message", "1 3 boom"), ("hours", "8"),
    ("document.hours", "8"), ("application.counter", "6"), ("words", "a%20b!Ael"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "value"), FOUND)
def test_old_scripts(tmp_path: Path, code: str, value: str) -> None:
    """What they assign without declaring it is a variable of the scope that they stand in."""
    variables = '<var name="hours" expr="1"/>'
    body = f'{variables}<script>{SCRIPT}</script><form><block><value expr="{code}"/></block></form>'
    assert said(run(tmp_path, body)) == [f'"{value}"']
    assert problems(tmp_path, f"{HEAD}{body}</vxml>") == []


def test_what_a_script_assigns_goes_no_further_than_its_scope(tmp_path: Path) -> None:
    """That of a block is not there in the next one; a declared variable stays where it is."""
    body = (
        '<form><var name="kept" expr="1"/><block><script>own = 2; kept = 3;</script>'
        '<value expr="own + kept"/></block><block><value expr="kept"/></block>'
        '<block><value expr="own"/></block></form>'
    )
    made = run(tmp_path, body)
    assert [row.what for row in made.rows() if row.what.startswith('"')] == ['"5"', '"3"']
    assert "own is not defined" in made.failures[0]


# Others --------------------------------------------------------------------------------------
def test_the_telephone_of_old_documents(tmp_path: Path) -> None:
    """It is there, and knows what the connection knows: here nothing."""
    body = '<var name="ani" expr="session.telephone.ani"/><form><block>From <value expr="ani"/></block></form>'
    assert said(run(tmp_path, body)) == ['"From undefined"']


EXPRESSIONS = {
    "x = 1; x + 1": "2",
    "x = 1; x = x * 7;": "7",
    "var y = 3; if (y) x = y + 1;": "4",
    "for (var i = 0, s = 0; i != 3; i++) s += i; s": "3",
    "": "undefined",
    " ": "undefined",
}


@pytest.mark.parametrize("expr", EXPRESSIONS)
def test_several_statements_give_the_value_of_the_last(tmp_path: Path, expr: str) -> None:
    body = (
        f'<form><var name="x" expr="9"/><var name="v" expr="{expr}"/><block><assign name="x"'
        f' expr="9"/><log expr="{expr}"/><log><value expr="v"/></log><assign name="v"'
        f' expr="{expr}"/><log expr="String(v)"/><exit expr="{expr}"/></block></form>'
    )
    call = Call(body)
    value = EXPRESSIONS[expr]
    assert call.logs()[:3] == [value] * 3
    assert call.logs()[3:] == ([] if value == "undefined" else [f"exit: {value}"])
    told = problems(tmp_path, HEAD + body + "</vxml>")
    assert {(one.severity, one.code) for one in told} == {("warning", "bad-expression")}
    said = "empty" if not expr.strip() else "several statements"
    assert all(said in one.message for one in told)


def test_an_error_in_several_statements_is_told_at_its_place() -> None:
    call = Call(
        """<form><catch event="error.semantic"><log expr="_message"/></catch>
<var name="x" expr="1; nothing.at.all"/></form>"""
    )
    place, _, message = call.logs()[0].partition(": ")
    assert place == "app.vxml:2:24"
    assert message == "1; nothing.at.all: ReferenceError: nothing is not defined"


def test_what_is_no_script_either_stays_an_error() -> None:
    call = Call(
        """<form><catch event="error.semantic"><log>semantic</log></catch>
        <block><log expr="1 +; 2"/></block><block><if cond="1; 2"/></block></form>"""
    )
    assert call.logs() == ["semantic", "semantic"]


def test_methods_may_stand_in_capitals(tmp_path: Path) -> None:
    web = {"http://x.example/a": vxml("<form><block><log>there</log></block></form>")}
    body = """<form><block><submit next="http://x.example/a" method="GET"/></block></form>"""
    call = Online(web, body)
    sends = [one["data"] for one in call.phases("send")]
    assert (call.logs(), sends[0]["method"]) == (["there"], "get")
    [told] = problems(tmp_path, HEAD + body + "</vxml>")
    assert (told.severity, told.remedy) == ("warning", 'Write "get".')
    [wrong] = problems(tmp_path, HEAD + body.replace("GET", "PUT") + "</vxml>")
    assert (wrong.severity, wrong.code) == ("error", "bad-value")
