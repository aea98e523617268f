"""Runs on a robot, and replays of runs from their records."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from numbers import Real
from pathlib import Path

from prima.api.rehearsing import Sink, check_functions, fetcher
from prima.api.transcripts import Transcript, check_transcripts, outcome_of, whole_numbers
from prima.errors import UsageError
from prima.language.values import LONGEST_MS
from prima.loading import Loaded, load_scenario
from prima.loading.files import check_path, paths_of, texts_of
from prima.loading.heads import check_files
from prima.messages import Record

# Modules that only some functions need are imported there, so that short commands start quickly.

MOST_MORE = 1000
"""The maximum number of records of a replay beyond those of its transcript: it differs anyway."""
FASTEST = 1000.0
"""How many times as fast as real time a live run may go."""


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

    check_transcripts(transcript)
    head = transcript.kept()[0]
    check_head(head, transcript.name)
    if head["data"].get("redacted"):
        message = "what users said was left out of this journal, so it cannot be run again."
        raise UsageError(f"{transcript.name}: {message}")
    if scenario is None:
        from prima.live.chosen import reloaded

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
    records = [finished(record) for record in again]
    return Transcript(records, transcript.name, outcome=outcome_of(records))


def run_live(
    scenario: str | Path | None = None,
    robot: str | Path | None = None,
    fas: str | Path | Iterable[str | Path] = (),
    eas: str | Path | Iterable[str | Path] = (),
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
    drivers: str | Path | Iterable[str | Path] = (),
    hosts: str | Iterable[str] = (),
    sink: Sink | None = None,
    warn: Callable[[str], None] | None = None,
    keep: bool = True,
) -> Transcript:
    """Run applications on a robot, in real time, to their end (docs/live.md).

    The robot is made safe at the end, even after Ctrl-C or an exception of ``sink``.

    Args:
        scenario: a scenario, whose robot, world and user are simulated; then without ``fas``,
            ``eas``, ``world`` and ``services``.
        robot: the robot's document, which names its drivers.
        fas: the FAs.
        eas: the EAs.
        world: the site's map, and what its areas offer.
        maps: pairs ``URI=PATH`` that map addresses in VoiceXML documents to files.
        services: the document of the services that may be used.
        output: the path of the journal, which must not exist yet.
        resume: the journal of an interrupted run to resume; then without all arguments before it.
        policy: a policy's name, as for :func:`rehearse`.
        bound: rule E4's bound on loops of a feedback Command.
        patience: rule E6's bound (ms).
        isolate: which scripts run in a process of their own, as for :func:`rehearse`.
        speed: how many times as fast as real time it runs, for simulated robots.
        until: when it ends at the latest (ms).
        late: how late (ms) an instant may be before ``warn`` is called; None for never.
        sync: whether each instant is flushed to the disk before it is carried out.
        redact: whether what users say is left out of journal and transcript.
        drivers: Python files that define drivers; they are run.
        hosts: hosts from which applications may fetch, as for :func:`rehearse`.
        sink: called with each line of the transcript before its instant is carried out.
        warn: called with messages for the operator, such as that the robot is lost.
        keep: whether to keep the records in memory.

    Raises:
        DocumentError: documents have errors.
        UsageError: the arguments cannot be combined, or a file is missing.
        RunError: the robot cannot be reached, or the journal cannot be written.
        KeyboardInterrupt: Ctrl-C or a signal has ended the run; the journal can be resumed.
    """
    from prima.live.chosen import Chosen
    from prima.live.prepared import prepared
    from prima.live.visit import LiveSettings
    from prima.transcript.lines import finished, line

    def name(path: str | Path | None, argument: str) -> str:
        return check_path("" if path is None else path, argument)

    chosen = Chosen(
        name(robot, "robot"), name(scenario, "scenario"), name(world, "world"),
        tuple(paths_of(fas, "fas")), tuple(paths_of(eas, "eas")), tuple(texts_of(maps, "maps")),
        name(services, "services"),
    )  # fmt: skip
    check_functions(sink=sink, warn=warn)
    [bound] = whole_numbers(bound=bound)
    [until, late] = whole_numbers(0, until=until, late=late)
    [patience] = whole_numbers(0, LONGEST_MS, patience=patience)
    if not isinstance(speed, Real) or not 0 < speed <= FASTEST:
        raise UsageError(f"The speed is {speed!r:.80}: write a number above 0, up to {FASTEST:g}.")
    web = fetcher(hosts, len(chosen.fas) + len(chosen.eas) + 1)
    named = tuple(paths_of(drivers, "drivers"))
    settings = LiveSettings(
        policy, bound, patience, isolate, speed, until, sync, late, redact, named, web
    )
    given = [name(output, "output") or None, name(resume, "resume") or None]
    visit = prepared(chosen, settings, *given)
    called = given[0] or given[1] or chosen.scenario or chosen.robot
    made = Transcript(list(visit.before) if keep else [], called)

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
