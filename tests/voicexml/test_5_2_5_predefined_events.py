"""The platform's own handlers, and events it throws: VoiceXML 2.0, 5.2.5 and 5.2.6."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    GRAMMAR,
    HOME,
    LEAF,
    OOPS,
    SILENT,
    VXML,
    Case,
    Cases,
    ask,
    block,
    logged,
    rule,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

for _event in ("error.odd", "odd", "exit", "connection.disconnect.hangup"):
    case(
        f"{_event} that nothing takes ends the application",
        "5.2.5",
        f"""<form><block><throw event="{_event}"/></block><block><log>no</log></block></form>""",
        logs=[],
        ended=_event,
    )
for _event in ("cancel", "help", "help.more", "noinput", "nomatch", "maxspeechtimeout"):
    case(
        f"{_event} that nothing takes lets the application go on",
        "5.2.5",
        f"""<form><block><throw event="{_event}"/></block><block><log>on</log></block></form>""",
        logs=["on"],
        ended="exit",
    )
case(
    "cancel that nothing takes does not ask again",
    "5.2.5",
    f"""<form><link event="cancel">{HOME}</link>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    "go home",
    said=["Well?"],
)
case(
    "a nomatch that nothing takes asks again",
    "5.2.5",
    f"<form><field name='f'><prompt>1?</prompt><prompt count='2'>2?</prompt>{CITIES}</field></form>",
    "x",
    said=["1?", OOPS, "2?"],
)
case(
    "a noinput that nothing takes asks again",
    "5.2.5",
    f"<form><field name='f'><prompt>1?</prompt><prompt count='2'>2?</prompt>{CITIES}</field></form>",
    SILENT,
    said=["1?", "2?"],
)
case(
    "help that nothing takes has words of the platform's own",
    "5.2.5",
    f"""<form><link event="help">{HOME}</link>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    "go home",
    said=["Well?", "There is no help here.", "Well?"],
)
case(
    "an error in a condition is error.semantic at its item",
    "5.2.6",
    """<form><catch event="error.semantic"><log>semantic</log><exit/></catch>
    <block cond="zz"><log>no</log></block></form>""",
    logs=["semantic"],
)
for _error, _content in [
    ("error.badfetch", "<block><goto next='none.vxml'/></block>"),
    ("error.semantic", "<block><value expr='zz.y'/></block>"),
    ("error.unsupported.objectname", "<object name='o' classid='x'/>"),
    (
        "error.badfetch",
        "<field name='f'><grammar version='1.0' root='zz'><rule id='a'>x</rule></grammar></field>",
    ),
    ("error.unsupported.builtin", "<field name='f' type='zodiac'/>"),
    (
        "error.unsupported.format",
        "<field name='f'><grammar type='text/x-odd' src='g.odd'/></field>",
    ),
]:
    case(
        f"{_error} is thrown",
        "5.2.6",
        logged(_error, _content),
        logs=[_error],
        files={"g.odd": "odd"},
    )
case(
    "a document that is no VoiceXML is error.badfetch",
    "5.2.6",
    logged("error.badfetch", "<block><goto next='odd.vxml'/></block>"),
    logs=["error.badfetch"],
    files={"odd": "<vxml"},
)
case(
    "prompts before a grammar that cannot be used are kept",
    "5.2.6",
    """<form><block>Hello.</block><field name="f"><prompt>Well?</prompt>
    <grammar src="none.grxml" type="application/srgs+xml"/></field><catch event="error.badfetch">
    Sorry.<exit/></catch></form>""",
    said=["Hello.", "Well?", "Sorry."],
)
case(
    "a goto that fails leaves its dialog as it is",
    "5.2.6",
    """<form><var name="n" expr="1"/><catch event="error.badfetch"><log>bad</log></catch>
    <block><assign name="n" expr="2"/><goto next="leaf.vxml"/></block>
    <block><log expr="n"/></block></form>""",
    logs=["bad", "2"],
    files={"leaf": f"{LEAF}<form/></vxml>"},
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


@pytest.mark.parametrize(
    ("lang", "words"),
    [("en-GB", ["There is no help here."]), ("ja", ["ヘルプはありません。"]), ("fr", [])],
)
def test_the_platforms_help_is_in_the_documents_language(lang: str, words: list[str]) -> None:
    """5.2.5."""
    call = run(
        f"""{VXML} xml:lang="{lang}"><form><block><throw event="help"/></block></form></vxml>"""
    )
    assert call.said() == words


def test_a_document_with_an_error_is_error_badfetch() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.badfetch"><log>bad</log><exit/></catch>'
        + block('<goto next="other.vxml"/>'),
        other=vxml("<form><blok/></form>"),
    )
    assert call.logs() == ["bad"]


def test_a_document_that_is_not_xml_is_error_badfetch() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.badfetch"><log expr="_message.includes(\'other.vxml:1\')"/><exit/>'
        "</catch>" + block('<goto next="other.vxml"/>'),
        other="<vxml",
    )
    assert call.logs() == ["true"]


def test_a_bad_grammar_is_error_badfetch_when_it_would_listen() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.badfetch"><log expr="_event"/><exit/></catch>'
        "<form><block><log>before</log></block>"
        f'<field name="f"><prompt>Well?</prompt><grammar {GRAMMAR} root="r"><rule id="r">'
        '<ruleref uri="#none"/></rule></grammar></field></form>'
    )
    assert call.logs() == ["before", "error.badfetch"]


def test_a_bad_grammar_that_never_listens_is_no_error() -> None:  # 5.2.6
    call = Call(
        '<form><block><log>before</log><exit/></block><field name="f"><prompt>Well?</prompt>'
        f'<grammar {GRAMMAR} root="none"><rule id="r">a</rule></grammar></field></form>'
    )
    assert (call.logs(), call.ended) == (["before"], "exit")


def test_a_grammar_of_another_format_is_unsupported() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.unsupported.format"><log>format</log><exit/></catch>'
        + ask('<grammar type="application/x-jsgf">public &lt;a&gt; = b;</grammar>')
    )
    assert call.logs() == ["format"]


def test_a_grammar_of_no_real_language_is_unsupported() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.unsupported.language"><log>language</log><exit/></catch>'
        + ask(rule("tea", 'xml:lang="x-elvish-of-old"'))
    )
    assert call.logs() == ["language"]


def test_a_grammar_that_is_not_there_is_error_badfetch() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.badfetch"><log>none</log><exit/></catch>'
        + ask('<grammar src="none.grxml"/>')
    )
    assert call.logs() == ["none"]


def test_a_grammar_that_another_refers_to_and_is_not_there_is_error_badfetch() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.badfetch"><log>none</log><exit/></catch>'
        + ask(f'<grammar {GRAMMAR} root="r"><rule id="r"><ruleref uri="none.grxml"/></rule></grammar>')
    )  # fmt: skip
    assert call.logs() == ["none"]


def test_an_unknown_tag_format_is_unsupported() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.unsupported.format"><log>format</log><exit/></catch>'
        + ask(
            f'<grammar {GRAMMAR} root="r" tag-format="x"><rule id="r">a<tag>1</tag></rule></grammar>'
        )
    )
    assert call.logs() == ["format"]


def test_a_script_that_fails_is_error_semantic_with_its_place() -> None:  # 5.2.6
    call = Call("<form>\n<block><script>\nnone();</script></block></form>")
    assert call.ended.startswith("error.semantic: app.vxml:3")


def test_a_document_that_is_not_there_is_an_event() -> None:
    call = Call(
        """<catch event="error.badfetch"><log>none</log><exit/></catch>
        <form><block><goto next="nowhere.vxml"/></block></form>"""
    )
    assert (call.logs(), call.ended) == (["none"], "exit")
