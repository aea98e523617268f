"""Documents, input, output, properties and checking of VoiceXML: one short case for each rule.

Numbers are sections of VoiceXML 2.0; those with "2.1" are of VoiceXML 2.1.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from prima import loading
from prima.errors import DocumentError, Problem
from prima.messages import Ended, Heard
from prima.voicexml.document import broken, join, read_page
from prima.voicexml.vocabulary import ALTERNATIVES
from tests import ROOT
from tests.helpers.robot import Bench
from tests.helpers.voice import HEAD, Call, voice, vxml
from tests.helpers.work import steps

P = 'xmlns:p="urn:prima:dialogue:1"'
GRAMMAR = 'version="1.0" xmlns="http://www.w3.org/2001/06/grammar"'


def leaf(body: str, root: str = "root.vxml", version: str = "2.1") -> str:
    """A document of the application whose root is ``root``."""
    return (
        f'<vxml version="{version}" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"'
        f' application="{root}">{body}</vxml>'
    )


def block(content: str) -> str:
    return f"<form><block>{content}</block></form>"


def rule(words: str, more: str = "") -> str:
    """A grammar of a few words."""
    items = "".join(f"<item>{word}</item>" for word in words.split("|"))
    return (
        f'<grammar {GRAMMAR} root="r" {more}><rule id="r"><one-of>{items}</one-of></rule></grammar>'
    )


def file(words: str, more: str = "") -> str:
    """A grammar as a file."""
    return rule(words, f'xml:lang="en" {more}')


def ask(content: str, name: str = "f", more: str = "") -> str:
    """A form with one field that logs what it was filled with."""
    return (
        f'<form><field name="{name}" {more}><prompt>Well?</prompt>{content}'
        f'<filled><log expr="{name}"/><exit/></filled></field></form>'
    )


def problems(text: str) -> list[str]:
    """What is wrong with a document: line, column and code of each problem."""
    try:
        page = read_page("d.vxml", "d.vxml", text.encode())
        found = page.problems
    except DocumentError as error:
        found = error.problems
    return [f"{p.place.line}:{p.place.column} {p.code}" for p in sorted(found)]


def codes(text: str) -> list[str]:
    return [one.partition(" ")[2] for one in problems(text if "<vxml" in text else vxml(text))]


# 1: documents and applications ---------------------------------------------------------


def test_a_document_begins_with_its_first_dialog() -> None:  # 1.5.1
    assert Call(f'{block("<log>one</log>")}<form id="b"><block/></form>').logs() == ["one"]


def test_an_application_ends_where_no_dialog_follows() -> None:  # 1.5.1
    assert Call(block("<log>one</log>")).ended == "exit"


def test_the_roots_variables_are_the_leafs_application_scope() -> None:  # 1.5.2
    call = Call(
        leaf(block('<log expr="a"/><log expr="application.a"/>')),
        root=vxml("<var name='a' expr='7'/>"),
    )
    assert call.logs() == ["7", "7"]


def test_the_roots_scripts_run_before_the_leafs_variables() -> None:  # 1.5.2
    call = Call(
        leaf('<var name="b" expr="twice(4)"/>' + block('<log expr="b"/>')),
        root=vxml("<script>function twice(x) { return 2 * x; }</script>"),
    )
    assert call.logs() == ["8"]


def test_a_leaf_hides_the_roots_variable_of_the_same_name() -> None:  # 5.1.2
    call = Call(
        leaf('<var name="a" expr="1"/>' + block('<log expr="a"/><log expr="application.a"/>')),
        root=vxml("<var name='a' expr='7'/>"),
    )
    assert call.logs() == ["1", "7"]


def test_the_roots_handlers_catch_in_the_leaf() -> None:  # 1.5.2
    call = Call(
        leaf(block('<throw event="odd"/>')),
        root=vxml('<catch event="odd"><log>root</log><exit/></catch>'),
    )
    assert call.logs() == ["root"]


def test_a_leafs_handler_comes_before_the_roots() -> None:  # 5.2.4
    call = Call(
        leaf('<catch event="odd"><log>leaf</log><exit/></catch>' + block('<throw event="odd"/>')),
        root=vxml('<catch event="odd"><log>root</log><exit/></catch>'),
    )
    assert call.logs() == ["leaf"]


def test_the_roots_links_listen_in_the_leaf() -> None:  # 1.5.2
    call = Call(
        leaf(ask("<option>yes</option>")),
        root=vxml(f'<link event="odd">{rule("operator")}</link>'
                  '<catch event="odd"><log>link</log><exit/></catch>'),
    )  # fmt: skip
    call.answer("operator")
    assert call.logs() == ["link"]


def test_the_roots_properties_hold_in_the_leaf() -> None:  # 1.5.2, 6.3
    call = Call(
        leaf(ask("<option>yes</option>")),
        root=vxml('<property name="timeout" value="9s"/>'),
    )
    call.play()
    assert question(call)["timeout"] == 9000


def test_the_roots_document_scoped_dialogs_listen_in_the_leaf() -> None:  # 3.1.3
    call = Call(
        leaf(ask("<option>yes</option>")),
        root=vxml(f'<form scope="document">{rule("weather")}<block><log>root form</log></block></form>'),
    )  # fmt: skip
    call.answer("weather")
    assert call.logs() == ["root form"]


def test_the_roots_other_dialogs_do_not_listen_in_the_leaf() -> None:  # 3.1.3
    call = Call(
        leaf(ask("<option>yes</option><nomatch><log>no</log><exit/></nomatch>")),
        root=vxml(f"<form>{rule('weather')}<block/></form>"),
    )
    call.answer("weather")
    assert call.logs() == ["no"]


def test_variables_of_the_root_outlive_a_transition_between_leaves() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="other.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>"),
        other=leaf(block('<log expr="a"/>')),
    )
    assert call.logs() == ["2"]


def test_variables_of_a_leaf_do_not_outlive_it() -> None:  # 1.5.2
    call = Call(
        leaf('<var name="b" expr="1"/>' + block('<goto next="other.vxml"/>')),
        root=vxml(""),
        other=leaf(block('<log expr="typeof b"/>')),
    )
    assert call.logs() == ["undefined"]


def test_a_leaf_may_go_to_its_root_without_losing_its_variables() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="root.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>" + block('<log expr="a"/><log expr="document.a"/>')),
    )
    assert call.logs() == ["2", "2"]


def test_a_root_may_go_to_its_leaf_without_losing_its_variables() -> None:  # 1.5.2
    call = Call(
        vxml(
            "<var name='a' expr='1'/>" + block('<assign name="a" expr="3"/><goto next="l.vxml"/>')
        ),
        l=leaf(block('<log expr="application.a"/>'), root="app.vxml"),
    )
    assert call.logs() == ["3"]


def test_another_application_has_an_application_scope_of_its_own() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="other.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>"),
        second=vxml("<var name='c' expr='5'/>"),
        other=leaf(block('<log expr="typeof a"/><log expr="application.c"/>'), root="second.vxml"),
    )
    assert call.logs() == ["undefined", "5"]


def test_a_document_without_root_is_its_own_application() -> None:  # 1.5.2
    call = Call("<var name='a' expr='1'/>" + block('<log expr="application.a"/>'))
    assert call.logs() == ["1"]


def test_a_root_that_is_not_there_is_error_badfetch() -> None:  # 1.5.2
    call = Call(leaf(block("x")))
    assert call.ended.startswith("error.badfetch")


def test_a_root_that_names_a_root_is_error_semantic() -> None:  # 1.5.2
    call = Call(leaf(block("x")), root=leaf("", root="second.vxml"), second=vxml(""))
    assert call.ended.startswith("error.semantic")


def test_a_fragment_leads_to_a_dialog_of_another_document() -> None:  # 5.3.7
    call = Call(
        block('<goto next="other.vxml#b"/>'),
        other=vxml('<form id="a"><block><log>a</log></block></form>'
                   '<form id="b"><block><log>b</log></block></form>'),
    )  # fmt: skip
    assert call.logs() == ["b"]


def test_a_fragment_that_is_not_there_is_error_badfetch() -> None:  # 5.3.7
    call = Call(
        '<catch event="error.badfetch"><log>none</log><exit/></catch>'
        + block('<goto next="other.vxml#c"/>'),
        other=vxml('<form id="a"><block/></form>'),
    )
    assert call.logs() == ["none"]


def test_a_fragment_alone_keeps_the_documents_variables() -> None:  # 5.3.7
    call = Call(
        '<var name="a" expr="1"/><form><block><assign name="a" expr="2"/><goto next="#b"/></block>'
        '</form><form id="b"><block><log expr="a"/></block></form>'
    )
    assert call.logs() == ["2"]


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


def test_relative_uris_are_relative_to_the_document_that_holds_them() -> None:  # 1.5.1
    call = Call(
        block('<goto next="sub/a.vxml"/>'),
        **{
            "sub/a.vxml": vxml(block('<goto next="b.vxml"/>')),
            "sub/b.vxml": vxml(block("<log>sub b</log>")),
        },
    )
    assert call.logs() == ["sub b"]


def test_xml_base_is_what_uris_are_relative_to() -> None:  # 1.5.1
    call = Call(
        f'{HEAD[:-1]} xml:base="sub/">{block("<goto next=" + chr(34) + "b.vxml" + chr(34) + "/>")}</vxml>',
        **{"sub/b.vxml": vxml(block("<log>sub b</log>"))},
    )
    assert call.logs() == ["sub b"]


@pytest.mark.parametrize(
    ("base", "uri", "whole"),
    [
        ("a.vxml", "b.vxml", "b.vxml"),
        ("s/a.vxml", "b.vxml#x", "s/b.vxml#x"),
        ("s/a.vxml", "../b.vxml", "b.vxml"),
        ("s/a.vxml", "../../b.vxml", "../b.vxml"),
        ("s/a.vxml", "#x", "s/a.vxml#x"),
        ("s/a.vxml", "b.vxml?a=1/2", "s/b.vxml?a=1/2"),
        ("a.vxml", "http://x.y/z", "http://x.y/z"),
        ("http://x.y/s/a", "b", "http://x.y/s/b"),
    ],
)
def test_uris_are_joined(base: str, uri: str, whole: str) -> None:  # 1.5.1
    assert join(base, uri) == whole


@pytest.mark.parametrize("uri", ["../secret.vxml", "/etc/passwd", "ftp://x/y", "file:///x"])
def test_nothing_is_fetched_from_outside_the_folder(tmp_path: Path, uri: str) -> None:
    folder = tmp_path / "app"
    folder.mkdir()
    (folder.parent / "secret.vxml").write_text(vxml(block("<log>secret</log>")))
    text = vxml(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
        + block(f'<goto next="{uri}"/>')
    )
    (folder / "a.vxml").write_text(text)
    found, _ = loading.read_application(str(folder / "a.vxml"), text.encode())
    assert Bench(found).logs() == ["refused"]  # type: ignore[arg-type]


def test_a_link_of_the_file_system_leads_nowhere_outside(tmp_path: Path) -> None:
    folder = tmp_path / "app"
    folder.mkdir()
    (tmp_path / "secret.vxml").write_text(vxml(block("<log>secret</log>")))
    (folder / "in.vxml").symlink_to(tmp_path / "secret.vxml")
    text = vxml(block('<goto next="in.vxml"/>'))
    found, _ = loading.read_application(str(folder / "a.vxml"), text.encode())
    assert Bench(found).logs() == []  # type: ignore[arg-type]


def test_xml_base_of_the_network_is_refused() -> None:  # 1.5.1
    head = f'{HEAD[:-1]} xml:base="http://example.org/">'
    call = Call(
        vxml('<catch event="error.badfetch"><log>refused</log><exit/></catch>'
             + block('<goto next="b.vxml"/>'), head),
        b=vxml(block("<log>there</log>")),
    )  # fmt: skip
    assert call.logs() == ["refused"]


def test_a_version_2_0_document_runs() -> None:  # 1.5
    text = '<vxml version="2.0" xmlns="http://www.w3.org/2001/vxml"><form><block>Hi.</block></form></vxml>'
    assert Call(text).play() == ["Hi."]


# 3: input ------------------------------------------------------------------------------


def asked(content: str, *said: str, more: str = "", head: str = "") -> list[str]:
    """What a field logs when it is answered."""
    call = Call(head + ask(content, more=more))
    call.answer(*said)
    return call.logs()


def question(call: Call) -> dict[str, object]:
    """The arguments of the question that is being asked."""
    found = call.session.mediator.question()
    assert found is not None and found.command is not None
    return found.command.args


def test_an_inline_grammar_fills_its_field() -> None:  # 3.1.1
    call = Call(ask(rule("tea|coffee")))
    call.answer("Coffee!")
    assert call.logs() == ["coffee"]


def test_an_inline_grammar_of_the_vxml_namespace_is_a_grammar_too() -> None:  # 3.1.1.1
    call = Call(ask('<grammar version="1.0" root="r"><rule id="r">tea</rule></grammar>'))
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_tag_gives_the_meaning() -> None:  # 3.1.6
    call = Call(
        ask(
            f'<grammar {GRAMMAR} root="r" tag-format="semantics/1.0"><rule id="r">'
            "<one-of><item>big<tag>out = 10;</tag></item></one-of></rule></grammar>"
        )
    )
    call.answer("big")
    assert call.logs() == ["10"]


def test_an_inline_abnf_grammar_is_taken() -> None:  # 3.1.1.2
    call = Call(
        ask(
            '<grammar type="application/srgs" root="r"><![CDATA[#ABNF 1.0 UTF-8;\n'
            "language en;\nroot $r;\n$r = tea | coffee;]]></grammar>"
        )
    )
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_grammar_may_be_a_file() -> None:  # 3.1.1.3
    call = Call(ask('<grammar src="g.grxml"/>'), **{"g.grxml": file("tea|coffee")})
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_grammars_fragment_names_its_rule() -> None:  # 3.1.1.3
    text = (
        f'<grammar {GRAMMAR} xml:lang="en" root="a"><rule id="a" scope="public">no</rule>'
        '<rule id="b" scope="public">tea</rule></grammar>'
    )
    call = Call(ask('<grammar src="g.grxml#b"/>'), **{"g.grxml": text})
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_grammars_srcexpr_is_evaluated_when_it_listens() -> None:  # 2.1, 2
    call = Call(
        """<var name="n" expr="'a'"/><form><field name="f"><prompt>Well?</prompt>
        <grammar srcexpr="n + '.grxml'"/><nomatch><assign name="n" expr="'b'"/><reprompt/></nomatch>
        <filled><log expr="f"/></filled></field></form>""",
        **{"a.grxml": file("tea"), "b.grxml": file("coffee")},
    )
    call.answer("coffee", "coffee")
    assert call.logs() == ["coffee"]


def test_a_fields_grammar_comes_before_the_forms_and_the_links() -> None:  # 3.1.4
    call = Call(
        f'<link event="odd">{rule("tea")}</link><catch event="odd"><log>link</log><exit/></catch>'
        f'<form>{rule("tea")}<field name="f"><prompt>Well?</prompt>{rule("tea")}'
        "<filled><log>field</log><exit/></filled></field></form>"
    )
    call.answer("tea")
    assert call.logs() == ["field"]


def test_a_links_grammar_in_a_form_comes_before_the_documents() -> None:  # 3.1.4
    call = Call(
        f'<link event="outer">{rule("help me")}</link>'
        f'<form><link event="inner">{rule("help me")}</link>'
        '<catch event="inner outer"><log expr="_event"/><exit/></catch>'
        '<field name="f"><prompt>Well?</prompt><option>yes</option></field></form>'
    )
    call.answer("help me")
    assert call.logs() == ["inner"]


def test_of_two_grammars_of_one_scope_the_first_wins() -> None:  # 3.1.4
    call = Call(
        f'<link event="one">{rule("stop")}</link><link event="two">{rule("stop")}</link>'
        '<catch event="one two"><log expr="_event"/><exit/></catch>' + ask("<option>yes</option>")
    )
    call.answer("stop")
    assert call.logs() == ["one"]


def test_a_document_scoped_form_listens_while_another_dialog_waits() -> None:  # 3.1.3
    call = Call(
        ask("<option>yes</option>")
        + f'<form scope="document">{rule("weather")}<block><log>weather</log></block></form>'
    )
    call.answer("weather")
    assert call.logs() == ["weather"]


def test_a_dialog_scoped_form_does_not() -> None:  # 3.1.3
    call = Call(
        ask("<option>yes</option><nomatch><log>no</log><exit/></nomatch>")
        + f"<form>{rule('weather')}<block><log>weather</log></block></form>"
    )
    call.answer("weather")
    assert call.logs() == ["no"]


def test_one_grammar_of_a_form_may_have_document_scope() -> None:  # 3.1.3
    call = Call(
        ask("<option>yes</option><nomatch><log>no</log></nomatch>")
        + f"<form>{rule('weather', 'scope=' + chr(34) + 'document' + chr(34))}{rule('news')}"
        "<block><log>here</log></block></form>"
    )
    call.answer("news", "weather")
    assert call.logs() == ["no", "here"]


def test_a_grammar_of_dialog_scope_in_a_document_scoped_form_does_not_listen() -> None:  # 3.1.3
    call = Call(
        ask("<option>yes</option><nomatch><log>no</log><exit/></nomatch>")
        + f'<form scope="document">{rule("weather", "scope=" + chr(34) + "dialog" + chr(34))}'
        "<block><log>here</log></block></form>"
    )
    call.answer("weather")
    assert call.logs() == ["no"]


def test_a_document_scoped_menu_listens() -> None:  # 2.2
    call = Call(
        ask("<option>yes</option>")
        + '<menu scope="document"><choice next="#n">news</choice></menu>'
        '<form id="n"><block><log>news</log></block></form>'
    )
    call.answer("news")
    assert call.logs() == ["news"]


def test_a_forms_grammar_listens_in_its_fields() -> None:  # 3.1.3
    call = Call(
        f'<form><grammar {GRAMMAR} root="r" tag-format="semantics/1.0"><rule id="r">blue'
        "<tag>out.g = 'b';</tag></rule></grammar>"
        '<field name="f"><prompt>One?</prompt><option>yes</option></field>'
        '<field name="g"><prompt>Two?</prompt><option>no</option>'
        '<filled><log expr="g"/></filled></field></form>'
    )
    call.answer("blue", "yes")
    assert (call.logs(), call.ended) == (["b"], "exit")


def test_a_modal_field_hears_its_own_grammars_alone() -> None:  # 2.3.1
    call = Call(
        f'<link event="odd">{rule("operator")}</link>'
        + ask("<option>yes</option><nomatch><log>no</log></nomatch>", more='modal="true"')
    )
    call.answer("operator", "yes")
    assert call.logs() == ["no", "yes"]


def test_keys_fill_a_field_of_dtmf_mode() -> None:  # 3.1.2
    call = Call(ask(rule("1 2|3", 'mode="dtmf"') + "<log/>".replace("<log/>", "")))
    call.answer("12")
    assert call.logs() == ["12"]


def test_speech_is_no_dtmf() -> None:  # 3.1.2
    call = Call(ask(rule("1|2", 'mode="dtmf"') + "<nomatch><log>no</log><exit/></nomatch>"))
    call.answer("one")
    assert call.logs() == ["no"]


def test_the_input_mode_is_told() -> None:  # 2.3.1
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><option dtmf="1" value="a">apple</option>
        <filled><log expr="f$.inputmode"/><log expr="f"/></filled></field>
        <field name="g"><prompt>And?</prompt><option dtmf="1">apple</option>
        <filled><log expr="g$.inputmode"/></filled></field></form>"""
    )
    call.answer("1", "apple")
    assert call.logs() == ["dtmf", "a", "voice"]


def test_the_key_that_ends_an_input_is_no_part_of_it() -> None:  # 6.3.3
    call = Call(ask("", more='type="digits"'))
    call.answer("12#")
    assert call.logs() == ["12"]


@pytest.mark.parametrize(
    ("kind", "said", "value"),
    [
        ("boolean", "yes", "true"),
        ("boolean", "2", "false"),
        ("boolean?y=7;n=9", "7", "true"),
        ("digits", "one two three", "123"),
        ("digits?length=3", "456", "456"),
        ("number", "42", "42"),
        ("time", "half past five", "0530?"),
        ("currency", "$5.50", "USD5.50"),
        ("phone", "5551234", "5551234"),
        ("date", "19990204", "19990204"),
    ],
)
def test_built_in_types_give_their_values(kind: str, said: str, value: str) -> None:  # P
    call = Call(ask("", more=f'type="{kind}"'))
    call.answer(said)
    assert call.logs() == [value]


def test_digits_of_another_length_are_nomatch() -> None:  # P
    call = Call(ask("<nomatch><log>no</log><exit/></nomatch>", more='type="digits?length=3"'))
    call.answer("1234")
    assert call.logs() == ["no"]


def test_a_built_in_grammar_may_be_referred_to_by_uri() -> None:  # P
    call = Call(ask('<grammar src="builtin:dtmf/digits?minlength=2;maxlength=3"/>'))
    call.answer("12")
    assert call.logs() == ["12"]


def test_a_builtin_voice_grammar_takes_speech() -> None:  # P
    call = Call(ask('<grammar src="builtin:grammar/boolean"/>'))
    call.answer("yes")
    assert call.logs() == ["true"]


def test_an_unknown_built_in_type_is_unsupported() -> None:  # 2.3.1
    call = Call(
        '<catch event="error.unsupported.builtin"><log expr="_event"/><exit/></catch>'
        + ask("", more='type="x-colour"')
    )
    assert call.logs() == ["error.unsupported.builtin"]


def test_options_are_heard_by_their_text_and_give_their_value() -> None:  # 2.3.1.3
    call = Call(ask('<option value="m"> a  moose </option>'))
    call.answer("A moose.")
    assert call.logs() == ["m"]


def test_an_option_without_value_gives_its_text() -> None:  # 2.3.1.3
    call = Call(ask("<option> a  moose </option>"))
    call.answer("a moose")
    assert call.logs() == ["a moose"]


def test_an_option_without_text_gives_its_keys() -> None:  # 2.3.1.3
    call = Call(ask('<option dtmf="4"/>'))
    call.answer("4")
    assert call.logs() == ["4"]


def test_an_exact_option_takes_no_part_of_itself() -> None:  # 2.2.5
    call = Call(ask("<option>the big moose</option><nomatch><log>no</log><exit/></nomatch>"))
    call.answer("moose")
    assert call.logs() == ["no"]


def test_an_approximate_option_takes_parts_in_their_order() -> None:  # 2.2.5
    call = Call(
        ask('<option accept="approximate">the big moose</option><nomatch><log>no</log></nomatch>')
    )
    call.answer("moose big", "big moose")
    assert call.logs() == ["no", "the big moose"]


def test_a_menus_accept_is_that_of_its_choices() -> None:  # 2.2
    call = Call(
        '<menu accept="approximate"><prompt>Which?</prompt><choice event="a">local news</choice>'
        '<choice event="b" accept="exact">world news</choice></menu>'
        '<catch event="a b"><log expr="_event"/><exit/></catch>'
    )
    call.answer("news")
    assert call.logs() == ["a"]


def test_a_menu_numbers_choices_without_keys_of_their_own() -> None:  # 2.2
    call = Call(
        '<menu dtmf="true"><prompt>Which?</prompt><choice dtmf="0" event="z">zero</choice>'
        '<choice event="a">one</choice><choice event="b">two</choice></menu>'
        '<catch event="a b z"><log expr="_event"/><exit/></catch>'
    )
    call.answer("1")
    assert call.logs() == ["a"]


def test_a_choices_grammar_replaces_its_words() -> None:  # 2.2.5
    call = Call(
        f'<menu><prompt>Which?</prompt><choice event="a">{rule("football")}sports</choice>'
        "<nomatch><log>no</log></nomatch></menu>"
        '<catch event="a"><log expr="_event"/><exit/></catch>'
    )
    call.answer("sports", "football")
    assert call.logs() == ["no", "a"]


def test_a_slot_picks_a_part_of_the_meaning() -> None:  # 3.1.6
    call = Call(
        ask(
            f'<grammar {GRAMMAR} root="r" tag-format="semantics/1.0"><rule id="r">big'
            "<tag>out.size = {n: 3};</tag></rule></grammar>",
            more='slot="size.n"',
        )
    )
    call.answer("big")
    assert call.logs() == ["3"]


def test_a_meaning_without_the_fields_slot_is_the_fields_whole_value() -> None:  # 3.1.6.3
    call = Call(
        f'<form><field name="f"><prompt>Well?</prompt><grammar {GRAMMAR} root="r"'
        ' tag-format="semantics/1.0"><rule id="r">big<tag>out.a = 1; out.b = 2;</tag></rule>'
        '</grammar><filled><log expr="f.a + f.b"/></filled></field></form>'
    )
    call.answer("big")
    assert call.logs() == ["3"]


def test_lastresult_has_the_n_best_as_many_as_maxnbest_says() -> None:  # 5.1.5
    call = Call(
        '<property name="maxnbest" value="2"/>'
        + """<form><field name="f"><prompt>Well?</prompt>
        <option accept="approximate">red car</option><option accept="approximate">red bus</option>
        <option accept="approximate">red boat</option>
        <filled><log expr="application.lastresult$.length"/>
        <log expr="application.lastresult$[1].interpretation"/>
        <log expr="application.lastresult$.interpretation"/></filled></field></form>"""
    )
    call.answer("red")
    assert call.logs() == ["2", "red bus", "red car"]


N_BEST = """<property name="maxnbest" value="{}"/><form><field name="f"><prompt>Well?</prompt>
<option value="B">Boston</option><option value="A">Austin</option><option value="H">Houston</option>
<nomatch><foreach item="one" array="application.lastresult$"><log expr="'no ' + one.utterance + ' '
 + one.confidence"/></foreach></nomatch>
<filled><foreach item="one" array="application.lastresult$"><log expr="one.utterance + ' ' +
 one.confidence + ' ' + one.interpretation + ' ' + one.inputmode"/></foreach>
<log expr="f + ' ' + f$.utterance + ' ' + f$.confidence + ' ' + f$.interpretation + ' ' + f$.inputmode"/>
</filled></field></form>"""


@pytest.mark.parametrize(
    ("most", "said", "logged"),
    [
        (
            3,
            ("Boston", {"Austin": 0.6, "Houston": 0.5}),
            ["Boston 0.7 B voice", "Austin 0.6 A voice", "Houston 0.5 H voice"],
        ),
        (
            2,
            ("Boston", {"Austin": 0.6, "Houston": 0.5}),
            ["Boston 0.7 B voice", "Austin 0.6 A voice"],
        ),
        (1, ("Boston", {"Austin": 0.6}), ["Boston 0.7 B voice"]),
        (3, ("Bosten", {"Houston": 0.6, "Austin": 0.3}), ["Houston 0.6 H voice"]),
    ],
)
def test_lastresult_has_what_else_the_recogniser_has_heard(
    most: int, said: tuple[str, dict[str, float]], logged: list[str]
) -> None:  # 5.1.5
    call = Call(N_BEST.format(most))
    call.play()
    call.listens()
    call.hears(said[0], 0.7, **said[1])
    town, sure, code, _ = logged[0].split()
    assert call.logs() == [*logged, f"{code} {town} {sure} {code} voice"]


def test_what_the_recogniser_is_not_sure_of_is_nomatch_and_lastresult_tells() -> None:  # 5.1.5
    call = Call(N_BEST.format(2))
    call.play()
    call.listens()
    call.hears("Boston", 0.4, Austin=0.3, Houston=0.2)
    assert call.logs() == ["no Boston 0.4", "no Austin 0.3"]


def test_the_likeliest_words_decide_which_grammars_are_meant() -> None:  # 3.1.4
    call = Call(
        '<property name="maxnbest" value="5"/>'
        f'<link event="stop"><grammar {GRAMMAR} root="r"><rule id="r">stop</rule></grammar></link>'
        + ask("<option>shop</option><option>top</option>")
        + "<catch event='stop'><log expr='application.lastresult$.length'/></catch>"
    )
    call.play()
    call.listens()
    call.hears("stop", 0.9, shop=0.8, top=0.7)
    assert call.logs() == ["1"]


@pytest.mark.parametrize("value", ["inf", "nan", "-1", "many", "1e99", ""])
def test_a_maxnbest_that_is_none_is_one(value: str) -> None:  # 6.3.6
    assert asked(
        "<option>tea</option>", "tea", head=f'<property name="maxnbest" value="{value}"/>'
    ) == ["tea"]


def test_lastresult_has_one_result_unless_more_are_asked_for() -> None:  # 5.1.5
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><option>tea</option>
        <filled><log expr="application.lastresult$.length"/>
        <log expr="application.lastresult$[0].utterance"/>
        <log expr="application.lastresult$.confidence"/></filled></field></form>"""
    )
    call.answer("tea")
    assert call.logs() == ["1", "tea", "1"]


def test_nomatch_sets_lastresult() -> None:  # 5.1.5
    call = Call(
        ask(
            '<option>tea</option><nomatch><log expr="application.lastresult$.utterance"/></nomatch>'
        )
    )
    call.answer("coffee")
    assert call.logs() == ["coffee"]


def test_a_links_choice_sets_lastresult() -> None:  # 5.1.5
    call = Call(
        f'<link event="odd">{rule("operator")}</link>' + ask("<option>yes</option>")
        + '<catch event="odd"><log expr="application.lastresult$.utterance"/><exit/></catch>'
    )  # fmt: skip
    call.answer("operator")
    assert call.logs() == ["operator"]


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


def test_inputmodes_says_how_one_may_answer() -> None:  # 6.3.6
    call = Call(
        '<property name="inputmodes" value="voice"/>'
        + ask('<option dtmf="1">tea</option><nomatch><log>no</log></nomatch>')
    )
    call.answer("1", "tea")
    assert call.logs() == ["no", "tea"]


def test_universals_are_off_unless_a_property_names_them() -> None:  # 6.3.6
    call = Call(ask("<option>tea</option><nomatch><log>no</log><exit/></nomatch>"))
    call.answer("help")
    assert call.logs() == ["no"]


def test_universals_throw_their_events() -> None:  # 6.3.6
    call = Call(
        '<property name="universals" value="help exit"/>'
        + ask("<option>tea</option><help><log>helped</log></help>")
    )
    call.answer("help", "exit")
    assert (call.logs(), call.ended) == (["helped"], "exit")


def test_an_utterance_below_the_confidencelevel_is_nomatch() -> None:  # 6.3.2
    grammar = (
        f'<grammar {GRAMMAR} root="r"><rule id="r"><ruleref special="GARBAGE"/>tea</rule></grammar>'
    )
    low = '<nomatch><log expr="_event"/><exit/></nomatch>'
    said = "well well well well tea"
    head = '<property name="confidencelevel" value="{}"/>'
    assert asked(grammar + low, said, head=head.format(0.9)) == ["nomatch"]
    assert asked(grammar + low, said, head=head.format(0)) == ["tea"]


def test_a_tag_that_fails_is_told_and_the_grammar_does_not_match() -> None:
    call = Call(
        ask(
            f'<grammar {GRAMMAR} root="r" tag-format="semantics/1.0"><rule id="r">big'
            "<tag>out = none.x;</tag></rule></grammar><nomatch><log>no</log><exit/></nomatch>"
        )
    )
    call.answer("big")
    told, handled = call.logs()
    assert told.startswith("no match: ") and "none is not defined" in told
    assert handled == "no"


def test_a_grammars_srcexpr_that_fails_is_error_semantic() -> None:  # 2.1, 2
    call = Call(
        '<catch event="error.semantic"><log>bad</log><exit/></catch>'
        + ask('<grammar srcexpr="none"/>')
    )
    assert call.logs() == ["bad"]


def test_a_grammar_from_the_network_is_error_badfetch() -> None:
    call = Call(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
        + ask('<grammar src="http://example.org/g.grxml"/>')
    )
    assert call.logs() == ["refused"]


def recorded(said: str, more: str = "") -> list[str]:
    call = Call(
        f'<link event="odd">{rule("stop")}</link><catch event="odd"><log>odd</log><exit/></catch>'
        f'<form><record name="r" {more}><prompt>Speak.</prompt>'
        '<filled><log expr="r"/></filled></record></form>'
    )
    call.answer(said)
    return call.logs()


def test_a_record_takes_whatever_is_said() -> None:  # 2.3.6
    assert recorded("I like it") == ["I like it"]
    assert recorded("stop") == ["stop"]


def test_a_record_that_is_not_modal_hears_grammars_first() -> None:  # 2.3.6
    assert recorded("stop", 'modal="false"') == ["odd"]


def test_a_links_target_is_looked_for_where_it_is_heard() -> None:  # 2.5
    call = Call(
        leaf(ask("<option>yes</option>") + '<form id="x"><block><log>leaf x</log></block></form>'),
        root=vxml(f'<link next="#x">{rule("go")}</link>'
                  '<form id="x"><block><log>root x</log></block></form>'),
    )  # fmt: skip
    call.answer("go")
    assert call.logs() == ["leaf x"]


def test_a_link_of_the_root_is_relative_to_where_it_is_heard() -> None:  # 2.5
    call = Call(
        leaf(ask("<option>yes</option>"), root="sub/root.vxml"),
        **{
            "sub/root.vxml": vxml(f'<link next="x.vxml">{rule("go")}</link>'),
            "sub/x.vxml": vxml(block("<log>sub</log>")),
            "x.vxml": vxml(block("<log>top</log>")),
        },
    )
    call.answer("go")
    assert call.logs() == ["top"]


def test_an_event_that_no_handler_takes_is_lost_on_the_application() -> None:
    call = Call(ask("<option>yes</option>"))
    call.play()
    call.event("touch.head")
    call.answer("yes")
    assert (call.logs(), call.ended) == (["yes"], "exit")


def test_a_link_in_a_field_listens_in_that_field_alone() -> None:  # 2.5
    call = Call(
        f"""<form><catch event="odd"><log>odd</log></catch>
        <field name="f"><prompt>One?</prompt><link event="odd">{rule("stop")}</link>
        <option>yes</option></field>
        <field name="g"><prompt>Two?</prompt><option>yes</option>
        <nomatch><log>no</log><exit/></nomatch></field></form>"""
    )
    call.answer("stop", "yes", "stop")
    assert call.logs() == ["odd", "no"]


def test_a_link_may_be_followed_by_keys() -> None:  # 2.5
    call = Call(
        '<link event="odd" dtmf="* 9"/><catch event="odd"><log>odd</log><exit/></catch>'
        + ask("<option>yes</option>")
    )
    call.answer("*9")
    assert call.logs() == ["odd"]


def test_a_choices_keys_may_be_many() -> None:  # 2.2
    call = Call(
        '<menu><prompt>Which?</prompt><choice dtmf="1 2" event="a">one</choice>'
        '<choice dtmf="1 3" event="b">two</choice></menu>'
        '<catch event="a b"><log expr="_event"/><exit/></catch>'
    )
    call.answer("13")
    assert call.logs() == ["b"]


def test_a_field_may_have_many_grammars_of_both_modes() -> None:  # 3.1
    grammars = rule("tea") + rule("coffee") + rule("1|2", 'mode="dtmf"')
    assert asked(grammars, "coffee") == ["coffee"]
    assert asked(grammars, "2") == ["2"]


def test_a_type_and_a_grammar_listen_together() -> None:  # 2.3.1
    assert asked(rule("maybe"), "maybe", more='type="boolean"') == ["maybe"]
    assert asked(rule("maybe"), "no", more='type="boolean"') == ["false"]


def test_a_grammar_file_may_be_abnf() -> None:  # 3.1.1.3
    text = "#ABNF 1.0 UTF-8;\nlanguage en;\nroot $r;\npublic $r = tea | coffee;\n"
    call = Call(ask('<grammar src="g.gram" type="application/srgs"/>'), **{"g.gram": text})
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_grammar_file_may_refer_to_another_beside_it() -> None:  # 3.1.1.3; SISR 5
    call = Call(
        ask('<grammar src="g/a.grxml"/><nomatch><log>no</log></nomatch>'),
        **{
            "g/a.grxml": f'<grammar {GRAMMAR} xml:lang="en" root="r"><rule id="r">big'
            ' <ruleref uri="b.grxml"/></rule></grammar>',
            "g/b.grxml": file("tea"),
        },
    )
    call.answer("big tea")
    assert call.logs() == ["big tea"]


def test_a_grammars_weight_is_accepted() -> None:  # 3.1.1.4
    assert asked(rule("tea", 'weight="0.3"'), "tea") == ["tea"]


def test_a_grammar_in_another_language_is_taken() -> None:  # 3.1.1.4
    assert asked(rule("お茶", 'xml:lang="ja"'), "お茶") == ["お茶"]


def test_lastresult_is_kept_until_the_next_utterance() -> None:  # 5.1.5
    call = Call(
        """<form><field name="f"><prompt>One?</prompt><option>yes</option></field>
        <block><log expr="application.lastresult$.utterance"/></block></form>"""
    )
    call.answer("yes")
    assert call.logs() == ["yes"]


def test_lastresult_has_no_more_than_what_fits() -> None:  # 5.1.5
    head = '<property name="maxnbest" value="5"/>'
    logged = asked(
        '<option>tea</option><option>coffee</option><filled><log expr="application.lastresult$.length"/></filled>',
        "tea",
        head=head,
    )
    assert logged == ["1", "tea"]


# 4: output -----------------------------------------------------------------------------


def said(content: str, **files: str) -> list[str]:
    """What a block says."""
    return Call(f"<form><block>{content}</block></form>", **files).play()


def test_prompts_of_many_blocks_queue_in_their_order() -> None:  # 4.1.8
    call = Call(
        """<form><block>One.</block><block><prompt>Two.</prompt><goto next="#b"/></block></form>
        <form id="b"><block>Three.</block></form>"""
    )
    assert call.play() == ["One.", "Two.", "Three."]


def test_queued_prompts_are_played_before_the_application_ends() -> None:  # 4.1.8
    call = Call(block("Bye.<exit/>"))
    assert (call.play(), call.ended) == (["Bye."], "exit")


def test_text_and_values_without_a_prompt_are_one_prompt() -> None:  # 4.1.2
    assert said('<var name="n" expr="3"/>You have <value expr="n"/> letters.') == [
        "You have 3 letters."
    ]


def test_a_prompts_condition_is_evaluated() -> None:  # 4.1
    assert said('<prompt cond="1 > 2">No.</prompt><prompt cond="2 > 1">Yes.</prompt>') == ["Yes."]


def test_a_recording_is_heard_as_its_text() -> None:  # 4.1.3
    assert said('<audio src="hello.wav">Hello!</audio>') == ["Hello!"]


def test_a_recording_without_text_is_named() -> None:  # 4.1.3
    assert said('<audio src="sounds/bell.wav"/>') == ["[bell.wav]"]


def test_a_recordings_name_may_be_an_expression() -> None:  # 4.1.3
    assert said("<audio expr=\"'be' + 'll.wav'\"/>") == ["[bell.wav]"]


def test_a_recording_whose_expression_is_undefined_is_not_heard_at_all() -> None:  # 4.1.3
    assert said('One. <audio expr="undefined">Two.</audio> Three.') == ["One. Three."]


def test_a_recordings_text_may_hold_a_recording() -> None:  # 4.1.3
    assert said('<audio src="a.wav"><audio src="b.wav">Text.</audio></audio>') == ["Text."]


@pytest.mark.parametrize(
    ("markup", "words"),
    [
        ('<sub alias="World Wide Web">WWW</sub> here', "World Wide Web here"),
        ('<say-as interpret-as="date">May 5</say-as>', "May 5"),
        ("One<break/>two", "One two"),
        ('One<break time="500ms"/>two', "One two"),
        ("<emphasis>Very</emphasis> good", "Very good"),
        ("<p><s>One.</s><s>Two.</s></p>", "One. Two."),
        ("<p>One.</p><p>Two.</p>", "One. Two."),
        ('<voice gender="female">Hi</voice> there', "Hi there"),
        ('<prosody rate="slow">Slow</prosody>', "Slow"),
        ('<phoneme ph="x">tomato</phoneme>', "tomato"),
        ('<mark name="m"/>Hi', "Hi"),
        ('<lexicon uri="l.xml"/>Hi', "Hi"),
        ("<metadata><x>y</x></metadata>Hi", "Hi"),
        ('<audio src="a.wav">Hi<desc>a bell</desc></audio>', "Hi"),
        ('<value expr="1 + 1"/>', "2"),
        ("<value expr=\"'a' + 'b'\"/>c", "abc"),
        ('<value expr="[1, 2]"/>', "1,2"),
        ('<value expr="undefined"/>', "undefined"),
        ("Many\n   spaces", "Many spaces"),
        ("<![CDATA[1 < 2]]>", "1 < 2"),
    ],
)
def test_markup_is_read_for_its_words(markup: str, words: str) -> None:  # 4.1.1
    assert said(f"<prompt>{markup}</prompt>") == [words]


def test_an_undeclared_variable_in_a_value_is_error_semantic() -> None:  # 4.1.4
    call = Call('<catch event="error.semantic"><log>bad</log><exit/></catch>'
                + block('<value expr="none"/>'))  # fmt: skip
    assert call.logs() == ["bad"]


def test_foreach_says_its_content_for_each_element() -> None:  # 2.1, 6
    assert said(
        """<var name="a" expr="['x', 'y']"/>
        <prompt>Now <foreach item="i" array="a">letter <value expr="i"/>,</foreach></prompt>"""
    ) == ["Now letter x, letter y,"]


def test_foreach_runs_executable_content() -> None:  # 2.1, 6
    call = Call(block('<foreach item="i" array="[1, 2, 3]"><log expr="i"/></foreach>'))
    assert call.logs() == ["1", "2", "3"]


def test_foreach_over_no_array_is_error_semantic() -> None:  # 2.1, 6
    call = Call(block('<foreach item="i" array="5"><log expr="i"/></foreach>'))
    assert call.ended.startswith("error.semantic")


def test_foreach_works_on_a_copy_of_the_array() -> None:  # 2.1, 6
    call = Call(
        block("""<var name="a" expr="[1, 2]"/><foreach item="i" array="a">
        <script>a.push(9)</script><log expr="i"/></foreach>""")
    )
    assert call.logs() == ["1", "2"]


def test_prompts_taper_by_their_counts() -> None:  # 4.1.6
    call = Call(
        """<form><field name="f"><prompt count="1">One?</prompt><prompt count="3">Three?</prompt>
        <option>yes</option><nomatch><reprompt/></nomatch></field></form>"""
    )
    for _ in range(3):
        call.answer("no")
    assert call.said() == ["One?", "One?", "Three?", "Three?"]


def test_a_count_whose_condition_fails_is_left_out() -> None:  # 4.1.6
    call = Call(
        """<form><field name="f"><prompt>One?</prompt><prompt count="2" cond="false">Two?</prompt>
        <option>yes</option><nomatch><reprompt/></nomatch></field></form>"""
    )
    call.answer("no")
    assert call.said() == ["One?", "One?"]


def test_all_prompts_of_one_count_are_said() -> None:  # 4.1.6
    call = Call(
        '<form><field name="f"><prompt>One.</prompt><prompt>Two?</prompt><option>y</option>'
        "</field></form>"
    )
    assert call.play() == ["One.", "Two?"]


def test_clear_resets_the_prompts_counter() -> None:  # 5.3.3
    call = Call(
        """<form><field name="f"><prompt>One?</prompt><prompt count="2">Two?</prompt>
        <option>yes</option><nomatch><clear namelist="f"/><reprompt/></nomatch></field></form>"""
    )
    call.answer("no")
    assert call.said() == ["One?", "One?"]


@pytest.mark.parametrize(
    ("property_value", "attribute", "expected"),
    [("true", "false", False), ("false", "true", True), ("false", "", False), ("", "", True)],
)
def test_bargein_of_a_prompt_comes_before_the_property(
    property_value: str, attribute: str, expected: bool
) -> None:  # 4.1.5
    own = f'<property name="bargein" value="{property_value}"/>' if property_value else ""
    call = Call(
        f"""{own}<form><field name="f"><prompt {f'bargein="{attribute}"' if attribute else ""}>
        Well?</prompt><option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["bargein"] is expected


def test_the_last_prompts_timeout_counts() -> None:  # 4.1.7
    call = Call(
        """<form><field name="f"><prompt timeout="1s">One.</prompt><prompt timeout="2s">Two?</prompt>
        <option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["timeout"] == 2000


def test_a_prompt_without_timeout_has_that_of_the_property() -> None:  # 4.1.7
    call = Call(
        """<form><property name="timeout" value="3s"/><field name="f">
        <prompt timeout="1s">One.</prompt><prompt>Two?</prompt><option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["timeout"] == 3000


def test_without_any_timeout_it_is_the_platforms() -> None:  # 4.1.7
    call = Call(ask("<option>yes</option>"))
    call.play()
    assert question(call)["timeout"] == 5000


def test_enumerate_lists_the_choices() -> None:  # 2.2.4
    call = Call(
        """<menu><prompt>Choose <enumerate/>.</prompt><choice event="a">red</choice>
        <choice event="b">blue</choice></menu>"""
    )
    assert call.play() == ["Choose red; blue."]


def test_enumerate_has_a_template_of_prompt_and_keys() -> None:  # 2.2.4
    call = Call(
        """<menu dtmf="true"><prompt><enumerate>For <value expr="_prompt"/>, press
        <value expr="_dtmf"/>.</enumerate></prompt><choice event="a">red</choice>
        <choice event="b">blue</choice></menu>"""
    )
    assert call.play() == ["For red, press 1. For blue, press 2."]


def test_enumerate_counts_as_the_keys_do() -> None:  # 2.2.4
    call = Call(
        """<menu dtmf="true"><prompt><enumerate><value expr="_dtmf"/></enumerate></prompt>
        <choice dtmf="0" event="a">red</choice><choice event="b">blue</choice></menu>"""
    )
    assert call.play() == ["0 1"]


def test_enumerate_lists_a_fields_options() -> None:  # 2.3.1.3
    call = Call(
        """<form><field name="f"><prompt>One of <enumerate/>?</prompt><option>red</option>
        <option>blue</option></field></form>"""
    )
    assert call.play() == ["One of red; blue?"]


def languages(call: Call) -> list[tuple[str, str]]:
    """Everything said, with its language."""
    call.play()
    return [
        (order.command.text or "", order.command.lang)
        for order in call.orders
        if order.verb == "start" and order.command is not None
    ]


def test_a_prompts_language_is_its_own_or_its_documents() -> None:  # 4.1
    call = Call(block('<prompt>Hello.</prompt><prompt xml:lang="ja">どうぞ。</prompt>'))
    assert languages(call) == [("Hello.", "en"), ("どうぞ。", "ja")]


def test_a_part_of_a_prompt_may_be_of_another_language() -> None:  # 4.1.1
    call = Call(block('<prompt>Say <voice xml:lang="fr">bonjour</voice> now.</prompt>'))
    assert languages(call) == [("Say", "en"), ("bonjour", "fr"), ("now.", "en")]


def test_a_questions_language_is_its_prompts() -> None:  # 4.1
    call = Call(
        '<form><field name="f"><prompt xml:lang="ja">どこ？</prompt><option>a</option></field></form>'
    )
    assert languages(call) == [("どこ？", "ja")]


def test_a_command_at_the_end_of_a_question_comes_after_its_words() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt>Where? <p:turn angle='3'/></prompt><option>a</option>"
        "</field></form>"
    )
    assert started(call) == ["Where?", "turn", "q-and-a"]


def test_text_in_an_item_is_its_prompt() -> None:  # 4.1.2
    call = Call(
        '<form><field name="f">Pick <value expr="1 + 1"/> now.<option>a</option></field></form>'
    )
    assert call.play() == ["Pick 2 now."]


def test_prompts_in_another_document_have_its_language() -> None:  # 4.1
    other = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="ja">'
    call = Call(
        block('<goto next="o.vxml"/>'), o=f"{other}<form><block>はい。</block></form></vxml>"
    )
    assert languages(call) == [("はい。", "ja")]


@pytest.mark.parametrize(
    "attributes",
    ['bargeintype="speech"', 'bargeintype="hotword"', 'xml:base="sounds/"', 'count="1"'],
)
def test_other_attributes_of_a_prompt_are_accepted(attributes: str) -> None:  # 4.1
    assert said(f"<prompt {attributes}>Hi.</prompt>") == ["Hi."]


def test_prompts_in_a_handler_are_queued() -> None:  # 4.1.8
    call = Call(
        '<form><catch event="odd">Oh. <exit/></catch><block>One. <throw event="odd"/></block></form>'
    )
    assert call.play() == ["One.", "Oh."]


def test_enumerate_tells_the_keys_of_options() -> None:  # 2.2.4
    call = Call(
        """<form><field name="f"><prompt><enumerate><value expr="_dtmf"/> for
        <value expr="_prompt"/>.</enumerate></prompt><option dtmf="7">red</option></field></form>"""
    )
    assert call.play() == ["7 for red."]


def test_foreach_may_stand_in_foreach() -> None:  # 2.1, 6
    assert said(
        """<prompt><foreach item="i" array="[[1, 2], [3]]"><foreach item="j" array="i">
        <value expr="j"/></foreach>;</foreach></prompt>"""
    ) == ["1 2; 3;"]


def test_what_is_said_at_once_is_bounded() -> None:
    call = Call(
        block(
            """<script>var a = 'x'.repeat(5000); var n = []; for (var i = 0; i &lt; 300; i++) n.push(i);
            </script><foreach item="i" array="n"><value expr="a"/></foreach>"""
        )
    )
    assert "characters come out at once" in call.ended


def test_a_log_has_a_label_content_and_an_expression() -> None:  # 5.3.13
    call = Call(block('<log label="note" expr="1 + 1">sum <value expr="3"/></log>'))
    assert call.logs() == ["note: sum 3 2"]


# 6: properties, parameters, resources -----------------------------------------------------


@pytest.mark.parametrize("level", range(1, 5))
def test_a_property_counts_where_it_is_nearest(level: int) -> None:  # 6.3.1
    lines = [f'<property name="timeout" value="{n}s"/>' for n in range(1, 5)]
    root, page, form, item = (line if n < level else "" for n, line in enumerate(lines))
    call = Call(
        leaf(
            f'{page}<form>{form}<field name="f">{item}<prompt>Well?</prompt><option>yes</option>'
            "</field></form>"
        ),
        root=vxml(root),
    )
    call.play()
    assert question(call)["timeout"] == level * 1000


def test_of_two_properties_of_one_level_the_last_counts() -> None:  # 6.3.1
    call = Call(
        '<property name="timeout" value="1s"/><property name="timeout" value="2s"/>'
        + ask("<option>yes</option>")
    )
    call.play()
    assert question(call)["timeout"] == 2000


def test_a_property_of_a_menu_counts_in_it() -> None:  # 6.3.1
    call = Call(
        """<property name="timeout" value="1s"/><menu><property name="timeout" value="4s"/>
        <prompt>Which?</prompt><choice event="a">one</choice></menu>"""
    )
    call.play()
    assert question(call)["timeout"] == 4000


@pytest.mark.parametrize("value", ["", "5", "soon", "-1s"])
def test_a_timeout_that_is_no_time_is_the_platforms(value: str) -> None:  # 6.3.4
    call = Call(f'<property name="timeout" value="{value}"/>' + ask("<option>yes</option>"))
    call.play()
    assert question(call)["timeout"] == 5000


def test_a_subdialogs_source_may_be_an_expression() -> None:  # 2.1, 2
    call = Call(
        """<form><subdialog name="r" srcexpr="'#' + 's'"><filled><log expr="r.a"/></filled>
        </subdialog></form><form id="s"><var name="a" expr="3"/><block><return namelist="a"/></block></form>"""
    )
    assert call.logs() == ["3"]


def test_an_unknown_property_is_ignored() -> None:  # 6.3
    assert Call('<property name="x.y" value="z"/>' + block("<log>on</log>")).logs() == ["on"]


def test_a_param_has_an_expression_or_a_value() -> None:  # 6.4
    call = Call(
        """<form><subdialog name="r" src="#s"><param name="a" expr="1 + 1"/>
        <param name="b" value="x" valuetype="data"/><filled><log expr="r.c"/></filled></subdialog></form>
        <form id="s"><var name="a"/><var name="b"/><var name="c"/>
        <block><assign name="c" expr="a + b"/><return namelist="c"/></block></form>"""
    )
    assert call.logs() == ["2x"]


def test_a_param_takes_precedence_over_a_variables_expression() -> None:  # 2.3.4
    call = Call(
        """<form><subdialog name="r" src="#s"><param name="a" expr="1"/></subdialog></form>
        <form id="s"><var name="a" expr="5"/><block><log expr="a"/><return/></block></form>"""
    )
    assert call.logs() == ["1"]


def test_a_param_without_variable_is_error_semantic() -> None:  # 2.3.4
    call = Call(
        """<catch event="error.semantic"><log>bad</log><exit/></catch>
        <form><subdialog name="r" src="#s"><param name="a" expr="1"/></subdialog></form>
        <form id="s"><block><log>in</log><return/></block></form>"""
    )
    assert call.logs() == ["bad"]


def test_meta_and_metadata_change_nothing() -> None:  # 6.2
    call = Call(
        '<meta name="author" content="A"/><meta http-equiv="Expires" content="0"/>'
        '<metadata><rdf:RDF xmlns:rdf="urn:r"><rdf:x>text</rdf:x></rdf:RDF></metadata>'
        + block("<log>on</log>")
    )
    assert call.logs() == ["on"]


FETCH = 'fetchhint="safe" fetchtimeout="3s" maxage="0" maxstale="10"'


@pytest.mark.parametrize(
    "body",
    [
        f'<script src="s.js" {FETCH}/><form><block/></form>',
        f'<link next="#a" {FETCH}><grammar src="g.grxml" {FETCH}/></link><form id="a"><block/></form>',
        f'<form><block><goto next="o.vxml" {FETCH} fetchaudio="a.wav"/></block></form>',
        f'<form><block><submit next="o.vxml" {FETCH} method="post"/></block></form>',
        f'<form><block><data name="d" src="d.xml" {FETCH}/></block></form>',
        f'<form><block><audio src="a.wav" {FETCH}>A</audio></block></form>',
        f'<form><subdialog src="o.vxml" {FETCH}/></form>',
    ],
)
def test_fetching_attributes_are_accepted(body: str) -> None:  # 6.1
    call = Call(
        body,
        o=vxml("<form><block/></form>"),
        **{"s.js": "var a = 1;", "g.grxml": file("a"), "d.xml": "<d/>"},
    )
    call.play()
    assert not call.ended.startswith("error")


def test_a_script_may_be_a_file() -> None:  # 5.3.12
    call = Call(
        '<script src="s.js"/>' + block('<log expr="f(2)"/>'),
        **{"s.js": "function f(x) { return x + 1; }"},
    )
    assert call.logs() == ["3"]


def test_a_scripts_srcexpr_is_evaluated() -> None:  # 2.1, 3
    call = Call(
        block('<var name="n" expr="\'s\'"/><script srcexpr="n + \'.js\'"/><log expr="a"/>'),
        **{"s.js": "var a = 4;"},
    )
    assert call.logs() == ["4"]


def test_a_script_that_is_not_there_is_error_badfetch() -> None:  # 5.3.12
    call = Call(block('<script src="none.js"/>'))
    assert call.ended.startswith("error.badfetch")


def test_a_scripts_charset_is_accepted() -> None:  # 5.3.12
    call = Call(
        block('<script src="s.js" charset="UTF-8"/><log expr="a"/>'), **{"s.js": "var a = 'é';"}
    )
    assert call.logs() == ["é"]


def test_a_scripts_text_may_be_cdata() -> None:  # 5.3.12
    call = Call(block('<script><![CDATA[var a = 1 < 2 && 3 > 2;]]></script><log expr="a"/>'))
    assert call.logs() == ["true"]


def test_a_script_that_fails_is_error_semantic_with_its_place() -> None:  # 5.2.6
    call = Call("<form>\n<block><script>\nnone();</script></block></form>")
    assert call.ended.startswith("error.semantic: app.vxml:3")


# 2.1: data, marks, disconnect, transfer ---------------------------------------------------

NEWS = (
    '<!-- c --><news xmlns:x="urn:x" date="today"><item id="a">one</item><x:item id="b">two</x:item>'
    "<empty/></news>"
)


@pytest.mark.parametrize(
    ("code", "value"),
    [
        ("d.documentElement.nodeName", "news"),
        ("d.nodeType", "9"),
        ("d.documentElement.nodeType == d.ELEMENT_NODE", "true"),
        ("d.documentElement.getAttribute('date')", "today"),
        ("d.documentElement.getAttribute('none') == ''", "true"),
        ("d.documentElement.attributes.getNamedItem('date').value", "today"),
        ("d.documentElement.childNodes.length", "3"),
        ("d.documentElement.firstChild.firstChild.data", "one"),
        ("d.documentElement.firstChild.nextSibling.nodeName", "x:item"),
        ("d.documentElement.lastChild.previousSibling.textContent", "two"),
        ("d.documentElement.lastChild.hasChildNodes()", "false"),
        ("d.documentElement.firstChild.parentNode.nodeName", "news"),
        ("d.documentElement.firstChild.ownerDocument == d", "true"),
        ("d.getElementsByTagName('item').length", "1"),
        ("d.getElementsByTagNameNS('urn:x', 'item').item(0).textContent", "two"),
        ("d.getElementsByTagName('*').length", "4"),
        ("d.getElementsByTagName('item').item(9) === null", "true"),
        ("d.getElementById('b').textContent", "two"),
        ("d.documentElement.lastChild.namespaceURI === null", "true"),
        ("(d.documentElement.nodeName = 'x', d.documentElement.nodeName)", "news"),
    ],
)
def test_data_gives_a_dom(code: str, value: str) -> None:  # 2.1, 5 and D
    call = Call(block(f'<data name="d" src="d.xml"/><log expr="{code}"/>'), **{"d.xml": NEWS})
    assert call.logs() == [value]


def test_the_dom_cannot_be_changed() -> None:  # 2.1, D
    call = Call(
        block(
            """<data name="d" src="d.xml"/><script>var c = 0;
            try { d.documentElement.removeChild(d.documentElement.firstChild); }
            catch (e) { c = e.code; }</script><log expr="c"/>"""
        ),
        **{"d.xml": NEWS},
    )
    assert call.logs() == ["7"]


def test_data_may_stand_in_a_document_and_in_a_form() -> None:  # 2.1, 5
    call = Call(
        """<data name="d" srcexpr="'d' + '.xml'"/><form><data name="e" src="d.xml"/>
        <block><log expr="d.documentElement.nodeName + e.documentElement.nodeName"/></block></form>""",
        **{"d.xml": "<n/>"},
    )
    assert call.logs() == ["nn"]


@pytest.mark.parametrize("content", ["<a", "", "not xml"])
def test_data_that_is_not_xml_is_error_badfetch(content: str) -> None:  # 2.1, 5
    call = Call(block('<data name="d" src="d.xml"/>'), **{"d.xml": content})
    assert call.ended.startswith("error.badfetch")


def test_data_without_name_is_fetched_and_forgotten() -> None:  # 2.1, 5
    call = Call(block('<data src="d.xml"/><log>on</log>'), **{"d.xml": "<n/>"})
    assert call.logs() == ["on"]


def test_data_that_is_not_there_is_error_badfetch() -> None:  # 2.1, 5
    call = Call(block('<data name="d" src="none.xml"/>'))
    assert call.ended.startswith("error.badfetch")


def test_the_last_mark_before_an_answer_is_told() -> None:  # 2.1, 4
    call = Call(
        """<form><field name="f"><prompt>One <mark name="a"/> two <mark nameexpr="'b' + 1"/>?</prompt>
        <option>yes</option><filled><log expr="f$.markname"/>
        <log expr="application.lastresult$.markname"/></filled></field></form>"""
    )
    call.answer("yes")
    assert call.logs() == ["b1", "b1"]


def test_without_marks_there_is_no_name_of_one() -> None:  # 2.1, 4
    call = Call(
        """<form><block><prompt><mark name="a"/>Hi.</prompt></block><field name="f"><prompt>Well?</prompt>
        <option>yes</option><filled><log expr="f$.markname"/></filled></field>
        <field name="g"><prompt>And?</prompt><option>yes</option>
        <filled><log expr="typeof g$.markname"/></filled></field></form>"""
    )
    call.answer("yes", "yes")
    assert call.logs() == ["a", "undefined"]


def test_disconnect_has_a_namelist() -> None:  # 2.1, 8
    call = Call(block('<var name="a" expr="1"/><disconnect namelist="a"/>'))
    assert (call.logs(), call.ended) == (
        ['disconnect: {"a": 1}'],
        "connection.disconnect.hangup",
    )


def test_disconnect_of_an_undeclared_variable_is_error_semantic() -> None:  # 2.1, 8
    call = Call(block('<disconnect namelist="none"/>'))
    assert call.ended.startswith("error.semantic")


def test_exit_gives_its_values_to_the_transcript() -> None:  # 5.3.9
    assert Call(block("<exit expr=\"'done'\"/>")).logs() == ['exit: "done"']
    call = Call(block('<var name="a" expr="[1]"/><exit namelist="a"/>'))
    assert (call.logs(), call.ended) == (['exit: {"a": [1]}'], "exit")


def test_a_consultation_transfer_takes_the_caller_away() -> None:  # 2.1, 7
    call = Call(
        """<form><transfer name="t" dest="tel:+1" type="consultation"/>
        <catch event="connection.disconnect.transfer"><log>gone</log><exit/></catch></form>"""
    )
    call.play()
    assert call.logs() == ["gone"]


def test_a_transfers_destination_may_be_an_expression() -> None:  # 2.3.7
    call = Call(
        """<form><transfer name="t" destexpr="'tel:' + 1" bridge="true">
        <filled><log expr="t"/></filled></transfer></form>"""
    )
    call.play()
    assert call.logs() == ["noanswer"]


def test_submit_fetches_a_document_of_the_folder() -> None:  # 5.3.8
    call = Call(
        block('<var name="a" expr="1"/><submit next="o.vxml" namelist="a"/>'),
        o=vxml(block("<log>there</log>")),
    )
    assert call.logs() == ["there"]


def test_submit_of_an_undeclared_variable_is_error_semantic() -> None:  # 5.3.8
    call = Call(block('<submit next="o.vxml" namelist="none"/>'), o=vxml(block("")))
    assert call.ended.startswith("error.semantic")


def test_submit_to_a_service_sends_and_the_reply_is_an_event() -> None:
    call = Call(
        """<catch event="reply.weather"><log expr="session.event.data.sky"/><exit/></catch>
        <form><block><var name="city" expr="'Nara'"/><submit next="service:weather#wait" namelist="city"/>
        </block></form><form id="wait"><field name="f"><prompt>One moment.</prompt>
        <option>stop</option></field></form>"""
    )
    assert [o.data for o in call.orders if o.verb == "send"] == [
        {"to": "weather", "params": {"city": "Nara"}}
    ]
    call.event("reply.weather", sky="blue")
    assert call.logs() == ["blue"]


# Commands of the robot ------------------------------------------------------------------


def started(call: Call) -> list[str]:
    call.play()
    return [r.get("text") or r["command"] for r in call.phases("start")]


def test_a_command_in_a_prompt_stands_where_it_is_written() -> None:
    call = Call(
        f"<form {P}><block><prompt>Look <p:turn angle='30'/> there.</prompt></block></form>"
    )
    assert started(call) == ["Look", "turn", "there."]


def test_a_command_in_a_fields_prompt_comes_before_the_question() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt><p:gesture name='nod'/>Well?</prompt>"
        "<option>yes</option></field></form>"
    )
    assert started(call) == ["gesture", "Well?"]


def test_a_commands_arguments_may_be_expressions_and_its_text_holds_values() -> None:
    call = Call(
        f"<form {P}><block><var name='a' expr='40'/>"
        "<p:turn-and-speak angle-expr='a + 5'>By <value expr='a'/>!</p:turn-and-speak></block></form>"
    )
    assert started(call) == ["By 40!"]
    assert call.orders[0].command is not None and call.orders[0].command.args == {"angle": 45}


def test_a_command_in_a_foreach_is_asked_for_each_time() -> None:
    call = Call(
        f"<form {P}><block><prompt><foreach item='i' array='[1, 2]'>"
        "<value expr='i'/> <p:turn angle-expr='i'/></foreach></prompt></block></form>"
    )
    assert started(call) == ["1", "turn", "2", "turn"]


def test_a_command_in_a_handler_and_in_an_if() -> None:
    call = Call(
        f"<catch event='odd' {P}><if cond='true'><p:turn angle='1'/><else/><p:turn angle='2'/></if>"
        "<exit/></catch>" + block('<throw event="odd"/>')
    )
    assert started(call) == ["turn"]


def problems_of(body: str) -> list[Problem]:
    """What is wrong with a document."""
    try:
        return list(read_page("d.vxml", "d.vxml", vxml(body).encode()).problems)
    except DocumentError as error:
        return error.problems


def spans(call: Call) -> dict[str, tuple[float, float]]:
    """When each Command begins and ends, by its words or its name."""
    call.play()
    begins = {r["behavior"]: r for r in call.phases("start") if r["command"] != "iu"}
    ends = {r["behavior"]: r["time"] for r in call.phases("end")}
    return {r.get("text") or r["command"]: (r["time"], ends[key]) for key, r in begins.items()}


def test_branches_run_at_once_and_what_follows_waits_for_all() -> None:  # U3
    found = spans(
        Call(
            f"<form {P}><block>One. <p:par><p:speak>Two is <value expr='1 + 1'/>.</p:speak><p:seq>"
            "<p:gesture name='nod'/><p:turn angle='5'/></p:seq></p:par> Three.</block></form>"
        )
    )
    assert found["Two is 2."][0] == found["gesture"][0] == found["One."][1]
    assert found["turn"][0] == found["gesture"][1]
    assert found["Three."][0] == max(found["Two is 2."][1], found["turn"][1])


def test_a_unit_around_commands_is_one_behavior() -> None:  # U4
    call = Call(
        f"<form {P}><block><p:iu longest='8s' restartable='true'><p:gesture name='nod'/><p:par>"
        "<p:speak>Mind the step.</p:speak><p:move-head pan='5'/></p:par></p:iu></block></form>"
    )
    found = spans(call)
    [unit] = [r for r in call.phases("request") if r["command"] == "iu"]
    assert set(unit["devices"]) >= {"speaker", "neck"}
    inside = [r for r in call.phases("start") if r.get("unit")]
    assert inside[0]["command"] == "gesture" and len(inside) == 3
    assert found["Mind the step."][0] == found["move-head"][0] == found["gesture"][1]


def test_arranged_commands_in_a_prompt_come_before_the_question() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt>Look. <p:par><p:turn angle='5'/>"
        "<p:speak>There.</p:speak></p:par>Well?</prompt><option>yes</option></field></form>"
    )
    assert started(call)[:4] == ["Look.", "turn", "There.", "Well?"]


def test_arranged_commands_may_stand_in_handlers_conditions_and_loops() -> None:
    call = Call(
        f"<form {P}><block><foreach item='i' array='[1, 2]'><if cond='i == 2'>"
        "<p:par><p:turn angle-expr='i'/><p:speak>Now</p:speak></p:par></if></foreach></block></form>"
    )
    assert started(call) == ["turn", "Now"]


@pytest.mark.parametrize(
    ("body", "code", "told"),
    [
        ("<p:iu><p:topological-move to='a'/></p:iu>", "not-in-unit", "leaves the user"),
        ("<p:iu><p:par><p:tracking-human/></p:par></p:iu>", "not-in-unit", "feedback loop"),
        ("<p:par/>", "empty", "holds no Command"),
        ("<p:par><prompt>Hm.</prompt></p:par>", "misplaced-element", "Write what is said as"),
        ("<p:par><p:par/></p:par>", "misplaced-element", "cannot stand in <p:par>"),
        ("<p:par>Hm.</p:par>", "stray-text", "Write it into a <p:speak>"),
        ("<p:iu longer='2s'><p:speak>a</p:speak></p:iu>", "unknown-attribute", '"longest"'),
        ("<p:iu longest='2'><p:speak>a</p:speak></p:iu>", "bad-value", "2"),
        ("<p:seq><p:turn angel='2'/></p:seq>", "unknown-attribute", '"angle"'),
        ("<iu><p:turn angle='2'/></iu>", "unknown-element", "Write <p:iu> around Commands"),
        ("<p:iuu/>", "unknown-element", '"iu"'),
    ],
)
def test_wrong_arrangements_are_told(body: str, code: str, told: str) -> None:
    problems = problems_of(f"<form {P}><block>{body}</block></form>")
    [problem] = [one for one in problems if one.code == code]
    assert problem.severity == "error"
    assert told in f"{problem.message} {problem.remedy}"


def test_branches_that_share_a_device_are_told() -> None:
    body = (
        "<p:par><p:speak>a</p:speak><p:seq><p:turn angle='1'/><p:speak>b</p:speak></p:seq></p:par>"
    )
    [problem] = problems_of(f"<form {P}><block>{body}</block></form>")
    assert (problem.code, problem.severity) == ("shared-device", "warning")
    around = problems_of(f"<form {P}><p:par><field name='f'/></p:par></form>")
    assert "it is around Commands" in around[0].message


def test_a_wrong_argument_is_an_event_when_it_is_asked_for() -> None:
    call = Call(
        f"<catch event='error' ><log expr='_event'/><exit/></catch>"
        f"<form {P}><block><p:turn angle='far'/></block><field name='f'><option>yes</option></field></form>"
    )
    call.play()
    assert call.logs() == ["error.semantic"]


def test_a_wrong_argument_at_the_very_end_ends_the_application_with_its_error() -> None:
    call = Call(f"<form {P}><block><p:turn angle='far'/></block></form>")
    assert call.ended.startswith("error.semantic")


# Checking -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("<frm/>", "unknown-element"),
        ("<form><blok/></form>", "unknown-element"),
        ("<block/>", "misplaced-element"),
        ("<form><prompt>Hi</prompt></form>", "misplaced-element"),
        ("<form><form/></form>", "misplaced-element"),
        ("<form><block><field name='f'/></block></form>", "misplaced-element"),
        ("<form><block><else/></block></form>", "misplaced-element"),
        ("<menu><block/></menu>", "misplaced-element"),
        ("<form nam='a'/>", "unknown-attribute"),
        ("<form><field name='f' dtmf='1'/></form>", "unknown-attribute"),
        ("<form><block><goto/></block></form>", "missing-attribute"),
        ("<form><block><goto next='#a' expr='1'/></block></form>", "exclusive"),
        ("<form><block><goto next='#a' nextitem='b'/></block></form>", "exclusive"),
        ("<form><block><submit/></block></form>", "missing-attribute"),
        ("<form><block><submit next='a' expr='b'/></block></form>", "exclusive"),
        ("<form><block><throw/></block></form>", "missing-attribute"),
        ("<form><block><throw event='a' eventexpr='b'/></block></form>", "exclusive"),
        ("<form><block><throw event='a' message='a' messageexpr='b'/></block></form>", "exclusive"),
        ("<form><block><return event='a' namelist='b'/></block></form>", "exclusive"),
        ("<form><block><exit expr='a' namelist='b'/></block></form>", "exclusive"),
        ("<form><block><assign name='a'/></block></form>", "missing-attribute"),
        ("<form><block><var expr='1'/></block></form>", "missing-attribute"),
        ("<form><block><if>a</if></block></form>", "missing-attribute"),
        ("<form><block><value/></block></form>", "missing-attribute"),
        ("<form><block><audio/></block></form>", "missing-attribute"),
        ("<form><block><audio src='a' expr='b'/></block></form>", "exclusive"),
        ("<form><block><prompt><mark/></prompt></block></form>", "missing-attribute"),
        ("<form><block><prompt><mark name='a' nameexpr='b'/></prompt></block></form>", "exclusive"),
        ("<form><block><script/></block></form>", "missing-attribute"),
        ("<form><block><script src='a'>b</script></block></form>", "exclusive"),
        ("<form><block><script src='a' srcexpr='b'/></block></form>", "exclusive"),
        ("<form><block><data/></block></form>", "missing-attribute"),
        ("<form><block><data src='a' srcexpr='b'/></block></form>", "exclusive"),
        ("<form><block><foreach item='a'/></block></form>", "missing-attribute"),
        ("<form><block><foreach array='a'/></block></form>", "missing-attribute"),
        ("<form><grammar/></form>", "missing-attribute"),
        ("<form><grammar src='a' srcexpr='b'/></form>", "exclusive"),
        ("<form><grammar src='a'><rule id='r'>b</rule></grammar></form>", "exclusive"),
        ("<link/>", "missing-attribute"),
        ("<link next='#a' event='b'/>", "exclusive"),
        ("<menu><choice>a</choice></menu>", "missing-attribute"),
        ("<menu><choice next='#a' event='b'>a</choice></menu>", "exclusive"),
        ("<menu dtmf='true'><choice dtmf='3' event='b'>a</choice></menu>", "exclusive"),
        ("<form><subdialog/></form>", "missing-attribute"),
        ("<form><subdialog src='a' srcexpr='b'/></form>", "exclusive"),
        ("<form><subdialog src='a'><param name='a'/></subdialog></form>", "missing-attribute"),
        (
            "<form><subdialog src='a'><param name='a' expr='1' value='2'/></subdialog></form>",
            "exclusive",
        ),
        ("<form><transfer dest='a' destexpr='b'/></form>", "exclusive"),
        ("<form><transfer dest='a' bridge='true' type='blind'/></form>", "exclusive"),
        ("<property name='a'/>", "missing-attribute"),
        ("<meta name='a'/>", "missing-attribute"),
        ("<meta name='a' http-equiv='b' content='c'/>", "exclusive"),
        ("<form><block><prompt bargein='yes'>a</prompt></block></form>", "bad-value"),
        ("<form><block><prompt timeout='5'>a</prompt></block></form>", "bad-value"),
        ("<form><block><prompt count='0'>a</prompt></block></form>", "bad-value"),
        ("<form scope='global'/>", "bad-value"),
        ("<form><field name='f'><option accept='near'>a</option></field></form>", "bad-value"),
        ("<form><filled mode='some'/></form>", "bad-value"),
        ("<form><field name='f'><filled mode='all'/></field></form>", "unknown-attribute"),
        ("<form><field name='f'><filled namelist='f'/></field></form>", "unknown-attribute"),
        ("<form><block name='b'/><filled namelist='b'/></form>", "no-such-item"),
        ("<form><field name='f'/><filled namelist='g'/></form>", "no-such-item"),
        ("<form><field name='f'/><block name='f'/></form>", "duplicate-name"),
        ("<form id='a'/><menu id='a'/>", "duplicate-id"),
        ("<form>text</form>", "stray-text"),
        ("text", "stray-text"),
        ("<form><block><if cond='1'><else/><elseif cond='2'/></if></block></form>", "after-else"),
        ("<form xmlns:o='urn:o'><o:block/></form>", "wrong-namespace"),
        (f"<form {P}><block><p:dance/></block></form>", "unknown-element"),
        (f"<form {P}><block><p:turn angel='1'/></block></form>", "unknown-attribute"),
        (f"<form {P}><p:turn angle='1'/></form>", "misplaced-element"),
    ],
)
def test_what_is_wrong_has_a_code(body: str, code: str) -> None:  # 1.5 and each element's section
    assert codes(body) == [code]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<vxml xmlns="http://www.w3.org/2001/vxml"/>', ["1:1 missing-attribute"]),
        ('<vxml version="1.0" xmlns="http://www.w3.org/2001/vxml"/>', ["1:16 bad-value"]),
        ('<vxml version="2.0"><form/></vxml>', ["1:1 no-namespace"]),
        ('<vxml version="2.0" xmlns="http://www.w3.org/2001/VXML"/>', ["1:28 wrong-namespace"]),
        ('<vml version="2.0" xmlns="http://www.w3.org/2001/vxml"/>', ["1:1 wrong-root"]),
        ('<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">\n <form>\n  <blok/></form></vxml>',
         ["3:3 unknown-element"]),
        ('<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">\n <form nam="a"/></vxml>',
         ["2:8 unknown-attribute"]),
        ("<vxml", ["1:6 not-xml"]),
        ("", ["1:1 not-xml"]),
    ],
)  # fmt: skip
def test_problems_have_a_place(text: str, found: list[str]) -> None:
    assert problems(text) == found


DOCTYPE = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<!DOCTYPE vxml PUBLIC "-//W3C//DTD VOICEXML 2.1//EN"'
    ' "http://www.w3.org/TR/voicexml21/vxml.dtd">\n'
)


def test_a_doctype_as_real_documents_have_is_accepted_and_never_fetched() -> None:  # B
    assert problems(DOCTYPE + vxml(block("Hi."))) == []
    assert Call(DOCTYPE + vxml(block("Hi."))).play() == ["Hi."]


def test_a_schema_location_is_accepted() -> None:  # O
    head = (
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xsi:schemaLocation="http://www.w3.org/2001/vxml http://www.w3.org/TR/x.xsd">'
    )
    assert problems(vxml(block("Hi."), head)) == []


def test_a_doctype_that_declares_something_is_refused() -> None:
    text = '<!DOCTYPE vxml [<!ENTITY a "b">]>' + vxml(block("Hi."))
    assert problems(text) == ["1:1 doctype"]


def test_elements_of_foreign_namespaces_are_ignored_with_a_warning() -> None:
    text = vxml(
        '<form xmlns:o="urn:o"><o:block><log>no</log></o:block><block><o:log>no</o:log>'
        '<o:goto next="#none"/><log>yes</log></block></form>'
    )
    page = read_page("d.vxml", "d.vxml", text.encode())
    assert {p.severity for p in page.problems} == {"warning"} and broken(page) is None
    assert Call(text).logs() == ["yes"]


def test_attributes_of_foreign_namespaces_are_ignored() -> None:
    assert codes('<form xmlns:o="urn:o" o:a="b"/>') == []


def test_an_expression_that_does_not_compile_is_a_warning_for_who_asks() -> None:
    text = vxml(
        '<form><block>\n<assign name="a" expr="1 +"/><script>var = ;</script></block></form>'
    )
    page = read_page("d.vxml", "d.vxml", text.encode())
    assert page.problems == []
    found = [(p.place.line, p.severity, p.code) for p in page.warnings()]
    assert sorted(found) == [(2, "warning", "bad-expression")] * 2


def test_such_an_expression_is_error_semantic_when_it_is_reached() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.semantic"><log>bad</log><exit/></catch>'
        + block('<log>before</log><if cond="1 +"><log>no</log></if>')
    )
    assert call.logs() == ["before", "bad"]


def test_such_an_expression_that_is_never_reached_is_no_error() -> None:
    call = Call(block('<if cond="false"><log expr="1 +"/></if><log>after</log>'))
    assert (call.logs(), call.ended) == (["after"], "exit")


def test_a_dialog_that_is_not_there_is_a_warning_for_who_asks() -> None:
    page = read_page("d", "d", vxml(block('<goto next="#none"/>')).encode())
    assert [p.code for p in page.warnings()] == ["no-such-form"]


def test_validation_asks_for_warnings(tmp_path: Path) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(vxml(block('<log expr="1 +"/>')))
    assert [(p.severity, p.code) for p in loading.validate([path])] == [
        ("warning", "bad-expression")
    ]


def test_a_wrong_document_is_no_vxml_at_all() -> None:
    with pytest.raises(DocumentError):
        read_page("d", "d", b'<prima xmlns="urn:prima:dialogue:1"/>')


def long_document(forms: int) -> bytes:
    form = (
        '<form id="f{0}"><var name="a" expr="{0} + 1"/><field name="x"><prompt>Say <value expr="a"/>'
        ' please, number {0}</prompt><option>one</option><option value="2">two</option>'
        '<nomatch count="2"><reprompt/></nomatch><filled><if cond="x == \'one\'">'
        '<goto next="#f0"/><else/><assign name="a" expr="a + 1"/></if></filled></field></form>\n'
    )
    return vxml("".join(form.format(n) for n in range(forms))).encode()


def test_the_work_for_a_document_grows_with_its_length() -> None:
    short, long = long_document(30), long_document(300)
    assert steps(lambda: read_page("d", "d", long)) < 11 * steps(lambda: read_page("d", "d", short))


# Answers before the question (4.1.5) ---------------------------------------------------------

WELCOME = """<form><block><prompt>One.</prompt><prompt {}>Two.</prompt></block>
<field name="f">{}<prompt>Which?</prompt><option dtmf="1">red</option>
<filled><log expr="f"/><prompt>Good.</prompt></filled></field></form>"""


@pytest.mark.parametrize(("said", "logged"), [("red", "red"), ("1", "red")])
def test_what_is_said_during_a_prompt_before_a_question_answers_it(said: str, logged: str) -> None:
    call = Call(WELCOME.format("", ""))
    call.hears(said)
    assert call.saying() == ["One."], "what is being said is not cut (U1)"
    assert call.logs() == [logged]
    assert call.play() == ["One.", "Good."], "nothing more is said before the answer counts"
    assert {(r["rule"], r["text"]) for r in call.phases("cancel")} == {
        ("O3", "Two."),
        ("O3", "Which?"),
    }
    left = call.phases("leave")
    assert [one["state"] for one in left] == [1, 2], "by the answer, and by the dialog's end"
    assert call.ended == "exit"


@pytest.mark.parametrize("before", [["One."], ["One.", "Two."]])
def test_what_is_said_as_a_prompt_ends_answers_the_question_behind_it(before: list[str]) -> None:
    call = Call(WELCOME.format("", ""))
    for text in before[:-1]:
        call.finish(text)
    call.step(Ended(call._id(before[-1])), Heard("red"))
    assert call.logs() == ["red"]
    assert call.play() == [*before, "Good."]
    assert call.ended == "exit"


def test_what_is_said_as_a_prompt_ends_that_may_not_be_broken_in_on_is_no_answer() -> None:
    call = Call(WELCOME.format('bargein="false"', ""))
    call.finish("One.")
    call.step(Ended(call._id("Two.")), Heard("red"))
    assert (call.logs(), call.saying()) == ([], ["Which?"])


def test_a_question_is_not_answered_in_the_instant_in_which_it_is_asked_for() -> None:
    call = Call("<form><block>Other.</block></form>", voice(WELCOME.format("", ""), "asking"))
    call.step(Ended(call._id("Other.")), Heard("red"))
    assert (call.logs(), call.saying()) == ([], ["One."])


def test_what_no_grammar_takes_before_a_question_ends_nothing() -> None:
    call = Call(WELCOME.format("", ""))
    call.hears("blue")
    assert call.play() == ["One.", "Two.", "Which?"]
    call.answer("red")
    assert call.logs() == ["red"]


def test_what_may_not_be_broken_in_on_is_said_before_an_answer_counts() -> None:
    call = Call(WELCOME.format('bargein="false"', ""))
    call.hears("red")
    assert call.logs() == []
    call.finish("One.")
    call.hears("red")
    assert call.logs() == []
    call.answer("red")
    assert call.said() == ["One.", "Two.", "Which?", "Good."]


def test_prompts_may_be_broken_in_on_behind_one_that_may_not() -> None:
    text = WELCOME.replace("<prompt>One.", '<prompt bargein="false">One.')
    call = Call(text.format("", ""))
    call.hears("red")
    call.finish("One.")
    assert call.logs() == []
    call.hears("red")
    assert call.logs() == ["red"]
    assert call.play() == ["One.", "Two.", "Good."]


@pytest.mark.parametrize("own", [True, False])
def test_bargein_as_a_property_holds_for_prompts_before_a_question(own: bool) -> None:
    text = WELCOME.format(
        'bargein="true"' if own else "", '<property name="bargein" value="false"/>'
    )
    call = Call(text)
    call.finish("One.")
    call.hears("red")
    assert call.logs() == [], "the question itself may not be broken in on"
    text = WELCOME.format('bargein="true"' if own else "", "").replace(
        "<prompt>Which?", '<prompt bargein="true">Which?'
    )
    call = Call(vxml(f'<property name="bargein" value="false"/>{text}'))
    call.finish("One.")
    call.hears("red")
    assert call.logs() == (["red"] if own else [])


def test_what_is_said_before_a_recording_is_not_recorded() -> None:
    call = Call(
        """<form><block>One.</block><record name="r"><prompt>Speak.</prompt></record>
        <block><log expr="'later'"/></block></form>"""
    )
    call.hears("something")
    assert call.saying() == ["One."]
    call.finish("One.")
    assert call.saying() == ["Speak."]


def test_nobody_answers_a_question_before_anything_is_said_for_it() -> None:
    call = Call("<form><block>Other.</block></form>", voice(WELCOME.format("", ""), "asking"))
    call.hears("red")
    assert call.logs() == []
    call.finish("Other.")
    assert call.saying() == ["One."]
    call.hears("red")
    assert call.logs() == ["red"]


def test_a_link_may_be_taken_before_a_question() -> None:
    text = """<link next="#help"><grammar mode="voice" version="1.0" root="r">
    <rule id="r">help</rule></grammar></link>
    <form><block>One.</block><field name="f"><prompt>Which?</prompt><option>red</option></field></form>
    <form id="help"><block>Like this.</block></form>"""
    call = Call(text)
    call.hears("help")
    assert call.play() == ["One.", "Like this."]


PROPERTY = '<property name="bargein" value="{}"/>'


@pytest.mark.parametrize(
    ("text", "open_"),
    [
        (PROPERTY.format("false") + WELCOME.format("", PROPERTY.format("true")), False),
        (WELCOME.format("", PROPERTY.format("true")), True),
        (WELCOME.format("", "").replace("<form>", f"<form>{PROPERTY.format('false')}"), False),
    ],
)
def test_the_property_holds_where_the_prompt_stands(text: str, open_: bool) -> None:  # 6.3
    call = Call(vxml(text))
    call.hears("red")
    assert call.logs() == (["red"] if open_ else [])


def test_the_property_of_a_dialog_that_was_left_holds_for_its_prompts() -> None:
    call = Call(
        f"""<form id="a">{PROPERTY.format("false")}<block>Legal notice.<goto next="#b"/></block></form>
        <form id="b"><field name="f"><prompt>Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    )
    call.hears("red")
    assert call.logs() == []
    call.finish("Legal notice.")
    call.hears("red")
    assert call.logs() == ["red"]


@pytest.mark.parametrize("place", ["", "Come with me."])
def test_a_command_before_a_question_is_done_before_an_answer_counts(place: str) -> None:
    text = f"""<form><block>{place}<p:point-by-hand xmlns:p="urn:prima:dialogue:1" angle="30"/></block>
        <field name="f"><prompt>Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    call = Call(text)
    call.hears("red")
    assert call.logs() == []
    call.answer("red")
    assert "point-by-hand" in [r["command"] for r in call.phases("end")]
    assert call.logs() == ["red"]


def test_a_grammar_of_a_recording_takes_nothing_before_it() -> None:
    call = Call(
        """<form><block>One.</block><record name="r"><grammar version="1.0" root="g" mode="voice">
        <rule id="g">stop</rule></grammar><prompt>Speak.</prompt>
        <filled><log expr="'filled'"/></filled></record></form>"""
    )
    call.hears("stop")
    call.finish("One.")
    assert (call.saying(), call.logs()) == (["Speak."], [])


@pytest.mark.parametrize("allowed", [True, False])
def test_the_property_holds_for_the_platforms_own_words(allowed: bool) -> None:  # 5.2.5
    call = Call(
        f"""{PROPERTY.format(str(allowed).lower())}<form><field name="f">
        <prompt bargein="true">Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    )
    call.listens()
    call.hears("blue")
    assert call.saying() != ["Which?"]
    call.hears("red")
    assert call.logs() == (["red"] if allowed else [])


def test_an_expression_of_an_attribute_may_have_commas() -> None:
    call = Call(
        """<form><block><goto expr="'#nowhere', '#b'"/></block></form>
        <form id="b"><block><log>b</log></block></form>"""
    )
    assert call.logs() == ["b"]


# Attributes of which one element has just one ---------------------------------------------

EITHER = {
    "goto": "<block><goto next='#a' expr='1'/></block>",
    "goto nextitem": "<block><goto next='#a' nextitem='b'/></block>",
    "goto nowhere": "<block><goto/></block>",
    "submit": "<block><submit next='a' expr='1'/></block>",
    "submit nowhere": "<block><submit namelist='x'/></block>",
    "throw": "<block><throw event='a' eventexpr='1'/></block>",
    "throw nothing": "<block><throw message='m'/></block>",
    "throw message": "<block><throw event='a' message='m' messageexpr='1'/></block>",
    "return": "<block><return event='a' namelist='x'/></block>",
    "return event": "<block><return event='a' eventexpr='x'/></block>",
    "return message": "<block><return event='a' message='m' messageexpr='x'/></block>",
    "exit": "<block><exit expr='1' namelist='x'/></block>",
    "script": "<block><script src='a.js'>var x;</script></block>",
    "script empty": "<block><script> </script></block>",
    "form script": "<script src='a.js' srcexpr='1'/><block/>",
    "data": "<block><data src='a' srcexpr='1'/></block>",
    "data of nothing": "<block><data name='d'/></block>",
    "audio": "<block><audio src='a' expr='1'/></block>",
    "audio of nothing": "<block><prompt><audio>words</audio></prompt></block>",
    "mark": "<block><prompt><mark name='a' nameexpr='1'/></prompt></block>",
    "subdialog": "<subdialog name='s' src='#a' srcexpr='1'/>",
    "subdialog nowhere": "<subdialog name='s'/>",
    "param": "<subdialog name='s' src='#a'><param name='p' value='1' expr='2'/></subdialog>",
    "param of nothing": "<subdialog name='s' src='#a'><param name='p'/></subdialog>",
    "transfer": "<transfer name='t' dest='tel:1' destexpr='1'/>",
    "transfer nowhere": "<transfer name='t'/>",
    "transfer type": "<transfer name='t' dest='tel:1' bridge='true' type='blind'/>",
    "grammar": "<field name='f'><prompt>Q?</prompt><grammar src='a' srcexpr='1'/></field>",
    "grammar empty": "<field name='f'><prompt>Q?</prompt><grammar> <!-- --> </grammar></field>",
    "grammar both": "<field name='f'><grammar src='a.gram'>#ABNF 1.0; $a = b;</grammar></field>",
    "link": f"<link next='#a' event='b'>{rule('x')}</link><block/>",
    "link nowhere": f"<link>{rule('x')}</link><block/>",
}


@pytest.mark.parametrize("content", EITHER.values(), ids=EITHER)
def test_a_document_with_attributes_that_exclude_each_other_is_not_run(content: str) -> None:
    other = '<form id="a"><block><return/></block></form>'
    text = vxml(f"<form><block><log>runs</log></block>{content}</form>{other}")
    errors = [one.partition(" ")[2] for one in problems(text)]
    assert errors in (["exclusive"], ["missing-attribute"])
    fetching = Call(
        """<catch event="error.badfetch"><log>refused</log><exit/></catch>
        <form><block><goto next="leaf.vxml"/></block></form>""",
        leaf=text.replace("<log>runs</log>", '<log>runs</log><throw event="error.badfetch"/>'),
    )
    assert (fetching.logs(), fetching.ended) == (["refused"], "exit")


@pytest.mark.parametrize("more", ['next="#a" event="b"', "", 'event="a" eventexpr="b"'])
def test_a_choice_leads_to_one_target(more: str) -> None:  # 2.2.2
    text = vxml(f"<menu id='a'><prompt>Q?</prompt><choice {more}>x</choice></menu>")
    assert [one.partition(" ")[2] for one in problems(text)] in (
        ["exclusive"],
        ["missing-attribute"],
    )


def test_a_root_or_subdialog_that_is_no_valid_document_is_badfetch_where_it_is_fetched() -> None:
    wrong = vxml('<form><block><goto next="#a" expr="1"/></block></form>')
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="wrong.vxml">'
    refused = '<catch event="error.badfetch"><log expr="_message"/><exit/></catch>'
    told = (
        'wrong.vxml:1:106: error: <goto> has both "next" and "expr". Keep one of them. [exclusive]'
    )
    for leading in ('<block><goto next="leaf.vxml"/></block>', '<subdialog src="wrong.vxml"/>'):
        call = Call(
            f"{refused}<form>{leading}</form>",
            wrong=wrong,
            leaf=vxml("<form><block><log>leaf</log></block></form>", head),
        )
        assert [one.partition(" ")[2] for one in call.logs()] == [told]
    own = Call(vxml(f"{refused}<form><block><log>runs</log></block></form>", head), wrong=wrong)
    assert [one.partition(" ")[2] for one in own.logs()] == [told]


def test_the_documentation_lists_the_attributes_that_exclude_each_other() -> None:
    page = (ROOT / "docs" / "voicexml.md").read_text(encoding="utf-8")
    table = page.partition("| Exactly one of |")[2].partition("\n\n")[0].splitlines()[2:]
    told: dict[str, set[str]] = {}
    for row in table:
        names, needed, most = (
            re.sub("[`,]", "", cell).split("|")[0] for cell in row.split("|")[1:4]
        )
        for name in names.split():
            lines = [f"{needed.strip()} !"] if needed.strip() else []
            told[name] = {*lines, *(one.strip() for one in most.split(";") if one.strip())}
    assert told == {name: set(lines) for name, lines in ALTERNATIVES.items()}
