"""How long an editor waits for problems and proposals: ``python -m bench.editor [ELEMENTS]``.

A document is changed again and again over stdio; measured is the time from a change to the
problems that the server publishes, both processes and the wire included.
"""

from __future__ import annotations

import asyncio
import statistics
import sys
import time
from pathlib import Path

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

CHANGES = 60
SETTLE_SECONDS = 2.0
FORM = """  <form id="f{n}">
    <var name="n{n}" expr="{n}"/>
    <block>
      <speak>This is number <value expr="n{n} + seen"/>.</speak>
      <assign name="seen" expr="seen + 1"/>
      <if cond="seen &gt; {n}">
        <speak>Many.</speak>
        <move-head pan="20"/>
      </if>
    </block>
    <field name="a{n}" type="boolean">
      <prompt>Go on to {n}?</prompt>
      <filled><if cond="a{n}"><goto next="#f{m}"/><else/><exit/></if></filled>
      <noinput><exit/></noinput>
    </field>
    <on event="touch.head"><speak>Yes?</speak><goto next="#f0"/></on>
  </form>
"""
ELEMENTS_OF_A_FORM = 20


def document(elements: int) -> str:
    """An application of about so many elements: forms that ask and go on to the next."""
    forms = max(elements // ELEMENTS_OF_A_FORM, 1)
    parts = [FORM.format(n=n, m=(n + 1) % forms) for n in range(forms)]
    begin = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="big">'
    return f'{begin}\n  <var name="seen" expr="0"/>\n{"".join(parts)}</prima>\n'


async def measure(elements: int) -> list[float]:
    """Milliseconds from a change to its problems, for each of many changes."""
    client = LanguageClient("bench", "1")
    told: asyncio.Queue[int | None] = asyncio.Queue()

    def published(params: lsp.PublishDiagnosticsParams) -> None:
        told.put_nowait(params.version)

    client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(published)
    await client.start_io(sys.executable, "-m", "prima", "lsp")
    await client.initialize_async(lsp.InitializeParams(capabilities=lsp.ClientCapabilities()))
    client.initialized(lsp.InitializedParams())
    await asyncio.sleep(SETTLE_SECONDS)
    uri, text = Path("/nowhere/at/all/big.xml").as_uri(), document(elements)
    client.text_document_did_open(
        lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, "xml", 1, text))
    )
    await told.get()
    taken = []
    for version in range(2, CHANGES + 2):
        changed = text.replace("Many.", f"Many {version}.", 1)
        start = time.perf_counter()
        client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(uri=uri, version=version),
                [lsp.TextDocumentContentChangeWholeDocument(text=changed)],
            )
        )
        while await told.get() != version:
            pass
        taken.append(1000 * (time.perf_counter() - start))
    await client.shutdown_async(None)
    client.exit(None)
    await client.stop()  # type: ignore[no-untyped-call]
    return taken


def problems(elements: int) -> float:
    """Seconds from a change of a document of so many elements to its problems: the median."""
    return statistics.median(asyncio.run(measure(elements))) / 1000


def main() -> None:
    """Measure and print."""
    elements = int(sys.argv[1]) if len(sys.argv) > 1 else 2_000
    taken = asyncio.run(measure(elements))
    quick = statistics.quantiles(taken, n=10)
    print(
        f"{elements:,} elements, {CHANGES} changes: problems after {statistics.median(taken):.0f} ms"
        f" (fastest {min(taken):.0f} ms, nine of ten within {quick[8]:.0f} ms)"
    )


if __name__ == "__main__":
    main()
