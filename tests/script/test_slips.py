"""Code that does not compile: what is wrong, where, and what to do about it."""

from __future__ import annotations

from html import escape
from pathlib import Path

import pytest

from prima import api
from tests.helpers.bad_input import app

EXPRESSIONS = [
    ("(a", 1, 'its "(" is not closed. Close the (.'),
    ("a + [1, (2)", 5, 'its "[" is not closed. Close the [.'),
    ("f(1", 2, 'its "(" is not closed. Close the (.'),
    ("[1, 2)", 6, 'its ")" closes nothing. Remove the ).'),
    ("a)", 2, 'its ")" closes nothing. Remove the ).'),
    ("a))", 2, 'its ")" closes nothing. Remove the ).'),
    ("'(' + a)", 8, 'its ")" closes nothing. Remove the ).'),
    ("a ==", 5, "it ends too early. Complete it, or remove its last sign."),
    ("a ? 1", 6, "it ends too early. Complete it, or remove its last sign."),
    ("a b", 3, "Write an operator before b, or put a text into quotes."),
    ("a is b", 3, "Write == for is."),
    ("a is not b", 3, "Write != for is not."),
    ("a equals b", 3, "Write == for equals."),
    ("${a}", 2, "Write the expression alone, without ${ and }."),
    ("a OR b", 3, "Write || for OR."),
    ("a +* b", 4, "Write what belongs before the *, or remove it."),
    ("'abc", 1, "Write the text's quote also at its end."),
    ('"abc', 1, "Write the text's quote also at its end."),
    ("a /* b", 3, "Write */ at the end of the comment."),
    ("1a", 1, "A name does not begin with a digit."),
    ("a.0", 2, "an element of a list is list[0]."),
    ("a..b", 3, "Write a name after the dot."),
]
SCRIPTS = [
    ("function f(a { return a; }", 11, 'its "(" is not closed. Close the (.'),
    ("function f(a) { return a; } }", 29, 'its "}" closes nothing. Remove the }.'),
    ("if (a) { a = 1 } else { a = 2", 23, 'its "{" is not closed. Close the {.'),
    ("var x = `a${b`", 14, "Write the text's quote also at its end."),
    ("var r = /[(]/; f(", 17, 'its "(" is not closed. Close the (.'),
    ("// (\nf(1", 2, 'its "(" is not closed. Close the (.'),
    ("var = 1", 5, "Write a name after the keyword."),
    ("function () {}", 10, "Give the function a name."),
    ("const x;", 8, "Give it a value, or write let."),
    ("let x = 1 let y = 2", 11, "Write a ; between two statements of one line."),
    ("var x = 1 /* ; */ var y", 19, "Write a ; between two statements of one line."),
]


@pytest.mark.parametrize(("code", "column", "says"), EXPRESSIONS)
def test_an_expression_that_does_not_compile_has_a_remedy(
    code: str, column: int, says: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.xml"
    content = f'<form id="f"><block>\n<if cond="{escape(code)}"><exit/></if><exit/></block></form>'
    path.write_text(app(f'<var name="a" expr="1"/><var name="b" expr="2"/>{content}'))
    (problem,) = api.validate([path])
    assert f"{problem.message} {problem.remedy}".endswith(says)
    at = problem.place.column - len('<if cond="')
    assert at == len(escape(code[: column - 1])) + 1


@pytest.mark.parametrize(("code", "column", "says"), SCRIPTS)
def test_a_script_that_does_not_compile_has_a_remedy(
    code: str, column: int, says: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.xml"
    path.write_text(app(f'<script><![CDATA[\n{code}]]></script><form id="f"><block/></form>'))
    problem = next(one for one in api.validate([path]) if one.code == "bad-expression")
    assert f"{problem.message} {problem.remedy}".endswith(says)
    assert problem.place.column == column


@pytest.mark.parametrize(
    "code",
    [
        *("var x = 1\nvar y = 2", "var x = 1 /* \n */ var y", "function f() { var x = 1 }\nf()"),
        *("do { } while (false) var x = 1", "var x = 1 // ;\nvar y = 2", "var x = {}\rvar y = []"),
    ],
)
def test_semicolons_may_be_left_out_where_ecmascript_allows_it(code: str, tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(app(f'<script><![CDATA[{code}]]></script><form id="f"><block/></form>'))
    assert [one for one in api.validate([path]) if one.severity == "error"] == []
    assert not api.rehearse(api.stage([path], [])).failures
