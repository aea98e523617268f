"""Names of files that follow when an editor moves files and folders."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lsprotocol import types as lsp

from prima.lsp import naming
from prima.lsp.workspace import Workspace
from tests.helpers.editor import SCENE, VOICE, Editor, edited


@pytest.mark.parametrize(
    ("names", "moved"),
    [
        (("it&apos;s.xml", "it%27s.vxml"), ("it&apos;s.xml", "it&apos;s.vxml")),
        (("a &amp; b.xml", "a &amp; b.vxml"), ("a &amp; b.xml", "a &amp; b.vxml")),
        (("50% #1?.xml", "50%25%20%231%3f.vxml"), ("50% #1?.xml", "50%25 %231%3F.vxml")),
        (("a%20b.xml", "a%2520b.vxml"), ("a%20b.xml", "a%2520b.vxml")),
    ],
)
def test_names_of_files_with_signs_are_found_and_written(
    tmp_path: Path, names: tuple[str, str], moved: tuple[str, str]
) -> None:
    workspace = Workspace()
    workspace.folders = [tmp_path]
    scene = SCENE.replace('"', "'") + f"<application src='{names[0]}'/></scenario>"
    (tmp_path / "s.xml").write_text(scene, encoding="utf-8")
    voice = VOICE.replace('"', "'") + f"<form><block><goto next='{names[1]}?x=1#a'/></block></form>"
    (tmp_path / "v.vxml").write_text(voice, encoding="utf-8")
    for name, there, text, says in (
        (names[0], "s.xml", scene, moved[0]),
        (names[1], "v.vxml", voice, moved[1]),
    ):
        offset = text.index(name)
        file = naming.definitions(workspace, tmp_path / there, offset)
        assert file == [], "there is no such file yet"
        target = workspace.target(tmp_path / there, name)
        assert target is not None and target.parent == tmp_path
        target.write_text(voice, encoding="utf-8")
        assert naming.definitions(workspace, tmp_path / there, offset)[0].path == target
        edits = naming.moved(workspace, {target: tmp_path / "sub" / target.name})
        made = [(text[one.start : one.end], one.text) for one in edits
                if one.path == tmp_path / there]  # fmt: skip
        assert made == [(name, f"sub/{says}")]


def test_files_that_the_editor_moves_are_followed(editor: Editor) -> None:
    file = lsp.FileRename(editor.uri("scenarios/follow-alone.xml"), editor.uri("follow-alone.xml"))
    change = editor.do(
        editor.client.workspace_will_rename_files_async(lsp.RenameFilesParams([file]))
    )
    assert change is not None and change.changes is not None
    text = (editor.folder / "scenarios/follow-alone.xml").read_text(encoding="utf-8")
    made = edited(text, list(change.changes[editor.uri("scenarios/follow-alone.xml")]))
    assert 'src="fa/follow.xml"' in made and "../" not in made


def test_files_that_the_editor_moves_at_once_find_each_other(editor: Editor) -> None:
    moves = {
        "scenarios/follow-alone.xml": "more/alone/follow-alone.xml",
        "fa/follow.xml": "more/pet.xml",
        "ea/pizza.vxml": "more/pizza.vxml",
    }
    files = [lsp.FileRename(editor.uri(old), editor.uri(new)) for old, new in moves.items()]
    asked = lsp.RenameFilesParams(files)
    change = editor.do(editor.client.workspace_will_rename_files_async(asked))
    assert change is not None and change.changes is not None
    for name, words in (
        ("scenarios/follow-alone.xml", 'src="../pet.xml"'),
        ("scenarios/pizza-and-follow.xml", 'src="../more/pizza.vxml"'),
        ("scenarios/pizza-and-follow.xml", 'src="../more/pet.xml"'),
    ):
        edits = list(change.changes[editor.uri(name)])
        assert len({str(one.range) for one in edits}) == len(edits), "one edit a place"
        assert words in edited((editor.folder / name).read_text(encoding="utf-8"), edits)


def test_a_grammar_in_abnf_that_the_editor_moves_is_followed(tmp_path: Path) -> None:
    able = lsp.FileOperationClientCapabilities(will_rename=True)
    workspace = lsp.WorkspaceClientCapabilities(file_operations=able)
    editor = Editor(tmp_path.resolve(), lsp.ClientCapabilities(workspace=workspace))
    asked = editor.started.capabilities.workspace
    assert asked and asked.file_operations and asked.file_operations.will_rename
    files, folders = asked.file_operations.will_rename.filters
    assert files.pattern.glob == "**/*.{xml,vxml,grxml,gram,abnf}"
    assert (folders.pattern.glob, folders.pattern.matches) == ("**", "folder")
    text = VOICE + '<form><field name="f"><grammar src="yes.gram#r"/></field></form></vxml>'
    editor.open("x.vxml", text)
    move = lsp.FileRename(editor.uri("yes.gram"), editor.uri("more/yes.gram"))
    change = editor.do(
        editor.client.workspace_will_rename_files_async(lsp.RenameFilesParams([move]))
    )
    assert change is not None and change.changes is not None
    edits = list(change.changes[editor.uri("x.vxml")])
    assert edited(text, edits) == text.replace("yes.gram", "more/yes.gram")
    assert editor.end() == (0, "")


@pytest.mark.parametrize(
    ("moves", "written"),
    [
        ({"a": "b"}, {"a": ["b", "./leaf"], "leaf": ["b"]}),
        ({"a": "sub/b"}, {"a": ["b", "../leaf"], "leaf": ["sub/b"]}),
        ({"a": "sub/a", "leaf": "sub/leaf"}, {}),
        ({"a": "leaf", "leaf": "a"}, {"a": ["leaf", "a"], "leaf": ["leaf"]}),
    ],
)
def test_names_of_files_follow_only_where_they_change(
    tmp_path: Path, moves: dict[str, str], written: dict[str, list[str]]
) -> None:
    workspace, folder = Workspace(), tmp_path.resolve()
    texts = {
        name: VOICE + "<form><block>" + "".join(f'<goto next="{one}.vxml#f"/>' for one in to)
        for name, to in (("a", ["a", "./leaf"]), ("leaf", ["a"]))
    }
    for name, text in texts.items():
        workspace.put((folder / f"{name}.vxml").as_uri(), text)
    files = {folder / f"{old}.vxml": folder / f"{new}.vxml" for old, new in moves.items()}
    edits = sorted(naming.moved(workspace, files), key=_start)[::-1]
    for edit in edits:
        text = texts[edit.path.stem]
        texts[edit.path.stem] = text[: edit.start] + edit.text + text[edit.end :]
    found = {edit.path.stem: texts[edit.path.stem] for edit in edits}
    assert {name: re.findall(r'"(\S+)\.vxml#f"', text) for name, text in found.items()} == written


def test_a_voicexml_application_is_called_by_its_new_file_in_scenarios(tmp_path: Path) -> None:
    workspace, folder = Workspace(), tmp_path.resolve()
    text = (
        SCENE + '<application src="{}"{}/><expect ends="{}"/><never says="Hi." by="{}"/></scenario>'
    )
    for file, given, ends, new in (
        ("pie 1.vxml", "", "pie-1", "cake-2"),
        ("tea.vxml", ' id="tea"', "tea", "tea"),
    ):
        page = workspace.put((folder / file).as_uri(), VOICE + "<form/></vxml>")
        scene = text.format(file, given, ends, ends)
        path = workspace.put((folder / f"{ends}.xml").as_uri(), scene)
        assert page is not None and path is not None
        moves = {page: folder / "cake 2.vxml"}
        for edit in sorted(naming.moved(workspace, moves), key=_start)[::-1]:
            assert edit.path == path
            scene = scene[: edit.start] + edit.text + scene[edit.end :]
        assert scene == text.format("cake 2.vxml", given, new, new)


def test_files_in_a_folder_that_the_editor_moves_are_followed(editor: Editor) -> None:
    """Those of the folder are found by the others, and find the others and each other."""
    move = lsp.FileRename(editor.uri("fa"), editor.uri("more/pets"))
    asked = lsp.RenameFilesParams([move])
    change = editor.do(editor.client.workspace_will_rename_files_async(asked))
    assert change is not None and change.changes is not None
    scene = "scenarios/follow-alone.xml"
    text = (editor.folder / scene).read_text(encoding="utf-8")
    made = edited(text, list(change.changes[editor.uri(scene)]))
    assert made == text.replace('src="../fa/follow.xml"', 'src="../more/pets/follow.xml"') != text
    assert not any(editor.uri("fa") in uri for uri in change.changes), "they name no other files"
    workspace, folder = Workspace(), editor.folder
    main = VOICE + '<form><block><goto next="sub/a.vxml#f"/></block></form></vxml>'
    page = (
        VOICE
        + '<form id="f"><block><goto next="b.vxml"/><goto next="../main.vxml"/></block></form></vxml>'
    )
    for name, text in ("main", main), ("sub/a", page), ("sub/b", page):
        workspace.put((folder / f"{name}.vxml").as_uri(), text)
    edits = naming.moved(workspace, {folder / "sub": folder / "deep/low"})
    assert [(one.path.stem, one.text) for one in edits] == [
        ("main", "deep/low/a.vxml"),
        ("a", "../../main.vxml"),
        ("b", "../../main.vxml"),
    ]


def test_a_file_that_leaves_a_folder_that_moves_goes_its_own_way(tmp_path: Path) -> None:
    workspace, folder = Workspace(), tmp_path.resolve()
    page = (
        VOICE
        + '<form><block><goto next="sub/a.vxml"/><goto next="sub/b.vxml"/></block></form></vxml>'
    )
    workspace.put((folder / "main.vxml").as_uri(), page)
    moves = {folder / "sub": folder / "low", folder / "sub/a.vxml": folder / "top.vxml"}
    for order in (moves, dict(reversed(moves.items()))):
        edits = naming.moved(workspace, order)
        assert [one.text for one in edits] == ["top.vxml", "low/b.vxml"]


def _start(edit: naming.NameEdit) -> int:
    return edit.start
