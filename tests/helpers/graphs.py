"""Applications as graphs, and how a test reads them."""

from __future__ import annotations

import random
from functools import lru_cache
from pathlib import Path

import pydot

from prima import api
from prima.graph import states
from prima.graph.model import Graph, GraphNode
from tests import ROOT
from tests.helpers import command

SVG = "{http://www.w3.org/2000/svg}"


def app(body: str, more: str = "") -> str:
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app" xml:lang="en">'
        f"{body}{more}</prima>"
    )


def vxml(body: str, more: str = "") -> str:
    return f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en" {more}>{body}</vxml>'


def drawn(folder: Path, body: str, name: str = "app.xml") -> Graph:
    path = folder / name
    path.write_text(body, encoding="utf-8")
    return states(path)


def ways(graph: Graph, title: str) -> dict[str, list[str]]:
    """Where a state leads, with the reasons."""
    node = named(graph, title)
    return {
        (graph.nodes[e.target].title if e.target else e.words)
        + (
            ""
            if e.kind in ("go", "exit", "return", "computed", "outside", "missing")
            else f" {e.kind}"
        ): e.labels
        for e in graph.out(node.key)
    }


def named(graph: Graph, title: str) -> GraphNode:
    [node] = [node for node in graph.nodes.values() if node.title == title]
    return node


def read_dot(made: str) -> pydot.Dot:
    """DOT as another program reads it."""
    [graph] = pydot.graph_from_dot_data(made) or []
    return graph


@lru_cache
def transcript(scenario: str, policy: str = "prima") -> api.Transcript:
    return api.rehearse(ROOT / "documents" / scenario, policy)


# The picture ---------------------------------------------------------------------------------
def generated(count: int, seed: int) -> str:
    """An application of many states that lead here and there."""
    chance = random.Random(seed)
    forms = []
    for number in range(count):
        to = [chance.randrange(count), chance.randrange(count), (number + 1) % count]
        forms.append(
            f'<form id="state-{number}"><field name="more" type="boolean"><prompt>Is this number'
            f' {number}, or do you want to hear more?</prompt><filled><if cond="more">'
            f'<goto next="#state-{to[0]}"/><else/><goto next="#state-{to[1]}"/></if></filled></field>'
            f'<on event="touch.{number}"><goto next="#state-{to[2]}"/></on></form>'
        )
    return app("".join(forms))


FLOW = [
    r"---", r'title: "[^\n]*"', r"flowchart (LR|TB)",
    r'n\d+\["[^"]*"\]', r'start\(\("start"\)\)', r'out\d+(\(\(\("[^"]*"\)\)\)|>"[^"]*"\])',
    r'(n\d+|start) (-->|-\.->)(\|"[^"]*"\|)? (n|out)\d+',
    r'subgraph g\d+\["[^"]*"\]', r"end",
    r"classDef \w+ [\w:.#, -]+", r"class n\d+(,n\d+)* \w+",
]  # fmt: skip


# The command --------------------------------------------------------------------------------
def prima(folder: Path, *words: str) -> tuple[int, str, str]:
    done = command.prima("graph", *words, cwd=folder)
    return done.returncode, done.stdout, done.stderr
