"""What the tests of this room share."""

from __future__ import annotations

import shutil
from collections.abc import Iterator

import pytest
from lsprotocol import types as lsp

from tests import ROOT
from tests.helpers.editor import Editor


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
