"""Schemas as editors use them: catalogues, locating rules, and the verdicts of their validators."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from lxml import etree

from prima import api, loading
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from tests import ROOT
from tests.helpers.here import prima
from tools.reference import VOCABULARIES, voicexml
from tools.rnc import make_rnc

SCHEMAS = ROOT / "schemas"
DOCUMENTS = sorted([*ROOT.glob("documents/**/*.xml"), *ROOT.glob("documents/**/*.vxml")])
CATALOG = "{urn:oasis:names:tc:entity:xmlns:xml:catalog}"
RULES = "{http://thaiopensource.com/ns/locating-rules/1.0}"
KINDS = (*VOCABULARIES, voicexml())
BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">'
SCENE = '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="x" world="w" robot="r">'
VOICE = '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1"'
P = ' xmlns:p="urn:prima:dialogue:1"'
WRONG = {
    "element": f'{BEGIN}<form id="a"><blok/></form></prima>',
    "misplaced": f"{BEGIN}<block/></prima>",
    "attribute": f'{BEGIN}<form id="a" colour="red"/></prima>',
    "missing": f"{BEGIN}<form/></prima>",
    "choice": f'{BEGIN.replace("fa", "xa")}<form id="a"/></prima>',
    "kind": f'{SCENE}<when at="soon"/></scenario>',
    "text": f"{SCENE}words</scenario>",
    "voice": f'{VOICE}><form id="a"><block><gotto next="#a"/></block></form></vxml>',
    "voice-value": f'{VOICE}><form id="a"><block><prompt bargein="maybe"/></block></form></vxml>',
    "voice-unit": f'{VOICE}{P}><form id="a"><p:iu longer="2s"><block/></p:iu></form></vxml>',
    "voice-time": f'{VOICE}{P}><form id="a"><p:iu longest="2"><block/></p:iu></form></vxml>',
    "voice-par": f'{VOICE}{P}><form id="a"><block><p:par at="1s"/></block></form></vxml>',
    "voice-turn": f'{VOICE}{P}><form id="a"><block><p:turn angel="1"/></block></form></vxml>',
}
"""Documents with one mistake each that every schema language can tell."""
RIGHT = {
    "either": f'{BEGIN}<form id="a"><block><throw event-expr="x"/></block></form></prima>',
    "location": BEGIN.replace(
        ">",
        ' xml:lang="en" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xsi:schemaLocation="urn:prima:dialogue:1 dialogue.xsd">',
    )
    + '<form id="a"><block><exit/></block></form></prima>',
    "voice": f'{VOICE} xmlns:p="urn:prima:dialogue:1" xml:lang="en"><form id="a"><block>'
    '<p:point-by-hand angle="30"/>Hello.<goto next="#a"/></block><field name="f">'
    '<grammar version="1.0" root="r"><rule id="r"><one-of><item>yes</item></one-of></rule>'
    "</grammar></field></form></vxml>",
    "voice-unit": f'{VOICE}{P}><form id="a"><p:iu longest="20s" name="u" cond="x"><block>Hi.'
    '<p:par><p:speak>You <value expr="x"/></p:speak><p:seq><p:turn angle-expr="1"/></p:seq>'
    '</p:par><p:command type="hum"><param name="a" value="1"/></p:command></block>'
    '<field name="f" type="boolean"/><noinput>Hm?</noinput></p:iu></form></vxml>',
}


def schema_of(root: etree._Element) -> Path:
    """The XML Schema that the catalogue gives for a document."""
    namespace = etree.QName(root).namespace
    for entry in etree.parse(str(SCHEMAS / "catalog.xml")).getroot():
        if entry.tag == f"{CATALOG}uri" and entry.get("name") == namespace:
            return SCHEMAS / str(entry.get("uri"))
    raise AssertionError(f"the catalogue has no schema for {namespace}")


def test_every_kind_of_document_is_in_the_catalogue_and_the_locating_rules() -> None:
    entries = etree.parse(str(SCHEMAS / "catalog.xml")).getroot().findall(f"{CATALOG}uri")
    rules = etree.parse(str(SCHEMAS / "schemas.xml")).getroot().findall(f"{RULES}namespace")
    spaces = {one.namespace for one in KINDS}
    assert {one.get("name") for one in entries} == spaces
    assert {one.get("ns") for one in rules} == spaces
    for one in (*entries, *rules):
        assert (SCHEMAS / str(one.get("uri"))).is_file()


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_documents_are_valid_by_their_schema(path: Path) -> None:
    root = etree.parse(str(path))
    schema = etree.XMLSchema(etree.parse(str(schema_of(root.getroot()))))
    assert schema.validate(root), schema.error_log


@pytest.mark.parametrize("name", [*RIGHT, *WRONG])
def test_the_xml_schema_tells_right_from_wrong(name: str) -> None:
    root = etree.fromstring(RIGHT.get(name, WRONG.get(name, "")))
    schema = etree.XMLSchema(etree.parse(str(schema_of(root))))
    assert schema.validate(root) == (name in RIGHT), schema.error_log


def test_a_document_may_name_its_schema(tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    path.write_text(RIGHT["location"], encoding="utf-8")
    assert api.validate([path]) == []


def test_xmllint_finds_schemas_by_the_catalogue() -> None:
    xmllint = shutil.which("xmllint")
    if xmllint is None:
        pytest.skip("xmllint is not here")
    for folder, kind in (("fa", "dialogue"), ("worlds", "world"), ("robots", "robot")):
        files = [str(path) for path in DOCUMENTS if path.parent.name == folder]
        done = subprocess.run(
            [xmllint, "--nonet", "--noout", "--schema", f"urn:prima:{kind}:1", *files],
            env={**os.environ, "XML_CATALOG_FILES": (SCHEMAS / "catalog.xml").as_uri()},
            capture_output=True,
            encoding="utf-8",
        )
        assert files and done.returncode == 0, done.stderr


EMACS = """
(require 'nxml-mode) (require 'rng-valid) (require 'rng-loc)
(setq rng-schema-locating-files (list (expand-file-name "schemas.xml" (getenv "SCHEMAS"))))
(dolist (file command-line-args-left)
  (with-current-buffer (find-file-noselect file)
    (nxml-mode)
    (rng-validate-mode 1)
    (rng-auto-set-schema t)
    (while (rng-do-some-validation (lambda () t)))
    (princ (format "%s %s %d\\n" file
                   (file-name-nondirectory rng-current-schema-file-name) rng-error-count))))
(setq command-line-args-left nil)
"""


def test_emacs_tells_right_from_wrong(tmp_path: Path) -> None:
    emacs = shutil.which("emacs")
    if emacs is None:
        pytest.skip("Emacs is not here")
    script = tmp_path / "check.el"
    script.write_text(EMACS, encoding="utf-8")
    made = {tmp_path / f"right-{name}.xml": text for name, text in RIGHT.items()}
    made |= {tmp_path / f"wrong-{name}.xml": text for name, text in WRONG.items()}
    for path, text in made.items():
        path.write_text(text, encoding="utf-8")
    done = subprocess.run(
        [emacs, "--batch", "-Q", "-l", str(script), *map(str, [*DOCUMENTS, *made])],
        env={**os.environ, "SCHEMAS": str(SCHEMAS)},
        capture_output=True,
        encoding="utf-8",
        timeout=300,
    )
    lines = [
        line.split(" ") for line in done.stdout.splitlines() if line.endswith(tuple("0123456789"))
    ]
    found = {Path(line[0]): (line[1], int(line[2])) for line in lines if len(line) == 3}
    assert len(found) == len(DOCUMENTS) + len(made), done.stderr
    for path, (schema, errors) in found.items():
        assert schema.endswith(".rnc"), path
        assert (errors > 0) == path.name.startswith("wrong-"), (path.name, errors)


def test_relax_ng_says_what_the_table_says() -> None:
    text = make_rnc(DIALOGUE)
    for element in DIALOGUE.elements.values():
        assert f"\ne-{element.key} =\n  element {element.tag} {{" in text
    assert "(attribute event { kind-event } | attribute event-expr { kind-expression })" in text


PAGE = (ROOT / "docs" / "editors.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    """The examples of the page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


def test_settings_of_the_page_are_json_and_name_what_is_there() -> None:
    package, made = map(json.loads, blocks("json"))
    assert package["main"] == "extension.js"
    assert [Path(name).name for name in made["xml.catalogs"]] == ["catalog.xml"]


def test_javascript_of_the_page_is_javascript(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not here")
    (text,) = blocks("js")
    (tmp_path / "extension.js").write_text(text, encoding="utf-8")
    subprocess.run([node, "--check", "extension.js"], cwd=tmp_path, check=True)


def test_emacs_lisp_of_the_page_finds_the_schemas(tmp_path: Path) -> None:
    emacs = shutil.which("emacs")
    if emacs is None:
        pytest.skip("Emacs is not here")
    _, setting = blocks("elisp")
    script = tmp_path / "check.el"
    found = "(setq rng-schema-locating-files (list"
    begin, _, rest = EMACS.partition(found)
    assert rest
    script.write_text(setting + begin + rest.partition("\n")[2], encoding="utf-8")
    shutil.copytree(SCHEMAS, tmp_path / "schemas")
    (tmp_path / "x.xml").write_text(WRONG["element"], encoding="utf-8")
    done = subprocess.run(
        [emacs, "--batch", "-Q", "-l", str(script), "x.xml"],
        cwd=tmp_path,
        capture_output=True,
        encoding="utf-8",
        timeout=120,
    )
    assert "x.xml dialogue.rnc 1" in done.stdout, done.stderr


def test_the_command_copies_the_schemas(tmp_path: Path) -> None:
    done = prima("schemas", "schemas", cwd=tmp_path)
    assert done.returncode == 0 and not done.stdout
    assert sorted(p.name for p in (tmp_path / "schemas").iterdir()) == sorted(
        p.name for p in SCHEMAS.iterdir()
    )
    again = prima("schemas", "schemas", cwd=tmp_path)
    assert again.returncode == 2
    assert again.stderr == "prima: schemas: already exists; name a new folder.\n"
    far = prima("schemas", "x.xml/schemas", cwd=tmp_path)
    assert far.returncode in (0, 2) and "Traceback" not in far.stderr
    (tmp_path / "file").write_text("", encoding="utf-8")
    wrong = prima("schemas", "file/schemas", cwd=tmp_path)
    assert wrong.returncode == 2 and "cannot be written" in wrong.stderr


def test_the_package_has_the_schemas() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert '"schemas" = "prima/schemas"' in text
    assert (loading.schemas_folder() / "catalog.xml").is_file()
