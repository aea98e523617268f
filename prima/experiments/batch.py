"""Batches: scenarios under policies, spread over the cores, each with its own transcript.

A run that fails or dies does not affect the others. Beside each transcript a ledger names the
inputs of its run, so that an interrupted batch can be resumed (docs/batch.md).
"""

from __future__ import annotations

import errno
import json
import os
import signal
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing, nullcontext, suppress
from dataclasses import asdict, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from typing import TYPE_CHECKING

from prima.errors import TOO_MUCH, DocumentError, PrimaError, UsageError
from prima.experiments.ledger import KEPT, InputDigests, earlier_row, key_of
from prima.experiments.plan import LEDGER, TRANSCRIPT, BatchPlan, BatchRow, Job, Options
from prima.markup.limits import set_limits
from prima.pool import Died, cores, spread

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded

# The parent runs nothing itself, so it imports only what it needs.

MOST_MESSAGES = 10
"""Maximum number of messages of a row."""
FULL = (errno.ENOSPC, errno.EROFS, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Write errors that would affect every further run."""


def run_batch(
    plan: BatchPlan, options: Options, workers: int = 0
) -> Generator[BatchRow, None, None]:
    """Make the runs of a plan; yield their rows in order. See :func:`prima.pool.spread`.

    There are so many processes, or with 0 as many as there are cores.

    Raises:
        UsageError: the folder for the transcripts cannot be written to, or is full.
        RunError: no process can be started.
    """
    from prima.loading.writing import parts_folder

    workers = max(min(workers or cores(), len(plan)), 1)
    with parts_folder(plan.output) if plan.output else nullcontext("") as parts:
        options = replace(options, parts=parts)
        made = spread(
            partial(run_job, options),
            plan,
            workers,
            partial(_begin, options),
            partial(rmtree, parts, ignore_errors=True),
        )
        with closing(made):
            yield from _rows(made)


def _rows(made: Iterable[tuple[Job, BatchRow | Died]]) -> Iterator[BatchRow]:
    """The rows of results.

    Raises:
        UsageError: the disk is full.
    """
    for job, result in made:
        row = _dead(job, result) if isinstance(result, Died) else result
        yield row
        if row.full:
            raise UsageError("Nothing more can be written; make room, then --resume.")


def _dead(job: Job, died: Died) -> BatchRow:
    """The row of a run whose process died."""
    message = f"its process ended with code {died.code}."
    if died.code < 0:
        with suppress(ValueError):
            name = signal.Signals(-died.code).name
            message = f"its process was killed by the signal {name}; was there no memory left?"
    return BatchRow(job.scenario, job.policy, 3, messages=[message])


# In worker processes -------------------------------------------------------------------------


def _begin(options: Options) -> None:
    """Apply the parent's limits, and silence stderr: only the parent prints."""
    set_limits(options.limits)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def run_job(options: Options, job: Job) -> BatchRow:
    """Make one run, or find that it is up to date; errors are reported in its row."""
    try:
        if options.resume and job.stem and (row := earlier_row(options, job)):
            return row
        return _run(options, job)
    except Exception as error:
        return _failed(job, error)


def _failed(job: Job, error: Exception) -> BatchRow:
    """The row of a run that an exception ended."""
    match error:
        case DocumentError():
            errors = [str(one) for one in error.problems if one.severity == "error"]
            return BatchRow(job.scenario, job.policy, 1, messages=_few(errors))
        case UsageError():
            code, message = 2, str(error)
        case OSError():
            code, message = 2, f"{job.stem}{TRANSCRIPT}: cannot be written: {error.strerror}."
        case UnicodeEncodeError():
            path = f"{job.scenario}: a transcript cannot name it"
            code, message = 2, f"{path}: its path is not UTF-8; rename it."
        case PrimaError():
            code, message = 3, str(error)
        case MemoryError():
            code, message = 3, "out of memory"
        case _:
            code, message = 3, _defect(error)
    full = isinstance(error, OSError) and error.errno in FULL
    return BatchRow(job.scenario, job.policy, code, messages=[message], full=full)


def _defect(error: Exception) -> str:
    if "PRIMA_DEBUG" in os.environ:
        import traceback

        return "".join(traceback.format_exception(error))
    return f"this is a defect of prima: {type(error).__name__}: {error}. Please report it."


def _few(messages: list[str]) -> list[str]:
    over = len(messages) - MOST_MESSAGES
    return messages if over <= 0 else [*messages[:MOST_MESSAGES], f"and {over} more."]


def _run(options: Options, job: Job) -> BatchRow:
    """Make a run; rename its transcript, then its ledger, once complete."""
    from prima import api
    from prima.loading.files import in_place_of_files

    if job.stem:
        _make_room(job)
    inputs = InputDigests(job.scenario)
    with in_place_of_files(inputs):
        loaded = api.load_scenario(job.scenario)
        if not job.stem:
            made = api.rehearse(loaded, job.policy, keep=False, **options.arguments())
            return _row(job, loaded, made)
        digest = sha256()
        part = os.path.join(options.parts, f"{os.getpid()}{TRANSCRIPT}")
        with open(part, "wb") as stream:

            def sink(line: str) -> None:
                data = line.encode()
                digest.update(data)
                stream.write(data)

            given = options.arguments()
            made = api.rehearse(loaded, job.policy, sink=sink, keep=False, **given)
    row = _row(job, loaded, made)
    os.replace(part, f"{job.stem}{TRANSCRIPT}")
    ledger = {
        "key": key_of(options, job),
        "inputs": inputs.digests,
        "transcript": digest.hexdigest(),
        "row": {name: getattr(row, name) for name in KEPT},
    }
    Path(part).write_text(json.dumps(ledger, ensure_ascii=False) + "\n", encoding="utf-8")
    os.replace(part, f"{job.stem}{LEDGER}")
    return row


def _row(job: Job, loaded: Loaded, made: Transcript) -> BatchRow:
    """The row of a run that ended."""
    measures = asdict(made.summary())
    del measures["starved"]
    messages = [told_failure(failure) for failure in made.failures]
    if made.outcome == "limit":
        messages.append(TOO_MUCH)
    return BatchRow(
        job.scenario,
        job.policy or loaded.cast.scenario.policy,
        3 if messages else 0,
        made.outcome,
        made.measure.records if made.measure else 0,
        transcript=f"{job.stem}{TRANSCRIPT}" if job.stem else None,
        messages=_few(messages),
        **measures,
    )


def told_failure(failure: str) -> str:
    """An application's failure, with a hint if it throws an event that nothing handles."""
    event = failure.split(": ")[1]
    handling = ""
    if ":" not in event and not event.startswith("error."):
        handling = f'. Nothing handles it: write <on event="{event}">, in VoiceXML <catch>.'
    return f"{failure.rstrip(': ')}{handling}"


def _make_room(job: Job) -> None:
    """Remove the files of an earlier run, so that no old file is taken for a new one.

    Raises:
        UsageError: another program wrote them.
    """
    os.makedirs(os.path.dirname(job.stem), exist_ok=True)
    for ending, beginning in ((LEDGER, b'{"key":'), (TRANSCRIPT, b'{"time":0.0,"phase":"run"')):
        path = Path(job.stem + ending)
        with suppress(FileNotFoundError):
            with path.open("rb") as stream:
                data = stream.read(len(beginning)) if path.is_file() else b"?"
            if data not in (b"", beginning):
                raise UsageError(f"{path}: not written by a batch; move it away.")
            path.unlink()
