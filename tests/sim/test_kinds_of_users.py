"""Users as documents: how a person answers and walks, whatever the scenario is about."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from prima import api
from prima.errors import DocumentError
from prima.invariants import callers, check
from prima.loading import load_scenario, load_text
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.rehearsing import rehearse, told

HEAD = '<user xmlns="urn:prima:user:1" version="1.0" id="kind"'
ASKS = """<form id="a"><field name="x" type="boolean"><prompt timeout="5s">Shall I?</prompt>
  <noinput><reprompt/></noinput><nomatch><reprompt/></nomatch>
  <filled><clear/></filled></field></form>"""
USERS = sorted((ROOT / "documents" / "users").glob("*.xml"))
SCENARIOS = [
    path
    for path in sorted(ROOT.glob("documents/scenarios/**/*.xml"))
    if "<person" in path.read_text()
]


def visit(folder: Path, user: str, script: str, person: str = "", until: str = "60s") -> Any:
    """A run with a user of a kind."""
    (folder / "kind.xml").write_text(f"{HEAD}{user}</user>")
    there = f'<person x="1" y="0" user="kind.xml" {person}/>'
    return rehearse(folder, ASKS, there + script, until=until)


def answers(made: api.Transcript) -> list[dict[str, Any]]:
    return [one for one in made.records if one.get("event") == "speech"]


def test_a_user_says_how_answers_come(tmp_path: Path) -> None:
    plain = '<answer to="Shall I">Yes.</answer>'
    soon = visit(tmp_path, '><answers after="200ms"/>', plain)
    late = visit(tmp_path, '><answers after="4s"/>', plain)
    assert answers(late)[0]["time"] - answers(soon)[0]["time"] == pytest.approx(3.8, abs=0.01)
    assert not answers(visit(tmp_path, '><answers chance="0"/>', plain))


def test_what_the_scenario_says_comes_first(tmp_path: Path) -> None:
    own = '<answer to="Shall I" after="1s" chance="1">Yes.</answer>'
    kind = visit(tmp_path, ' speed="2"><answers after="4s" chance="0"/>', own, 'speed="0.5"')
    without = rehearse(tmp_path, ASKS, f'<person x="1" y="0"/>{own}', until="60s")
    assert [one["time"] for one in answers(kind)] == [one["time"] for one in answers(without)]
    (person,) = load_kind(tmp_path, ' speed="2"/>', 'speed="0.5"').persons
    assert person.speed.drawn(1) == 0.5
    (person,) = load_kind(tmp_path, ' speed="2">').persons
    assert person.speed.drawn(1) == 2.0


def load_kind(folder: Path, user: str, person: str = "") -> Any:
    visit(folder, user.replace("/>", ">"), "", person)
    return load_scenario(folder / "scenario.xml").cast.scenario


def test_a_user_does_things_of_their_own_accord(tmp_path: Path) -> None:
    user = """><when at="2s"><touch sensor="head"/></when>
      <answer to="Shall I" times="1">No.</answer>"""
    rows = told(visit(tmp_path, user, '<answer to="Shall I" after="3s">Yes.</answer>'))
    assert "touches the robot's head" in rows
    assert '"No."' in rows and '"Yes."' in rows


def test_two_persons_of_one_kind_are_drawn_apart(tmp_path: Path) -> None:
    (tmp_path / "kind.xml").write_text(f'{HEAD}><answers after="1s..9s"/></user>')
    script = """<person id="ann" x="1" y="0" user="kind.xml"/>
      <person id="ben" x="1" y="1" user="kind.xml"/>
      <answer to="Shall I" person="ann">Yes.</answer>
      <answer to="Shall I" person="ben">Yes.</answer>
      <answer to="Shall" person="ben">Yes.</answer>"""
    rehearse(tmp_path, ASKS, script, until="20s")
    whens = load_scenario(tmp_path / "scenario.xml").cast.scenario.whens
    assert len({one.after.ms(1) for one in whens}) == 3
    assert len({one.after.ms(1, 2) for one in whens}) == 3


def test_a_seed_is_told_where_only_a_user_is_drawn(tmp_path: Path) -> None:
    plain = '<answer to="Shall I">Yes.</answer>'
    drawn = visit(tmp_path, '><answers after="1s..2s"/>', plain)
    assert drawn.records[0]["data"]["seed"] == 1
    assert "kind.xml" in drawn.records[0]["data"]["files"]
    fixed = visit(tmp_path, '><answers after="2s"/>', plain)
    assert "seed" not in fixed.records[0]["data"]


WRONG = {
    "><answers/><answers/>": (1, "There is a second <answers>."),
    '><answers after="soon"/>': (1, 'after "soon" '),
    '>\n<answers chance="1.5"/>': (2, 'chance "1.5" is out of range: from 0 to 1.'),
    '>\n<event name="a"/>': (2, "There is no <event>."),
    ">\n<person/>": (2, "There is no <person>."),
    '>\n<when at="1s"><touch sensor="tail"/></when>': (2, 'There is no touch sensor "tail".'),
    '>\n<when at="1s"><walk to="moon"/></when>': (2, 'There is no place or thing "moon".'),
    '>\n<when at="1s" person="ann"><leave/></when>': (2, '<when> has no attribute "person".'),
    ">\n<when><leave/></when>": (2, "<when> needs exactly one of"),
    ">Hello": (1, '<user> holds text: "Hello".'),
    """>
    <answer id="a" to="x">Yes.</answer>
    <when id="a" at="1s"><leave/></when>""": (3, 'The id "a" is there twice.'),
}


@pytest.mark.parametrize("user", WRONG)
def test_mistakes_in_users_have_a_place(tmp_path: Path, user: str) -> None:
    with pytest.raises(DocumentError) as caught:
        visit(tmp_path, user, "")
    errors = [one for one in caught.value.problems if one.severity == "error"]
    line, message = WRONG[user]
    assert [(one.place.line, Path(one.place.file).name) for one in errors] == [(line, "kind.xml")]
    assert errors[0].message.startswith(message)


def test_a_document_is_offered_no_values_from_a_file(tmp_path: Path) -> None:
    with pytest.raises(DocumentError) as caught:
        visit(tmp_path, '><answers after="gauss(1s,1s)"/>', "")
    (remedy,) = [one.remedy for one in caught.value.problems if one.severity == "error"]
    assert remedy.endswith("There are normal, lognormal, uniform, exponential.")


def test_warnings_about_users_are_told(tmp_path: Path) -> None:
    user = '><when at="1s"><say/></when><answer to="Shall I"/>'
    visit(tmp_path, user, '<answer to="Shall I">Yes.</answer>')
    for name in ("kind.xml", "scenario.xml"):
        made = prima("validate", "--format", "short", str(tmp_path / name))
        assert made.stdout.count("holds no words: the user stays silent.") == 2


def test_warnings_about_a_user_of_two_persons_are_told_once(tmp_path: Path) -> None:
    (tmp_path / "kind.xml").write_text(f'{HEAD}><when at="1s"><say/></when></user>')
    ann, ben = (f'<person id="{one}" x="1" y="0" user="kind.xml"/>' for one in ("ann", "ben"))
    rehearse(tmp_path, ASKS, ann + ben, until="5s")
    problems = load_scenario(tmp_path / "scenario.xml").problems
    assert [Path(one.place.file).name for one in problems if one.code == "empty"] == ["kind.xml"]


@pytest.mark.parametrize(
    ("user", "message"),
    [
        ("nobody.xml", '"nobody.xml" cannot be read'),
        ("app.xml", "This is an application; a user is needed here."),
        ("broken.xml", ""),
    ],
)
def test_a_user_that_is_not_there(tmp_path: Path, user: str, message: str) -> None:
    (tmp_path / "broken.xml").write_text("<user")
    with pytest.raises(DocumentError) as caught:
        rehearse(tmp_path, ASKS, f'<person x="1" y="0" user="{user}"/>')
    assert any(message in one.message for one in caught.value.problems)


def test_users_are_validated_alone() -> None:
    made = prima("validate", *map(str, USERS))
    assert (made.returncode, made.stdout) == (0, "")
    assert len(USERS) == 4


def test_a_user_is_no_scenario(tmp_path: Path) -> None:
    made = prima("run", str(USERS[0]))
    assert made.returncode == 1
    assert "This is a user; a scenario is needed here." in made.stderr


@pytest.mark.parametrize("user", USERS, ids=lambda path: path.stem)
def test_the_rules_hold_with_users_of_each_kind(user: Path, tmp_path: Path) -> None:
    """Each shipped scenario with such a user, in a run of its own for each seed."""
    for number, path in enumerate(SCENARIOS):
        text = path.read_text(encoding="utf-8")
        beside = ROOT / "documents" / "users" / user.name
        for seed in (number + 1, number + 101):
            copy = path.with_name(f"~{path.stem}.xml")
            changed = text.replace("<person", f'<person user="{beside}"', 1)
            loaded = load_text(copy, changed.encode())
            made = api.rehearse(loaded, seed=seed)
            policy, calling = loaded.cast.scenario.policy, callers(loaded.cast.documents)
            assert check(made.records, policy, calling=calling) == [], (path, seed)
            assert made.failures == []


def test_a_sweep_has_users_as_a_factor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    plain = '<answer to="Shall I">Yes.</answer>'
    visit(tmp_path, '><answers after="1s..4s"/>', plain, until="30s")
    (tmp_path / "mute.xml").write_text(f'{HEAD}><answers chance="0"/></user>')
    made = prima(
        *("sweep", "scenario.xml", "--vary", "person.user=kind.xml|mute.xml", "--seeds", "4"),
        *("-o", "users.csv"),
    )
    assert made.returncode == 0, made.stderr
    with (tmp_path / "users.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [(one["person.user"], one["seed"]) for one in rows] == [
        (user, str(seed)) for user in ("kind.xml", "mute.xml") for seed in range(1, 5)
    ]
    orders = {one["order"] for one in rows if one["person.user"] == "mute.xml"}
    assert len(orders) == 1
    records = {one["records"] for one in rows if one["person.user"] == "kind.xml"}
    assert len(records) > 1, "each seed is another user"
    for row in rows[:4]:
        again = prima("run", "scenario.xml", "--seed", row["seed"], "--format", "json")
        assert len(again.stdout.splitlines()) == int(row["records"])
    for name in {one["transcript"] for one in rows}:
        saved = (tmp_path / name).with_suffix(".xml")
        once = prima("run", str(saved), "--format", "json")
        assert once.stdout == (tmp_path / name).read_text()
