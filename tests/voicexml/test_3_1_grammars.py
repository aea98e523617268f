"""Grammars, their scopes and what they mean: VoiceXML 2.0, 3.1 and Appendix P."""

from __future__ import annotations

from time import process_time

import pytest

from prima.messages import Fetched
from tests.helpers.dialogs import (
    CITIES,
    GRAMMAR,
    PASS,
    TRIP,
    YES,
    Case,
    Cases,
    ask,
    asked,
    codes,
    file,
    grammar,
    holds,
    rule,
    run,
)
from tests.helpers.voice import Call, Online

case = Cases()

case(
    "a field's own grammar fills that field alone",
    "3.1.6.2",
    f"""<form><field name="start">{TRIP}</field><field name="end"><prompt>To?</prompt>{CITIES}
    </field><block><log expr="start + end"/></block></form>""",
    "from Nara to Osaka",
    "kyoto",
    logs=["NaraKyoto"],
)
case(
    "a field without a matching slot takes the whole interpretation",
    "3.1.6.2",
    f"""<form><field name="f">{TRIP}</field><block><log expr="f.start"/></block></form>""",
    "from Nara",
    logs=["Nara"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_words_around_what_is_meant_are_no_reason_for_a_nomatch() -> None:  # SRGS 2.2.3
    text = f"""<form><field name="f"><prompt>Q?</prompt><grammar version="1.0" root="r"
        xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en"><rule id="r">
        <ruleref special="GARBAGE"/> pizza</rule></grammar><filled>{PASS}</filled></field></form>"""
    assert run(text, "well I would really like a pizza").logs() == ["pass"]


def test_a_field_may_have_many_grammars_of_both_modes() -> None:  # 3.1
    grammars = rule("tea") + rule("coffee") + rule("1|2", 'mode="dtmf"')
    assert asked(grammars, "coffee") == ["coffee"]
    assert asked(grammars, "2") == ["2"]


def test_an_inline_grammar_fills_its_field() -> None:  # 3.1.1
    assert asked(rule("tea|coffee"), "Coffee!") == ["coffee"]


def test_an_inline_grammar_of_the_vxml_namespace_is_a_grammar_too() -> None:  # 3.1.1.1
    assert asked('<grammar version="1.0" root="r"><rule id="r">tea</rule></grammar>', "tea") == [
        "tea"
    ]


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


@pytest.mark.parametrize(
    ("weight", "wrong"),
    [
        ("2", []),
        ("٢", ["bad-value"]),
        ("2.", []),
        (".5", []),
        ("-1", ["bad-value"]),
        ("1e3", ["bad-value"]),
    ],
)
def test_a_grammars_weight_has_neither_sign_nor_exponent(weight: str, wrong: list[str]) -> None:
    """3.1.1.3."""
    assert codes(ask(f'<grammar src="a.grxml" weight="{weight}"/>')) == wrong


def test_a_long_weight_that_is_none_takes_no_longer() -> None:
    began = process_time()
    assert codes(ask(f'<grammar src="a.grxml" weight="{"1" * 50_000}x"/>')) == ["bad-value"]
    assert process_time() - began < 2, "10 ms on a quiet machine"


def test_a_grammar_in_another_language_is_taken() -> None:  # 3.1.1.4
    assert asked(rule("お茶", 'xml:lang="ja"'), "お茶") == ["お茶"]


def test_keys_fill_a_field_of_dtmf_mode() -> None:  # 3.1.2
    assert asked(rule("1 2|3", 'mode="dtmf"') + "<log/>".replace("<log/>", ""), "12") == ["12"]


def test_speech_is_no_dtmf() -> None:  # 3.1.2
    assert asked(rule("1|2", 'mode="dtmf"') + "<nomatch><log>no</log><exit/></nomatch>", "one") == [
        "no"
    ]


def test_a_tag_gives_the_meaning() -> None:  # 3.1.6
    call = Call(
        ask(
            f'<grammar {GRAMMAR} root="r" tag-format="semantics/1.0"><rule id="r">'
            "<one-of><item>big<tag>out = 10;</tag></item></one-of></rule></grammar>"
        )
    )
    call.answer("big")
    assert call.logs() == ["10"]


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


@pytest.mark.parametrize(
    "held", ["{}<field name='f' slot='size.n'/>", "<field name='f' slot='size.n'>{}</field>"]
)
def test_a_slot_with_dots_may_name_a_property_itself(held: str) -> None:  # C
    taken = grammar("big", "out = {'size.n': 3, size: {n: 4}}")
    text = f"<form>{held.format(taken)}<block>{holds('f === 3')}</block></form>"
    assert run(text, "big").logs() == ["pass"]


@pytest.mark.parametrize(
    "held",
    [
        "{}<field name='n'><prompt>Which?</prompt></field>",
        "<field name='n'>{}<prompt>Which?</prompt></field>",
        "<field name='n' slot='a.n'>{}<prompt>Which?</prompt></field>",
    ],
)
def test_a_slot_that_is_null_fills_its_item(held: str) -> None:  # 3.1.6
    taken = grammar("none", "out = {n: null, a: {n: null}}")
    text = f"<form>{held.format(taken)}<block>{holds('n === null')}</block></form>"
    assert run(text, "none").logs() == ["pass"]


def test_a_slot_that_is_undefined_fills_no_item() -> None:  # 3.1.6
    taken = grammar("none", "out = {m: 1, n: undefined}")
    text = f"<form>{taken}<field name='m'/><field name='n'/><filled mode='any'>{holds('n == void 0')}</filled></form>"
    assert run(text, "none").logs() == ["pass"]


def test_keys_of_a_grammar_without_tags_are_all_the_keys() -> None:  # 3.1.6
    grammar = (
        '<grammar mode="dtmf" version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
        '<rule id="r"><item repeat="2-4"><ruleref uri="#d"/></item></rule><rule id="d"><one-of>'
        "<item>1</item><item>2</item><item>3</item></one-of></rule></grammar>"
    )
    call = Call(
        f'<form><field name="q"><prompt>Number?</prompt>{grammar}'
        '<filled><log expr="q"/></filled></field></form>'
    )
    call.answer("1 2 3")
    assert call.logs() == ["123"]


def test_a_simple_result_of_a_forms_grammar_fills_no_item() -> None:  # 3.1.6.1
    call = run(
        f"""<form>{grammar("hi", "out = 5")}<field name="f">{YES}
        <filled>{holds("f == 'yes'")}</filled></field></form>""",
        "hi",
        "yes",
    )
    assert call.logs() == ["pass"]


def test_a_meaning_without_the_fields_slot_is_the_fields_whole_value() -> None:  # 3.1.6.3
    call = Call(
        f'<form><field name="f"><prompt>Well?</prompt><grammar {GRAMMAR} root="r"'
        ' tag-format="semantics/1.0"><rule id="r">big<tag>out.a = 1; out.b = 2;</tag></rule>'
        '</grammar><filled><log expr="f.a + f.b"/></filled></field></form>'
    )
    call.answer("big")
    assert call.logs() == ["3"]


@pytest.mark.parametrize("root", ["one", "two"])
def test_a_private_rule_does_not_listen_for_a_document(root: str) -> None:  # SRGS 3.2
    abnf = f"#ABNF 1.0;\nlanguage en; root ${root}; public $one = no; private $two = big;"
    call = Call(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch><form><field name="q">'
        '<prompt>Well?</prompt><grammar src="a.gram#two" type="application/srgs"/></field></form>',
        **{"a.gram": abnf},
    )
    assert call.logs() == ["refused"]


def test_tags_of_grammars_are_told_the_runs_date() -> None:
    grammar = (
        '<grammar version="1.0" root="r" tag-format="semantics/1.0" xml:lang="en">'
        '<rule id="r">today<tag>out = new Date().toISOString()</tag></rule></grammar>'
    )
    call = Call(
        f'<form><field name="day"><prompt>When?</prompt>{grammar}'
        '<filled><log expr="day"/></filled></field></form>'
    )
    call.answer("today")
    (logged,) = call.logs()
    assert logged.startswith("2005-03-01T10:00:")


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
    assert asked("", said, more=f'type="{kind}"') == [value]


def test_digits_of_another_length_are_nomatch() -> None:  # P
    assert asked(
        "<nomatch><log>no</log><exit/></nomatch>", "1234", more='type="digits?length=3"'
    ) == ["no"]


def test_a_built_in_grammar_may_be_referred_to_by_uri() -> None:  # P
    assert asked('<grammar src="builtin:dtmf/digits?minlength=2;maxlength=3"/>', "12") == ["12"]


def test_a_builtin_voice_grammar_takes_speech() -> None:  # P
    assert asked('<grammar src="builtin:grammar/boolean"/>', "yes") == ["true"]


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


def test_a_grammar_from_the_network_is_error_badfetch() -> None:
    call = Call(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
        + ask('<grammar src="http://example.org/g.grxml"/>')
    )
    assert call.logs() == ["refused"]


def test_parameters_that_exclude_each_other_are_badfetch() -> None:  # Appendix P
    for kind in ("digits?minlength=5;maxlength=3", "digits?length=3;minlength=1"):
        call = Call(
            '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
            f'<form><field name="q" type="{kind}"><prompt>Well?</prompt></field></form>'
        )
        assert call.logs() == ["refused"]


def test_a_grammar_that_could_not_be_fetched_is_requested_again() -> None:  # 5.2.6
    uri = "http://words.example/g.grxml"
    call = Online(
        {uri: None},
        f"""<form><field name="f"><prompt>Well?</prompt><grammar src="{uri}"/>
        <error><log expr="_event"/></error><filled><log expr="f"/></filled></field></form>""",
    )
    call.step(Fetched("app", 1, uri, status=503, problem="busy"))
    call.step(Fetched("app", 2, uri, file("tea")))
    call.answer("tea")
    assert call.logs() == ["error.badfetch.http.503", "tea"]
