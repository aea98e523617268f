"""Names in tags, and tags that are not scripts (SISR)."""

from __future__ import annotations

import pytest

from prima.grammar import (
    load,
)
from tests.helpers.grammars import ABNF, SCRIPT


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        ("$r = a {out = nothing};", ["nothing"]),
        ("$r = a {out = nope(1)};", ["nope"]),
        ("$r = a {out = session.id};", ["session"]),
        ("$r = $s {out = rules.t}; $s = a;", ["rule t"]),
        ("$r = $s {out = meta.t.text}; $s = a;", ["rule t"]),
        ("$r = $s {out = rules.s + meta.s.text + rules.latest()}; $s = a;", []),
        ("$r = $s {out = other}; $s = a {other = 1};", []),
        ("$r = a {var n = 1} {out = n; out.text = 'nothing'; /* nope */};", []),
        ("$r = a {out = Math.max(1, 2) + meta.current().text};", []),
        ("$r = a {out = typeof nothing};", []),
        ("$r = a {!{let f = function (x) { return x; }; out = f(2)}!};", []),
        ("$r = $<builtin:grammar/boolean> {out = rules.boolean};", []),
    ],
)
def test_names_that_no_tag_knows_are_told(rules: str, told: list[str]) -> None:
    warnings = load(SCRIPT + rules, base="g.gram").warnings()
    assert [
        one.message.split('"')[1]
        if "which nothing" in one.message
        else f"rule {one.message.split(chr(34))[1]}"
        for one in warnings
    ] == told
    codes = {"rule t": "no-such-rule"}
    assert [one.code for one in warnings] == [codes.get(one, "undeclared-variable") for one in told]
    assert all(one.place.file == "g.gram" and one.place.column > 1 for one in warnings)


def test_tags_of_the_header_give_names_to_those_of_rules() -> None:
    text = SCRIPT + "{!{function twice(x) { return 2 * x; }}!};\n$r = a {out = twice(2)};"
    assert not load(text).warnings()
    assert [one.code for one in load(text.replace("= twice", "= twcie")).warnings()] == [
        "undeclared-variable"
    ]


def test_a_name_that_a_tag_tests_may_be_missing() -> None:
    assert not load(f"{SCRIPT}$r = a {{if (typeof q != 'undefined') out.k = q;}};").warnings()


def test_tags_of_other_formats_have_no_names() -> None:
    assert not load(f"{ABNF}$r = a {{nothing}};").warnings()
    assert not load(f"{ABNF}$r = a {{city='Rome'; n=Rome}};").warnings()
    (warning,) = load(f"{ABNF}$r = $s {{$.x = $t}}; $s = a;").warnings()
    assert warning.code == "no-such-rule"


@pytest.mark.parametrize(
    ("tag", "warned"),
    [("out = = 1", True), ("out = 1", False), ("$.a = {", True), ("$.a = 'b'", False)],
)
def test_tags_that_are_no_script_are_warned_of(tag: str, warned: bool) -> None:
    for head in (SCRIPT, ABNF):
        found = load(f"{head}$r = x {{!{{{tag}}}!}};").warnings()
        assert [one.code for one in found] == ["bad-expression"] * warned


@pytest.mark.parametrize("value", ["out.out = out", "out = 'x'.repeat(200000)", "out = 1n"])
def test_a_value_that_cannot_be_given_has_the_place_of_its_tag(value: str) -> None:
    text = f"{SCRIPT}$r = $s;\n$s = [b] {{out = 1}} $t {{out = rules.t}};\n$t = a {{{value}}};"
    (match,) = load(text, base="g.gram").match("a")
    assert match.error is not None and match.error.message.startswith("The value cannot be given")
    line = text.splitlines().index("$s = [b] {out = 1} $t {out = rules.t};") + 1
    assert str(match.error.place) == f"g.gram:{line}:23"


@pytest.mark.parametrize(
    ("tag", "remedy"),
    [
        ('{title: "x"}', 'Write out = {title: "x"}.'),
        ('{title: "x", room: 3};', 'Write out = {title: "x", room: 3}.'),
        ('{"title": "x"}', 'Write out = {"title": "x"}.'),
        ("title: 'x', room: 3", "Write out = {title: 'x', room: 3}."),
        ("{ title: 'x' room: 3 }", ""),
        ('{ out.title = "x"; }', None),
        ('out = {title: "x"}', None),
        ("each: for (var i = 0; i < 3; i++) { out.i = i; }", None),
    ],
)
def test_an_object_that_is_not_assigned_is_told(tag: str, remedy: str | None) -> None:
    found = load(f"{SCRIPT}$r = a {{!{{ {tag} }}!}};").warnings()
    told = [] if remedy is None else [("bad-expression", remedy)]
    assert [(one.code, one.remedy) for one in found] == told


def test_tags_older_than_sisr_are_read_as_they_were_meant() -> None:
    assert not load(f"{ABNF}$r = a {{title:'x'}};").warnings()


def test_an_older_name_among_tags_of_sisr_is_told_with_what_it_is_there() -> None:
    (warning,) = load(f"{ABNF}$r = $s {{out.x = $$}}; $s = a;").warnings()
    assert (warning.code, warning.remedy) == (
        "undeclared-variable",
        "In SISR 1.0, as in the other tags, $$ is rules.latest() and $ is out.",
    )
