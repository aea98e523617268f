"""Expressions and scripts that fail while a document runs."""

from __future__ import annotations

import os
import resource
from pathlib import Path

import pytest

from tests.helpers.bad_input import (
    BAD,
    CATCH,
    GOOD,
    PLAY,
    Prima,
    app,
    block,
    form,
    messages,
    scenario,
    stage,
    write,
)

EXPRESSIONS = [
    ("throws", "(function(){throw new Error('boom')})()", "Error: boom"),
    ("throws-symbol", "(function(){throw Symbol('x')})()", "app.xml:3"),
    ("type-error", "document.x.y", "TypeError"),
    ("loops", "(function(){while(1);})()", "longer than 0.5 s"),
    ("eats", "(function(){var a=[];while(1)a.push(Array(1000).fill(1))})()", "too much memory"),
    ("grows", "(function(){var a='x';while(1)a+=a})()", "too much memory"),
    ("sets", "(function(){var s=new Set();for(var i=0;;i++)s.add(i)})()", "too much memory"),
    ("recurses", "(function f(){f()})()", "call stack"),
    ("regex", "/^(a+)+$/.test('a'.repeat(40)+'b')", "longer than 0.5 s"),
    ("bigint", "10n**(10n**7n)", "RangeError"),
    ("long", "'x'.repeat(200000)", "more than 100,000 characters"),
    ("deep", "(function(){var a=[];for(var i=0;i<5000;i++)a=[a];return a})()", "call stack"),
    ("circular", "(function(){var a=[];a.push(a);return a})()", "circular"),
    ("deep-json", "JSON.parse('['.repeat(500000))", "call stack"),
    ("deep-eval", "eval('('.repeat(500000))", "call stack"),
    ("spread", "Math.max(...Array(900000))", "too much memory"),
    ("no-clock", "eval('performance').now()", "not defined"),
    ("null-thrown", "(function(){throw null})()", "it threw null"),
    ("says-interrupted", "(function(){throw 'interrupted'})()", ": interrupted"),
]  # fmt: skip


def processor_seconds() -> float:
    """Processor time of this process and its children, so that a busy machine changes nothing."""
    whose = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    spent = sum(sum(resource.getrusage(one)[:2]) for one in whose)
    for path in Path("/proc").glob("[0-9]*/stat"):  # engines that go on, for the next run
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:  # it has just ended
            continue
        if int(fields[1]) == os.getpid():
            spent += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return spent


@pytest.mark.parametrize(("name", "code", "message"), EXPRESSIONS)
def test_expressions(prima: Prima, tmp_path: Path, name: str, code: str, message: str) -> None:
    """Each is a timely event that the document can handle, with its place."""
    shown = code.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    asked = f'\n<send to="x"><param name="p" expr="{shown}"/></send><exit/>'
    before = processor_seconds()
    prima("run", stage(tmp_path, app(form(f"<block>{asked}</block>{CATCH}"))), "-o", "t").check(0)
    assert processor_seconds() - before < 3
    [said] = messages(tmp_path / "t")
    assert said.startswith("caught app.xml:3:") and message in said


@pytest.mark.parametrize("code", ["null", "undefined", "String(1) ? null : 1"])
def test_nothing_in_the_place_of_a_value_is_told(prima: Prima, tmp_path: Path, code: str) -> None:
    turns = app(form(f'<block><turn angle-expr="{code}"/></block>{CATCH}'))
    prima("run", stage(tmp_path, turns), "-o", "t")
    assert "angle (null or undefined) is not a number." in messages(tmp_path / "t")[0]


SITES = [
    ("log", block(f'<log expr="{BAD}"/>')),
    ("speak", block(f'<speak><value expr="{BAD}"/></speak>')),
    ("script", block("<script>document.x.y</script>")),
    ("if", block(f'<if cond="{BAD}"/>')),
    ("foreach", block(f'<foreach item="i" array="{BAD}"/>')),
    ("no-array", block('<foreach item="i" array="7"/>')),
    ("argument", block(f'<turn angle-expr="{BAD}"/>')),
    ("form-variable", form(f'<var name="z" expr="{BAD}"/>')),
    ("form-script", form(f"<script>{BAD}</script>")),
    ("item-value", form(f'<field name="q" type="text" expr="{BAD}"/>')),
    ("prompt", form(f'<field name="q" type="text"><prompt><value expr="{BAD}"/></prompt></field>')),
    ("goto", block(f'<goto next-expr="{BAD}"/>')),
    ("block-condition", form(f'<block cond="{BAD}"/>')),
    ("handler-condition", form(f'<block><throw event="foo"/></block><on event="foo" cond="{BAD}"/>')),
    ("watch", form(f'<watch name="w" when="{BAD}"/>')),
    ("document-variable", f'<var name="z" expr="{BAD}"/>' + form("")),
    ("return", form('<subdialog name="s" src="#g"/>') + form("<var name='x' expr=\"'x'.repeat(99999)\"/><block><assign name='x' expr='x.concat(x).slice(0)'/><return namelist='x'/></block>", "g")),
]  # fmt: skip


def played(folder: Path, document: str) -> Path:
    return stage(folder, document, '<when at="1s"><sensor name="a" value="1"/></when>')


@pytest.mark.parametrize(("name", "body"), SITES)
def test_every_expression_that_fails_can_be_handled(
    prima: Prima, tmp_path: Path, name: str, body: str
) -> None:
    prima("run", played(tmp_path, app(body, head=CATCH)), "-o", "t").check(0)
    assert messages(tmp_path / "t")[0].startswith("caught app.xml:2:")


@pytest.mark.parametrize(("name", "body"), SITES)
def test_every_expression_that_fails_ends_the_application(
    prima: Prima, tmp_path: Path, name: str, body: str
) -> None:
    prima("run", played(tmp_path, app(body)), "-o", "t").check(3, "prima: a: error.semantic: ")


def test_an_error_ends_its_application_alone(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "bad.xml", app(block(f'<log expr="{BAD}"/>'), name="bad"))
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", scenario('<application src="bad.xml"/>' + PLAY))
    prima("run", "s.xml", "-o", "t").check(3, "prima: bad: error.semantic: bad.xml:2")
    assert messages(tmp_path / "t") == ["alive"]


HOSTILE = [
    ("freeze", "Object.freeze(application); Object.freeze(document); Object.freeze(dialog)"),
    (
        "prototype",
        "Object.defineProperty(Object.prototype, 'event', {set: function () { throw 1 }})",
    ),
    (
        "full",
        "document.a = []; try { while (1) document.a.push('x' + document.a.length) } catch (e) {}",
    ),
    ("promise", "Promise.resolve(1).then(function () { while (1); })"),
    ("stringify-number", "JSON.stringify = function () { return 42 }"),
    ("stringify-text", "JSON.stringify = function () { return '{' }"),
]


@pytest.mark.parametrize(("name", "code"), HOSTILE)
def test_hostile_scripts(prima: Prima, tmp_path: Path, name: str, code: str) -> None:
    given = '<send to="x"><param name="p" expr="({a: 1})"/></send>' if name != "full" else ""
    body = block(f"<script>{code}</script>{given}<speak>x</speak><log>alive</log><exit/>")
    happens = '<service name="x"/>'
    prima("run", stage(tmp_path, app(body), happens), "-o", "t").check(0)
    assert messages(tmp_path / "t") == ["alive"]


def test_a_setter_for_the_clock(prima: Prima, tmp_path: Path) -> None:
    code = "Object.defineProperty(application, 'session', {set: function () { throw 1 }})"
    body = block(f"<script>{code}</script><speak>x</speak><log>alive</log><exit/>")
    said = prima("run", stage(tmp_path, app(body)), "-o", "t")
    assert said.code in (0, 3)
    said.check(said.code)


def test_a_long_text_made_of_two(prima: Prima, tmp_path: Path) -> None:
    body = block("<log expr=\"'a'.repeat(9000) + 'b'\"/><exit/>")
    prima("run", stage(tmp_path, app(body)), "-o", "t").check(0)
    assert len(messages(tmp_path / "t")[0]) == 9001


FILLS = "for (var i = 0; ; i++) a.push({i: i})"


@pytest.mark.parametrize("how", ["none", "ea"])
def test_a_script_that_fills_the_memory_is_an_error_of_its_document(
    prima: Prima, tmp_path: Path, how: str
) -> None:
    told = "it threw null, or used too much memory"
    local = app(form(f"<block><script>var a = []; {FILLS}</script></block>{CATCH}"))
    prima("run", stage(tmp_path, local), "--isolate", how, "-o", "t").check(0)
    assert told in messages(tmp_path / "t")[0]
    kept = app(
        '<var name="a" expr="[]"/>' + form(f"<block><script>{FILLS}</script></block>{CATCH}")
    )
    prima("run", stage(tmp_path, kept), "--isolate", how, "-o", "t").check(
        3, "error.semantic", told
    )
