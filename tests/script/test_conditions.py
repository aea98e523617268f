"""Conditions as authors write them: comments in them, words of other languages."""

from __future__ import annotations

import pytest

from prima.errors import Place
from prima.script.conditions import assigning, compared
from tests.helpers.robot import read


def at(offset: int) -> Place:
    return Place("a.xml", 1, offset + 1)


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("size == 'big'", ("size", "big", 8)),
        ("size == /* the value */ 'big'", ("size", "big", 24)),
        ("'big' /* x */ !== size", ("size", "big", 0)),
    ],
)
def test_a_comment_does_not_hide_a_comparison(code: str, found: tuple[str, str, int]) -> None:
    assert [*compared(code)] == [found]


@pytest.mark.parametrize(
    ("code", "remedy"),
    [
        ("size == 'big' and true", "Write &amp;&amp; for and."),
        ("size == 'big' or true", "Write || for or."),
        ("size == 'big' 'small'", ""),
        ("== 'big'", ""),
    ],
)
def test_a_comparison_that_does_not_compile_is_told(code: str, remedy: str) -> None:
    body = (
        '<form id="f"><field name="size"><prompt>A?</prompt><option>big</option>'
        f'<noinput><exit/></noinput></field><block cond="{code}"><exit/></block></form>'
    )
    found = [one for one in read(body, "ea")[1] if one.code == "bad-expression"]
    assert len(found) == 1 and remedy in found[0].remedy


def test_the_sign_of_an_assignment_is_the_place_also_behind_a_comment() -> None:
    (problem,) = assigning("size /* the value */ = 'big'", at)
    assert problem.place.column == 22


@pytest.mark.parametrize(
    ("code", "column", "remedy"),
    [
        ("{n}", 1, "Write it without { and }."),
        (" {n: n}", 2, "Write it without { and }."),
        ("[n > 1]", 1, "Write it without [ and ]."),
        ("'n > 1'", 1, "Write it without its quotes."),
        ("`${n} > 1`", 1, "Write it without its quotes."),
        ("'n = 1'", 1, "Write it without its quotes."),
    ],
)
def test_a_condition_that_is_always_true_is_told(code: str, column: int, remedy: str) -> None:
    (problem,) = assigning(code, at)
    assert (problem.place.column, problem.remedy) == (column, remedy)


@pytest.mark.parametrize(
    "code", ["''", "'a' == n", "[n].length", "true", "1", "n", "({n}).n", "n == '='", "/* ' */ n"]
)
def test_a_condition_that_may_be_meant_is_not_told(code: str) -> None:
    assert [*assigning(code, at)] == []
