"""Values as they were most likely meant."""

from __future__ import annotations

import pytest

from prima.markup.hints import meant_value


@pytest.mark.parametrize(
    ("text", "usual", "meant"),
    [
        ("99", "", "99s"),
        ("500", "", "500ms"),
        ("500", "0s", "500ms"),
        ("500", "10s", "500ms"),
        ("120", "600s", "120s"),  # when a run ends
        ("2min", "600s", "120s"),
        ("soon", "600s", ""),
    ],
)
def test_a_time_without_a_unit(text: str, usual: str, meant: str) -> None:
    assert meant_value("duration", text, usual) == meant
