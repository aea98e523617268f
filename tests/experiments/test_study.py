"""The thesis's criteria on small runs, and what a study of the ten situations shows."""

from __future__ import annotations

import csv
import io
from copy import deepcopy
from functools import cache

import pytest

from prima import api
from prima.experiments.study import (
    POLICIES,
    StudyResult,
    format_csv,
    format_table,
    situations,
    study,
)
from prima.messages import Command, Emergency, Ended, Group, Occurred
from prima.transcript.criteria import Criteria
from prima.transcript.measures import Measure
from prima.transcript.observer import observe
from prima.transcript.record import Entry
from prima.transcript.table import read_table
from tests.helpers.robot import Bench, document
from tests.helpers.stage import Stage, ask, chain, command, move, say

EVENT = 7
TILT = command("move-head", pan=30)


def seen(stage: Stage) -> Criteria:
    return observe(stage.records)


# Each criterion on the smallest run that shows it ----------------------------------------


@pytest.mark.parametrize(("policy", "cut"), [("none", 1), ("prima", 0)])
def test_units_cut(policy: str, cut: int) -> None:
    stage = Stage(policy)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", say("Hello."), say("Again."))
    stage.at(100).select()
    assert seen(stage).units_cut == cut


def test_a_device_that_its_own_application_takes_is_no_cut() -> None:
    stage = Stage("none")
    stage.request("ea", say("One."))
    stage.select()
    stage.request("ea", say("Two."), cause=EVENT)
    stage.at(100).select()
    assert seen(stage).units_cut == 0


def in_turns(policy: str, cause: int | None = None) -> Stage:
    """The EA's two sentences, and what the FA says in between where the policy lets it."""
    stage = Stage(policy)
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Hello."), cause=cause)
    stage.at(100).end("ea#1")
    started = stage.select()
    stage.at(200).end(started[0])
    started = stage.select()
    stage.at(300).end(started[0])
    stage.select()
    return stage


@pytest.mark.parametrize(
    ("policy", "cause", "broken"), [("fair", None, 1), ("prima", None, 0), ("prima", EVENT, 0)]
)
def test_streams_broken_by_no_reaction(policy: str, cause: int | None, broken: int) -> None:
    assert seen(in_turns(policy, cause)).broken == broken


@pytest.mark.parametrize(
    ("policy", "cause", "wordless"), [("fair", None, 1), ("prima", None, 0), ("prima", EVENT, 1)]
)
def test_topics_taken_up_after_others_have_spoken(
    policy: str, cause: int | None, wordless: int
) -> None:
    """ "Two." comes after the FA's "Hello.", and nothing says so; a reaction takes nothing up."""
    assert seen(in_turns(policy, cause)).wordless == wordless


def with_unit(*inside: Command, cause: int | None = None) -> Stage:
    """The EA's two sentences, and between them a unit of the FA that owns the speaker."""
    stage = Stage("fifo")
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.open("fa", 1, "speaker", "neck")
    stage.at(100).end("ea#1")
    stage.select()
    for number, what in enumerate(inside, 2):
        stage.request("fa", what, unit=1, cause=cause)
        stage.select()
        stage.at(100 * number).end(f"fa#{number}")
    stage.close("fa", 1)
    assert stage.select() == ["ea#2"]
    return stage


@pytest.mark.parametrize(("inside", "count"), [((say("Hello."),), 1), ((TILT,), 0), ((), 0)])
def test_a_unit_speaks_only_where_something_in_it_does(
    inside: tuple[Command, ...], count: int
) -> None:
    assert seen(with_unit(*inside)).wordless == count


@pytest.mark.parametrize(("words", "count"), [("Tea?", 1), (None, 0)])
def test_a_question_that_only_listens_says_nothing(words: str | None, count: int) -> None:
    """As after a nomatch whose handler does not ask again."""
    stage = Stage("fair")
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", Command("q-and-a", text=words))
    stage.at(100).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(200).end("fa#1", outcome="noinput")
    assert stage.select() == ["ea#2"]
    found = seen(stage)
    assert (found.wordless, found.broken) == (count, 1)


def test_a_unit_that_reacts_takes_up_no_topic() -> None:
    """Its Commands carry no cause, as the whole unit is the reaction."""
    stage = with_unit(say("Hello."))
    records = [dict(record) for record in stage.records]
    told = [one for one in records if one["phase"] == "request" and one["app"] == "ea"]
    unit = {**told[1], "behavior": "ea#9", "command": "iu", "cause": EVENT}
    told[1]["unit"] = "ea#9"
    place = records.index(told[1])
    assert observe([*records[:place], unit, *records[place:]]).wordless == 0


def test_a_unit_that_has_taken_too_long_is_cut_while_something_in_it_runs() -> None:
    stage = Stage("none")
    stage.open("ea", 1, "speaker", longest=50)
    stage.select()
    stage.request("ea", say("A long story."), unit=1)
    stage.select()
    stage.at(100).mediator.expire()
    stage.request("fa", say("Hello."))
    stage.select()
    assert [one["behavior"] for one in stage.phases("fail")] == ["ea#1"]
    assert [one["behavior"] for one in stage.phases("collision")] == ["ea#1"]
    assert seen(stage).units_cut == 1


@pytest.mark.parametrize(("policy", "wordless"), [("prima", 1), ("prima+x9", 0), ("prima+all", 0)])
def test_x9_takes_topics_up_in_words(policy: str, wordless: int) -> None:
    path = api.documents_folder() / "scenarios" / "politeness" / "in-words.xml"
    (result,) = study([path], [policy])
    assert result.criteria.wordless == wordless


def test_what_goes_on_at_the_same_time_breaks_nothing() -> None:
    stage = Stage()
    stage.request("ea", move(), say("Here."))
    stage.select()
    stage.request("fa", say("Nice weather."))
    stage.select()
    stage.at(500).end("ea#1.1")
    stage.at(600).end("fa#1")
    stage.select()
    assert seen(stage).broken == 0


def spoken_into(between: Command, cause: int | None = None) -> Stage:
    """Two sentences with something else between them, in which another application speaks."""
    stage = Stage("fifo")
    stage.request("ea", say("The answer is"), between, say("forty two."))
    stage.select()
    stage.at(100).end("ea#1")
    stage.select()
    stage.request("fa", say("I like trains."), cause=cause)
    stage.at(200).select()
    stage.at(300).end("fa#1")
    stage.at(400).end("ea#2" if between == TILT else "ea#2.1")
    assert stage.select() == ["ea#3"], "it goes on"
    return stage


@pytest.mark.parametrize(("cause", "broken"), [(None, 1), (EVENT, 0)])
def test_a_topic_that_is_spoken_into_is_broken(cause: int | None, broken: int) -> None:
    """Although the head turns meanwhile, so that the stream never stands still."""
    assert seen(spoken_into(TILT, cause)).broken == broken


def test_on_a_way_one_may_talk() -> None:
    assert seen(spoken_into(move())).broken == 0


@pytest.mark.parametrize("policy", ["prima", "fifo"])
def test_whoever_speaks_beside_a_way_from_its_first_instant_on_breaks_nothing(policy: str) -> None:
    """Whichever of the two is recorded first."""
    stage = Stage(policy)
    stage.request("ea", say("The answer is"), move(), say("forty two."))
    stage.select()
    stage.request("fa", say("I like trains."))
    stage.at(100).end("ea#1")
    assert sorted(stage.select()) == ["ea#2.1", "fa#1"]
    stage.at(300).end("fa#1")
    stage.select()
    stage.at(400).end("ea#2.1", goal=True)
    stage.select()
    assert seen(stage).broken == 0


def test_a_topic_that_is_spoken_into_twice_is_broken_once() -> None:
    """The stream stands still first, then its head turns: the user heard one interruption."""
    stage = Stage("fifo")
    stage.request("ea", say("The answer is"), TILT, say("forty two."))
    stage.select()
    stage.request("fa", say("I like trains."), say("And ships."))
    stage.at(100).end("ea#1")
    stage.select()
    stage.at(200).end("fa#1")
    stage.select()
    stage.at(300).end("fa#2")
    stage.at(400).end("ea#2")
    stage.select()
    assert seen(stage).broken == 1


ASKING = """<form id="a">
  <block><speak>I ask the server.</speak><send to="server"/><speak>Wait.</speak></block>
  <on event="reply.server"><speak>Thank you.</speak></on></form>"""
TALKING = '<form id="a"><block><speak>One.</speak><speak>Two.</speak><speak>Three.</speak></block>{}</form>'


def waiting(other: str) -> Bench:
    bench = Bench(ASKING, document(other, "ea", "other"))
    for text in ("I ask the server.", "Wait.", "One."):
        bench.finish(text)
    bench.step(Occurred("reply.server", data={}, app="app"))
    bench.finish("Two.")
    assert bench.saying() == ["Thank you."]
    return bench


def test_the_first_pattern_is_a_wait_for_a_server_that_another_breaks() -> None:
    bench = waiting(TALKING.format(""))
    assert observe(_seconds(bench)).broken_waiting == 1


def test_a_reaction_while_waiting_is_no_such_pattern() -> None:
    other = '<form id="a"><on event="bell"><speak>The bell!</speak></on></form>'
    bench = Bench(ASKING, document(other, "ea", "other"))
    bench.finish("I ask the server.")
    bench.finish("Wait.")
    bench.event("bell")
    bench.finish("The bell!")
    bench.step(Occurred("reply.server", data={}, app="app"))
    assert observe(_seconds(bench)).broken_waiting == 0


def test_a_wait_that_nobody_notices_is_no_such_pattern() -> None:
    silent = '<form id="a"><block><send to="server"/></block></form>'
    bench = Bench(silent, document(TALKING.format(""), "ea", "other"))
    bench.finish("One.")
    bench.step(Occurred("reply.server", data={}, app="app"))
    assert observe(_seconds(bench)).broken_waiting == 0


def _seconds(bench: Bench) -> list[dict[str, object]]:
    return [{**record, "time": record["time"] / 1000} for record in bench.records]


@pytest.mark.parametrize(("found", "unfaced"), [(True, 0), (False, 1)])
def test_the_second_pattern_is_a_conversation_begun_without_the_channel(
    found: bool, unfaced: int
) -> None:
    question = '<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt></field></form>'
    bench = Bench(
        "<form id='a'><on event='go'><goto next='#b'/></on></form>" + question.replace('"a"', '"b"')
    )
    if found:
        bench.step(Occurred("human.found", "robot"))
    bench.event("go")
    assert observe(bench.records).unfaced == unfaced


def test_what_asks_nothing_is_no_conversation() -> None:
    bench = Bench('<form id="a"><block><speak>Hello.</speak></block></form>')
    assert observe(bench.records).unfaced == 0


@pytest.mark.parametrize(("policy", "left"), [("fifo", 1), ("prima", 0)])
def test_a_conversation_that_the_robot_leaves(policy: str, left: int) -> None:
    stage = Stage(policy)
    stage.request("fa", ask("Well?"), say("I see."))
    stage.select()
    stage.request("ea", move())
    stage.at(100).select()
    assert seen(stage).left == left


@pytest.mark.parametrize(
    ("then", "stolen"),
    [
        (say("Thank you."), 1),
        (ask("Sure?"), 0),
        (Group(chain(say("Thank you."), say("Bye."))), 1),
        (Group(chain(command("gesture", name="nod"), say("Thank you."))), 1),
        (Group(chain(ask("Sure?"), say("Thank you."))), 0),
        (Group(chain(command("gesture", name="nod"), ask("Sure?"))), 0),
    ],
)
def test_a_third_turn_is_stolen_where_the_asker_s_next_utterance_is_no_question(
    then: Command | Group, stolen: int
) -> None:
    stage = Stage("fifo")
    stage.request("ea", ask())
    stage.select()
    stage.at(100).request("fa", say("Me."))
    stage.at(200).end("ea#1", then=lambda: stage.request("ea", deepcopy(then)), outcome="filled")
    assert stage.select() == ["fa#1"]
    stage.at(300).end("fa#1")
    started = stage.select()
    if isinstance(then, Group) and len(started) > 1 and stage.records[-1]["command"] == "gesture":
        stage.at(400).end(started[-1])
        stage.select()
    assert seen(stage).third_turns == stolen


def test_without_a_reaction_there_is_no_reaction_time() -> None:
    bench = Bench('<form id="a"><block><speak>A story.</speak></block></form>')
    bench.finish("A story.")
    found = observe(_seconds(bench))
    assert (found.reactions, found.reaction_mean, found.reaction_max) == (0, None, None)
    assert (found.responses, found.response_mean, found.response_max) == (0, None, None)


def test_a_policy_s_reaction_time_is_that_of_runs_with_reactions() -> None:
    """A run without a reaction is not one in which it took no time."""
    some = Criteria(reactions=2, reaction_mean=1.5, reaction_max=2.0)
    runs = (("a", some), ("b", Criteria()))
    rows = [StudyResult(name, "prima", one, None, None, 9.0, []) for name, one in runs]
    table = [line.split() for line in format_table(rows).splitlines()]
    [_, a, b, every] = [line[2:] for line in table if line]
    assert [line[9] for line in (a, b, every)] == ["2", "0", "2"]
    assert [line[10] for line in (a, b, every)] == ["1.50", "-", "1.50"]
    assert [line[11] for line in (a, b, every)] == ["2.00", "-", "2.00"]


def test_reactions_and_their_delays() -> None:
    bench = Bench(
        '<form id="a"><on event="bell"><speak>The bell!</speak></on></form>',
        document('<form id="a"><block><speak>A story.</speak></block></form>', "ea", "other"),
    )
    bench.event("bell")
    bench.finish("A story.")
    found = observe(_seconds(bench))
    assert found.reactions == 1
    assert found.reaction_mean == found.reaction_max == 0.1
    assert [(one.event, one.app, one.seconds) for one in found.delays] == [("bell", "app", 0.1)]


NODS = """<form id="a"><on event="touch">
  <move-head pan="20"/><speak>You touched me.</speak><face-human/></on></form>"""


def test_a_reaction_and_its_response_are_measured_apart() -> None:
    """A turn of the head at once is the first Command; the first word comes 59 s later."""
    bench = Bench(
        NODS, document('<form id="a"><block><speak>A story.</speak></block></form>', "ea", "other")
    )
    bench.event("touch")
    bench.finish("move-head")
    bench.now += 58_800
    bench.finish("A story.")
    found = observe(_seconds(bench))
    assert (found.reactions, found.reaction_mean, found.reaction_max) == (1, 0.0, 0.0)
    assert (found.responses, found.response_mean, found.response_max) == (1, 59.0, 59.0)
    assert [(one.seconds, one.response) for one in found.delays] == [(0.0, 59.0)]


def test_a_question_that_only_listens_is_no_response() -> None:
    asks = '<form id="b"><field name="q"><option>Yes.</option></field></form>'
    bench = Bench('<form id="a"><on event="touch"><goto next="#b"/></on></form>' + asks)
    bench.event("touch")
    found = observe(_seconds(bench))
    assert (found.reactions, found.responses) == (1, 0)


@pytest.mark.parametrize(
    ("content", "responses"),
    [
        ("<speak>Yes?</speak>", 1),
        ("<face-human/>", 1),
        ('<move-head pan="20"/>', 0),
        ('<gesture name="nod"/>', 0),
        ('<topological-move to="lab"/>', 0),
    ],
)
def test_a_response_is_a_word_or_a_movement_towards_the_user(content: str, responses: int) -> None:
    bench = Bench(f'<form id="a"><on event="touch">{content}</on></form>')
    bench.event("touch")
    found = observe(_seconds(bench))
    assert (found.reactions, found.responses) == (1, responses)
    assert [one.response for one in found.delays] == [0.0 if responses else None]


def test_a_printed_table_is_read_back() -> None:
    transcript = api.rehearse(api.documents_folder() / "scenarios" / "museum-alone.xml")
    rows = read_table(transcript.table())
    made = transcript.rows()
    assert [(row.actor, row.app, row.what, row.event) for row in rows] == [
        (row.actor, row.app, row.what, row.event) for row in made
    ]


# The ten situations ---------------------------------------------------------------------


@cache
def results() -> list[StudyResult]:
    return list(study())


def of(policy: str) -> list[StudyResult]:
    return [result for result in results() if result.policy == policy]


def test_a_study_runs_the_ten_situations_under_every_policy() -> None:
    assert len(situations()) == 10
    assert [result.policy for result in results()] == list(POLICIES) * 10
    assert not [result for result in results() if result.failures and result.policy != "none"]


def test_the_rules_of_the_thesis_cut_nothing_and_leave_nobody() -> None:
    for policy in (name for name in POLICIES if name.startswith("prima")):
        for result in of(policy):
            criteria = result.criteria
            assert (criteria.units_cut, criteria.broken, criteria.left) == (0, 0, 0)
    for policy in ("none", "fifo", "fair", "fixed"):
        assert any(
            one.criteria.units_cut or one.criteria.broken or one.criteria.left for one in of(policy)
        ), policy


def test_both_patterns_of_complaint_occur_and_the_extensions_remove_them() -> None:
    assert sum(result.criteria.broken_waiting for result in of("prima")) > 0
    assert sum(result.criteria.unfaced for result in of("prima")) > 0
    for policy in ("prima+x3", "prima+all"):
        assert [result.criteria.broken_waiting for result in of(policy)] == [0] * 10
    for policy in ("prima+x4", "prima+all"):
        assert [result.criteria.unfaced for result in of(policy)] == [0] * 10


def test_prima_gives_the_order_that_each_situation_expects() -> None:
    assert [(result.distance, result.missing) for result in of("prima")] == [(0, 0)] * 10
    assert sum(result.distance or 0 for result in of("fifo")) > 0


def test_the_three_forms_of_a_study_tell_the_same() -> None:
    made = of("prima")
    rows = list(csv.DictReader(io.StringIO(format_csv(made))))
    assert [row["unfaced"] for row in rows] == [str(one.criteria.unfaced) for one in made]
    table = format_table(made)
    assert table.count("\n") == 1 + 2 * 10 + 2
    assert table.splitlines()[-1].startswith("all")


def test_a_row_of_what_resumes_may_be_missing() -> None:
    """S04 without a mediator breaks off none of the two ways, so none of them resumes."""
    assert {one.situation: one.missing for one in of("none")}["s04"] == 2


def test_the_emergency_stop_is_an_event_that_may_be_reacted_to() -> None:
    bench = Bench('<form id="f"><on event="emergency.release"><speak>Released.</speak></on></form>')
    bench.step(Emergency(True))
    bench.step(Emergency(False))
    bench.step(*map(Ended, bench.running()))
    figures = Measure()
    for record in bench.records:
        figures.add(Entry(record, record["time"] / 1000))
    assert figures.summary().reactions == 1
