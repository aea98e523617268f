"""Units around form items in VoiceXML documents (rule U5), as PRIMA's own language has them."""

from __future__ import annotations

from tests.helpers.dialogs import question
from tests.helpers.units import PHOTO, SPEECH, P, ask, say, unit, units, with_other
from tests.helpers.voice import Call


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


def test_a_question_behind_a_unit_has_no_settings_of_a_prompt_in_it() -> None:  # 4.1.7
    said = '<block><prompt timeout="2s" bargein="false">Hello.</prompt></block>'
    call = Call(f'<form {P}><p:iu>{said}</p:iu><field name="f" type="boolean"/></form>')
    call.play()
    assert (question(call)["timeout"], question(call)["bargein"]) == (5000, True)


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


def test_a_goto_into_a_unit_begins_it_with_that_item() -> None:
    call = Call(
        f"<form {P}><block><goto nextitem='x'/></block><p:iu><block>One.</block>{ask()}</p:iu></form>"
    )
    call.play()
    assert call.said() == ["May I?"] and call.saying() == ["May I?", "iu"]
    call.answer("yes")
    assert call.said() == ["May I?", "One."] and call.ended == "exit"


def test_the_user_may_answer_while_a_unit_still_speaks() -> None:
    call = Call(PHOTO)
    call.hears("yes")
    call.play()
    assert call.said() == ["One moment.", "Thanks.", "Smile!", "Bye."]
