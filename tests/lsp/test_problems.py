"""Problems in an editor: those of prima validate, while a text is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types as lsp

from prima import api
from prima.errors.visible import HARMFUL
from tests.helpers.editor import BEGIN, SCENE, SRGS, VOICE, WRONG, Editor, cut


def shown(problem: Any) -> tuple[int, int, str, str, str]:
    words = f"{problem.message} {problem.remedy}".strip()
    return problem.place.line, problem.place.column, problem.severity, problem.code, words


WORLD = (
    '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="door" x="0" y="0"/></world>'
)
SEVERITIES = {1: "error", 2: "warning", 3: "note"}


@pytest.mark.parametrize("name", WRONG)
def test_problems_are_those_of_prima_validate(editor: Editor, name: str) -> None:
    text = WRONG[name]
    (editor.folder / name).write_text(text, encoding="utf-8")
    expected = [shown(one) for one in api.validate([editor.folder / name])]
    (editor.folder / name).unlink()
    found = []
    for one in editor.open(name, text):
        assert one.source == "prima" and one.severity is not None
        line = text.split("\n")[one.range.start.line] if text else ""
        column = len(line.encode("utf-16-le")[: 2 * one.range.start.character].decode("utf-16-le"))
        found.append(
            (one.range.start.line + 1, column + 1, SEVERITIES[one.severity], one.code, one.message)
        )
    editor.close(name)
    if name != "fa/empty.xml":  # that is not yet anything
        assert found == expected and expected


@pytest.mark.parametrize(
    "name",
    ["fa/follow.xml", "ea/museum.xml", "ea/pizza.vxml", "robots/papero.xml", "worlds/home.xml"],
)
def test_good_documents_have_no_errors(editor: Editor, name: str) -> None:
    assert not [one for one in editor.open(name) if one.severity == 1]
    editor.close(name)


@pytest.mark.parametrize("before", ["<!-- A robot. --\n", '<?xml version="1.0"?\n', "<![CDATA["])
def test_what_never_ends_before_the_root_is_told(editor: Editor, before: str) -> None:
    text = f"{before}{BEGIN}</prima>"
    assert [one.code for one in editor.open("fa/x.xml", text)] == ["not-xml"]
    editor.close("fa/x.xml")


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        (BEGIN.removeprefix("<") + "<form/></prima>", ["not-xml"]),
        ('<world xmlns="urn:pima:world:1" version="1.0" id="w"/>', ["wrong-namespace"]),
        ('<grammar xmlns="http://www.w3.org/2001/6/grammar" version="1.0"/>', ["wrong-root"]),
        ('<grammar xmlns="http://www.w3.org/1999/xhtml"/>', []),
        ('<robot xmlns="urn:acme:arm" name="r"/>', []),
        ('<catalog><of name="urn:prima:dialogue"/></catalog>', []),
    ],
)
def test_a_document_is_known_by_its_namespace_though_its_root_is_broken(
    editor: Editor, text: str, codes: list[str]
) -> None:
    assert [one.code for one in editor.open("fa/x.xml", text)] == codes
    editor.close("fa/x.xml")


def test_a_byte_order_mark_is_no_letter_of_the_document(editor: Editor) -> None:
    text = BEGIN.replace("kind", "kin") + '<form id="a"><block><exit/></block></form></prima>'
    for mark in ("", "\ufeff"):
        problems = editor.open("fa/x.xml", mark + text)
        assert cut(mark + text, problems[0].range) == "kin"
        editor.close("fa/x.xml")


def test_a_list_of_problems_stops_in_the_editor_too(editor: Editor) -> None:
    bad = "".join(f'  <place id="p{index}" x="zero" y="0"/>\n' for index in range(1_234))
    text = f'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n{bad}</world>\n'
    found = editor.open("worlds/many.xml", text)
    editor.close("worlds/many.xml")
    assert len(found) == 1_001 and "And 234 more problems" in found[-1].message


def test_what_a_document_says_reaches_the_editor_as_text_and_as_nothing_else(
    editor: Editor,
) -> None:
    name = "\u202e\u2066\x9b31m\u200fabc"
    text = BEGIN + (
        f'<form id="{name}"><var name="{name}"/><block><goto next="#{name}x"/></block>'
        '<block cond="abc\u061cd"><exit/></block></form></prima>'
    )
    problems = editor.open("fa/x.xml", text)
    document = lsp.TextDocumentIdentifier(editor.uri("fa/x.xml"))
    whole = lsp.Range(lsp.Position(0, 0), lsp.Position(9, 0))
    actions = editor.do(
        editor.client.text_document_code_action_async(
            lsp.CodeActionParams(document, whole, lsp.CodeActionContext(problems))
        )
    )
    symbols = editor.do(
        editor.client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
    )
    found = editor.do(
        editor.client.text_document_completion_async(
            lsp.CompletionParams(
                document, lsp.Position(1, text.splitlines()[1].index("#\u202e") + 1)
            )
        )
    )
    editor.close("fa/x.xml")
    assert isinstance(found, lsp.CompletionList)
    shown = [one.message for one in problems] + [one.title for one in actions or ()]
    shown += [one.name for one in symbols or ()]
    shown += [one.label for one in found.items]
    assert sum("\ufffd" in one for one in shown) > 4, shown
    assert not [one for one in shown if HARMFUL.search(one)]


def test_columns_count_utf16_units(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><speak>😀😀</speak><goto next="#b"/></block></form></prima>'
    (found,) = [one for one in editor.open("fa/x.xml", text) if one.code == "no-such-form"]
    assert cut(text, found.range) == "#b"
    editor.close("fa/x.xml")


@pytest.mark.parametrize(
    ("encoding", "column"),
    [(lsp.PositionEncodingKind.Utf8, 8), (lsp.PositionEncodingKind.Utf32, 2)],
)
def test_an_editor_may_count_columns_otherwise(
    tmp_path: Path, encoding: lsp.PositionEncodingKind, column: int
) -> None:
    general = lsp.GeneralClientCapabilities(position_encodings=[encoding])
    editor = Editor(tmp_path, lsp.ClientCapabilities(general=general))
    text = (
        BEGIN + '<form id="a"><block><speak>\n😀😀<goto next="#b"/></speak></block></form></prima>'
    )
    problems = editor.open("x.xml", text)
    assert column in [one.range.start.character for one in problems if one.range.start.line == 2]
    assert editor.end() == (0, "")


def test_what_is_written_counts_at_once(editor: Editor) -> None:
    good = BEGIN + '<form id="a"><block><speak>Hello.</speak><exit/></block></form></prima>'
    assert editor.open("fa/x.xml", good) == []
    assert [one.code for one in editor.change("fa/x.xml", good.replace("speak", "speek"))] == [
        "unknown-element"
    ]
    assert editor.change("fa/x.xml", good) == []
    editor.close("fa/x.xml")


def test_unsaved_text_counts_for_files_that_a_scenario_names(editor: Editor) -> None:
    scene = "scenarios/touched-on-the-way.xml"
    world = (editor.folder / "worlds/office.xml").read_text(encoding="utf-8")
    assert not [one for one in editor.open(scene) if one.severity == 1]
    editor.open("worlds/office.xml", world)
    editor.change("worlds/office.xml", world.replace('"entrance"', '"entry"'))
    editor.until(scene, "no-such-name")
    editor.close("worlds/office.xml")
    editor.until(scene, "no-such-name", there=False)
    editor.close(scene)


def test_unsaved_text_counts_for_dialogs_and_grammars_that_an_application_names(
    editor: Editor,
) -> None:
    whole = VOICE + '<form id="a"><block><exit/></block></form></vxml>'
    rules = (
        '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" root="r" xml:lang="en">\n'
        '<rule id="r" scope="public">yes</rule></grammar>'
    )
    (editor.folder / "ea" / "leaf.vxml").write_text(whole, encoding="utf-8")
    (editor.folder / "ea" / "rules.grxml").write_text(rules, encoding="utf-8")
    (editor.folder / "ea" / "more.grxml").write_text(rules, encoding="utf-8")
    editor.open(
        "ea/first.vxml",
        VOICE
        + """<form id="m">
      <field name="x"><grammar src="rules.grxml" type="application/srgs+xml"/></field>
      <block><goto next="leaf.vxml#a"/></block></form></vxml>""",
    )
    editor.open("ea/leaf.vxml", whole.replace('"a"', '"b"'))
    editor.until("ea/first.vxml", "no-such-form")
    editor.close("ea/leaf.vxml")
    editor.until("ea/first.vxml", "no-such-form", there=False)
    editor.open("ea/rules.grxml", rules.replace("yes", '<ruleref uri="more.grxml#r"/>'))
    editor.open("ea/more.grxml", rules)
    editor.change("ea/more.grxml", rules.replace('"r"', '"q"'))
    editor.until("ea/rules.grxml", "no-such-rule")
    editor.close("ea/rules.grxml", "ea/more.grxml", "ea/first.vxml")


def test_a_file_that_is_not_saved_yet_is_there(editor: Editor) -> None:
    first = (
        VOICE
        + """<form id="m">
      <field name="x"><grammar src="fresh.grxml" type="application/srgs+xml"/></field>
      <block><goto next="fresh.vxml#a"/></block></form></vxml>"""
    )
    codes = [one.code for one in editor.open("ea/first.vxml", first)]
    assert codes.count("no-such-file") == 2
    editor.open("ea/fresh.vxml", VOICE + '<form id="b"><block><exit/></block></form></vxml>')
    editor.open("ea/fresh.grxml", SRGS + '<rule id="r">yes</rule></grammar>')
    editor.until("ea/first.vxml", "no-such-file", there=False)
    editor.until("ea/first.vxml", "no-such-form")
    editor.close("ea/fresh.vxml", "ea/fresh.grxml")
    editor.until("ea/first.vxml", "no-such-file")
    editor.close("ea/first.vxml")


def test_problems_of_a_file_that_is_not_open_stand_with_it(editor: Editor) -> None:
    broken = editor.folder / "fa" / "broken.xml"
    broken.write_text(WRONG["fa/names.xml"], encoding="utf-8")
    text = SCENE + '<robot at="entrance"/><application src="../fa/broken.xml"/></scenario>'
    editor.open("scenarios/x.xml", text)
    editor.until("fa/broken.xml", "no-such-form")
    editor.close("scenarios/x.xml")
    editor.until("fa/broken.xml", "no-such-form", there=False)
    broken.unlink()


def test_files_and_folders_that_change_are_seen_at_once(tmp_path: Path) -> None:
    watching = lsp.DidChangeWatchedFilesClientCapabilities(dynamic_registration=True)
    able = lsp.WorkspaceClientCapabilities(did_change_watched_files=watching)
    home, other = tmp_path / "home", tmp_path / "other"
    for folder in (home, other):
        folder.mkdir()
        (folder / "w.xml").write_text(WORLD, encoding="utf-8")
    editor = Editor(home, lsp.ClientCapabilities(workspace=able))
    scene = '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="|w.xml"><robot at="door"/>'
    assert editor.proposals("s.xml", scene).keys() == {"w.xml"}
    (home / "new.xml").write_text(WORLD, encoding="utf-8")
    saved = lsp.TextDocumentIdentifier(editor.uri("new.xml"))
    editor.client.text_document_did_save(lsp.DidSaveTextDocumentParams(saved))
    assert editor.proposals("s.xml", scene).keys() == {"w.xml", "new.xml"}
    folders = [lsp.WorkspaceFolder(one.as_uri(), one.name) for one in (home, other)]
    event = lsp.WorkspaceFoldersChangeEvent(added=folders, removed=[])
    editor.client.workspace_did_change_workspace_folders(lsp.DidChangeWorkspaceFoldersParams(event))
    assert editor.proposals("s.xml", scene).keys() == {"w.xml", "new.xml", "../other/w.xml"}
    whole = scene.replace("|", "") + "</scenario>"
    assert "no-such-name" not in [one.code for one in editor.open("s.xml", whole)]
    (home / "w.xml").write_text(WORLD.replace("door", "gate"), encoding="utf-8")
    change = lsp.FileEvent(editor.uri("w.xml"), lsp.FileChangeType.Changed)
    editor.client.workspace_did_change_watched_files(lsp.DidChangeWatchedFilesParams([change]))
    editor.until("s.xml", "no-such-name")
    kinds = [f"**/*.{kind}" for kind in ("xml", "vxml", "grxml", "gram", "abnf")]
    assert editor.watched == [*kinds, "**/prima.toml"], "as prima validate --watch does"
    assert editor.end() == (0, "")


def test_a_file_open_by_two_names_stays_open_until_both_are_closed(tmp_path: Path) -> None:
    editor = Editor(tmp_path.resolve(), lsp.ClientCapabilities())
    good = BEGIN + '<form id="a"><block><exit/></block></form></prima>'
    (tmp_path / "x.xml").write_text(good, encoding="utf-8")
    (tmp_path / "link.xml").symlink_to(tmp_path / "x.xml")
    assert editor.open("x.xml", good) == editor.open("link.xml", good) == []
    bad = good.replace("exit", "exi")
    assert editor.change("link.xml", bad)
    editor.close("link.xml")
    editor.until("link.xml", "unknown-element", there=False)
    assert editor.problems("x.xml") == [], "its text is the one that the editor shows"
    assert editor.change("x.xml", bad)
    editor.close("x.xml")
    assert editor.end() == (0, "")


def test_a_file_outside_of_the_workspace_finds_its_neighbours_at_once(tmp_path: Path) -> None:
    home, other = tmp_path / "home", tmp_path / "far" / "other"
    for folder in (home, other):
        folder.mkdir(parents=True)
        (folder / "w.xml").write_text(WORLD, encoding="utf-8")
    editor = Editor(home, lsp.ClientCapabilities())
    scene = '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="|"/>'
    assert editor.proposals("s.xml", scene).keys() == {"w.xml"}
    assert editor.proposals("../far/other/s.xml", scene).keys() == {"w.xml", "../../home/w.xml"}
    removed = [lsp.WorkspaceFolder(home.as_uri(), "home")]
    event = lsp.WorkspaceFoldersChangeEvent(added=[], removed=removed)
    editor.client.workspace_did_change_workspace_folders(lsp.DidChangeWorkspaceFoldersParams(event))
    assert editor.proposals("../far/other/s.xml", scene).keys() == {"w.xml"}
    assert editor.end() == (0, "")


def test_xml_of_other_people_is_left_alone(editor: Editor) -> None:
    assert (
        editor.open("pom.xml", '<project xmlns="http://maven.apache.org/POM/4.0.0"><a></project>')
        == []
    )
    assert editor.open("page.xml", "<html><body>") == []
    editor.close("pom.xml", "page.xml")
