"""Definitions, references and renaming, across files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from prima.lsp import naming
from prima.lsp.names import NameSpot
from prima.lsp.workspace import Workspace
from tests.helpers.editor import BEGIN, SCENE, VOICE, Editor, cut, edited, plain

FORMS = (
    BEGIN
    + '<form id="a"><block><goto next="#b"/></block></form>\n<form id="|b"><block><goto next="#b"/></block></form></prima>'
)
SCOPES = (
    BEGIN + '<var name="n"/><form id="a"><var name="|n"/><block cond="n &lt; document.n">'
    '<assign name="n" expr="n + dialog.n"/></block></form>\n'
    '<form id="b"><block cond="n"/></form></prima>'
)
SCRIPT = (
    BEGIN + "<script>function twice(x) { return 2 * x; }</script>"
    '<form id="a"><block cond="|twice(1) &gt; 1"/></form></prima>'
)
SHORT = (
    BEGIN + '<var name="|n" expr="1"/><script>const {m, n: o} = {m: {n}}; ({n} = o);'
    ' const {p = n} = m;</script><form id="a"><block cond="{n}.n"/></form></prima>'
)
SHORT_GIVEN = BEGIN + "<script>const {|n} = obj; const {x, y = n} = {x: n, n};</script></prima>"
HELD = (
    BEGIN + '<var name="|n"/><form id="a"><var name="n"/><script>document.n = n; dialog.n = o.n;'
    " var o = {n: document.n};</script></form></prima>"
)
LISTED = (
    BEGIN + '<var name="|n"/><form id="a"><var name="n"/><block><clear namelist="n document.n"/>'
    "</block></form></prima>"
)
LISTED_IN_VOICE = (
    VOICE + '<var name="n"/><form id="a"><var name="|n"/><block><submit next="service:s#a" '
    'namelist="document.n dialog.n"/><exit namelist="application.n n.x"/></block></form></vxml>'
)
RULE = (
    VOICE + '<form id="a"><field name="f"><grammar root="r"><rule id="|r"><item>x</item></rule>'
    '<rule id="s"><ruleref uri="#r"/></rule></grammar></field>'
    '<field name="g"><grammar root="r"><rule id="r"/></grammar></field></form></vxml>'
)
GIVEN = (
    BEGIN + '<form id="g"><block cond="n"/></form><form id="a"><var name="n"/>'
    '<subdialog name="s" src="#g"><param name="|n" expr="n"/></subdialog></form></prima>'
)
GIVEN_IN_VOICE = (
    VOICE
    + plain(GIVEN)[0][len(BEGIN) : -len("</prima>")].replace(
        '<form id="g">', '<form id="g"><var name="|n"/>'
    )
    + "</vxml>"
)

GRAMMAR = (
    '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r">'
    '<rule id="r" scope="public">x</rule></grammar>'
)


@pytest.mark.parametrize(
    ("text", "name", "uses", "renamed"),
    [
        (FORMS, "fa/x.xml", 3, {"#c": 2, 'id="c"': 1}),
        (SCOPES, "fa/x.xml", 5, {'<var name="n"/><form id="a"><var name="c"/>': 1, "document.n": 1, "dialog.c": 1, 'cond="n"': 1}),
        (SCRIPT, "fa/x.xml", 2, {"function c(": 1, "c(1)": 1}),
        (SHORT, "fa/x.xml", 5, {"{m: {n: c}}": 1, "({n: c} = o)": 1, "{m, n: o}": 1, "{p = c}": 1, 'cond="{n: c}.n"': 1}),
        (SHORT_GIVEN, "fa/x.xml", 4, {"const {n: c} = obj; const {x, y = c} = {x: c, n: c};": 1}),
        (HELD, "fa/x.xml", 3, {"document.c = n; dialog.n = o.n; var o = {n: document.c};": 1}),
        (LISTED, "fa/x.xml", 2, {'<var name="c"/><form': 1, '"n document.c"': 1}),
        (LISTED_IN_VOICE, "ea/x.vxml", 3, {'"document.n dialog.c"': 1, '"application.n c.x"': 1}),
        (GIVEN, "fa/x.xml", 2, {'<block cond="c"/>': 1, '<param name="c" expr="n"/>': 1}),
        (GIVEN_IN_VOICE, "ea/x.vxml", 3, {'<var name="c"/><block cond="c"/>': 1, '<param name="c" expr="n"/>': 1}),
        (RULE, "ea/x.vxml", 3, {'root="c"': 1, 'uri="#c"': 1, 'root="r"': 1}),
    ],
    ids=["form", "variable", "function", "property", "pattern", "script", "list", "list of VoiceXML", "param", "param of VoiceXML", "rule"],
)  # fmt: skip
def test_names_of_a_document(
    editor: Editor, text: str, name: str, uses: int, renamed: dict[str, int]
) -> None:
    where = editor.at(name, text)
    text = plain(text)[0]
    context = lsp.ReferenceContext(include_declaration=True)
    found = editor.do(
        editor.client.text_document_references_async(lsp.ReferenceParams(context, *where))
    )
    assert found is not None and len(found) == uses
    defined = editor.do(editor.client.text_document_definition_async(lsp.DefinitionParams(*where)))
    assert isinstance(defined, list) and len(defined) == 1
    lights = editor.do(
        editor.client.text_document_document_highlight_async(lsp.DocumentHighlightParams(*where))
    )
    assert lights is not None and len(lights) == uses
    can = editor.do(
        editor.client.text_document_prepare_rename_async(lsp.PrepareRenameParams(*where))
    )
    assert isinstance(can, lsp.PrepareRenamePlaceholder)
    assert can.placeholder == cut(text, can.range)
    change = editor.do(
        editor.client.text_document_rename_async(lsp.RenameParams(where[0], where[1], "c"))
    )
    editor.close(name)
    assert change is not None and change.changes is not None
    made = edited(text, list(change.changes[editor.uri(name)]))
    for words, count in renamed.items():
        assert made.count(words) == count, (words, made)


def rename(editor: Editor, where: Any, new: str) -> lsp.WorkspaceEdit | None:
    return editor.do(
        editor.client.text_document_rename_async(lsp.RenameParams(where[0], where[1], new))
    )


def test_a_name_that_is_none_or_taken_is_refused(editor: Editor) -> None:
    where = editor.at("fa/x.xml", FORMS)
    for new, why in (("b c", "is not a name"), ("a", "already"), ("", "is not a name")):
        with pytest.raises(JsonRpcException, match=why):
            rename(editor, where, new)
    where = editor.at("fa/x.xml", SCOPES)
    for new, why in (("class", "a word of ECMAScript"), ("a.b", "has a dot")):
        with pytest.raises(JsonRpcException, match=why):
            rename(editor, where, new)
    editor.close("fa/x.xml")


@pytest.mark.parametrize("at", ['name="town', 'expr="town', 'expr="f({to', "dialog.to", 'list="to'])
def test_the_result_of_an_item_is_renamed_with_it(tmp_path: Path, at: str) -> None:
    text = (
        BEGIN
        + """<var name="mine$"/><form id="a"><field name="town"><prompt>Which town?</prompt>
        <option>Rome</option><filled><log expr="town + mine$"/><log expr="f({town$}) + dialog.town$.confidence"/>
        <clear namelist="town mine$"/></filled></field>
        <block><script>var other$ = 1; log(other$, town$)</script></block></form></prima>"""
    )
    workspace = Workspace()
    path = workspace.put((tmp_path / "x.xml").as_uri(), text)
    assert path is not None
    edits, _ = naming.rename(workspace, path, text.index(at) + len(at), "city")
    for edit in reversed(edits):
        text = text[: edit.start] + edit.text + text[edit.end :]
    assert "town" not in text.replace("{town$: city$}", "").replace("Which town?", "")
    uses = ("city + mine$", "f({town$: city$})", "dialog.city$.", '"city mine$"', "other$, city$")
    assert all(use in text for use in uses), text


@pytest.mark.parametrize(
    ("uses", "old", "refused"),
    [
        ('cond="n + m"', "n", True),
        ('cond="n + m"', "m", True),
        ('cond="document.n + m"', "n", False),
        ('cond="document.n + m"', "m", False),
    ],
)
def test_a_variable_is_not_renamed_to_one_that_would_hide_it(
    tmp_path: Path, uses: str, old: str, refused: bool
) -> None:
    text = BEGIN + f'<var name="n"/><form id="a"><var name="m"/><block {uses}/></form></prima>'
    workspace, new = Workspace(), "m" if old == "n" else "n"
    path = workspace.put((tmp_path / "x.xml").as_uri(), text)
    assert path is not None
    where = text.index(f'name="{old}"') + 6
    if not refused:
        assert len(naming.rename(workspace, path, where, new)[0]) == 2
        return
    with pytest.raises(naming.RenameError, match=f'There is a variable "{new}" already'):
        naming.rename(workspace, path, where, new)


@pytest.mark.parametrize(
    ("code", "refused"),
    [
        ("function f(m) { return n * m; }", True),
        ("function f() { var m = 1; return function () { return n; }; }", True),
        ("{ let m = n; }", True),
        ("function f(n) { return n; } function g(m) { return m; } f(n);", False),
        ("function f(m) { return document.n * m; }", False),
    ],
)
@pytest.mark.parametrize("place", ["<script>{}</script>", '<form id="a"><block cond="{}"/></form>'])
def test_a_variable_gets_no_name_that_a_function_hides(
    tmp_path: Path, code: str, refused: bool, place: str
) -> None:
    shown = code if "script" in place else f"(() => {{ {code} }})()"
    text = f'{BEGIN}<var name="n"/>{place.format(shown)}</prima>'
    workspace = Workspace()
    path = workspace.put((tmp_path / "x.xml").as_uri(), text)
    assert path is not None
    where = text.index('name="n"') + 6
    if not refused:
        assert len(naming.rename(workspace, path, where, "m")[0]) == 2
        return
    with pytest.raises(naming.RenameError, match='There is a variable "m" already'):
        naming.rename(workspace, path, where, "m")


def test_a_place_is_renamed_everywhere(editor: Editor) -> None:
    world = (editor.folder / "worlds/office.xml").read_text(encoding="utf-8")
    where = editor.at("worlds/office.xml", world.replace('id="kidode-room"', 'id="|kidode-room"'))
    change = rename(editor, where, "room")
    editor.close("worlds/office.xml")
    assert change is not None and change.changes is not None
    files = {Path(uri).name for uri in change.changes}
    assert files == {"office.xml", "guide.xml", "touched-on-the-way.xml"}
    for uri, edits in change.changes.items():
        text = Path(uri.removeprefix("file://")).read_text(encoding="utf-8")
        assert "kidode-room" in text
        assert "kidode-room" not in edited(text, list(edits))


def test_a_place_is_renamed_alike_from_wherever_it_is_used(editor: Editor) -> None:
    changes = []
    for name in ("worlds/office.xml", "scenarios/follow-alone.xml", "scenarios/navigate-alone.xml"):
        text = (editor.folder / name).read_text(encoding="utf-8")
        where = editor.at(name, text.replace('"entrance"', '"|entrance"', 1))
        changes.append(rename(editor, where, "gate"))
        editor.close(name)
    assert changes[0] is not None and changes[0].changes is not None
    assert len(changes[0].changes) > 5
    assert changes == [changes[0]] * 3


def test_an_application_is_renamed_in_expectations_too(editor: Editor) -> None:
    scene = (
        SCENE + '<application src="../fa/follow.xml" kind="fa"/><robot at="entrance"/>'
        '<when at="1s"><unload application="follow"/><load application="follow"/>'
        '<message to="follow">Hi.</message></when><never ends="follow" reason="exit"/>'
        '<in-order><expect says="Hi" by="follow"/></in-order></scenario>'
    )
    editor.open("scenarios/x.xml", scene)
    text = (editor.folder / "fa/follow.xml").read_text(encoding="utf-8")
    where = editor.at("fa/follow.xml", text.replace('id="follow"', 'id="|follow"'))
    change = rename(editor, where, "pet")
    editor.close("scenarios/x.xml", "fa/follow.xml")
    assert change is not None and change.changes is not None
    made = edited(scene, list(change.changes[editor.uri("scenarios/x.xml")]))
    assert '"follow"' not in made and made.count('"pet"') == 5


def test_definitions_lead_to_other_files(editor: Editor) -> None:
    for name, text, file, words in (
        ("ea/guide.xml", BEGIN + '<form id="a"><block><topological-move to="|kidode-room"/>', "office.xml", "kidode-room"),
        ("fa/dance.xml", BEGIN + '<form id="a"><block><command type="da|nce"/>', "papero-plus.xml", "dance"),
        ("ea/guide.xml", BEGIN + '<form id="a"><on event="touch.|head"/>', "papero.xml", "head"),
        ("scenarios/x.xml", SCENE + '<robot at="entra|nce"/>', "office.xml", "entrance"),
        ("scenarios/x.xml", SCENE + '<application src="../fa/|follow.xml"/>', "follow.xml", ""),
        ("ea/x.vxml", VOICE + '<form id="a"><block><goto next="pizza.vxml#|order"/>', "pizza.vxml", "order"),
    ):  # fmt: skip
        where = editor.at(name, text)
        found = editor.do(
            editor.client.text_document_definition_async(lsp.DefinitionParams(*where))
        )
        editor.close(name)
        assert isinstance(found, list) and found, text
        path = Path(found[0].uri.removeprefix("file://"))
        assert path.name == file
        assert cut(path.read_text(encoding="utf-8"), found[0].range) == words


@pytest.mark.parametrize("begin", [BEGIN, VOICE], ids=["prima", "voicexml"])
def test_a_rule_is_renamed_where_a_document_names_its_file(tmp_path: Path, begin: str) -> None:
    workspace, rules = Workspace(), tmp_path.resolve() / "cities.grxml"
    text = begin + '<form id="a"><field name="f"><grammar src="cities.grxml#r"/></field></form>'
    rules.write_text(GRAMMAR, encoding="utf-8")
    path = workspace.put((rules.parent / "x.xml").as_uri(), text)
    assert path is not None
    where = text.index("#r") + 1
    at = GRAMMAR.index('id="r"') + 4
    assert naming.definitions(workspace, path, where) == [NameSpot(rules, at, at + 1)]
    edits, _ = naming.rename(workspace, rules, at, "k")
    assert edits == naming.rename(workspace, path, where, "k")[0]
    assert naming.NameEdit(path, where, where + 1, "k") in edits and len(edits) == 3


def test_a_variable_of_a_root_is_renamed_in_its_leaves(tmp_path: Path) -> None:
    workspace, folder = Workspace(), tmp_path.resolve()
    leaf = VOICE.replace("<vxml", '<vxml application="root.vxml"')
    texts = {
        "root": VOICE + '<var name="g"/><form><var name="k"/></form></vxml>',
        "leaf": leaf
        + '<var name="j"/><form><var name="f"/><block cond="g + application.g"/></form>',
        "own": leaf + '<var name="g"/><form><block cond="g + application.g + k"/></form>',
        "other": VOICE + '<form><block cond="g + application.g"/></form>',
    }
    paths = {}
    for name, text in texts.items():
        made = workspace.put((folder / f"{name}.vxml").as_uri(), text)
        assert made is not None
        paths[name] = made

    def renamed(name: str, words: str, new: str) -> list[tuple[str, str]]:
        edits, _ = naming.rename(workspace, paths[name], texts[name].index(words), new)
        found = ((one.path.stem, texts[one.path.stem][one.start - 7 : one.end]) for one in edits)
        return sorted(found)

    everywhere = [
        ("leaf", ' cond="g'),
        ("leaf", "cation.g"),
        ("own", "cation.g"),
        ("root", ' name="g'),
    ]
    assert sorted(renamed("root", 'g"/>', "h")) == sorted(everywhere)
    assert renamed("leaf", "g + ", "h") == renamed("own", "g + k", "h") == sorted(everywhere)
    assert renamed("own", 'g"/>', "h") == [("own", ' cond="g'), ("own", ' name="g')]
    at = texts["root"].index('g"/>')
    there = naming.definitions(workspace, paths["leaf"], texts["leaf"].index("g + "))
    assert there == [NameSpot(paths["root"], at, at + 1)]
    assert naming.definitions(workspace, paths["own"], texts["own"].index('k"/>')) == []
    for name, words, new in (
        *(("root", 'g"/>', taken) for taken in "jf"),
        *(("leaf", f'{old}"/>', "g") for old in "jf"),
    ):
        with pytest.raises(naming.RenameError, match=f'a variable "{new}" already'):
            renamed(name, words, new)


def test_files_are_found_and_renamed(editor: Editor) -> None:
    text = SCENE + '<robot at="entrance"/><application src="../fa/fol|low.xml"/></scenario>'
    where = editor.at("scenarios/x.xml", text)
    context = lsp.ReferenceContext(include_declaration=True)
    found = editor.do(
        editor.client.text_document_references_async(lsp.ReferenceParams(context, *where))
    )
    assert found is not None and len(found) > 5
    change = rename(editor, where, "../fa/behind.xml")
    assert change is not None and change.document_changes is not None
    *edits, move = change.document_changes
    assert isinstance(move, lsp.RenameFile)
    assert move.new_uri == editor.uri("fa/behind.xml")
    assert len(edits) == len({one.uri for one in found})
    for new, why in (("../fa/dance.xml", "already"), (" ", '" " is not a file\'s name.')):
        with pytest.raises(JsonRpcException, match=why):
            rename(editor, where, new)
    assert rename(editor, where, "../fa/follow.xml") is None
    editor.close("scenarios/x.xml")


def test_an_editor_that_moves_no_files_is_told_to_do_it_itself(tmp_path: Path) -> None:
    (tmp_path / "w.xml").write_text('<world xmlns="urn:prima:world:1" version="1.0" id="w"/>')
    editor = Editor(tmp_path, lsp.ClientCapabilities())
    where = editor.at("s.xml", SCENE.replace("../worlds/office.xml", "w|.xml") + "</scenario>")
    with pytest.raises(JsonRpcException, match="This editor lets no server move a file"):
        rename(editor, where, "v.xml")
    assert editor.end() == (0, "")
