"""Figures of a table as SVG: a measure whole and by factor, and the map of orders."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10
from sys import float_info

from prima.errors.visible import visible
from prima.graph.svg import box, circle, fit, line, measure, picture, text
from prima.results.analysis import Distribution, Panel
from prima.results.data import Data, FactorColumn, number, with_unit
from prima.results.ordermap import OrderMap
from prima.results.statistics import ValueSummary
from prima.transcript import colours

WIDTH = 720.0
LEFT, RIGHT = 170.0, 60.0
"""The space for the names of levels, and for the numbers of runs."""
HEIGHT = 84.0
"""Of a histogram."""
ROW = 19.0
CELL = 26.0
COLOURED = colours.NOBODY
"""The number of orders with a colour of their own: the most frequent ones."""
LISTED = 12
"""The number of orders that the figure of a map lists."""

STYLE = """
.bin { fill: #9cc3ea; stroke: #1c5d99; stroke-width: 0.6 }
.range { stroke: #6e7781; stroke-width: 1 }
.quartiles { fill: #dfe5ec; stroke: #6e7781; stroke-width: 1 }
.median { stroke: #1f2328; stroke-width: 2 }
.interval { stroke: #b3261e; stroke-width: 3 }
.mean { fill: #b3261e }
.cell { stroke: #59636e; stroke-width: 0.6 }
.axis { stroke: #59636e; stroke-width: 1 }
.tick { stroke: #d1d9e0; stroke-width: 1 }
@media screen and (prefers-color-scheme: dark) {
  .bin { fill: #24507c; stroke: #7db7ee }
  .range { stroke: #9aa4af }
  .quartiles { fill: #333b47; stroke: #9aa4af }
  .median { stroke: #e6edf3 }
  .interval { stroke: #ff9d8f }
  .mean { fill: #ff9d8f }
  .cell, .axis { stroke: #9aa4af }
  .tick { stroke: #3d444d }
}
"""


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing with its description."""

    name: str
    title: str
    description: str
    width: float
    height: float
    parts: list[str]

    @property
    def file(self) -> str:
        """Its name as a file name."""
        return re.sub(r"[^A-Za-z0-9_.()-]", "_", self.name).lstrip(".-")[:80] or "figure"

    def inline(self) -> str:
        """The drawing as a part of a page."""
        label = escape(visible(f"{self.title}. {self.description}"))
        return (
            f'<svg viewBox="0 0 {self.width:.0f} {self.height:.0f}" role="img"'
            f' aria-label="{label}">{"".join(self.parts)}</svg>'
        )

    def whole(self) -> str:
        """The drawing as a file."""
        style = f"<style>{STYLE}</style>"
        description = visible(self.description)
        return picture(self.title, description, self.width, self.height, [style, *self.parts])


class Scale:
    """A scale that maps values to positions between two points."""

    def __init__(self, low: float, high: float, begin: float, end: float) -> None:
        self.low, self.high = low, high
        self.begin, self.end = begin, end

    def at(self, value: float) -> float:
        """The place of a value."""
        return self.begin + (value - self.low) / (self.high - self.low) * (self.end - self.begin)

    def ticks(self, least: float = 0.0) -> list[float]:
        """At most eight round values between the ends, with a minimum distance."""
        rough = max((self.high - self.low) / 5, least, float_info.min)
        power = 10.0 ** floor(log10(rough))
        step = next(one * power for one in (1, 2, 5, 10) if one * power >= rough)
        first, last = ceil(self.low / step - 1e-9), floor(self.high / step + 1e-9)
        return [round(index * step, 12) for index in range(first, last + 1)]


def distribution(made: Distribution) -> Figure:
    """A measure over all runs, and below by each factor, on one scale."""
    scale = Scale(made.edges[0], made.edges[-1], LEFT, WIDTH - RIGHT)
    bottom = 30 + HEIGHT
    parts = [
        text(8, 24, "All runs", "name"),
        *_bins(made, scale, bottom),
        *_interval(made.whole, scale, 20),
        text(WIDTH - RIGHT + 6, 24, f"n {made.whole.count}", "small"),
    ]
    y = bottom + 18
    panels: list[str] = []
    for panel in made.panels:
        panels += _panel(panel, scale, y)
        y += 32 + ROW * len(panel.levels.names)
    ticks = scale.ticks(1.0 if made.whole_numbers else 0.0)
    grid = [line(scale.at(one), 30, scale.at(one), y, "tick") for one in ticks]
    labels = [_middle(scale.at(one), y + 14, number(one)) for one in ticks]
    title = with_unit(made.measure.name, made.measure.column.unit)
    labels.append(_middle((LEFT + WIDTH - RIGHT) / 2, y + 32, title))
    axis = line(LEFT, y, WIDTH - RIGHT, y, "axis")
    by = ", ".join(panel.factor.name for panel in made.panels)
    whole = made.whole
    description = (
        f"{whole.count} runs from {number(whole.least)} to {number(whole.most)}, mean"
        f" {number(whole.mean)} ({number(whole.low)} to {number(whole.high)})"
    )
    description += f"; below by {by}" if by else ""
    heading = f"{title}: {made.measure.column.description}"
    parts = [*grid, axis, *parts, *panels, *labels]
    return Figure(made.measure.name, heading, description, WIDTH, y + 42, parts)


def _bins(made: Distribution, scale: Scale, bottom: float) -> list[str]:
    most = max(made.counts)
    parts = []
    for low, high, count in zip(made.edges, made.edges[1:], made.counts, strict=False):
        if count:
            tall = max(1.0, count / most * HEIGHT)
            left, right = scale.at(low), scale.at(high)
            parts.append(box(left, bottom - tall, max(0.5, right - left), tall, "bin", 0))
    parts.append(line(LEFT, bottom, WIDTH - RIGHT, bottom, "axis"))
    parts.append(text(WIDTH - RIGHT + 6, 38, str(most), "small"))
    return parts


def _interval(found: ValueSummary, scale: Scale, y: float) -> list[str]:
    """The mean with its interval."""
    return [
        line(scale.at(found.low), y, scale.at(found.high), y, "interval"),
        circle(scale.at(found.mean), y, 3.4, "mean"),
    ]


def _panel(panel: Panel, scale: Scale, y: float) -> list[str]:
    """A measure by a factor, a row for each level."""
    name = with_unit(panel.factor.name, panel.factor.column.unit)
    parts = [text(8, y + 14, fit(name, LEFT + 60, 13, True), "name")]
    for index, (level, found) in enumerate(zip(panel.levels.names, panel.summaries, strict=True)):
        middle = y + 24 + ROW * (index + 0.5)
        parts.append(text(14, middle + 4, fit(level, LEFT - 24)))
        count = found.count if found else 0
        parts.append(text(WIDTH - RIGHT + 6, middle + 4, f"n {count}", "small"))
        if found is not None:
            parts += _row(found, scale, middle)
    return parts


def _row(found: ValueSummary, scale: Scale, y: float) -> list[str]:
    """All values, their quartiles, the median, and the mean with its interval."""
    lower, upper, middle = (scale.at(one) for one in (found.lower, found.upper, found.median))
    return [
        line(scale.at(found.least), y, scale.at(found.most), y, "range"),
        box(lower, y - 6, max(upper - lower, 0.5), 12, "quartiles", 0),
        line(middle, y - 6, middle, y + 6, "median"),
        *_interval(found, scale, y),
    ]


def _middle(x: float, y: float, what: str) -> str:
    """A line of text around a place."""
    return text(x - measure(what) / 2.15, y, what)


# Orders ----------------------------------------------------------------------------------


def shade(place: int) -> int:
    """The colour of an order, by its rank; grey for the less frequent ones."""
    return min(place, COLOURED)


def orders(data: Data, made: OrderMap, factors: Sequence[FactorColumn]) -> Figure:
    """The map of orders over one factor or two, with the most frequent orders below."""
    names = made.columns.names if made.columns else [""]
    tall = max((measure(fit(one, 110)) for one in names), default=0) * 0.8 + 12
    top = 44 + tall
    parts = [text(8, 20, " by ".join(one.name for one in factors), "name")]
    for index, name in enumerate(names):
        x = LEFT + CELL * (index + 0.6)
        turned = f"rotate(-55 {x:.1f} {top - 6:.1f})"
        label = text(x, top - 6, fit(name, 110))
        parts.append(label.replace("<text", f'<text transform="{turned}"', 1))
    for row, name in enumerate(made.rows.names):
        parts.append(text(14, top + CELL * (row + 0.65), fit(name, LEFT - 24)))
        for column in range(len(names)):
            x, y = LEFT + CELL * column, top + CELL * row
            parts += _cell(data, made, row * len(names) + column, x, y)
    y = top + CELL * len(made.rows.names) + 24
    for place, order in enumerate(data.orders[:LISTED]):
        parts.append(box(14, y - 10, 14, 13, f"s{shade(place)}", 0))
        share = order.runs / len(data)
        signature = order.signature or "no order: the run did not end"
        parts.append(
            text(34, y + 1, f"{order.label}: {signature}, {order.runs} runs ({share:.1%})")
        )
        y += 17
    if len(data.orders) > LISTED:
        parts.append(text(34, y + 1, f"and {len(data.orders) - LISTED} more", "small"))
        y += 17
    width = max(WIDTH, LEFT + CELL * len(names) + 90)
    description = f"{len(data.orders)} orders in {len(data)} runs; in each cell the most frequent"
    return Figure("orders", "Map of orders", description, width, y, parts)


def _cell(data: Data, made: OrderMap, index: int, x: float, y: float) -> list[str]:
    found = made.cells[index]
    if found is None:
        return [box(x, y, CELL, CELL, "frame", 0)]
    place, _, _, distinct = found
    label = data.orders[place].label + ("+" if distinct > 1 else "")
    size = measure(label)
    words = text(x + max(1, (CELL - size) / 2), y + CELL * 0.65, fit(label, CELL + 6))
    return [box(x, y, CELL, CELL, f"s{shade(place)} cell", 0), words]
