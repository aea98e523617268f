"""One attack of each family, tried as ``make attack`` tries them all."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.attacks import ATTACKS, Attack, attempt

CHOSEN = {
    "arrays": "script 1",
    "iterators": "script 1",
    "texts": "script 13",
    "compiling": "script 2",
    "loops": "script 8",
    "memory": "script 1",
    "tags": "tag 1",
    "expressions": "condition 1",
    "bytes": "params of send",
    "work": "documents without a wait",
}


@pytest.mark.parametrize(
    "attack", [one for one in ATTACKS if CHOSEN[one.family] == one.name], ids=lambda one: one.family
)
def test_an_attack_costs_nobody_else_anything(attack: Attack, tmp_path: Path) -> None:
    found = attempt(attack, tmp_path)
    assert found.contained, found
    assert any("bad: error.semantic" in one for one in found.said), found


def test_every_family_is_tried() -> None:
    assert {one.family for one in ATTACKS} == CHOSEN.keys()


def test_a_run_that_hangs_or_lies_is_not_contained(tmp_path: Path) -> None:
    """The measure itself: an honest application that is never run does not survive."""
    found = attempt(Attack("work", "no document", {"bad.xml": "<prima/>"}), tmp_path)
    assert not found.contained
    assert found.exit == 1
