"""The rows of the table, as data: what is measured, beside what, and what it has to reach."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bench import (
    batch,
    experiments,
    isolation,
    large,
    live,
    matching,
    mediation,
    peers,
    processes,
    simulation,
    workloads,
)


@dataclass(frozen=True)
class Call:
    """A function that gives one figure, to be called in a fresh process."""

    function: Callable[..., float]
    args: tuple[Any, ...] = ()
    quick: tuple[Any, ...] = ()
    """Arguments of a small size, where smaller numbers alone will not do."""


@dataclass(frozen=True)
class Row:
    """One comparison, or one figure that is compared with nothing."""

    what: str
    unit: str
    """The unit of our figure: see :func:`bench.run.shown`."""
    ours: Call
    beside: str = ""
    peer: Call | None = None
    least: float | None = None
    """The least value of our figure, divided by the peer's if there is one."""
    most: float | None = None
    rounds: int | None = None
    """How often it is measured, where that is not left to the command."""
    needs: str = ""
    """A requirement: a Python package, or a peer of :mod:`bench.peers`."""

    def pairs(self, rounds: int) -> int:
        """How often it is measured where the command says ``rounds``; without a target less often."""
        aimed = self.least is not None or self.most is not None
        return self.rounds or (rounds if aimed else min(rounds, UNAIMED))


SECONDS = 0.7
"""How long events are counted."""
MORE = 9
"""Pairs of rows that are quickly measured and have a target."""
UNAIMED = 2
"""Pairs of rows without a target, at most."""
MOST = 25
"""Pairs of rows whose ratio moves more from pair to pair than lies between it and its target."""
MANY_SECONDS = 6.0
"""After how long no more machines are made."""
TITLES = {
    "transitions": "transitions",
    "sismic": "sismic",
    "xstate": "XState",
    "scxml": "Commons SCXML",
}


def events() -> list[Row]:
    """Events a second beside each peer's."""
    rows = []
    floors = (
        (False, "two states", {"transitions": 3, "xstate": 1.5, "scxml": 2, "sismic": 15}),
        (True, "three guards a state", {"transitions": 3, "xstate": 1.2, "scxml": 2}),
    )
    for guards, what, bounds in floors:
        for system, title in TITLES.items():
            rows.append(
                Row(
                    f"W{1 + guards}: {what}",
                    "events/s",
                    Call(workloads.rate, ("prima", 2, SECONDS, guards)),
                    title,
                    Call(workloads.rate, (system, 2, SECONDS, guards)),
                    least=bounds.get(system),
                    rounds=3
                    if system in peers.PEERS
                    else MORE
                    if system == "transitions"
                    else None,
                    needs=system,
                )
            )
        rows.append(
            Row(
                f"W{1 + guards}: {what}, the interpreter alone",
                "events/s",
                Call(workloads.rate, ("application", 2, SECONDS, guards)),
                "transitions",
                Call(workloads.rate, ("transitions", 2, SECONDS, guards)),
                needs="transitions",
            )
        )
    for system, title in {"prima": "PRIMA", **TITLES}.items():
        ours = system == "prima"
        rows.append(
            Row(
                "W1: ring of 1,000 states" + ("" if ours else f", {title}"),
                "events/s",
                Call(workloads.rate, (system, 1_000, SECONDS)),
                "its two states",
                Call(workloads.rate, (system, 2, SECONDS)),
                least=0.9 if ours else None,
                rounds=MOST if ours else 1,
                needs=system,
            )
        )
    return rows


def loads() -> list[Row]:
    """From text to a started machine."""
    rows = [
        Row(
            f"W3: load {states:,} states",
            "s",
            Call(workloads.load, ("prima", states)),
            "transitions",
            Call(workloads.load, ("transitions", states)),
            most=4,
            needs="transitions",
        )
        for states in (1_000, 10_000)
    ]
    return [
        *rows,
        Row(
            "W3: load 1,000 states",
            "s",
            Call(workloads.load, ("prima", 1_000)),
            "sismic",
            Call(workloads.load, ("sismic", 1_000)),
            rounds=1,
            needs="sismic",
        ),
        Row(
            "Growth of load, 100 to 20,000 states: the exponent",
            "",
            Call(workloads.growth, (20_000,)),
            most=1.05,
            rounds=3,
        ),
        Row(
            "A second load of the same bytes, 2,000 states",
            "of the first",
            Call(workloads.second_load, (2_000,)),
            most=0.05,
        ),
        Row(
            "VoiceXML: 100 KB, to its first question",
            "s",
            Call(workloads.voicexml, ("prima", 260)),
            "lxml's parse and XSD",
            Call(workloads.voicexml, ("lxml", 260)),
            most=12,
            needs="lxml",
        ),
    ]


def many() -> list[Row]:
    """Applications that live at once."""
    given = (10_000, MANY_SECONDS)
    kinds = {
        "application": "W4: 10,000 applications, ten events each",
        "scripted": "W4: 10,000 with scripts, each in an engine of its own",
        "prima": "W4: 10,000 sessions, each with one application",
    }
    rows = [
        Row(
            what,
            "s",
            Call(workloads.many, (kind, *given)),
            "transitions",
            Call(workloads.many, ("transitions", *given)),
            most=0.5 if kind == "application" else None,
            rounds=3 if kind == "application" else 1,
            needs="transitions",
        )
        for kind, what in kinds.items()
    ]
    memory = [
        Row(
            f"{what.removesuffix(', ten events each')}: memory",
            "MB",
            Call(workloads.many_memory, (kind, *given)),
            most=60 if kind == "application" else None,
            rounds=1,
        )
        for kind, what in kinds.items()
    ]
    return [*rows, *memory]


def mediator() -> list[Row]:
    """Decisions while so many wait."""
    return [
        Row(
            "Decisions, 10 waiting, each with its records",
            "decisions/s",
            Call(mediation.decisions, (10, SECONDS)),
            "events of transitions",
            Call(workloads.rate, ("transitions", 2, SECONDS)),
            least=0.4,
            needs="transitions",
        ),
        Row(
            "A decision, 100 waiting",
            "s",
            Call(mediation.cost, (100, SECONDS)),
            "10 waiting",
            Call(mediation.cost, (10, SECONDS)),
            most=10,
        ),
    ]


def simulated() -> list[Row]:
    """The simulated robot."""
    return [
        *(
            Row(
                f"Situation {number} of the study",
                "× real time",
                Call(simulation.situation, (number, SECONDS)),
                least=3_000,
                rounds=3,
            )
            for number in range(1, 11)
        ),
        Row(
            "The ten situations in one process, their median",
            "× real time",
            Call(simulation.ten_situations, (SECONDS,)),
            least=4_500,
            rounds=3,
        ),
        Row(
            "Memory, from hour 10 to hour 100, twenty visits an hour",
            "MB more",
            Call(simulation.visits_memory, (100,), (2,)),
            most=1,
            rounds=1,
        ),
        Row(
            "Instants computed in 100 quiet hours",
            "",
            Call(simulation.quiet, (100,)),
            most=0,
            rounds=1,
        ),
    ]


def starts() -> list[Row]:
    """Whole processes."""
    run = Call(processes.run)
    return [
        Row(
            "`prima --help`",
            "s",
            Call(processes.help_),
            "Python + click",
            Call(processes.floor, ("click",)),
            most=1.5,
            rounds=MORE,
        ),
        Row(
            "`prima validate`, one file",
            "s",
            Call(processes.validate),
            "Python + its imports",
            Call(processes.floor, ("validate",)),
            most=2,
            rounds=MOST,
        ),
        Row(
            "`prima validate`, 1,000 small files",
            "s",
            Call(processes.validate_many, ("prima", 1_000)),
            "lxml's parse and XSD",
            Call(processes.validate_many, ("lxml", 1_000)),
            most=2,
            needs="lxml",
        ),
        Row(
            "W5: `prima run` of the demo",
            "s",
            run,
            "Python + its imports",
            Call(processes.floor, ("run",)),
            most=4,
            rounds=MORE,
        ),
        *(
            Row(
                "W5: `prima run` of the demo",
                "s",
                run,
                f"{system}, two states",
                Call(processes.peer, (system,)),
                needs=system,
            )
            for system in ("transitions", "sismic")
        ),
    ]


def batches() -> list[Row]:
    """Many runs by one command."""
    return [
        Row(
            "A batch on two workers",
            "× two processes",
            Call(batch.ratio, (1,)),
            least=0.95,
            rounds=9,
        )
    ]


def matches() -> list[Row]:
    """Answers among very many, and transcripts of very many rows."""
    rows = [
        Row(
            f"An answer among 10,000, {title}",
            "ms",
            Call(function, (how, 10_000)),
            most=10,
            rounds=1,
        )
        for title, function, how in (
            ("as options", matching.answer, "options"),
            ("in a grammar", matching.answer, "one-of"),
            ("in a rule that is repeated", matching.answer, "repeat"),
            ("in an SRGS grammar", matching.spoken, "one-of"),
            ("in an SRGS rule that is repeated", matching.spoken, "repeat"),
            ("after any words", matching.spoken, "garbage"),
        )
    ]
    few = Call(matching.difference_memory, ("few", 100_000), ("few", 800))
    half = Call(matching.difference_memory, ("few", 50_000), ("few", 400))
    return [
        *rows,
        Row(
            "`prima diff` of two transcripts of 100,000 rows",
            "s",
            Call(matching.difference, ("few", 100_000), ("few", 400)),
            most=10,
            rounds=1,
        ),
        Row(
            "Memory of `prima diff`, 100,000 rows", "MB", few, "50,000 rows", half, most=2, rounds=1
        ),
    ]


def editor() -> list[Row]:
    """The language server."""
    from bench import editor as lsp

    return [
        Row(
            "From a change to its problems, 2,000 elements",
            "s",
            Call(lsp.problems, (2_000,)),
            most=0.05,
            rounds=1,
            needs="pygls",
        )
    ]


LARGE = {
    "undeclared names": "undeclared names in expressions",
    "VoiceXML dialogs with gotos": "VoiceXML dialogs with gotos",
    "places with ways": "places with ways",
    "forms with gotos": "forms with gotos",
    "unknown elements": "unknown elements",
    "`let`": "let",
    "`let` in one script": "let in one script",
    "wrong expressions": "wrong expressions",
}
"""The contents of large documents, and their families in :mod:`bench.large`."""


def large_ones() -> list[Row]:
    """Validation of documents of nearly as many bytes as are read."""
    size = (large.MOST_BYTES,)
    quick = (4_000,)
    return [
        row
        for what, family in LARGE.items()
        for row in (
            Row(
                f"2 MB of {what}",
                "s",
                Call(large.validation, (family, *size), (family, *quick)),
                most=5,
                rounds=3,
            ),
            Row(
                f"2 MB of {what}: growth",
                "",
                Call(large.growth, (family, *size), (family, *quick)),
                most=1.1,
                rounds=3,
            ),
        )
    ]


def isolated() -> list[Row]:
    """The cost of running scripts in separate processes."""
    return [
        Row(
            "Expressions that an engine evaluates, in a process of its own",
            "events/s",
            Call(isolation.calls, ("ea", SECONDS)),
            "in the process of the run",
            Call(isolation.calls, ("none", SECONDS)),
        ),
        Row(
            "The demo's run",
            "s",
            Call(isolation.run, ("ea", "demo", 5)),
            "without isolation",
            Call(isolation.run, ("none", "demo", 5)),
        ),
        Row(
            "A VoiceXML application with scripted grammars",
            "s",
            Call(isolation.run, ("ea", "pizza", 5)),
            "without isolation",
            Call(isolation.run, ("none", "pizza", 5)),
        ),
    ]


def lives() -> list[Row]:
    """Live runs: see :mod:`bench.live`."""
    return [
        Row(
            "Live: from an event to its order, ten applications",
            "ms",
            Call(live.event_to_order),
            most=1,
            rounds=3,
        ),
        Row(
            "Live: how late instants are, 99th percentile",
            "ms",
            Call(live.lateness),
            most=10,
            rounds=3,
        ),
        Row("Live: a core while nothing happens", "of it", Call(live.idle), most=0.02, rounds=1),
        Row(
            "Live: memory after 24 hours over that after one",
            "times",
            Call(live.growth, (24,), (3,)),
            most=1.1,
            rounds=1,
        ),
        Row("Live: journal, an instant of ten records", "µs", Call(live.journal_cost, (False,))),
        Row("Live: the same with --sync", "µs", Call(live.journal_cost, (True,))),
    ]


def experimenting() -> list[Row]:
    """Sweeps and explorations."""
    return [
        Row(
            "A sweep of 10,000 runs on two processes",
            "runs/s",
            Call(experiments.pooled, (10_000,), (4,)),
            "two independent processes",
            Call(experiments.independent, (10_000,), (4,)),
            least=0.95,
            rounds=1,
        ),
        Row(
            "A sweep's rows, from the values to the table",
            "s",
            Call(experiments.rows_seconds, (500,), (4,)),
            "their simulation alone",
            Call(experiments.runs_seconds, (500,), (4,)),
            most=1.2,
            rounds=5,
        ),
        Row(
            "A sweep on two workers of Dask",
            "runs/s",
            Call(experiments.on_dask, (10_000,), (4,)),
            "two processes of this machine",
            Call(experiments.pooled, (10_000,), (4,)),
            least=0.85,
            rounds=1,
            needs="distributed",
        ),
        Row(
            "Every variant to 1 ms, one event moved by up to 5 s",
            "s",
            Call(experiments.every_variant, (5_000,), (10, 4)),
            "an exploration",
            Call(experiments.explored, (5_000,), (10,)),
            least=10,
            rounds=3,
        ),
    ]


SECTIONS: dict[str, Callable[[], list[Row]]] = {
    "Events": events,
    "Load": loads,
    "Many": many,
    "Mediator": mediator,
    "Simulation": simulated,
    "Start": starts,
    "Batch": batches,
    "Grammars and diff": matches,
    "Editor": editor,
    "Large documents": large_ones,
    "Isolation": isolated,
    "Live": lives,
    "Experiments": experimenting,
}
