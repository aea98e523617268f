"""The tables of elements and the schemas agree about generated documents."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from prima import api
from prima.errors import Problem
from prima.language.values import KINDS, read_value
from prima.markup.check import check_tree
from prima.markup.reader import parse
from prima.markup.vocabulary import Attribute, Element, Vocabulary, attributes_by_name
from tests.helpers.pages import BEGIN, NAMESPACES, compiled_schema
from tools.xsd import make_schema

VALID = {
    "duration": ["2s", "500ms", ".5s", "+1.25s", " 3s "],
    "delay": ["2s", "normal(5s,1s)", "0s..20s", "0s .. 1.5s"],
    "number": ["1", "-1.5", ".5", "2e3", " 7 "],
    "quantity": ["1", "normal(1,0.2)", "-1..1", "0.5 .. 2"],
    "integer": ["1", "-2", "007"],
    "boolean": ["true", "false", " true"],
    "id": ["a", "a-1", "\u3042", "x.y_z"],
    "variable": ["a", "a1", "dialog.a", "\u5ba4"],
    "variables": ["a", "a b", " a  dialog.b "],
    "event": ["touch", "touch.head", "error.device."],
    "events": ["touch", "touch.head message", " a b "],
    "expression": ["1", "a + b", " x ", "\u5ba4"],
    "text": ["", "any text", " ", "\u5ba4"],
    "target": ["#a", "#a-1"],
    "path": ["a.xml", "../b/c.xml"],
    "language": ["en", "ja-JP"],
    "date": ["2005-03-01T10:00:00", "1999-12-31", "2020-02-29T23:59"],
}
WRONG = ["", " ", "#", "1x", "x y", "-", "2", "2 s", "true false", "a..b", ".a", "#1", "TRUE", "1e", "9999999999"]  # fmt: skip
FAR = ["\u5b9f\u9a13", "#\ud55c", "e\u0301", "\uff11s", "\uff11", "\u00b2", "\u00a0", "a\u00a0", "100000s", "1e999", "$x"]  # fmt: skip
DIFFERING: dict[str, list[str]] = {
    "duration": ["100000s"],
    "delay": ["100000s"],
    "number": ["1e999"],
    "quantity": ["1e999"],
    **{kind: ["\uff11s", "\uff11"] for kind in ("id", "variable", "variables", "event", "events")},
}
"""Values of which the schema cannot say what the reader says, by kind: limits, and letters that
XML 1.0 takes since its fifth edition."""


@st.composite
def values(draw: st.DrawFn, item: Attribute, expression: bool) -> str:
    if item.choices and not expression:
        return draw(st.sampled_from(item.choices))
    return draw(st.sampled_from(VALID["expression" if expression else item.kind]))


@st.composite
def trees(
    draw: st.DrawFn, vocabulary: Vocabulary, element: Element, depth: int = 3
) -> etree._Element:
    """A valid element by the table, with what it may hold."""
    made = etree.Element(f"{{{vocabulary.namespace}}}{element.tag}")
    for item in element.attributes:
        if item.required or draw(st.booleans()):
            expression = item.dynamic and draw(st.booleans())
            name = f"{item.name}-expr" if expression else item.name
            made.set(name, draw(values(item, expression)))
    if element.text and draw(st.booleans()):
        made.text = draw(st.sampled_from(["text", " ", "\n  more text\n", "\u5ba4"]))
    if element.children and depth:
        for key in draw(st.lists(st.sampled_from(element.children), max_size=3)):
            child = draw(trees(vocabulary, vocabulary.elements[key], depth - 1))
            child.tail = draw(st.sampled_from(["", "\n  ", *(["tail"] if element.text else [])]))
            made.append(child)
    return made


def _either(item: Attribute) -> bool:
    """Whether an attribute or its expression has to be there, which the schema cannot say."""
    return item.required and item.dynamic


def strict_attributes(vocabulary: Vocabulary, node: etree._Element) -> list[str]:
    """Attributes of an element that table and schema are equally strict about."""
    tag = etree.QName(node).localname
    loose: set[str] = set()
    for element in vocabulary.elements.values():
        for name, (item, _) in attributes_by_name(element).items():
            if element.tag == tag and _either(item):
                loose.add(name)
    return sorted(name for name in map(str, node.attrib) if name not in loose)


@st.composite
def mutated(draw: st.DrawFn, vocabulary: Vocabulary) -> etree._Element:
    """A valid document, and then up to three changes that may make it wrong."""
    root = draw(trees(vocabulary, vocabulary.elements[vocabulary.root]))
    if draw(st.booleans()):
        root.set("{http://www.w3.org/XML/1998/namespace}lang", draw(st.sampled_from(["en", "ja"])))
    lenient = {e.tag for e in vocabulary.elements.values() for a in e.attributes if _either(a)}
    tags = sorted(vocabulary.tags - lenient)
    for _ in range(draw(st.integers(0, 3))):
        node = draw(st.sampled_from(list(root.iter())))
        strict = strict_attributes(vocabulary, node)
        match draw(st.integers(0, 6)):
            case 0 if strict:
                del node.attrib[draw(st.sampled_from(strict))]
            case 1 if strict:
                node.set(draw(st.sampled_from(strict)), draw(st.sampled_from(WRONG)))
            case 2:
                node.set(draw(st.sampled_from(["colour", "name", "expr", "cond", "to-expr"])), "x")
            case 3:
                blank = [" ", "\n"] if len(node) else []  # see test_white_space_is_no_content
                node.text = draw(st.sampled_from(["stray", "\u5ba4", *blank]))
            case 4:
                tag = draw(st.sampled_from([*tags, "nothing"]))
                etree.SubElement(node, f"{{{vocabulary.namespace}}}{tag}")
            case 5:
                etree.SubElement(node, draw(st.sampled_from(["{urn:other}block", "block"])))
            case _ if node is not root:
                tag = draw(st.sampled_from(tags))
                node.tag = f"{{{vocabulary.namespace}}}{tag}"
    return root


def verdicts(vocabulary: Vocabulary, root: etree._Element) -> tuple[bool, list[Problem]]:
    """What the XML Schema and the table say of a document."""
    data = etree.tostring(root, encoding="utf-8")
    node, element = parse("x.xml", data), etree.fromstring(data)
    for one in element.iter():
        if not len(one) and not (one.text or "").strip():
            one.text = None  # white space where nothing is allowed does not count
    problems: list[Problem] = []
    check_tree(node, vocabulary, problems)
    return compiled_schema(vocabulary.name).validate(element), problems


@pytest.mark.parametrize("vocabulary", NAMESPACES.values(), ids=lambda one: one.name)
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_generated_documents_are_valid_by_table_and_schema(
    vocabulary: Vocabulary, data: st.DataObject
) -> None:
    root = data.draw(trees(vocabulary, vocabulary.elements[vocabulary.root]))
    valid, problems = verdicts(vocabulary, root)
    assert valid and not problems, (problems, etree.tostring(root, encoding="unicode"))


@pytest.mark.parametrize("vocabulary", NAMESPACES.values(), ids=lambda one: one.name)
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_table_and_schema_give_one_verdict(vocabulary: Vocabulary, data: st.DataObject) -> None:
    root = data.draw(mutated(vocabulary))
    valid, problems = verdicts(vocabulary, root)
    assert valid == (not problems), (problems, etree.tostring(root, encoding="unicode"))


def kind_schema(kind: str) -> etree.XMLSchema:
    """A schema of one element with one attribute of a kind."""
    holder = Vocabulary("urn:x", "x", "e", [Element("e", "", (Attribute("a", kind, ""),))])
    imported = re.compile(r".*<xs:import.*\n|.*ref=.xml:lang.*\n")
    return etree.XMLSchema(etree.fromstring(imported.sub("", make_schema(holder)).encode()))


def differing(kind: str) -> list[str]:
    """Values that only one of schema and reader takes."""
    schema, found = kind_schema(kind), []
    for text in [*WRONG, *FAR, *VALID[kind]]:
        try:
            read_value(kind, text)
            read = True
        except ValueError:
            read = False
        element = etree.Element("{urn:x}e")
        element.set("a", text)
        if schema.validate(element) != read:
            found.append(text)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_schema_and_reader_agree_on_values(kind: str) -> None:
    new = [text for text in differing(kind) if text not in DIFFERING.get(kind, [])]
    assert not new, f"schema and reader differ about these values of {kind}: {new}"


def test_white_space_is_no_content(tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    path.write_text(
        f'{BEGIN}<form id="f"><block><exit>\n</exit></block></form></prima>', encoding="utf-8"
    )
    assert api.validate([path]) == []


def test_a_required_attribute_that_may_be_an_expression_is_required(tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    path.write_text(
        f'{BEGIN}<form id="f"><block><throw/><exit/></block></form></prima>', encoding="utf-8"
    )
    assert [problem.code for problem in api.validate([path])] == ["missing-attribute"]


@pytest.mark.parametrize("vocabulary", NAMESPACES.values(), ids=lambda one: one.name)
def test_defaults_are_values_of_their_kind(vocabulary: Vocabulary) -> None:
    for element in vocabulary.elements.values():
        for item, expression in attributes_by_name(element).values():
            if item.default and not expression and not item.choices:
                read_value(item.kind, item.default)
            if item.default and item.choices:
                assert item.default in item.choices
