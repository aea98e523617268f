"""One command that measures everything and writes the tables of docs/performance.md.

``python -m bench.run [--rounds N] [--only WORDS] [--quick]``. Every figure is taken in a fresh
process. A comparison is measured in pairs: our process and the peer's back to back, in either
order, and the ratio of each pair counts. The pairs of all rows are shuffled together.
"""

from __future__ import annotations

import argparse
import os
import platform
import random
import sys
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from statistics import median, quantiles
from time import perf_counter

from bench import peers
from bench.fresh import ROOT, Figure, WrongAnswer, fresh
from bench.rows import MOST, SECTIONS, Call, Row

PAGE = ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
HEAD = "| what | figure | beside | ratio | target | |\n| --- | --- | --- | --- | --- | --- |"
VERSIONS = ("transitions", "sismic", "quickjs-ng", "lxml", "pymunk")
QUICK_SIZE, QUICK_SECONDS = 20, 0.01


@dataclass
class Measured:
    """A row's figures, pair by pair."""

    row: Row
    ours: list[Figure] = field(default_factory=list)
    peers: list[Figure] = field(default_factory=list)
    wrong: str = ""
    """Why there is no figure: what was measured did not do its work."""

    @property
    def results(self) -> list[float]:
        """The values that the target is for: the ratio of each pair, or the figures themselves."""
        if self.row.peer is None:
            return [figure.value for figure in self.ours]
        return [a.value / b.value for a, b in zip(self.ours, self.peers, strict=True)]

    def take(self, quick: bool) -> None:
        """Measure one pair, in either order; no more of them after a wrong answer."""
        if self.wrong:
            return
        sides = [(self.row.ours, self.ours)]
        if self.row.peer is not None:
            sides.append((self.row.peer, self.peers))
        random.shuffle(sides)
        try:
            for call, figures in sides:
                figures.append(measure(call, quick))
        except WrongAnswer as error:
            self.wrong = str(error)


def measure(call: Call, quick: bool = False) -> Figure:
    """Take a figure; quickly, of a small size, which shows only that the work is done."""
    args = call.args
    if quick:
        args = call.quick or tuple(_small(arg) for arg in args)
    return fresh(call.function, *args)


def _small(arg: object) -> object:
    if isinstance(arg, float):
        return min(arg, QUICK_SECONDS)
    return min(arg, QUICK_SIZE) if type(arg) is int else arg


def available(name: str) -> bool:
    """Whether what a row needs is installed."""
    if name in peers.PEERS:
        return peers.installed(name)
    return not name or find_spec(name) is not None


def collect(rows: list[Row], rounds: int, quick: bool) -> dict[Row, Measured]:
    """All figures of some rows, their pairs shuffled together."""
    found = {row: Measured(row) for row in rows}
    order = [row for row in rows for _ in range(1 if quick else row.pairs(rounds))]
    random.shuffle(order)
    for number, row in enumerate(order, 1):
        if sys.stderr.isatty():
            print(f"\r\x1b[K{number}/{len(order)} {row.what}", end="", file=sys.stderr)
        found[row].take(quick)
    if sys.stderr.isatty():
        print("\r\x1b[K", end="", file=sys.stderr)
    return found


def line(one: Measured) -> str:
    """A row of the table."""
    row = one.row
    if one.wrong:
        return f"| {row.what} | **wrong answer** | {row.beside} |  |  | **not met** |"
    result = median(one.results)
    bounds = [("≥", row.least), ("≤", row.most)]
    target = next((f"{sign} {told(bound, row)}" for sign, bound in bounds if bound is not None), "")
    met = (row.least is None or result >= row.least) and (row.most is None or result <= row.most)
    mark = "" if not target else "met" if met else "**not met**"
    own, beside, ratio = shown(middle(one.ours), row.unit) + noted(one.ours), "", ""
    if row.peer is None:
        own += spread(one.results, row)
    else:
        beside = f"{row.beside}: {shown(middle(one.peers), row.unit)}{noted(one.peers)}"
        ratio = told(result, row) + spread(one.results, row)
    return f"| {row.what} | {own} | {beside} | {ratio} | {target} | {mark} |"


def middle(figures: list[Figure]) -> float:
    """The median."""
    return median(figure.value for figure in figures)


def noted(figures: list[Figure]) -> str:
    """The remark about figures: that of the first one."""
    return next((f" ({figure.note})" for figure in figures if figure.note), "")


def told(value: float, row: Row) -> str:
    """A row's result or bound: a ratio, or a figure with its unit."""
    return number(value) if row.peer is not None else shown(value, row.unit)


def spread(results: list[float], row: Row) -> str:
    """Between what the middle half of the results lies; a unit that never changes is left out."""
    if len(results) < 3:
        return ""
    low, _, high = quantiles(results, n=4, method="inclusive")
    form = shown if row.unit == "s" and row.peer is None else lambda value, _: number(value)
    return f" ({form(low, row.unit)} to {form(high, row.unit)})"


def shown(value: float, unit: str) -> str:
    """A figure with its unit; seconds in one that fits."""
    if unit != "s":
        return f"{number(value)} {unit}".rstrip()
    if value >= 1:
        return f"{number(value)} s"
    if value >= 1e-3:
        return f"{number(value * 1e3)} ms"
    return f"{number(value * 1e6)} µs"


def number(value: float) -> str:
    """A number as people read it: three digits, or all of a whole one."""
    return f"{value:,.0f}" if abs(value) >= 100 or value == int(value) else f"{value:.3g}"


def machine(rounds: int) -> str:
    """The machine, the versions, and how it was measured."""
    names = [f"{name} {version(name)}" for name in VERSIONS if _has(name)]
    for key, one in peers.PEERS.items():
        if available(key):
            names.append(f"{one.title} {peers.version(key)} ({peers.runtime(key)})")
    return (
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores,"
        f" {platform.python_implementation()} {platform.python_version()}; {', '.join(names)};"
        f" medians of {rounds} pairs (slow rows and those without a target have fewer, some up to"
        f" {MOST}), in brackets their middle half."
    )


def _has(name: str) -> bool:
    try:
        version(name)
    except PackageNotFoundError:
        return False
    return True


def chosen(only: str) -> dict[str, list[Row]]:
    """The rows of each section whose section or text holds some words."""
    words = only.lower()
    found = {
        section: [row for row in rows() if words in f"{section} {row.what} {row.beside}".lower()]
        for section, rows in SECTIONS.items()
    }
    return {section: rows for section, rows in found.items() if rows}


def tables(sections: dict[str, list[Row]], found: dict[Row, Measured]) -> str:
    """Everything measured, as Markdown."""
    parts = []
    for section, rows in sections.items():
        lines = [line(found[row]) for row in rows if row in found]
        if lines:
            parts.append("\n".join([f"### {section}\n", HEAD, *lines]))
    wanted = {row.needs for rows in sections.values() for row in rows}
    missing = sorted(name for name in wanted if not available(name))
    if missing:
        parts.append(f"Left out, because it is not installed here: {', '.join(missing)}.")
    return "\n\n".join(parts)


def main(given: list[str] | None = None) -> None:
    """Measure, print, and write the page if all was measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="pairs of each row (default 5)")
    parser.add_argument("--only", default="", help="rows that hold these words; writes nothing")
    parser.add_argument("--quick", action="store_true", help="tiny sizes; writes nothing")
    options = parser.parse_args(given)
    began = perf_counter()
    sections = chosen(options.only)
    able = [row for rows in sections.values() for row in rows if available(row.needs)]
    found = collect(able, options.rounds, options.quick)
    minutes = (perf_counter() - began) / 60
    head = f"{machine(options.rounds)} All of it took {minutes:.1f} minutes."
    text = f"{head}\n\n{tables(sections, found)}"
    print("Tiny sizes: the work is done, the figures say nothing.\n" if options.quick else "", text)
    wrong = [f"{one.row.what}: {one.wrong}" for one in found.values() if one.wrong]
    if wrong:
        raise SystemExit("\n".join(["Wrong answers; nothing is written.", *wrong]))
    if not options.quick and not options.only:
        page = PAGE.read_text(encoding="utf-8")
        before, _, rest = page.partition(BEGIN)
        after = rest.partition(END)[2]
        PAGE.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
