"""The server's state and its conversion of places, problems and edits for an editor."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import logging
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from cattrs import Converter
from lsprotocol import types as lsp
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcServerNotInitialized,
)
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, default_converter

from prima.errors import Problem, in_order
from prima.errors.visible import visible
from prima.lsp import naming
from prima.lsp.names import NameSpot
from prima.lsp.problems import check, files_read, is_ours, spot
from prima.lsp.text import Lines
from prima.lsp.workspace import Text, Workspace
from prima.version import __version__

SEVERITIES = {
    "error": lsp.DiagnosticSeverity.Error,
    "warning": lsp.DiagnosticSeverity.Warning,
    "note": lsp.DiagnosticSeverity.Information,
}

IDS = (str, int, float)
"""Types of the id of a request."""
NO_MESSAGE = "This is not a JSON-RPC 2.0 message."
logger = logging.getLogger("prima.lsp")


def _converter() -> Converter:
    """A converter of messages; unlike pygls's own it rejects values of wrong types."""
    made: Converter = default_converter()  # type: ignore[no-untyped-call]
    for kind in (str, int, bool):
        made.register_structure_hook(kind, functools.partial(_exactly, kind))
    return made


def _exactly(kind: type, value: Any, _: object) -> Any:
    if type(value) is not kind:
        raise ValueError(f"{kind.__name__} is wanted")
    return value


class Protocol(LanguageServerProtocol):
    """Answers requests that are wrong, or come too early or late, with an error; pygls does not."""

    left_early = False
    """Whether the editor sent ``exit`` without ``shutdown``."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Read a message; errors in a request are sent back."""
        asked = data.get("id")
        is_request = "jsonrpc" in data and "id" in data and "method" in data
        known = isinstance(asked, IDS) and isinstance(data.get("method"), str)
        if is_request and not (known and data["jsonrpc"] == self.VERSION):
            raise self.refused(asked, JsonRpcInvalidRequest(NO_MESSAGE))
        try:
            message = super().structure_message(data)
            if isinstance(message, lsp.InitializeRequest):
                _check_folders(message.params)
        except (JsonRpcException, ValueError) as error:
            if not is_request:
                raise
            sentence = f"Wrong parameters of {data['method'][:80]}."
            raise self.refused(asked, JsonRpcInvalidParams(sentence)) from error
        if is_request and not hasattr(message, "id"):
            sentence = f"{data['method']} is a notification: it has no id."
            raise self.refused(asked, JsonRpcInvalidRequest(sentence))
        return message

    def handle_message(self, message: Any) -> None:
        """Handle a message, if there is one and it may come now."""
        if getattr(message, "jsonrpc", None) != self.VERSION:
            asked = message.get("id") if isinstance(message, dict) else getattr(message, "id", None)
            self.refused(asked, JsonRpcInvalidRequest(NO_MESSAGE))
            return
        method = getattr(message, "method", "")
        error: JsonRpcException | None = None
        if method == lsp.EXIT:
            self.left_early = not self._shutdown
        elif self._shutdown:
            error = JsonRpcInvalidRequest("The server has been shut down.")
        elif self._workspace is None and method != lsp.INITIALIZE:
            error = JsonRpcServerNotInitialized("The server waits for initialize.")
        if error is None:
            super().handle_message(message)
        elif method and hasattr(message, "id"):
            self.refused(message.id, error)

    def _send_data(self, data: Any) -> None:
        """Send a message, unless the editor is gone: the end of its messages ends the server."""
        with contextlib.suppress(BrokenPipeError):
            super()._send_data(data)

    def refused(self, asked: Any, error: JsonRpcException) -> JsonRpcException:
        """Answer a request, by its id (perhaps none), with an error, and return that."""
        known = asked if isinstance(asked, IDS) else None
        details = {"code": error.code, "message": error.message}
        self._send_data({"jsonrpc": self.VERSION, "id": known, "error": details})
        return error


def _check_folders(params: lsp.InitializeParams) -> None:
    """Check that folders are URIs.

    Raises:
        ValueError: one is not.
    """
    folders = [folder.uri for folder in params.workspace_folders or ()]
    for uri in (*folders, params.root_uri):
        urlsplit(uri or "")


class Cursor(NamedTuple):
    """A place in an open document."""

    path: Path
    text: Text
    offset: int


class Server(LanguageServer):
    """The state of the server between requests."""

    protocol: Protocol

    def __init__(self) -> None:
        super().__init__(
            "prima",
            __version__,
            text_document_sync_kind=lsp.TextDocumentSyncKind.Full,
            protocol_cls=Protocol,
            converter_factory=_converter,
        )
        self.documents = Workspace()
        self.reported: dict[Path, dict[Path, list[Problem]]] = {}
        """Problems by the validated document, and by their file."""
        self.waiting: dict[Path, asyncio.TimerHandle] = {}

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Do not log wrong messages of an editor: it gets an error as answer."""
        if source is JsonRpcException and isinstance(error, ValueError | RecursionError):
            self.protocol.refused(None, JsonRpcParseError("This is not JSON."))
        logger.debug("%s: %s", type(error).__name__, error)

    # Places -------------------------------------------------------------------

    @property
    def encoding(self) -> str:
        """The unit in which this editor counts columns."""
        encoding = self.workspace.position_encoding or lsp.PositionEncodingKind.Utf16
        return str(getattr(encoding, "value", encoding))

    def offset(self, lines: Lines, position: lsp.Position) -> int:
        """The offset of a position."""
        return lines.offset(position.line, position.character, self.encoding)

    def range(self, lines: Lines, start: int, end: int) -> lsp.Range:
        """The range of a piece of text."""
        first, last = (lines.position(one, self.encoding) for one in (start, end))
        return lsp.Range(lsp.Position(*first), lsp.Position(*last))

    def locations(self, places: list[NameSpot]) -> list[lsp.Location]:
        """Pieces of documents."""
        return [
            lsp.Location(self.documents.uri(one.path), self.range(text.lines, one.start, one.end))
            for one in places
            if (text := self.documents.text(one.path)) is not None
        ]

    def asked(self, params: Any) -> Cursor | None:
        """The place in an open document that a request is about."""
        found = self.documents.asked(params.text_document.uri)
        if found is None or params.position.line >= len(found[1].lines.starts):
            return None
        path, text = found
        return Cursor(path, text, self.offset(text.lines, params.position))

    # Problems -----------------------------------------------------------------

    def check_soon(self, path: Path, delay: float) -> None:
        """Check a document soon; a later call replaces an earlier one."""
        if path in self.waiting:
            self.waiting.pop(path).cancel()
        loop = asyncio.get_running_loop()
        self.waiting[path] = loop.call_later(delay, self._check, path)

    def check_now(self, file: Path) -> None:
        """Check the documents that wait for it and have problems in a file: its text has changed."""
        for path in [
            one for one in self.waiting if one == file or file in self.reported.get(one, {})
        ]:
            self.waiting[path].cancel()
            self._check(path)

    def _check(self, path: Path) -> None:
        self.waiting.pop(path, None)
        if path not in self.documents.open:
            return
        try:
            self.tell(path, check(self.documents, path))
        except Exception:  # the next change is checked again
            logger.exception("a document cannot be checked")

    def tell(self, path: Path, found: dict[Path, list[Problem]]) -> None:
        """Publish the problems found by validating a document, and clear old ones."""
        before = self.reported.get(path, {})
        self.reported[path] = found
        for file in sorted({*before, *found}):
            if file == path or before.get(file) != found.get(file):
                self.publish(file)

    def problems(self, file: Path) -> list[Problem]:
        """All problems of a file, from all validated documents."""
        return [one for by_file in self.reported.values() for one in by_file.get(file, ())]

    def publish(self, file: Path) -> None:
        """Publish all problems of a file."""
        text = self.documents.text(file)
        self.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(
                self.documents.uri(file),
                [self.diagnostic(text.lines, one) for one in in_order(self.problems(file))]
                if text
                else [],
                text.version if text else None,
            )
        )

    def diagnostic(self, lines: Lines, problem: Problem) -> lsp.Diagnostic:
        """A problem as an editor shows it."""
        return lsp.Diagnostic(
            self.range(lines, *spot(lines, problem)),
            visible(f"{problem.message} {problem.remedy}".strip()),
            SEVERITIES[problem.severity],
            problem.code,
            source="prima",
        )

    def concerned(self, path: Path) -> list[Path]:
        """Open documents whose problems may change with a document."""
        return [
            other
            for other, text in self.documents.open.items()
            if other != path and is_ours(text.top) and path in files_read(self.documents, other)
        ]

    # Edits --------------------------------------------------------------------

    def edits(
        self, found: list[naming.NameEdit], move: tuple[Path, Path] | None = None
    ) -> lsp.WorkspaceEdit | None:
        """Edits of documents, and a file to move after them."""
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
        """Whether the editor can move files."""
        workspace = self.client_capabilities.workspace
        able = workspace.workspace_edit if workspace else None
        return bool(
            able
            and able.document_changes
            and "rename" in [str(getattr(x, "value", x)) for x in able.resource_operations or ()]
        )

    @property
    def snippets(self) -> bool:
        """Whether the editor supports snippets."""
        document = self.client_capabilities.text_document
        item = document.completion.completion_item if document and document.completion else None
        return bool(item and item.snippet_support)
