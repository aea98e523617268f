"""Tables as prima sweep writes them, made by hand."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from prima.experiments.levels import read_factor
from prima.experiments.table import Column, columns, dictionary, line
from prima.sim.paths import find
from prima.sim.scenario import look_at_scenario
from tests import ROOT

SCENARIO = ROOT / "documents" / "scenarios" / "touched-on-the-way.xml"
POLICIES = ("prima", "fifo")
ORDERS = ("aaaaaaaaaaaa", "bbbbbbbbbbbb", "cccccccccccc")


def known_columns() -> list[Column]:
    """The columns of a sweep over a time and an answer."""
    root = look_at_scenario(str(SCENARIO), SCENARIO.read_bytes())[0].node
    varied = {"when.at": "0s..9s/1s", "answer": "Yes.|No.|"}
    found = [(find(root, path, lambda: root), told) for path, told in varied.items()]
    return columns([read_factor(target, told, "") for target, told in found])


def cells(number: int) -> dict[str, Any]:
    """A run: it takes as long as the touch is late, and 10 s longer under fifo."""
    policy, at, answer = POLICIES[number // 30], number % 10, number // 10 % 3
    order = ORDERS[0] if policy == "prima" else ORDERS[1 + (at >= 8)]
    made: dict[str, Any] = dict.fromkeys((one.name for one in known_columns()), 0)
    reaction = 0.5 * answer if at else None
    return made | {
        "run": number, "scenario": "visit.xml", "policy": policy, "seed": 1, "when.at": float(at),
        "answer": ("Yes.", "No.", "")[answer], "exit": 0, "ended": "quiet", "failures": "",
        "order": order, "transcript": f"sweep/orders/{order}.jsonl",
        "seconds": 20.0 + at + 10 * (policy == "fifo"), "broken": int(policy == "fifo"),
        "reaction_mean": reaction, "reaction_max": reaction,
    }  # fmt: skip


def runs() -> list[dict[str, Any]]:
    """Sixty runs, all combinations once."""
    return [cells(number) for number in range(60)]


def write(folder: Path, made: Sequence[dict[str, Any]], name: str = "sweep.csv") -> Path:
    """Write a table, its dictionary, its plan, and a transcript of the first order."""
    told = known_columns()
    path, beside = folder / name, (folder / name).with_suffix("")
    heads = [one.name for one in told]
    heads += [one for one in dict.fromkeys(key for row in made for key in row) if one not in heads]
    lines = [line(heads), *(line([row.get(head) for head in heads]) for row in made)]
    path.write_text("".join(lines), encoding="utf-8", newline="")
    (beside / "orders").mkdir(parents=True, exist_ok=True)
    (beside / "dictionary.json").write_text(dictionary(name, told), encoding="utf-8")
    plan = {
        "prima": "1.0.0",
        "question": {"scenarios": ["visit.xml"], "design": "full", "seeds": 1},
        "runs": len(made),
        "files": ["0123456789abcdef"],
    }
    (beside / "plan.json").write_text(json.dumps(plan))
    (beside / "orders" / f"{ORDERS[0]}.jsonl").write_text("")
    return path


class Tables(HTMLParser):
    """The tables of a page, by their ids: the texts of their cells, row by row."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: dict[str, list[list[str]]] = {}
        self.links: list[str] = []
        self.tags: list[str] = []
        self.rows: list[list[str]] = []
        self.inside = False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        held = dict(attrs)
        self.tags.append(tag)
        if tag == "a":
            self.links.append(held.get("href") or "")
        if tag == "table":
            self.rows = self.found[held.get("id") or ""] = []
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("th", "td"):
            self.rows[-1].append("")
            self.inside = True

    def handle_endtag(self, tag: str) -> None:
        if tag in ("th", "td"):
            self.inside = False

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.rows[-1][-1] += data

    def by_name(self, name: str) -> Iterator[dict[str, str]]:
        """The rows of a table, by the heads of their columns."""
        head, *rows = self.found[name]
        for row in rows:
            yield dict(zip(head, row, strict=True))
