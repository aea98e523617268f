"""Fields, blocks and initial items: VoiceXML 2.0, 2.3.1 to 2.3.3."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    FAIL,
    GO,
    HOME,
    MIXED,
    OOPS,
    PASS,
    TRIP,
    YES,
    Case,
    Cases,
    ask,
    asked,
    grammar,
    rule,
    run,
)
from tests.helpers.voice import Call

case = Cases()

case(
    "a field's shadow variables tell how it was filled",
    "2.3.1",
    f"""<form><field name="f">{CITIES}</field><block>
    <log expr="[f$.utterance, f$.inputmode, f$.interpretation, f$.confidence].join()"/>
    </block></form>""",
    "Kyoto",
    logs=["Kyoto,voice,Kyoto,1"],
)
case(
    "a slot names the property that fills the field",
    "2.3.1",
    f"""<form>{TRIP}<field name="f" slot="start"/><field name="g" slot="end"/>
    <filled><log expr="f + g"/></filled></form>""",
    "from Nara to Osaka",
    logs=["NaraOsaka"],
)
case(
    "a field's built-in type is its grammar",
    "2.3.1",
    """<form><field name="f" type="boolean"/><block><log expr="f === true"/></block></form>""",
    "yes",
    logs=["true"],
)
case(
    "a modal field turns off all other grammars",
    "2.3.1",
    f"""<link event="home">{HOME}</link><catch event="home"><log>home</log></catch>
    <form>{TRIP}<field name="f" modal="true">{CITIES}<nomatch><log>nomatch</log></nomatch></field>
    <field name="start" expr="1"/></form>""",
    "go home",
    "from Nara",
    logs=["nomatch", "nomatch"],
)
case(
    "a field that is not modal hears links and the form",
    "2.3.1",
    f"""<link event="home">{HOME}</link><catch event="home"><log>home</log></catch>
    <form>{TRIP}<field name="f" modal="false">{CITIES}</field>
    <field name="start"/><block><log expr="start"/></block></form>""",
    "go home",
    "from Nara",
    "kyoto",
    logs=["home", "Nara"],
)
case(
    "an unnamed field is filled and left",
    "2.3.1",
    f"""<form><field>{CITIES}<filled><log>filled</log></filled></field></form>""",
    "kyoto",
    logs=["filled"],
    ended="exit",
)
case(
    "another field's grammar does not listen",
    "2.3.1",
    f"""<form><field name="a"><option>red</option><nomatch><log>no</log></nomatch></field>
    <field name="b">{CITIES}</field></form>""",
    "kyoto",
    logs=["no"],
)
case(
    "a form's grammar gives each field its shadow",
    "2.3.1",
    f"""<form>{TRIP}<field name="start"/><field name="end"/><filled>
    <log expr="start$.utterance + '/' + end$.utterance"/></filled></form>""",
    "from Nara to Osaka",
    logs=["from Nara to Osaka/from Nara to Osaka"],
)
case(
    "a field's no is an answer",
    "2.3.1",
    """<form><field name="f" type="boolean"><filled><log expr="f"/></filled></field>
    <filled><log>form</log></filled></form>""",
    "no",
    logs=["false", "form"],
    ended="exit",
)
case(
    "an option without a value gives its text",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="1"> New   York </option></field>
    <block><log expr="f"/></block></form>""",
    "new york",
    logs=["New York"],
)
case(
    "an option is chosen by its key",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="1" value="a">Kyoto</option>
    <option dtmf="2" value="b">Nara</option></field>
    <block><log expr="f + f$.inputmode"/></block></form>""",
    "2",
    logs=["bdtmf"],
)
case(
    "an option with neither value nor text gives its key",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="3"/></field><block><log expr="f"/></block></form>""",
    "3",
    logs=["3"],
)
case(
    "an option is exact by default",
    "2.3.1.3",
    """<form><field name="f"><option>New York City</option><nomatch><log>no</log></nomatch></field>
    </form>""",
    "new york",
    logs=["no"],
)
case(
    "an unnamed block with an expr is not visited",
    "2.3.2",
    "<form><block expr='true'><log>no</log></block><block><log>yes</log></block></form>",
    logs=["yes"],
)
case(
    "a block's variable is true before its content runs",
    "2.3.2",
    "<form><block name='b'><log expr='b'/></block></form>",
    logs=["true"],
)
case(
    "text in a block is said as a prompt",
    "2.3.2",
    "<form><block>One <value expr='1 + 1'/> <prompt>three</prompt> four</block></form>",
    said=["One 2", "three", "four"],
)
case(
    "a block is run once",
    "2.3.2",
    "<form><block><log>a</log></block><block><log>b</log></block></form>",
    logs=["a", "b"],
    ended="exit",
)
case(
    "what initial leaves open is asked for",
    "2.3.3",
    MIXED,
    "to Nara",
    "kyoto",
    logs=["e:Nara", "s:Kyoto", "Kyoto-Nara-true"],
    said=["Your trip?", "From?"],
)
case(
    "initial is left when its variable is set",
    "2.3.3",
    MIXED,
    "x",
    "y",
    "kyoto",
    "nara",
    said=["Your trip?", OOPS, "Your trip?", "Step by step.", "From?", "To?"],
    logs=["s:Kyoto", "e:Nara", "Kyoto-Nara-true"],
)
case(
    "a field's own grammar does not listen during initial",
    "2.3.3",
    MIXED,
    "kyoto",
    "from Nara",
    "kyoto",
    said=["Your trip?", OOPS, "Your trip?", "To?"],
    logs=["s:Nara", "e:Kyoto", "Nara-Kyoto-true"],
)
case(
    "an initial with a goto back is visited again when cleared",
    "2.3.3",
    f"""<form>{TRIP}<initial name="init"><prompt>Trip?</prompt></initial>
    <field name="start"><prompt>From?</prompt>{CITIES}</field>
    <field name="end"><prompt>To?</prompt>{CITIES}
    <filled><if cond="end == 'Nara'"><clear namelist="init start end"/></if></filled></field></form>""",
    "from Kyoto to Nara",
    "from Nara to Osaka",
    said=["Trip?", "Trip?"],
    ended="exit",
)
case(
    "an initial's condition is its guard",
    "2.3.3",
    f"""<form>{TRIP}<initial cond="false"><prompt>Trip?</prompt></initial>
    <field name="start"><prompt>From?</prompt>{CITIES}</field></form>""",
    "nara",
    said=["From?"],
    ended="exit",
)
case(
    "an initial's event counters are its own",
    "2.3.3",
    f"""<form>{TRIP}<initial name="i"><nomatch count="2"><assign name="i" expr="true"/></nomatch>
    </initial><field name="start">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch></field></form>""",
    "x",
    "x",
    "x",
    logs=["1"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_the_value_of_an_option_may_be_empty() -> None:  # 2.3.1.3
    option = '<option value="">blank</option><option dtmf="1" value="">none</option>'
    for said in ("blank", "1"):
        assert asked(f"{option}<filled><log expr=\"f === ''\"/></filled>", said)[0] == "true"


def test_a_modal_field_hears_its_own_grammars_alone() -> None:  # 2.3.1
    call = Call(
        f'<link event="odd">{rule("operator")}</link>'
        + ask("<option>yes</option><nomatch><log>no</log></nomatch>", more='modal="true"')
    )
    call.answer("operator", "yes")
    assert call.logs() == ["no", "yes"]


def test_the_input_mode_is_told() -> None:  # 2.3.1
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><option dtmf="1" value="a">apple</option>
        <filled><log expr="f$.inputmode"/><log expr="f"/></filled></field>
        <field name="g"><prompt>And?</prompt><option dtmf="1">apple</option>
        <filled><log expr="g$.inputmode"/></filled></field></form>"""
    )
    call.answer("1", "apple")
    assert call.logs() == ["dtmf", "a", "voice"]


def test_an_unknown_built_in_type_is_unsupported() -> None:  # 2.3.1
    call = Call(
        '<catch event="error.unsupported.builtin"><log expr="_event"/><exit/></catch>'
        + ask("", more='type="x-colour"')
    )
    assert call.logs() == ["error.unsupported.builtin"]


def test_a_type_and_a_grammar_listen_together() -> None:  # 2.3.1
    assert asked(rule("maybe"), "maybe", more='type="boolean"') == ["maybe"]
    assert asked(rule("maybe"), "no", more='type="boolean"') == ["false"]


def test_a_modal_field_hears_its_own_links() -> None:  # 2.3.1, 3.1.4
    call = run(
        f"""<link event="y">{grammar("away")}</link><form><field name="f" modal="true">{YES}
        <link event="x">{GO}</link><catch event="x">{PASS}</catch><catch event="y">{FAIL}</catch>
        <nomatch><log>no</log></nomatch></field></form>""",
        "away",
        "go",
    )
    assert call.logs() == ["no", "pass"]


def test_a_field_may_be_called_as_what_all_objects_have() -> None:  # 2.3.1
    text = f"""<form><field name="constructor"><prompt>Q?</prompt>{YES}<filled>{PASS}</filled></field>
        </form>"""
    assert run(text, "yes").logs() == ["pass"]


def test_options_are_heard_by_their_text_and_give_their_value() -> None:  # 2.3.1.3
    assert asked('<option value="m"> a  moose </option>', "A moose.") == ["m"]
