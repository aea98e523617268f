"""The map of a world: places, ways, walls, areas, corners and things, in metres."""

from __future__ import annotations

import json
from math import dist
from typing import TYPE_CHECKING

from prima.graph import text as words
from prima.graph.model import clean
from prima.graph.svg import box, circle, fit, line, measure, picture, text
from prima.transcript.colours import NOBODY, colours

if TYPE_CHECKING:
    from prima.sim.map import Map
    from prima.sim.plan import Point

MARGIN, TOP = 24.0, 54.0
WIDE, HIGH = 900.0, 640.0
"""Maximum size of a map (pixels)."""
MOST_SCALE = 90.0
"""Maximum pixels per metre."""
LEAST = 300.0
MOST_STEPS = 1000
"""Points of a line that labels avoid."""
BAR = 15.0
"""Height of a label (pixels)."""
LEGEND = (
    ("place", "place"),
    ("way", "way"),
    ("wall", "wall"),
    ("thing", "thing"),
    ("corner", "corner"),
    ("area", "area that offers an application"),
)


def shades(world: Map) -> dict[str, int]:
    """The colours of the applications that areas offer, by the areas."""
    names = {area.id: area.src.rpartition("/")[2].partition(".")[0] for area in world.areas}
    found = colours(names.values())
    return {area: found.get(name, NOBODY) for area, name in names.items()}


class _Sheet:
    """Converts a world's metres to places on the page."""

    def __init__(self, world: Map) -> None:
        points = [*world.places.values(), *world.things.values()]
        points += [point for wall in world.walls for point in wall]
        points += [point for area in world.areas for point in (area.low, area.high)]
        for corner in world.corners:
            (x, y), r = corner.at, corner.radius
            points += [(x - r, y - r), (x + r, y + r)]
        xs, ys = [x for x, _ in points] or [0.0], [y for _, y in points] or [0.0]
        self.left, self.top = min(xs) - 0.5, max(ys) + 0.5
        across, down = max(xs) + 0.5 - self.left, self.top - min(ys) + 0.5
        self.scale = min(WIDE / across, HIGH / down, MOST_SCALE)
        self.width = max(across * self.scale, LEAST) + 2 * MARGIN
        self.bottom = TOP + down * self.scale
        self._taken: list[tuple[float, float, float, float]] = []
        """Where marks and labels are."""
        self._crossed: list[tuple[float, float]] = []
        """Points of lines that labels should avoid."""

    def at(self, point: Point) -> Point:
        """A place on the page."""
        x, y = point
        return MARGIN + (x - self.left) * self.scale, TOP + (self.top - y) * self.scale

    def keep(self, point: Point, half: float) -> None:
        """Keep labels away from a mark."""
        x, y = self.at(point)
        self._taken.append((x - half, y - half, x + half, y + half))

    def keep_line(self, a: Point, b: Point) -> None:
        """Keep labels away from a line, if possible."""
        (x1, y1), (x2, y2) = self.at(a), self.at(b)
        steps = min(int(dist((x1, y1), (x2, y2)) / 6) + 1, MOST_STEPS)
        for step in range(steps + 1):
            share = step / steps
            self._crossed.append((x1 + (x2 - x1) * share, y1 + (y2 - y1) * share))

    def label(self, point: Point, name: str, kind: str = "") -> str:
        """A name beside a point, at a free place if there is one."""
        name = fit(clean(name), 200)
        x, y = self.at(point)
        wide = measure(name, *((13, True) if kind == "name" else ()))
        beside = [
            (x + 8, y + 4),
            (x - 8 - wide, y + 4),
            (x - wide / 2, y - 9),
            (x - wide / 2, y + 19),
        ]
        beside += [(x - wide / 2, y + 19 + BAR * step) for step in (1, 2, 3)]
        tried = [(a, b - 11, a + wide, b + 4) for a, b in beside]
        best = min(range(len(tried)), key=lambda one: (self._covered(tried[one]), one))
        self._taken.append(tried[best])
        return text(*beside[best], name, kind)

    def _covered(self, one: tuple[float, float, float, float]) -> int:
        """The cost of a label's place: overlaps with labels, the page's edge and, less, lines."""
        left, top, right, bottom = one
        others = sum(
            left < x2 and x1 < right and top < y2 and y1 < bottom for x1, y1, x2, y2 in self._taken
        )
        lines = sum(left < x < right and top < y < bottom for x, y in self._crossed)
        return (others + (left < 2 or right > self.width - 2)) * MOST_STEPS + lines


def draw(world: Map) -> str:
    """A world as SVG."""
    sheet = _Sheet(world)
    shade = shades(world)
    parts = [text(MARGIN, 26, f"The map of {clean(world.id)}", "name"), *_ruler(sheet)]
    parts += [_area(sheet, area.low, area.high, f"s{shade[area.id]}") for area in world.areas]
    for a, b in world.ways:
        parts.append(line(*sheet.at(world.places[a]), *sheet.at(world.places[b]), "way"))
    for corner in world.corners:
        parts.append(circle(*sheet.at(corner.at), corner.radius * sheet.scale, "corner"))
    parts += [line(*sheet.at(a), *sheet.at(b), "wall") for a, b in world.walls]
    parts += [circle(*sheet.at(at), 4.5, "place") for at in world.places.values()]
    for at in world.things.values():
        x, y = sheet.at(at)
        parts.append(box(x - 4.5, y - 4.5, 9, 9, "thing", 1))
    parts += _labels(sheet, world)
    parts += _legend(world, sheet.bottom + 26)
    width = max(sheet.width, 640.0)
    return picture(
        f"The map of {clean(world.id)}", describe(world), width, sheet.bottom + 40, parts
    )


def _labels(sheet: _Sheet, world: Map) -> list[str]:
    for at in (*world.places.values(), *world.things.values()):
        sheet.keep(at, 5)
    for a, b in (*world.walls, *((world.places[a], world.places[b]) for a, b in world.ways)):
        sheet.keep_line(a, b)
    parts = [sheet.label(at, name, "name") for name, at in world.places.items()]
    parts += [sheet.label(at, name) for name, at in world.things.items()]
    for corner in world.corners:
        event = "" if corner.event == "corner" else f": {corner.event}"
        parts.append(sheet.label(corner.at, f"{corner.id}{event}", "small"))
    for area in world.areas:
        x, y = sheet.at((area.low[0], area.high[1]))
        parts.append(text(x + 8, y + 16, fit(area.title or area.id, 200), "small"))
    return parts


def _area(sheet: _Sheet, low: Point, high: Point, kind: str) -> str:
    (left, bottom), (right, top) = sheet.at(low), sheet.at(high)
    return box(left, top, right - left, bottom - top, f"{kind} area", 0)


def _ruler(sheet: _Sheet) -> list[str]:
    """A scale bar of one, ten or a hundred metres."""
    metres = next((one for one in (1, 2, 5, 10, 20, 50, 100) if one * sheet.scale >= 30), 1000)
    x, end = MARGIN, MARGIN + metres * sheet.scale
    ends = [line(one, 36, one, 44) for one in (x, end)]
    return [line(x, 40, end, 40), *ends, text(end + 6, 44, f"{metres} m", "small")]


def _legend(world: Map, y: float) -> list[str]:
    """A legend for the marks that occur."""
    held = {
        "place": world.places,
        "way": world.ways,
        "wall": world.walls,
        "thing": world.things,
        "corner": world.corners,
        "area": world.areas,
    }
    parts, x = [], MARGIN
    for kind, name in LEGEND:
        if not held[kind]:
            continue
        middle = y - 4
        marks = {
            "place": circle(x + 11, middle, 4.5, kind),
            "thing": box(x + 6.5, middle - 4.5, 9, 9, kind, 1),
            "corner": circle(x + 11, middle, 7, kind),
            "area": box(x, middle - 6, 22, 12, f"s{NOBODY} area", 0),
        }
        parts.append(marks.get(kind) or line(x, middle, x + 22, middle, kind))
        parts.append(text(x + 28, y, name, "small"))
        x += 46 + measure(name, 10)
    return parts


def describe(world: Map) -> str:
    """The map as text, for accessibility."""
    spots = [f"{name} at {x:g}, {y:g}" for name, (x, y) in list(world.places.items())[:40]]
    things = [f"{name} at {x:g}, {y:g}" for name, (x, y) in list(world.things.items())[:40]]
    ways = [f"{a} to {b}" for a, b in world.ways[:60]]
    corners = [f"{one.id} within {one.radius:g} m" for one in world.corners[:40]]
    areas = [one.title or one.id for one in world.areas[:40]]
    named = [("Places", spots), ("Ways", ways), ("Things", things)]
    named += [("Corners", corners), ("Areas", areas)]
    found = [f"{what}: {clean(', '.join(names))}." for what, names in named if names]
    return " ".join([*found, f"{len(world.walls)} walls. Lengths in metres."])


# For other programs ---------------------------------------------------------------------------


def dot(world: Map) -> str:
    """Places and ways in DOT, with positions (``neato -n``)."""
    number = {name: f"n{index}" for index, name in enumerate(world.places, 1)}
    made = [
        "graph prima {",
        f"  graph [label={words.quote(clean(f'The map of {world.id}'))}, labelloc=t, layout=neato];",
        '  node [shape=box, style="rounded", fontname="sans-serif", fontsize=11];',
    ]
    for name, (x, y) in world.places.items():
        made.append(f'  {number[name]} [label={words.quote(clean(name))}, pos="{x:g},{y:g}!"];')
    made += [f"  {number[a]} -- {number[b]};" for a, b in world.ways]
    return "\n".join([*made, "}"]) + "\n"


def mermaid(world: Map) -> str:
    """Places and ways in Mermaid, which has no positions."""
    number = {name: f"n{index}" for index, name in enumerate(world.places, 1)}
    made = ["---", f"title: {json.dumps(clean(f'The map of {world.id}'))}", "---", "flowchart LR"]
    made += [f'  {number[name]}["{words.entity(clean(name))}"]' for name in world.places]
    made += [f"  {number[a]} --- {number[b]}" for a, b in world.ways]
    return "\n".join(made) + "\n"


def data(world: Map) -> str:
    """All of a world in JSON, in metres."""
    made = {
        "title": f"The map of {world.id}",
        "places": [{"id": name, "x": x, "y": y} for name, (x, y) in world.places.items()],
        "ways": [{"from": a, "to": b} for a, b in world.ways],
        "walls": [{"x1": a, "y1": b, "x2": c, "y2": d} for (a, b), (c, d) in world.walls],
        "things": [{"id": name, "x": x, "y": y} for name, (x, y) in world.things.items()],
        "corners": [
            {"id": one.id, "x": one.at[0], "y": one.at[1], "radius": one.radius, "event": one.event}
            for one in world.corners
        ],
        "areas": [
            {
                "id": one.id,
                "title": one.title,
                "application": one.src,
                "x1": one.low[0],
                "y1": one.low[1],
                "x2": one.high[0],
                "y2": one.high[1],
            }
            for one in world.areas
        ],
    }
    return json.dumps(made, ensure_ascii=False, indent=2) + "\n"
