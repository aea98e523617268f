"""Variables that content declares: a run and validation agree on where they end."""

from __future__ import annotations

import pytest

from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Form
from prima.script.known import NameScope
from tests.helpers.robot import Bench, read

ENDS = "<block><exit/></block>"


def told(body: str) -> list[tuple[int, str]]:
    """The warnings about variables of other content: their columns, and the names."""
    problems = read(body)[1]
    assert [one for one in problems if one.severity == "error"] == []
    about = [one for one in problems if "is declared in other content" in one.message]
    return [(one.place.column, one.message.split('"')[1]) for one in about]


def fails(body: str) -> bool:
    """Whether a run ends by an error, once everything that is said has ended and somebody touched."""
    bench = Bench(body)
    for _ in range(5):
        for said in bench.saying():
            bench.finish(said)
        bench.event("touch")
    return any("error.semantic" in one for one in bench.session.failures)


@pytest.mark.parametrize(
    "content",
    [
        '<block><var name="x" expr="1"/></block><block><log expr="§x"/></block>',
        '<block><var name="x" expr="1"/></block><block><assign name="§x" expr="2"/></block>',
        '<block><var name="x" expr="1"/></block><block cond="§x"><log>a</log></block>',
        '<block><script>var x = 1</script></block><block><script>§x + 1</script></block>',
        '<block><foreach item="x" array="[1]"><log expr="x"/></foreach></block><block><log expr="§x"/></block>',
        '<block><var name="x" expr="1"/><speak>A<on event="end"><log expr="§x"/></on></speak></block>',
        '<block><speak>A<on event="end"><var name="x" expr="1"/></on></speak><log expr="§x"/></block>',
        '<on event="touch"><log expr="§x"/></on><block><var name="x" expr="1"/><speak>A</speak></block>',
        '<block><var name="x" expr="1"/></block><block><speak>It is <value expr="§x"/>.</speak></block>',
        '<block><var name="x" expr="1"/></block><block><clear namelist="§x"/></block>',
        '<block><var name="x" expr="1"/></block><block><return namelist="§x"/></block>',
        '<block><var name="x" expr="1"/><speak>A</speak></block><on event="touch" cond="§x"/>',
        '<block><var name="x" expr="1"/><speak>A<on event="end" cond="§x"/></speak></block>',
        '<var name="y" expr="§x"/><block><var name="x" expr="1"/></block>',
        '<script>var y = §x;</script><block><var name="x" expr="1"/></block>',
    ],
)  # fmt: skip
def test_what_other_content_declares_is_warned_of_and_fails(content: str) -> None:
    body = f'<form id="m">{content}{ENDS}</form>'
    plain = body.replace("§", "")
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="app">'
    assert told(plain) == [(len(head) + body.index("§") + 1, "x")]
    assert fails(plain.replace(ENDS, ""))


@pytest.mark.parametrize(
    "content",
    [
        '<block><var name="x" expr="1"/><if cond="x"><log expr="x"/></if><assign name="x" expr="2"/></block>',
        '<block><if cond="true"><var name="x" expr="1"/></if><log expr="x"/></block>',
        '<block><foreach item="x" array="[1]"><speak>A<value expr="x"/></speak></foreach><log expr="x"/></block>',
        '<var name="x" expr="0"/><block><var name="x" expr="1"/></block><block><log expr="x"/></block>',
        '<block name="x"><var name="x" expr="1"/></block><block><log expr="x"/></block>',
        '<block><speak>A<on event="end"><var name="x" expr="1"/><log expr="x"/></on></speak></block>',
        '<block><script>function x() { return 1; }</script><log expr="x()"/></block>',
        '<block><var name="x" expr="1"/></block><block><log expr="[1].map(x => x).length"/></block>',
        '<block><var name="x" expr="1"/></block><block><var name="x" expr="2"/><log expr="x"/></block>',
        '<block><var name="x" expr="1"/><clear namelist="x"/></block>',
        '<block><speak>A<on event="end"><var name="x" expr="1"/><log expr="x"/></on></speak></block><on event="touch" cond="typeof x"/>',
    ],
)  # fmt: skip
def test_what_content_sees_is_not_warned_of(content: str) -> None:
    assert told(f'<form id="m">{content}{ENDS}</form>') == []
    assert not fails(f'<form id="m">{content}</form>')


def test_a_handler_of_the_document_sees_no_content_of_forms() -> None:
    on = '<on event="touch"><log expr="x"/></on>'
    assert told(f'<form id="m"><block><var name="x" expr="1"/></block>{ENDS}</form>{on}') != []
    assert told(f'<form id="m"><var name="x" expr="1"/>{ENDS}</form>{on}') == []
    on = '<on event="touch" cond="x"/>'
    assert told(f'<form id="m"><block><var name="x" expr="1"/></block>{ENDS}</form>{on}') != []
    assert told(f'<form id="m"><var name="x" expr="1"/>{ENDS}</form>{on}') == []


def test_a_param_is_no_variable_of_content() -> None:
    body = """<form id="a"><subdialog name="s" src="#b"><param name="x" expr="1"/></subdialog>
        <block><exit/></block></form>
      <form id="b"><block><var name="x" expr="2"/></block><block><log expr="x"/><return/></block></form>"""
    assert told(body) == []


def test_what_a_form_knows_is_gathered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gathered anew for each piece of content, a large form took minutes."""
    gathered: list[str] = []
    gather = Facts.outside_content

    def counted(facts: Facts, form: Form) -> NameScope:
        gathered.append(form.id)
        return gather(facts, form)

    monkeypatch.setattr(Facts, "outside_content", counted)
    block = '<block><var name="x" expr="1"/><log expr="x"/></block>'
    on = '<on event="e"><var name="y" expr="1"/></on>'
    read(f'<form id="a">{20 * block}</form><form id="b">{20 * block}</form>{20 * on}')
    assert gathered == ["a", "b"]


@pytest.mark.parametrize(
    ("scope", "body"),
    [
        ("dialog", '<block><var name="x" expr="1"/><assign name="dialog.x" expr="2"/></block>'),
        ("document", '<var name="x"/><block><assign name="document.x" expr="2"/></block>'),
        ("application", '<var name="x"/><block><assign name="application.x" expr="2"/></block>'),
    ],
)
def test_an_assignment_to_a_scope_that_lacks_the_variable_is_warned_of_and_fails(
    scope: str, body: str
) -> None:
    _, problems = read(f'<form id="m">{body}{ENDS}</form>')
    (problem,) = problems
    assert f'The scope "{scope}" declares no variable "x"' in problem.message
    assert fails(f'<form id="m">{body}</form>')


@pytest.mark.parametrize(
    "body",
    [
        '<var name="x"/><block><assign name="dialog.x" expr="2"/></block>',
        '<block name="x"><assign name="dialog.x" expr="2"/></block>',
        '<block><script>dialog.x = 1;</script><assign name="dialog.x" expr="2"/></block>'
        '<block><var name="x"/></block>',
        '<block><log expr="document.x = 1"/><assign name="document.x" expr="2"/></block>'
        '<block><var name="x"/></block>',
    ],
)
def test_an_assignment_to_a_scope_with_the_variable_is_not_warned_of(body: str) -> None:
    assert read(f'<form id="m">{body}{ENDS}</form>')[1] == []
    assert not fails(f'<form id="m">{body}</form>')


@pytest.mark.parametrize(
    ("body", "member", "meant"),
    [
        ('<var name="who"/><block><log expr="dialog.whom"/></block>', "dialog.whom", "who"),
        ('<block cond="!document.whom"/>', "document.whom", ""),
        ('<var name="who"/><block><log expr="document.who"/></block>', "document.who", ""),
        ('<block><var name="who"/><log expr="dialog.who"/></block>', "dialog.who", ""),
        ('<block><log expr="application.who"/></block>', "application.who", ""),
        ("<block><script>var a = document.who;</script></block>", "document.who", ""),
        ('<block><var name="a" expr="[document.who]"/></block>', "document.who", ""),
    ],
)
def test_a_member_that_nothing_declares_is_warned_of_and_undefined(
    body: str, member: str, meant: str
) -> None:
    form = f'<form id="m">{body}{ENDS}</form>'
    (problem,) = read(form)[1]
    assert (problem.severity, problem.code) == ("warning", "undeclared-variable")
    scope, _, name = member.partition(".")
    says = f'The scope "{scope}" declares no variable "{name}": it is undefined.'
    assert problem.message == says
    assert problem.remedy == (
        f'Did you mean "{meant}"?' if meant else "Name a variable that it has."
    )
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="app">'
    assert problem.place.column == len(head) + form.index(member) + len(scope) + 2
    bench = Bench(f'<form id="m"><block><log expr="String({member})"/></block>{ENDS}</form>')
    assert [one["message"] for one in bench.records if one["phase"] == "log"] == ["undefined"]


@pytest.mark.parametrize(
    "body",
    [
        '<var name="x"/><block><log expr="dialog.x"/></block>',
        '<field name="x" type="boolean"><prompt>Is it?</prompt><noinput/></field><block><log expr="dialog.x$"/></block>',
        '<block><script>dialog.x = 1;</script><log expr="dialog.x"/></block>',
        '<block><script>dialog.x += 1; dialog.y--;</script><log expr="dialog.x + dialog.y"/></block>',
        "<block><script>document['x'] = 1;</script><log expr=\"document.x\"/></block>",
        '<block><script>x = 1;</script><log expr="document.x"/></block>',
        '<block><log expr="application.session.time"/></block>',
        '<block><var name="document" expr="({})"/><log expr="document.x"/></block>',
    ],
)
def test_a_member_that_something_may_declare_is_not_warned_of(body: str) -> None:
    told = [one.message for one in read(f'<form id="m">{body}{ENDS}</form>')[1]]
    assert [one for one in told if "declares no variable" in one] == []


def test_a_member_of_the_document_is_known_in_all_its_forms() -> None:
    say = '<log expr="document.x + document.f()"/>'
    setup = '<var name="x"/><script>function f() { return 1; }</script>'
    body = f'{setup}<form id="a"><block>{say}<goto next="#b"/></block></form>'
    assert read(f'{body}<form id="b"><block>{say}<exit/></block></form>')[1] == []
