"""The picture of Atomic Behaviors: each stream a frame, its tree from top to bottom."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from itertools import accumulate

from prima.digraphs import led_to
from prima.graph.layout import THREAD, LayoutEdge, arrange, depths
from prima.graph.model import Graph, GraphNode
from prima.graph.svg import box, fit, head, measure, picture, text, wrap

WIDTH, PAD = 190.0, 8.0
GAP, STEP = 16.0, 26.0
MARGIN = 18.0
PAGE = 1240.0
"""Width of a row of streams before the next row begins."""
Drawn = tuple[list[str], float, float]
"""The parts of a drawing, its width and its height."""
KINDS = (
    ("running", "runs or has run"),
    ("waiting", "waits"),
    ("linked", "dashed: linked, or given up"),
)


def draw(graph: Graph) -> str:
    """The trees as SVG."""
    groups = graph.groups()
    frames = (_frame(graph, name, nodes) for name, nodes in groups.items())
    parts, wide, y = _in_rows(frames, MARGIN, MARGIN + 30, 18)
    wide, y = max(wide, 420.0), y + 26
    if not groups:
        parts.append(text(MARGIN, y, "Nothing is in working memory."))
    else:
        drawn, right = _legend(y)
        parts, wide = parts + drawn, max(wide, right)
    top = text(MARGIN, MARGIN + 8, fit(graph.title, wide - 2 * MARGIN, 13, True), "name")
    return picture(graph.title, graph.description, wide, y + MARGIN, [top, *parts])


def _legend(y: float) -> tuple[list[str], float]:
    """A legend for the boxes' fillings, and its right edge."""
    parts, x = [], MARGIN
    for kind, words in KINDS:
        parts += [box(x, y - 10, 20, 12, f"s1 {kind}", 3), text(x + 26, y, words, "small")]
        x += 44 + measure(words, 10)
    return parts, x


def _in_rows(pieces: Iterable[Drawn], margin: float, top: float, gap: float) -> Drawn:
    """Pieces side by side, in rows as wide as the page; their right and bottom edges."""
    parts: list[str] = []
    x, y, low, wide = margin, top, 0.0, 0.0
    for drawn, width, height in pieces:
        if x > margin and x + width > PAGE:
            x, y, low = margin, y + low + gap, 0.0
        parts += [f'<g transform="translate({x:.1f} {y:.1f})">', *drawn, "</g>"]
        wide = max(wide, x + width + margin)
        x, low = x + width + gap, max(low, height)
    return parts, wide, y + low


def _frame(graph: Graph, name: str, nodes: list[GraphNode]) -> Drawn:
    """A stream: its trees side by side, in rows; its width and its height."""
    title = f"stream {name}" if name else "no stream"
    trees = (_tree(graph, tree) for tree in _trees(graph, nodes))
    parts, wide, bottom = _in_rows(trees, 10.0, 30.0, GAP)
    wide, height = max(wide, min(measure(title, 13, True) + 20, 400.0)), bottom + 10
    frame = box(0, 0, wide, height, "frame", 8)
    top = text(10, 19, fit(title, wide - 20, 13, True), "name")
    return [frame, top, *parts], wide, height


def _trees(graph: Graph, nodes: list[GraphNode]) -> list[list[GraphNode]]:
    """The nodes of a stream, divided into those that are linked with each other."""
    held = {node.key for node in nodes}
    near: dict[str, list[str]] = {node.key: [] for node in nodes}
    for key in near:
        for edge in graph.out(key):
            if edge.target in held:
                near[key].append(edge.target)
                near[edge.target].append(key)
    trees: dict[str, list[GraphNode]] = {}
    root: dict[str, str] = {}
    for node in nodes:
        if node.key not in root:
            root |= dict.fromkeys(led_to([node.key], near.__getitem__), node.key)
        trees.setdefault(root[node.key], []).append(node)
    return list(trees.values())


def _tree(graph: Graph, nodes: list[GraphNode]) -> Drawn:
    """ABs that are linked with each other: the parts, the width and the height."""
    number = {node.key: index for index, node in enumerate(nodes)}
    kinds = {
        (number[node.key], number[edge.target]): edge.kind
        for node in nodes
        for edge in graph.out(node.key)
        if edge.target in number
    }
    words = [_lines(node) for node in nodes]
    layers = depths(len(nodes), list(kinds))
    links = [
        LayoutEdge(low, high, WIDTH / 2, WIDTH / 2)
        for low, high in kinds
        if layers[low] < layers[high]
    ]
    layout = arrange([WIDTH] * len(nodes), layers, links, GAP)
    heights = [0.0] * (max(layers) + 1)
    for layer, lines in zip(layers, words, strict=True):
        heights[layer] = max(heights[layer], _height(lines) + STEP)
    tops = list(accumulate(heights, initial=0.0))
    parts: list[str] = []
    for index, node in enumerate(nodes):
        parts += _box(node, words[index], layout.aside[index], tops[layers[index]])
    for link in links:
        down = tops[layers[link.low]] + _height(words[link.low])
        stops = tops[layers[link.low] + 1 : layers[link.high] + 1]
        parts += _line(link, kinds[link.low, link.high], layout.aside, down, stops)
    return parts, layout.extent, tops[-1] - STEP


def _line(
    link: LayoutEdge, kind: str, aside: list[float], down: float, stops: list[float]
) -> list[str]:
    """A line from the foot of an AB, through the layers between, to the top of another."""
    at = aside[link.low] + WIDTH / 2
    path = f"M{at:.1f} {down:.1f}"
    for place, top in zip(link.chain[1:], stops, strict=True):
        last = place == link.high
        to = aside[place] + (WIDTH / 2 if last else THREAD / 2)
        begin, end = top - STEP, top - (7 if last else 0)
        middle = (begin + end) / 2
        path += f"V{begin:.1f}C{at:.1f} {middle:.1f} {to:.1f} {middle:.1f} {to:.1f} {end:.1f}"
        at = to
    shape = "head" if kind == "child" else f"{kind}-head"
    return [f'<path class="edge {kind}" d="{path}"/>', head(at, stops[-1], shape, "down")]


def _lines(node: GraphNode) -> list[str]:
    inner = WIDTH - 2 * PAD
    lines = wrap(node.notes[0], inner, 3)
    lines += [fit(note, inner, 10) for note in node.notes[1:]]
    marks = ", ".join(node.marks)
    return [*lines, *(wrap(marks, inner, 2, 10) if marks else [])]


def _height(lines: list[str]) -> float:
    return 24 + 15 * len(lines) + 4


def _box(node: GraphNode, lines: list[str], x: float, y: float) -> list[str]:
    """An AB."""
    kind = {"done": "", "running": ""}.get(node.kind, node.kind)
    parts = [
        f"<g><title>{escape(f'{node.title}, {node.kind}, {node.source}')}</title>",
        box(x, y, WIDTH, _height(lines), f"s{node.shade} {kind}".strip()),
        text(x + PAD, y + 17, fit(node.title, WIDTH - 2 * PAD, 11.5, True), "to"),
    ]
    said = len(wrap(node.notes[0], WIDTH - 2 * PAD, 3))
    for number, one in enumerate(lines):
        parts.append(text(x + PAD, y + 32 + 15 * number, one, "" if number < said else "small"))
    return [*parts, "</g>"]
