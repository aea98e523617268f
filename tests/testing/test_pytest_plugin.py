"""Scenarios as tests of pytest."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.helpers.testing import FIRST, write


def run_pytest(folder: Path, *args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "prima.pytest_plugin",
            "-p",
            "no:cacheprovider",
            *args,
        ],
        capture_output=True,
        encoding="utf-8",
        cwd=folder,
        timeout=60,
        check=False,
    )


@pytest.fixture
def project(tmp_path: Path) -> Iterator[Path]:
    for name, expected in (("good", "Going up"), ("bad", "Going down"), ("plain", "")):
        folder = tmp_path / name
        folder.mkdir()
        write(folder, f'<expect says="{expected}"/>' if expected else "")
    (tmp_path / "other.xml").write_text("<a/>")
    (tmp_path / "broken.xml").write_text("<a")
    yield tmp_path


def test_scenarios_are_tests_of_pytest(project: Path) -> None:
    done = run_pytest(project)
    assert "1 failed, 1 passed" in done.stdout
    assert f"lift.xml:{FIRST}:9: Expected: " in done.stdout
    assert "Traceback" not in done.stdout


def test_pytest_leaves_scenarios_alone_where_it_is_told(project: Path) -> None:
    (project / "pytest.ini").write_text("[pytest]\nprima_scenarios = false\n")
    assert "no tests ran" in run_pytest(project).stdout


def test_the_plugin_imports_prima_only_for_scenarios(tmp_path: Path) -> None:
    (tmp_path / "some.xml").write_text("<a/>")
    (tmp_path / "test_it.py").write_text(
        "import sys\n"
        "def test_it():\n"
        "    assert not {'prima.api', 'prima.testing', 'lxml', 'click'} & set(sys.modules)\n"
    )
    done = run_pytest(tmp_path)
    assert "1 passed" in done.stdout, done.stdout


def test_a_scenario_that_cannot_be_read_is_a_failing_test(tmp_path: Path) -> None:
    write(tmp_path, "<expect")
    done = run_pytest(tmp_path)
    assert "1 failed" in done.stdout and "Traceback" not in done.stdout
