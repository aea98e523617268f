"""Units around items, and the devices of handlers that they can reach (F6, U5)."""

from __future__ import annotations

import pytest

from prima.interpreter.units import units_of
from tests.helpers.robot import Bench, document, read

UNIT = """<form id="a">
  <iu name="u" longest="20s">
    <field name="x" type="boolean"><prompt>May I?</prompt>{}</field>
    <block cond="x"><speak>Smile!</speak></block>
  </iu>
  <block><speak>Bye.</speak></block>
  <on event="error.unit.timeout"><log>too long</log></on>
</form>"""


def test_a_unit_around_items_owns_its_devices_from_question_to_the_last_word() -> None:
    other = document(
        '<form id="a"><on event="touch"><speak>Ouch.</speak></on></form>', name="other"
    )
    bench = Bench(document(UNIT.format(""), name="photo"), other)
    bench.event("touch")
    assert bench.saying() == ["May I?", "iu"]
    bench.hears("yes")
    assert bench.saying() == ["Smile!", "iu"]
    bench.finish("Smile!")
    assert bench.saying() == ["Ouch."], "the unit has ended; the reaction goes before Bye"
    bench.finish("Ouch.")
    assert bench.saying() == ["Bye."]


ANSWER = (
    '<var name="n"/><form id="a"><block><speak>The answer is</speak><move-head pan="30"/>{}'
    "<speak>forty two.</speak><exit/></block></form>"
)
TRAINS = '<form id="a"><on event="touch" reactive="false"><speak>I like trains.</speak></on></form>'


@pytest.mark.parametrize(
    ("between", "said"),
    [("", ["move-head"]), ('<assign name="n" expr="42"/>', ["I like trains.", "move-head"])],
)
def test_f6_what_is_not_requested_yet_keeps_no_topic_together(
    between: str, said: list[str]
) -> None:
    bench = Bench(document(ANSWER.format(between), name="answer"), document(TRAINS, name="other"))
    bench.event("touch")
    bench.finish("The answer is")
    assert sorted(bench.saying()) == said


REACHING = """<form id="a">{form}
  <iu name="u">{unit}
    <field name="x" type="boolean"><prompt>May I?</prompt>{field}</field>
    <block>{block}</block>
  </iu>
  <block><exit/></block>
</form><form id="b"><block><topological-move to="hall"/><exit/></block></form>{document}"""
TURNS = '<on event="{}"><turn angle="90"/></on>'
LINK = "<link {}><grammar>help me</grammar></link>"
GOES = '<on event="{}"><topological-move to="hall"/></on>'


def reaching(**parts: str) -> str:
    given = dict.fromkeys(("form", "unit", "field", "block", "document"), "") | parts
    return REACHING.format(**given)


@pytest.mark.parametrize(
    "parts",
    [
        {"field": '<filled><throw event="x.y"/></filled>', "document": TURNS.format("x")},
        {"block": '<throw event="x"/>', "form": TURNS.format("x")},
        {"block": "<throw event-expr='x'/>", "document": TURNS.format("z")},
        {"form": TURNS.format("noinput")},
        {"form": LINK.format("event='help'") + TURNS.format("help")},
        {"document": LINK.format("event='help'") + TURNS.format("help")},
        {"field": TURNS.format("touch")},
        {"unit": TURNS.format("touch")},
        {"form": '<filled><turn angle="90"/></filled>'},
        {"form": '<filled namelist="x"><turn angle="90"/></filled>'},
        {"document": TURNS.format("error.device")},
        {"block": "<speak>Hi.</speak>", "document": TURNS.format("error.unsupported.speak")},
        {
            "block": '<throw event="x"/>',
            "form": '<on event="x"><throw event="y"/></on>',
            "document": TURNS.format("y"),
        },
        {
            "field": '<noinput><throw event="y"/></noinput>',
            "document": TURNS.format("y") + "<noinput><turn angle='9'/></noinput>",
        },
        {"field": "<noinput count='2'><reprompt/></noinput>", "document": TURNS.format("noinput")},
        {
            "field": "<noinput cond='x'><reprompt/></noinput>",
            "document": TURNS.format("noinput"),
        },
    ],
)
def test_u5_a_unit_owns_what_the_handlers_need_that_it_can_reach(parts: dict[str, str]) -> None:
    made, _ = read(reaching(**parts))
    (unit,) = [unit for _, unit in units_of(made)]
    assert unit.devices == {"speaker", "speech-recognition", "locomotion"}
    assert "turn" in unit.types


@pytest.mark.parametrize(
    "parts",
    [
        {"form": TURNS.format("touch")},
        {"form": LINK.format("next='#b'") + TURNS.format("help")},
        {"document": TURNS.format("x")},
        {"document": TURNS.format("error.unit.timeout")},
        {"document": TURNS.format("error.unsupported.speak")},
        {"field": "<noinput><reprompt/></noinput>", "document": TURNS.format("noinput")},
        {"unit": "<noinput><reprompt/></noinput>", "form": TURNS.format("noinput")},
        {"form": '<field name="y" type="boolean"/><filled namelist="y"><turn angle="9"/></filled>'},
    ],
)
def test_u5_a_unit_owns_nothing_for_handlers_that_it_cannot_reach(parts: dict[str, str]) -> None:
    made, _ = read(reaching(**parts))
    (unit,) = [unit for _, unit in units_of(made)]
    assert unit.devices == {"speaker", "speech-recognition"}


CHOOSES = '<filled><throw event-expr="{}"/></filled>'
GIVEN = '<var name="e" expr="old ? \'y\' : \'z\'"/><var name="old" expr="true"/>'


@pytest.mark.parametrize(
    ("code", "document", "reached"),
    [
        ("x ? 'y' : 'z'", "", False),
        ("x ? 'x' : 'z'", "", True),
        ("'x' + x", "", True),
        ("x", "", True),
        ("e", GIVEN, False),
        ("e", GIVEN.replace("'z'", "'x'"), True),
        ("e", GIVEN.replace("'z'", "old"), True),
        ("e", GIVEN + "<script>e = 'x';</script>", True),
        ("e", GIVEN + TURNS.format("touch").replace("<turn", "<log expr=\"e = 'x'\"/><turn"), True),
        ("e", GIVEN + TURNS.format("a").replace("<turn", "<assign name='e' expr=\"'x'\"/><turn"), True),
        ("e", GIVEN + TURNS.format("a").replace("<turn", "<assign name='e' expr=\"'w'\"/><turn"), False),
    ],
)  # fmt: skip
def test_u5_an_expression_reaches_the_events_that_it_may_name(
    code: str, document: str, reached: bool
) -> None:
    parts = {"field": CHOOSES.format(code), "document": document + GOES.format("x")}
    _, problems = read(reaching(**parts))
    codes = [one.code for one in problems if one.severity == "error"]
    assert codes == (["not-in-unit"] if reached else [])


def test_u5_an_expression_that_may_name_any_event_is_told() -> None:
    parts = {"field": CHOOSES.format("x"), "document": GOES.format("z")}
    _, problems = read(reaching(**parts))
    (problem,) = [one for one in problems if one.severity == "error"]
    told = 'reaches it by the event "z", which the expression "x" may name; it is not allowed'
    assert told in problem.message
    assert "as a text, x ? 'this' : 'that', or leave the <iu> with <goto> first." in problem.remedy


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        (
            {"field": '<filled><throw event="x"/></filled>', "document": GOES.format("x")},
            "<topological-move> leaves the user, and the unit in line 2 reaches it by the event"
            ' "x"; it is not allowed in a unit. Handle "x" in the <iu> as well,'
            " or leave the <iu> with <goto> first.",
        ),
        (
            {"form": "<noinput><tracking-human/></noinput>"},
            "<tracking-human> works in a feedback loop, and the unit in line 2 reaches it by the"
            ' event "noinput"; it is not allowed',
        ),
        (
            {"form": '<filled><topological-move to="hall"/></filled>'},
            "and the unit in line 2 reaches it; it is not allowed in a unit. Leave the <iu> with",
        ),
        ({"field": GOES.format("touch")}, "<topological-move> leaves the user; it is not allowed"),
    ],
)
def test_u5_no_command_that_a_unit_reaches_leaves_the_user(
    parts: dict[str, str], says: str
) -> None:
    _, problems = read(reaching(**parts))
    (problem,) = [one for one in problems if one.severity == "error"]
    assert problem.code == "not-in-unit" and says in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    "parts",
    [
        {"form": GOES.format("touch")},
        {"document": GOES.format("error.unit.timeout")},
        {"document": '<noinput><goto next="#b"/></noinput>'},
        {"field": "<noinput><exit/></noinput>", "document": GOES.format("noinput")},
    ],
)
def test_u5_a_command_that_no_unit_reaches_may_leave_the_user(parts: dict[str, str]) -> None:
    _, problems = read(reaching(**parts))
    assert [one for one in problems if one.code == "not-in-unit"] == []


def test_leaving_a_unit_by_goto_ends_it() -> None:
    bench = Bench(
        UNIT.format('<noinput><goto next="#b"/></noinput>')
        + '<form id="b"><block><speak>Never mind.</speak></block></form>'
    )
    bench.silence()
    assert bench.saying() == ["Never mind."]


def test_a_unit_that_takes_too_long_throws_and_ends() -> None:
    bench = Bench(UNIT.format(""))
    bench.listens()
    bench.step(at=20_100)
    assert bench.logs() == ["too long"]
    assert bench.saying() == ["May I?", "iu"], "the Command that runs finishes"
    bench.silence()
    assert bench.saying() == ["Bye."]


def test_o2_a_cancelled_unit_around_commands_is_told_by_its_own_name() -> None:
    bench = Bench(
        """<form id="a">
          <block><iu><speak>One.</speak><gesture name="bow"/></iu><speak>Two.</speak></block>
          <on event="touch"><speak order="now">Stop.</speak></on>
          <on event="cancel"><log expr="event.name"/></on>
        </form>"""
    )
    bench.event("touch")
    assert bench.saying() == ["Stop."]
    assert sorted(bench.logs()) == ["cancel.iu", "cancel.speak"]


def test_e1_an_error_in_a_unit_of_commands_has_the_commands_place_and_handlers() -> None:
    unit = """<form id="a"><block><iu><speak>One.{}</speak><turn angle="5"/></iu></block></form>"""
    bench = Bench(unit.format('<on event="error"><log expr="event.data.command"/></on>'))
    bench.fail("One.")
    assert bench.logs() == ["speak"]
    bench = Bench(unit.format(""))
    bench.fail("One.")
    [error] = bench.phases("error")
    assert error["message"].startswith("error.device.speaker: app.xml:1:")


@pytest.mark.parametrize("said", ["yes", "nonsense"])
def test_u5_words_end_the_question_of_a_unit_whose_time_is_up(said: str) -> None:
    bench = Bench(UNIT.format(""))
    bench.listens()
    bench.step(at=20_100)
    bench.hears(said)
    assert bench.saying() == ["Bye."]
    [question] = [one for one in bench.phases("end") if one["command"] == "q-and-a"]
    assert question["outcome"] == "nomatch"


IN_UNIT = """<form id="a">
  <iu><block><speak>One.</speak></block><block><gesture name="bow"/></block>{handler}</iu>
  <block><speak>Two.</speak></block>
  <error><log expr="event.name"/></error>
</form>"""


def test_u5_the_error_of_a_handler_in_a_unit_is_handled() -> None:
    handler = '<on event="touch"><move-head pan="5"/></on>'
    bench = Bench(IN_UNIT.format(handler=handler))
    bench.event("touch")
    bench.finish("One.")
    bench.fail("move-head", "neck")
    assert bench.logs() == ["error.device.neck"]
    assert bench.running() == {}
    [unit] = [one for one in bench.phases("end") if one["command"] == "iu"]
    assert unit["outcome"] == "done"


def test_o2_a_command_wanted_now_in_a_unit_is_carried_out_in_it() -> None:
    handler = '<on event="touch"><speak order="now">Wait.</speak><log>said</log></on>'
    bench = Bench(IN_UNIT.format(handler=handler))
    bench.event("touch")
    assert bench.saying() == ["Wait.", "iu"]
    bench.finish("Wait.")
    assert (bench.logs(), bench.running()) == (["said"], {})


def test_o3_what_follows_a_waiting_unit_that_is_left_continues_its_stream() -> None:
    speaker = '<form id="a"><block><speak>A long story.</speak></block></form>'
    waits = """<form id="a">
      <block><gesture name="bow"/></block>
      <iu><block><speak>One.</speak></block></iu>
      <on event="touch"><goto next="#b"/></on>
    </form>
    <form id="b"><block><speak>Two.</speak></block></form>"""
    bench = Bench(document(waits, "ea", "waits"), document(speaker, "fa", "speaks"))
    bench.finish("gesture")
    assert [one["rule"] for one in bench.phases("hold")] == ["S1"]
    bench.event("touch")
    trees = {one["tree"] for one in bench.phases("request") if one["app"] == "waits"}
    assert trees == {"waits:1"}
    assert bench.phases("stream-end") == []


def test_o2_of_a_unit_all_is_cancelled_that_was_requested_at_once() -> None:
    handlers = """<on event="touch"><speak>Ouch.</speak><move-head pan="5"/></on>
      <on event="human.lost"><speak order="now">Come back.</speak></on>"""
    bench = Bench(IN_UNIT.format(handler=handlers))
    bench.event("touch")
    bench.event("human.lost")
    cancelled = [one["command"] for one in bench.phases("cancel")]
    assert sorted(cancelled) == ["move-head", "speak", "speak"]
    assert bench.saying() == ["Come back.", "iu"]


@pytest.mark.parametrize(
    ("item", "inside"),
    [
        ("three", {"One.": True, "Three.": True, "Two.": True, "Bye.": False}),
        ("bye", {"One.": True, "Bye.": False}),
    ],
)
def test_a_goto_to_an_item_leaves_a_unit_that_does_not_hold_it(
    item: str, inside: dict[str, bool]
) -> None:
    bench = Bench(
        f"""<form id="a"><iu><block><speak>One.</speak><goto nextitem="{item}"/></block>
        <block><speak>Two.</speak></block><block name="three"><speak>Three.</speak></block></iu>
        <block name="bye"><speak>Bye.</speak></block></form>"""
    )
    for text in inside:
        bench.finish(text)
    said = {r["text"]: bool(r.get("unit")) for r in bench.phases("start") if r.get("text")}
    assert [*said.items()] == [*inside.items()]
    starts = [one for one in bench.phases("start") if one.get("command") == "iu"]
    assert len(starts) == 1
    assert bench.running() == {}
