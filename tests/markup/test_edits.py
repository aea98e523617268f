"""Changes to documents as they are written."""

from __future__ import annotations

import pytest

from prima.markup.edits import edited, set_attribute, set_text
from prima.markup.reader import parse
from prima.markup.tree import Node

TEXT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!-- <say x="1"/> --><a one='1 &amp; "2"' two = "2"
   ><b/><c>some <!-- > --> text</c><d><e/></d></a>"""


def read() -> Node:
    return parse("a.xml", TEXT.encode("latin-1"))


def child(name: str) -> Node:
    return next(one for one in read().nodes if one.tag == name)


@pytest.mark.parametrize(
    ("name", "value", "made"),
    [
        ("two", "3", """<a one='1 &amp; "2"' two="3"\n   >"""),
        ("one", 'x<">&\n', """<a one="x&lt;&quot;&gt;&amp;&#10;" two = "2"\n   >"""),
        ("two", "", """<a one='1 &amp; "2"' \n   >"""),
        ("new", "5", """<a new="5" one='1 &amp; "2"' two = "2"\n   >"""),
        ("new", "", """<a one='1 &amp; "2"' two = "2"\n   >"""),
    ],
)
def test_an_attribute_is_set_or_taken_away(name: str, value: str, made: str) -> None:
    data = edited(TEXT, [set_attribute(read(), name, value)]).decode()
    assert made in data
    assert parse("b.xml", data.encode()).get(name) == value


@pytest.mark.parametrize(
    ("name", "value", "made"),
    [
        ("b", "x < y", "<b>x &lt; y</b><c>"),
        ("c", "other", "<b/><c>other</c><d>"),
        ("b", "", "\n   ><c>"),
        ("c", "", "<b/><d>"),
    ],
)
def test_a_text_is_set_or_its_element_taken_away(name: str, value: str, made: str) -> None:
    data = edited(TEXT, [set_text(child(name), value)])
    assert made in data.decode()
    again = [one for one in parse("b.xml", data).nodes if one.tag == name]
    assert [one.text for one in again] == ([value] if value else [])


def test_a_text_beside_elements_cannot_be_set() -> None:
    with pytest.raises(ValueError, match="holds elements"):
        set_text(child("d"), "x")


def test_several_edits_at_once_and_the_declaration_goes() -> None:
    edits = [
        set_attribute(read(), "two", "longer"),
        set_text(child("c"), "é"),
        set_attribute(read(), "one", ""),
    ]
    data = edited(TEXT, edits)
    assert data.decode().startswith('\n<!-- <say x="1"/> --><a  two="longer"')
    assert [one.text for one in parse("b.xml", data).nodes if one.tag == "c"] == ["é"]
