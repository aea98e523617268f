"""How units in VoiceXML documents are left, run out of time, and meet events (U5)."""

from __future__ import annotations

import pytest

from tests.helpers.robot import document
from tests.helpers.units import PHOTO, TOUCHED, ask, say, unit, units, with_other
from tests.helpers.voice import Call, Online, vxml


def test_a_goto_to_an_item_outside_leaves_a_unit() -> None:
    call = Call(unit(ask("<noinput>Pity.<goto nextitem='bye'/></noinput>") + say("Smile!"),
                     "<block name='bye'>Bye.</block>"))  # fmt: skip
    call.silent()
    inside = {r["text"]: bool(r.get("unit")) for r in call.phases("start") if r.get("text")}
    assert inside == {"May I?": True, "Pity.": True, "Bye.": False}


@pytest.mark.parametrize(
    ("said", "first"), [([], ["request", "cancel"]), (["One."], ["request", "start", "end"])]
)
def test_a_goto_to_a_unit_from_inside_begins_it_again(said: list[str], first: list[str]) -> None:
    again = say(f"{''.join(said)}<goto nextitem='u'/>")
    call = Call(unit(again + say("Two."), say("Bye."), "name='u'"))
    assert call.play() == [*said, "Two.", "Bye."]
    assert units(call) == [*first, "request", "start", "end"]


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
    from prima.messages import ApplicationUnloaded

    call = with_other(PHOTO)
    call.step(ApplicationUnloaded("app"))
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


def test_an_event_that_waited_for_a_units_last_words_causes_no_reaction() -> None:  # C5
    asks = "<field name='w' type='boolean'><prompt>Well?</prompt></field>"
    call = Call(
        unit(say("Thanks.<goto next='#b'/>"))
        + f"<form id='b'>{asks}<catch event='touch'>Ouch.<reprompt/></catch></form>"
    )
    call.event("touch")
    assert call.saying() == ["Thanks.", "iu"]
    call.step(at=call.now + 100)
    call.finish("Thanks.")
    said = {r.get("text"): (r["reactive"], r.get("cause")) for r in call.phases("request")}
    assert call.saying() == ["Ouch."]
    assert said["Ouch."] == (False, None)


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


@pytest.mark.parametrize(
    ("handled", "said"), [("", ["May I?"]), ("Sorry.<exit/>", ["May I?", "Sorry."])]
)
def test_a_condition_of_a_units_handler_that_fails_is_an_error_in_the_unit(
    handled: str, said: list[str]
) -> None:
    never = "<catch event='phone' cond='none.such'>Never.</catch>"
    around = f"<catch event='error.semantic'>{handled}</catch>" if handled else ""
    call = Call(unit(ask(never), say("Bye."), "", around))
    call.listens()
    call.event("phone")
    call.play()
    assert call.said() == said and (call.ended is None or "none" in call.ended or handled)


@pytest.mark.parametrize("name", ["", "name='u'"])
def test_a_unit_with_a_name_that_is_left_is_visited_again_as_one_without(name: str) -> None:
    phone = "<catch event='phone'><log expr='typeof u'/><reprompt/></catch>"
    call = Call(f"<var name='u'/>{unit(ask() + ask(name='y'), say('Bye.'), name, phone)}")
    call.hears("yes")
    call.listens()
    call.event("phone")
    call.answer("no")
    assert call.said() == ["May I?", "May I?", "May I?", "Bye."]
    assert call.logs() == ["undefined"]
