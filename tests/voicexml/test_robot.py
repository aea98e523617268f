"""The robot in VoiceXML documents: its Commands among prompts, its events, its failures."""

from __future__ import annotations

import pytest

from prima.errors import DocumentError, Problem
from prima.messages import Occurred
from prima.voicexml.reading import read_page
from tests.helpers.dialogs import CITIES, P, block
from tests.helpers.voice import Call, vxml


def test_an_event_from_outside_does_not_cut_the_last_words() -> None:
    """4.1.8: what is queued is said before the application ends."""
    call = Call("<catch event='touch'><log>no</log></catch><form><block>Good bye.</block></form>")
    call.event("touch.head")
    call.play()
    assert (call.logs(), call.said(), call.ended) == ([], ["Good bye."], "exit")


def test_an_event_from_outside_that_nothing_takes_changes_nothing() -> None:
    """A robot's world has more events than a telephone's; only errors are for everyone."""
    call = Call(f"<form><field name='f'><prompt>Well?</prompt>{CITIES}</field></form>")
    call.play()
    call.event("touch.head")
    call.answer("nara")
    assert (call.said(), call.ended) == (["Well?"], "exit")


DEEP, PEED = "<p:par><p:seq>" * 26, "</p:seq></p:par>" * 26
"""More elements inside each other than may be."""


def started(call: Call) -> list[str]:
    call.play()
    return [r.get("text") or r["command"] for r in call.phases("start")]


def test_a_command_at_the_end_of_a_question_comes_after_its_words() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt>Where? <p:turn angle='3'/></prompt><option>a</option>"
        "</field></form>"
    )
    assert started(call) == ["Where?", "turn", "q-and-a"]


def test_a_command_in_a_prompt_stands_where_it_is_written() -> None:
    call = Call(
        f"<form {P}><block><prompt>Look <p:turn angle='30'/> there.</prompt></block></form>"
    )
    assert started(call) == ["Look", "turn", "there."]


def test_a_command_in_a_fields_prompt_comes_before_the_question() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt><p:gesture name='nod'/>Well?</prompt>"
        "<option>yes</option></field></form>"
    )
    assert started(call) == ["gesture", "Well?"]


def test_a_command_by_its_type_has_its_arguments_as_parameters() -> None:
    turn = "<p:command type='turn'><param name='angle' expr='10 * 3'/></p:command>"
    nod = "<p:command type='gesture'><param name='name' value='nod'/></p:command>"
    call = Call(f"<form {P}><block>{turn}{nod}</block></form>")
    call.play()
    args = [order.command.args for order in call.orders if order.command and order.verb == "start"]
    assert args == [{"angle": 30}, {"name": "nod"}]


def test_a_commands_arguments_may_be_expressions_and_its_text_holds_values() -> None:
    call = Call(
        f"<form {P}><block><var name='a' expr='40'/>"
        "<p:turn-and-speak angle-expr='a + 5'>By <value expr='a'/>!</p:turn-and-speak></block></form>"
    )
    assert started(call) == ["By 40!"]
    assert call.orders[0].command is not None and call.orders[0].command.args == {"angle": 45}


@pytest.mark.parametrize("stop", ["<p:stop-moving/>", "<p:iu><p:stop-moving/></p:iu>"])
def test_what_is_wanted_now_is_requested_after_what_comes_before_it(stop: str) -> None:
    """O2, O4: it is never linked, and content is carried out in its order."""
    call = Call(
        f"<form {P}><block>Hello.{stop}Well.</block><field name='f'><prompt>Yes?</prompt>"
        "<option>yes</option></field></form>"
    )
    assert all(one.get("order") != "now" for one in call.phases("request"))
    assert started(call)[-1] == "Yes?"
    asked = [r for r in call.phases("request") if r.get("order") == "now"]
    assert [one.get("parent") for one in asked] == [None]
    (ended,) = [r["time"] for r in call.phases("end") if r.get("text") == "Hello."]
    assert asked[0]["time"] == ended
    assert len({one.get("state") for one in call.phases("request")}) == 1, "one state"
    call.answer("yes")
    assert call.ended == "exit"


def test_a_handler_during_what_comes_before_it_takes_its_place() -> None:
    call = Call(
        f"<catch event='touch'><exit/></catch><form {P}><block>Hello.<p:stop-moving/>Well.</block>"
        "<field name='f'><prompt>Yes?</prompt><option>yes</option></field></form>"
    )
    call.event("touch.head")
    call.play()
    assert (call.said(), call.ended) == (["Hello."], "exit")


def test_a_command_in_a_foreach_is_asked_for_each_time() -> None:
    call = Call(
        f"<form {P}><block><prompt><foreach item='i' array='[1, 2]'>"
        "<value expr='i'/> <p:turn angle-expr='i'/></foreach></prompt></block></form>"
    )
    assert started(call) == ["1", "turn", "2", "turn"]


def test_a_command_in_a_handler_and_in_an_if() -> None:
    call = Call(
        f"<catch event='odd' {P}><if cond='true'><p:turn angle='1'/><else/><p:turn angle='2'/></if>"
        "<exit/></catch>" + block('<throw event="odd"/>')
    )
    assert started(call) == ["turn"]


def spans(call: Call) -> dict[str, tuple[float, float]]:
    """When each Command begins and ends, by its words or its name."""
    call.play()
    begins = {r["behavior"]: r for r in call.phases("start") if r["command"] != "iu"}
    ends = {r["behavior"]: r["time"] for r in call.phases("end")}
    return {r.get("text") or r["command"]: (r["time"], ends[key]) for key, r in begins.items()}


def test_branches_run_at_once_and_what_follows_waits_for_all() -> None:  # U3
    found = spans(
        Call(
            f"<form {P}><block>One. <p:par><p:speak>Two is <value expr='1 + 1'/>.</p:speak><p:seq>"
            "<p:gesture name='nod'/><p:turn angle='5'/></p:seq></p:par> Three.</block></form>"
        )
    )
    assert found["Two is 2."][0] == found["gesture"][0] == found["One."][1]
    assert found["turn"][0] == found["gesture"][1]
    assert found["Three."][0] == max(found["Two is 2."][1], found["turn"][1])


def test_a_unit_around_commands_is_one_behavior() -> None:  # U4
    call = Call(
        f"<form {P}><block><p:iu longest='8s' restartable='true'><p:gesture name='nod'/><p:par>"
        "<p:speak>Mind the step.</p:speak><p:move-head pan='5'/></p:par></p:iu></block></form>"
    )
    found = spans(call)
    [unit] = [r for r in call.phases("request") if r["command"] == "iu"]
    assert set(unit["devices"]) >= {"speaker", "neck"}
    inside = [r for r in call.phases("start") if r.get("unit")]
    assert inside[0]["command"] == "gesture" and len(inside) == 3
    assert found["Mind the step."][0] == found["move-head"][0] == found["gesture"][1]


def test_arranged_commands_in_a_prompt_come_before_the_question() -> None:
    call = Call(
        f"<form {P}><field name='f'><prompt>Look. <p:par><p:turn angle='5'/>"
        "<p:speak>There.</p:speak></p:par>Well?</prompt><option>yes</option></field></form>"
    )
    assert started(call)[:4] == ["Look.", "turn", "There.", "Well?"]


def test_arranged_commands_may_stand_in_handlers_conditions_and_loops() -> None:
    call = Call(
        f"<form {P}><block><foreach item='i' array='[1, 2]'><if cond='i == 2'>"
        "<p:par><p:turn angle-expr='i'/><p:speak>Now</p:speak></p:par></if></foreach></block></form>"
    )
    assert started(call) == ["turn", "Now"]


def problems_of(body: str) -> list[Problem]:
    """What is wrong with a document."""
    try:
        return list(read_page("d.vxml", "d.vxml", vxml(body).encode()).problems)
    except DocumentError as error:
        return error.problems


@pytest.mark.parametrize(
    ("body", "code", "told"),
    [
        ("<p:iu><p:topological-move to='a'/></p:iu>", "not-in-unit", "leaves the user"),
        ("<p:iu><p:par><p:tracking-human/></p:par></p:iu>", "not-in-unit", "feedback loop"),
        ("<p:par/>", "empty", "holds no Command"),
        ("<p:par><prompt>Hm.</prompt></p:par>", "misplaced-element", "Write what is said as"),
        ("<p:par><p:par/></p:par>", "misplaced-element", "is not allowed in <p:par>"),
        ("<p:par>Hm.</p:par>", "stray-text", "Write it into a <p:speak>"),
        ("<p:iu longer='2s'><p:speak>a</p:speak></p:iu>", "unknown-attribute", '"longest"'),
        ("<p:iu longest='2'><p:speak>a</p:speak></p:iu>", "bad-value", "2"),
        ("<p:seq><p:turn angel='2'/></p:seq>", "unknown-attribute", '"angle"'),
        ("<iu><p:turn angle='2'/></iu>", "unknown-element", "Write <p:iu> around Commands"),
        ("<p:iuu/>", "unknown-element", '"iu"'),
        (f"{DEEP}<p:turn angle='2'/>{PEED}", "too-deep", "more than 50 such elements inside"),
    ],
)
def test_wrong_arrangements_are_told(body: str, code: str, told: str) -> None:
    problems = problems_of(f"<form {P}><block>{body}</block></form>")
    [problem] = [one for one in problems if one.code == code]
    assert problem.severity == "error"
    assert told in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize("around", ["{}", "<p:seq>{}</p:seq>"])
@pytest.mark.parametrize("inside", ["p:param", "p:turn", "p:foo", "spek", "field"])
def test_what_a_command_cannot_hold_is_told(inside: str, around: str) -> None:
    body = around.format(f"<p:speak>Hello. <{inside}/></p:speak>")
    [problem] = problems_of(f"<form {P}><block>{body}</block></form>")
    assert (problem.code, problem.severity) == ("misplaced-element", "error")
    assert problem.message == f"<{inside}> is not allowed in <p:speak>."


def test_a_command_holds_what_a_prompt_holds_and_arguments() -> None:
    said = "<p:speak>One <emphasis>is</emphasis> <value expr='1'/>.</p:speak>"
    assert started(Call(f"<form {P}><block>{said}</block></form>")) == ["One is 1."]
    par = f"<p:par xml:lang='en'>{said}<p:turn angle='2'/></p:par>"
    assert problems_of(f"<form {P}><block>{par}</block></form>") == []
    waves = "<p:command type='wave'><param name='hand' value='left'/></p:command>"
    assert problems_of(f"<form {P}><block>{said}{waves}</block></form>") == []


@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("speak", "nothing-to-say"),
        ("topological-move", "missing-attribute"),
        ("turn", "missing-attribute"),
        ("stop", None),
    ],
)
def test_a_command_by_its_type_is_checked_as_one_by_its_name(
    command: str, code: str | None
) -> None:
    for written in (f"<p:{command}/>", f"<p:command type='{command}'/>"):
        body = vxml(f"<form {P}><block>{written}</block></form>").encode()
        found = read_page("d.vxml", "d.vxml", body).warnings()
        assert [one.code for one in found] == ([code] if code else [])


def test_branches_that_share_a_device_are_told() -> None:
    body = (
        "<p:par><p:speak>a</p:speak><p:seq><p:turn angle='1'/><p:speak>b</p:speak></p:seq></p:par>"
    )
    [problem] = problems_of(f"<form {P}><block>{body}</block></form>")
    assert (problem.code, problem.severity) == ("shared-device", "warning")
    around = problems_of(f"<form {P}><p:par><field name='f'/></p:par></form>")
    assert "it is around Commands" in around[0].message


def test_a_wrong_argument_is_an_event_when_it_is_asked_for() -> None:
    call = Call(
        f"<catch event='error' ><log expr='_event'/><exit/></catch>"
        f"<form {P}><block><p:turn angle='far'/></block><field name='f'><option>yes</option></field></form>"
    )
    call.play()
    assert call.logs() == ["error.semantic"]


def test_a_wrong_argument_is_told_in_ecmascripts_words() -> None:
    call = Call(f'<form {P}><block><p:turn angle-expr="[{{a: null}}, true]"/></block></form>')
    assert 'angle "[{"a": null}, true]" is not a number.' in call.ended


def test_a_wrong_argument_at_the_very_end_ends_the_application_with_its_error() -> None:
    call = Call(f"<form {P}><block><p:turn angle='far'/></block></form>")
    assert call.ended.startswith("error.semantic")


def test_an_event_from_outside_that_a_handler_takes_ends_the_wait() -> None:
    call = Call(
        """<catch event="touch"><prompt>You touched me.</prompt></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.listens()
    call.event("touch.head")
    call.play()
    assert call.said() == ["Well?", "You touched me."]


@pytest.mark.parametrize("attribute", ["", 'event=""', 'event="."', 'event="nomatch help"'])
def test_a_handler_for_all_events_takes_none_of_the_robot_and_its_surroundings(
    attribute: str,
) -> None:
    call = Call(
        f"""<catch {attribute}><log><value expr="_event"/></log><exit/></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    for name in ("human.found", "touch.head", "corner", "emergency.stop"):
        call.event(name)
    call.answer("yes")
    assert (call.logs(), call.said(), call.ended) == ([], ["Well?"], "exit")


@pytest.mark.parametrize(
    "own", ["message", "reply.weather", "connection.disconnect.hangup", "error.service.x"]
)
def test_a_handler_for_all_events_takes_what_is_meant_for_the_document(own: str) -> None:
    call = Call(
        """<catch><log><value expr="_event"/></log><exit/></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.step(Occurred(own, app="app"))
    assert (call.logs(), call.ended) == ([own], "exit")


def test_a_handler_for_all_events_takes_a_robot_s_event_that_the_document_throws() -> None:
    call = Call(
        """<catch><log>all</log></catch>
        <form><block><throw event="human.found"/></block>
        <field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    assert call.logs() == ["all"]


def test_an_event_of_the_robot_counts_for_those_handlers_alone_that_name_it() -> None:
    call = Call(
        """<catch count="2"><log>all</log></catch><catch event="human"><log>named</log></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.event("human.found")
    call.event("human.found")
    assert call.logs() == ["named", "named"]


@pytest.mark.parametrize(
    ("handlers", "logged"),
    [
        ('<catch event="touch" count="2"><log>2</log></catch>', ["2", "2"]),
        ('<catch event="touch" count="2" cond="false"><log>2</log></catch>', []),
        ('<catch event="touch.back" count="2"><log>2</log></catch>', []),
    ],
)
def test_an_event_of_the_robot_counts_though_no_handler_takes_it(  # 5.2.2
    handlers: str, logged: list[str]
) -> None:
    call = Call(
        f"<form><field name='f' type='boolean'><prompt>Well?</prompt>{handlers}</field></form>"
    )
    call.play()
    for _ in range(3):
        call.event("touch.head")
    assert (call.logs(), call.said()) == (logged, ["Well?"])


def test_commands_of_the_robot_stand_among_prompts() -> None:
    call = Call(
        """<form xmlns:p="urn:prima:dialogue:1"><block>Look. <p:point-by-hand angle="30"/> There.
        </block></form>"""
    )
    call.play()
    assert [r["command"] for r in call.phases("start")] == ["speak", "point-by-hand", "speak"]


def test_a_device_that_fails_is_told_with_line_and_column_and_recorded_with_its_line() -> None:
    call = Call(
        """<form><catch event="error.device"><log expr="_message"/></catch>
 <block>Hello.</block><field name="f" type="boolean">
 <prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.fail("Well?")
    assert call.logs() == ["app.vxml:2:23: broken"]
    requests = call.phases("request")
    assert next(one["source"] for one in requests if one["text"] == "Well?") == "app.vxml:2"


def test_text_without_a_prompt_has_the_place_of_what_contains_it() -> None:
    call = Call(
        """<form>
 <block>Hello.</block>
 <block><if cond="true">
  Good morning.</if></block>
 <field name="f" type="boolean"><prompt>Well?</prompt><noinput>Say yes.<reprompt/></noinput></field>
</form>"""
    )
    call.silent()
    places = {one["text"]: one["source"] for one in call.phases("request")}
    assert places["Hello."] == "app.vxml:2"
    assert places["Good morning."] == "app.vxml:3"
    assert places["Say yes."] == "app.vxml:5"
