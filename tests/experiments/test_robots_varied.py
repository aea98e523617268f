"""The robot's document as a factor: how fast it goes and talks, how long its gestures take."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pytest

from prima.api import rehearse
from prima.errors import UsageError
from prima.experiments.pools import local
from prima.experiments.settings import ExperimentSettings
from prima.experiments.sweep import Output, Sweep, SweepQuestion
from prima.experiments.variants import Stage
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.sweeps import PET, VISIT, write_visit

NODS = PET.replace("<speak>That tickles!</speak>", '<gesture name="nod"/>')
ROBOT = (ROOT / "documents/robots/papero.xml").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A visit whose robot nods when it is touched."""
    monkeypatch.chdir(tmp_path)
    write_visit(tmp_path, VISIT.replace(f"{ROOT}/documents/robots/papero.xml", "robot.xml"))
    (tmp_path / "pet.xml").write_text(NODS, encoding="utf-8")
    (tmp_path / "robot.xml").write_text(ROBOT, encoding="utf-8")
    return tmp_path


def written(vary: dict[str, str], name: str = "t.csv") -> list[dict[str, Any]]:
    out = Output(Sweep(SweepQuestion(("visit.xml",), vary=vary)), name, local(1))
    for _ in out.write():
        pass
    return list(out.read())


def test_a_slow_voice_takes_longer_and_a_long_gesture_ends_later() -> None:
    fast, slow = written({"robot.voice[en]": "28|7"})
    assert slow["seconds"] > fast["seconds"] + 4
    lasts = [one["seconds"] for one in written({"robot.gesture[nod]": "1s|20s"})]
    assert lasts[1] > lasts[0] + 10


def test_a_run_with_what_is_written_is_the_scenario_s_own_run() -> None:
    (row,) = written({"robot.speed": "0.5"})
    assert row["seconds"] == rehearse("visit.xml").summary().seconds
    assert not list(Path("t/orders").glob("*.robot.xml"))


def test_the_saved_scenario_makes_the_run_again() -> None:
    written({"robot.gesture[nod]": "20s", "robot.speed": "0.4"})
    (order,) = Path("t/orders").glob("*.jsonl")
    robot = order.with_suffix(".robot.xml").read_text(encoding="utf-8")
    assert 'name="nod" duration="20s"' in robot and 'speed="0.4"' in robot
    done = prima("run", str(order.with_suffix(".xml")), "-o", "again.jsonl")
    assert done.returncode == 0, done.stderr
    assert Path("again.jsonl").read_text() == order.read_text()


def test_a_stage_that_is_sent_takes_the_robot_along(folder: Path) -> None:
    stage = Stage.of(["visit.xml"], ["robot.voice[en]"], ExperimentSettings())
    variant = next(iter(Sweep(SweepQuestion(("visit.xml",), vary={"robot.voice[en]": "7"}))))
    here, sent = stage.run(variant), pickle.dumps(stage)
    (folder / "robot.xml").unlink()
    assert pickle.loads(sent).run(variant) == here


def test_the_digest_in_the_transcript_is_that_of_the_changed_document() -> None:
    stage = Stage.of(["visit.xml"], ["robot.speed"], ExperimentSettings())
    (slow,) = Sweep(SweepQuestion(("visit.xml",), vary={"robot.speed": "0.1"}))
    (own,) = Sweep(SweepQuestion(("visit.xml",), vary={"robot.speed": "0.5"}))
    digests = [stage.loaded(one).files["robot.xml"] for one in (slow, own)]
    assert len(set(digests)) == 2
    stage.save(Path(), "slow", slow)
    assert set(stage.digests()) == set(Stage.of(["visit.xml"], [], ExperimentSettings()).digests())


@pytest.mark.parametrize(
    ("vary", "why"),
    [
        ({"robot.speed": "9"}, 'robot.speed: "9" is out of range: from 0.01 to 3.'),
        ({"robot.voice[en]": ""}, "<voice> needs rate."),
        ({"robot.gesture[nod]": "0s|soon"}, 'robot.gesture.nod.: "soon" '),
        ({"robot.speed": "1", "robot": "robot.xml"}, "is a value of one robot"),
        ({"robot.gesture[nod]": "1s", "robot.gesture[1]": "2s"}, "are the same value"),
    ],
)
def test_wrong_levels(vary: dict[str, str], why: str) -> None:
    with pytest.raises(UsageError, match=why):
        written(vary)


def test_a_robots_document_that_cannot_be_read(folder: Path) -> None:
    (folder / "robot.xml").write_text("<robot", encoding="utf-8")
    done = prima("sweep", "visit.xml", "--vary", "robot.speed=1")
    assert done.returncode == 1 and "robot.xml:1:" in done.stderr, done.stderr
    (folder / "robot.xml").write_text(ROBOT.replace("<gesture", "<gestur", 1), encoding="utf-8")
    done = prima("sweep", "visit.xml", "--vary", "robot.gesture[nod]=1s")
    assert done.returncode == 1 and done.stderr.startswith("robot.xml:"), done.stderr
    assert 'Did you mean "gesture"?' in done.stderr
    (folder / "robot.xml").unlink()
    done = prima("sweep", "visit.xml", "--vary", "robot.speed=1")
    assert (done.returncode, done.stderr) == (
        2,
        "prima: visit.xml: robot.xml: cannot be read: No such file or directory.\n",
    )
