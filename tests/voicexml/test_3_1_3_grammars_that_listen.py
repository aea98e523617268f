"""Which grammars listen, and which of them goes first: VoiceXML 2.0, 3.1.3 and 3.1.4."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    ENDS,
    FAIL,
    GO,
    GRAMMAR,
    PASS,
    TRIP,
    YES,
    Case,
    Cases,
    ask,
    grammar,
    leaf,
    rule,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "a grammar of document scope makes its form listen",
    "3.1.3",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form>{TRIP.replace("<grammar", '<grammar scope="document"')}<field name="start"/>
    <block><log expr="start"/></block></form>""",
    "from Osaka",
    logs=["Osaka"],
)
case(
    "of two choices with the same words the first is taken",
    "3.1.4",
    f"""<menu><choice next="#a">news</choice><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["a"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


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


def test_an_utterance_for_another_menu_goes_to_it_first() -> None:  # 3.1.4
    call = run(
        f"""<form><catch event="x">{FAIL}</catch><field name="f">{YES}</field></form>
        <menu scope="document"><choice event="x">go</choice><catch event="x">{PASS}</catch></menu>""",
        "go",
    )
    assert call.logs() == ["pass"]


@pytest.mark.parametrize(
    "item",
    [
        '<field name="f"><prompt>Well?</prompt></field>',
        "<initial><prompt>Well?</prompt></initial>",
        f'<field name="f" modal="true"/><link event="x">{GO}</link>',
    ],
)
def test_to_listen_without_a_grammar_is_error_semantic(item: str) -> None:  # 3.1.4
    call = run(f'<form>{item}<catch event="error.semantic">{PASS}</catch></form>')
    assert call.logs() == ["pass"]


def test_further_results_come_from_all_grammars_of_a_document() -> None:  # 3.1.4, 5.1.5
    forms = "".join(
        f'<form scope="document">{grammar("go", f"out.{name}=1")}<field name="{name}">{YES}<filled>'
        f'<log expr="application.lastresult$.length"/><exit/></filled></field></form>'
        for name in "gh"
    )
    asks = f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>'
    assert run(f'<property name="maxnbest" value="3"/>{asks}{forms}', "go").logs() == ["2"]


THIS, OTHER = grammar("go", "out='this'"), grammar("go", "out='other'")
LEAVES = f'<link event="left">{GO}</link>'
BY_LINK = '<catch event="left"><log>link</log><exit/></catch>'


@pytest.mark.parametrize(
    ("document", "first"),
    [
        (f'<form>{LEAVES}{THIS}<field name="f"><prompt>Q?</prompt>{YES}</field></form>', "link"),
        (f'<form><field name="f"><prompt>Q?</prompt>{LEAVES}{THIS}</field></form>', "link"),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{THIS}{LEAVES}<filled><log expr="f"/></filled></field></form>',
            "this",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt><option value="option">go</option>{THIS}<filled><log expr="f"/></filled></field></form>',
            "option",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>'
            f'<form scope="document">{grammar("go", "out.g=1")}<field name="g">{YES}<filled><log>form</log><exit/></filled></field></form>{LEAVES}',
            "form",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>{LEAVES}'
            f'<form scope="document">{grammar("go", "out.g=1")}<field name="g">{YES}</field></form>',
            "link",
        ),
    ],
)  # fmt: skip
def test_of_grammars_of_one_precedence_the_first_in_the_document_wins(
    document: str, first: str
) -> None:
    assert run(BY_LINK + document, "go").logs()[:1] == [first]
