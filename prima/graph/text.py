"""Pictures as text for other programs: DOT (Graphviz), Mermaid, and JSON."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from prima.graph.model import INWARD, Edge, Graph, GraphNode
from prima.graph.run import History, in_words
from prima.transcript import colours
from prima.transcript.colours import NOBODY

MEANS = re.compile(r"[^\w ,?!'/=]|_")
"""Characters that may be syntax in Mermaid, and are escaped."""
DATES = "YYYY-MM-DD HH:mm:ss.SSS"
DASHED = ("call", "back", "guess", "stay")
DOT_LINES = {
    "call": ", style=dashed",
    "back": ", style=dashed",
    "guess": ", style=dotted",
    "stay": ", style=dotted",
}


def lines(node: GraphNode) -> list[str]:
    """The lines of a node's text."""
    marks = [", ".join(node.marks)] if node.marks else []
    return [node.title, *marks, *node.notes]


def numbered(graph: Graph) -> dict[str, str]:
    """An identifier for each node, by its key."""
    return {key: f"n{index}" for index, key in enumerate(graph.nodes, 1)}


def ends(graph: Graph) -> list[Edge]:
    """Edges to targets outside the application, which need a node: one for each target."""
    found: dict[tuple[str, str], Edge] = {}
    for edge in graph.edges:
        if edge.kind not in INWARD:
            found.setdefault((edge.kind, edge.where), edge)
    return list(found.values())


def arrows(graph: Graph) -> Iterator[tuple[Edge, str, str]]:
    """The edges with the identifiers of the nodes where they begin and end."""
    number = numbered(graph)
    outside = {(edge.kind, edge.where): f"out{i}" for i, edge in enumerate(ends(graph), 1)}
    for edge in graph.edges:
        target = number[edge.target] if edge.target else outside[edge.kind, edge.where]
        yield edge, number[edge.source], target


# DOT --------------------------------------------------------------------------------------------


def quote(text: str) -> str:
    """A text quoted for DOT, with its line breaks."""
    text = text.replace("&", "&amp;").replace("\\", "\\\\").replace('"', '\\"')
    return '"' + text.replace("\n", "\\n") + '"'


def dot(graph: Graph) -> str:
    """A graph in DOT."""
    number = numbered(graph)
    made = [
        "digraph prima {",
        f"  graph [label={quote(graph.title)}, labelloc=t, rankdir={'LR' if graph.across else 'TB'}];",
        '  node [shape=box, style="rounded", fontname="sans-serif", fontsize=11];',
        '  edge [fontname="sans-serif", fontsize=9];',
    ]
    for index, (group, nodes) in enumerate(graph.groups().items(), 1):
        inside = [f"  {number[node.key]} [{_attributes(node)}];" for node in nodes]
        made += _cluster(index, group, inside) if group else inside
    if starts := _starts(graph):
        made.append('  start [shape=point, width=0.2, label=""];')
        made += [f"  start -> {number[key]};" for key in starts]
    for index, edge in enumerate(ends(graph), 1):
        shape = "doublecircle" if edge.kind == "exit" else "plaintext"
        made.append(f"  out{index} [shape={shape}, label={quote(_end(edge))}];")
    for edge, source, target in arrows(graph):
        label = quote("\n".join(_edge_lines(edge)))
        made.append(f"  {source} -> {target} [label={label}{DOT_LINES.get(edge.kind, '')}];")
    return "\n".join([*made, "}"]) + "\n"


def _cluster(index: int, group: str, inside: list[str]) -> list[str]:
    return [
        f"  subgraph cluster_{index} {{",
        f"    label={quote(f'stream {group}')}; style=dashed;",
        *(f"  {one}" for one in inside),
        "  }",
    ]


def _starts(graph: Graph) -> list[str]:
    return [key for key, node in graph.nodes.items() if node.start]


def _end(edge: Edge) -> str:
    return "end" if edge.kind == "exit" else edge.words


def _attributes(node: GraphNode) -> str:
    style = ["rounded"]
    more = ""
    if node.kind in ("any", "linked", "cancelled", "failed"):
        style.append("dashed")
    if node.kind in ("running", "done"):
        style.append("filled")
        more = f', fillcolor="{colours.fill(node.shade)}"'
    if not node.reached:
        more += ', color="gray60", fontcolor="gray60"'
    if node.start:
        more += ", penwidth=2"
    return f'label={quote(chr(10).join(lines(node)))}, style="{",".join(style)}"{more}'


def _edge_lines(edge: Edge) -> list[str]:
    words = {"call": ["calls"], "back": ["returns"], "guess": ["perhaps"]}.get(edge.kind, [])
    return [*words, *edge.labels]


def dot_streams(history: History) -> str:
    """The streams' history in DOT: a chain of pieces for each."""
    made = [
        "digraph prima {",
        f"  graph [label={quote(history.title)}, labelloc=t, rankdir=LR];",
        '  node [shape=box, style="filled", fontname="sans-serif", fontsize=11];',
    ]
    for index, stream in enumerate(history.streams, 1):
        shade = history.shades.get(stream.app, NOBODY)
        made += [f"  subgraph cluster_{index} {{", f"    label={quote(f'stream {stream.name}')};"]
        for number, span in enumerate(stream.pieces, 1):
            fill = {"runs": colours.fill(shade), "away": "gray85", "broken": "#ffcecb"}[span.kind]
            label = quote(f"{in_words(span)}\n{span.begin:.2f} to {span.end:.2f} s")
            made.append(f'    s{index}_{number} [label={label}, fillcolor="{fill}"];')
        chain = " -> ".join(f"s{index}_{number}" for number in range(1, len(stream.pieces) + 1))
        made += [f"    {chain};"] if chain else [f'    s{index}_0 [label="nothing of it ran"];']
        made.append("  }")
    return "\n".join([*made, "}"]) + "\n"


# Mermaid ----------------------------------------------------------------------------------------


def entity(text: str) -> str:
    """A text escaped for Mermaid."""
    return MEANS.sub(lambda match: f"#{ord(match[0])};", text)


def mermaid(graph: Graph) -> str:
    """A graph as a Mermaid flowchart."""
    number = numbered(graph)
    made = ["---", f"title: {json.dumps(graph.title)}", "---"]
    made.append(f"flowchart {'LR' if graph.across else 'TB'}")
    for index, (group, nodes) in enumerate(graph.groups().items(), 1):
        inside = [f"  {number[node.key]}{_shape(node)}" for node in nodes]
        if group:
            title = entity(f"stream {group}")
            inside = [f'  subgraph g{index}["{title}"]', *(f"  {one}" for one in inside), "  end"]
        made += inside
    if starts := _starts(graph):
        made.append('  start(("start"))')
        made += [f"  start --> {number[key]}" for key in starts]
    for index, edge in enumerate(ends(graph), 1):
        label = entity(_end(edge))
        shape = f'((("{label}")))' if edge.kind == "exit" else f'>"{label}"]'
        made.append(f"  out{index}{shape}")
    made += [_arrow(*one) for one in arrows(graph)]
    made += _classes(graph, number)
    return "\n".join(made) + "\n"


def _arrow(edge: Edge, source: str, target: str) -> str:
    label = "<br/>".join(map(entity, _edge_lines(edge)))
    arrow = "-.->" if edge.kind in DASHED else "-->"
    words = f'|"{label}"|' if label else ""
    return f"  {source} {arrow}{words} {target}"


def _shape(node: GraphNode) -> str:
    first, *rest = map(entity, lines(node))
    return f'["{"<br/>".join([f"<b>{first}</b>", *rest])}"]'


def _classes(graph: Graph, number: dict[str, str]) -> list[str]:
    """Styles: dimmed, dashed or filled."""
    held: dict[str, list[str]] = {}
    for key, node in graph.nodes.items():
        if not node.reached:
            held.setdefault("lost opacity:0.45", []).append(number[key])
        if node.kind in ("any", "linked", "cancelled", "failed"):
            held.setdefault("dashed stroke-dasharray:5 3", []).append(number[key])
        if node.kind in ("running", "done"):
            fill, stroke = colours.fill(node.shade), colours.stroke(node.shade)
            style = f"s{node.shade} fill:{fill},stroke:{stroke},color:#1f2328"
            held.setdefault(style, []).append(number[key])
    made = []
    for style, nodes in sorted(held.items()):
        name, _, rule = style.partition(" ")
        made += [f"  classDef {name} {rule}", f"  class {','.join(nodes)} {name}"]
    return made


def mermaid_streams(history: History) -> str:
    """The streams' history as a Mermaid Gantt chart, with times in seconds of the run."""
    made = [
        "gantt",
        f"  title {entity(history.title)}",
        f"  dateFormat {DATES}",
        "  axisFormat %H:%M:%S",
    ]
    for stream in history.streams:
        made.append(f"  section {entity(stream.name)}")
        for span in stream.pieces:
            mark = {"runs": "active", "away": "done", "broken": "crit"}[span.kind]
            begin, end = _date(span.begin), _date(max(span.end, span.begin + 0.001))
            made.append(f"  {entity(in_words(span))} :{mark}, {begin}, {end}")
    return "\n".join(made) + "\n"


def _date(seconds: float) -> str:
    """A time of the run as a time of day, the same in every time zone."""
    ms = round(seconds * 1000)
    clock = f"{ms // 3_600_000 % 24:02}:{ms // 60_000 % 60:02}:{ms // 1000 % 60:02}.{ms % 1000:03}"
    return f"2000-01-{1 + min(ms // 86_400_000, 30):02} {clock}"


# JSON -------------------------------------------------------------------------------------------


def data(graph: Graph) -> str:
    """A graph as JSON: ``nodes`` by their ``id``, and ``edges`` between them."""
    number = numbered(graph)
    nodes = [_node_data(number[key], node) for key, node in graph.nodes.items()]
    edges = [
        {
            "from": number[edge.source],
            "to": number.get(edge.target),
            "kind": edge.kind,
            **({"where": edge.where} if edge.where else {}),
            "labels": edge.labels,
        }
        for edge in graph.edges
    ]
    made = {"title": graph.title, "nodes": nodes, "edges": edges}
    return json.dumps(made, ensure_ascii=False, indent=2) + "\n"


def _node_data(name: str, node: GraphNode) -> dict[str, object]:
    return {
        "id": name,
        "name": node.title,
        "kind": node.kind,
        "start": node.start,
        "reached": node.reached,
        "marks": node.marks,
        "notes": node.notes,
        **({"stream": node.group} if node.group else {}),
        **({"source": node.source} if node.source else {}),
    }


def data_streams(history: History) -> str:
    """The streams' history as JSON; times in seconds."""
    made = {
        "title": history.title,
        "streams": [
            {
                "name": stream.name,
                "app": stream.app,
                "begin": stream.begin,
                "end": stream.end,
                "ended": stream.ended,
                "spans": [
                    {"kind": span.kind, "begin": span.begin, "end": span.end}
                    | ({"by": span.by} if span.by else {})
                    | ({"rule": span.rule} if span.rule else {})
                    for span in stream.pieces
                ],
            }
            for stream in history.streams
        ],
    }
    return json.dumps(made, ensure_ascii=False, indent=2) + "\n"
