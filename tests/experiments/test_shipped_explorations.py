"""The scenarios that come with PRIMA keep what they expect in every timing.

Those that take few runs; ``make explore`` does the others.
"""

from __future__ import annotations

import pytest

from prima import explore, sweep
from tests import ROOT

SCENARIOS = ROOT / "documents" / "scenarios"
QUICK = [
    "dance-alone",
    "library-alone",
    "navigate-by-laser",
    "picture-alone",
    "pizza-and-video-timer",
    "three-applications",
    "touched-on-the-way",
    "video-timer-alone",
]


@pytest.mark.parametrize("name", QUICK)
def test_every_timing_keeps_what_a_scenario_expects(name: str) -> None:
    found = explore(SCENARIOS / f"{name}.xml", workers=1)
    assert (found["problems"], found["complete"]) == ([], True)


@pytest.mark.parametrize(
    ("name", "vary"),
    [
        ("pizza-and-follow", {}),
        ("three-applications", {"when[2].after": "8666ms"}),
        ("touched-on-the-way", {"when.at": "1157ms"}),
    ],
)
def test_another_policy_breaks_it(name: str, vary: dict[str, str]) -> None:
    """First come, first served: what was requested before a reaction goes before it."""
    table = sweep(SCENARIOS / f"{name}.xml", vary, ["prima", "fifo"], workers=1)
    own, other = table["expects_failed"].to_pylist()
    assert own == 0 < other


def test_an_entry_is_told_until_it_is_confirmed() -> None:
    """A "Yes." comes late, and the next one as the robot does not listen."""
    found = explore(SCENARIOS / "schedule-alone.xml", ["when[4]"], workers=1)
    assert (found["problems"], found["complete"]) == ([], True)
