"""Checks of a VoiceXML document's conditions: assignments, and texts that no answer gives."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.validating import told

BOOLEAN = '<field name="x" type="boolean{}"><prompt>More?</prompt>{}</field>'
OPTIONS = (
    '<field name="x"><option value="t"> black  tea </option><option>ice cream</option></field>'
)
BUILT_IN = (
    '<field name="x"><grammar src="builtin:dtmf/boolean?y=7"/>'
    '<grammar src="builtin:grammar/boolean"/></field>'
)
GRAMMAR = '<field name="x"><grammar version="1.0" root="r"><rule id="r">go</rule></grammar></field>'


@pytest.mark.parametrize(
    ("cond", "found"),
    [
        ("y = 1", "This condition gives a variable a value; it does not compare. Write ==."),
        ("document.y='a'", "This condition gives a variable a value"),
        ("true &amp;&amp; (y = 2)", "This condition gives a variable a value"),
        ("y => 2", "This condition is a function, which is always true"),
        ("y == 1 || y >= 2 || y != '='", ""),
    ],
)
def test_a_condition_that_assigns_is_told(tmp_path: Path, cond: str, found: str) -> None:
    content = f'<var name="y"/><form><block><if cond="{cond}">Yes.</if></block></form>'
    assert [found in one for one in told(tmp_path, content)] == [True] * bool(found)


@pytest.mark.parametrize(
    ("field", "cond", "found"),
    [
        (
            BOOLEAN.format("", ""),
            "x == 'true'",
            ['"true". It is true or false: write "x" or "!x".'],
        ),
        (BOOLEAN.format("?y=1;n=2", ""), "'no' != x || x === 'yes'", ["no", "yes"]),
        (BOOLEAN.format("", ""), "x == true || x == '1' || x == '' || x$.utterance == 'yes'", []),
        (BUILT_IN, "x == 'false'", ['"false". It is true or false']),
        (OPTIONS, "x == 't' || x == 'ice cream'", []),
        (OPTIONS, "x == 'black tea'", ['"black tea". It is ice cream or t.']),
        (OPTIONS, "x == 'Ice cream'", ['Did you mean "ice cream"?']),
        (GRAMMAR, "x == 'stop'", []),
        (f"<block/>{OPTIONS}<grammar src='all.grxml'/>", "x == 'milk'", []),
        (f"{OPTIONS}<script src='all.js'/>", "x == 'milk'", []),
        (f"{OPTIONS}<catch event='e'><assign name='dialog.x' expr='1'/></catch>", "x == 'no'", []),
        (f"{OPTIONS}<block><var name='x' expr='1'/></block>", "x == 'no'", []),
        (f"{OPTIONS}<script>function f() {{ x = 'no'; }}</script>", "x == 'no'", []),
        (OPTIONS.replace("name", "expr='\"a\"' name"), "x == 'no'", []),
    ],
)
def test_a_comparison_with_what_no_answer_to_a_field_gives_is_told(
    tmp_path: Path, field: str, cond: str, found: list[str]
) -> None:
    content = f'<form>{field}<block cond="{cond}">Good.</block></form>'
    for name in ("all.grxml", "all.js"):
        (tmp_path / name).write_text("")
    seen = [one for one in told(tmp_path, content) if "never-equal" in one]
    assert [words in one for words, one in zip(found, seen, strict=True)] == [True] * len(found)


def test_a_comparison_in_another_form_is_none_of_a_field(tmp_path: Path) -> None:
    content = f'<var name="x"/><form>{OPTIONS}</form><form id="b"><block cond="x == 1"/></form>'
    other = content.replace("x == 1", "x == 'no'")
    assert told(tmp_path, content) == told(tmp_path, other) == []
