"""Runs in simulation."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from prima.api.transcripts import Transcript, whole_numbers
from prima.errors import UsageError
from prima.language.values import LONGEST_MS, MOST_SEED
from prima.loading import Loaded, load_scenario, seeded
from prima.loading.files import texts_of
from prima.loading.heads import chosen_policy, run_record

if TYPE_CHECKING:
    from prima.scheduler.behavior import Application
    from prima.sim.rehearsal import Rehearsal
    from prima.sim.services import Web
    from prima.transcript.record import Entry

# Modules that only some functions need are imported there, so that short commands start quickly.

Sink = Callable[[str], object]


def rehearse(
    scenario: str | Path | Loaded,
    policy: str | None = None,
    bound: int | None = None,
    sink: Sink | None = None,
    keep: bool = True,
    hosts: str | Iterable[str] = (),
    isolate: str = "ea",
    patience: int | None = None,
    visits: bool = False,
    rows: bool = False,
    entries: bool = False,
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
        entries: whether to keep the records as :class:`Entry` in ``entries`` of the transcript.
        seed: determines all random values of the run; by default the scenario's own.

    Raises:
        DocumentError: documents have errors.
        UsageError: a policy or file is unknown, a host is not a host name, or a number is
            out of range.
    """
    from collections import deque

    from prima.sim.rehearsal import Rehearsal
    from prima.transcript.lines import finished, line
    from prima.transcript.measures import Measure
    from prima.transcript.record import Entry
    from prima.transcript.rows import make_rows

    check_functions(sink=sink)
    [bound] = whole_numbers(bound=bound)
    [seed] = whole_numbers(0, MOST_SEED, seed=seed)
    [patience] = whole_numbers(0, LONGEST_MS, patience=patience)
    loaded = scenario if isinstance(scenario, Loaded) else load_scenario(scenario)
    loaded = seeded(loaded, seed)
    cast = loaded.cast
    name = cast.scenario.policy if policy is None else policy
    chosen = chosen_policy(name, loaded)
    if patience is None:
        patience = cast.scenario.patience
    web = fetcher(hosts, len(cast.documents))
    rehearsal = Rehearsal(cast, chosen, bound, web, isolate, patience)
    head = run_record(loaded, name, bound, patience)
    measure = Measure()
    made = Transcript([], cast.scenario.id, measure=measure)

    def each() -> Iterator[Entry]:
        for records in chain([[head]], rehearsal.run()):
            for record in records:
                entry = Entry(record, record["time"] / 1000)
                measure.add(entry)
                yield entry
                if entries:
                    made.entries.append(entry)
                if keep:
                    made.records.append(finished(record))
                if sink is not None:
                    sink(line(record))
            if visits:
                made.visits += rehearsal.visits

    if rows:
        made.made = make_rows(each())
    else:
        deque(each(), maxlen=0)
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
    refused = rehearsal.session.hearing.refused
    return [
        f"{name} is {_doing(memory.apps[name], name in owed)}"
        f"{_refusing(memory.apps[name], *refused.get(name, ('', '')))}"
        for name in there
        if name in memory.apps
    ]


def _refusing(app: Application, place: str, words: str) -> str:
    """The remark that the question at this place, if it is asked now, does not take an answer."""
    asked = {ab.command.source for ab in app.members.values() if ab.command is not None}
    return f', and does not take the answer "{words}"' if words and place in asked else ""


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


def fetcher(given: str | Iterable[str], applications: int) -> Web | None:
    """A fetcher for some hosts, or None; only then are network modules imported."""
    hosts = texts_of(given, "hosts")
    if not hosts:
        return None
    from prima.loading.web import Hosts

    for host in hosts:
        if not re.fullmatch(r"([\w.-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]{1,5})?", host):
            raise UsageError(
                f'"{host}" is not a host name: write a name and a port, such as example.org:8080.'
            )
    return Hosts(hosts, applications)


def check_functions(**given: object) -> None:
    """Refuse what cannot be called.

    Raises:
        UsageError: one of the values cannot.
    """
    for name, one in given.items():
        if one is not None and not callable(one):
            raise UsageError(f"{name}={one!r:.80}: write a function.")
