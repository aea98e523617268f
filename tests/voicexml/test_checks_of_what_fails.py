"""``prima validate`` of VoiceXML that is valid, but fails whenever a run reaches it."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api

FAILING = {
    "object": ('<object name="o" classid="method://x"/>', "error.unsupported.objectname"),
    "format": ('<record name="r" type="audio/mpeg; rate=8"/>', "error.unsupported.format"),
    "scheme": ('<transfer name="t" dest="phone:12"/>', "error.unsupported.uri"),
    "number": ('<transfer name="t" dest="desk"/>', "error.connection.baddestination"),
    "choices": ("<block>One of <enumerate/></block>", "error.semantic"),
    "in a field": ('<field name="f" type="digits"><enumerate/></field>', "error.semantic"),
}
FINE = {
    "another type": '<record name="r" type="audio/x-wav;rate=8"/><record name="s"/>',
    "calls": '<transfer name="t" dest="tel:+1-555"/><transfer name="u" destexpr="where"/>',
    "options": '<field name="f"><option>tea</option><prompt><enumerate/></prompt></field>',
    "a handler of the form": "<catch><enumerate/></catch>",
    "maybe never": '<object name="o" classid="method://x" cond="session.objects"/>',
    "expected": '<object name="o"><catch event="error.unsupported"/></object>',
    "expected by name": '<transfer name="t" dest="phone:1"><catch event="error.unsupported.uri"/></transfer>',
}


def failing(folder: Path, form: str, more: str = "") -> list[tuple[str, str]]:
    path = folder / "a.vxml"
    path.write_text(
        f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"{more}>'
        f'<var name="where" expr="\'tel:1\'"/><form>{form}<block/></form></vxml>'
    )
    told = api.validate([str(path)])
    return [(one.message, one.remedy) for one in told if one.code == "always-fails"]


@pytest.mark.parametrize("what", FAILING)
def test_what_always_fails_is_told_with_its_event(tmp_path: Path, what: str) -> None:
    form, event = FAILING[what]
    ((_, remedy),) = failing(tmp_path, form)
    assert event in remedy


@pytest.mark.parametrize("what", FINE)
def test_what_may_work_is_not_told(tmp_path: Path, what: str) -> None:
    assert failing(tmp_path, FINE[what]) == []


def test_a_handler_of_any_error_expects_none(tmp_path: Path) -> None:
    form, _ = FAILING["object"]
    assert len(failing(tmp_path, f"<error>Sorry.</error>{form}")) == 1


def test_a_root_document_may_expect_it(tmp_path: Path) -> None:
    form, _ = FAILING["object"]
    assert failing(tmp_path, form, ' application="root.vxml"') == []


def test_the_message_says_what_to_write_instead(tmp_path: Path) -> None:
    ((message, remedy),) = failing(tmp_path, FAILING["scheme"][0])
    assert message == (
        '<transfer> always fails: "phone:12" cannot be called; write "tel:", "sip:" or "sips:".'
    )
    assert remedy == "At run time it is error.unsupported.uri: change it, or catch the event."


RECORDED = '<property name="recordutterance" value="{}"/>'
TYPE = '<property name="recordutterancetype" value="audio/mpeg"/>'
ASKS = '<field name="f" type="digits">{}</field>'


def test_a_format_in_which_no_answer_is_recorded_is_told(tmp_path: Path) -> None:  # 2.1, 7.2
    recorded = RECORDED.format("true")
    for form in (recorded + TYPE + ASKS.format(""), recorded + ASKS.format(TYPE)):
        ((message, remedy),) = failing(tmp_path, form)
        assert 'nothing is recorded as "audio/mpeg"' in message
        assert "error.unsupported.format" in remedy


def test_a_format_of_answers_may_be_unused_or_its_event_expected(tmp_path: Path) -> None:
    assert failing(tmp_path, RECORDED.format("false") + TYPE + ASKS.format("")) == []
    expects = ASKS.format('<catch event="error.unsupported.format"/>')
    assert failing(tmp_path, RECORDED.format("true") + TYPE + expects) == []


OWN_ROOTS = {
    "two rules": ('version="1.0">{}<rule id="a">tea</rule>', 1),
    "a root": ('version="1.0" root="a">{}<rule id="a">tea</rule>', 0),
    "one public rule": ('version="1.0">{}<rule id="a" scope="public">tea</rule>', 0),
    "ABNF": ('type="application/srgs">#ABNF 1.0;\n$a = tea; $b = $&lt;rest.gram>;', 1),
    "ABNF with a root": ('type="application/srgs">#ABNF 1.0;\nroot $a;\n$a = tea; $b = no;', 0),
}


@pytest.mark.parametrize("what", OWN_ROOTS)
def test_a_grammar_that_does_not_say_where_it_begins_is_told(tmp_path: Path, what: str) -> None:
    """SRGS 1.0, 4.7: what has no root takes nothing by itself."""
    (tmp_path / "rest.gram").write_text("#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = milk;\n")
    rest = '<rule id="b"><ruleref uri="rest.gram"/></rule>'
    content, times = OWN_ROOTS[what]
    grammar = f"<grammar {content.format(rest)}</grammar>"
    path = tmp_path / "a.vxml"
    path.write_text(
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"><form>'
        f'<field name="f"><prompt>Well?</prompt>{grammar}</field></form></vxml>'
    )
    told = api.validate([str(path)])
    assert [(one.code, one.severity) for one in told] == [("no-root", "warning")] * times
    assert all("error.badfetch" in one.message for one in told)
