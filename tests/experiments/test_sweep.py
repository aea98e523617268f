"""Sweeps: runs that are functions of their rows, and the table they make."""

from __future__ import annotations

import csv
import json
import pickle
from pathlib import Path
from typing import Any

import pytest

from prima.api import rehearse
from prima.errors import DocumentError, Problem, UsageError
from prima.experiments.pools import local
from prima.experiments.scenariotext import Variant
from prima.experiments.sweep import Output, Sweep, SweepQuestion, estimate
from prima.experiments.variants import Made, Stage, signature
from tests import ROOT
from tests.helpers.batches import files
from tests.helpers.here import prima
from tests.helpers.sweeps import VISIT, write_visit

TOUCH = {"touch": "0s..6s/2s"}
MUTE = """<user xmlns="urn:prima:user:1" version="1.0" id="mute"><answers chance="0"/></user>"""


@pytest.fixture(autouse=True)
def visit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_visit(tmp_path)
    return tmp_path


def rows(**options: Any) -> list[dict[str, Any]]:
    """The table of a sweep of the visit, made in this process."""
    sweep = Sweep(SweepQuestion(("visit.xml",), **options))
    made = (sweep.row(one, sweep.stage.run(one), "") for one in sweep)
    return [dict(zip([one.name for one in sweep.columns], row, strict=True)) for row in made]


def written(name: str, pool: Any = None, resume: bool = False, **options: Any) -> Output:
    out = Output(Sweep(SweepQuestion(("visit.xml",), **options)), name, pool or local(2))
    for _ in out.write(resume):
        pass
    return out


def test_a_row_for_each_combination() -> None:
    made = rows(vary={"touch": "1s|4s", "reply": "Yes.|No."}, policies=("prima", "fifo"))
    assert [(one["policy"], one["touch"], one["reply"]) for one in made] == [
        (policy, touch, reply)
        for policy in ("prima", "fifo")
        for touch in (1.0, 4.0)
        for reply in ("Yes.", "No.")
    ]
    assert [one["run"] for one in made] == list(range(8))
    assert {one["exit"] for one in made} == {0}


def test_a_scenario_s_own_seed_that_is_varied_is_the_column_seed() -> None:
    out = written("s.csv", vary={"seed": "3|5"})
    text = Path("s.csv").read_text(encoding="utf-8")
    assert text.partition("\r\n")[0].split(",").count("seed") == 1
    assert [row["seed"] for row in out.read()] == [3, 5]


def test_a_run_with_what_is_written_is_the_scenario_s_own_run() -> None:
    (row,) = rows(vary={"touch": "1s", "reply": "Yes."})
    own = rehearse("visit.xml")
    assert row["order"] == signature(own.rows())
    assert row["seconds"] == own.summary().seconds
    assert row["records"] == len(own.records)


def test_equal_orders_have_equal_signatures_and_others_have_others() -> None:
    made = rows(vary={"touch": "1s|1500ms|7s"})
    assert made[0]["order"] == made[1]["order"] != made[2]["order"]


def test_measures_are_those_of_the_batch() -> None:
    policies = ("prima", "fifo")
    made = rows(vary={"touch": "1s"}, policies=policies)
    lines = prima(
        "run", "visit.xml", "--policy", "prima", "--policy", "fifo", "--format", "json"
    ).stdout.splitlines()
    for row, batch in zip(made, map(json.loads, lines), strict=True):
        same = row.keys() & batch.keys() - {"transcript"}
        assert len(same) >= 12
        assert {name: row[name] for name in same} == {name: batch[name] for name in same}


def test_documents_worlds_and_scenarios_are_factors_too() -> None:
    other = Path("guide.xml").read_text().replace("Welcome", "Hello")
    Path("other.xml").write_text(other)
    made = rows(vary={"application[2].src": "guide.xml|other.xml"})
    assert [one["expects_failed"] for one in made] == [0, 1]
    Path("again.xml").write_text(VISIT.replace('until="30s"', 'until="3s"'))
    both = Sweep(SweepQuestion(("visit.xml", "again.xml"), TOUCH))
    assert [both.row(one, both.stage.run(one), "")[1] for one in both] == (
        ["visit.xml"] * 4 + ["again.xml"] * 4
    )


def test_an_empty_level_takes_the_answer_away() -> None:
    yes, none = rows(vary={"reply": "Yes.|"})
    assert none["reply"] == "" and none["seconds"] > yes["seconds"] + 2


def test_an_answer_that_is_taken_away_has_no_delay() -> None:
    vary = {"reply": "Yes.|", "reply.after": "1s|2s"}
    made = rows(vary=vary)
    assert [one["exit"] for one in made] == [0, 0, 0, 0], made
    assert made[2]["order"] == made[3]["order"] == rows(vary={"reply": ""})[0]["order"]


def test_seeds_draw_and_the_same_seed_is_the_same_run() -> None:
    made = rows(vary={"touch": "normal(3s,2s)", "reply": "Yes.|No."}, seeds=5)
    times = [one["touch"] for one in made]
    assert times[:5] == times[5:] and len(set(times)) == 5
    assert made == rows(vary={"touch": "normal(3s,2s)", "reply": "Yes.|No."}, seeds=5)


def test_a_stage_is_content_and_reads_no_file(visit: Path) -> None:
    stage = Stage.of(["visit.xml"], ["touch"], Sweep(SweepQuestion(("visit.xml",))).stage.settings)
    sent = pickle.dumps(stage)
    here = stage.run(Variant(0, 0, "", 0, ("1s",)))
    for one in visit.iterdir():
        one.unlink()
    assert pickle.loads(sent).run(Variant(0, 0, "", 0, ("1s",))) == here
    assert here.exit == 0 and here.order


def test_the_table_is_the_same_however_it_is_made() -> None:
    written("one.csv", local(1), vary=TOUCH)
    written("two.csv", local(2), vary=TOUCH)
    one, two = Path("one.csv").read_text(), Path("two.csv").read_text()
    assert one.replace("one/", "two/") == two
    done = prima("sweep", "visit.xml", "--vary", "touch=0s..6s/2s", "-o", "three.csv")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "three.csv: 4 runs, 4 orders\n"
    assert Path("three.csv").read_text().replace("three/", "two/") == two
    printed = prima("sweep", "visit.xml", "--vary", "touch=0s..6s/2s", "-j", "2").stdout
    cut = [[cell for i, cell in enumerate(row) if i != 10] for row in csv.reader(two.splitlines())]
    got = csv.reader(printed.splitlines())
    assert [[cell for i, cell in enumerate(row) if i != 10] for row in got] == cut


def test_a_transcript_and_a_scenario_for_each_order() -> None:
    out = written("t.csv", vary=TOUCH)
    table = list(out.read())
    orders = {str(one["order"]) for one in table}
    assert {one.stem for one in Path("t/orders").iterdir()} == orders and len(orders) > 1
    for row in table:
        transcript = Path(str(row["transcript"]))
        assert transcript == Path(f"t/orders/{row['order']}.jsonl")
        again = prima("run", transcript.with_suffix(".xml"), "-o", "-").stdout
        assert again == transcript.read_text()
        assert signature(rehearse(transcript.with_suffix(".xml")).rows()) == row["order"]


def test_a_level_is_meant_even_if_it_is_the_default(visit: Path) -> None:
    """What is written in the scenario comes before what the user does."""
    slow = '<answers after="3s"/>'
    Path("slow.xml").write_text(MUTE.replace('<answers chance="0"/>', slow))
    person = VISIT.replace('speed="1"/>', 'user="slow.xml"/>')
    visit.joinpath("visit.xml").write_text(person.replace(' after="1s"', ""))
    one, two, own = [row["seconds"] for row in rows(vary={"reply.after": "1s|2s|"})]
    assert two - one == own - two == pytest.approx(1.0)


def test_a_scenario_is_saved_without_the_user_that_its_run_lacks(visit: Path) -> None:
    Path("mute.xml").write_text(MUTE)
    user = VISIT.replace('speed="1"/>', 'speed="1" user="mute.xml"/>')
    visit.joinpath("visit.xml").write_text(user)
    rows = list(written("t.csv", vary={"person.user": "mute.xml|"}).read())
    kept = [Path(str(one["transcript"])).with_suffix(".xml") for one in rows]
    assert ['user="' in one.read_text() for one in kept] == [True, False]
    for row, path in zip(rows, kept, strict=True):
        assert signature(rehearse(path).rows()) == row["order"]


def test_a_sweep_made_anew_keeps_no_transcript_of_the_one_before() -> None:
    """Orders are alike, and times are not; what somebody else has put there stays."""
    written("t.csv", vary={"touch": "1s|8s"})
    Path("t/orders/notes.xml").write_text("mine")
    out = written("t.csv", vary={"touch": "1500ms"})
    (row,) = out.read()
    found = sorted(one.name for one in Path("t/orders").iterdir())
    assert found == sorted([f"{row['order']}.jsonl", f"{row['order']}.xml", "notes.xml"])
    assert '"time":1.5,"phase":"event"' in Path(str(row["transcript"])).read_text()


def test_the_dictionary_describes_every_column() -> None:
    out = written("t.csv", vary=TOUCH)
    fields = json.loads(Path("t/dictionary.json").read_text())["fields"]
    with Path("t.csv").open(newline="") as stream:
        assert [one["name"] for one in fields] == next(csv.reader(stream))
    assert all(one["description"] for one in fields)
    touch = next(one for one in fields if one["name"] == "touch")
    assert (touch["type"], touch["role"], touch["unit"]) == ("number", "factor", "s")
    types: dict[str, Any] = {"integer": int, "number": (int, float), "string": str}
    for row in out.read():
        for one in fields:
            assert row[one["name"]] is None or isinstance(row[one["name"]], types[one["type"]])


def test_parquet_has_the_same_rows() -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table = list(written("t.csv", vary=TOUCH).read())
    written("p.parquet", vary=TOUCH)
    same = [{**row, "transcript": str(row["transcript"]).replace("p/", "t/")}
            for row in parquet.read_table("p.parquet").to_pylist()]  # fmt: skip
    assert same == table


def test_what_a_sweep_will_cost() -> None:
    done = prima("sweep", "visit.xml", "--vary", "touch=0s..6s/2ms", "--plan")
    assert done.returncode == 0
    assert done.stdout.startswith("3001 runs: about ") and "a table of about 0." in done.stdout
    assert "with 1 process (" in estimate(Sweep(SweepQuestion(("visit.xml",), TOUCH)), 1)


def test_what_many_runs_will_cost_is_told_before_them(monkeypatch: pytest.MonkeyPatch) -> None:
    for many, told in ((1, True), (2, False)):
        monkeypatch.setattr("prima.cli.sweep.MANY", many)
        done = prima("sweep", "visit.xml", "--vary", "touch=0s|1s", "--workers", "1")
        assert done.returncode == 0 and len(done.stdout.splitlines()) == 3
        assert ("2 runs: about " in done.stderr) == told


def test_the_cost_of_millions_is_estimated_from_runs_across_the_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    question = SweepQuestion(("visit.xml",), TOUCH, ("prima", "fifo"), seeds=1_000_000)
    sweep, ran, run = Sweep(question), [], Stage.run

    def noted(stage: Stage, variant: Variant) -> Made:
        ran.append(variant)
        return run(stage, variant)

    monkeypatch.setattr(Stage, "run", noted)
    assert estimate(sweep, 1).startswith(f"{len(sweep)} runs: about ")
    first, *counted = ran
    assert first == counted[0], "it is made twice: the first run of a process is slow"
    assert len(counted) == 10
    assert {one.policy for one in counted} == {"prima", "fifo"}
    assert len({one.values for one in counted}) > 1


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (
            {"vary": {"toch": "1s"}},
            'visit.xml: "toch" is not a value of the scenario. Did you mean "touch"',
        ),
        ({"vary": {"touch": "1s", "touch.at": "2s"}}, '"touch" and "touch.at" are the same value'),
        ({"vary": {"policy": "prima"}}, "write --policy prima --policy fifo"),
        ({"vary": {"touch": "normal(1s,1s)"}}, "its values are drawn by seed"),
        ({"vary": {"world": "none.xml"}}, 'world: with "none.xml": '),
        ({"vary": {"robot.at": "midle"}}, 'robot.at: with "midle": .*Did you mean "middle"'),
        ({"policies": ("pirma",)}, 'Did you mean "prima"'),
        ({"seeds": 0}, "write a whole number from 1"),
    ],
)
def test_mistakes_are_told_before_the_first_run(options: dict[str, Any], why: str) -> None:
    with pytest.raises(UsageError, match=why):
        Sweep(SweepQuestion(("visit.xml",), **options))


def test_a_scenario_with_errors() -> None:
    Path("visit.xml").write_text(VISIT.replace("<robot", "<robbot"))
    with pytest.raises(DocumentError):
        Sweep(SweepQuestion(("visit.xml",)))


def test_a_run_that_fails_is_a_row() -> None:
    guide = Path("guide.xml").read_text().replace("<speak>You", '<throw event="bored"/><speak>You')
    Path("guide.xml").write_text(guide)
    fails, fine = rows(vary={"reply": "Yes.|"})
    assert fails["exit"] == 3 and "bored" in fails["failures"] and fails["order"]
    assert fine["exit"] == 0
    done = prima("sweep", "visit.xml", "--vary", "reply=Yes.|", "-o", "t.csv")
    assert (done.returncode, done.stdout) == (3, "t.csv: 2 runs, 2 orders, 1 not fine\n")


def test_levels_that_do_not_fit_together_are_a_row() -> None:
    room = (ROOT / "documents" / "worlds" / "room.xml").read_text(encoding="utf-8")
    Path("hall.xml").write_text(room.replace('"door"', '"gate"'), encoding="utf-8")
    found = rows(
        vary={"world": f"{ROOT}/documents/worlds/room.xml|hall.xml", "robot.at": "middle|door"}
    )
    assert [one["exit"] for one in found] == [0, 0, 0, 1]
    assert 'There is no place "door"' in found[-1]["failures"]


def test_a_path_is_of_one_kind_in_all_scenarios() -> None:
    other = VISIT.replace('id="touch"', 'id="other"').replace('id="reply"', 'id="touch"')
    Path("other.xml").write_text(other)
    with pytest.raises(UsageError, match="touch: it is of another kind in each scenario"):
        Sweep(SweepQuestion(("visit.xml", "other.xml"), {"touch": "1s"}))


def test_the_folder_has_all_of_it() -> None:
    written("t.csv", vary=TOUCH)
    assert {name for name in files("t") if not name.startswith("orders")} == {
        "plan.json", "dictionary.json",
    }  # fmt: skip


def test_the_function_of_python_gives_the_same_table() -> None:
    import prima as package

    pytest.importorskip("pyarrow")
    vary: dict[str, str | list[str]] = {"touch": "0s..6s/2s", "reply": ["Yes.", "No."]}
    table = package.sweep("visit.xml", vary, workers=1)
    same = written("t.csv", vary={"touch": "0s..6s/2s", "reply": "Yes.|No."})
    assert [{**row, "transcript": ""} for row in same.read()] == table.to_pylist()
    kept = package.sweep(["visit.xml"], vary, output="u.csv", resume=True)
    assert Path("u.csv").read_text() == Path("t.csv").read_text().replace("t/", "u/")
    assert kept.num_rows == 8 and str(kept.schema.field("touch").type) == "double"
    with pytest.raises(UsageError, match="resume needs the output"):
        package.sweep("visit.xml", resume=True)
    with pytest.raises(UsageError, match="Name a scenario"):
        package.sweep([])


def test_a_path_is_varied_once() -> None:
    """The later levels would replace the earlier ones."""
    for again in ("touch", " touch", "touch "):
        done = prima("sweep", "visit.xml", "--vary", "touch=1s", "--vary", f"{again}=2s")
        told = "prima: --vary: touch is there twice; join the levels with |.\n"
        assert (done.returncode, done.stderr) == (2, told)
    done = prima("sweep", "visit.xml", "--vary", " =2s")
    assert done.returncode == 2 and "write PATH=LEVELS" in done.stderr


def test_a_scenario_is_named_once() -> None:
    """Its runs would count twice, in every mean and test."""
    for again, also in (("visit.xml", ""), ("./visit.xml", ', as "visit.xml"')):
        done = prima("sweep", "visit.xml", again, "-o", "t.csv")
        told = f'prima: The scenario "{again}" is there twice{also}.\n'
        assert (done.returncode, done.stderr) == (2, told)


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"workers": -1}, "workers=-1: write a whole number from 1"),
        ({"seeds": 1.5}, "seeds=1.5: write a whole number from 1"),
        ({"seeds": "3"}, "seeds='3': write a whole number from 1"),
        ({"patience": "3s"}, "patience='3s': write a whole number from 0"),
        ({"vary": {"touch": 5}}, 'touch: "5" is not a time'),
        ({"policies": "pirma"}, 'Did you mean "prima"'),
    ],
)
def test_mistakes_in_python(given: dict[str, Any], why: str) -> None:
    import prima as package

    with pytest.raises(UsageError, match=why):
        package.sweep("visit.xml", **given)


def test_what_python_may_leave_out() -> None:
    import prima as package

    pytest.importorskip("pyarrow")
    table = package.sweep("visit.xml", {"person.speed": 0.5}, policies="fifo", workers=1)
    assert table.column("policy").to_pylist() == ["fifo"]
    for wrong in ({"within": 0}, {"workers": -1}, {"step": -1}, {"runs": True}):
        with pytest.raises(UsageError, match="write a whole number"):
            package.explore("visit.xml", "touch", **wrong)


def test_planning_takes_no_longer_with_more_levels_than_are_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each level that is tried reads the scenario once, and not more are than told."""
    tried: list[Variant] = []
    problems = Stage.problems

    def count(stage: Stage, variant: Variant) -> list[Problem]:
        tried.append(variant)
        return problems(stage, variant)

    monkeypatch.setattr(Stage, "problems", count)
    Path("again.xml").write_text(Path("visit.xml").read_text())
    counts = []
    for step in ("20ms", "10ms", "5ms"):
        tried.clear()
        Sweep(
            SweepQuestion(("visit.xml", "again.xml"), {"touch": f"0s..20s/{step}", "reply": "No."})
        )
        counts.append(len(tried))
    assert counts == [1002, 1002, 1002]


@pytest.mark.parametrize("name", ["run", "scenario", "seed", "exit", "order", "seconds", "left"])
def test_ids_that_are_names_of_columns(name: str) -> None:
    write_visit(Path(), VISIT.replace('id="touch"', f'id="{name}"'))
    with pytest.raises(UsageError) as caught:
        rows(vary={name: "1s|4s"})
    assert str(caught.value) == (
        f'{name}: each table has a column "{name}" of its own.'
        " Name the value by its place, as when[2].at, or change its id."
    )
    assert [one["when[1].at"] for one in rows(vary={"when[1].at": "1s|4s"})] == [1, 4]
