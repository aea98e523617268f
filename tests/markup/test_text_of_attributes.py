"""The remedy for a text in an element that takes none: the attribute that it lacks."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api

APPLICATION = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">
<block>{}<exit/></block></form></prima>"""


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        ("<gesture>bow</gesture>", 'Write it as name="...".'),
        ("<pause>2s</pause>", 'Write it as time="...".'),
        ('<gesture name="bow">Hello.</gesture>', "Say it with <speak>, or remove it."),
        ("<if>Hello.</if>", "Say it with <speak>, or remove it."),
    ],
)
def test_a_text_goes_into_the_only_attribute_that_is_missing(
    tmp_path: Path, content: str, remedy: str
) -> None:
    path = tmp_path / "a.xml"
    path.write_text(APPLICATION.format(content), encoding="utf-8")
    found = [one.remedy for one in api.validate([path]) if one.code == "stray-text"]
    assert found == [remedy]
