"""The documentation is true: its examples validate and run, its tables are those of the code."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from prima import api
from prima.checks.codes import diagnoses
from prima.devices.vocabulary import ROBOT
from prima.errors import Problem, UsageError
from prima.handbook import rulebook
from prima.interpreter.vocabulary import DIALOGUE, SPEAKING
from prima.language.values import KINDS, read_value
from prima.markup.check import check_tree
from prima.markup.reader import parse
from prima.markup.schema import make_schema
from prima.markup.vocabulary import Attribute, Element, Vocabulary, attributes_by_name
from prima.report import strip
from prima.scheduler.policy import BASELINES
from prima.sim.vocabulary import SCENARIO, WORLD
from prima.transcript.record import FIELDS, PHASES, model
from prima.transcript.rules import RULES
from tests import ROOT
from tools import reference

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(
    r"^```(?P<language>\w*)(?: (?P<name>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)
NAMESPACES = {one.namespace: one for one in (DIALOGUE, WORLD, ROBOT, SCENARIO)}
MODULE = [sys.executable, "-m", "prima"]


@dataclass
class Example:
    """A fenced block of a page: its language, the file's name if it has one, its text."""

    page: Path
    line: int
    language: str
    name: str
    text: str

    @property
    def complete(self) -> bool:
        """Whether it is a whole document and no fragment."""
        namespaces = ('xmlns="urn:prima:', 'xmlns="http://www.w3.org/2001/vxml"')
        known = self.name.endswith(".grxml") or any(one in self.text for one in namespaces)
        return self.language == "xml" and known

    def __str__(self) -> str:
        return f"{self.page.name}:{self.line}"


@dataclass
class Shown:
    """A command of a console block, and the output that the page shows for it."""

    example: Example
    words: list[str]
    output: list[str] = field(default_factory=list)


def examples(page: Path) -> list[Example]:
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    return [
        Example(
            page,
            text.count("\n", 0, match.start()) + 1,
            match["language"],
            match["name"] or "",
            match["text"],
        )
        for match in FENCE.finditer(text)
    ]


def commands(example: Example) -> list[Shown]:
    found: list[Shown] = []
    marked = re.search(r"^\$ ", example.text, re.MULTILINE) is not None
    for line in example.text.splitlines():
        if line.startswith("$ " if marked else "prima "):
            found.append(Shown(example, shlex.split(line.removeprefix("$ "), comments=True)))
        elif marked and found:
            found[-1].output.append(line)
    return found


def stage(page: Path, folder: Path) -> None:
    """A folder in which a page's commands work: the demo documents and the page's own."""
    shutil.copytree(ROOT / "documents", folder / "documents")
    for number, example in enumerate(examples(page)):
        if example.complete:
            (folder / (example.name or f"example-{number}.xml")).write_text(
                example.text, encoding="utf-8"
            )


def save(example: Example, folder: Path) -> None:
    """Write a named file when the page comes to it, as a reader does.

    A part takes the place of the element with the same tag and id or name; if there
    is none, it is added at the document's end.
    """
    path, part = folder / example.name, example.text
    if not example.complete:
        whole = path.read_text(encoding="utf-8")
        start = re.match(r"\s*(<([\w-]+)(?: (?:id|name)=\"[^\"]*\")?)", part)
        assert start, str(example)
        old = re.compile(
            rf"^ *{re.escape(start[1])}(?=[\s>]).*?</{start[2]}>\n", re.DOTALL | re.MULTILINE
        )
        end = whole.rindex("</")
        found = old.search(whole)
        at = found.span() if found else (end, end)
        part = whole[: at[0]] + part + whole[at[1] :]
    path.write_text(part, encoding="utf-8")


def piped(words: list[str]) -> tuple[str | None, list[str]]:
    """What a command is given through a pipe (printf TEXT | COMMAND), and the command."""
    if words[:1] != ["printf"] or words[2:3] != ["|"]:
        return None, words
    return words[1].replace("\\n", "\n"), words[3:]


def run(words: list[str], folder: Path, given: str | None = None) -> tuple[int, list[str]]:
    paths = [
        sorted(path.relative_to(folder).as_posix() for path in folder.glob(word))
        if "*" in word
        else [word]
        for word in words
    ]
    done = subprocess.run(
        [*MODULE, *(name for names in paths for name in names)],
        cwd=folder,
        input=given,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=120,
    )
    return done.returncode, [line.rstrip() for line in done.stdout.splitlines()]


def alike(shown: list[str], made: list[str]) -> bool:
    """Whether the output is as shown; a line of three dots stands for any lines."""
    if not shown:
        return not made
    if shown[0].strip() == "...":
        return any(alike(shown[1:], made[start:]) for start in range(len(made) + 1))
    return bool(made) and shown[0].rstrip() == made[0] and alike(shown[1:], made[1:])


# Examples --------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_complete_examples_are_valid(page: Path, tmp_path: Path) -> None:
    stage(page, tmp_path)
    for path in sorted(tmp_path.glob("*.xml")):
        errors = [p for p in api.validate([path]) if p.severity == "error"]
        assert not errors, (page.name, path.name, errors)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_give_what_is_shown(page: Path, tmp_path: Path) -> None:
    stage(page, tmp_path)
    for example in examples(page):
        if example.language in ("xml", "wrong") and example.name:  # wrong: to be validated
            save(example, tmp_path)
        if example.language not in ("", "console", "sh", "bash", "shell"):
            continue
        for shown in commands(example):
            given, words = piped(shown.words)
            if words[:1] != ["prima"]:
                continue
            code, made = run(words[1:], tmp_path, given)
            assert code != 2, (str(example), shown.words, made)
            while shown.output and not shown.output[-1].strip():
                shown.output.pop()
            if shown.output:
                assert alike(shown.output, made), (str(example), shown.words, "\n".join(made))


BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">'
SCENE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="x" world="w" robot="r">',
    "</scenario>",
)
CONTEXTS = {
    "dialogue": (
        (BEGIN, "</prima>"),
        (f'{BEGIN}<form id="f">', "</form></prima>"),
        (f'{BEGIN}<form id="f"><block>', "</block></form></prima>"),
        (f'{BEGIN}<form id="f"><field name="n">', "</field></form></prima>"),
    ),
    "scenario": (SCENE, (f'{SCENE[0]}<when at="1s">', f"</when>{SCENE[1]}")),
    "robot": (('<robot xmlns="urn:prima:robot:1" version="1.0" id="x">', "</robot>"),),
    "world": (('<world xmlns="urn:prima:world:1" version="1.0" id="x">', "</world>"),),
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_fragments_are_valid_where_they_belong(page: Path) -> None:
    for example in examples(page):
        if example.language != "xml" or example.complete:
            continue
        valid = [
            name
            for name, contexts in CONTEXTS.items()
            for begin, end in contexts
            if compiled_schema(name).validate(etree.fromstring(begin + example.text + end))
        ]
        assert valid, f"{example}: this fragment is valid nowhere"


# Tables ----------------------------------------------------------------------


def test_generated_files_are_those_of_the_code() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tools.reference", "--check"],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert done.returncode == 0, done.stderr


def test_check_names_what_differs(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "schemas", tmp_path / "schemas")
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    for path, text in reference.outputs(tmp_path).items():
        path.write_text(text, encoding="utf-8")
    assert reference.differing(tmp_path) == []
    (tmp_path / "schemas" / "world.xsd").unlink()
    page = tmp_path / "docs" / "codes.md"
    page.write_text(page.read_text(encoding="utf-8").replace("not-xml", "no-xml"), encoding="utf-8")
    assert reference.differing(tmp_path) == ["schemas/world.xsd", "docs/codes.md"]


def test_a_wrong_marker_is_told() -> None:
    with pytest.raises(UsageError, match='no generated section "nothing"'):
        reference.fill("x.md", "<!-- generated: nothing -->\n<!-- end: nothing -->\n")
    with pytest.raises(UsageError, match="no end"):
        reference.fill("x.md", "<!-- generated: codes -->\n")


def test_every_generated_section_stands_in_a_page() -> None:
    pages = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for name in reference.SECTIONS:
        assert f"<!-- generated: {name} -->" in pages, name


def words_of(text: str) -> str:
    """A page without what is generated, and without its examples of code."""
    return reference.MARKER.sub("", text)


@pytest.mark.parametrize("vocabulary", NAMESPACES.values(), ids=lambda one: one.name)
def test_every_element_is_mentioned_in_the_text(vocabulary: Vocabulary) -> None:
    page = "language.md" if vocabulary is DIALOGUE else "scenarios.md"
    whole = (ROOT / "docs" / page).read_text(encoding="utf-8")
    text = words_of(whole)
    named = {"q-and-a"} | set(SPEAKING)  # these have a generated table of their own
    for element in vocabulary.elements.values():
        assert f"`<{element.tag}>`" in whole, element.tag
        if element.tag not in named:
            assert re.search(rf"[`<]{re.escape(element.tag)}\b", text), element.tag


def test_every_phase_and_field_of_a_record_is_described() -> None:
    text = (ROOT / "docs" / "transcripts.md").read_text(encoding="utf-8")
    for word in [*PHASES, *FIELDS]:
        assert f"`{word}`" in text, word


def test_the_phases_are_those_of_the_model() -> None:
    schema = model().model_json_schema()
    assert schema["properties"]["phase"]["enum"] == list(PHASES)


def test_transcripts_fit_the_json_schema() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "schemas" / "transcript.schema.json").read_text(encoding="utf-8"))
    check = jsonschema.Draft202012Validator(schema)
    made = api.rehearse(ROOT / "documents" / "scenarios" / "follow-during-navigation.xml")
    for record in made.records:
        check.validate(record)
    assert not check.is_valid({"time": 0, "phase": "start", "actor": "robot", "colour": "red"})


def links_of(page: Path) -> Iterator[tuple[str, str]]:
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" not in target:
            name, _, anchor = target.partition("#")
            yield name, anchor


def anchors(page: Path) -> set[str]:
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    found = set()
    for title in re.findall(r"^#+ (.+)$", text, re.MULTILINE):
        plain = re.sub(r"[^\w\- ]", "", title.lower())
        found.add(plain.replace(" ", "-"))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for name, anchor in links_of(page):
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), (page.name, name)
        if anchor:
            assert anchor in anchors(target), (page.name, name, anchor)


@pytest.mark.parametrize("name", sorted(rulebook.EXAMPLES))
def test_every_example_of_a_rule_shows_it(name: str) -> None:
    run = rulebook.run_of(name)
    looked = next(row for row in run.rows if row.number == run.number)
    assert rulebook.EXAMPLES[name].row in looked.what
    assert max(map(len, run.picture.splitlines())) <= 80
    assert "\0" not in run.picture


def test_every_rule_of_the_page_has_an_example_and_is_explained_in_its_words() -> None:
    rules = rulebook.rules()
    assert set(rules) == set(rulebook.EXAMPLES), "each rule needs an example"
    assert {*RULES, *BASELINES} <= set(rules), "each rule that records name is in the page"
    page = (ROOT / "docs" / "mediation.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^- \*\*([A-Z]\d+)", page, re.MULTILINE))
    assert named <= set(rules)
    bare = " ".join(re.sub(r"[*`]", "", re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", page)).split())
    for name in sorted(named - {"S2"}):
        assert " ".join(rules[name].text.split()) in bare, name


@pytest.mark.parametrize("name", ["S2", "S2d", "K1", "X1", "none"])
def test_a_rule_is_explained_with_a_picture_and_a_run(name: str, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "documents", tmp_path / "documents")
    code, made = run(["explain", name.lower()], tmp_path)
    assert code == 0 and max(map(len, made)) <= 80
    first = rulebook.rules()[name].text.split("\n")[0]
    assert " ".join(made).startswith(f"{name} (") and first[:40] in " ".join(made)
    assert strip.LEGEND in made
    assert run(shlex.split(made[-1])[1:], tmp_path)[0] == 0
    code, told = run(["explain", name, "--format", "json"], tmp_path)
    data = json.loads("\n".join(told))
    assert data["rule"] == name and data["example"]["commands"] == [made[-1].strip()]


@pytest.mark.parametrize("there", [(), ("documents",), ("documents", "documents-2")])
def test_a_rule_is_tried_by_the_commands_as_they_are_printed(
    tmp_path: Path, there: tuple[str, ...]
) -> None:
    for folder in there:
        (tmp_path / folder).mkdir()
    _, made = run(["explain", "F2"], tmp_path)
    copy, example = made[made.index("Try it:") + 1 :]
    for line in (copy, example):
        assert run(shlex.split(line)[1:], tmp_path)[0] == 0, line
    _, made = run(["explain", "F2"], tmp_path)
    assert made[made.index("Try it:") + 1 :] == [example], "the documents are there now"


def test_a_rule_that_is_not_there_is_told(tmp_path: Path) -> None:
    for words, told in (
        (["F99"], "Rules with F are F1, F2"),
        (["F2", "3"], "F2 is a rule, which has no rows"),
        (["undeclared-varable"], 'Did you mean "undeclared-variable"?'),
        (["qqqq"], "prima explain lists them all"),
    ):
        code, made = run(["explain", *words], tmp_path)
        assert code == 2 and told in " ".join(made), made
    code, made = run(["explain"], tmp_path)
    assert code == 0 and any(line.startswith("F2 ") for line in made)
    assert max(map(len, made)) <= 80


def test_every_code_that_is_used_is_explained_and_the_other_way_round() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "prima").rglob("*.py"))
    for code in diagnoses():
        constant = code.upper().replace("-", "_")
        uses = source.count(f'"{code}"') + len(re.findall(rf"\b{constant}\.(?:at|says)\(", source))
        assert uses > 1, f"nothing uses the code {code}"


# The table of elements and the XML Schema agree --------------------------------

VALID = {
    "duration": ["2s", "500ms", ".5s", "+1.25s", " 3s "],
    "number": ["1", "-1.5", ".5", "2e3", " 7 "],
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
    "number": ["1e999"],
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


@lru_cache
def compiled_schema(name: str) -> etree.XMLSchema:
    """The published schema of that name."""
    return etree.XMLSchema(etree.parse(str(ROOT / "schemas" / f"{name}.xsd")))


def verdicts(vocabulary: Vocabulary, root: etree._Element) -> tuple[bool, list[Problem]]:
    """What the XML Schema and the table say of a document."""
    data = etree.tostring(root, encoding="utf-8")
    node, element = parse("x.xml", data), etree.fromstring(data)
    for one in element.iter():
        if not len(one) and not (one.text or "").strip():
            one.text = None  # white space where nothing may stand is no content
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
@settings(max_examples=400, deadline=None, suppress_health_check=list(HealthCheck))
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
