"""Answers to the questions of an editor, in the terms of the Language Server Protocol."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from prima.errors import Problem, in_order
from prima.errors.visible import visible
from prima.lsp import naming
from prima.lsp import outline as outlines
from prima.lsp.complete import Proposal, complete
from prima.lsp.hover import hover as meaning
from prima.lsp.paths import path_of
from prima.lsp.problems import spot
from prima.lsp.protocol import Cursor, Server
from prima.lsp.scan import ScannedText
from prima.markup.limits import LIMITS

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


def completion(server: Server, params: lsp.CompletionParams, at: Cursor) -> lsp.CompletionList:
    """Proposals at the cursor."""
    typed = params.context.trigger_character if params.context else None
    found = complete(server.documents, at.path, at.offset, typed or "")
    items = [_item(server, at.text.page, one, n) for n, one in enumerate(found)]
    return lsp.CompletionList(is_incomplete=False, items=items)


def _item(server: Server, page: ScannedText, one: Proposal, number: int) -> lsp.CompletionItem:
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


def hover(server: Server, params: lsp.HoverParams, at: Cursor) -> lsp.Hover | None:
    """The meaning of what is under the mouse."""
    found = meaning(server.documents, at.path, at.offset)
    if found is None:
        return None
    return lsp.Hover(
        lsp.MarkupContent(lsp.MarkupKind.Markdown, visible(found.text, "\n")),
        server.range(at.text.lines, found.start, found.end),
    )


def definition(
    server: Server, params: lsp.DefinitionParams, at: Cursor
) -> list[lsp.Location] | None:
    """Where the name at the cursor is defined."""
    return server.locations(naming.definitions(server.documents, at.path, at.offset)) or None


def references(
    server: Server, params: lsp.ReferenceParams, at: Cursor
) -> list[lsp.Location] | None:
    """Where the name at the cursor is used."""
    own = params.context.include_declaration
    return server.locations(naming.references(server.documents, at.path, at.offset, own)) or None


def highlight(
    server: Server, params: lsp.DocumentHighlightParams, at: Cursor
) -> list[lsp.DocumentHighlight]:
    """The uses of a name in its document."""
    return [
        lsp.DocumentHighlight(server.range(at.text.lines, one.start, one.end))
        for one in naming.references(server.documents, at.path, at.offset)
        if one.path == at.path
    ]


def prepare_rename(
    server: Server, params: lsp.PrepareRenameParams, at: Cursor
) -> lsp.PrepareRenamePlaceholder | None:
    """The name at the cursor, if it can be renamed."""
    found = naming.renamable(server.documents, at.path, at.offset)
    if found is None:
        return None
    place = server.range(at.text.lines, found.start, found.end)
    return lsp.PrepareRenamePlaceholder(place, at.text.text[found.start : found.end])


def rename(server: Server, params: lsp.RenameParams, at: Cursor) -> lsp.WorkspaceEdit | None:
    """The edits that rename a name."""
    try:
        found, move = naming.rename(server.documents, at.path, at.offset, params.new_name)
    except naming.RenameError as error:
        raise JsonRpcException(str(error), REQUEST_FAILED) from None
    if move is not None and not server.moves_files:
        message = "This editor lets no server move a file: move it yourself."
        raise JsonRpcException(message, REQUEST_FAILED)
    return server.edits(found, move)


def will_move(server: Server, params: lsp.RenameFilesParams) -> lsp.WorkspaceEdit | None:
    """The edits that follow from moving files."""
    named = [(path_of(file.old_uri), path_of(file.new_uri)) for file in params.files]
    moves = {old: new for old, new in named if old is not None and new is not None}
    return server.edits(naming.moved(server.documents, moves))


def symbols(server: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol] | None:
    """A document's outline."""
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    page = found[1].page
    return [_symbol(server, page, part) for part in outlines.outline(page)]


def _symbol(
    server: Server, page: ScannedText, part: outlines.OutlineElement, depth: int = 1
) -> lsp.DocumentSymbol:
    """A part and those in it, as deep as a document may be."""
    return lsp.DocumentSymbol(
        visible(part.name),
        lsp.SymbolKind[part.sort.capitalize()],
        server.range(page.lines, part.start, part.end),
        server.range(page.lines, part.name_start, part.name_end),
        visible(part.detail) or None,
        children=[_symbol(server, page, one, depth + 1) for one in part.parts]
        if depth < LIMITS.depth
        else [],
    )


def links(server: Server, params: lsp.DocumentLinkParams) -> list[lsp.DocumentLink] | None:
    """The files that a document names."""
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    path, text = found
    return [
        lsp.DocumentLink(server.range(text.lines, start, end), server.documents.uri(target))
        for target, start, end in outlines.links(server.documents, path)
    ]


def actions(server: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction] | None:
    """Quick fixes."""
    found = server.documents.asked(params.text_document.uri)
    if found is None:
        return None
    path, text = found
    server.check_now(path)
    page = text.page
    first, last = (server.offset(page.lines, at) for at in (params.range.start, params.range.end))
    made: list[lsp.CodeAction] = []
    for problem in in_order(server.problems(path)):
        start, end = spot(page.lines, problem)
        if end >= first and start <= last:
            made += _quick_fixes(server, page, problem, params.text_document.uri)
    return made


def _quick_fixes(
    server: Server, page: ScannedText, problem: Problem, uri: str
) -> Iterator[lsp.CodeAction]:
    """The fixes of a problem, the preferred one first."""
    for number, (title, changes) in enumerate(problem.fixes):
        edits = [
            lsp.TextEdit(server.range(page.lines, *page.lines.offsets(span)), text)
            for span, text in changes
        ]
        yield lsp.CodeAction(
            visible(title),
            lsp.CodeActionKind.QuickFix,
            [server.diagnostic(page.lines, problem)],
            is_preferred=number == 0,
            edit=lsp.WorkspaceEdit(changes={uri: edits}),
        )


def linked(
    server: Server, params: lsp.LinkedEditingRangeParams, at: Cursor
) -> lsp.LinkedEditingRanges | None:
    """The names in a start tag and its end tag, which are edited together."""
    for tag in at.text.page.tags:
        if tag.close is None or not tag.name:
            continue
        spans = ((tag.start + 1, tag.name_end), tag.close)
        if any(start <= at.offset <= end for start, end in spans):
            return lsp.LinkedEditingRanges([server.range(at.text.lines, *span) for span in spans])
    return None
