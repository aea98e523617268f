"""The Language Server Protocol: the handlers of requests, for pygls."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, BinaryIO, TypeVar, cast

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from prima.checks.ignores import KINDS, SETTINGS
from prima.errors import UsageError
from prima.lsp import answers
from prima.lsp.paths import path_of
from prima.lsp.protocol import Cursor, Server

SOON, LATER = 0.005, 0.25
"""Seconds after a change until its document is checked, and those that depend on it."""
MOST_BYTES = 100_000_000
"""Bytes that a message may have; a document has 2 MB at most."""
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


def _at_cursor(
    function: Callable[[Server, Any, Cursor], Answer],
) -> Callable[[Server, Any], Answer | None]:
    """Wrap a handler of requests about a place, which has no answer elsewhere."""

    @functools.wraps(function)
    def call(server: Server, params: Any) -> Answer | None:
        at = server.asked(params)
        return function(server, params, at) if at is not None else None

    return call


# Documents ------------------------------------------------------------------------------


def _initialized(server: Server, params: lsp.InitializedParams) -> None:
    root = server.workspace.root_uri  # of an editor that knows only one folder
    server.documents.folders = _folders(server) or _paths([root] if root else [])
    workspace = server.client_capabilities.workspace
    watching = workspace.did_change_watched_files if workspace else None
    if watching and watching.dynamic_registration:
        names = [f"*{kind}" for kind in KINDS] + [SETTINGS]
        watchers = [lsp.FileSystemWatcher(f"**/{name}") for name in names]
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
    return _paths(folder.uri for folder in server.workspace.folders.values())


def _paths(uris: Iterable[str]) -> list[Path]:
    return [path for uri in uris if (path := path_of(uri)) is not None]


def _folders_changed(server: Server, params: lsp.DidChangeWorkspaceFoldersParams) -> None:
    server.documents.folders = _folders(server)
    server.documents.forget()


def _opened(server: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    document = params.text_document
    server.documents.forget()  # a file outside of all folders brings its own
    path = server.documents.put(document.uri, document.text, document.version)
    if path is not None:
        _check(server, path)


def _check(server: Server, path: Path) -> None:
    """Check a document soon, and those that depend on it."""
    server.check_soon(path, SOON)
    for other in server.concerned(path):
        server.check_soon(other, LATER)


def _changed(server: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    known = server.documents.asked(params.text_document.uri)
    if known is None or not params.content_changes:
        return
    text = server.workspace.get_text_document(params.text_document.uri).source
    path = server.documents.put(params.text_document.uri, text, params.text_document.version)
    if path is not None:
        _check(server, path)


def _closed(server: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    path = path_of(params.text_document.uri)
    if path is None or path not in server.documents.open:
        return
    if _open_otherwise(server, path, params.text_document.uri):
        return
    reported = server.reported.pop(path, {})
    concerned = server.concerned(path)
    uri = server.documents.uri(path)
    server.documents.drop(path)
    for file in {path, *reported}:
        server.publish(file)
    if uri != server.documents.uri(path):
        server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))
    for other in concerned:  # the files on disk are used again
        server.check_soon(other, LATER)


def _open_otherwise(server: Server, path: Path, closed: str) -> bool:
    """Go on with the text of a file that stays open by another URI, such as a link's, if it does."""
    others = [one for one in server.workspace.text_documents.values() if path_of(one.uri) == path]
    for other in others[-1:]:
        server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(closed, []))
        server.documents.put(other.uri, other.source, other.version)
        _check(server, path)
    return bool(others)


def _files_changed(server: Server, params: lsp.DidChangeWatchedFilesParams) -> None:
    server.documents.forget()
    for path in server.documents.open:
        server.check_soon(path, LATER)


def _saved(server: Server, params: lsp.DidSaveTextDocumentParams) -> None:
    server.documents.forget()


def make_server() -> Server:
    """A server, ready to start."""
    server = Server()
    kinds_of_files = ",".join(kind[1:] for kind in KINDS)
    patterns = (
        lsp.FileOperationPattern(f"**/*.{{{kinds_of_files}}}"),
        lsp.FileOperationPattern("**", lsp.FileOperationPatternKind.Folder),
    )
    moving = [lsp.FileOperationFilter(pattern, "file") for pattern in patterns]
    files = lsp.FileOperationRegistrationOptions(moving)
    kinds = lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix])
    for method, handler, options in (
        (lsp.INITIALIZED, _initialized, None),
        (lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS, _folders_changed, None),
        (lsp.TEXT_DOCUMENT_DID_OPEN, _opened, None),
        (lsp.TEXT_DOCUMENT_DID_CHANGE, _changed, None),
        (lsp.TEXT_DOCUMENT_DID_CLOSE, _closed, None),
        (lsp.TEXT_DOCUMENT_DID_SAVE, _saved, None),
        (lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES, _files_changed, None),
        (
            lsp.TEXT_DOCUMENT_COMPLETION,
            _at_cursor(answers.completion),
            lsp.CompletionOptions(TRIGGERS),
        ),
        (lsp.TEXT_DOCUMENT_HOVER, _at_cursor(answers.hover), None),
        (lsp.TEXT_DOCUMENT_DEFINITION, _at_cursor(answers.definition), None),
        (lsp.TEXT_DOCUMENT_REFERENCES, _at_cursor(answers.references), None),
        (lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, _at_cursor(answers.highlight), None),
        (lsp.TEXT_DOCUMENT_PREPARE_RENAME, _at_cursor(answers.prepare_rename), None),
        (lsp.TEXT_DOCUMENT_RENAME, _at_cursor(answers.rename), None),
        (lsp.WORKSPACE_WILL_RENAME_FILES, answers.will_move, files),
        (lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, answers.symbols, None),
        (lsp.TEXT_DOCUMENT_DOCUMENT_LINK, answers.links, None),
        (lsp.TEXT_DOCUMENT_CODE_ACTION, answers.actions, kinds),
        (lsp.TEXT_DOCUMENT_LINKED_EDITING_RANGE, _at_cursor(answers.linked), None),
    ):
        server.feature(method, options)(_safely(handler))
    return server


class _Input:
    """The standard input, of which no message may be longer than memory allows."""

    def readline(self) -> bytes:
        """The next line of a head."""
        return sys.stdin.buffer.readline(MOST_BYTES)

    def read(self, size: int) -> bytes:
        """A message.

        Raises:
            UsageError: it is too long; where the next one begins is not known.
        """
        if size > MOST_BYTES:
            raise UsageError(f"the editor sends more than {MOST_BYTES:,} bytes at once.")
        return sys.stdin.buffer.read(size)


def serve() -> bool:
    """Serve an editor over standard input and output until it disconnects.

    Returns:
        False if the editor sent ``exit`` without ``shutdown`` (LSP 3.17, Exit Notification).
    """
    logging.basicConfig(level=logging.ERROR, format="prima lsp: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    with os.fdopen(os.dup(1), "wb") as stdout:  # pygls closes what it writes to
        server = make_server()
        server.start_io(cast("BinaryIO", _Input()), stdout)
    return not server.protocol.left_early
