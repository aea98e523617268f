"""The tables of a page: factors, outcomes, measures, tests and orders as HTML."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from prima.report.parts import text
from prima.results.analysis import Analysis, Distribution
from prima.results.data import (
    Data,
    FactorColumn,
    OrderRow,
    number,
    numbers,
    probability,
    shown,
    with_unit,
)
from prima.results.figures import shade
from prima.results.ordermap import OrderMap
from prima.results.statistics import MANN_WHITNEY, ValueSummary

NUMBER = re.compile(r"(?:&lt; )?-?[0-9][0-9.e+-]*(?: \([0-9.]+%\))?|–")
"""A cell with a number, or an empty one; columns of numbers are aligned right."""
CLASSES = {True: ' class="n"', False: ""}
LISTED = 50
"""The number of orders, levels or outcomes that a table lists."""
Link = Callable[[OrderRow], str]
"""The address of an order's transcript from the page; empty if there is none."""


def table(name: str, caption: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table that can be copied; cells are markup, and numbers are aligned right."""
    held = [list(row) for row in rows]
    right = [all(NUMBER.fullmatch(one) for one in column) for column in zip(*held, strict=True)]
    right = [place > 0 and one for place, one in enumerate(right or [False] * len(heads))]
    heading = "".join(
        f'<th scope="col"{CLASSES[one]}>{text(head)}</th>'
        for head, one in zip(heads, right, strict=True)
    )
    body = "\n".join(f"<tr>{_cells(row, right)}</tr>" for row in held)
    return (
        f'<div class="held"><div class="scroll" role="group" tabindex="0" aria-label="{text(caption)}">'
        f'<table id="{name}"><caption>{text(caption)}</caption><thead><tr>{heading}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
        f'<p class="tool"><button type="button" class="copy" data-table="{name}" hidden'
        f' aria-label="Copy the table: {text(caption)}">Copy</button></p></div>\n'
    )


def _cells(row: Sequence[str], right: Sequence[bool]) -> str:
    cells = zip(row[1:], right[1:], strict=True)
    others = "".join(f"<td{CLASSES[is_right]}>{one}</td>" for one, is_right in cells)
    return f'<th scope="row">{row[0]}</th>{others}'


def facts(data: Data) -> list[tuple[str, str]]:
    """The content of the page's head, as names and texts."""
    sheet = data.sheet
    fine = sum(str(one) in ("0", "0.0") for one in sheet.cells["exit"])
    found = [("Runs", str(len(data))), ("Fine (exit code 0)", _share(fine, len(data)))]
    found.append(("Orders", str(len(data.orders) - any(not one.signature for one in data.orders))))
    failed = next((one for one in data.measures if one.column.name == "expects_failed"), None)
    if failed:
        count = int((failed.values > 0).sum())
        found.append(("With failed expectations", _share(count, len(data))))
    found += [(name, shown(value)) for name, value in _planned(data)]
    return found


def _planned(data: Data) -> Iterable[tuple[str, str]]:
    """The content of the plan beside the table."""
    plan = data.sheet.plan
    question = plan.get("question")
    if isinstance(plan.get("prima"), str):
        yield "Version of PRIMA", plan["prima"]
    if isinstance(question, dict):
        for name, key in (("Design", "design"), ("Seeds", "seeds")):
            if isinstance(question.get(key), str | int):
                yield name, str(question[key])


def documents(data: Data) -> list[str]:
    """The scenarios named by the sweep's plan, then the digests of all its documents."""
    plan = data.sheet.plan
    question, files = plan.get("question"), plan.get("files")
    scenarios = question.get("scenarios") if isinstance(question, dict) else None
    named = scenarios[:LISTED] if isinstance(scenarios, list) else []
    digests = files[:LISTED] if isinstance(files, list) else []
    return [shown(str(one)) for one in named] + [str(one)[:12] for one in digests]


def _share(count: int, whole: int) -> str:
    return f"{count} ({count / whole:.1%})"


def factors(data: Data) -> str:
    """The table of factors, including those with one level."""
    rows = []
    for one in data.factors:
        column = one.column
        name = with_unit(one.name, column.unit)
        cells = (name, _levels(one), str(one.count), str(one.missing))
        rows.append([text(cell) for cell in (*cells, shown(column.description))])
    heads = ("Factor", "Levels", "Number", "Without a value", "What it is")
    return table("factors", "Factors", heads, rows)


def _levels(factor: FactorColumn) -> str:
    distinct = factor.distinct
    if factor.numeric:
        if len(distinct) > 8:
            return " to ".join(numbers([distinct[0], distinct[-1]]))
        return ", ".join(numbers(distinct)) or "–"
    listed = ", ".join(f"“{shown(one)}”" if one else "(nothing)" for one in distinct[:8])
    return listed if len(distinct) <= 8 else f"{listed}, and {len(distinct) - 8} more"


def outcomes(data: Data) -> str:
    """How the runs ended, the most frequent first."""
    cells = data.sheet.cells
    empty = [""] * len(data)
    ended, failures = cells.get("ended", empty), cells.get("failures", empty)
    every = Counter(
        zip(map(_word, cells["exit"]), map(_word, ended), map(_word, failures), strict=True)
    )
    rows = [
        (text(code), text(shown(end) or "–"), text(shown(why) or "–"), _share(count, len(data)))
        for (code, end, why), count in every.most_common(LISTED)
    ]
    if len(every) > LISTED:
        left = sum(every.values()) - sum(count for _, count in every.most_common(LISTED))
        rows.append(
            ("others", "–", f"{len(every) - LISTED} other outcomes", _share(left, len(data)))
        )
    heads = ("Exit code", "Ended", "What went wrong", "Runs")
    return table("outcomes", "How runs ended", heads, rows)


def _word(cell: object) -> str:
    return "" if cell is None else str(cell)[:1000]


HEADS = ("Runs", "Missing", "Mean", "95 % from", "to", "SD", "Least", "Q1", "Median", "Q3", "Most")


def _summary(found: ValueSummary | None) -> list[str]:
    if found is None:
        return ["0", *["–"] * (len(HEADS) - 1)]
    values = (
        *(found.mean, found.low, found.high, found.deviation),
        *(found.least, found.lower, found.median, found.upper, found.most),
    )
    return [str(found.count), str(found.missing), *map(number, values)]


def measures(analysis: Analysis) -> str:
    """The table of all measures that differ between runs."""
    rows = []
    for index, made in enumerate(analysis.distributions):
        name = text(with_unit(made.measure.name, made.measure.column.unit))
        rows.append([f'<a href="#m{index}">{name}</a>', *_summary(made.whole)])
    return table("measures", "Measures over all runs", ("Measure", *HEADS), rows)


def by_level(index: int, made: Distribution) -> str:
    """The table of a measure by each level of each factor."""
    rows = [
        [text(panel.factor.name), text(level), *_summary(found)]
        for panel in made.panels
        for level, found in zip(panel.levels.names, panel.summaries, strict=True)
    ]
    heads = ("Factor", "Level", *HEADS)
    return table(f"levels-{index}", f"{made.measure.name} by level", heads, rows)


def tests(analysis: Analysis) -> str:
    """The table of tests, with their sizes and the functions that made them."""
    rows = []
    for measure, factor, one in analysis.tests:
        sizes = ", ".join(map(str, one.sizes))
        if one.method is MANN_WHITNEY:
            pairs = zip(factor.levels(2, 2).names, one.sizes, strict=True)
            sizes = ", ".join(f"{name[:30]}: {size}" for name, size in pairs)
        cells = [measure.name, factor.name, one.method.name]
        cells += [f"{one.method.statistic} = {number(one.statistic)}", sizes]
        cells += [probability(one.p), probability(one.adjusted)]
        cells += [f"{one.method.effect} = {number(one.effect)}", one.method.function]
        rows.append([text(cell) for cell in cells])
    heads = (
        "Measure",
        "Factor",
        "Test",
        "Statistic",
        "Runs",
        "p",
        "p (Holm)",
        "Effect",
        "Function",
    )
    return table("tests", "Tests of each measure by each factor", heads, rows)


def untested(analysis: Analysis) -> str:
    """The table of measures that are not tested, and why."""
    rows = [
        [text(measure.name), text(factor.name), text(one.why)]
        for measure, factor, one in analysis.untested
    ]
    return table("untested", "What is not tested", ("Measure", "Factor", "Why"), rows)


def orders(data: Data, link: Link) -> str:
    """The table of orders, the most frequent first."""
    rows = []
    for place, one in enumerate(data.orders[:LISTED]):
        address = link(one)
        signature = text(shown(one.signature)) if one.signature else "no order: the run did not end"
        where = f'<a href="{text(address)}">transcript</a>' if address else "none"
        label = f'<span class="key fill{shade(place)}">{text(one.label)}</span>'
        rows.append(
            (
                label,
                f"<code>{signature}</code>",
                _share(one.runs, len(data)),
                text(one.first),
                where,
            )
        )
    heads = ("Order", "Signature", "Runs", "First run", "Transcript")
    return table("orders", "Orders, the most frequent first", heads, rows)


def map_table(data: Data, made: OrderMap, names: Sequence[str], link: Link) -> str:
    """The map of orders as a table; the page's script makes the same for other factors."""
    columns = made.columns.names if made.columns else ["Order"]
    corner = text(" \\ ".join(names))
    head = "".join(f'<th scope="col">{text(one)}</th>' for one in columns)
    wide, rows = len(columns), []
    for row, name in enumerate(made.rows.names):
        cells = "".join(_cell(data, made, row * wide + column, link) for column in range(wide))
        rows.append(f'<tr><th scope="row">{text(name)}</th>{cells}</tr>')
    return (
        f'<table id="map"><caption>The most frequent order by {text(" and ".join(names))}</caption>'
        f'<thead><tr><th scope="col">{corner}</th>{head}</tr></thead><tbody>'
        + "\n".join(rows)
        + "</tbody></table>"
    )


def _cell(data: Data, made: OrderMap, index: int, link: Link) -> str:
    found = made.cells[index]
    if found is None:
        return '<td class="empty">–</td>'
    place, runs, whole, distinct = found
    order = data.orders[place]
    address = link(order)
    title = f"Order {order.label}, {runs} of {whole} runs"
    label = text(order.label)
    label = (
        f'<a href="{text(address)}" aria-label="{text(title)}">{label}</a>' if address else label
    )
    more = f' <span class="more">+{distinct - 1}</span>' if distinct > 1 else ""
    return f'<td class="fill{shade(place)}">{label}{more}</td>'
