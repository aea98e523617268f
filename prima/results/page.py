"""The page of a table as text: everything that the table says is escaped here or in its tables."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import lru_cache
from itertools import combinations
from pathlib import Path
from string import Template
from typing import Any
from urllib.parse import quote

from prima.errors import counted
from prima.report.parts import described, json_text, part, policy_of, style_of, text
from prima.results import tables
from prima.results.analysis import MOST_LEVELS, Analysis, Distribution, analyse
from prima.results.data import Data, MeasureColumn, OrderRow, number, shown
from prima.results.figures import COLOURED, STYLE, distribution
from prima.results.ordermap import MOST_LINKED, OrderMap, map_levels, order_map
from prima.results.statistics import LEAST_GROUP, LEAST_PAIRS, MOST_DISTINCT, RESAMPLES, SEED

ROOM = "prima.results"
FIGURES = "/* figures */"


def page(data: Data, folder: Path, by: tuple[int, ...]) -> str:
    """The page of a table.

    Args:
        data: the table.
        folder: where the page will be, for its links to transcripts.
        by: the factors of its first map, as places in ``data.varied``: two, one, or none.
    """
    analysis = analyse(data)
    link = _links(data, folder)
    style = style_of(ROOM, "results.css").replace(FIGURES, STYLE)
    script = part(ROOM, "results.js")
    name = data.sheet.path.name
    figures = "".join(_figure(*one) for one in enumerate(analysis.distributions))
    body = {
        "title": text(f"Sweep {shown(name)}"),
        "policy": policy_of(style, script),
        "style": style,
        "script": script,
        "notes": _notes(data),
        "facts": described(tables.facts(data)),
        "factors": tables.factors(data),
        "outcomes": tables.outcomes(data),
        "measures": tables.measures(analysis) if analysis.distributions else "",
        "constant": _constant(analysis.constant),
        "figures": figures or "<p>No measure differs between runs.</p>",
        "tests": _tests(data, analysis),
        "map": _map(data, by, link),
        "orders": tables.orders(data, link),
        "made": _made(data),
        "source": text(shown(name)),
        "data": json_text(_data(data, link)),
    }
    return Template(part(ROOM, "template.html")).substitute(body)


def _links(data: Data, folder: Path) -> Callable[[OrderRow], str]:
    """Returns the address of an order's transcript, relative to the page's folder."""
    begin = data.sheet.path.parent
    base = os.path.realpath(folder)

    @lru_cache(MOST_LINKED)
    def link(order: OrderRow) -> str:
        target = begin / order.transcript
        if not order.transcript or order.number > MOST_LINKED or not target.is_file():
            return ""
        try:
            way = os.path.relpath(os.path.realpath(target), base)
        except ValueError:  # on another drive
            return ""
        way = way.replace(os.sep, "/")
        return quote(way if way.startswith("..") else f"./{way}", errors="replace")

    return link


def _notes(data: Data) -> str:
    notes = list(data.notes)
    if data.sheet.cut:
        notes.insert(0, f"The table is not whole: {data.sheet.cut}.")
    return "".join(f'<p class="cut">{text(one)}</p>\n' for one in notes)


def _constant(measures: list[MeasureColumn]) -> str:
    """The paragraph about measures that do not differ."""
    if not measures:
        return ""
    listed = ", ".join(_value(one) for one in measures)
    same = "The same in all runs that have a value, so neither drawn nor tested"
    return f'<p id="constant">{same}: {listed}.</p>\n'


def _value(measure: MeasureColumn) -> str:
    known = [one for one in measure.values.tolist() if one == one]
    value = f"{number(known[0])}{measure.unit}" if known else "no value"
    if known and (missing := len(measure.values) - len(known)):
        value += f"; {counted(missing, 'run')} without a value"
    return text(f"{measure.name} ({value})")


def _figure(index: int, made: Distribution) -> str:
    drawn = distribution(made)
    name = text(made.measure.name)
    missing = made.whole.missing
    remark = f"<p>{counted(missing, 'run')} without a value.</p>" if missing else ""
    by_level = ""
    if made.panels:
        by_level = (
            f"<details><summary>{name} as a table</summary>{tables.by_level(index, made)}</details>"
        )
    return (
        f'<section aria-labelledby="m{index}"><h3 id="m{index}" tabindex="-1">{name}</h3>'
        f"<p>{text(shown(made.measure.column.description))}</p>{remark}"
        f'<figure><div class="scroll" tabindex="0" role="group" aria-label="Figure of {name}">'
        f"{drawn.inline()}</div></figure>{by_level}</section>\n"
    )


def _tests(data: Data, analysis: Analysis) -> str:
    if not data.varied:
        return "<p>No factor has more than one level, so there is nothing to compare.</p>"
    made = tables.tests(analysis) if analysis.tests else "<p>No test could be made.</p>"
    if analysis.untested:
        made += f"<details><summary>What is not tested, and why</summary>{tables.untested(analysis)}</details>"
    return (
        "<p>p says how often chance alone would show so much if the factor changed nothing. More"
        " runs make it as small as one likes, so read the effect sizes. The tests take runs as"
        " independent: that runs of one seed have the same user is not used.</p>" + made
    )


def _map(data: Data, by: tuple[int, ...], link: Callable[[OrderRow], str]) -> str:
    """The map of orders with the selection of its factors."""
    made = ""
    if not any(link(one) for one in data.orders[:MOST_LINKED]):
        made = (
            "<p>There are no transcripts of the orders beside the table, so nothing leads to"
            " them; prima sweep writes them into a folder with the table's name.</p>"
        )
    if not by:
        return made + "<p>No factor has more than one level, so there is no map.</p>"
    levels = map_levels(data)
    rows, columns = by[0], by[1] if len(by) > 1 else None
    first = order_map(data, [levels[one] for one in by])
    names = [data.varied[one].name for one in by]
    return (
        "<p>Each cell has the number of the order that most of its runs have, with a link to that"
        " order's transcript; +2 means that runs in it have two other orders besides."
        f" The {COLOURED} most frequent orders have colours, the others are grey.</p>{made}"
        '<form class="choose" hidden>'
        f"<label>Rows {_select('map-rows', data, rows, False)}</label>"
        f"<label>Columns {_select('map-columns', data, columns, True)}</label></form>"
        '<div class="scroll" tabindex="0" role="group" aria-label="Map of orders">'
        f"{tables.map_table(data, first, names, link)}</div>"
    )


def _select(name: str, data: Data, chosen: int | None, none: bool) -> str:
    options = [
        f'<option value="{index}"{" selected" if index == chosen else ""}>{text(one.name)}</option>'
        for index, one in enumerate(data.varied)
    ]
    if none:
        picked = " selected" if chosen is None else ""
        options.append(f'<option value="-1"{picked}>none</option>')
    return f'<select id="{name}" autocomplete="off">{"".join(options)}</select>'


def _made(data: Data) -> str:
    """How the numbers were computed, and from what."""
    words = {
        "resamples": RESAMPLES,
        "seed": SEED,
        "distinct": MOST_DISTINCT,
        "levels": MOST_LEVELS,
        "group": LEAST_GROUP,
        "pairs": LEAST_PAIRS,
    }
    made = Template(part(ROOM, "formulas.html")).substitute({k: str(v) for k, v in words.items()})
    listed = "".join(f"<li><code>{text(one)}</code></li>" for one in tables.documents(data))
    if listed:
        made += (
            "<details><summary>Scenarios, and the digests of all documents</summary>"
            f"<ul>{listed}</ul></details>"
        )
    return made


def _data(data: Data, link: Callable[[OrderRow], str]) -> dict[str, Any]:
    """The data from which the script draws maps of other factors."""
    levels = map_levels(data)
    maps: dict[str, OrderMap] = {}
    for count in (1, 2):
        for chosen in combinations(range(len(levels)), count):
            key = ",".join(map(str, chosen))
            maps[key] = order_map(data, [levels[one] for one in chosen])
    none = next((one.number - 1 for one in data.orders if not one.signature), -1)
    return {
        "factors": [
            {"name": one.name, "levels": held.names}
            for one, held in zip(data.varied, levels, strict=True)
        ],
        "orders": [[one.label, link(one)] for one in data.orders[:MOST_LINKED]],
        "none": none,
        "coloured": COLOURED,
        "maps": {key: [one and list(one) for one in made.cells] for key, made in maps.items()},
    }
