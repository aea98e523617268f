"""The Language Server Protocol: the handlers of requests, for pygls."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from prima.errors import in_order
from prima.errors.visible import visible
from prima.lsp import naming
from prima.lsp.complete import Proposal, complete
from prima.lsp.fixes import fixes
from prima.lsp.hover import hover
from prima.lsp.outline import Part, links, outline
from prima.lsp.problems import spot
from prima.lsp.protocol import Server
from prima.lsp.scan import Page
from prima.lsp.workspace import path_of

SOON, LATER = 0.005, 0.25
"""Seconds after a change until its document is checked, and those that depend on it."""
REQUEST_FAILED = -32803

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


def _safely(function: Callable[[Server, Any], Answer]) -> Callable[[Server, Any], Answer | None]:
    """Wrap a handler so that a defect ends only its request."""

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
    """Import what the first document needs."""
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
        server.check_soon(path, SOON)


def _changed(server: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    known = server.documents.asked(params.text_document.uri)
    if known is None or not params.content_changes:
        return
    text = server.workspace.get_text_document(params.text_document.uri).source
    path = server.documents.put(params.text_document.uri, text, params.text_document.version)
    if path is not None:
        server.check_soon(path, SOON)
        for other in server.concerned(path):
            server.check_soon(other, LATER)


def _closed(server: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    path = path_of(params.text_document.uri)
    if path is None or path not in server.documents.open:
        return
    told = server.reported.pop(path, {})
    concerned = server.concerned(path)
    uri = server.documents.uri(path)
    server.documents.drop(params.text_document.uri)
    for file in {path, *told}:
        server.publish(file)
    if uri != server.documents.uri(path):
        server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))
    for other in concerned:  # the files on disk are used again
        server.check_soon(other, LATER)


def _files_changed(server: Server, params: lsp.DidChangeWatchedFilesParams) -> None:
    server.documents.forget()
    for path in server.documents.open:
        server.check_soon(path, LATER)


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
    except naming.RenameError as error:
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
    """The names in a start tag and its end tag, which are edited together."""
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
    """A server, ready to start."""
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
    """Serve an editor over standard input and output until it disconnects."""
    logging.basicConfig(level=logging.ERROR, format="prima lsp: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    with os.fdopen(os.dup(1), "wb") as stdout:  # pygls closes what it writes to
        make_server().start_io(stdout=stdout)
