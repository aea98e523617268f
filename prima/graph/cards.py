"""The picture of an application's states: each is a card that says where it leads, and why.

All words are in the cards, so that no label lies on a line or on another label. The cards
are in columns by their distance from the start. If there are more columns than a page has
room for, they wrap into rows, like words into lines; no line is drawn from one row to
another, as the card names its target.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape

from prima.graph.layout import LayoutEdge, arrange, distances
from prima.graph.model import Edge, Graph, GraphNode
from prima.graph.svg import SIZE, box, fit, head, line, measure, picture, text, wrap

WIDTH = 236.0
PAD = 9.0
LEADING = 15.0
TITLE = 24.0
"""Height of a card's name."""
COLUMNS = 6
"""Maximum number of columns in one row of the page."""
GAP = 22.0
MARGIN = 18.0
MANY_BACK = 6
"""Maximum number of lines back to one card; if there are more, none is drawn."""
LONGEST_BOW = 900.0
"""Maximum length of a line back within a column."""
LEGEND = (("go", "leads to"), ("call", "calls and comes back"), ("guess", "may lead to"))


@dataclass(slots=True)
class CardEdge:
    """An edge as a card shows it: where it begins, and its lines of text."""

    edge: Edge
    at: float
    lines: list[tuple[str, float]]
    """Lines with their indentation: continuation lines are indented further."""


@dataclass(slots=True)
class Card:
    """A node with its text wrapped."""

    node: GraphNode
    height: float = 0.0
    marks: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    ways: list[CardEdge] = field(default_factory=list)
    x: float = 0.0
    y: float = 0.0


def draw(graph: Graph) -> str:
    """The states of an application as SVG."""
    cards = {key: _card(graph, node) for key, node in graph.nodes.items()}
    columns = _columns(graph)
    deepest = max(columns.values(), default=0) + 1
    rows = 1 if deepest <= COLUMNS + 2 else -(-deepest // COLUMNS)
    each = -(-deepest // rows)
    parts: list[str] = []
    y, width = MARGIN + 26, 0.0
    for row in range(rows):
        held = {key: column % each for key, column in columns.items() if column // each == row}
        band = _Band(graph, {key: cards[key] for key in held}, held)
        drawn, right, bottom = band.draw(y)
        parts += drawn
        width, y = max(width, right), bottom + 34
    width = max(width + MARGIN, 560.0)
    top = [text(MARGIN, MARGIN + 8, fit(graph.title, width - 2 * MARGIN, 13, True), "name")]
    return picture(
        graph.title, graph.description, width, y + 6, top + parts + _legend(graph, y - 4)
    )


def _columns(graph: Graph) -> dict[str, int]:
    """Each state's distance from the start, or from what holds in any state."""
    number = {key: index for index, key in enumerate(graph.nodes)}
    follows = [[number[edge.target] for edge in graph.out(key) if edge.target] for key in number]
    starts = [number[key] for key, node in graph.nodes.items() if node.start]
    starts += [number[key] for key, node in graph.nodes.items() if node.kind == "any"]
    return dict(zip(number, distances(len(number), starts, follows), strict=True))


def _legend(graph: Graph, y: float) -> list[str]:
    """A legend for the kinds of lines that occur."""
    kinds = {edge.kind for edge in graph.edges}
    parts, x = [], MARGIN
    for kind, words in LEGEND:
        if kind in kinds and (kind != "go" or len(kinds & {"go", "call", "guess", "back"}) > 1):
            parts.append(line(x, y - 4, x + 26, y - 4, kind))
            parts.append(text(x + 32, y, words, "small"))
            x += 48 + measure(words, 10)
    return parts


# Cards ----------------------------------------------------------------------------------------


def _card(graph: Graph, node: GraphNode) -> Card:
    card = Card(node)
    inner = WIDTH - 2 * PAD
    row: list[str] = []
    for mark in node.marks:
        if row and sum(map(_pill, [*row, mark])) > inner:
            card.marks.append(row)
            row = []
        row.append(mark)
    card.marks += [row] if row else []
    card.notes = [part for note in node.notes for part in wrap(note, inner, 3, 10)]
    y = TITLE + 19 * len(card.marks) + 13 * len(card.notes) + (5 if card.notes else 0)
    for edge in sorted(graph.out(node.key), key=lambda edge: edge.kind == "stay"):
        lines = [
            (part, 10.0 if number == 0 else 20.0)
            for label in edge.labels
            for number, part in enumerate(wrap(label, inner - 20, 3))
        ]
        y += 6
        card.ways.append(CardEdge(edge, y + 9, lines))
        y += LEADING * (1 + len(lines))
    card.height = y + 7
    return card


def _pill(mark: str) -> float:
    return measure(mark, 10) + 14


def _name(graph: Graph, edge: Edge) -> str:
    """The target of an edge, as shown on its card."""
    if not edge.target:
        return edge.words
    if edge.kind == "stay":
        return "stays"
    title = graph.nodes[edge.target].title
    return {"call": f"calls {title}", "back": f"returns to {title}"}.get(edge.kind, f"→ {title}")


def _drawn(graph: Graph, card: Card) -> list[str]:
    """A card's box and text."""
    x, y = card.x, card.y
    parts = _titled(card)
    top = y + TITLE
    for row in card.marks:
        left = x + PAD
        for mark in row:
            wide = _pill(mark)
            parts += [
                box(left, top, wide - 5, 15, "mark", 7),
                text(left + 4.5, top + 11, mark, "small"),
            ]
            left += wide
        top += 19
    for note in card.notes:
        parts.append(text(x + PAD, top + 10, note, "small"))
        top += 13
    for way in card.ways:
        base = y + way.at
        parts.append(line(x, base - 13, x + WIDTH, base - 13, "rule"))
        name = fit(_name(graph, way.edge), WIDTH - 2 * PAD, SIZE, True)
        parts.append(text(x + PAD, base + 2, name, "to"))
        for label, indent in way.lines:
            base += LEADING
            parts.append(text(x + PAD + indent, base + 2, label))
    return parts


def _titled(card: Card) -> list[str]:
    """A card's box with its name."""
    node, x, y = card.node, card.x, card.y
    kind = "box any" if node.kind == "any" else "box first" if node.start else "box"
    start = measure("start", 10) + 4 if node.start else 0
    name = fit(node.title, WIDTH - 2 * PAD - start, 13, True)
    parts = [box(x, y, WIDTH, card.height, kind, 7), text(x + PAD, y + 17, name, "name")]
    if node.start:
        parts.append(text(x + WIDTH - PAD - start + 4, y + 16, "start", "small"))
    if node.source:
        prefix = "start: " if node.start else ""
        parts.append(f"<title>{escape(f'{prefix}{node.title}, {node.source}')}</title>")
    return parts


# Rows of the page -------------------------------------------------------------------------------


class _Band:
    """One row of the page: the cards of some columns."""

    def __init__(self, graph: Graph, cards: dict[str, Card], column: dict[str, int]) -> None:
        self.graph, self.cards, self.column = graph, cards, column
        back = Counter(
            edge.target
            for key, edge in self._inside()
            if key != edge.target and self._is_back(key, edge)
        )
        self.crowded = {key for key, count in back.items() if count > MANY_BACK}
        self.links = self._links()
        heights = [card.height for card in cards.values()]
        columns = list(column.values())
        self.layout = arrange(heights, columns, list(self.links.values()), GAP)
        self.left = self._lefts(columns)

    def _links(self) -> dict[tuple[str, str, str], LayoutEdge]:
        """The lines from column to column, by both cards and the kind of the edge."""
        number = {key: index for index, key in enumerate(self.cards)}
        links: dict[tuple[str, str, str], LayoutEdge] = {}
        for key, card in self.cards.items():
            for way in card.ways:
                to = way.edge.target
                if not self._near(key, way.edge) or self.column[to] == self.column[key]:
                    continue
                ends = (number[key], number[to]), (way.at, 14.0)
                if self._is_back(key, way.edge):
                    ends = ends[0][::-1], ends[1][::-1]
                links[key, to, way.edge.kind] = LayoutEdge(*ends[0], *ends[1])
        return links

    def _inside(self) -> Iterator[tuple[str, Edge]]:
        """The edges between cards of this row, with the keys of their cards."""
        for key, card in self.cards.items():
            for way in card.ways:
                if way.edge.target in self.cards:
                    yield key, way.edge

    def _is_back(self, key: str, edge: Edge) -> bool:
        """Whether an edge leads to an earlier column or stays in its own."""
        return self.column[edge.target] <= self.column[key]

    def _near(self, key: str, edge: Edge) -> bool:
        """Whether a line is drawn: not to another row of the page, nor back to a crowded card."""
        target = edge.target
        if target not in self.cards or edge.kind == "stay":
            return False
        return key == target or not (target in self.crowded and self._is_back(key, edge))

    def _lefts(self, columns: list[int]) -> list[float]:
        """The left edge of each column; more lines between two columns get more room."""
        count = max(columns, default=0) + 1
        lines = [0] * (count + 1)
        near = [(key, edge.target) for key, edge in self._inside() if self._near(key, edge)]
        for one, two in ((self.column[a], self.column[b]) for a, b in near):
            for gutter in range(min(one, two), max(one, two)):
                lines[gutter] += 1
            lines[one] += one == two
        left = [MARGIN]
        for gutter in range(count):
            left.append(left[-1] + WIDTH + min(54 + 4.0 * lines[gutter], 150))
        return left

    def draw(self, top: float) -> tuple[list[str], float, float]:
        """The row's parts, and its right and bottom edges."""
        for index, (key, card) in enumerate(self.cards.items()):
            card.x = self.left[self.column[key]]
            card.y = top + self.layout.aside[index]
        parts: list[str] = []
        for key, card in self.cards.items():
            lost = "" if card.node.reached else " lost"
            lines: list[str] = []
            for way in card.ways:
                lines += self._line(key, card, way, top)
            parts += [f'<g class="state{lost}">', *_drawn(self.graph, card), *lines, "</g>"]
        last = max(self.column.values(), default=0)
        loops = any(
            self.column[edge.target] == last == self.column[key] for key, edge in self._inside()
        )
        right = self.left[last] + WIDTH + (self.left[last + 1] - self.left[last] - WIDTH) * loops
        bottom = top + self.layout.extent
        return parts, right, bottom

    def _line(self, key: str, card: Card, way: CardEdge, top: float) -> list[str]:
        """An edge's line with its head; a stub if the whole line is not drawn."""
        edge, y = way.edge, card.y + way.at - 2
        if not edge.target or edge.kind == "stay":
            return []
        kind = f"edge {edge.kind}"
        shape = "head" if edge.kind == "go" else f"{edge.kind}-head"
        right = card.x + WIDTH
        target = self.cards.get(edge.target)
        level = target is not None and self.column[edge.target] == self.column[key]
        to = target.y + 14 if target else 0.0
        far = level and abs(to - y) > LONGEST_BOW
        if target is None or far or not self._near(key, edge):
            return [line(right, y, right + 9, y, kind), head(right + 17, y, shape, "right")]
        if level:
            return self._bow(right, y, to, key == edge.target, kind, shape)
        if self._is_back(key, edge):
            path = self._path((card.x, y), (target.x + WIDTH + 7, to), key, edge, top)
            return [f'<path class="{kind}" d="{path}"/>', head(target.x + WIDTH, to, shape, "left")]
        path = self._path((right, y), (target.x - 7, to), key, edge, top)
        return [f'<path class="{kind}" d="{path}"/>', head(target.x, to, shape, "right")]

    def _path(
        self, begin: tuple[float, float], end: tuple[float, float], key: str, edge: Edge, top: float
    ) -> str:
        """The path of a line through the columns between two cards."""
        chain = self.links[key, edge.target, edge.kind].chain[1:-1]
        middle = [top + self.layout.aside[place] + 4.5 for place in chain]
        low, high = sorted((self.column[key], self.column[edge.target]))
        through = [(self.left[one], self.left[one] + WIDTH) for one in range(low + 1, high)]
        if self._is_back(key, edge):
            middle, through = middle[::-1], [(off, near) for near, off in through[::-1]]
        (at, y), path = begin, f"M{begin[0]:.1f} {begin[1]:.1f}"
        for place, (near, off) in zip(middle, through, strict=True):
            path += _curve(at, y, near, place) + f"H{off:.1f}"
            at, y = off, place
        return path + _curve(at, y, *end)

    def _bow(
        self, right: float, y: float, to: float, own: bool, kind: str, shape: str
    ) -> list[str]:
        """A line back to the same column."""
        out = 16 if own else min(24 + abs(to - y) / 12, 58)
        path = f"M{right:.1f} {y:.1f}C{right + out:.1f} {y:.1f} {right + out:.1f} {to:.1f}"
        path += f" {right + 7:.1f} {to:.1f}"
        return [f'<path class="{kind}" d="{path}"/>', head(right, to, shape, "left")]


def _curve(x1: float, y1: float, x2: float, y2: float) -> str:
    """A curve that begins and ends horizontally."""
    middle = (x1 + x2) / 2
    return f"C{middle:.1f} {y1:.1f} {middle:.1f} {y2:.1f} {x2:.1f} {y2:.1f}"
