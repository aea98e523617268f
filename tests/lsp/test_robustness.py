"""Strange questions, mangled documents and wrong messages end nothing."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lsprotocol import types as lsp

from prima.lsp import naming, server
from prima.lsp.complete import complete
from prima.lsp.hover import hover
from prima.lsp.names import marks
from prima.lsp.outline import links, outline
from prima.lsp.paths import path_of
from prima.lsp.problems import check, spot
from prima.lsp.protocol import Server
from prima.lsp.scan import ScannedText
from prima.lsp.tables import resolve
from prima.lsp.text import UTF8, UTF16, UTF32, Lines
from prima.lsp.workspace import Workspace
from tests import ROOT
from tests.helpers.editor import BEGIN, SECONDS, WRONG, Editor


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
    for problem in check(workspace, path)[path]:
        start, end = spot(page.lines, problem)
        assert 0 <= start <= end <= len(page.text)
        for span, _ in (edit for fix in problem.fixes for edit in fix.edits):
            start, end = page.lines.offsets(span)
            assert 0 <= start <= end <= len(page.text)


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
    page = ScannedText(text)
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


def test_a_name_that_is_too_long_leads_nowhere(tmp_path: Path) -> None:
    field = (
        f'<form id="a"><field name="b"><grammar src="{"x" * 300}.grxml"/></field></form></prima>'
    )
    workspace = Workspace()
    path = workspace.put((tmp_path / "x.xml").as_uri(), BEGIN + field)
    assert path is not None and workspace.named(path)
    assert links(workspace, path) == []
    offset = (BEGIN + field).index("xxx")
    everything(workspace, path, offset)
    assert naming.rename(workspace, path, offset, "y" * 300)


def test_a_text_that_is_nested_too_deep_has_an_outline(editor: Editor) -> None:
    problems = editor.open("fa/deep.xml", BEGIN + '<form id="a">' * 3_000)
    assert [one.code for one in problems] == ["too-deep"]
    asked = lsp.DocumentSymbolParams(lsp.TextDocumentIdentifier(editor.uri("fa/deep.xml")))
    assert editor.do(editor.client.text_document_document_symbol_async(asked))
    editor.close("fa/deep.xml")


def test_it_ends_when_the_editor_is_gone() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=SECONDS,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_an_editor_that_no_longer_listens_is_told_nothing() -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    speak(process, BEGINNING)
    hear(process)
    assert process.stdin is not None and process.stdout is not None
    process.stdout.close()
    item = {"uri": "file:///x.xml", "languageId": "xml", "version": 1, "text": BEGIN}
    told = {"method": lsp.TEXT_DOCUMENT_DID_OPEN, "params": {"textDocument": item}}
    speak(process, {"jsonrpc": "2.0", **told})
    speak(process, {**HOVER, "id": 1})
    process.stdin.close()
    assert process.stderr is not None
    assert (process.stderr.read(), process.wait(SECONDS)) == (b"", 0)


def test_what_is_no_message_does_not_end_it() -> None:
    noise = b"Content-Length: 5\r\n\r\nhello" + b"Content-Length: 2\r\n\r\n{}" + b"nonsense\r\n"
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"], input=noise, capture_output=True, timeout=SECONDS
    )
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr


@pytest.mark.parametrize("size", ["999999999999", "9" * 30])
def test_a_message_that_is_too_long_is_not_waited_for(size: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"],
        input=f"Content-Length: {size}\r\n\r\n{{}}".encode(),
        capture_output=True,
        timeout=SECONDS,
    )
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr == b"prima: the editor sends more than 100,000,000 bytes at once.\n"


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
    data = message if isinstance(message, bytes) else json.dumps(message).encode()
    process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))
    process.stdin.flush()


def hear(process: subprocess.Popen[bytes]) -> Any:
    assert process.stdout is not None
    size = 0
    while line := process.stdout.readline().strip():
        size = int(line.partition(b":")[2]) if line.lower().startswith(b"content-length") else size
    return json.loads(process.stdout.read(size))


HOVER = {"jsonrpc": "2.0", "method": lsp.TEXT_DOCUMENT_HOVER, "params": WHERE}
BEGINNING: Any = {
    "jsonrpc": "2.0", "id": 0, "method": "initialize",
    "params": {"processId": None, "rootUri": None, "capabilities": {}},
}  # fmt: skip
ODD_NAMES: list[Any] = [None, 5, {}, []]
NO_MESSAGES: list[tuple[Any, Any, int]] = [
    *(([{**HOVER, "id": 1}], None, -32600), ([], None, -32600), (5, None, -32600), (None, None, -32600)),
    *(({**HOVER, "id": {}}, None, -32600), ({**HOVER, "id": [1]}, None, -32600)),
    *(({**HOVER, "id": 1, "method": name}, 1, -32600) for name in ODD_NAMES),
    *(({**HOVER, "id": 1, "jsonrpc": mark}, 1, -32600) for mark in (None, "1.0", 2.0)),
    ({"id": 1, "method": "shutdown"}, 1, -32600),
    ({**HOVER, "id": 1, "method": "no/such"}, 1, -32601),
    ({**HOVER, "id": 1, "method": "textDocument/didOpen"}, 1, -32602),
    ({**HOVER, "id": 1, "method": "textDocument/didClose"}, 1, -32600),
    *((text, None, -32700) for text in (b"{", b"hello", b"[" * 100_000, b"\xff", b"9" * 5_000)),
]  # fmt: skip


@contextmanager
def served(ends: int = 0) -> Iterator[subprocess.Popen[bytes]]:
    """A server of its own, which writes nothing but messages and ends when it is told to."""
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    yield process
    speak(process, {"jsonrpc": "2.0", "method": "exit"})
    assert process.stderr is not None
    assert (process.wait(SECONDS), process.stderr.read()) == (ends, b"")


def test_what_is_no_request_is_answered_and_the_server_goes_on() -> None:
    with served(ends=1) as process:
        speak(process, BEGINNING)
        assert hear(process)["id"] == 0
        for message, asked, code in NO_MESSAGES:
            speak(process, message)
            answer = hear(process)
            assert (answer["id"], answer["error"]["code"]) == (asked, code), message
            assert "data" not in answer["error"], "no traceback"
        speak(process, {**HOVER, "id": 2})
        assert hear(process) == {"jsonrpc": "2.0", "id": 2, "result": None}


def test_requests_before_the_beginning_and_after_the_end_are_refused() -> None:
    with served() as process:
        speak(process, {**HOVER, "id": 1})
        assert hear(process)["error"]["code"] == -32002
        wrong = {**BEGINNING["params"], "rootUri": "http://[::1"}
        speak(process, {**BEGINNING, "params": wrong})
        assert hear(process)["error"]["code"] == -32602
        speak(process, {"jsonrpc": "2.0", "method": "initialized", "params": {}})
        speak(process, BEGINNING)
        assert "result" in hear(process)
        speak(process, {"jsonrpc": "2.0", "id": 2, "method": "shutdown"})
        assert hear(process)["result"] is None
        for method in ("shutdown", lsp.TEXT_DOCUMENT_HOVER):
            speak(process, {**HOVER, "id": 3, "method": method})
            assert hear(process)["error"]["code"] == -32600


def test_wrong_parameters_are_answered_as_such_and_the_server_goes_on() -> None:
    with served() as process:
        speak(process, BEGINNING)
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


@pytest.mark.parametrize("begun", [True, False])
def test_an_editor_that_leaves_without_shutdown_gets_exit_code_1(begun: bool) -> None:
    with served(ends=1) as process:
        if begun:
            speak(process, BEGINNING)
            assert hear(process)["id"] == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_a_server_that_waits_for_its_editor(number: signal.Signals) -> None:
    """Its exception waited until the editor sent something, and then the exit code was 0."""
    with subprocess.Popen(
        [sys.executable, "-m", "prima", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        speak(process, BEGINNING)
        assert hear(process)["id"] == 0
        process.send_signal(number)
        assert process.wait(SECONDS) == -number
