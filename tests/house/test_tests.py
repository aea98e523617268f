"""The order of the tests: a folder for each room, a file for each subject."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests import ROOT

MOST = 500
"""Lines of a file of tests."""

PACKAGE, TESTS = ROOT / "prima", ROOT / "tests"
BESIDE = {
    "bad_input", "browser", "cases", "helpers", "house", "invariants", "mistakes", "parties"
}  # fmt: skip
"""Folders that mirror no room of the package; docs/development.md says what is in each."""

FILES = [
    path
    for path in sorted(TESTS.rglob("*.py"))
    if not any(
        part == "node_modules" or part.startswith(".") for part in path.relative_to(TESTS).parts
    )
]
FOLDERS = sorted({path.relative_to(TESTS).parts[0] for path in FILES if path.parent != TESTS})


def is_package(folder: Path) -> bool:
    return (folder / "__init__.py").exists()


def rooms() -> set[str]:
    """Packages and modules of the package, and the folders of the checkout that have tests."""
    found = {path.stem for path in PACKAGE.glob("*.py")}
    found |= {path.name for path in PACKAGE.iterdir() if is_package(path)}
    return found | {"bench", "docs", "release", "tools"}


def test_files_are_short() -> None:
    """A file that grows over the bound is split by subject."""
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in FILES}
    assert {str(path.relative_to(ROOT)): n for path, n in lines.items() if n > MOST} == {}


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_is_a_room_or_declared(folder: str) -> None:
    assert folder in rooms() | BESIDE
    assert is_package(TESTS / folder), "else two files of one name are taken for one module"


@pytest.mark.parametrize("folder", sorted(BESIDE))
def test_a_declared_folder_is_there_and_described(folder: str) -> None:
    page = (ROOT / "docs" / "development.md").read_text(encoding="utf-8")
    assert is_package(TESTS / folder)
    assert re.search(rf"^\| .*`{folder}`.* \|", page, re.MULTILINE)


def test_tests_are_in_folders() -> None:
    assert [path.name for path in TESTS.glob("test_*.py")] == []
