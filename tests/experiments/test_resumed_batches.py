"""Batches that are taken up again: only what is missing or changed is done."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from prima.experiments.batch import run_job
from prima.experiments.ledger import InputDigests
from prima.experiments.plan import Job, Options
from tests.helpers.batches import HELLO, POLICIES, files, prima, scenario, write

BATCH = ("a/one.xml", "b", "a/three.xml", *POLICIES)


def test_only_what_is_missing_or_changed_is_done_again(stage: Path) -> None:
    first = prima(*BATCH, "-o", "runs")
    before = files("runs")
    assert (first.returncode, len(before)) == (3, 16)

    def again(count: int, *more: str) -> None:
        done = prima(*BATCH, "-o", "runs", "--resume", *more)
        assert done.stderr.splitlines()[-1] == f"{count} of 8 runs had been made before"
        assert (done.returncode, done.stdout) == (first.returncode, first.stdout)
        assert files("runs").keys() == before.keys()

    again(8)
    os.unlink("runs/a/one.fifo.jsonl")
    os.unlink("runs/b/one.fifo.run.json")
    again(6)
    assert files("runs") == before
    cut = Path("runs/a/three.prima.jsonl")
    cut.write_bytes(cut.read_bytes()[:-20])
    write("runs/b/five.prima.run.json", '{"key": ')
    again(6)
    assert files("runs") == before
    write("a/one.xml", scenario("one", "hello.xml").replace("><robot", ">\n<robot"))
    again(6)
    write("a/hello.xml", HELLO + "\n")
    again(2)
    again(0, "--bound", "3")


@pytest.mark.parametrize(
    "change",
    [
        lambda ledger: ledger["key"].update(prima="0.9"),
        lambda ledger: ledger.update(row=7),
        lambda ledger: ledger["row"].update(records="many"),
        lambda ledger: ledger["row"].update(messages="x"),
        lambda ledger: ledger["row"].pop("exit"),
        lambda ledger: ledger.update(inputs=[1]),
        lambda ledger: ledger.update(transcript=None),
    ],
)
def test_a_ledger_of_another_version_or_that_is_damaged(stage: Path, change: object) -> None:
    assert callable(change)
    options, job = Options(parts="."), Job("a/one.xml", None, "runs/a/one")
    run_job(options, job)
    resumed = Options(parts=".", resume=True)
    assert run_job(resumed, job).earlier
    ledger = Path("runs/a/one.run.json")
    data = json.loads(ledger.read_text())
    change(data)
    ledger.write_text(json.dumps(data))
    row = run_job(resumed, job)
    assert (row.exit, row.earlier) == (0, False), row.messages


VOICE = """<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1" xml:lang="en"><form>
<field name="f"><prompt>Which?<audio src="bell.wav">bell</audio></prompt>
<grammar src="which.grxml" type="application/srgs+xml"/><noinput><exit/></noinput>
<filled><exit/></filled></field></form></vxml>
"""
GRAMMAR = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"
 root="r"><rule id="r"><one-of><item>this</item><item>that</item></one-of></rule></grammar>
"""


def test_what_an_application_fetches_counts_as_well(stage: Path) -> None:
    """Also what is looked at in part alone, or looked for in vain."""
    write("a/voice.vxml", VOICE)
    write("a/which.grxml", GRAMMAR)
    write("a/six.xml", scenario("six", "voice.vxml"))
    options, job = Options(parts=".", resume=True), Job("a/six.xml", None, "runs/a/six")

    def done() -> bool:
        row = run_job(options, job)
        assert (row.exit, row.messages) == (0, [])
        return row.earlier

    assert (done(), done()) == (False, True)
    write("a/which.grxml", GRAMMAR.replace("that", "it"))
    assert (done(), done()) == (False, True)
    Path("a/bell.wav").write_bytes(b"RIFF")
    assert (done(), done()) == (False, True)
    Path("a/bell.wav").write_bytes(b".snd")
    assert (done(), done()) == (False, True)


def test_what_is_no_file_has_no_digest(stage: Path) -> None:
    inputs = InputDigests("a/one.xml")
    for name in ("a/one.xml", "/dev/zero", "a", "a/gone.xml", "a/\0"):
        inputs.text(Path(name).absolute())
    assert [value is None for value in inputs.digests.values()] == [False, True, True, True, True]
