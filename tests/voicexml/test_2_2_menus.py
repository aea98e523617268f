"""Menus and their choices: VoiceXML 2.0, 2.2."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    ENDS,
    GO,
    HOME,
    PASS,
    SILENT,
    YES,
    Case,
    Cases,
    ask,
    problems,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "a menu's prompts taper",
    "2.2",
    f"""<menu><prompt>News?</prompt><prompt count="2">Say news.</prompt>
    <noinput><reprompt/></noinput><choice next="#a">news</choice></menu>{ENDS}""",
    SILENT,
    said=["News?", "Say news."],
)
case(
    "a menu counts its events",
    "2.2",
    f"""<menu><nomatch><log>1</log></nomatch><nomatch count="2"><log>2</log></nomatch>
    <choice next="#a">news</choice></menu>{ENDS}""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "a menu is gone to like a form",
    "2.2",
    f"""<form><block>Hi.<goto next="#m"/></block></form>
    <menu id="m"><prompt>What?</prompt><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    said=["Hi.", "What?"],
    logs=["b"],
)
case(
    "a choice leads to its next",
    "2.2.1",
    f'<menu><choice next="#a">sports</choice><choice next="#b">news</choice></menu>{ENDS}',
    "news",
    logs=["b"],
)
case(
    "a menu with dtmf numbers its choices",
    "2.2.1",
    f'<menu dtmf="true"><choice next="#a">x</choice><choice next="#b">y</choice></menu>{ENDS}',
    "2",
    logs=["b"],
)
case(
    "an explicit key takes no number from the others",
    "2.2.1",
    f"""<menu dtmf="true"><choice dtmf="0" next="#a">x</choice><choice next="#b">y</choice></menu>
    {ENDS}""",
    "1",
    logs=["b"],
)
case(
    "a menu's accept is its choices' default",
    "2.2.1",
    f"""<menu accept="approximate"><nomatch><log>no</log></nomatch>
    <choice next="#a">world sports</choice><choice accept="exact" next="#b">local news</choice>
    </menu>{ENDS}""",
    "news",
    "sports",
    logs=["no", "a"],
)
case(
    "a menu of document scope listens in other dialogs",
    "2.2.1",
    f"""<form><field name="f">{CITIES}</field></form>
    <menu scope="document"><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["b"],
)
case(
    "a menu of dialog scope does not",
    "2.2.1",
    f"""<form><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>
    <menu><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["no"],
)
case(
    "a menu's prompt may be bare text",
    "2.2.1",
    f"""<menu>Welcome. <choice next="#b">news</choice></menu>{ENDS}""",
    said=["Welcome."],
)
case(
    "a choice's next may be computed",
    "2.2.2",
    f"""<menu><choice expr="'#' + 'b'">news</choice></menu>{ENDS}""",
    "news",
    logs=["b"],
)
case(
    "a choice may throw an event with a message",
    "2.2.2",
    """<menu><choice event="odd" message="well">news</choice>
    <catch event="odd"><log expr="_event + _message"/><exit/></catch></menu>""",
    "news",
    logs=["oddwell"],
)
case(
    "a choice's event may be computed",
    "2.2.2",
    """<menu><choice eventexpr="'o' + 'dd'" messageexpr="1 + 1">news</choice>
    <catch event="odd"><log expr="_event + _message"/><exit/></catch></menu>""",
    "news",
    logs=["odd2"],
)
case(
    "a choice has its key",
    "2.2.2",
    f'<menu><choice dtmf="7" next="#a">x</choice><choice dtmf="0" next="#b">y</choice></menu>{ENDS}',
    "0",
    logs=["b"],
)
case(
    "a choice's grammar takes the place of its words",
    "2.2.2",
    f"""<menu><nomatch><log>no</log></nomatch><choice next="#a">{HOME} house</choice></menu>{ENDS}""",
    "house",
    "go home",
    logs=["no", "a"],
)
case(
    "a choice to a dialog that is not there is error.badfetch",
    "2.2.2",
    """<menu><choice next="#zz">news</choice>
    <catch event="error.badfetch"><log>bad</log><exit/></catch></menu>""",
    "news",
    logs=["bad"],
)
case(
    "a menu's choice may ask for help",
    "2.2.2",
    """<menu><prompt>News?</prompt><choice event="help">what</choice>
    <help>Say news.<reprompt/></help></menu>""",
    "what",
    said=["News?", "Say news.", "News?"],
)
case(
    "enumerate in a field says its options",
    "2.2.4",
    f"""<form><field name="f"><prompt>Go to <enumerate/>?</prompt>{CITIES}</field></form>""",
    said=["Go to Kyoto; Nara?"],
)
case(
    "enumerate says the choices",
    "2.2.4",
    f"""<menu><prompt>Say <enumerate/></prompt><choice next="#a">sports</choice>
    <choice next="#b">world <emphasis>news</emphasis></choice></menu>{ENDS}""",
    said=["Say sports; world news"],
)
case(
    "enumerate's content has the choice's words and key",
    "2.2.4",
    f"""<menu dtmf="true"><prompt><enumerate>For <value expr="_prompt"/>
    press <value expr="_dtmf"/>. </enumerate></prompt><choice next="#a">sports</choice>
    <choice next="#b">news</choice></menu>{ENDS}""",
    said=["For sports press 1. For news press 2."],
)
case(
    "a handler in a menu enumerates its choices",
    "2.2.4",
    f"""<menu><choice next="#a">sports</choice><choice next="#b">news</choice>
    <nomatch>Say <enumerate/>.</nomatch></menu>{ENDS}""",
    "x",
    said=["Say sports; news."],
)
case(
    "a handler in a field enumerates its options",
    "2.2.4",
    f"""<form><field name="f">{CITIES}<nomatch>Say <enumerate/>.</nomatch></field></form>""",
    "x",
    said=["Say Kyoto; Nara."],
)
case(
    "a choice is exact by default",
    "2.2.5",
    f"""<menu><nomatch><log>no</log></nomatch><choice next="#a">world sports news</choice></menu>
    {ENDS}""",
    "sports news",
    logs=["no"],
)
case(
    "an approximate choice takes some of its words",
    "2.2.5",
    f"""<menu><nomatch><log>no</log></nomatch>
    <choice accept="approximate" next="#a">world sports news</choice></menu>{ENDS}""",
    "news world",
    "world news",
    logs=["no", "a"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_choices_keys_may_be_many() -> None:  # 2.2
    call = Call(
        '<menu><prompt>Which?</prompt><choice dtmf="1 2" event="a">one</choice>'
        '<choice dtmf="1 3" event="b">two</choice></menu>'
        '<catch event="a b"><log expr="_event"/><exit/></catch>'
    )
    call.answer("13")
    assert call.logs() == ["b"]


@pytest.mark.parametrize("more", ['next="#a" event="b"', "", 'event="a" eventexpr="b"'])
def test_a_choice_leads_to_one_target(more: str) -> None:  # 2.2.2
    text = vxml(f"<menu id='a'><prompt>Q?</prompt><choice {more}>x</choice></menu>")
    assert [one.partition(" ")[2] for one in problems(text)] in (
        ["exclusive"],
        ["missing-attribute"],
    )


def test_enumerate_counts_as_the_keys_do() -> None:  # 2.2.4
    call = Call(
        """<menu dtmf="true"><prompt><enumerate><value expr="_dtmf"/></enumerate></prompt>
        <choice dtmf="0" event="a">red</choice><choice event="b">blue</choice></menu>"""
    )
    assert call.play() == ["0 1"]


def test_enumerate_tells_the_keys_of_options() -> None:  # 2.2.4
    call = Call(
        """<form><field name="f"><prompt><enumerate><value expr="_dtmf"/> for
        <value expr="_prompt"/>.</enumerate></prompt><option dtmf="7">red</option></field></form>"""
    )
    assert call.play() == ["7 for red."]


@pytest.mark.parametrize(
    "item",
    [
        "<block><enumerate/></block>",
        f"""<field name="f"><prompt><enumerate/></prompt>{GO}</field>""",
        f"""<field name="f"><prompt><enumerate><enumerate/></enumerate></prompt>{YES}</field>""",
    ],
)
def test_enumerate_without_choices_is_error_semantic(item: str) -> None:  # 2.2.4
    call = run(f'<form><catch event="error.semantic">{PASS}</catch>{item}</form>')
    assert call.logs() == ["pass"]


def test_keys_are_enumerated_one_by_one() -> None:  # 2.2.4
    text = """<menu><prompt><enumerate><value expr="_prompt"/> is <value expr="_dtmf"/>.</enumerate>
        </prompt><choice dtmf="42" next="#a">news</choice></menu><form id="a"/>"""
    call = Call(text)
    call.play()
    assert call.said()[:1] == ["news is 4 2."]


@pytest.mark.parametrize(
    ("menu", "choice"),
    [
        ("", '<choice event="a">tea</choice>'),
        (' dtmf="true"', f'<choice event="a">tea{GO}</choice>'),
        ("", f'<choice dtmf="1" event="a">tea{GO}</choice>'),
    ],
)
def test_a_choice_without_keys_or_with_a_grammar_has_no_dtmf(menu: str, choice: str) -> None:
    """2.2.4"""
    prompt = '<prompt><enumerate><value expr="typeof _dtmf"/></enumerate></prompt>'
    assert Call(f"<menu{menu}>{prompt}{choice}</menu>").play() == ["undefined"]


@pytest.mark.parametrize("tag", ["s", "sentence", "emphasis"])
def test_the_choices_may_be_enumerated_in_a_sentence(tag: str) -> None:  # 2.2.4
    text = f"""<menu><prompt>Say <{tag}>one of <enumerate/></{tag}></prompt>
        <choice event="exit">tea</choice><choice event="exit">milk</choice></menu>"""
    assert run(text).said() == ["Say one of tea; milk"]


def test_an_approximate_option_takes_parts_in_their_order() -> None:  # 2.2.5
    call = Call(
        ask('<option accept="approximate">the big moose</option><nomatch><log>no</log></nomatch>')
    )
    call.answer("moose big", "big moose")
    assert call.logs() == ["no", "the big moose"]


@pytest.mark.parametrize(
    "said", ["京都", "ニュース", "京都ニュース", "大学 ニュース", "FM ニュース"]
)
def test_an_approximate_option_takes_words_that_no_spaces_divide(said: str) -> None:  # 2.2.5
    option = '<option accept="approximate" value="x">京都 大学 FM ニュース</option>'
    call = Call(ask(f"{option}<nomatch><log>no</log></nomatch>"))
    call.answer("京", "ニュース京都", said)
    assert call.logs() == ["no", "no", "x"]


def test_a_menu_goes_where_its_choice_leads() -> None:
    call = Call(
        """<menu dtmf="true"><prompt>Choose: <enumerate/></prompt>
          <choice next="#a">Sports</choice><choice next="#b">Weather</choice></menu>
        <form id="a"><block>Goal!</block></form><form id="b"><block>Sunny.</block></form>"""
    )
    assert call.play() == ["Choose: Sports; Weather"]
    call.answer("weather")
    assert call.said()[-1] == "Sunny."
