"""Links: VoiceXML 2.0, 2.5."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    ENDS,
    GO,
    HOME,
    LEAF,
    PAGE,
    PASS,
    TRIP,
    YES,
    Case,
    Cases,
    ask,
    block,
    leaf,
    page,
    rule,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "a document's link leads to a dialog from any field",
    "2.5",
    f"""<link next="#b">{HOME}</link><form><field name="f">{CITIES}</field></form>{ENDS}""",
    "go home",
    logs=["b"],
)
case(
    "a form's link listens in that form alone",
    "2.5",
    f"""<form><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>
    <form><link event="x">{HOME}</link></form>""",
    "go home",
    logs=["no"],
)
case(
    "a form's link throws its event where the user is",
    "2.5",
    f"""<form><link event="odd" message="m">{HOME}</link><field name="f">{CITIES}
    <catch event="odd"><log expr="'field' + _message"/></catch></field>
    <catch event="odd"><log>form</log></catch></form>""",
    "go home",
    logs=["fieldm"],
)
case(
    "a link's event is counted by the item",
    "2.5",
    f"""<form><link event="help">{HOME}</link><field name="f">{CITIES}
    <help><log>1</log></help><help count="2"><log>2</log></help></field></form>""",
    "go home",
    "go home",
    logs=["1", "2"],
)
case(
    "a field's link listens in that field alone",
    "2.5",
    f"""<form><catch event="odd"><log>odd</log></catch><nomatch><log>no</log></nomatch>
    <field name="f"><link event="odd">{HOME}</link>{CITIES}</field>
    <field name="g">{CITIES}</field></form>""",
    "go home",
    "kyoto",
    "go home",
    logs=["odd", "no"],
)
case(
    "an initial's link listens there",
    "2.5",
    f"""<form>{TRIP}<catch event="odd"><log>odd</log></catch>
    <initial><link event="odd">{HOME}</link></initial><field name="start"/></form>""",
    "go home",
    logs=["odd"],
)
case(
    "a link's target may be computed",
    "2.5",
    f"""<form><var name="n" expr="'b'"/><link expr="'#' + n">{HOME}</link>
    <field name="f">{CITIES}</field></form>{ENDS}""",
    "go home",
    logs=["b"],
)
case(
    "a link's event may be computed",
    "2.5",
    f"""<form><var name="n" expr="1"/><link eventexpr="'odd.' + n" messageexpr="n + 1">{HOME}</link>
    <field name="f">{CITIES}<catch event="odd"><log expr="_event + _message"/></catch></field>
    </form>""",
    "go home",
    logs=["odd.12"],
)
case(
    "a link has a key",
    "2.5",
    f"""<link next="#b" dtmf="*9"/><form><field name="f">{CITIES}</field></form>{ENDS}""",
    "*9",
    logs=["b"],
)
case(
    "the root's links listen in its leaves",
    "2.5",
    f"""{LEAF}<form><field name="f">{CITIES}<catch event="odd"><log>odd</log></catch></field></form>
    </vxml>""",
    "go home",
    logs=["odd"],
    files={"root": f"{PAGE}<link event='odd'>{HOME}</link></vxml>"},
)
case(
    "a menu hears links",
    "2.5",
    f"""<link next="#b">{HOME}</link><menu><choice next="#a">x</choice></menu>{ENDS}""",
    "go home",
    logs=["b"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


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


def test_a_links_expression_is_evaluated_where_it_is_heard() -> None:  # 2.5
    call = run(
        leaf(
            f"""<form><var name="to" expr="'#y'"/><field name="f">{YES}</field></form>
            <form id="y"><block>{PASS}</block></form>"""
        ),
        "go",
        root=page(f"""<var name="to" expr="'#z'"/><link expr="to">{GO}</link>"""),
    )
    assert call.logs() == ["pass"]
