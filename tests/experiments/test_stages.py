"""Stages: what runs need goes with them to another process or machine."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from prima.errors import RunError, UsageError
from prima.experiments import kept
from prima.experiments.scenariotext import Variant
from prima.experiments.settings import ExperimentSettings
from prima.experiments.variants import Made, Stage
from tests.helpers.spoken import recording
from tests.helpers.sweeps import VISIT, write_visit
from tests.helpers.voice import vxml

FIRST = """<form><block>One.<goto expr="'tw' + 'o.vxml'"/></block></form>"""
SECOND = """<form><block><audio expr="'sounds/be' + 'll.wav'">Bell.</audio></block></form>"""
HERE = Variant(0, 0, "", 0, ("1s",))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scenario whose pages and sounds have names that scripts compute."""
    made = tmp_path / "here"
    (made / "shop" / "sounds").mkdir(parents=True)
    monkeypatch.chdir(made)
    write_visit(made)
    Path("visit.xml").write_text(
        VISIT.replace("guide.xml", "shop/one.vxml")
        .replace('<answer id="reply" to="Shall I go on?" after="1s">Yes.</answer>', "")
        .replace('<expect says="Welcome" by="guide"/>', "")
    )
    Path("shop/one.vxml").write_text(vxml(FIRST))
    Path("shop/two.vxml").write_text(vxml(SECOND))
    recording(Path("shop/sounds/bell.wav"), 4.0)
    return made


def test_a_packed_stage_needs_no_file(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = Stage.of(["visit.xml"], ["touch"], ExperimentSettings())
    unpacked = pickle.dumps(stage)
    stage.pack()
    sent = pickle.dumps(stage)
    assert len(sent) < 200_000
    here = stage.run(HERE)
    assert here.exit == 0, here
    stage.save(Path(".."), "t", HERE)
    assert "Bell." in Path("../t.jsonl").read_text()
    folder.rename(folder.with_name("elsewhere"))
    monkeypatch.chdir("/")
    there: Stage = pickle.loads(sent)
    assert there.run(HERE) == here
    assert pickle.loads(unpacked).run(HERE) != here


@pytest.mark.parametrize(
    ("error", "code", "failures"),
    [
        (MemoryError(), 3, "out of memory"),
        (UsageError("It is not there."), 2, "It is not there."),
        (RunError("It broke."), 3, "It broke."),
        (KeyError("x"), 3, "this is a defect of prima: KeyError: 'x'"),
    ],
)
def test_a_run_that_cannot_be_made_says_why(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, code: int, failures: str
) -> None:
    stage = Stage.of(["visit.xml"], ["touch"], ExperimentSettings())

    def fails(*_: object) -> None:
        raise error

    monkeypatch.delenv("PRIMA_DEBUG", raising=False)
    monkeypatch.setattr(Stage, "rehearsed", fails)
    assert stage.run(HERE) == Made(code, failures=failures)


def test_too_much_to_pack(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = Stage.of(["visit.xml"], ["touch"], ExperimentSettings())
    monkeypatch.setattr(kept, "MOST_SENT", 100)
    with pytest.raises(UsageError, match=r"shop: a cluster needs the files .* folder of its own"):
        stage.pack()
    monkeypatch.setattr(kept, "MOST_SENT", 10**6)
    monkeypatch.setattr(kept, "MOST_FILES", 2)
    with pytest.raises(UsageError, match="shop: a cluster needs"):
        stage.pack()


def test_a_file_that_changes_afterwards_counts_as_it_was(folder: Path) -> None:
    stage = Stage.of(["visit.xml"], ["touch"], ExperimentSettings())
    before = stage.run(HERE)
    Path("pet.xml").write_text("<broken")
    assert stage.run(Variant(1, 0, "", 0, ("1s",))) == before
