"""Checks of literals in the place of expressions of Commands' arguments."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import loading
from tests.helpers.bad_input import app
from tests.helpers.robot import Bench

BLOCK = '<form id="f"><block><{} {}="{}"/><exit/></block></form>'
SECONDS = "A number counts seconds."


@pytest.mark.parametrize(
    ("tag", "name", "code", "says"),
    [
        (
            "pause",
            "time-expr",
            "500",
            f'time-expr "500" is out of range: from 1ms to 60s. {SECONDS}',
        ),
        ("pause", "time-expr", "'500'", 'time-expr "500" is not a time. Write a number with its'),
        ("pause", "time-expr", " true ", 'time-expr "true" is not a time: a number of seconds, or'),
        ("turn", "angle-expr", "'left'", 'angle-expr "left" is not a number. Write digits'),
        ("turn", "angle-expr", "-7000", 'angle-expr "-7000" is out of range: from -360 to 360.'),
        (
            "topological-move",
            "to-expr",
            "'a b'",
            'to-expr "a b" is not a name. Begin with a letter',
        ),
        ("pause", "time-expr", "'500ms'", ""),
        ("pause", "time-expr", "0.5", ""),
        ("turn", "angle-expr", "('90')", ""),
        ("turn", "angle-expr", "-90 * 1000", ""),
        ("turn", "angle-expr", "`left`", ""),
        ("turn", "angle-expr", "[90]", ""),
        ("topological-move", "to-expr", "session.time", ""),
    ],
)
def test_a_literal_that_a_command_never_takes_is_told(
    tmp_path: Path, tag: str, name: str, code: str, says: str
) -> None:
    path = tmp_path / "a.xml"
    path.write_text(app(BLOCK.format(tag, name, code)))
    found = [one for one in loading.validate([path]) if one.code in ("bad-value", "out-of-range")]
    told = [f"{one.severity} {one.message} {one.remedy}".strip() for one in found]
    assert len(told) == bool(says)
    assert all(one.startswith(f"warning {says}") for one in told)


def test_it_is_an_error_that_an_application_can_handle() -> None:
    bench = Bench(
        """<form id="f"><block><turn angle-expr="'left'"/></block>
        <on event="error.semantic"><log expr="event.name"/><exit/></on></form>"""
    )
    bench.step()
    assert bench.logs() == ["error.semantic"]
