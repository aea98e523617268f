"""The language server as an editor meets it: over stdio, with texts that are being written."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Coroutine
from pathlib import Path
from typing import Any, TypeVar

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

from prima.lsp.text import Lines

BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">\n'
VOICE = '<vxml xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1" version="2.1">\n'
SRGS = '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" root="r">\n'
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
    """The text in a range."""
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
        self.watched: list[str] = []

        def registered(params: lsp.RegistrationParams) -> None:
            self.watched += [
                watcher["globPattern"]
                for one in params.registrations
                for watcher in (one.register_options or {})["watchers"]
            ]

        def published(params: lsp.PublishDiagnosticsParams) -> None:
            self.told.setdefault(params.uri, []).append(params)

        self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(published)
        self.client.feature(lsp.CLIENT_REGISTER_CAPABILITY)(registered)

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
