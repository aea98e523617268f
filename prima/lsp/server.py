"""The Language Server Protocol: this module alone knows it, and pygls that speaks it."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from cattrs import Converter
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, default_converter

from prima import __version__
from prima.errors import Problem, in_order
from prima.errors.visible import visible
from prima.lsp import naming
from prima.lsp.complete import Proposal, complete
from prima.lsp.fixes import fixes
from prima.lsp.hover import hover
from prima.lsp.names import dialect
from prima.lsp.outline import Part, links, outline
from prima.lsp.problems import Spot, check, spot, spots
from prima.lsp.scan import Page
from prima.lsp.text import Lines
from prima.lsp.workspace import Text, Workspace, path_of

SOON, LATER = 0.005, 0.25
"""Seconds after a change until its document is looked through, and those that it concerns."""
REQUEST_FAILED = -32803

SEVERITIES = {
    "error": lsp.DiagnosticSeverity.Error,
    "warning": lsp.DiagnosticSeverity.Warning,
    "note": lsp.DiagnosticSeverity.Information,
}
ITEMS = {
    "element": lsp.CompletionItemKind.Class,
    "attribute": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.EnumMember,
    "name": lsp.CompletionItemKind.Reference,
    "variable": lsp.CompletionItemKind.Variable,
    "event": lsp.CompletionItemKind.Event,
    "file": lsp.CompletionItemKind.File,
}
SYMBOLS = {
    "module": lsp.SymbolKind.Module,
    "class": lsp.SymbolKind.Class,
    "method": lsp.SymbolKind.Method,
    "event": lsp.SymbolKind.Event,
    "variable": lsp.SymbolKind.Variable,
    "function": lsp.SymbolKind.Function,
    "object": lsp.SymbolKind.Object,
}
TRIGGERS = ["<", "/", '"', "'", "#", ".", " "]

Answer = TypeVar("Answer")
logger = logging.getLogger("prima.lsp")


def _converter() -> Converter:
    """What reads messages; unlike pygls's own it refuses values of wrong types."""
    made: Converter = default_converter()  # type: ignore[no-untyped-call]
    for kind in (str, int, bool):
        made.register_structure_hook(kind, functools.partial(_exactly, kind))
    return made


def _exactly(kind: type, value: Any, _: object) -> Any:
    if type(value) is not kind:
        raise ValueError(f"{kind.__name__} is wanted")
    return value


class Protocol(LanguageServerProtocol):
    """Answers requests whose parameters are none of the protocol's; pygls leaves them unanswered."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message as it is read; what is wrong with a request goes back to whoever asks."""
        try:
            return super().structure_message(data)
        except JsonRpcException as error:
            if "id" in data and "method" in data:
                asked = data["id"] if isinstance(data["id"], str | int) else None
                message = f"Wrong parameters of {str(data['method'])[:80]}."
                told = lsp.ResponseError(JsonRpcInvalidParams.CODE, message)
                self._send_response(asked, None, told)  # type: ignore[arg-type]
            raise error


class Server(LanguageServer):
    """What is known between the requests of an editor."""

    def __init__(self) -> None:
        super().__init__(
            "prima",
            __version__,
            text_document_sync_kind=lsp.TextDocumentSyncKind.Full,
            protocol_cls=Protocol,
            converter_factory=_converter,
        )
        self.documents = Workspace()
        self.told: dict[Path, dict[Path, list[Problem]]] = {}
        """Problems by the open document that brought them to light, and by their file."""
        self.waiting: dict[Path, asyncio.TimerHandle] = {}

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Keep quiet of what an editor has sent in a wrong way: it gets its answer."""
        logger.debug("%s: %s", type(error).__name__, error)

    # Places -------------------------------------------------------------------

    @property
    def encoding(self) -> str:
        """What the columns of this editor count."""
        encoding = self.workspace.position_encoding or lsp.PositionEncodingKind.Utf16
        return str(getattr(encoding, "value", encoding))

    def offset(self, lines: Lines, position: lsp.Position) -> int:
        """The offset of a position."""
        return lines.offset(position.line, position.character, self.encoding)

    def range(self, lines: Lines, start: int, end: int) -> lsp.Range:
        """The range of a piece of text."""
        first, last = (lines.position(one, self.encoding) for one in (start, end))
        return lsp.Range(lsp.Position(*first), lsp.Position(*last))

    def location(self, place: naming.Spot) -> lsp.Location | None:
        """A piece of a document."""
        text = self.documents.text(place.path)
        if text is None:
            return None
        return lsp.Location(
            self.documents.uri(place.path), self.range(text.lines, place.start, place.end)
        )

    def locations(self, places: list[naming.Spot]) -> list[lsp.Location]:
        """Pieces of documents."""
        return [one for place in places if (one := self.location(place)) is not None]

    def asked(self, params: Any) -> tuple[Path, Text, int] | None:
        """The document and the offset that a request is about."""
        found = self.documents.asked(params.text_document.uri)
        if found is None or params.position.line >= len(found[1].lines.starts):
            return None
        path, text = found
        return path, text, self.offset(text.lines, params.position)

    # Problems -----------------------------------------------------------------

    def look_through(self, path: Path, delay: float) -> None:
        """Look for problems of a document soon; a later wish takes the place of an earlier."""
        if path in self.waiting:
            self.waiting.pop(path).cancel()
        loop = asyncio.get_running_loop()
        self.waiting[path] = loop.call_later(delay, self._check, path)

    def _check(self, path: Path) -> None:
        self.waiting.pop(path, None)
        if path not in self.documents.open:
            return
        try:
            self.tell(path, check(self.documents, path))
        except Exception:  # the next change may be looked through again
            logger.exception("a document cannot be looked through")

    def tell(self, path: Path, found: dict[Path, list[Problem]]) -> None:
        """Publish what a document has brought to light, and what it no longer does."""
        before = self.told.get(path, {})
        self.told[path] = found
        for file in sorted({*before, *found}):
            if file == path or before.get(file) != found.get(file):
                self.publish(file)

    def problems(self, file: Path) -> list[Problem]:
        """All problems of a file, whichever document brought them to light."""
        return [one for told in self.told.values() for one in told.get(file, ())]

    def publish(self, file: Path) -> None:
        """Publish all problems of a file."""
        text = self.documents.text(file)
        found = spots(self.documents, file, self.problems(file))
        self.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(
                self.documents.uri(file),
                [self.diagnostic(text.lines, one) for one in found] if text else [],
                text.version if text else None,
            )
        )

    def diagnostic(self, lines: Lines, one: Spot) -> lsp.Diagnostic:
        """A problem as an editor shows it."""
        problem = one.problem
        return lsp.Diagnostic(
            self.range(lines, one.start, one.end),
            visible(f"{problem.message} {problem.remedy}".strip(), "\n"),
            SEVERITIES[problem.severity],
            problem.code,
            source="prima",
        )

    def concerned(self, path: Path) -> list[Path]:
        """Open documents whose problems may change with a document."""
        return [
            other
            for other, text in self.documents.open.items()
            if other != path
            and dialect(text.top) in ("scenario", "world")
            and path in self.documents.reading(other)
        ]

    # Edits --------------------------------------------------------------------

    def edits(
        self, found: list[naming.Edit], move: tuple[Path, Path] | None = None
    ) -> lsp.WorkspaceEdit | None:
        """Edits of documents, and a file that is moved after them."""
        by_file: dict[Path, list[lsp.TextEdit]] = {}
        for edit in found:
            text = self.documents.text(edit.path)
            if text is not None:
                place = self.range(text.lines, edit.start, edit.end)
                by_file.setdefault(edit.path, []).append(lsp.TextEdit(place, edit.text))
        if move is None:
            changes = {self.documents.uri(path): some for path, some in by_file.items()}
            return lsp.WorkspaceEdit(changes=changes) if changes else None
        parts: list[Any] = [
            lsp.TextDocumentEdit(
                lsp.OptionalVersionedTextDocumentIdentifier(
                    self.documents.uri(path),
                    self.documents.open[path].version if path in self.documents.open else None,
                ),
                list(some),
            )
            for path, some in by_file.items()
        ]
        parts.append(lsp.RenameFile(self.documents.uri(move[0]), self.documents.uri(move[1])))
        return lsp.WorkspaceEdit(document_changes=parts)

    @property
    def moves_files(self) -> bool:
        """Whether the editor can move a file for us."""
        workspace = self.client_capabilities.workspace
        able = workspace.workspace_edit if workspace else None
        return bool(
            able
            and able.document_changes
            and "rename" in [str(getattr(x, "value", x)) for x in able.resource_operations or ()]
        )

    @property
    def snippets(self) -> bool:
        """Whether the editor can take a proposal with places to go on at."""
        document = self.client_capabilities.text_document
        item = document.completion.completion_item if document and document.completion else None
        return bool(item and item.snippet_support)


def _safely(function: Callable[[Server, Any], Answer]) -> Callable[[Server, Any], Answer | None]:
    """A handler whose defects end one request and not the server."""

    @functools.wraps(function)
    def call(server: Server, params: Any) -> Answer | None:
        try:
            return function(server, params)
        except JsonRpcException:
            raise
        except Exception:
            logger.exception("%s", function.__name__)
            return None

    return call


# Documents ------------------------------------------------------------------------------


def _initialized(server: Server, params: lsp.InitializedParams) -> None:
    server.documents.folders = _folders(server)
    workspace = server.client_capabilities.workspace
    watching = workspace.did_change_watched_files if workspace else None
    if watching and watching.dynamic_registration:
        watchers = [lsp.FileSystemWatcher(f"**/*.{kind}") for kind in ("xml", "vxml", "grxml")]
        server.client_register_capability(
            lsp.RegistrationParams(
                [
                    lsp.Registration(
                        "files",
                        lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES,
                        lsp.DidChangeWatchedFilesRegistrationOptions(watchers),
                    )
                ]
            )
        )
    asyncio.get_running_loop().call_later(SOON, _warm)


def _warm() -> None:
    """Import what the first document would have to wait for."""
    import prima.interpreter.checks
    import prima.sim.rehearsal
    import prima.voicexml.document  # noqa: F401


def _folders(server: Server) -> list[Path]:
    uris = [folder.uri for folder in server.workspace.folders.values()]
    if not uris and server.workspace.root_uri:
        uris = [server.workspace.root_uri]
    return [path for uri in uris if (path := path_of(uri)) is not None]


def _folders_changed(server: Server, params: lsp.DidChangeWorkspaceFoldersParams) -> None:
    server.documents.folders = _folders(server)
    server.documents.forget()


def _opened(server: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    document = params.text_document
    path = server.documents.put(document.uri, document.text, document.version)
    if path is not None:
        server.look_through(path, SOON)


def _changed(server: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    known = server.documents.asked(params.text_document.uri)
    if known is None or not params.content_changes:
        return
    text = server.workspace.get_text_document(params.text_document.uri).source
    path = server.documents.put(params.text_document.uri, text, params.text_document.version)
    if path is not None:
        server.look_through(path, SOON)
        for other in server.concerned(path):
            server.look_through(other, LATER)


def _closed(server: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    path = path_of(params.text_document.uri)
    if path is None or path not in server.documents.open:
        return
    told = server.told.pop(path, {})
    concerned = server.concerned(path)
    uri = server.documents.uri(path)
    server.documents.drop(params.text_document.uri)
    for file in {path, *told}:
        server.publish(file)
    if uri != server.documents.uri(path):
        server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))
    for other in concerned:  # what is on the disk counts again
        server.look_through(other, LATER)


def _files_changed(server: Server, params: lsp.DidChangeWatchedFilesParams) -> None:
    server.documents.forget()
    for path in server.documents.open:
        server.look_through(path, LATER)


def _saved(server: Server, params: lsp.DidSaveTextDocumentParams) -> None:
    server.documents.forget()


# Questions ------------------------------------------------------------------------------


def _completion(server: Server, params: lsp.CompletionParams) -> lsp.CompletionList | None:
    asked = server.asked(params)
    if asked is None:
        return None
    path, text, offset = asked
    typed = params.context.trigger_character if params.context else None
    found = complete(server.documents, path, offset, typed or "")
    items = [_item(server, text.page, one, n) for n, one in enumerate(found)]
    return lsp.CompletionList(is_incomplete=False, items=items)


def _item(server: Server, page: Page, one: Proposal, number: int) -> lsp.CompletionItem:
    snippet = one.snippet if server.snippets else ""
    edit = lsp.TextEdit(
        server.range(page.lines, one.start, one.end), snippet or one.insert or one.label
    )
    return lsp.CompletionItem(
        visible(one.label),
        kind=ITEMS.get(one.kind),
        detail=visible(one.detail) or None,
        documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, one.doc) if one.doc else None,
        sort_text=f"{number:04}",
        filter_text=one.label,
        text_edit=edit,
        insert_text_format=lsp.InsertTextFormat.Snippet
        if snippet
        else lsp.InsertTextFormat.PlainText,
    )


def _hover(server: Server, params: lsp.HoverParams) -> lsp.Hover | None:
    asked = server.asked(params)
    found = hover(server.documents, asked[0], asked[2]) if asked else None
    if asked is None or found is None:
        return None
    return lsp.Hover(
        lsp.MarkupContent(lsp.MarkupKind.Markdown, visible(found.text, "\n")),
        server.range(asked[1].lines, found.start, found.end),
    )


def _definition(server: Server, params: lsp.DefinitionParams) -> list[lsp.Location] | None:
    asked = server.asked(params)
    if asked is None:
        return None
    return server.locations(naming.definitions(server.documents, asked[0], asked[2])) or None


def _references(server: Server, params: lsp.ReferenceParams) -> list[lsp.Location] | None:
    asked = server.asked(params)
    if asked is None:
        return None
    path, _, offset = asked
    own = params.context.include_declaration
    return server.locations(naming.references(server.documents, path, offset, own)) or None


def _highlight(
    server: Server, params: lsp.DocumentHighlightParams
) -> list[lsp.DocumentHighlight] | None:
    asked = server.asked(params)
    if asked is None:
        return None
    path, text, offset = asked
    return [
        lsp.DocumentHighlight(server.range(text.lines, one.start, one.end))
        for one in naming.references(server.documents, path, offset)
        if one.path == path
    ]


def _prepare_rename(
    server: Server, params: lsp.PrepareRenameParams
) -> lsp.PrepareRenamePlaceholder | None:
    asked = server.asked(params)
    found = naming.renamable(server.documents, asked[0], asked[2]) if asked else None
    if asked is None or found is None:
        return None
    page = asked[1].page
    return lsp.PrepareRenamePlaceholder(
        server.range(page.lines, found.start, found.end), page.text[found.start : found.end]
    )


def _rename(server: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    asked = server.asked(params)
    if asked is None:
        return None
    try:
        found, move = naming.rename(server.documents, asked[0], asked[2], params.new_name)
    except naming.Refused as error:
        raise JsonRpcException(str(error), REQUEST_FAILED) from None
    if move is not None and not server.moves_files:
        message = "This editor lets no server move a file: move it yourself."
        raise JsonRpcException(message, REQUEST_FAILED)
    return server.edits(found, move)


def _will_move(server: Server, params: lsp.RenameFilesParams) -> lsp.WorkspaceEdit | None:
    found: list[naming.Edit] = []
    for file in params.files:
        old, new = path_of(file.old_uri), path_of(file.new_uri)
        if old is not None and new is not None:
            found += naming.moved(server.documents, old, new)
    return server.edits(found)


def _symbols(server: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol] | None:
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    page = found[1].page
    return [_symbol(server, page, part) for part in outline(page)]


def _symbol(server: Server, page: Page, part: Part) -> lsp.DocumentSymbol:
    return lsp.DocumentSymbol(
        visible(part.name),
        SYMBOLS[part.sort],
        server.range(page.lines, part.start, part.end),
        server.range(page.lines, part.name_start, part.name_end),
        visible(part.detail) or None,
        children=[_symbol(server, page, one) for one in part.parts],
    )


def _links(server: Server, params: lsp.DocumentLinkParams) -> list[lsp.DocumentLink] | None:
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    path, text = found
    return [
        lsp.DocumentLink(
            server.range(text.lines, one.start, one.end), server.documents.uri(one.target)
        )
        for one in links(server.documents, path)
    ]


def _actions(server: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction] | None:
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    path, text = found
    page = text.page
    first, last = (
        server.offset(page.lines, params.range.start),
        server.offset(page.lines, params.range.end),
    )
    made = []
    for problem in in_order(server.problems(path)):
        one = spot(page.lines, problem)
        if one.end < first or one.start > last:
            continue
        for number, (title, changes) in enumerate(fixes(page.lines, problem)):
            edits = [
                lsp.TextEdit(server.range(page.lines, change.start, change.end), change.text)
                for change in changes
            ]
            made.append(
                lsp.CodeAction(
                    visible(title),
                    lsp.CodeActionKind.QuickFix,
                    [server.diagnostic(page.lines, one)],
                    is_preferred=number == 0,
                    edit=lsp.WorkspaceEdit(changes={params.text_document.uri: edits}),
                )
            )
    return made


def _linked(server: Server, params: lsp.LinkedEditingRangeParams) -> lsp.LinkedEditingRanges | None:
    """The names in a start tag and its end tag, which are written as one."""
    asked = server.asked(params)
    if asked is None:
        return None
    _, text, offset = asked
    for tag in text.page.tags:
        if tag.close is None or not tag.name:
            continue
        spans = ((tag.start + 1, tag.name_end), tag.close)
        if any(start <= offset <= end for start, end in spans):
            return lsp.LinkedEditingRanges([server.range(text.lines, *span) for span in spans])
    return None


def make_server() -> Server:
    """A server that is ready to be started."""
    server = Server()
    files = lsp.FileOperationRegistrationOptions(
        [lsp.FileOperationFilter(lsp.FileOperationPattern("**/*.{xml,vxml,grxml}"), "file")]
    )
    kinds = lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix])
    for method, handler, options in (
        (lsp.INITIALIZED, _initialized, None),
        (lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS, _folders_changed, None),
        (lsp.TEXT_DOCUMENT_DID_OPEN, _opened, None),
        (lsp.TEXT_DOCUMENT_DID_CHANGE, _changed, None),
        (lsp.TEXT_DOCUMENT_DID_CLOSE, _closed, None),
        (lsp.TEXT_DOCUMENT_DID_SAVE, _saved, None),
        (lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES, _files_changed, None),
        (lsp.TEXT_DOCUMENT_COMPLETION, _completion, lsp.CompletionOptions(TRIGGERS)),
        (lsp.TEXT_DOCUMENT_HOVER, _hover, None),
        (lsp.TEXT_DOCUMENT_DEFINITION, _definition, None),
        (lsp.TEXT_DOCUMENT_REFERENCES, _references, None),
        (lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, _highlight, None),
        (lsp.TEXT_DOCUMENT_PREPARE_RENAME, _prepare_rename, None),
        (lsp.TEXT_DOCUMENT_RENAME, _rename, None),
        (lsp.WORKSPACE_WILL_RENAME_FILES, _will_move, files),
        (lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, _symbols, None),
        (lsp.TEXT_DOCUMENT_DOCUMENT_LINK, _links, None),
        (lsp.TEXT_DOCUMENT_CODE_ACTION, _actions, kinds),
        (lsp.TEXT_DOCUMENT_LINKED_EDITING_RANGE, _linked, None),
    ):
        server.feature(method, options)(_safely(handler))
    return server


def serve() -> None:
    """Speak with an editor over standard input and output, until it goes."""
    logging.basicConfig(level=logging.ERROR, format="prima lsp: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    with os.fdopen(os.dup(1), "wb") as stdout:  # pygls closes what it writes to
        make_server().start_io(stdout=stdout)
