"""The studies that come with PRIMA can be made as they stand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from prima.experiments.studyfile import read_study
from prima.experiments.sweep import Sweep
from tests import ROOT

STUDIES = sorted(ROOT.glob("documents/studies/**/*.toml"))


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_a_study_of_the_package_makes_its_runs(path: Path) -> None:
    study = read_study(str(path))
    assert study.seeds == 10_000
    sweep = Sweep(replace(study, seeds=2, isolate="none"))
    made = [sweep.stage.run(variant) for variant in sweep]
    assert [one.exit for one in made] == [0] * len(sweep)
