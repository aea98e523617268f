"""Runs of generated applications, against the rules written once more."""

from __future__ import annotations

from hypothesis import given

from tests.helpers.generated.model import Model
from tests.helpers.generated.timed import Happening, Timed, happened, timed
from tests.invariants.test_properties import examples


def in_order(found: list[Happening]) -> list[Happening]:
    """What happens; at one instant, in a fixed order."""
    return sorted(found)


@given(timed)
@examples(50)
def test_what_happens_is_what_the_rules_say(play: Timed) -> None:
    assert in_order(happened(play)) == in_order(Model(play).run())
