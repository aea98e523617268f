"""Batches: scenarios under policies, spread over the cores, each with its own transcript.

A run that fails or dies does not affect the others. Beside each transcript a ledger names the
inputs of its run, so that an interrupted batch can be resumed (docs/batch.md).
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import signal
import stat
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prima import __version__
from prima.errors import TOO_MUCH, DocumentError, PrimaError, UsageError
from prima.pool import Died, cores, spread

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded

# The parent runs nothing itself, so it imports only what it needs.

TRANSCRIPT, LEDGER = ".jsonl", ".run.json"
"""Suffixes of a run's files."""
MOST_MESSAGES = 10
"""Maximum number of messages of a row."""
MOST_LEDGER = 1_000_000
"""Maximum length of a ledger (characters)."""
FULL = (errno.ENOSPC, errno.EROFS, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Write errors that would affect every further run."""
MOST_DIGESTS = 10_000
"""Maximum number of digests in memory."""


@dataclass(slots=True)
class Row:
    """The result of one run."""

    scenario: str
    policy: str | None
    """None if none is named and the scenario cannot be read."""
    exit: int = 0
    """0 fine; 1 documents have errors; 2 unreadable or unwritable; 3 an error or a limit."""
    ended: str | None = None
    """How the run ended: ``over``, ``quiet``, ``until`` or ``limit``; None if it did not."""
    records: int = 0
    seconds: float = 0.0
    streams_broken: int = 0
    collisions: int = 0
    reactions: int = 0
    reaction_mean: float = 0.0
    reaction_max: float = 0.0
    responses: int = 0
    response_mean: float = 0.0
    response_max: float = 0.0
    transcript: str | None = None
    messages: list[str] = field(default_factory=list)
    """What went wrong."""
    earlier: bool = False
    """Whether the run was made by an earlier batch."""
    full: bool = False
    """Whether nothing more can be written."""


KEPT = (
    "policy", "exit", "ended", "records", "seconds", "streams_broken", "collisions",
    "reactions", "reaction_mean", "reaction_max",
    "responses", "response_mean", "response_max", "messages",
)  # fmt: skip
"""The fields of a row that a ledger keeps; the rest follows from the job."""


@dataclass(frozen=True, slots=True)
class Job:
    """A run to make: a scenario, a policy (None for its own), its files without suffix."""

    scenario: str
    policy: str | None
    stem: str = ""


@dataclass(frozen=True, slots=True)
class Options:
    """Options shared by all runs of a batch."""

    bound: int | None = None
    hosts: tuple[str, ...] = ()
    resume: bool = False
    limits: Mapping[str, int] = field(default_factory=dict)
    isolate: str = "ea"
    """Which scripts run in a process of their own (see ``prima.api.rehearse``)."""
    parts: str = ""
    """The folder for unfinished transcripts."""
    patience: int | None = None
    """Rule E6's bound (ms), if not the scenario's."""


# Plans ----------------------------------------------------------------------------------


class Plan(Iterable[Job]):
    """The runs of a batch: each scenario under each policy, in order."""

    def __init__(
        self, paths: Iterable[str], policies: Iterable[str] = (), output: str = ""
    ) -> None:
        """Plan a batch.

        Args:
            paths: scenarios, and folders of scenarios.
            policies: policies; by default each scenario's own.
            output: the folder for the transcripts, if they are written.

        Raises:
            UsageError: a policy is unknown, a folder has no scenario, or two
                transcripts would have the same name.
        """
        self.policies: list[str | None] = list(dict.fromkeys(policies)) or [None]
        self.output = output
        _check_policies(self.policies)
        self.scenarios = _gathered(paths)
        if output:
            self._check_names()

    def __len__(self) -> int:
        return len(self.scenarios) * len(self.policies)

    def __iter__(self) -> Iterator[Job]:
        for scenario in self.scenarios:
            for policy in self.policies:
                yield Job(scenario, policy, self._stem(scenario, policy))

    def _stem(self, scenario: str, policy: str | None) -> str:
        """The path of a run's files, without suffix."""
        if not self.output:
            return ""
        stem = os.path.join(self.output, stem_of(scenario))
        return stem if policy is None else stem + re.sub(r"[^\w+.-]", "-", f".{policy}")

    def _check_names(self) -> None:
        taken: dict[str, str] = {}
        for scenario in self.scenarios:
            other = taken.setdefault(stem_of(scenario), scenario)
            if other != scenario:
                name = os.path.join(self.output, stem_of(scenario))
                raise UsageError(
                    f"{scenario}: its transcript has the same name as that of {other}, {name}{TRANSCRIPT}."
                    " Run one of them with another folder after -o."
                )


def stem_of(scenario: str) -> str:
    """The path of a scenario's transcript in the output folder, without suffix.

    It is the scenario's path from the current folder, or else from the file system's root.
    """
    path, here = os.path.abspath(scenario), os.getcwd()
    with suppress(ValueError):  # on different drives
        if os.path.commonpath([path, here]) == here:
            path = os.path.relpath(path, here)
    return os.path.splitext(os.path.splitdrive(path)[1].lstrip(os.sep))[0]


def _check_policies(policies: Sequence[str | None]) -> None:
    from prima.scheduler.policy import policy_named

    for policy in policies:
        if policy is not None:
            try:
                policy_named(policy)
            except UsageError as error:
                raise UsageError(f"{error} fixed:APP prefers the application APP.") from None


def _gathered(paths: Iterable[str]) -> list[str]:
    """The scenarios named, and those in folders named; each file once."""
    found: dict[str, str] = {}
    for path in paths:
        inside = [path]
        if os.path.isdir(path):
            from prima.testing.finding import find

            inside = find([path])
        for one in inside:
            found.setdefault(os.path.realpath(one), os.path.normpath(one))
    return list(found.values())


def run_batch(
    plan: Plan,
    options: Options,
    workers: int = 0,
) -> Generator[Row, None, None]:
    """Make the runs of a plan; yield their rows in order. See :func:`prima.pool.spread`.

    Args:
        plan: the runs.
        options: their common options.
        workers: the number of processes; 0 for the number of cores.

    Raises:
        UsageError: the folder for the transcripts cannot be written to, or is full.
        RunError: no process can be started.
    """
    from prima.markup.limits import LIMITS

    workers = max(min(workers or cores(), len(plan)), 1)
    with _parts(plan.output) as parts:
        options = replace(options, limits=asdict(LIMITS), parts=parts)
        made = spread(
            partial(run_job, options),
            plan,
            workers,
            partial(_begin, options),
            partial(_remove, parts),
        )
        try:
            for job, row in made:
                told = _dead(job, row) if isinstance(row, Died) else row
                yield told
                if told.full:
                    raise UsageError("Nothing more can be written; make room, then --resume.")
        finally:
            made.close()


@contextmanager
def _parts(output: str) -> Iterator[str]:
    """A temporary folder for unfinished files.

    Raises:
        UsageError: it cannot be made.
    """
    if not output:
        yield ""
        return
    from prima.loading.writing import parts_folder

    with ExitStack() as held:
        try:
            parts = held.enter_context(parts_folder(output))
        except FileExistsError:
            message = "this is a file; several transcripts need a folder."
            raise UsageError(f"{output}: {message}") from None
        except OSError as error:
            raise UsageError(f"{output}: cannot be written: {error.strerror}.") from None
        yield parts


def _remove(parts: str) -> None:
    if parts:
        import shutil

        shutil.rmtree(parts, ignore_errors=True)


def _dead(job: Job, died: Died) -> Row:
    """The row of a run whose process died."""
    message = f"its process ended with code {died.code}."
    if died.code < 0:
        with suppress(ValueError):
            name = signal.Signals(-died.code).name
            message = f"its process was killed by the signal {name}; was there no memory left?"
    return Row(job.scenario, job.policy, 3, messages=[message])


# In worker processes -------------------------------------------------------------------------


def _begin(options: Options) -> None:
    """Apply the parent's limits, and silence stderr: only the parent prints."""
    from prima.markup.limits import LIMITS

    for name, number in options.limits.items():
        setattr(LIMITS, name, number)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def run_job(options: Options, job: Job) -> Row:
    """Make one run, or find that it is up to date; errors are reported in its row."""
    try:
        if options.resume and job.stem and (row := _earlier(options, job)):
            return row
        return _run(options, job)
    except DocumentError as error:
        told = [str(one) for one in error.problems if one.severity == "error"]
        return Row(job.scenario, job.policy, 1, messages=_few(told))
    except UsageError as error:
        return Row(job.scenario, job.policy, 2, messages=[str(error)])
    except OSError as error:
        message = f"{job.stem}{TRANSCRIPT}: cannot be written: {error.strerror}."
        return Row(job.scenario, job.policy, 2, messages=[message], full=error.errno in FULL)
    except UnicodeEncodeError:
        message = f"{job.scenario}: a transcript cannot name it: its path is not UTF-8; rename it."
        return Row(job.scenario, job.policy, 2, messages=[message])
    except PrimaError as error:
        return Row(job.scenario, job.policy, 3, messages=[str(error)])
    except MemoryError:
        return Row(job.scenario, job.policy, 3, messages=["out of memory"])
    except Exception as error:
        message = f"this is a defect of prima: {type(error).__name__}: {error}. Please report it."
        if "PRIMA_DEBUG" in os.environ:
            import traceback

            message = traceback.format_exc()
        return Row(job.scenario, job.policy, 3, messages=[message])


def _few(messages: list[str]) -> list[str]:
    over = len(messages) - MOST_MESSAGES
    return messages if over <= 0 else [*messages[:MOST_MESSAGES], f"and {over} more."]


def _run(options: Options, job: Job) -> Row:
    """Make a run; rename its transcript, then its ledger, once complete."""
    from prima import api
    from prima.loading.files import in_place_of_files

    if job.stem:
        _make_room(job)
    inputs = Inputs(job.scenario)
    with in_place_of_files(inputs):
        loaded = api.load_scenario(job.scenario)
        inputs.look_at_sounds(loaded)
        if not job.stem:
            made = _rehearse(options, loaded, job.policy, None)
            return _row(job, loaded, made)
        digest = sha256()
        part = os.path.join(options.parts, f"{os.getpid()}{TRANSCRIPT}")
        with open(part, "wb") as stream:

            def sink(line: str) -> None:
                data = line.encode()
                digest.update(data)
                stream.write(data)

            made = _rehearse(options, loaded, job.policy, sink)
    row = _row(job, loaded, made)
    os.replace(part, f"{job.stem}{TRANSCRIPT}")
    ledger = {
        "key": _key(options, job),
        "inputs": inputs.digests,
        "transcript": digest.hexdigest(),
        "row": {name: getattr(row, name) for name in KEPT},
    }
    Path(part).write_text(json.dumps(ledger, ensure_ascii=False) + "\n", encoding="utf-8")
    os.replace(part, f"{job.stem}{LEDGER}")
    return row


def _row(job: Job, loaded: Loaded, made: Transcript) -> Row:
    """The row of a run that ended."""
    measure, summary = made.measure, made.summary()
    messages = [told_failure(failure) for failure in made.failures]
    if made.outcome == "limit":
        messages.append(TOO_MUCH)
    return Row(
        job.scenario,
        job.policy or loaded.cast.scenario.policy,
        3 if messages else 0,
        made.outcome,
        measure.records if measure else 0,
        summary.seconds,
        summary.streams_broken,
        summary.collisions,
        summary.reactions,
        summary.reaction_mean,
        summary.reaction_max,
        summary.responses,
        summary.response_mean,
        summary.response_max,
        f"{job.stem}{TRANSCRIPT}" if job.stem else None,
        _few(messages),
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


# Inputs -----------------------------------------------------------------------------------


class Inputs(Mapping[Path, bytes]):
    """Records the digest of every file that a run reads; provides none itself."""

    def __init__(self, scenario: str) -> None:
        self.digests: dict[str, str | None] = {}
        """By paths from the scenario's folder; None if there is no such file."""
        self._folder = os.path.dirname(os.path.realpath(scenario))

    def __bool__(self) -> bool:
        return True

    def __getitem__(self, path: Path) -> bytes:
        name = os.path.relpath(path, self._folder)
        if name not in self.digests:
            self.digests[name] = file_digest(path)
        raise KeyError(path)

    def __iter__(self) -> Iterator[Path]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def look_at_sounds(self, loaded: Loaded) -> None:
        """Record audio files too, of which applications read only the beginning."""
        from prima.interpreter.elements import Document

        for document in loaded.cast.documents:
            if not isinstance(document, Document) and document.glance is not None:
                folder = Path(document.folder).resolve()
                document.glance = partial(self._glance, document.glance, folder)

    def _glance(
        self, glance: Callable[[str, int], tuple[bytes, int]], folder: Path, uri: str, most: int
    ) -> tuple[bytes, int]:
        from urllib.parse import unquote, urlsplit

        path = (folder / unquote(urlsplit(uri).path).lstrip("/")).resolve()
        if folder in path.parents:
            self.get(path)
        return glance(uri, most)


_digests: dict[tuple[str, int, int, int], str] = {}
"""Digests of files by path, modification time, size and inode."""


def file_digest(path: str | Path) -> str | None:
    """A file's SHA-256, or None if there is no such file."""
    try:
        state = os.stat(path)
        if not stat.S_ISREG(state.st_mode):
            return None
        key = (str(path), state.st_mtime_ns, state.st_size, state.st_ino)
        if key not in _digests:
            if len(_digests) >= MOST_DIGESTS:
                _digests.clear()
            with open(path, "rb") as stream:
                _digests[key] = hashlib.file_digest(stream, "sha256").hexdigest()
        return _digests[key]
    except (OSError, ValueError):
        return None


def _rehearse(
    options: Options, loaded: Loaded, policy: str | None, sink: Callable[[str], object] | None
) -> Transcript:
    """Run a scenario with the common options, without keeping its records."""
    from prima import api

    more = options.hosts, options.isolate, options.patience
    return api.rehearse(loaded, policy, options.bound, sink, False, *more)


def _key(options: Options, job: Job) -> dict[str, Any]:
    """What determines a run, apart from its files."""
    return {
        "prima": __version__,
        "scenario": job.scenario,
        "policy": job.policy,
        "bound": options.bound,
        "patience": options.patience,
        "hosts": list(options.hosts),
        "limits": dict(options.limits),
    }


def _earlier(options: Options, job: Job) -> Row | None:
    """The row of the same run in an earlier batch, if its inputs and transcript are unchanged."""
    try:
        with open(f"{job.stem}{LEDGER}", encoding="utf-8") as stream:
            ledger = json.loads(stream.read(MOST_LEDGER))
        folder = os.path.dirname(os.path.realpath(job.scenario))
        inputs: dict[str, str | None] = ledger["inputs"]
        if (
            ledger["key"] != _key(options, job)
            or any(file_digest(os.path.join(folder, one)) != inputs[one] for one in inputs)
            or file_digest(f"{job.stem}{TRANSCRIPT}") != ledger["transcript"]
        ):
            return None
        kept = {name: ledger["row"][name] for name in KEPT}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    fresh = Row(job.scenario, transcript=f"{job.stem}{TRANSCRIPT}", earlier=True, **kept)
    return fresh if _sound(fresh) else None


def _sound(row: Row) -> bool:
    """Whether a row from a ledger has values of the right types."""
    whole = (
        row.exit,
        row.records,
        row.streams_broken,
        row.collisions,
        row.reactions,
        row.responses,
    )
    times = (row.reaction_mean, row.reaction_max, row.response_mean, row.response_max)
    parts = (row.seconds, *times)
    words = (row.policy, row.ended, *(row.messages if isinstance(row.messages, list) else [0]))
    return (
        all(type(one) is int for one in whole)
        and all(type(one) in (int, float) for one in parts)
        and all(type(one) is str for one in words)
    )


# Output -----------------------------------------------------------------------------------


COLUMNS = (
    ("policy", 8),
    ("exit", 4),
    ("ended", 5),
    ("records", 7),
    ("seconds", 8),
    ("broken", 6),
    ("reactions", 9),
    ("mean s", 6),
    ("responses", 9),
    ("mean s", 6),
)
"""Headings after the scenario's, and minimum widths."""


def row_data(row: Row) -> dict[str, Any]:
    """A row as data for JSON; it does not depend on when or how the run was made."""
    data = asdict(row)
    del data["earlier"], data["full"]
    return data


def format_head(wide: int) -> str:
    """The headings, with a column of this width for scenarios."""
    return _line(["scenario", *(head for head, _ in COLUMNS)], wide)


def format_row(row: Row, wide: int) -> str:
    """A row of the table."""
    cells = [row.scenario, row.policy or "-", str(row.exit), row.ended or "-"]
    if row.ended is None:
        return _line(cells, wide)
    cells += [str(row.records), f"{row.seconds:.2f}", str(row.streams_broken)]
    cells += [str(row.reactions), f"{row.reaction_mean:.2f}"]
    return _line([*cells, str(row.responses), f"{row.response_mean:.2f}"], wide)


def _line(cells: list[str], wide: int) -> str:
    widths = [wide, *(width for _, width in COLUMNS)]
    return "  ".join(
        cell.ljust(width) if index in (0, 1, 3) else cell.rjust(width)
        for index, (cell, width) in enumerate(zip(cells, widths, strict=False))
    ).rstrip()


def format_counts(exits: Mapping[int, int]) -> str:
    """The number of runs for each exit code."""
    parts = [f"runs: {sum(exits.values())}", f"fine: {exits.get(0, 0)}"]
    return "; ".join(parts + [f"exit code {one}: {exits[one]}" for one in sorted(exits) if one])
