"""Fetching attributes, metadata and properties: VoiceXML 2.0, chapter 6."""

from __future__ import annotations

import pytest

from prima.voicexml.reading import read_page
from tests.helpers.dialogs import GRAMMAR, PASS, YES, ask, asked, block, file, leaf, question, run
from tests.helpers.voice import Call, Online, vxml

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


def test_an_element_can_do_without_the_fetch_audio_of_a_property() -> None:  # 6.1.1
    sets = '<property name="fetchaudio" value="hold.wav"/>'
    leads = block('One moment.<submit next="service:slow" fetchaudio=""/>')
    slow = {"service:slow": None}
    assert Online(slow, sets + leads).said() == []
    assert Online(slow, sets + leads.replace(' fetchaudio=""', "")).said() == ["One moment."]


def test_meta_and_metadata_change_nothing() -> None:  # 6.2
    call = Call(
        '<meta name="author" content="A"/><meta http-equiv="Expires" content="0"/>'
        '<metadata><rdf:RDF xmlns:rdf="urn:r"><rdf:x>text</rdf:x></rdf:RDF></metadata>'
        + block("<log>on</log>")
    )
    assert call.logs() == ["on"]


def test_an_unknown_property_is_ignored() -> None:  # 6.3
    assert Call('<property name="x.y" value="z"/>' + block("<log>on</log>")).logs() == ["on"]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("timout", "timeout"),
        ("inputmode", "inputmodes"),
        ("bargeinType", "bargeintype"),
        ("universal", "universals"),
        ("fetchaudio", ""),
        ("com.example.timeout", ""),
        ("termdigits", ""),
        ("voicename", ""),
        ("", ""),
    ],
)
def test_a_misspelt_property_is_told(name: str, meant: str) -> None:
    text = vxml(f'<property name="{name}" value="x"/><form/>')
    found = read_page("a.vxml", "a.vxml", text.encode()).warnings()
    told = [f'There is no property "{name}" in VoiceXML: it has no effect.'] * bool(meant)
    assert [one.message for one in found if "property" in one.message] == told
    assert all(one.remedy == f'Did you mean "{meant}"?' for one in found if meant)


@pytest.mark.parametrize(
    ("name", "value", "remedy"),
    [
        ("timeout", "1", 'Write "1s".'),
        ("confidencelevel", "1.1", "Write a number from 0 to 1."),
        ("maxnbest", "x", "Write a whole number from 1."),
        ("bargein", "yes", "Write false or true."),
        ("inputmodes", "text", "Write dtmf, voice, or both with a space between."),
        ("inputmodes", "voice dtmf", None),
        ("recordutterance", "7", "Write false or true."),
        ("datafetchhint", "5", "Write prefetch or safe."),
        ("documentmaxage", "x", "Write a whole number from 0."),
        ("termchar", "12", "Write one key: 0 to 9, *, # or A to D; or none."),
        ("termchar", "", None),
        ("fetchtimeout", "3s", None),
        ("sensitivity", "0.5", None),
        ("com.example.timeout", "?", None),
    ],
)
def test_a_property_that_holds_nothing_is_warned_of(
    name: str, value: str, remedy: str | None
) -> None:  # 6.3
    text = f'<property name="{name}" value="{value}"/><form><block/></form>'
    found = read_page("a.vxml", "a.vxml", vxml(text).encode()).warnings()
    assert [(one.severity, one.remedy) for one in found] == [("warning", remedy)] * (
        remedy is not None
    )


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


@pytest.mark.parametrize(
    ("name", "outer", "wrong", "argument", "value"),
    [
        ("timeout", "2s", "two", "timeout", 2000),
        ("bargein", "false", "no", "bargein", False),
    ],
)
def test_a_value_of_the_wrong_kind_leaves_the_one_further_out(
    name: str, outer: str, wrong: str, argument: str, value: object
) -> None:  # 6.3.1
    inner = f'<property name="{name}" value="{wrong}"/>'
    call = Call(f'<property name="{name}" value="{outer}"/>' + ask(inner + YES))
    call.play()
    assert question(call)[argument] == value


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


def test_an_utterance_below_the_confidencelevel_is_nomatch() -> None:  # 6.3.2
    grammar = (
        f'<grammar {GRAMMAR} root="r"><rule id="r"><ruleref special="GARBAGE"/>tea</rule></grammar>'
    )
    low = '<nomatch><log expr="_event"/><exit/></nomatch>'
    said = "well well well well tea"
    head = '<property name="confidencelevel" value="{}"/>'
    assert asked(grammar + low, said, head=head.format(0.9)) == ["nomatch"]
    assert asked(grammar + low, said, head=head.format(0)) == ["tea"]


def test_a_confidence_that_nothing_can_reach_counts_for_nothing() -> None:  # 6.3.2
    text = f"""<property name="confidencelevel" value="1.1"/><form><field name="f">
        <prompt>Q?</prompt>{YES}<filled>{PASS}</filled></field></form>"""
    assert run(text, "yes").logs() == ["pass"]


def test_the_key_that_ends_an_input_is_no_part_of_it() -> None:  # 6.3.3
    assert asked("", "12#", more='type="digits"') == ["12"]


@pytest.mark.parametrize(
    ("key", "typed", "outcome"),
    [
        ("#", "12#", "12"),
        ("*", "12*", "12"),
        ("*", "12", "12"),
        ("*", "12#", "nomatch"),
        ("", "12#", "nomatch"),
    ],
)
def test_the_key_that_ends_an_input(key: str, typed: str, outcome: str) -> None:  # 6.3.3
    call = run(
        f"""<form><property name="termchar" value="{key}"/><field name="f" type="digits">
        <filled><log expr="f"/><exit/></filled><nomatch><log>nomatch</log><exit/></nomatch>
        </field></form>""",
        typed,
    )
    assert call.logs() == [outcome]


@pytest.mark.parametrize("value", ["", "5", "soon", "-1s"])
def test_a_timeout_that_is_no_time_is_the_platforms(value: str) -> None:  # 6.3.4
    call = Call(f'<property name="timeout" value="{value}"/>' + ask("<option>yes</option>"))
    call.play()
    assert question(call)["timeout"] == 5000


@pytest.mark.parametrize("value", ["inf", "nan", "-1", "many", "1e99", ""])
def test_a_maxnbest_that_is_none_is_one(value: str) -> None:  # 6.3.6
    assert asked(
        "<option>tea</option>", "tea", head=f'<property name="maxnbest" value="{value}"/>'
    ) == ["tea"]


def test_inputmodes_says_how_one_may_answer() -> None:  # 6.3.6
    call = Call(
        '<property name="inputmodes" value="voice"/>'
        + ask('<option dtmf="1">tea</option><nomatch><log>no</log></nomatch>')
    )
    call.answer("1", "tea")
    assert call.logs() == ["no", "tea"]


@pytest.mark.parametrize("value", ["text", "Voice", "dtmf,voice", ""])
def test_inputmodes_that_are_none_are_both(value: str) -> None:  # 6.3.6
    call = Call(
        f'<property name="inputmodes" value="{value}"/>'
        + ask('<option dtmf="1">tea</option><nomatch><log>no</log></nomatch>')
    )
    call.answer("1")
    assert call.logs() == ["tea"]


def test_universals_are_off_unless_a_property_names_them() -> None:  # 6.3.6
    assert asked("<option>tea</option><nomatch><log>no</log><exit/></nomatch>", "help") == ["no"]


def test_universals_throw_their_events() -> None:  # 6.3.6
    call = Call(
        '<property name="universals" value="help exit"/>'
        + ask("<option>tea</option><help><log>helped</log></help>")
    )
    call.answer("help", "exit")
    assert (call.logs(), call.ended) == (["helped"], "exit")
