"""The package's functions: load, validate, rehearse, read, replay, diff, explain.

The command line does nothing that is not here. These functions open files;
everything below them works on text and values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import IO, TYPE_CHECKING

from prima.errors import DocumentError, Problem, RunError, UsageError, did_you_mean
from prima.interpreter.elements import Document
from prima.language.values import LONGEST_MS
from prima.loading import (
    Loaded,
    documents_folder,
    load,
    load_scenario,
    seeded,
    stage,
    validate,
)
from prima.loading.heads import VERSION, check_files, chosen_policy, run_record
from prima.messages import Record

if TYPE_CHECKING:
    from prima.exports import Exported
    from prima.interpreter.bounds import ElementVisit
    from prima.scheduler.behavior import Application
    from prima.sim.rehearsal import Rehearsal
    from prima.sim.services import Web
    from prima.transcript.diff import Difference
    from prima.transcript.measures import Measure, Summary
    from prima.transcript.record import Entry
    from prima.transcript.row import Row
    from prima.transcript.run import Run

# Modules that only some functions need are imported there, so that short commands start quickly.

MOST_MORE = 1000
"""Records that a replay makes at most beyond those of its transcript: it differs anyway."""
FASTEST = 1000.0
"""How many times as fast as real time a live run may go."""
LACKING = "a record lacks a field of its phase."


@dataclass(slots=True)
class Transcript:
    """The records of a run, times in seconds, with views of them."""

    records: list[Record]
    """Empty if they were not kept."""
    name: str = ""
    failures: list[str] = field(default_factory=list)
    """Applications that ended by an error, as ``NAME: ERROR``."""
    defects: list[Exception] = field(default_factory=list)
    """Defects of PRIMA that ended applications."""
    outcome: str = ""
    """How the run ended: ``over``, ``quiet``, ``until`` or ``limit``."""
    unfinished: list[str] = field(default_factory=list)
    """If the run was stopped at ``until``, the activity of each application still running."""
    cut: str = ""
    """The error in the line at which a partial transcript ends."""
    visits: list[ElementVisit] = field(default_factory=list)
    """The elements that applications reached in their documents, if they were kept."""
    measure: Measure | None = None
    """Counts made during the run."""

    made: list[Row] | None = None
    """The rows, if the records were not kept."""
    _run: Run | None = field(default=None, repr=False, compare=False)

    def rows(self) -> list[Row]:
        """The rows of the table."""
        return _made_of(self.name, self.run().entries) if self.made is None else self.made

    def run(self) -> Run:
        """The run as folded from its records, once.

        Raises:
            UsageError: a record lacks a field of its phase.
        """
        from prima.transcript.run import run_of

        if self._run is None or len(self._run.entries) != len(self.records):
            self._run = run_of(self.records, self.name)
        return self._run

    def table(self, why: bool = False, columns: int = 80) -> str:
        """The table as text, at most this wide if the names of applications allow it.

        With ``why``, each row has the rule that put it there.
        """
        from prima.transcript.table import format_rows

        return format_rows(self.rows(), why, columns)

    def summary(self) -> Summary:
        """The counts and measures of the run.

        Raises:
            UsageError: a record lacks a field of its phase.
        """
        from prima.transcript.measures import summarize

        return self.measure.summary() if self.measure else summarize(self.run())

    @property
    def early(self) -> str:
        """A message that the records end before their run did; empty if they do not."""
        if self.cut or not self.records or self.records[0]["phase"] != "run":
            return ""
        last = self.records[-1]
        return "" if last["phase"] == "over" else ends_early(self.name, last["time"])

    def dumps(self) -> str:
        """The transcript as JSON lines."""
        from prima.transcript.lines import line

        made = ({**record, "time": record["time"] * 1000} for record in self.records)
        return "".join(line(record) for record in made)


def _made_of(name: str, entries: Iterable[Entry]) -> list[Row]:
    """The rows of a transcript.

    Raises:
        UsageError: a record lacks a field of its phase.
    """
    from prima.transcript.rows import make_rows

    try:
        return make_rows(entries)
    except (KeyError, TypeError, ValueError, AttributeError):
        raise UsageError(f"{name}: {LACKING}") from None


def ends_early(name: str, seconds: float) -> str:
    """The message for a transcript whose last record is not the end of its run."""
    return f"{name}: the transcript ends at {seconds:.3f} s, before its run did."


Sink = Callable[[str], object]


def rehearse(
    scenario: str | Path | Loaded,
    policy: str | None = None,
    bound: int | None = None,
    sink: Sink | None = None,
    keep: bool = True,
    hosts: Iterable[str] = (),
    isolate: str = "ea",
    patience: int | None = None,
    visits: bool = False,
    rows: bool = False,
    seed: int | None = None,
) -> Transcript:
    """Run a scenario in simulation.

    Args:
        scenario: its path, or the result of :func:`load_scenario`.
        policy: a policy's name (docs/mediation.md lists them) or ``fixed:APP``;
            by default the scenario's own.
        bound: rule E4's bound on loops of a feedback Command.
        sink: called with each line of the transcript as soon as it is made.
        keep: whether to keep the records in memory.
        hosts: hosts from which applications may fetch by http and https, as ``HOST`` or
            ``HOST:PORT``; services of the scenario answer first.
        isolate: which scripts run in a process of their own: those of each EA, with one for
            all FAs (``ea``), those of each application (``all``), or none (``none``: then
            nothing stops a script that escapes the engine's limits).
        patience: rule E6's bound (ms) on how long an application may keep others from the
            speaker, 0 for no bound; by default the scenario's own.
        visits: whether to keep the elements that applications reach in their documents.
        rows: whether to make the table's rows even if the records are not kept.
        seed: what is drawn in the run depends on it alone; by default the scenario's own.

    Raises:
        DocumentError: documents have errors.
        UsageError: a policy or file is unknown, or a host is not a host name.
    """
    from collections import deque

    from prima.sim.rehearsal import Rehearsal
    from prima.transcript.lines import finished, line
    from prima.transcript.measures import Measure
    from prima.transcript.record import Entry

    loaded = scenario if isinstance(scenario, Loaded) else load_scenario(scenario)
    loaded = seeded(loaded, seed)
    cast = loaded.cast
    name = cast.scenario.policy if policy is None else policy
    chosen = chosen_policy(name, loaded)
    if patience is None:
        patience = cast.scenario.patience
    web = fetcher(list(hosts), len(cast.documents))
    rehearsal = Rehearsal(cast, chosen, bound, web, isolate, patience)
    head = run_record(loaded, name, bound, patience)
    measure = Measure()
    made = Transcript([], cast.scenario.id, measure=measure)

    def entries() -> Iterator[Entry]:
        for records in chain([[head]], rehearsal.run()):
            for record in records:
                entry = Entry(record, record["time"] / 1000)
                measure.add(entry)
                yield entry
                if keep:
                    made.records.append(finished(record))
                if sink is not None:
                    sink(line(record))
            if visits:
                made.visits += rehearsal.visits

    if rows:
        made.made = _made_of(made.name, entries())
    else:
        deque(entries(), maxlen=0)
    made.failures = list(rehearsal.session.failures)
    made.defects = list(rehearsal.session.defects)
    made.outcome = rehearsal.outcome
    if made.outcome == "until":
        made.unfinished = _unfinished(rehearsal)
    return made


def _unfinished(rehearsal: Rehearsal) -> list[str]:
    """The activity of each application still running as a run is stopped, as ``NAME is ...``."""
    memory, owed = rehearsal.session.mediator.memory, rehearsal.devices.services.owed
    there = [name for name, app in rehearsal.session.apps.items() if not app.over]
    return [
        f"{name} is {_doing(memory.apps[name], name in owed)}"
        for name in there
        if name in memory.apps
    ]


def _doing(app: Application, owed: bool) -> str:
    """The activity of an application; ``owed`` if a service has not answered it yet."""
    from prima.scheduler.behavior import RUNNING, WAITING
    from prima.transcript.row import describe

    for behavior in app.members.values():
        if behavior.state is RUNNING and behavior.unit is None:
            command = behavior.command
            if command is None:
                return "in the middle of a unit"
            what = describe(command.type, command.text, dict(command.args))
            return f"asking {what}" if command.type == "q-and-a" else f"in the middle of {what}"
    if any(behavior.state is WAITING for behavior in app.members.values()):
        return "waiting for its turn"
    return "waiting for a service's answer" if owed else "waiting for an event"


def fetcher(hosts: list[str], applications: int) -> Web | None:
    """A fetcher for some hosts, or None; only then are network modules imported."""
    if not hosts:
        return None
    from prima.loading.web import Hosts

    for host in hosts:
        if not re.fullmatch(r"[A-Za-z0-9._-]+(:[0-9]{1,5})?", host):
            raise UsageError(
                f'"{host}" is not a host name: write a name and a port, such as example.org:8080.'
            )
    return Hosts(hosts, applications)


def read(path: str | Path, partial: bool = False) -> Transcript:
    """Read a transcript; with ``partial``, up to its first unreadable line.

    Raises:
        UsageError: it cannot be read, or is none; the line is named.
    """
    cut: list[str] | None = [] if partial else None
    records = list(_records(path, cut))
    return Transcript(records, str(path), cut=" ".join(cut or ()))


def skim(path: str | Path) -> Transcript:
    """Read a transcript up to its first unreadable line; keep only its rows and counts.

    Only the first and last records are kept, so that a long transcript takes much less memory
    than with :func:`read`.

    Raises:
        UsageError: it cannot be read, or is none; the line is named.
    """
    from prima.transcript.measures import Measure
    from prima.transcript.record import Entry

    cut: list[str] = []
    kept: list[Record] = []
    measure = Measure()

    def entries() -> Iterator[Entry]:
        for record in _records(path, cut):
            kept[1:] = [record]
            entry = Entry(record)
            measure.add(entry)
            yield entry

    rows = _made_of(str(path), entries())
    return Transcript(kept, str(path), cut=" ".join(cut), measure=measure, made=rows)


def _records(path: str | Path, cut: list[str] | None) -> Iterator[Record]:
    """A transcript's records one by one; see :func:`read`."""
    from prima.transcript.lines import MAX_LINE, read_lines

    count = 0
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            lines = iter(lambda: stream.readline(MAX_LINE + 2), "")
            for record in read_lines(str(path), lines, cut):
                count += 1
                yield record
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError as error:
        if cut is None or count == 0 or error.reason != "unexpected end of data":
            raise UsageError(f"{path}: not a transcript: it is not UTF-8.") from None
        message = "the record is cut off within a character; the transcript is incomplete."
        cut.append(f"{path}:{count + 1}: {message}")


def export(
    transcript: Transcript | str | Path,
    to: str,
    output: str | Path | IO[bytes],
    languages: Mapping[str, str] | None = None,
) -> Exported:
    """Write a transcript in another tool's format (docs/exports.md).

    Args:
        transcript: a transcript, or the path of one, which is read in pieces up to its first
            unreadable line.
        to: the format's name, such as ``eaf``; docs/exports.md lists all.
        output: the path of the file to write, or a binary stream.
        languages: language tags (BCP 47) by application; the empty name stands for the
            user and all other applications.

    Raises:
        UsageError: a format, tag or application is unknown, or a file is unreadable or
            unwritable.
    """
    from prima.exports import Exported, checked, timeline, write

    tags = checked(to, languages or {})
    held = transcript if isinstance(transcript, Transcript) else None
    if not isinstance(transcript, Transcript) and not Path(transcript).is_file():
        held = read(transcript, partial=True)  # a pipe can be read only once
    name = str(transcript) if held is None else held.name
    cut = [held.cut] if held and held.cut else []

    def records(cuts: list[str]) -> Iterable[Record]:
        return _records(name, cuts) if held is None else held.records

    made = timeline(name, records(cut))
    made.check_names(tags)
    if isinstance(output, str | Path):
        made.parts()  # may raise, before a file is overwritten
        with _output(Path(output), name) as stream:
            write(to, made, records([]), tags, VERSION, stream)
    else:
        write(to, made, records([]), tags, VERSION, output)
    early = ends_early(name, made.end / 1000) if made.head and not made.over and not cut else ""
    return Exported(len(made.tiers), made.marks, made.end / 1000, " ".join(cut), early)


def _output(path: Path, transcript: str) -> AbstractContextManager[IO[bytes]]:
    """A file to write an export to.

    Raises:
        UsageError: it is the transcript.
    """
    from prima.loading.writing import whole

    if path.exists() and Path(transcript).exists() and path.samefile(transcript):
        raise UsageError(f"{path}: this is the transcript itself: name another file.")
    return whole(path)


def replay(transcript: Transcript, scenario: str | Path | Loaded | None = None) -> Transcript:
    """Run a transcript's inbound records again, without a world; the result is the same.

    Args:
        transcript: the transcript of a rehearsal, or the journal of a live run.
        scenario: the rehearsal's scenario; a live run needs none.

    Raises:
        UsageError: the scenario's files are not those of the transcript.
        DocumentError: documents have errors.
    """
    from itertools import islice

    from prima.journal import replay_records
    from prima.transcript.lines import check_head, finished

    head = transcript.records[0]
    check_head(head, transcript.name)
    if head["data"].get("redacted"):
        message = "what users said was left out of this journal, so it cannot be run again."
        raise UsageError(f"{transcript.name}: {message}")
    if scenario is None:
        from prima.live.visit import reloaded

        loaded = reloaded(head, transcript.name)
    else:
        loaded = scenario if isinstance(scenario, Loaded) else load_scenario(scenario)
    cast = loaded.cast
    check_files(head, loaded, transcript.name)
    if "live" not in head["data"] and transcript.records[-1]["time"] > LONGEST_MS / 1000:
        raise UsageError(f"{transcript.name}: the transcript ends after more than a day.")
    robot, most = cast.robot, len(transcript.records) + MOST_MORE
    made = replay_records(
        transcript.records, cast.documents, robot.commands, robot.absence, transcript.name
    )
    again = list(islice(made, most))
    return Transcript([finished(record) for record in again], transcript.name)


def run_live(
    scenario: str | Path | None = None,
    robot: str | Path | None = None,
    fas: Iterable[str | Path] = (),
    eas: Iterable[str | Path] = (),
    world: str | Path | None = None,
    maps: Iterable[str] = (),
    services: str | Path | None = None,
    output: str | Path | None = None,
    resume: str | Path | None = None,
    policy: str | None = None,
    bound: int | None = None,
    patience: int | None = None,
    isolate: str = "ea",
    speed: float = 1.0,
    until: int | None = None,
    late: int | None = 250,
    sync: bool = False,
    redact: bool = False,
    drivers: Iterable[str | Path] = (),
    hosts: Iterable[str] = (),
    sink: Sink | None = None,
    warn: Callable[[str], None] | None = None,
    keep: bool = True,
) -> Transcript:
    """Run applications on a robot, in real time, to their end (docs/live.md).

    The robot is made safe at the end, however that comes: by Ctrl-C, by an exception of ``sink``.

    Args:
        scenario: a scenario, whose robot, world and user are simulated; then without ``fas``,
            ``eas``, ``world`` and ``services``.
        robot: the robot's document, which names its drivers.
        fas: the FAs.
        eas: the EAs.
        world: the site's map, and what its areas offer.
        maps: pairs ``URI=PATH`` for what VoiceXML documents name.
        services: the document of the services that may be asked.
        output: the path of the journal, which is not there yet.
        resume: the journal of a run that was cut off, and goes on; then without all before it.
        policy: a policy's name, as for :func:`rehearse`.
        bound: rule E4's bound on loops of a feedback Command.
        patience: rule E6's bound (ms).
        isolate: which scripts run in a process of their own, as for :func:`rehearse`.
        speed: how many times as fast as real time it runs, for simulated robots.
        until: when it ends at the latest (ms).
        late: how late (ms) an instant may be before ``warn`` is told; None for never.
        sync: whether each instant is on the disk before it is carried out.
        redact: whether what users say is left out of journal and transcript.
        drivers: Python files that define drivers; they are run.
        hosts: hosts from which applications may fetch, as for :func:`rehearse`.
        sink: called with each line of the transcript before its instant is carried out.
        warn: called with what an operator should know, as that the robot is lost.
        keep: whether to keep the records in memory.

    Raises:
        DocumentError: documents have errors.
        UsageError: what was given does not go together, or is not there.
        RunError: the robot cannot be reached, or the journal cannot be written.
        KeyboardInterrupt: Ctrl-C or a signal has ended the run; the journal can be resumed.
    """
    from prima.live.prepared import prepared
    from prima.live.visit import Chosen, LiveSettings
    from prima.transcript.lines import finished, line

    def names(paths: Iterable[str | Path]) -> tuple[str, ...]:
        return tuple(map(str, paths))

    chosen = Chosen(
        str(robot or ""), str(scenario or ""), str(world or ""),
        names(fas), names(eas), tuple(maps), str(services or ""),
    )  # fmt: skip
    if not 0 < speed <= FASTEST:
        raise UsageError(f"The speed is {speed:g}: write a number above 0, up to {FASTEST:g}.")
    web = fetcher(list(hosts), len(chosen.fas) + len(chosen.eas) + 1)
    settings = LiveSettings(
        policy, bound, patience, isolate, speed, until, sync, late, redact, names(drivers), web
    )
    given = [None if path is None else str(path) for path in (output, resume)]
    visit = prepared(chosen, settings, *given)
    made = Transcript(list(visit.before) if keep else [], given[0] or given[1] or "")

    def take(records: list[Record]) -> None:
        if keep:
            made.records += map(finished, records)
        if sink is not None:
            for record in records:
                sink(line(record))

    visit.run_anywhere(take, warn or (lambda _: None))
    if visit.stopped:
        raise KeyboardInterrupt
    session = visit.loop.session
    made.failures, made.defects = list(session.failures), list(session.defects)
    made.outcome = visit.loop.outcome
    return made


def diff(before: Transcript, after: Transcript) -> Difference:
    """Compare two transcripts by behaviour."""
    from prima.transcript.diff import compare

    difference = compare(before.rows(), after.rows())
    difference.before, difference.after = before.summary(), after.summary()
    return difference


def explain(code: str) -> str:
    """The meaning of a problem's code.

    Raises:
        UsageError: the code is unknown.
    """
    from prima.checks.codes import diagnoses

    found = diagnoses()
    if code not in found:
        raise UsageError(f'There is no code "{code}". {did_you_mean(code, found)}'.rstrip())
    return found[code].meaning


def explain_row(transcript: Transcript, number: int) -> str:
    """The reasons for the time of a row of a transcript's table.

    Raises:
        UsageError: there is no such row.
    """
    from prima.transcript.why import explained

    rows = transcript.rows()
    if not rows:
        message = f"{transcript.name}: the transcript has no rows."
        raise UsageError(f"{message} {transcript.cut or transcript.early}".rstrip())
    if not 0 <= number < len(rows):
        message = f"There is no row {number}; the rows are 0 to {len(rows) - 1}."
        raise UsageError(f"{message} {transcript.cut or transcript.early}".rstrip())
    return "\n".join(explained(transcript.run(), rows[number]))


__all__ = [
    "Difference", "Document", "DocumentError", "Loaded", "Problem", "RunError", "Transcript",
    "UsageError", "diff", "documents_folder", "explain", "explain_row", "export", "load", "load_scenario",
    "read", "rehearse", "replay", "run_live", "stage", "validate",
]  # fmt: skip
