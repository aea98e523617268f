"""Rules of the mediator as authors meet them: whole documents, run side by side."""

from __future__ import annotations

import pytest

from prima.interpreter.bounds import MOST_BRIEF
from prima.invariants import check
from prima.messages import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Ended,
    Failed,
    Occurred,
    Sensed,
)
from tests.helpers.plays import NESTED, stepped
from tests.helpers.robot import Bench, document

IDLE = '<form id="sleep"/>'


def pair(ea: str, fa: str = IDLE) -> Bench:
    return Bench(document(fa, "fa", "fa"), document(ea, "ea", "ea"))


# Entering and leaving states --------------------------------------------------------
@pytest.mark.parametrize("way", ['<goto next="#b"/>', "<exit/>"])
def test_o3_a_watch_that_is_true_on_entry_stops_the_entry(way: str) -> None:
    bench = pair(
        f"""<form id="start"><on event="go"><goto next="#a"/></on></form>
        <form id="a">
          <watch name="dark" when="sensor.light &lt; 5"/>
          <on event="dark">{way}</on>
          <block><log>entered</log><speak>In a.</speak></block>
        </form>
        <form id="b"><block><speak>In b.</speak></block></form>"""
    )
    bench.step(Sensed({"light": 3}))
    bench.event("go")
    assert bench.logs() == []
    assert bench.said() == (["In b."] if "goto" in way else [])
    assert [r["text"] for r in bench.phases("request")] == bench.said()


def test_o4_a_watch_that_is_true_on_entry_and_stays_lets_the_content_begin() -> None:
    bench = pair(
        """<form id="start"><on event="go"><goto next="#a"/></on></form>
        <form id="a">
          <watch name="dark" when="sensor.light &lt; 5"/>
          <on event="dark"><log>it is dark</log></on>
          <block><log>entered</log><speak>In a.</speak></block>
        </form>"""
    )
    bench.step(Sensed({"light": 3}))
    bench.event("go")
    assert bench.logs() == ["it is dark", "entered"]
    assert bench.said() == ["In a."]


def test_o3_in_a_window_the_conversation_keeps_its_stream_and_its_floor() -> None:
    # The event's reaction waits behind the question; the answer leaves the state.
    bench = pair(
        """<form id="start"><on event="touch"><goto next="#one"/></on></form>
        <form id="one">
          <field name="a" type="boolean"><prompt>One?</prompt><filled><goto next="#two"/></filled></field>
          <on event="bell"><speak>A bell.</speak></on>
        </form>
        <form id="two">
          <field name="b" type="boolean"><prompt>Two?</prompt></field>
        </form>""",
        """<form id="dance"><on event="music"><gesture name="bow"/></on></form>""",
    )
    bench.event("touch")
    bench.event("bell")
    bench.listens()
    bench.hears("yes")
    asked = {r["text"]: r["tree"] for r in bench.phases("request") if r["text"]}
    assert asked["Two?"] == asked["One?"] != asked["A bell."]
    floors = [r["outcome"] for r in bench.phases("floor")]
    assert floors == ["taken"], "the conversation has it still"


# Orders --------------------------------------------------------------------------------
def test_o2_what_is_wanted_now_does_not_wait_behind_speech() -> None:
    bench = pair(
        """<form id="walk">
          <on event="door"><set-speed-and-time speed="0.2" time="20s"/></on>
          <on event="tell"><speak>One.</speak><speak>Two.</speak><speak>Three.</speak></on>
          <on event="end.speak"><stop-moving/></on>
        </form>"""
    )
    bench.event("door")
    bench.event("tell")
    assert bench.saying() == ["One.", "set-speed-and-time"]
    bench.finish("One.")
    assert bench.saying() == ["Two.", "stop-moving"]


def test_u5_commands_inside_a_linked_unit_hold_nobody_back() -> None:
    bench = pair(
        """<form id="ask">
          <block><speak>Good day.</speak></block>
          <iu><field name="name"><prompt>Your name?</prompt><option>Anna</option>
            <noinput><exit/></noinput></field></iu>
          <on event="touch"><face-human/><topological-move to="lab"/></on>
        </form>""",
        """<form id="sleep">
          <on event="phone"><speak>The phone.</speak><topological-move to="hall"/></on>
        </form>""",
    )
    bench.event("touch")
    bench.finish("Good day.")
    bench.event("phone")
    for _ in range(20):
        running = bench.running()
        if not running:
            break
        bench.step(*[Ended(name) for name, what in running.items() if what != "iu"])
    assert bench.session.idle, bench.session.mediator.memory.behaviors


def test_u5_a_unit_owns_what_a_handler_needs_that_is_reached_by_throw() -> None:
    bench = pair(
        """<form id="ask">
          <iu><field name="a" type="boolean">
            <prompt>Shall I turn?</prompt><filled><throw event="turn"/></filled>
          </field></iu>
        </form>
        <on event="turn"><turn angle="90"/></on>""",
        """<form id="sleep"><on event="touch"><turn angle="10"/></on></form>""",
    )
    bench.listens()
    bench.event("touch")
    assert bench.saying() == ["Shall I turn?", "iu"], "the wheels are the unit's"
    bench.hears("yes")
    assert bench.saying() == ["iu", "turn"]
    assert bench.running().keys() >= {"ea#3"}


# Streams that are broken ---------------------------------------------------------------
GUIDE = """<form id="panel">
  <block><speak>One.</speak><speak>Two.</speak><exit/></block>
  <on event="suspended"><goto next="#again"/></on>
  <on event="resumed"><log>resumed</log></on>
</form>
<form id="again">
  <on event="resumed"><log>resumed again</log></on>
  <block><speak>As I was saying,</speak><speak>two.</speak></block>
</form>"""
HELLO = """<form id="sleep"><on event="touch"><speak>Hello.</speak></on></form>"""


def test_c2_an_application_hears_that_its_stream_was_suspended_and_has_resumed() -> None:
    bench = pair(GUIDE, HELLO)
    bench.event("touch")
    bench.finish("One.")
    assert bench.saying() == ["Hello."]
    assert bench.session.deadline() == bench.now + 1, "it is told in the next instant"
    bench.step(at=bench.now + 1)
    assert bench.saying() == ["Hello."], "what it asks for waits with its stream"
    bench.finish("Hello.")
    bench.step(at=bench.now + 1)
    bench.finish("As I was saying,")
    bench.finish("two.")
    assert bench.said() == ["One.", "Hello.", "As I was saying,", "two."]
    assert bench.logs() == ["resumed again"]
    streams = {r["tree"] for r in bench.phases("request") if r["app"] == "ea"}
    assert streams == {"ea:1"}, "it is one topic"
    assert not any(r.get("reactive") for r in bench.phases("request") if r["app"] == "ea")


STORY = """<form id="story">
  <block><speak>One.</speak><speak>Two.</speak></block>
  <on event="suspended"><log>suspended</log></on>
  <on event="resumed"><log>resumed</log></on>
</form>"""


@pytest.mark.parametrize("at_once", [False, True], ids=["in turn", "kept by itself"])
def test_c2_a_suspended_stream_that_goes_on_without_a_gap_hears_nothing(at_once: bool) -> None:
    story = STORY.replace("<block>", "<block><par>").replace("</block>", "</par></block>")
    bench = pair(
        story if at_once else STORY,
        '<form id="sleep"><on event="door"><topological-move to="lab"/></on></form>',
    )
    bench.event("door")
    assert [r["tree"] for r in bench.phases("suspend")] == ["ea:1"]
    bench.step(at=bench.now + 1)
    bench.finish("One.")
    assert "Two." in bench.saying(), "it is of higher priority (F3)"
    bench.step(at=bench.now + 1)
    bench.finish("Two.")
    assert [r["tree"] for r in bench.phases("resume")] == ["ea:1"]
    assert bench.logs() == []


def test_c2_a_suspended_stream_hears_of_it_when_it_has_to_wait() -> None:
    bench = pair(STORY, '<form id="sleep"><on event="touch"><gesture name="bow"/></on></form>')
    bench.event("touch")
    assert bench.saying() == ["One.", "gesture"] and bench.phases("suspend")
    bench.step(at=bench.now + 10)
    assert bench.logs() == [], "its sentence goes on"
    bench.finish("One.")
    bench.step(at=bench.now + 1)
    assert bench.logs() == ["suspended"], "the next one waits"
    bench.finish("gesture")
    bench.step(at=bench.now + 1)
    assert bench.saying() == ["Two."] and bench.logs() == ["suspended", "resumed"]


def test_c2_a_stream_that_is_suspended_again_hears_it_again() -> None:
    story = STORY.replace("</block>", "<speak>Three.</speak></block>")
    bench = pair(story, HELLO)
    for sentence in ("One.", "Two."):
        bench.event("touch")
        bench.finish(sentence)
        bench.step(at=bench.now + 1)
        bench.finish("Hello.")
        bench.step(at=bench.now + 1)
    assert bench.logs() == ["suspended", "resumed"] * 2


def test_c2_a_stream_may_resume_and_be_suspended_again_in_one_instant() -> None:
    story = STORY.replace("<block>", "<block><speak>Zero.</speak><par>")
    story = story.replace("</block>", "</par></block>").replace(
        "</form>", '<on event="door"><topological-move to="lab"/></on></form>'
    )
    turning = '<form id="t"><on event="ring" reactive="false"><turn angle="3"/></on></form>'
    others = (document(HELLO, "fa", "fa"), document(turning, "ea", "xa"))
    bench = Bench(document(story, "ea", "ea"), *others)
    for name in ("door", "touch", "ring"):
        bench.event(name)
    bench.finish("Zero.")
    bench.step(at=bench.now + 1)
    bench.finish("topological-move", goal=False)
    bench.step(at=bench.now + 1)
    bench.finish("Hello.")
    assert bench.saying() == ["One.", "turn"], "which takes the floor (F3)"
    bench.step(at=bench.now + 1)
    assert bench.logs() == ["suspended"] * 2 + ["resumed", "suspended"], "the move waits, too"
    assert check(bench.records, declared=("ea", "fa", "xa")) == []


def test_c2_a_topic_that_was_broken_off_before_its_next_command_hears_nothing() -> None:
    bench = pair(STORY, '<form id="sleep"><on event="touch"><gesture name="bow"/></on></form>')
    bench.event("touch")
    bench.finish("gesture")
    bench.finish("One.")
    bench.step(at=bench.now + 1)
    bench.finish("Two.")
    assert bench.phases("suspend") and bench.phases("resume") and bench.logs() == []


def test_c2_whoever_does_not_ask_is_told_nothing() -> None:
    bench = pair('<form id="a"><block><speak>One.</speak><speak>Two.</speak></block></form>', HELLO)
    bench.event("touch")
    bench.finish("One.")
    assert bench.saying() == ["Hello."]
    assert bench.session.deadline() != bench.now + 1


# Reactions to what the transcript names ------------------------------------------------
def test_c5_a_reaction_to_an_end_has_a_cause_of_its_own() -> None:
    bench = pair(
        """<form id="a">
          <block><speak>One.</speak></block>
          <on event="end.speak" reactive="true"><gesture name="bow"/></on>
        </form>"""
    )
    bench.step(Occurred("door"))
    bench.finish("One.")
    (request,) = [r for r in bench.phases("request") if r["command"] == "gesture"]
    events = {r["serial"]: r["event"] for r in bench.phases("event")}
    assert request["reactive"] and events[request["cause"]] == "end.speak"


BUSY = {
    "refused": """<block name="b"><turn angle-expr="'left'"/></block>
        <on event="error"><clear namelist="b"/></on>""",
    "failed": """<block name="b"><gesture name="fly"/></block>
        <on event="error"><clear namelist="b"/></on>""",
    "failed beside others": """<block name="b"><gesture name="fly"/></block>
        <on event="error"><move-head pan="10"/><clear namelist="b"/></on>""",
    "done at once": """<block name="b"><stop-moving/><clear namelist="b"/></block>""",
    "paused": """<block name="b"><pause time="1ms"/><clear namelist="b"/></block>""",
    "asked": """<field name="a" type="boolean"><property name="timeout" value="1ms"/>
        <noinput/></field>""",
}


@pytest.mark.parametrize("body", BUSY.values(), ids=BUSY.keys())
def test_e2_an_application_that_hardly_waits_ends_alone(body: str) -> None:
    bench = pair(f'<form id="a">\n{body}</form>', HELLO)
    for _ in range(3 * MOST_BRIEF):
        for name, what in bench.running().items():
            fails = what == "gesture"
            end = Failed(name, "arm", "no such gesture") if fails else Ended(name)
            bench.step(end, at=bench.now + 1)
    (over,) = bench.phases("unload")
    assert over["app"] == "ea" and "ms on an average" in over["outcome"]
    assert over["outcome"].startswith("error.semantic: ea.xml:2:")
    bench.event("touch")
    assert bench.saying() == ["Hello."]


def test_e2_brief_commands_with_time_between_them_are_no_loop() -> None:
    bench = pair('<form id="a"><on event="door"><stop-moving/></on></form>')
    for _ in range(MOST_BRIEF + 10):
        bench.event("door")
        bench.step(*map(Ended, bench.running()), at=bench.now + 1)
    assert bench.phases("unload") == []


# What happens ----------------------------------------------------------------------------
def test_c6_a_condition_is_raised_when_it_turns_true_and_armed_when_it_turns_false() -> None:
    bench = pair(
        """<watch name="dark" when="sensor.light &lt; 5"/><on event="dark"><log>dark</log></on>
        <form id="a"/>"""
    )
    for light in (9, 3, 2, 9, 1):
        bench.step(Sensed({"light": light}))
    assert bench.logs() == ["dark", "dark"]


def test_k3_no_channel_is_made_where_nobody_asks_for_it() -> None:
    bench = pair('<form id="a" channel="connect"><block><speak>Hello.</speak></block></form>')
    assert [r["command"] for r in bench.phases("request")] == ["speak"]


def test_v1_what_a_question_does_not_take_goes_to_the_links_of_others() -> None:
    bench = pair(
        """<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt></field></form>""",
        """<link event="dance"><grammar><item>dance for me</item></grammar></link>
        <form id="sleep"><on event="dance"><gesture name="bow"/></on></form>""",
    )
    bench.listens()
    bench.hears("dance for me")
    assert bench.saying() == ["Well?", "gesture"], "and the question listens on"
    bench.hears("yes")
    assert bench.saying() == ["gesture"]


def test_v2_a_reaction_that_needs_a_device_of_a_question_waits_for_its_end() -> None:
    bench = pair(
        """<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt></field></form>""",
        HELLO,
    )
    bench.event("touch")
    assert bench.saying() == ["Well?"]
    bench.listens()
    bench.hears("yes")
    assert bench.saying() == ["Hello."]


def test_v3_ends_come_before_events() -> None:
    bench = pair(
        """<form id="a"><var name="done" expr="false"/>
          <block><speak>One.</speak><assign name="done" expr="true"/></block>
          <on event="touch"><log expr="done"/></on>
        </form>"""
    )
    (name,) = bench.running()
    bench.step(Occurred("touch"), Ended(name))
    assert bench.logs() == ["true"]


def test_v3_ends_of_one_application_come_in_the_order_of_their_numbers() -> None:
    bench = pair(
        """<form id="a"><block><par>
          <speak>One.<on event="end"><log>speak</log></on></speak>
          <gesture name="bow"><on event="end"><log>gesture</log></on></gesture>
        </par></block></form>"""
    )
    bench.step(*map(Ended, sorted(bench.running(), reverse=True)))
    assert bench.logs() == ["speak", "gesture"]


def test_s5_the_same_inputs_give_the_same_records() -> None:
    def records() -> list[object]:
        bench = pair(
            """<form id="a"><on event="touch"><par><speak>One.</speak><speak>Two.</speak>
            <speak>Three.</speak></par></on></form>""",
            """<form id="b"><on event="touch"><par><speak>Four.</speak><speak>Five.</speak></par>
            </on></form>""",
        )
        for _ in range(3):
            bench.event("touch")
            while bench.running():
                bench.step(*map(Ended, bench.running()))
        return [*bench.records]

    assert records() == records()


def test_an_application_that_is_loaded_again_gives_no_name_out_twice() -> None:
    # What its former life still runs may make ABs when the new one has made some.
    _, records = stepped(
        NESTED.format("<speak>Zero.</speak>", ""),
        (0, (ApplicationLoaded("ea"),)),
        (50, (ApplicationUnloaded("ea"),)),
        (60, (ApplicationLoaded("ea"),)),
        (100, (Ended("ea#3"),)),
    )
    names = [record["behavior"] for record in records if record["phase"] == "request"]
    assert len(names) == len(set(names)) > 7
