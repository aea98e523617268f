"""Tables and lists of the documentation are those of the code; its links lead somewhere."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from prima import api
from prima.checks.codes import diagnoses
from prima.errors import UsageError
from prima.interpreter.vocabulary.names import SPEAKING
from prima.markup.vocabulary import Vocabulary
from prima.transcript.phases import PHASES
from prima.transcript.record import FIELDS, model
from tests import ROOT
from tests.helpers.pages import FENCE, NAMESPACES, PAGES
from tools import reference


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
    page = {"dialogue": "language.md", "services": "live.md"}.get(vocabulary.name, "scenarios.md")
    whole = (ROOT / "docs" / page).read_text(encoding="utf-8")
    text = words_of(whole)
    named = {"q-and-a"} | set(SPEAKING.split())  # these have a generated table of their own
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


def test_every_code_that_is_used_is_explained_and_the_other_way_round() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "prima").rglob("*.py"))
    quoted = Counter(re.findall(r'"([a-z0-9-]+)"', source))
    said = Counter(re.findall(r"\b([A-Z0-9_]+)\.(?:at|says)\(", source))
    for code in diagnoses():
        uses = quoted[code] + said[code.upper().replace("-", "_")]
        assert uses > 1, f"nothing uses the code {code}"
