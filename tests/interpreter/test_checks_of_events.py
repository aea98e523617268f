"""Which events a document of PRIMA's own language may name."""

from __future__ import annotations

import json
import tracemalloc
from pathlib import Path
from typing import Any

import pytest

from prima.interpreter.reader import read_document
from tests.helpers.bad_input import app
from tests.helpers.here import prima
from tests.helpers.robot import Bench, read


def problems(folder: Path, text: str, code: str) -> list[dict[str, Any]]:
    """The problems of a document that have a code, as ``prima validate`` reports them."""
    (folder / "a.xml").write_text(text)
    done = prima("validate", "a.xml", "--format", "json", cwd=folder)
    return [one for one in json.loads(done.stdout) if one["code"] == code]


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<form id="m"><block><log expr="event.name"/><exit/></block></form>', "event"),
        ('<form id="m"><block><log expr="event.text"/><exit/></block></form>', "event"),
        ('<form id="m"><block><log expr="1 + _event.name"/><exit/></block></form>', "_event"),
        ('<form id="m"><block><speak>A<value expr="_message"/></speak><exit/></block></form>', "_message"),
        ('<form id="m"><block><speak>A<on event="failed"><log expr="event.name"/></on></speak><exit/></block></form>', ""),
        ('<form id="m"><block><exit/></block></form><on event="touch" cond="event.data"><log expr="event"/></on>', ""),
        ('<form id="m"><block><log expr="[1].map(event => event)"/><exit/></block></form>', ""),
        ("""<form id="m"><block><log expr="'event'"/><exit/></block></form>""", ""),
        ('<var name="event" expr="1"/><form id="m"><block><log expr="event"/><exit/></block></form>', ""),
        ('<form id="m"><block><foreach item="event" array="[1]"><log expr="event"/></foreach><exit/></block></form>', ""),
        ('<form id="m"><block><log expr="typeof event"/><exit/></block></form>', ""),
    ],
)  # fmt: skip
def test_an_event_is_known_in_its_handlers_alone(content: str, name: str, tmp_path: Path) -> None:
    text = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">{content}</prima>'
    found = problems(tmp_path, text, "undeclared-variable")
    assert [one["column"] for one in found] == ([text.index(name) + 1] if name else [])
    assert all(f'"{name}" exists only in handlers' in one["message"] for one in found)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ('<assign name="event" expr="1"/>', 'Declare it: <var name="event"/>.'),
        ('<assign name="session.user" expr="1"/>', 'Declare it: <var name="session"/>.'),
        ('<log expr="evnt.data"/>', 'Declare it: <var name="evnt"/>.'),
        ('<speak>A<on event="failed"><log expr="evnt.data"/></on></speak>', 'Did you mean "event"?'),
        ('<assign name="class" expr="1"/>', "Choose another name."),
        ('<clear namelist="class"/>', "Choose another name."),
        ('<assign expr="1"/>', ""),
        ('<assign name="a b" expr="1"/>', ""),
        ('<clear namelist="a-b"/>', ""),
    ],
)  # fmt: skip
def test_the_remedy_for_an_undeclared_variable_can_be_followed(
    content: str, says: str, tmp_path: Path
) -> None:
    text = (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="m">'
        f"<block>{content}<exit/></block></form></prima>"
    )
    assert [one["remedy"] for one in problems(tmp_path, text, "undeclared-variable")] == [
        remedy for remedy in [says] if remedy
    ]


@pytest.mark.parametrize(
    ("event", "meant"),
    [
        *(
            ("touch_head", "touch.head"),
            ("end_q-and-a", "end.q-and-a"),
            ("tuch.head", "touch.head"),
        ),
        *(("touch", ""), ("touch.head_left", ""), ("exhibit_touched", ""), ("message_board", "")),
    ],
)
def test_a_sign_in_place_of_the_dot_is_told(event: str, meant: str, tmp_path: Path) -> None:
    form = f'<form id="m"><block><exit/></block><on event="{event}"><exit/></on></form>'
    found = problems(tmp_path, app(form), "unknown-event")
    assert [one["remedy"] for one in found] == ([f'Did you mean "{meant}"?'] if meant else [])


@pytest.mark.parametrize(
    ("device", "meant"), [("camera", ""), ("gripper", ""), ("speeker", "speaker"), ("arm", "")]
)
def test_a_robot_may_have_a_device_of_its_own(device: str, meant: str, tmp_path: Path) -> None:
    handler = f'<on event="error.device.{device}"><exit/></on>'
    text = app(f'<form id="m"><block><speak>A</speak></block>{handler}</form>')
    found = problems(tmp_path, text, "unknown-event")
    assert [one["remedy"] for one in found] == (
        [f'Did you mean "error.device.{meant}"?'] if meant else []
    )


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("event.text", "Write event.data.text."),
        ("event?.nme", 'Did you mean "name"? Or write event.data.nme.'),
        ("1 + event . from.length", "Write event.data.from."),
        ("event.data.text + event.name + event.message", ""),
        ("event.toString()", ""),
        ("'event.text' + event.name", ""),
        ("[1].map(event => event.text)", ""),
    ],
)
def test_an_event_has_three_parts(code: str, says: str, tmp_path: Path) -> None:
    text = (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="m">'
        f'<on event="message"><log expr="{code}"/></on></form></prima>'
    )
    found = problems(tmp_path, text, "undeclared-variable")
    assert [(one["severity"], one["remedy"]) for one in found] == [("warning", says)] * bool(says)


@pytest.mark.parametrize(
    ("prompts", "told"),
    [
        ("<prompt/>", 1),
        ("<prompt> </prompt>", 1),
        ('<prompt>A?</prompt><prompt count="2"/>', 0),
        ('<prompt timeout="2s"/>', 0),
        ('<prompt bargein="false"/>', 0),
        ('<prompt><value expr="1"/></prompt>', 0),
        ("", 0),
    ],
)
def test_a_prompt_that_asks_nothing_is_told(prompts: str, told: int, tmp_path: Path) -> None:
    text = (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="m">'
        f'<field name="x" type="text">{prompts}<noinput><exit/></noinput></field></form></prima>'
    )
    found = problems(tmp_path, text, "nothing-to-say")
    assert [one["severity"] for one in found] == ["warning"] * told


def test_the_end_of_a_question_has_the_name_of_its_command(tmp_path: Path) -> None:
    text = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="m">
    <field name="f" type="boolean"><prompt>Yes?</prompt>
      <on event="end.%s"><exit/></on><noinput><exit/></noinput></field></form></prima>"""
    (found,) = problems(tmp_path, text % "field", "unknown-event")
    assert 'Did you mean "end.q-and-a"?' in found["message"] + found["remedy"]
    assert not problems(tmp_path, text % "q-and-a", "unknown-event")


@pytest.mark.parametrize("what", ["end", "cancel", "interrupted", "expired"])
def test_a_unit_around_commands_has_events_but_for_its_end(what: str, tmp_path: Path) -> None:
    text = f"""<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="m">
    <block><iu><speak>Hello.</speak><gesture name="bow"/></iu><exit/></block>
    <on event="{what}.iu"><exit/></on></form></prima>"""
    assert len(problems(tmp_path, text, "unknown-event")) == (what == "end")
    assert problems(tmp_path, text.replace("iu>", "seq>"), "unknown-event")


@pytest.mark.parametrize(
    ("named", "alone", "in_unit"),
    [
        ("end", 0, 1),
        ("end.speak", 0, 1),
        ("cancel.speak", 0, 1),
        ("expired", 0, 1),
        ("error", 0, 0),
        ("error.device.speaker", 0, 0),
        ("end.turn", 1, 1),
        ("touch", 1, 1),
        ("touch error end.speak", 1, 2),
        ("suspended", 1, 1),
    ],
)
def test_a_handler_in_a_command_takes_its_events_alone(
    named: str, alone: int, in_unit: int, tmp_path: Path
) -> None:
    text = f"""<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="m">
    <block><seq><speak>Hello.<on event="{named}"><exit/></on></speak><turn angle="9"/></seq>
    <exit/></block></form></prima>"""
    found = problems(tmp_path, text, "unknown-event")
    assert len(found) == alone
    assert all("takes only its own events" in one["message"] for one in found)
    inside = problems(tmp_path, text.replace("seq>", "iu>"), "unknown-event")
    assert len(inside) == in_unit
    assert all("takes only its errors" in one["message"] for one in inside)


def test_a_name_of_many_parts_takes_no_more_room_than_a_few_of_them() -> None:
    name = ".".join("a" * 20_000)
    text = app(
        f'<form id="f"><on event="touch" reactive="true"><throw event="{name}"/></on></form>'
    )
    tracemalloc.start()
    try:
        read_document("a.xml", text.encode())
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("handler", "told"),
    [
        ('<on event="message"><log expr="event.data.txt"/></on>', 1),
        ('<on event="interrupted.speak"><log expr="event.data.herd"/></on>', 1),
        ('<on event="interrupted"><log expr="event.data.done + event.data.heard"/></on>', 0),
        ('<on event="late"><log expr="event.data.tekst"/></on>', 1),
        ('<on event="message" cond="event.data.form == \'Ann\'"><exit/></on>', 1),
        ('<on event="touch.head touch.back"><script>var a = event.data?.sensr;</script></on>', 1),
        ('<on event="message"><log expr="event.data.text + event.data[\'txt\']"/></on>', 0),
        ('<on event="message"><log expr="event.data.colour"/></on>', 0),
        ('<on event="touch message"><log expr="event.data.txt"/></on>', 0),
        ('<on event="human"><log expr="event.data.distanc"/></on>', 0),
        ('<on event="message"><var name="event" expr="1"/><log expr="event.data.txt"/></on>', 0),
        (
            '<on event="message"><speak>Hm.<on event="error"><log expr="event.data.txt"/></on>'
            "</speak></on>",
            0,
        ),
    ],
)
def test_a_misspelt_part_of_what_an_event_brings_is_told(
    handler: str, told: int, tmp_path: Path
) -> None:
    text = (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="m">'
        f"{handler}</form></prima>"
    )
    found = problems(tmp_path, text, "undeclared-variable")
    assert [one["severity"] for one in found] == ["warning"] * told


@pytest.mark.parametrize(
    ("raises", "told"),
    [
        ("", 1),
        ('<link event="help"><grammar>help</grammar></link>', 0),
        ('<link event="help.rooms"><grammar>rooms</grammar></link>', 0),
        ('<on event="touch"><throw event="help"/></on>', 0),
        ("""<on event="touch"><throw event-expr="'help'"/></on>""", 0),
    ],
)
def test_help_that_nothing_raises_is_told(raises: str, told: int, tmp_path: Path) -> None:
    """Other than in VoiceXML, where all applications may understand the word."""
    text = app(f'<form id="f"><block><exit/></block></form><help><exit/></help>{raises}')
    assert len(problems(tmp_path, text, "unknown-event")) == told


OTHER = '<form id="b"><on event="gone"><exit/></on></form>'


@pytest.mark.parametrize(
    "body",
    [
        '<form id="a"><block><throw event="gone"/></block></form>' + OTHER,
        '<form id="a"><subdialog name="s" src="#c"><on event="gone"><exit/></on></subdialog></form>'
        '<form id="c"><block><throw event="gone.far"/></block></form>',
    ],
)
def test_an_event_that_only_other_forms_handle_ends_the_application(body: str) -> None:
    (told,) = [one for one in read(body)[1] if one.code == "unheard-event"]
    assert told.message.startswith("No handler of this form or of the document takes")
    assert Bench(body).session.failures != []


@pytest.mark.parametrize(
    "body",
    [
        '<form id="a"><block><throw event="gone"/></block></form><on event="gone"><exit/></on>',
        '<form id="a"><block><throw event="gone.far"/></block><on event="gone"><exit/></on></form>',
        '<form id="a"><block name="c"><throw event="gone"/></block><iu><block><exit/></block>'
        '<on event="gone"><exit/></on></iu></form>',
        '<form id="a"><subdialog name="s" src="#c"><on event="gone"><exit/></on></subdialog></form>'
        '<form id="c"><block><return event="gone"/></block></form>',
        '<form id="a"><block><throw event="help"/></block></form>'
        '<form id="b"><help><exit/></help></form>',
    ],
)
def test_an_event_that_may_reach_a_handler_is_not_warned_of(body: str) -> None:
    assert [one for one in read(body + OTHER)[1] if one.code == "unheard-event"] == []
