"""One command that measures everything and writes the table of docs/performance.md.

Every figure is taken in a fresh process; the processes of all workloads and
peers are shuffled together, round after round, and medians are compared.
``python -m bench.run [--rounds N] [--quick]``.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import random
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

from bench import workloads

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
MANY = {"prima": 1_000, "sismic": 1_000, "transitions": 10_000}

JOBS: dict[str, tuple[str, list[Any]]] = {
    **{
        f"W1 {system}": ("rate", [system, 2, events])
        for system, events in (("prima", 20_000), ("sismic", 5_000), ("transitions", 50_000))
    },
    **{
        f"ring {system}": ("rate", [system, 1_000, events])
        for system, events in (("prima", 20_000), ("sismic", 2_000), ("transitions", 50_000))
    },
    **{
        f"W2 {system}": ("rate", [system, 2, events, True])
        for system, events in (("prima", 20_000), ("sismic", 5_000), ("transitions", 50_000))
    },
    **{
        f"W3 {states} {system}": ("load", [system, states])
        for states in (1_000, 10_000)
        for system in ("prima", "sismic", "transitions")
        if (system, states) != ("sismic", 10_000)
    },
    **{f"voicexml {system}": ("voicexml", [system, 260]) for system in ("prima", "lxml")},
    **{f"W4 {system}": ("many", [system, count]) for system, count in MANY.items()},
    **{f"mediator {n}": ("decisions", [n, 4_000 if n < 500 else 400]) for n in (2, 10, 100, 1_000)},
    "simulation": ("simulate", [5]),
    **{
        f"process {what}": ("process", [what])
        for what in (
            *("bare", "click", "light", "imports", "help", "validate", "run"),
            *("sismic", "transitions"),
        )
    },
}


def measure(name: str, quick: bool) -> Any:
    """Take one figure in a fresh process."""
    function, args = JOBS[name]
    if quick:
        args = [min(arg, 20) if isinstance(arg, int) and arg > 20 else arg for arg in args]
    code = (
        "import json, sys; from bench import workloads; a = json.loads(sys.argv[2]);"
        "print(json.dumps(getattr(workloads, sys.argv[1])(*a)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, function, json.dumps(args)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"{name}: {done.stderr}")
    return json.loads(done.stdout)


def collect(rounds: int, quick: bool) -> dict[str, list[Any]]:
    """All figures of all rounds, shuffled together."""
    order = [name for name in JOBS for _ in range(rounds)]
    random.Random(1).shuffle(order)
    found: dict[str, list[Any]] = {name: [] for name in JOBS}
    for number, name in enumerate(order, 1):
        if sys.stderr.isatty():
            print(f"\r{number}/{len(order)} {name:<24}", end="", file=sys.stderr)
        found[name].append(measure(name, quick))
    return found


class Table:
    """Rows with medians, spreads and ratios."""

    def __init__(self, found: dict[str, list[Any]]) -> None:
        self.found = found
        self.rows: list[str] = []

    def value(self, name: str) -> float:
        """The median of a figure."""
        return float(median(one[0] if isinstance(one, list) else one for one in self.found[name]))

    def spread(self, name: str) -> str:
        """How far the figures lie apart, as a share of the median."""
        held = [one[0] if isinstance(one, list) else one for one in self.found[name]]
        return f"±{(max(held) - min(held)) / 2 / median(held):.0%}"

    def row(self, what: str, own: str, ratio: str, target: str, met: bool | None) -> None:
        """One line: our figure, its ratio to a peer or floor, and the target."""
        mark = "" if met is None else ("met" if met else "**not met**")
        self.rows.append(f"| {what} | {own} | {ratio} | {target} | {mark} |")


def number(value: float) -> str:
    """A figure as people read it."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def table(found: dict[str, list[Any]]) -> str:
    """The whole table as Markdown."""
    made = Table(found)
    for name, what, factor in (("W1", "two states", 4.5), ("W2", "three guards a state", 4.0)):
        own = made.value(f"{name} prima")
        peer, slow = made.value(f"{name} transitions"), made.value(f"{name} sismic")
        made.row(
            f"{name}: events/s, {what}",
            f"{number(own)} ({made.spread(f'{name} prima')})",
            f"{own / peer:.2f} × transitions ({number(peer)}), {own / slow:.1f} × sismic ({number(slow)})",
            f"≥ {factor:g} × transitions",
            own >= factor * peer,
        )
    ring = made.value("ring prima") / made.value("W1 prima")
    made.row(
        "W1: ring of 1,000 states ÷ two states",
        f"{ring:.2f}",
        "transitions {:.2f}, sismic {:.2f}".format(
            made.value("ring transitions") / made.value("W1 transitions"),
            made.value("ring sismic") / made.value("W1 sismic"),
        ),
        "≥ 0.95",
        ring >= 0.95,
    )
    for states in (1_000, 10_000):
        own, peer = made.value(f"W3 {states} prima"), made.value(f"W3 {states} transitions")
        slower = f", {own / made.value('W3 1000 sismic'):.2f} × sismic" if states == 1_000 else ""
        made.row(
            f"W3: load {states:,} states",
            f"{own * 1000:.0f} ms ({made.spread(f'W3 {states} prima')})",
            f"{own / peer:.1f} × transitions ({peer * 1000:.0f} ms){slower}",
            "≤ 3 × transitions",
            own <= 3 * peer,
        )
    own, peer = made.value("voicexml prima"), made.value("voicexml lxml")
    made.row(
        "VoiceXML: a document of 100 KB, to its first question",
        f"{own * 1000:.1f} ms ({made.spread('voicexml prima')})",
        f"{own / peer:.1f} × lxml's parse and XSD ({peer * 1000:.1f} ms)",
        "≤ 10 ×",
        own <= 10 * peer,
    )
    each = {system: made.value(f"W4 {system}") / count for system, count in MANY.items()}
    memory = median(one[1] for one in found["W4 prima"]) * 10_000 / MANY["prima"]
    made.row(
        f"W4: a machine with ten events (PRIMA: {MANY['prima']:,} measured, not 10,000)",
        f"{each['prima'] * 1000:.2f} ms, {memory:,.0f} MB for 10,000",
        f"{each['prima'] / each['transitions']:.1f} × transitions,"
        f" {each['prima'] / each['sismic']:.2f} × sismic",
        "≤ 0.4 × transitions, ≤ 60 MB",
        each["prima"] <= 0.4 * each["transitions"] and memory <= 60,
    )
    for n in (2, 10, 100, 1_000):
        own = made.value(f"mediator {n}")
        made.row(
            f"Mediator: decisions/s, {n:,} waiting",
            f"{number(own)} ({made.spread(f'mediator {n}')})",
            f"{made.value('mediator 2') / own:.1f} × the cost with 2",
            "",
            None,
        )
    own = made.value("simulation")
    made.row(
        "Demo: simulated seconds a second",
        f"{number(own)} ({made.spread('simulation')})",
        "real time is 1",
        "≥ 1,000",
        own >= 1000,
    )
    starts = (
        ("help", "click", "`prima --help`", "bare Python + click", 1.2),
        ("validate", "light", "`prima validate`, one file", "bare Python + its imports", 1.3),
        ("run", "imports", "W5: `prima run` of the demo", "bare Python + its imports", 3.0),
    )
    for what, floor, title, beside, most in starts:
        own, least = made.value(f"process {what}"), made.value(f"process {floor}")
        more = (
            "; sismic's smallest {:.0f} ms, transitions' {:.0f} ms".format(
                made.value("process sismic") * 1000, made.value("process transitions") * 1000
            )
            if what == "run"
            else ""
        )
        made.row(
            title,
            f"{own * 1000:.0f} ms ({made.spread(f'process {what}')})",
            f"{own / least:.2f} × {beside} ({least * 1000:.0f} ms){more}",
            f"≤ {most:g} ×",
            own <= most * least,
        )
    head = "| what | PRIMA | beside | target | |\n| --- | --- | --- | --- | --- |"
    return "\n".join([head, *made.rows])


def machine(rounds: int) -> str:
    """The machine and versions."""
    libraries = ("sismic", "transitions", "quickjs-ng", "lxml", "pymunk", "networkx")
    names = ", ".join(f"{library} {version(library)}" for library in libraries)
    return (
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores,"
        f" {platform.python_implementation()} {platform.python_version()}; {names};"
        f" medians of {rounds} fresh processes each, shuffled together, with half the range."
    )


def main() -> None:
    """Measure, print, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="tiny sizes; writes nothing")
    given = parser.parse_args()
    found = collect(1 if given.quick else given.rounds, given.quick)
    text = f"{machine(given.rounds)}\n\n{table(found)}"
    print(text)
    if not given.quick:
        page = PAGE.read_text(encoding="utf-8")
        before, _, rest = page.partition(BEGIN)
        after = rest.partition(END)[2]
        PAGE.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    assert workloads
    main()
