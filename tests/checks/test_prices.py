"""Prices of parts of applications: how long they keep each device."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.checks.prices import Outline, outline
from prima.errors import UsageError
from prima.loading import read_application
from prima.loading.files import read_file
from tests.helpers.certified import faults
from tests.helpers.certifying import (
    FA,
    HEAD,
    PROFILE,
    TOUCH,
    block,
    certified,
    lasting,
    priced,
    run,
    waited,
)

SOON = '<when at="1ms"><touch sensor="head"/></when>'


def outlined(folder: Path) -> Outline:
    """The outline of the application whose parts have been priced."""
    path = folder / "app.xml"
    return outline(read_application(str(path), read_file(path))[0], PROFILE)


def test_speech_costs_what_it_lasts(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<speak>Good morning to you.</speak>"))
    assert (price.lasts, price.known) == (lasting("Good morning to you."), True)
    assert price.devices == {"speaker"}


def test_pauses_cost_what_they_last_and_only_those_in_speech_the_speaker(tmp_path: Path) -> None:
    (said,) = priced(tmp_path, block('<speak>Good <break time="2s"/>morning.</speak>'))
    assert (said.lasts, said.known) == (lasting("Good morning.") + 2000, True)
    (unit,) = priced(tmp_path, block('<iu><speak>Good.</speak><pause time="3s"/></iu>'))
    assert (unit.lasts, unit.known) == (lasting("Good.") + 3000, True)
    assert unit.devices == {"speaker"}


def test_what_an_expression_says_is_not_known(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block('<speak>Good <value expr="1"/></speak>'))
    assert not price.known and price.seconds.startswith("at least ")


def test_a_unit_costs_the_sum_of_its_parts_and_branches_their_longest(tmp_path: Path) -> None:
    parts = '<speak>One and two.</speak><gesture name="bow"/>'
    (price,) = priced(tmp_path, block(f"<iu>{parts}</iu>"))
    assert price.what == "unit" and price.lasts == lasting("One and two.") + 1500
    (price,) = priced(tmp_path, block(f"<iu><par>{parts}</par></iu>"))
    assert price.lasts == max(lasting("One and two."), 1500)


def test_branches_of_a_unit_may_take_a_device_in_either_order(tmp_path: Path) -> None:
    """The second branch, ready first, speaks first: then the first one goes on later."""
    words = "This is a rather long sentence that goes on and on and on."
    one = '<gesture name="bow"/><speak>A.</speak><turn angle="170"/><turn angle="-170"/>'
    two = f'<pause time="1400ms"/><speak>{words}</speak>'
    body = block(f"<iu><par><seq>{one}</seq><seq>{two}</seq></par></iu>")
    (unit,) = priced(tmp_path, body)
    turns = sum(part.lasts for part in unit.inner if part.what == "turn")
    assert unit.lasts == 1500 + lasting(words) + lasting("A.") + turns
    found = certified(tmp_path, body)
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), SOON)
    assert faults(found, records, PROFILE.voices) == []


def test_a_unit_of_very_many_commands_costs_their_sum(tmp_path: Path) -> None:
    many = "<speak>One.</speak>" * 2000
    (unit,) = priced(tmp_path, block(f'<iu longest="3600s">{many}<par>{many}</par></iu>'))
    assert unit.lasts == 4000 * lasting("One.")


def test_a_unit_costs_its_longest_duration_and_what_runs_then(tmp_path: Path) -> None:
    words = "a long word " * 20
    said = f"<speak>{words}</speak>"
    (price,) = priced(tmp_path, block(f'<iu longest="2s">{said * 2}</iu>'))
    assert price.lasts == 2000 + lasting(words)
    (price,) = priced(tmp_path, block(f'<iu longest="2s">{said}</iu>'))
    assert price.lasts == lasting(words)


def test_a_question_costs_its_prompt_and_its_timeout(tmp_path: Path) -> None:
    field = '<form id="f"><field name="a" type="boolean"><prompt timeout="4s">Well?</prompt></field></form>'
    (price,) = priced(tmp_path, field)
    assert price.what == "question" and price.lasts == lasting("Well?") + 4000
    assert price.listens and price.engages
    (price,) = priced(tmp_path, field.replace(' timeout="4s"', ""))
    assert price.lasts == lasting("Well?") + 5000


def test_a_question_in_a_unit_costs_the_units_longest(tmp_path: Path) -> None:
    body = (
        '<form id="f"><iu longest="20s"><field name="a" type="boolean"><prompt>Well?</prompt>'
        "</field></iu></form>"
    )
    (price,) = priced(tmp_path, body)
    assert (price.what, price.lasts) == ("unit", 20_000 + lasting("Well?") + 5000)


def test_an_answer_in_a_unit_is_a_part_of_the_unit_alone(tmp_path: Path) -> None:
    field = '<field name="a" type="boolean"><filled><speak>Fine.</speak></filled></field>'
    noinput = '<on event="noinput"><speak>Well?</speak></on>'
    (price,) = priced(tmp_path, f'<form id="f"><iu>{field}{noinput}</iu></form>')
    assert price.what == "unit" and [one.what for one in price.inner].count("speak") == 2
    (state,) = outlined(tmp_path).states.values()
    assert state.parts == [price]


def test_a_unit_whose_content_runs_once_costs_the_sum(tmp_path: Path) -> None:
    inner = (
        '<block><if cond="true"><speak>One.</speak></if></block><block><speak>Two.</speak></block>'
    )
    (unit,) = priced(tmp_path, f'<form id="f"><iu>{inner}</iu></form>')
    assert unit.lasts == lasting("One.") + lasting("Two.")
    error = '<on event="error"><speak>Oh.</speak></on>'
    (unit, _) = priced(tmp_path, f'<form id="f"><iu>{inner}</iu></form>{error}')
    assert unit.lasts == 60_000 + lasting("Two."), "each block may fail"


def test_every_block_of_a_unit_may_fail(tmp_path: Path) -> None:
    failing = '<block><gesture name-expr="v.a"/></block>' * 4
    body = (
        f'<var name="v"/><form id="f"><iu><block><speak>One.</speak></block>{failing}</iu>'
        '<block><exit/></block></form><on event="error"><speak>This is rather long.</speak></on>'
    )
    found = certified(tmp_path, body)
    at = TOUCH.replace("1s", "10ms")
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), at)
    assert waited(records) * 1000 > 4 * lasting("This is rather long.")
    assert faults(found, records, PROFILE.voices) == []


@pytest.mark.parametrize(
    ("value", "again"),
    [("'no'", False), ("true", False), ("a ? 'x' : 'y'", False), ("undefined", True), ("a", True)],
)
def test_an_item_that_is_given_a_value_is_not_visited_again(
    tmp_path: Path, value: str, again: bool
) -> None:
    assign = f'<block><assign name="b" expr="{value}"/></block>'
    priced(tmp_path, f'<var name="a"/><form id="f"><block name="b"/>{assign}</form>')
    (state,) = outlined(tmp_path).states.values()
    assert bool(state.repeats) == again


def test_a_loop_costs_one_loop(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<tracking-human/>"))
    assert price.loops and price.lasts == PROFILE.loop


def test_reactions_are_what_follows_events_from_outside(tmp_path: Path) -> None:
    others = (
        '<on event="end.speak"><speak>Late.</speak></on>'
        '<on event="bell" reactive="false"><speak>When there is time.</speak></on>'
    )
    body = FA.replace("</on>", f"</on>{others}")
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + body + "</prima>").encode())
    (reaction,) = outline(document, PROFILE).reactions
    assert reaction.events == ("touch",)
    assert [price.devices for price in reaction.firsts] == [{"speaker"}]


def test_of_very_many_reactions_the_longest_activity_counts_for_each(tmp_path: Path) -> None:
    def wait(count: int) -> int:
        bells = "".join(f'<on event="b{at}"><speak>A bell.</speak></on>' for at in range(count))
        touch = '<on event="touch"><speak>Who is it?</speak></on>'
        (delay,) = certified(tmp_path, f'<form id="f">{touch}{bells}</form>').delays
        return delay.lasts

    few, many = wait(10), wait(450)
    assert lasting("Who is it?") <= few <= 2 * lasting("Who is it?") < many


def test_too_many_forms_and_handlers_are_refused(tmp_path: Path) -> None:
    body = '<form id="f{}"/>', '<on event="end"><speak>Oh.</speak></on>'
    forms = "".join(body[0].format(at) for at in range(201))
    told = (
        "app.xml: there are 201 forms and 200 handlers, too many to follow what leads where. Split"
    )
    with pytest.raises(UsageError, match=told):
        priced(tmp_path, forms + body[1] * 200)
    priced(tmp_path, forms + body[1] * 9)
