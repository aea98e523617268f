"""Several persons: who speaks, whom the robot attends to and follows, who leaves."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError
from prima.loading import load_scenario
from prima.scheduler.policy import policy_named
from prima.sim.map import Map
from prima.sim.measuring import OwnSensors
from prima.sim.people import TriggeredScript
from prima.sim.rehearsal import Rehearsal
from prima.sim.world import World
from tests.helpers.rehearsing import PROFILE, rehearse, told

TWO = '<person id="ann" x="1" y="0"/><person id="ben" x="0" y="-1"/>'
ASKS = """<form id="a"><field name="x" type="text"><prompt>Who is there?</prompt>
  <noinput><reprompt/></noinput><filled><speak>Hello, <value expr="x"/>.</speak><exit/></filled>
  </field></form>"""
FOLLOWS = '<form id="a"><block><tracking-human distance="0.5"/></block></form>'


def world(*people: tuple[str, tuple[float, float] | None]) -> World:
    made = World(Map("m"), PROFILE, (0.0, 0.0), 0.0)
    for name, at in people:
        made.put(name, at)
    return made


def test_the_robot_attends_to_an_only_person_from_the_start() -> None:
    assert world(("user", (-2.0, 0.0))).person == (-2.0, 0.0)


def test_of_several_it_attends_to_the_nearest_whom_it_sees() -> None:
    made = world(("behind", (-0.5, 0.0)), ("far", (3.0, 0.0)), ("near", (1.5, 0.2)))
    assert made.person is None
    assert made.sees_person()
    assert made.person == (1.5, 0.2)
    made.walk("far", (1.0, 0.0), 2.0)
    made.advance(2000)
    assert made.person == (1.5, 0.2), "it stays with its own"


def test_it_attends_to_who_speaks_or_touches_and_is_there() -> None:
    made = world(("ann", (2.0, 0.0)), ("ben", (-2.0, 0.0)), ("caller", None))
    assert made.sees_person() and made.person == (2.0, 0.0)
    made.attend("ben")
    assert made.person == (-2.0, 0.0) and not made.sees_person()
    made.attend("caller")
    assert made.person == (-2.0, 0.0)


def test_who_searches_takes_whom_it_sees() -> None:
    made = world(("ann", (2.0, 0.0)), ("ben", (-2.0, 0.0)))
    made.attend("ben")
    assert made.find_somebody() and made.person == (2.0, 0.0)


def test_when_its_own_leaves_it_attends_to_the_next_whom_it_sees() -> None:
    made = world(("ann", (1.0, 0.0)), ("ben", (2.0, 0.0)))
    assert made.sees_person() and made.person == (1.0, 0.0)
    made.leave("ann")
    assert made.person is None
    assert made.sees_person() and made.person == (2.0, 0.0)
    made.leave("ben")
    assert not made.sees_person() and made.person is None


def test_its_sensors_are_of_the_one_whom_it_attends_to_from_then_on() -> None:
    made = world(("ann", (1.0, 0.0)), ("ben", (2.0, 0.0)))
    sensors = OwnSensors(made)
    first = sensors.measure()
    assert (first["human.visible"], first["human.distance"]) == (True, 1.0)
    made.leave("ann")
    then = sensors.measure()
    assert (then["human.visible"], then["human.distance"]) == (True, 2.0)
    assert sensors.measure() == {}


def test_who_has_gone_away_neither_goes_along_nor_goes_away_again(tmp_path: Path) -> None:
    script = f"""{TWO}<when at="1s" person="ann"><leave/><follow/><leave/></when>
      <when at="2s" person="ben"><follow/><leave/></when>"""
    rows = [one for one in told(rehearse(tmp_path, ASKS, script)) if " goes " in one]
    assert rows == ["ann goes away", "ben goes along with the robot", "ben goes away"]


def test_the_transcript_tells_who_spoke_and_touched(tmp_path: Path) -> None:
    script = f"""{TWO}<when asked="Who" person="ben"><say>Ben</say></when>
      <when at="1s" person="ann"><touch sensor="head"/><walk x="2" y="0"/><leave/></when>"""
    made = rehearse(tmp_path, ASKS, script)
    rows = told(made)
    assert 'ben: "Ben"' in rows and "ann touches the robot's head" in rows
    assert "ann walks to 2, 0" in rows and "ann goes away" in rows
    spoken = next(one for one in made.records if one.get("event") == "speech")
    assert spoken["data"]["person"] == "ben"
    assert api.replay(made, tmp_path / "scenario.xml").dumps() == made.dumps()


def test_an_only_person_needs_no_name(tmp_path: Path) -> None:
    script = '<person x="1" y="0"/><when asked="Who"><say>Ann</say></when>'
    made = rehearse(tmp_path, ASKS, script)
    assert '"Ann"' in told(made)
    spoken = next(one for one in made.records if one.get("event") == "speech")
    assert "person" not in spoken.get("data", {})


def test_what_nobody_is_named_for_is_the_first_s(tmp_path: Path) -> None:
    made = rehearse(tmp_path, ASKS, f'{TWO}<answer to="Who">It is me</answer>')
    assert 'ann: "It is me"' in told(made)


def position(made: api.Transcript) -> tuple[float, float]:
    data = [one["data"] for one in made.records if "x" in (one.get("data") or {})][-1]
    return data["x"], data["y"]


def test_the_robot_follows_whom_it_attends_to(tmp_path: Path) -> None:
    people = '<person id="ann" x="1" y="0"/><person id="ben" x="2" y="0.8"/>'
    script = f"""{people}<when at="2s" person="ann"><walk to="crossing"/></when>
      <when at="2s" person="ben"><walk x="2" y="-0.8"/></when>"""
    alone = rehearse(tmp_path, FOLLOWS, script, until="40s")
    assert position(alone)[0] > 7, "she was the nearest"
    spoken = script + '<when at="1s" person="ben"><say>Here.</say></when>'
    other = rehearse(tmp_path, FOLLOWS, spoken, until="40s")
    assert position(other)[0] < 3, "he has spoken to it"


def test_each_walks_follows_and_stays_for_themselves(tmp_path: Path) -> None:
    body = '<form id="a"><block><topological-move to="crossing"/><exit/></block></form>'
    script = """<person id="ann" x="0" y="0.8"/><person id="ben" x="0" y="-0.8"/>
      <when at="1s" person="ann"><follow distance="1"/></when>
      <when at="1s" person="ben"><follow distance="1.5"/><wait for="3s"/><stay/></when>"""
    rehearse(tmp_path, body, script)
    rehearsal = Rehearsal(load_scenario(tmp_path / "scenario.xml").cast, policy_named("prima"))
    for _ in rehearsal.run():
        pass
    ann, ben = (one.at for one in rehearsal.devices.world.people.values())
    assert ann is not None and ann[0] > 6
    assert ben is not None and ben[0] < 3


def test_a_scenario_of_many_events_compares_few_of_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A user of 10,000 took minutes: at each instant all that were to come were put in order."""
    count, less = 0, TriggeredScript.__lt__

    def compared(one: TriggeredScript, other: TriggeredScript) -> bool:
        nonlocal count
        count += 1
        return less(one, other)

    monkeypatch.setattr(TriggeredScript, "__lt__", compared)
    whens = "".join(f'<when at="{ms}ms"><touch sensor="head"/></when>' for ms in range(1000))
    rehearse(tmp_path, '<form id="a"/>', f'<person x="1" y="0"/>{whens}')
    assert count < 30_000


WRONG = {
    '<person x="1" y="0"/><person id="ben" x="0" y="1"/>': "Of several persons each needs an id.",
    '<person id="b" x="1" y="0"/><person id="b" x="0" y="1"/>': 'The id "b" is there twice.',
    f'{TWO}<when at="1s" person="bn"><leave/></when>': 'There is no person "bn".',
    '<person x="1" y="0"/><answer to="a" person="ann">b</answer>': 'There is no person "ann".',
    '<person id="ann"/><when at="1s" person="user"><leave/></when>': 'There is no person "user".',
    '<when at="1s" person="ann"><leave/></when>': 'There is no person "ann".',
}


@pytest.mark.parametrize("script", WRONG)
def test_persons_are_told_apart(tmp_path: Path, script: str) -> None:
    with pytest.raises(DocumentError) as caught:
        rehearse(tmp_path, ASKS, script)
    assert WRONG[script] in [one.message for one in caught.value.problems]
