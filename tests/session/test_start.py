"""Applications that an instant loads, and how they begin."""

from __future__ import annotations

import pytest

from prima.messages import ApplicationLoaded, Occurred
from tests.helpers.robot import Bench, document

LONG = f"<speak>{'word ' * 300}</speak>"
TELLS = (
    f'<form id="f"><block>{LONG}</block><on event="error.semantic"><log>refused</log></on></form>'
)


@pytest.mark.parametrize("tells", [0, 1, 2])
def test_e6_each_of_those_that_start_together_speaks_beside_the_others(tells: int) -> None:
    bodies = ['<form id="f"/>'] * 3
    bodies[tells] = TELLS
    bench = Bench(*(document(body, "ea", f"a{index}") for index, body in enumerate(bodies)))
    assert bench.logs() == ["refused"] and bench.saying() == []


def test_e6_who_has_started_alone_may_speak_for_long() -> None:
    bench = Bench(document(TELLS, "ea", "a"))
    assert bench.logs() == [] and len(bench.saying()) == 1


def test_e6_an_application_that_is_loaded_once_more_is_alone() -> None:
    bench = Bench(document(f'<form id="f"><on event="go">{LONG}</on></form>', "ea", "a"))
    bench.step(ApplicationLoaded("a"), Occurred("go", "environment"))
    assert len(bench.saying()) == 1
