"""The language server as an editor meets it: over stdio, with texts that are being written."""

from __future__ import annotations

import asyncio
import json
import pty
import shutil
import subprocess
import sys
from collections.abc import Coroutine, Iterator
from pathlib import Path
from typing import Any, TypeVar

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

from prima import api
from prima.errors.visible import HARMFUL
from prima.lsp import naming, server
from prima.lsp.complete import complete
from prima.lsp.descriptions import RULES, VOICEXML_ATTRIBUTES
from prima.lsp.fixes import fixes
from prima.lsp.hover import hover
from prima.lsp.names import marks
from prima.lsp.outline import links, outline
from prima.lsp.problems import check, spots
from prima.lsp.protocol import Server
from prima.lsp.scan import Page
from prima.lsp.tables import VOCABULARIES, resolve
from prima.lsp.text import UTF8, UTF16, UTF32, Lines
from prima.lsp.workspace import Workspace, path_of

ROOT = Path(__file__).parent.parent
BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">\n'
VOICE = '<vxml xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1" version="2.1">\n'
SCENE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
    ' world="../worlds/office.xml" robot="../robots/papero-plus.xml">\n'
)
SECONDS = 60
Result = TypeVar("Result")


def plain(text: str) -> tuple[str, int]:
    """A text without its mark ``|``, and where the mark stood."""
    offset = text.index("|")
    return text[:offset] + text[offset + 1 :], offset


def position(text: str, offset: int) -> lsp.Position:
    """A position as the protocol has it: UTF-16 columns, counted here by another way."""
    before = text[:offset]
    line = before.rpartition("\n")[2]
    return lsp.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)


def cut(text: str, place: lsp.Range) -> str:
    """What stands in a range."""
    lines = [line.encode("utf-16-le") for line in text.split("\n")]
    first, last = place.start, place.end
    if first.line == last.line:
        return lines[first.line][2 * first.character : 2 * last.character].decode("utf-16-le")
    raise AssertionError("a range of several lines")


def edited(text: str, edits: list[Any]) -> str:
    """A text with edits in it."""
    lines = Lines(text)
    for edit in sorted(edits, key=lambda e: (e.range.start.line, e.range.start.character))[::-1]:
        start = lines.offset(edit.range.start.line, edit.range.start.character)
        end = lines.offset(edit.range.end.line, edit.range.end.character)
        text = text[:start] + edit.new_text + text[end:]
    return text


class Editor:
    """An editor with a workspace: the demo documents."""

    def __init__(self, folder: Path, capabilities: lsp.ClientCapabilities) -> None:
        self.folder = folder
        self.loop = asyncio.new_event_loop()
        self.client = LanguageClient("test", "1")
        self.told: dict[str, list[lsp.PublishDiagnosticsParams]] = {}
        self.versions: dict[str, int] = {}

        def published(params: lsp.PublishDiagnosticsParams) -> None:
            self.told.setdefault(params.uri, []).append(params)

        self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(published)

        self.do(self.client.start_io(sys.executable, "-m", "prima", "lsp", "--stdio"))
        self.started = self.do(
            self.client.initialize_async(
                lsp.InitializeParams(capabilities=capabilities, root_uri=folder.as_uri())
            )
        )
        self.client.initialized(lsp.InitializedParams())

    def do(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Let the loop run until something is done."""
        return self.loop.run_until_complete(asyncio.wait_for(work, SECONDS))

    def end(self) -> tuple[int | None, str]:
        """Shut the server down; its exit code and what it has said on stderr."""
        self.do(self.client.shutdown_async(None))
        self.client.exit(None)
        process = self.client._server
        assert process is not None and process.stderr is not None
        said = self.do(process.stderr.read())
        code = self.do(process.wait())
        self.do(self.client.stop())  # type: ignore[no-untyped-call]
        self.loop.close()
        return code, said.decode()

    def uri(self, name: str) -> str:
        return (self.folder / name).as_uri()

    def open(self, name: str, text: str | None = None) -> list[lsp.Diagnostic]:
        """Open a document, with a text that need not be the file's; its problems."""
        text = (self.folder / name).read_text(encoding="utf-8") if text is None else text
        uri = self.uri(name)
        self.versions[uri] = 1
        self.told.pop(uri, None)
        item = lsp.TextDocumentItem(uri, "xml", 1, text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        return self.problems(name)

    def change(self, name: str, text: str) -> list[lsp.Diagnostic]:
        """Write something else into an open document; its problems then."""
        uri = self.uri(name)
        self.versions[uri] += 1
        self.told.pop(uri, None)
        self.client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(uri=uri, version=self.versions[uri]),
                [lsp.TextDocumentContentChangeWholeDocument(text=text)],
            )
        )
        return self.problems(name)

    def problems(self, name: str) -> list[lsp.Diagnostic]:
        """The problems of a document, once its newest version has been looked through."""
        uri = self.uri(name)

        async def wait() -> list[lsp.Diagnostic]:
            while True:
                for told in reversed(self.told.get(uri, [])):
                    if told.version == self.versions.get(uri):
                        return list(told.diagnostics)
                await asyncio.sleep(0.01)

        return self.do(wait())

    def until(self, name: str, code: str, there: bool = True) -> None:
        """Wait until a document has a problem, or has it no longer."""

        async def wait() -> None:
            while True:
                told = self.told.get(self.uri(name), [])
                if told and (code in [one.code for one in told[-1].diagnostics]) == there:
                    return
                await asyncio.sleep(0.01)

        self.do(wait())

    def close(self, *names: str) -> None:
        for name in names:
            identifier = lsp.TextDocumentIdentifier(self.uri(name))
            self.client.text_document_did_close(lsp.DidCloseTextDocumentParams(identifier))
            self.versions.pop(self.uri(name), None)

    def at(self, name: str, text: str) -> tuple[lsp.TextDocumentIdentifier, lsp.Position]:
        """Open a document at its mark."""
        text, offset = plain(text)
        self.open(name, text)
        return lsp.TextDocumentIdentifier(self.uri(name)), position(text, offset)

    def proposals(self, name: str, text: str, typed: str = "") -> dict[str, lsp.CompletionItem]:
        """What may be written at a document's mark."""
        where = self.at(name, text)
        context = (
            lsp.CompletionContext(lsp.CompletionTriggerKind.TriggerCharacter, typed)
            if typed
            else None
        )
        found = self.do(
            self.client.text_document_completion_async(lsp.CompletionParams(*where, context))
        )
        self.close(name)
        assert isinstance(found, lsp.CompletionList)
        return {item.label: item for item in found.items}

    def places(self, found: Any) -> list[tuple[str, str]]:
        """Locations as the file's name and what stands there."""
        made = []
        for one in found or []:
            path = Path(one.uri.removeprefix("file://"))
            made.append((path.name, one.range))
        return made


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    folder = tmp_path_factory.mktemp("space").resolve() / "documents"
    shutil.copytree(ROOT / "documents", folder)
    item = lsp.ClientCompletionItemOptions(snippet_support=True)
    edits = lsp.WorkspaceEditClientCapabilities(
        document_changes=True, resource_operations=[lsp.ResourceOperationKind.Rename]
    )
    made = Editor(
        folder,
        lsp.ClientCapabilities(
            workspace=lsp.WorkspaceClientCapabilities(workspace_edit=edits),
            text_document=lsp.TextDocumentClientCapabilities(
                completion=lsp.CompletionClientCapabilities(completion_item=item)
            ),
        ),
    )
    yield made
    code, said = made.end()
    assert (code, said) == (0, "")


# Problems --------------------------------------------------------------------------------

WRONG = {
    "fa/element.xml": BEGIN + '<form id="a"><block><speek>Hello.</speek></block></form></prima>',
    "fa/names.xml": BEGIN + '<form id="a"><block><goto next="#b"/></block></form></prima>',
    "fa/cut.xml": BEGIN + '<form id="a"><block><speak>Hel',
    "fa/quote.xml": BEGIN + '<form id="a"><block><goto next="#a/></block></form></prima>',
    "fa/empty.xml": "",
    "fa/variables.xml": BEGIN
    + '<form id="a"><block cond="n &lt; 2 &amp;&amp; 日本"><exit/></block></form></prima>',
    "ea/voice.vxml": VOICE + '<form id="a"><block><goto/><var name="1 +"/></block></form></vxml>',
    "scenarios/scene.xml": SCENE
    + '<robot at="nowhere"/><application src="../fa/no.xml"/></scenario>',
    "worlds/place.xml": '<world xmlns="urn:prima:world:1" version="1.0" id="w">\n'
    '<place id="a" x="1" y="far"/><way from="a" to="b"/></world>',
}


def shown(problem: Any) -> tuple[int, int, str, str, str]:
    words = f"{problem.message} {problem.remedy}".strip()
    return problem.place.line, problem.place.column, problem.severity, problem.code, words


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


def test_problems_of_a_file_that_is_not_open_stand_with_it(editor: Editor) -> None:
    broken = editor.folder / "fa" / "broken.xml"
    broken.write_text(WRONG["fa/names.xml"], encoding="utf-8")
    text = SCENE + '<robot at="entrance"/><application src="../fa/broken.xml"/></scenario>'
    editor.open("scenarios/x.xml", text)
    editor.until("fa/broken.xml", "no-such-form")
    editor.close("scenarios/x.xml")
    editor.until("fa/broken.xml", "no-such-form", there=False)
    broken.unlink()


def test_xml_of_other_people_is_left_alone(editor: Editor) -> None:
    assert (
        editor.open("pom.xml", '<project xmlns="http://maven.apache.org/POM/4.0.0"><a></project>')
        == []
    )
    assert editor.open("page.xml", "<html><body>") == []
    editor.close("pom.xml", "page.xml")


# Completion ------------------------------------------------------------------------------

PROPOSED = {
    "document": ("fa/x.xml", "|", {"prima", "vxml", "scenario", "world", "robot"}, {"form"}),
    "root": ("fa/x.xml", "<|", {"prima", "vxml"}, {"form"}),
    "form": ("fa/x.xml", BEGIN + "<|", {"form", "on", "/prima"}, {"block", "speak"}),
    "in a name": ("fa/x.xml", BEGIN + '<form id="a"><block><spe|</block>', {"speak"}, {"field"}),
    "between": ("fa/x.xml", BEGIN + '<form id="a"><block>|</block>', {"speak", "goto"}, {"field"}),
    "end tag": ("fa/x.xml", BEGIN + '<form id="a"><block><exit/></|', {"/block"}, {"/form"}),
    "attribute": ("fa/x.xml", BEGIN + '<form id="a"><block><goto |', {"next", "nextitem"}, {"id"}),
    "given": ("fa/x.xml", BEGIN + '<form id="a" |></form></prima>', {"stream"}, {"id"}),
    "instead": ("fa/x.xml", BEGIN + '<form id="a"><block><turn angle="1" |/>', {"order"}, {"angle-expr"}),
    "choices": ("fa/x.xml", BEGIN + '<form id="a"><field name="n" type="|"/>', {"number"}, {"a"}),
    "truth": ("fa/x.xml", BEGIN + '<form id="a"><field name="n"><prompt bargein="|"', {"true"}, set()),
    "forms": ("fa/x.xml", BEGIN + '<form id="a"><block><goto next="|"/></block></form><form id="b"/>', {"#a", "#b"}, set()),
    "open quote": ("fa/x.xml", BEGIN + '<form id="a"><block><goto next="#|</block></form>', {"#a"}, set()),
    "rules": ("fa/x.xml", BEGIN + '<form id="a"><field name="n"><grammar root="|"><rule id="r"/></grammar>', {"r"}, {"a"}),
    "variables": (
        "fa/x.xml",
        BEGIN + '<var name="all"/><form id="a"><var name="own"/><block cond="own &lt; |"/></form>'
        '<form id="b"><var name="other"/></form>',
        {"all", "own", "event"},
        {"other"},
    ),
    "namelist": ("fa/x.xml", BEGIN + '<form id="a"><var name="n"/><block><clear namelist="x |"/>', {"n"}, {"event"}),
    "members": ("fa/x.xml", BEGIN + '<form id="a"><block cond="event.|"/>', {"data", "name"}, {"event"}),
    "script": ("fa/x.xml", BEGIN + "<script>var total = 1; |</script>", {"total"}, {"form"}),
    "events": (
        "ea/guide.xml",
        BEGIN + '<form id="a"><on event="message |"/></form>',
        {"touch.head", "human.lost", "error.device.arm", "corner"},
        set(),
    ),
    "places": ("ea/guide.xml", BEGIN + '<form id="a"><block><topological-move to="|"/>', {"kidode-room"}, {"head"}),
    "gestures": ("ea/guide.xml", BEGIN + '<form id="a"><block><gesture name="|"/>', {"nod"}, set()),
    "commands": ("fa/dance.xml", BEGIN + '<form id="a"><block><command type="|"/>', {"dance"}, {"speak"}),
    "handled": ("fa/x.xml", BEGIN + '<form id="a"><on event="done"/><block><throw event="|"/>', {"done"}, set()),
    "worlds": ("scenarios/x.xml", SCENE.replace("../worlds/office.xml", "|"), {"../worlds/home.xml"}, {"../robots/papero.xml"}),
    "applications": ("scenarios/x.xml", SCENE + '<application src="|"/>', {"../fa/follow.xml", "../ea/pizza.vxml"}, {"../worlds/home.xml"}),
    "scene places": ("scenarios/x.xml", SCENE + '<robot at="|"/>', {"entrance"}, {"charger"}),
    "sensors": ("scenarios/x.xml", SCENE + '<when at="1s"><touch sensor="|"/>', {"head"}, set()),
    "doing": ("scenarios/x.xml", SCENE + '<when doing="|"/>', {"speak", "dance"}, set()),
    "policy": (
        "scenarios/x.xml",
        SCENE.replace('id="s"', 'id="s" policy="|"'),
        {"fifo", "prima"},
        set(),
    ),
    "voice elements": ("ea/x.vxml", VOICE + '<form id="a"><block><|', {"prompt", "p:speak"}, {"field"}),
    "voice arranging": ("ea/x.vxml", VOICE + '<form id="a"><block><p:|', {"p:par", "p:seq", "p:iu"}, set()),
    "voice arranged": ("ea/x.vxml", VOICE + '<form id="a"><block><p:par><|', {"p:speak", "p:iu"}, {"prompt"}),
    "voice grouped": ("ea/x.vxml", VOICE + '<form id="a"><block><p:iu |', {"longest", "restartable"}, {"cond"}),
    "voice form": ("ea/x.vxml", VOICE + '<form id="a"><|', {"p:iu", "field"}, {"p:par", "p:speak"}),
    "voice unit": ("ea/x.vxml", VOICE + '<form id="a"><p:iu><|', {"block", "record", "noinput"}, {"p:speak", "on", "subdialog"}),
    "voice unit attributes": ("ea/x.vxml", VOICE + '<form id="a"><p:iu |', {"longest", "cond", "name"}, {"restartable"}),
    "voice unit content": ("ea/x.vxml", VOICE + '<form id="a"><p:iu><block><|', {"prompt", "p:speak"}, {"field"}),
    "voice unit items": ("ea/x.vxml", VOICE + '<form id="a"><p:iu name="u"><field name="f"/></p:iu><block><goto nextitem="|"/>', {"u", "f"}, set()),
    "voice goto": ("ea/x.vxml", VOICE + '<form id="a"><block><goto next="|"/>', {"#a", "pizza.vxml"}, set()),
    "voice grammar": ("ea/x.vxml", VOICE + '<form id="a"><field name="f"><grammar><|', {"rule", "one-of"}, {"prompt"}),
    "voice events": ("ea/x.vxml", VOICE + '<form id="a"><catch event="|"', {"nomatch", "error.badfetch"}, set()),
    "voice values": ("ea/x.vxml", VOICE + '<form id="a" scope="|"', {"dialog", "document"}, set()),
    "namespaces": ("fa/x.xml", '<prima xmlns="|"', {"urn:prima:dialogue:1"}, set()),
    "comment": ("fa/x.xml", BEGIN + "<!-- <| -->", set(), {"form"}),
}  # fmt: skip


@pytest.mark.parametrize("case", PROPOSED)
def test_completion(editor: Editor, case: str) -> None:
    name, text, wanted, unwanted = PROPOSED[case]
    found = editor.proposals(name, text).keys()
    assert wanted <= found
    assert not unwanted & found


def test_proposals_bring_what_an_element_needs(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><got|</block></form></prima>'
    item = editor.proposals("fa/x.xml", text)["goto"]
    assert item.insert_text_format == lsp.InsertTextFormat.Snippet
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert edited(plain(text)[0], [item.text_edit]) == (
        BEGIN + '<form id="a"><block><goto next="$1"/>$0</block></form></prima>'
    )
    text = BEGIN + '<form id="a"><block><|got next="#a"/></block></form></prima>'
    item = editor.proposals("fa/x.xml", text)["goto"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert item.text_edit.new_text == "goto"  # the rest is there already


def test_an_editor_without_snippets_gets_none(tmp_path: Path) -> None:
    editor = Editor(tmp_path, lsp.ClientCapabilities())
    for item in editor.proposals("x.xml", BEGIN + "<form |").values():
        assert isinstance(item.text_edit, lsp.TextEdit)
        assert "$" not in item.text_edit.new_text
    assert editor.end() == (0, "")


def test_a_space_in_a_sentence_proposes_nothing(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><speak>Hello |</speak></block></form></prima>'
    assert editor.proposals("fa/x.xml", text, " ") == {}
    assert "value" in editor.proposals("fa/x.xml", text)


def test_a_proposal_of_a_new_document_is_a_good_beginning(editor: Editor) -> None:
    item = editor.proposals("fa/x.xml", "|")["prima"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    text = item.text_edit.new_text.replace("${1|ea,fa|}", "fa").replace("$0", "<speak>x</speak>")
    assert editor.open("fa/x.xml", text.replace("$2", "x").replace("$3", "main")) == []
    editor.close("fa/x.xml")


# Names -------------------------------------------------------------------------------------

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
RULE = (
    VOICE + '<form id="a"><field name="f"><grammar root="r"><rule id="|r"><item>x</item></rule>'
    '<rule id="s"><ruleref uri="#r"/></rule></grammar></field>'
    '<field name="g"><grammar root="r"><rule id="r"/></grammar></field></form></vxml>'
)


@pytest.mark.parametrize(
    ("text", "name", "uses", "renamed"),
    [
        (FORMS, "fa/x.xml", 3, {"#c": 2, 'id="c"': 1}),
        (SCOPES, "fa/x.xml", 5, {'<var name="n"/><form id="a"><var name="c"/>': 1, "document.n": 1, "dialog.c": 1, 'cond="n"': 1}),
        (SCRIPT, "fa/x.xml", 2, {"function c(": 1, "c(1)": 1}),
        (RULE, "ea/x.vxml", 3, {'root="c"': 1, 'uri="#c"': 1, 'root="r"': 1}),
    ],
    ids=["form", "variable", "function", "rule"],
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
    editor.close("fa/x.xml")


def test_a_place_is_renamed_everywhere(editor: Editor) -> None:
    world = (editor.folder / "worlds/office.xml").read_text(encoding="utf-8")
    where = editor.at("worlds/office.xml", world.replace('id="kidode-room"', 'id="|kidode-room"'))
    change = rename(editor, where, "room")
    editor.close("worlds/office.xml")
    assert change is not None and change.changes is not None
    files = {Path(uri).name for uri in change.changes}
    assert files == {"office.xml", "guide.xml"}
    for uri, edits in change.changes.items():
        text = Path(uri.removeprefix("file://")).read_text(encoding="utf-8")
        assert "kidode-room" in text
        assert "kidode-room" not in edited(text, list(edits))


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
    with pytest.raises(JsonRpcException, match="already"):
        rename(editor, where, "../fa/dance.xml")
    editor.close("scenarios/x.xml")


def test_files_that_the_editor_moves_are_followed(editor: Editor) -> None:
    file = lsp.FileRename(editor.uri("scenarios/follow-alone.xml"), editor.uri("follow-alone.xml"))
    change = editor.do(
        editor.client.workspace_will_rename_files_async(lsp.RenameFilesParams([file]))
    )
    assert change is not None and change.changes is not None
    text = (editor.folder / "scenarios/follow-alone.xml").read_text(encoding="utf-8")
    made = edited(text, list(change.changes[editor.uri("scenarios/follow-alone.xml")]))
    assert 'src="fa/follow.xml"' in made and "../" not in made


# Meaning -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("fa/x.xml", BEGIN + '<form id="a"><bl|ock/></form>', ["Content that runs once", "O4"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block></bl|ock></form>', ["Content that runs once"]),
        ("fa/x.xml", BEGIN + '<form id="a"><i|u><block/></iu></form>', ["Information Unit", "**U5**"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block><turn an|gle="2"/>', ["counter-clockwise", "-360"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block><turn angle-ex|pr="2"/>', ["expression that gives angle"]),
        ("fa/x.xml", BEGIN + '<form id="a"><var name="n" expr="7"/><block cond="|n"/>', ["of the form `a`", 'expr="7"']),
        ("ea/guide.xml", BEGIN + '<form id="a"><block><topological-move to="kido|de-room"/>', ["place `kidode-room`", "office.xml"]),
        ("scenarios/x.xml", SCENE + '<when doing="sp|eak"/>', ["Says its text", "speaker"]),
        ("fa/x.xml", BEGIN + '<form id="a"><on event="human.l|ost"/>', ["out of sight"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><go|to next="#a"/>', ["VoiceXML 5.3.7"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><prompt barge|in="true"/>', ["before it ends"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><p:turn an|gle="1"/>', ["counter-clockwise"]),
        ("ea/x.vxml", VOICE + '<form id="a"><p:i|u>', ["around form items", "rule U5"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><p:i|u>', ["around Commands", "rule U4"]),
    ],
)  # fmt: skip
def test_hover(editor: Editor, name: str, text: str, words: list[str]) -> None:
    where = editor.at(name, text)
    found = editor.do(editor.client.text_document_hover_async(lsp.HoverParams(*where)))
    editor.close(name)
    assert found is not None and isinstance(found.contents, lsp.MarkupContent)
    for word in words:
        assert word in found.contents.value


def test_symbols_links_and_pairs_of_tags(editor: Editor) -> None:
    editor.open("fa/follow.xml")
    file = lsp.TextDocumentIdentifier(editor.uri("fa/follow.xml"))
    found = editor.do(
        editor.client.text_document_document_symbol_async(lsp.DocumentSymbolParams(file))
    )
    assert found is not None
    (root,) = found
    assert isinstance(root, lsp.DocumentSymbol) and root.name == "follow"
    forms = [one for one in root.children or () if one.detail == "form"]
    assert len(forms) > 1 and forms[0].children
    editor.close("fa/follow.xml")

    editor.open("scenarios/touched-on-the-way.xml")
    scene = lsp.TextDocumentIdentifier(editor.uri("scenarios/touched-on-the-way.xml"))
    targets = editor.do(
        editor.client.text_document_document_link_async(lsp.DocumentLinkParams(scene))
    )
    assert {Path(str(one.target)).name for one in targets or ()} >= {"office.xml", "follow.xml"}
    editor.close("scenarios/touched-on-the-way.xml")

    text = BEGIN + '<form id="a"><bl|ock><exit/></block></form></prima>'
    where = editor.at("fa/x.xml", text)
    pair = editor.do(
        editor.client.text_document_linked_editing_range_async(lsp.LinkedEditingRangeParams(*where))
    )
    assert pair is not None
    assert [cut(plain(text)[0], one) for one in pair.ranges] == ["block", "block"]
    editor.close("fa/x.xml")


FIXED = {
    "element": (BEGIN + '<form id="a"><block><speek>x</speek><exit/></block></form></prima>', "<speak>x</speak>"),
    "hint": (BEGIN + '<form id="a"><block><say>x</say><exit/></block></form></prima>', "<speak>x</speak>"),
    "attribute": (BEGIN + '<form id="a"><on evnt="touch"><exit/></on></form></prima>', '<on event="touch">'),
    "value": (BEGIN + '<form id="a"><block><speak order="nwo">x</speak><exit/></block></form></prima>', 'order="now"'),
    "time": (BEGIN + '<form id="a"><block><send event="x" delay="5"/></block><on event="x"><exit/></on></form></prima>', 'delay="5s"'),
    "range": (BEGIN + '<form id="a"><block><turn angle="450"/><exit/></block></form></prima>', 'angle="360"'),
    "form": (BEGIN + '<form id="main"><block><goto next="#mian"/></block></form></prima>', 'next="#main"'),
    "target": (BEGIN + '<form id="main"><block><goto next="main"/></block></form></prima>', 'next="#main"'),
    "variable": (BEGIN + '<form id="a"><var name="count"/><block cond="cuont"><exit/></block></form></prima>', 'cond="count"'),
    "declare": (BEGIN + '<form id="a"><block cond="q"><exit/></block></form></prima>', '<form id="a">\n  <var name="q"/>'),
    "missing": (BEGIN + '<form id="a"><block><turn/><exit/></block></form></prima>', '<turn angle=""/>'),
    "end tag": (BEGIN + '<form id="a"><block><exit/></form></prima>', "<exit/></block></form>"),
    "end": (BEGIN + '<form id="a"><block><exit/></block></form>\n', "</form></prima>\n"),
    "namespace": (BEGIN.replace("dialogue", "dialoge") + '<form id="a"/></prima>', "urn:prima:dialogue:1"),
    "place": (SCENE + '<robot at="entrace"/><application src="../fa/follow.xml" kind="fa"/></scenario>', 'at="entrance"'),
}  # fmt: skip


@pytest.mark.parametrize("case", FIXED)
def test_quick_fixes(editor: Editor, case: str) -> None:
    text, wanted = FIXED[case]
    name = "scenarios/x.xml" if "<scenario" in text else "fa/x.xml"
    problems = editor.open(name, text)
    assert problems
    made = []
    for problem in problems:
        actions = editor.do(
            editor.client.text_document_code_action_async(
                lsp.CodeActionParams(
                    lsp.TextDocumentIdentifier(editor.uri(name)),
                    problem.range,
                    lsp.CodeActionContext([problem]),
                )
            )
        )
        for action in actions or ():
            assert isinstance(action, lsp.CodeAction) and action.edit and action.edit.changes
            made.append(edited(text, list(action.edit.changes[editor.uri(name)])))
    editor.close(name)
    assert any(wanted in one for one in made), made


def test_nothing_is_done_about_a_name_that_is_cut() -> None:
    text = BEGIN + f'<form id="a"><block cond="{"q" * 1_000}"><exit/></block></form></prima>'
    workspace = Workspace()
    workspace.put("file:///x.xml", text)
    path = next(iter(workspace.open))
    (found,) = spots(workspace, path, check(workspace, path)[path])
    assert found.problem.code == "undeclared-variable" and "[...]" in found.problem.remedy
    assert fixes(workspace.open[path].page.lines, found.problem) == []


# Robustness --------------------------------------------------------------------------------


def test_strange_questions_are_answered_with_nothing(editor: Editor) -> None:
    editor.open("fa/x.xml", "<prima")
    far = lsp.Position(2_000_000, 2_000_000_000)
    for uri in (
        editor.uri("fa/x.xml"),
        "file:///nowhere/x.xml",
        "untitled:Untitled-1",
        "http://a/b",
        "file:///%00",
        "x:" * 50,
        "http://[::1",
    ):
        file = lsp.TextDocumentIdentifier(uri)
        client = editor.client
        context = lsp.ReferenceContext(include_declaration=True)
        assert not editor.do(client.text_document_hover_async(lsp.HoverParams(file, far)))
        assert not editor.do(client.text_document_definition_async(lsp.DefinitionParams(file, far)))
        assert not editor.do(
            client.text_document_references_async(lsp.ReferenceParams(context, file, far))
        )
        assert not editor.do(client.text_document_rename_async(lsp.RenameParams(file, far, "x")))
        assert not editor.do(
            client.text_document_prepare_rename_async(lsp.PrepareRenameParams(file, far))
        )
        assert not editor.do(client.text_document_document_link_async(lsp.DocumentLinkParams(file)))
        editor.do(client.text_document_completion_async(lsp.CompletionParams(file, far)))
        editor.do(client.text_document_document_symbol_async(lsp.DocumentSymbolParams(file)))
    editor.close("fa/x.xml", "fa/never-opened.xml")
    editor.versions[editor.uri("fa/unknown.xml")] = 1
    change = lsp.TextDocumentContentChangeWholeDocument(text="<prima")
    identifier = lsp.VersionedTextDocumentIdentifier(uri=editor.uri("fa/unknown.xml"), version=3)
    editor.client.text_document_did_change(lsp.DidChangeTextDocumentParams(identifier, [change]))
    assert editor.open("fa/y.xml", BEGIN + "<form/></prima>")  # it is still there
    editor.close("fa/y.xml")


def test_an_address_that_is_no_uri_names_no_file() -> None:
    assert path_of("http://[::1") is None


def test_a_document_without_a_file_is_looked_through(editor: Editor) -> None:
    uri = "untitled:Untitled-1"
    item = lsp.TextDocumentItem(uri, "xml", 1, WRONG["fa/names.xml"])
    editor.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))

    async def wait() -> list[Any]:
        while uri not in editor.told:
            await asyncio.sleep(0.01)
        return [one.code for one in editor.told[uri][-1].diagnostics]

    assert "no-such-form" in editor.do(wait())
    identifier = lsp.TextDocumentIdentifier(uri)
    editor.client.text_document_did_close(lsp.DidCloseTextDocumentParams(identifier))


def test_a_defect_ends_one_request_alone(caplog: pytest.LogCaptureFixture) -> None:
    def broken(_server: Server, _params: Any) -> int:
        return 1 // 0

    assert server._safely(broken)(server.make_server(), None) is None
    assert "ZeroDivisionError" in caplog.text


def everything(workspace: Workspace, path: Path, offset: int) -> None:
    """Ask everything about a place."""
    page = workspace.open[path].page
    complete(workspace, path, offset)
    hover(workspace, path, offset)
    naming.definitions(workspace, path, offset)
    naming.references(workspace, path, offset)
    naming.renamable(workspace, path, offset)
    outline(page)
    links(workspace, path)
    for one in spots(workspace, path, check(workspace, path)[path]):
        assert 0 <= one.start <= one.end <= len(page.text)
        for _, changes in fixes(page.lines, one.problem):
            assert all(0 <= c.start <= c.end <= len(page.text) for c in changes)


SAMPLES = [
    path.read_text(encoding="utf-8")
    for path in (
        *sorted(ROOT.glob("documents/fa/*.xml")),
        *sorted(ROOT.glob("documents/ea/*.*")),
        ROOT / "documents" / "scenarios" / "touched-on-the-way.xml",
        ROOT / "documents" / "robots" / "papero-plus.xml",
    )
]


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_every_question_about_a_mangled_document_has_an_answer(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(SAMPLES))
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 40)))
    written = data.draw(st.text(alphabet="<>/=\"'# &;!-[]?ab$.{(\n\r😀", max_size=6))
    text = text[:start] + written + text[end:]
    if data.draw(st.booleans()):
        text = text[: start + len(written)]
    workspace = Workspace()
    path = workspace.put("file:///nowhere/at/all/x.xml", text)
    assert path is not None
    everything(workspace, path, min(start + len(written), len(text)))


@settings(max_examples=300, deadline=None)
@given(
    text=st.text(alphabet="ab\n\r😀é\u2028", max_size=30),
    encoding=st.sampled_from([UTF8, UTF16, UTF32]),
)
def test_offsets_and_positions_are_each_other_s(text: str, encoding: str) -> None:
    lines = Lines(text)
    for offset in range(len(text) + 1):
        line, column = lines.position(offset, encoding)
        if text[offset - 1 : offset + 1] != "\r\n":
            assert lines.offset(line, column, encoding) == offset


@settings(max_examples=200, deadline=None)
@given(text=st.text(alphabet="<>/=\"'ab !-[]?\n", max_size=60))
def test_tags_of_any_text_are_inside_it_and_in_order(text: str) -> None:
    page = Page(text)
    resolve(page)
    starts = [tag.start for tag in page.tags]
    assert starts == sorted(set(starts))
    for tag in page.tags:
        assert tag.start < tag.end <= max(tag.until, tag.end) <= len(text)
        for attr in tag.attributes:
            assert attr.first < 0 or text[attr.first : attr.last] == attr.value
    assert all(text[mark.start : mark.end] == mark.name for mark in marks(page))


def test_a_long_text_without_end_takes_no_long_time() -> None:
    for text in ("<a " * 20_000, "<" * 50_000, '<a b="' * 20_000, "<!--" * 20_000, "</a>" * 20_000):
        workspace = Workspace()
        path = workspace.put("file:///nowhere/x.xml", BEGIN + text)
        assert path is not None
        everything(workspace, path, len(BEGIN) + 10)


# Words and the command line --------------------------------------------------------------


def test_every_element_attribute_and_rule_is_described() -> None:
    for vocabulary in VOCABULARIES:
        for element in vocabulary.elements.values():
            assert element.doc, element.tag
            for word in element.source.replace(";", " ").replace(",", " ").split():
                if len(word) == 2 and word[0] in "UOSCFKVEX" and word[1].isdigit():
                    assert word in RULES, (element.tag, word)
    plain_ones = {"name", "expr", "cond", "next", "event", "count", "timeout", "namelist", "src"}
    assert plain_ones <= VOICEXML_ATTRIBUTES.keys()


def test_a_person_at_a_terminal_is_told_what_it_is_for() -> None:
    _master, slave = pty.openpty()
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"], stdin=slave, capture_output=True, encoding="utf-8"
    )
    assert done.returncode == 2
    assert "An editor starts this" in done.stderr and "docs/editors.md" in done.stderr


def test_without_pygls_it_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['pygls'] = None; sys.argv = ['prima', 'lsp']\n"
        "from prima.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
    )
    assert done.returncode == 2
    assert done.stderr == 'prima: The language server needs pygls: pip install "prima[editor]".\n'


def test_it_ends_when_the_editor_is_gone() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=SECONDS,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_what_is_no_message_does_not_end_it() -> None:
    noise = b"Content-Length: 5\r\n\r\nhello" + b"Content-Length: 2\r\n\r\n{}" + b"nonsense\r\n"
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"], input=noise, capture_output=True, timeout=SECONDS
    )
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr


# Requests that are none -----------------------------------------------------------------------

WHERE = {"textDocument": {"uri": "file:///none.xml"}, "position": {"line": 0, "character": 0}}
SPAN = {"start": WHERE["position"], "end": WHERE["position"]}
REQUESTS: dict[str, dict[str, Any]] = {
    **dict.fromkeys(
        (
            *(lsp.TEXT_DOCUMENT_COMPLETION, lsp.TEXT_DOCUMENT_HOVER, lsp.TEXT_DOCUMENT_DEFINITION),
            *(lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, lsp.TEXT_DOCUMENT_PREPARE_RENAME),
            lsp.TEXT_DOCUMENT_LINKED_EDITING_RANGE,
        ),
        WHERE,
    ),
    lsp.TEXT_DOCUMENT_REFERENCES: {**WHERE, "context": {"includeDeclaration": True}},
    lsp.TEXT_DOCUMENT_RENAME: {**WHERE, "newName": "b"},
    lsp.WORKSPACE_WILL_RENAME_FILES: {"files": [{"oldUri": "file:///a", "newUri": "file:///b"}]},
    lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL: {"textDocument": WHERE["textDocument"]},
    lsp.TEXT_DOCUMENT_DOCUMENT_LINK: {"textDocument": WHERE["textDocument"]},
    lsp.TEXT_DOCUMENT_CODE_ACTION: {
        "textDocument": WHERE["textDocument"], "range": SPAN, "context": {"diagnostics": []},
    },
}  # fmt: skip


def ill(params: Any) -> Iterator[Any]:
    """Parameters, each time with one thing wrong in them."""
    wrong: tuple[Any, ...] = (7, "x", [1], {"a": 1}, 1e300, None)
    yield from (one for one in wrong if type(one) is not type(params))
    if isinstance(params, dict):
        for name, value in params.items():
            yield {key: one for key, one in params.items() if key != name}
            yield from ({**params, name: one} for one in ill(value))
    elif isinstance(params, list) and params:
        yield from ([one] for one in ill(params[0]))
    elif type(params) is int:
        yield from (-1, 2**31, 2**64)


def speak(process: subprocess.Popen[bytes], message: Any) -> None:
    assert process.stdin is not None
    data = json.dumps(message).encode()
    process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))
    process.stdin.flush()


def hear(process: subprocess.Popen[bytes]) -> Any:
    assert process.stdout is not None
    size = 0
    while line := process.stdout.readline().strip():
        size = int(line.partition(b":")[2]) if line.lower().startswith(b"content-length") else size
    return json.loads(process.stdout.read(size))


def test_wrong_parameters_are_answered_as_such_and_the_server_goes_on() -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    begin: Any = {"processId": None, "rootUri": None, "capabilities": {}}
    speak(process, {"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": begin})
    assert hear(process)["id"] == 0
    count = 0
    for method, params in REQUESTS.items():
        for one in (params, *ill(params), params):
            count += 1
            speak(process, {"jsonrpc": "2.0", "id": count, "method": method, "params": one})
            answer = hear(process)
            assert answer["id"] == count
            if one is params:
                assert "error" not in answer
            else:
                assert answer.get("error", {}).get("code") == -32602, (method, one, answer)
                assert answer["error"]["message"] == f"Wrong parameters of {method}."
    speak(process, {"jsonrpc": "2.0", "id": -1, "method": "shutdown"})
    assert hear(process) == {"jsonrpc": "2.0", "id": -1, "result": None}
    speak(process, {"jsonrpc": "2.0", "method": "exit"})
    assert process.stderr is not None
    assert (process.wait(SECONDS), process.stderr.read()) == (0, b"")
