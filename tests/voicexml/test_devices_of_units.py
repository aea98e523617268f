"""Devices of units in VoiceXML documents: all that the handlers they can reach need (U5)."""

from __future__ import annotations

import pytest

from prima.voicexml.reading import read_page
from prima.voicexml.sketch import Sketch
from tests.helpers.robot import document
from tests.helpers.units import SPEECH, P, ask, problems_of, unit
from tests.helpers.voice import Call, vxml

# What it owns ------------------------------------------------------------------------------
TURNS = '<catch event="{}"><p:turn angle="90"/></catch>'
GOES = '<catch event="{}"><p:topological-move to="hall"/></catch>'


def reaching(
    form: str = "", inner: str = "", field: str = "", content: str = "", outer: str = ""
) -> str:
    text = (
        f"<vxml version='2.1' xmlns='http://www.w3.org/2001/vxml' {P} xml:lang='en'>\n"
        f"<form id='a'>{form}\n<p:iu name='u'>{inner}"
        f"<field name='x' type='boolean'><prompt>May I?</prompt>{field}</field>"
        f"<block>{content}</block></p:iu><block><exit/></block></form>"
        f"<form id='b'><block><p:topological-move to='hall'/></block></form>{outer}</vxml>"
    )
    return text


def devices_of(text: str) -> set[str]:
    page = read_page("app.vxml", "app.vxml", text.encode())
    assert [str(one) for one in page.problems] == []
    sketch = Sketch(page, None)
    [(_, found)] = sketch.units
    return set(sketch.reach(found).devices)


@pytest.mark.parametrize(
    "parts",
    [
        {"field": '<filled><throw event="x.y"/></filled>', "outer": TURNS.format("x")},
        {"content": '<throw event="x"/>', "form": TURNS.format("x")},
        {"content": "<throw eventexpr='x'/>", "outer": TURNS.format("z")},
        {"content": '<if cond="x"><else/><throw event="x"/></if>', "form": TURNS.format("x")},
        {"form": TURNS.format("noinput")},
        {"form": '<noinput count="3"><p:turn angle="9"/></noinput>'},
        {"form": "<catch><p:turn angle='9'/></catch>"},
        {"outer": "<error><p:turn angle='9'/></error>"},
        {"field": TURNS.format("touch")},
        {"inner": TURNS.format("touch")},
        {"form": '<filled><p:turn angle="90"/></filled>'},
        {"form": '<filled namelist="x">Fine. <prompt>So <p:turn angle="9"/></prompt></filled>'},
        {"field": '<prompt count="2"><p:turn angle="9"/></prompt>'},
        {"field": '<prompt cond="x"><p:turn angle="9"/></prompt>'},
        {"content": '<p:par><p:turn angle="9"/><p:speak>a</p:speak></p:par>'},
        {
            "field": '<link event="x"><grammar src="a.grxml"/></link>',
            "form": TURNS.format("x"),
        },
        {"form": '<link event="x" dtmf="1"/>' + TURNS.format("x")},
        {"outer": '<link eventexpr="1" dtmf="1"/>' + TURNS.format("x")},
        {
            "form": '<property name="universals" value="all"/>',
            "outer": "<help><p:turn angle='9'/></help>",
        },
    ],
)
def test_a_unit_owns_what_the_handlers_need_that_it_can_reach(parts: dict[str, str]) -> None:
    assert devices_of(reaching(**parts)) == {*SPEECH, "locomotion"}


@pytest.mark.parametrize(
    "parts",
    [
        {"form": TURNS.format("touch")},
        {"outer": TURNS.format("x")},
        {"outer": TURNS.format("error.unit.timeout")},
        {"outer": "<help><p:turn angle='9'/></help>"},
        {"field": "<noinput><reprompt/></noinput>", "outer": TURNS.format("noinput")},
        {"inner": "<noinput><reprompt/></noinput>", "form": TURNS.format("noinput")},
        {
            "form": '<field name="y" type="boolean"/>'
            '<filled namelist="y"><p:turn angle="9"/></filled>'
        },
    ],
)
def test_a_unit_owns_nothing_for_handlers_that_it_cannot_reach(parts: dict[str, str]) -> None:
    assert devices_of(reaching(**parts)) == SPEECH


def test_a_unit_that_says_nothing_does_not_own_the_speaker() -> None:
    text = vxml(unit("<block><p:turn angle='9'/></block>"))
    assert devices_of(text) == {"locomotion"}
    music = "<block><data name='d' src='d.xml' fetchaudio='a.wav'/></block>"
    assert devices_of(vxml(unit(music))) == {"speaker"}
    sets = '<property name="fetchaudio" value="a.wav"/>'
    assert devices_of(vxml(sets + unit(music.replace(" fetchaudio='a.wav'", "")))) == {"speaker"}
    assert devices_of(vxml(sets + unit("<block><script src='a.js'/></block>"))) == set()
    assert devices_of(vxml(sets + unit("<block><goto next='#x'/></block>"))) == set()
    described = "<audio src='a.wav'><desc>A tune.</desc></audio>"
    assert devices_of(vxml(unit(f"<block>{described}</block>"))) == {"speaker"}


HELP = "There is no help here."


@pytest.mark.parametrize(
    ("around", "devices", "said"),
    [
        ("", {"speaker"}, [HELP]),
        ("<help><log>help</log></help>", set(), []),
        ("<help cond='false'/>", {"speaker"}, [HELP]),
        ("<help count='2'/>", {"speaker"}, [HELP]),
    ],
)
def test_a_unit_owns_what_the_platforms_own_handlers_need(
    around: str, devices: set[str], said: list[str]
) -> None:  # 5.2.5
    text = vxml(unit("<block><throw event='help'/></block>", "", "", around))
    assert devices_of(text) == devices
    assert Call(text).play() == said


def test_a_unit_owns_what_a_handler_of_the_application_root_needs() -> None:
    root = vxml(f"<noinput><p:turn {P} angle='9'/><reprompt/></noinput>")
    leaf = (
        "<vxml version='2.1' xmlns='http://www.w3.org/2001/vxml' application='root.vxml'>"
        + unit(ask())
        + "</vxml>"
    )
    call = Call(leaf, root=root)
    call.silence()
    assert call.saying() == ["iu", "turn"]


def test_nobody_takes_a_device_that_only_a_handler_needs() -> None:
    other = document('<form id="a"><on event="touch"><turn angle="10"/></on></form>', name="other")
    call = Call(
        unit(ask("<filled><throw event='turn'/></filled>"))
        + f"<catch event='turn'><p:turn {P} angle='90'/></catch>",
        other,  # type: ignore[arg-type]
    )
    call.listens()
    call.event("touch")
    assert call.saying() == ["May I?", "iu"], "the wheels are the unit's"
    call.hears("yes")
    assert call.saying() == ["iu", "turn"]


def test_a_unit_owns_what_an_answer_for_another_item_leads_to() -> None:
    grammar = '<grammar src="a.grxml"/>'
    other = '<field name="z"><filled><p:turn angle="9"/></filled></field>'
    assert devices_of(reaching(form=other)) == SPEECH
    assert devices_of(reaching(form=grammar + other)) == {*SPEECH, "locomotion"}
    asked = '<field name="z"><prompt><p:turn angle="9"/></prompt></field>'
    assert devices_of(reaching(form=grammar + asked)) == SPEECH


# What is refused -----------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("parts", "says"),
    [
        (
            {"field": '<filled><throw event="x"/></filled>', "outer": GOES.format("x")},
            "<p:topological-move> leaves the user, and the unit in line 3 reaches it by the event"
            ' "x"; it is not allowed in a unit. Handle "x" in the <p:iu> as well,'
            " or leave the <p:iu> with <goto> first.",
        ),
        (
            {"form": "<noinput><p:tracking-human/></noinput>"},
            "<p:tracking-human> works in a feedback loop, and the unit in line 3 reaches it by the"
            ' event "noinput"; it is not allowed',
        ),
        (
            {"form": '<filled><p:topological-move to="hall"/></filled>'},
            "and the unit in line 3 reaches it; it is not allowed in a unit. Leave the <p:iu> with",
        ),
        (
            {"field": GOES.format("touch")},
            "<p:topological-move> leaves the user; it is not allowed",
        ),
        ({"content": '<p:topological-move to="hall"/>'}, "Move it out of the <p:iu>."),
    ],
)
def test_no_command_that_a_unit_reaches_leaves_the_user(parts: dict[str, str], says: str) -> None:
    [problem] = problems_of(reaching(**parts))
    assert (problem.code, problem.severity) == ("not-in-unit", "error")
    assert says in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    "parts",
    [
        {"form": GOES.format("touch")},
        {"outer": GOES.format("error.unit.timeout")},
        {"outer": '<noinput><goto next="#b"/></noinput>'},
        {"field": "<noinput><exit/></noinput>", "outer": GOES.format("noinput")},
    ],
)
def test_a_command_that_no_unit_reaches_may_leave_the_user(parts: dict[str, str]) -> None:
    assert problems_of(reaching(**parts)) == []


def test_at_run_time_a_unit_refuses_what_it_does_not_own() -> None:  # E3
    root = vxml(f"<catch event='x'><p:topological-move {P} to='hall'/></catch>"
                "<catch event='error.semantic'><log expr='_message'/><exit/></catch>")  # fmt: skip
    leaf = (
        "<vxml version='2.1' xmlns='http://www.w3.org/2001/vxml' application='root.vxml'>"
        + unit(ask("<filled><throw event='x'/></filled>"))
        + "</vxml>"
    )
    call = Call(leaf, root=root)
    call.answer("yes")
    [told] = call.logs()
    assert told.endswith("topological-move cannot be part of a unit: it works in loops.")
    [refused] = [r for r in call.phases("fail") if r["rule"] == "E3"]
    assert refused["event"] == "error.semantic"
