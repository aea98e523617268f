"""Units around form items in VoiceXML documents (rule U5), as PRIMA's own language has them."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import loading
from prima.errors import DocumentError, Problem
from prima.voicexml.document import read_page
from prima.voicexml.sketch import Sketch
from tests.helpers.robot import document
from tests.helpers.voice import Call, Online, vxml

P = 'xmlns:p="urn:prima:dialogue:1"'
SPEECH = {"speaker", "speech-recognition"}
TOUCHED = '<form id="a"><on event="touch"><speak>Ouch.</speak></on></form>'
"""Another application, which speaks when the robot is touched."""


def unit(
    inner: str, behind: str = "", attributes: str = "", around: str = "", id: str = "a"
) -> str:
    """A form with a unit, and what stands behind and beside it."""
    return f"<form id='{id}' {P}><p:iu {attributes}>{inner}</p:iu>{behind}{around}</form>"


def ask(more: str = "", name: str = "x") -> str:
    """A question."""
    return f"<field name='{name}' type='boolean'><prompt>May I?</prompt>{more}</field>"


def say(text: str) -> str:
    return f"<block>{text}</block>"


PHOTO = unit(
    say("One moment.") + ask("<filled>Thanks.</filled>") + say("Smile!"),
    say("Bye."),
    "longest='20s'",
)


def with_other(text: str) -> Call:
    """A document beside an application that is touched and speaks."""
    return Call(text, document(TOUCHED, name="other"))  # type: ignore[arg-type]


def units(call: Call) -> list[str]:
    """What became of units, in order: ``request``, ``start``, ``end``, ``cancel``, ``fail``."""
    return [r["phase"] for r in call.records if r.get("command") == "iu" and r["phase"] != "select"]


# What a unit is -----------------------------------------------------------------------------


def test_nobody_speaks_between_the_items_of_a_unit() -> None:
    call = with_other(PHOTO)
    call.event("touch")
    assert call.saying() == ["One moment.", "iu"]
    call.finish("One moment.")
    assert call.saying() == ["May I?", "iu"]
    call.hears("yes")
    assert call.saying() == ["Thanks. Smile!", "iu"] or call.saying() == ["Thanks.", "iu"]
    call.finish("Thanks.")
    assert call.saying() == ["Smile!", "iu"]
    call.finish("Smile!")
    assert call.saying() == ["Ouch."], "the unit has ended; the reaction goes before Bye"
    call.finish("Ouch.")
    assert call.saying() == ["Bye."]


def test_without_a_unit_a_reaction_comes_in_between() -> None:
    call = with_other(
        PHOTO.replace("p:iu longest='20s'", "x").replace("<x>", "").replace("</p:iu>", "")
    )
    call.event("touch")
    call.finish("One moment.")
    assert call.saying() == ["Ouch."]


def test_what_was_said_before_a_unit_is_no_part_of_it() -> None:
    body = f"<form {P}><block>Hello.</block><p:iu>{ask()}</p:iu></form>"
    call = with_other(body)
    assert call.saying() == ["Hello."]
    call.event("touch")
    call.finish("Hello.")
    assert call.saying() == ["Ouch."], "the unit has not begun"


def test_all_that_a_unit_asks_for_belongs_to_it() -> None:
    call = Call(PHOTO)
    call.answer("yes")
    inside = {r["text"]: r.get("unit") for r in call.phases("start") if r.get("text")}
    [name] = {one for text, one in inside.items() if text != "Bye."}
    assert name and inside["Bye."] is None
    assert units(call) == ["request", "start", "end"] and call.ended == "exit"


def test_a_unit_owns_its_devices_from_the_first_to_the_last_item() -> None:
    call = Call(unit(ask() + "<block><p:gesture name='nod'/>Smile!</block>"))
    [asked] = [r for r in call.phases("request") if r["command"] == "iu"]
    assert set(asked["devices"]) == {*SPEECH, "arm", "neck"}


def test_a_units_items_are_visited_once_and_by_their_conditions() -> None:
    call = Call(
        unit(ask() + "<block cond='x'>Good.</block><block cond='!x'>Pity.</block>", say("Bye."))
    )
    call.answer("no")
    assert call.said() == ["May I?", "Pity.", "Bye."]


def test_a_unit_with_a_condition_that_does_not_hold_is_passed_over() -> None:
    call = Call(unit(ask(), say("Bye."), "cond='false'"))
    call.play()
    assert call.said() == ["Bye."] and units(call) == []


def test_a_unit_has_a_variable_by_its_name() -> None:
    call = Call(unit(ask(), "<block><log expr='u + \" \" + x'/></block>", "name='u'"))
    call.answer("yes")
    assert call.logs() == ["true true"]


def test_a_forms_filled_takes_fields_of_a_unit() -> None:
    call = Call(
        unit(
            ask() + ask(name="y"),
            "",
            "",
            "<filled mode='all' namelist='x y'>Both. <exit/></filled>",
        )
    )
    call.answer("yes", "no")
    assert call.said()[-1] == "Both."


def test_an_answer_may_fill_several_fields_of_a_unit() -> None:
    grammar = (
        "<grammar version='1.0' xmlns='http://www.w3.org/2001/06/grammar' root='r'><rule id='r'>"
        "<item>both<tag>out.x = 1; out.y = 2;</tag></item></rule></grammar>"
    )
    body = (
        f"<form {P}>{grammar}<p:iu><initial name='i'><prompt>What?</prompt></initial>"
        f"<field name='x'><prompt>X?</prompt>{grammar}</field>"
        f"<field name='y'><prompt>Y?</prompt>{grammar}</field></p:iu>"
        "<block><log expr='x + y'/></block></form>"
    )
    call = Call(body)
    call.answer("both")
    assert call.logs() == ["3"] and call.said() == ["What?"]


def test_a_record_may_stand_in_a_unit() -> None:
    call = Call(
        unit("<record name='r'><prompt>Speak.</prompt></record><block><value expr='r'/></block>")
    )
    call.answer("la la")
    assert call.said() == ["Speak.", "la la"]


def test_a_clear_in_a_unit_lets_its_items_be_visited_again_and_not_itself() -> None:
    again = "<if cond='n++ &lt; 1'><clear/></if>"
    body = f"<var name='n' expr='0'/>{unit(say('One.') + f'<block>{again}</block>', say('Bye.'))}"
    call = Call(body)
    call.play()
    assert " ".join(call.said()) == "One. One. Bye."
    assert units(call) == ["request", "start", "end"]


# Leaving it -------------------------------------------------------------------------------


def test_a_goto_from_item_to_item_does_not_leave_a_unit() -> None:
    call = Call(
        unit("<block name='one'>One.<goto nextitem='x'/></block><block>Two.</block>" + ask())
    )
    call.play()
    assert call.said() == ["One.", "May I?"]
    call.answer("yes")
    assert call.said() == ["One.", "May I?", "Two."]
    assert units(call) == ["request", "start", "end"]


def test_a_goto_to_an_item_outside_leaves_a_unit() -> None:
    call = Call(unit(ask("<noinput>Pity.<goto nextitem='bye'/></noinput>") + say("Smile!"),
                     "<block name='bye'>Bye.</block>"))  # fmt: skip
    call.silent()
    inside = {r["text"]: bool(r.get("unit")) for r in call.phases("start") if r.get("text")}
    assert inside == {"May I?": True, "Pity.": True, "Bye.": False}


def test_a_goto_into_a_unit_begins_it_with_that_item() -> None:
    call = Call(
        f"<form {P}><block><goto nextitem='x'/></block><p:iu><block>One.</block>{ask()}</p:iu></form>"
    )
    call.play()
    assert call.said() == ["May I?"] and call.saying() == ["May I?", "iu"]
    call.answer("yes")
    assert call.said() == ["May I?", "One."] and call.ended == "exit"


@pytest.mark.parametrize(
    ("leaving", "then"),
    [
        ("<goto next='#b'/>", "Next."),
        ("<goto next='other.vxml'/>", "Next."),
        ("<submit next='other.vxml'/>", "Next."),
        ("<exit/>", ""),
        ("<throw event='x.gone'/>", ""),
        ("<throw event='x.next'/>", "Next."),
        ("<disconnect/>", ""),
        ("<assign name='nowhere' expr='1'/>", ""),
    ],
)
def test_a_unit_is_left_by_whatever_way(leaving: str, then: str) -> None:
    handlers = (
        '<catch event="x.gone"><exit/></catch><catch event="x.next"><goto next="#b"/></catch>'
    )
    call = with_other_files(
        handlers
        + unit(ask(f"<filled>Thanks.{leaving}</filled>") + say("Smile!"))
        + "<form id='b'><block>Next.</block></form>"
    )
    call.event("touch")
    call.hears("yes")
    assert call.saying() == ["Thanks.", "iu"], "what is said before it is left is said in it (O3)"
    call.finish("Thanks.")
    assert units(call) == ["request", "start", "end"]
    assert call.saying() == ["Ouch."]
    call.play()
    assert call.said() == ["May I?", "Thanks.", "Ouch.", *([then] if then else [])]


def with_other_files(text: str) -> Call:
    files = {"other": vxml("<form><block>Next.</block></form>")}
    return Call(text, document(TOUCHED, name="other"), **files)  # type: ignore[arg-type]


def test_a_subdialogs_return_leaves_its_unit() -> None:
    call = Call(
        "<form><subdialog name='s' src='#sub'><catch event='gone'>Gone.</catch></subdialog></form>"
        + unit(ask("<filled><return event='gone'/></filled>") + say("Smile!"), id="sub")
    )
    call.answer("yes")
    inside = {r["text"]: bool(r.get("unit")) for r in call.phases("start") if r.get("text")}
    assert inside == {"May I?": True, "Gone.": False}


def test_an_answer_for_another_dialog_leaves_a_unit() -> None:
    call = Call(
        unit(ask())
        + "<menu id='b' scope='document'><prompt>Menu.</prompt><choice next='#c'>done</choice></menu>"
        + "<form id='c'><block>Done.</block></form>"
    )
    call.answer("done")
    assert call.said() == ["May I?", "Done."] and units(call) == ["request", "start", "end"]


def test_the_user_who_hangs_up_leaves_a_unit() -> None:
    call = with_other(
        unit(ask(), "", "", "<catch event='connection'><log>bye</log><exit/></catch>")
    )
    call.listens()
    call.event("connection.disconnect.hangup")
    assert call.logs() == ["bye"] and units(call)[-1] == "end" and call.ended == "exit"


def test_an_event_is_kept_while_what_is_said_at_last_is_said() -> None:
    call = Call(
        unit(ask("<filled>Thanks.<goto next='#b'/></filled>"))
        + "<form id='b'><field name='f' type='boolean'><prompt>More?</prompt></field>"
        "<catch event='touch'><log>touched</log></catch></form>"
    )
    call.hears("yes")
    call.event("touch")
    assert call.saying() == ["Thanks.", "iu"]
    call.finish("Thanks.")
    assert call.logs() == ["touched"], "the goto was not lost, and the event neither"


def test_an_application_that_is_unloaded_leaves_its_unit() -> None:
    from prima.messages import Unloaded

    call = with_other(PHOTO)
    call.step(Unloaded("app"))
    call.event("touch")
    call.finish("One moment.")
    assert call.saying() == ["Ouch."]


# Its longest duration -------------------------------------------------------------------------


def test_a_unit_that_takes_too_long_throws_and_the_form_goes_on_behind_it() -> None:
    call = Call(PHOTO.replace("</form>", "<error><log expr='_event'/></error></form>"))
    call.finish("One moment.")
    call.listens()
    call.step(at=20_200)
    assert call.logs() == ["error.unit.timeout"]
    assert call.saying() == ["May I?", "iu"], "the Command that runs finishes"
    call.silence()
    assert call.saying() == ["Bye."]


def test_nobody_handles_it_and_the_application_ends() -> None:
    call = Call(PHOTO)
    call.step(at=20_200)
    assert call.ended.startswith("error.unit.timeout: app.vxml:1:")
    assert call.ended.endswith("The unit took too long.")


def test_a_unit_is_over_in_time_while_an_answer_is_waited_for() -> None:
    call = Online(
        {"http://shop/": None},
        unit(
            "<block><data name='d' src='http://shop/' fetchtimeout='30s'/>Never.</block>",
            say("Bye."),
            "longest='2s'",
            "<catch event='error.unit.timeout'>Sorry.</catch>",
        ),
    )
    call.step(at=2_200)
    call.play()
    assert call.said() == ["Sorry.", "Bye."]


def test_what_handles_a_unit_that_took_too_long_is_no_part_of_it() -> None:
    call = Call(PHOTO.replace("</form>", "<error>Too long. <exit/></error></form>"))
    call.step(at=20_200)
    call.finish("One moment.")
    assert call.saying() == ["Too long."]


def test_no_handler_of_an_item_takes_that_its_unit_took_too_long() -> None:
    inner = ask("<catch event='error.unit'>In the field.</catch>")
    around = "<catch event='error.unit'>In the form.</catch>"
    call = Call(unit(inner, "", "longest='2s'", around))
    call.step(at=2_200)
    call.silence()
    assert call.saying() == ["In the form."]


# Events ------------------------------------------------------------------------------------


def test_an_event_thrown_in_a_unit_is_handled_in_it_wherever_the_handler_stands() -> None:
    call = with_other("<noinput>Please say yes or no.<reprompt/></noinput>" + PHOTO)
    call.finish("One moment.")
    call.event("touch")
    call.silence()
    assert call.saying() == ["Please say yes or no.", "iu"]
    call.finish("Please")
    assert call.saying() == ["May I?", "iu"]


def test_a_handler_in_a_unit_takes_an_event_from_outside_in_it() -> None:
    call = with_other(unit(ask("<catch event='touch'>Not now.<reprompt/></catch>"), say("Bye.")))
    call.listens()
    call.event("touch")
    assert call.saying() == ["Not now.", "iu"]
    call.finish("Not now.")
    assert call.saying() == ["May I?", "iu"]
    call.answer("yes")
    assert call.said() == ["May I?", "Not now.", "May I?", "Ouch.", "Bye."]


def test_a_unit_that_an_event_leads_to_is_a_reaction() -> None:  # C5
    call = Call(
        "<form><field name='w' type='boolean'><prompt>Well?</prompt></field>"
        "<catch event='phone'><goto next='#a'/></catch></form>" + unit(ask())
    )
    call.event("phone")
    [asked] = [r for r in call.phases("request") if r["command"] == "iu"]
    assert asked["reactive"] is True


def test_a_handler_outside_of_a_unit_leaves_it_and_the_rest_is_another_unit() -> None:
    call = with_other(
        unit(
            ask() + ask(name="y"),
            say("Bye."),
            "",
            "<catch event='phone'>The phone.<reprompt/></catch>",
        )
    )
    call.hears("yes")
    call.listens()
    call.event("phone")
    assert call.saying() == ["The phone."]
    assert [r["reactive"] for r in call.phases("request") if r.get("text") == "The phone."] == [
        True
    ]
    call.finish("The phone.")
    assert call.saying() == ["May I?", "iu"]
    call.answer("no")
    assert call.said() == ["May I?", "May I?", "The phone.", "May I?", "Bye."]
    assert units(call) == ["request", "start", "end"] * 2


def test_a_unit_that_is_done_when_it_is_left_is_not_begun_again() -> None:
    call = Call(unit(say("One."), say("Bye."), "", "<catch event='phone'>The phone.</catch>"))
    call.event("phone")
    call.play()
    assert call.said() == ["One.", "The phone.", "Bye."]
    assert units(call) == ["request", "start", "end"]


def test_the_user_may_answer_while_a_unit_still_speaks() -> None:
    call = Call(PHOTO)
    call.hears("yes")
    call.play()
    assert call.said() == ["One moment.", "Thanks.", "Smile!", "Bye."]


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


def problems_of(text: str) -> list[Problem]:
    try:
        return list(read_page("app.vxml", "app.vxml", text.encode()).problems)
    except DocumentError as error:
        return error.problems


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


# What is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        (
            {"field": '<filled><throw event="x"/></filled>', "outer": GOES.format("x")},
            "<p:topological-move> leaves the user, and the unit in line 3 reaches it by the event"
            ' "x"; it cannot stand in a unit. Handle "x" in the <p:iu> as well,'
            " or leave the <p:iu> with <goto> first.",
        ),
        (
            {"form": "<noinput><p:tracking-human/></noinput>"},
            "<p:tracking-human> works in a feedback loop, and the unit in line 3 reaches it by the"
            ' event "noinput"; it cannot stand',
        ),
        (
            {"form": '<filled><p:topological-move to="hall"/></filled>'},
            "and the unit in line 3 reaches it; it cannot stand in a unit. Leave the <p:iu> with",
        ),
        ({"field": GOES.format("touch")}, "<p:topological-move> leaves the user; it cannot stand"),
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


@pytest.mark.parametrize(
    ("inner", "code", "told"),
    [
        ("", "empty", "holds no form item. Write <block>, <field>, <initial> or <record>"),
        ("<noinput/>", "empty", "holds no form item"),
        ("Hm. <block/>", "stray-text", "Write it into a <block>"),
        ("<block/><p:turn angle='1'/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><p:par/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><prompt/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><on event='x'/>", "misplaced-element", 'Write <catch event="...">.'),
        ("<block/><filled/>", "misplaced-element", "beside the <p:iu>, with a namelist"),
        ("<block/><var name='v'/>", "misplaced-element", "Write it into the form, beside"),
        ("<subdialog src='#a'/><block/>", "misplaced-element", "Write it into the form, beside"),
        ("<p:iu><block/></p:iu><block/>", "misplaced-element", "<p:iu> cannot stand in a <p:iu>"),
        ("<blok/><block/>", "misplaced-element", "It holds <block>, <field>, <initial> or"),
        ("<field name='x' tipe='a'/>", "unknown-attribute", '"type"'),
        ("<field name='x'/><field name='x'/>", "duplicate-name", 'the name "x"'),
    ],
)
def test_wrong_units_are_told(inner: str, code: str, told: str) -> None:
    problems = problems_of(vxml(unit(inner)))
    [problem] = [one for one in problems if one.code == code]
    assert problem.severity == "error" and problem.place.line == 1
    assert told in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    ("attributes", "code"),
    [
        ("longest='2'", "bad-value"),
        ("restartable='true'", "unknown-attribute"),
        ("name='1x'", "bad-value"),
    ],
)
def test_wrong_attributes_of_units_are_told(attributes: str, code: str) -> None:
    assert [one.code for one in problems_of(vxml(unit("<block/>", "", attributes)))] == [code]


def test_a_unit_stands_in_a_form_or_around_commands() -> None:
    [problem] = problems_of(vxml(f"<menu {P}><choice next='#a'>a</choice><p:iu/></menu>"))[:1]
    assert problem.message == "<p:iu> cannot stand in <menu>."
    assert "around the items of a <form>" in problem.remedy


# Warnings -----------------------------------------------------------------------------------


def warned(tmp_path: Path, text: str, **files: str) -> list[Problem]:
    """What validation says of a document."""
    for name, content in files.items():
        (tmp_path / f"{name}.vxml").write_text(content)
    (tmp_path / "app.vxml").write_text(text)
    return loading.validate([tmp_path / "app.vxml"])


LONG = "This is a long sentence that goes on and on and on and on. " * 7


@pytest.mark.parametrize(
    "body",
    [
        unit(say(LONG)),
        unit(f"<field name='x' type='boolean'><prompt>{LONG}</prompt></field>"),
        f"<form {P}><block><p:iu><p:speak>{LONG}</p:speak></p:iu></block></form>",
        unit(say("<prompt>Wait. <break time='21s'/></prompt>")),
    ],
)
def test_a_unit_that_speaks_for_long_is_warned_of(tmp_path: Path, body: str) -> None:
    [problem] = warned(tmp_path, vxml(body))
    assert (problem.code, problem.severity) == ("long-unit", "warning")
    assert "<p:iu" in body.splitlines()[problem.place.line - 1]


def test_short_units_are_not_warned_of(tmp_path: Path) -> None:
    assert warned(tmp_path, vxml(unit(say("Hi.") + ask(), say(LONG)))) == []


@pytest.mark.parametrize("arranging", ["par", "seq", "iu"])
def test_a_command_wanted_now_stands_first(arranging: str) -> None:
    def told(inner: str) -> list[str]:
        body = f"<form {P}><block><p:{arranging}>{inner}</p:{arranging}></block></form>"
        return [f"{one.code} {one.message}" for one in problems_of(vxml(body))]

    assert told("<p:stop-moving/><p:speak>a</p:speak>") == []
    [problem] = told("<p:speak>a</p:speak><p:stop-moving/>")
    assert problem.startswith(
        "now-inside <p:stop-moving> is wanted now; it cannot stand in a <p:par>"
    )


def test_a_roots_handler_that_a_unit_cannot_have_is_warned_of(tmp_path: Path) -> None:
    root = vxml(f"<noinput {P}><p:tracking-human/></noinput>")
    leaf = (
        "<vxml version='2.1' xmlns='http://www.w3.org/2001/vxml' application='root.vxml'>"
        + unit(ask())
        + "</vxml>"
    )
    [problem] = warned(tmp_path, leaf, root=root)
    assert (problem.code, problem.severity) == ("not-in-unit", "warning")
    assert problem.place.file.endswith("root.vxml")
    assert problem.remedy.endswith("At run time it is error.semantic.")


@pytest.mark.parametrize("code", ["1 ==", "unknown"])
def test_a_units_condition_is_checked(tmp_path: Path, code: str) -> None:
    [problem] = warned(tmp_path, vxml(unit(say("Hi."), "", f"cond='{code}'")))
    assert problem.code in ("bad-expression", "undeclared-variable")


def test_the_fields_of_a_unit_are_variables_of_the_form(tmp_path: Path) -> None:
    assert warned(tmp_path, vxml(unit(ask(), "<block cond='x &amp;&amp; u'/>", "name='u'"))) == []


def test_a_document_with_errors_is_told_of_nothing_else_in_its_units(tmp_path: Path) -> None:
    body = unit(f"<block>{LONG}</block>") + f"<form {P}><block><p:unit/></block></form>"
    assert [one.code for one in warned(tmp_path, vxml(body))] == ["unknown-element"]
