"""Every rule of mediation for ``prima explain RULE``: its sentence, and a run that shows it.

The sentences are those of docs/mediation.md, which comes with the package; nothing repeats
them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from textwrap import wrap
from typing import Any

from prima import api
from prima.handbook.situations import EXAMPLES, RuleExample
from prima.loading.folders import shipped
from prima.report import strip
from prima.transcript.row import Row
from prima.transcript.run import Run
from prima.transcript.spans import base
from prima.transcript.table import format_rows

PAGE = "mediation.md"
"""The page of the documentation with the rules."""
HEADING = re.compile(r"^## (?P<title>.+)$")
RULE = re.compile(r"^- \*\*(?P<name>[A-Z]\d+)(?P<title>[^*]*)\*\* (?P<text>.+)$")
PART = re.compile(r"^  - \*\*(?P<name>[a-z])\*\* (?P<text>.+)$")
POLICY = re.compile(r"^\| `(?P<name>[a-z]+)`.* \| (?P<text>.+) \|$")
LINK = re.compile(r"\[([^\]]+)\]\([^)]+\)")
DECIDED = "*Decided.* "
AROUND = 3
"""Rows shown before and after the important one."""
LINE_END = "\n"
BEFORE, AFTER = 3.0, 7.0
"""Seconds shown in the picture before and after that row."""
WHOLE = 12.0
"""A run no longer than this (s) is shown whole."""


@dataclass(frozen=True, slots=True)
class MediationRule:
    """A rule: name, section of the page, text without markup, and summary."""

    name: str
    section: str
    text: str
    brief: str


@cache
def rules() -> dict[str, MediationRule]:
    """All rules by name, in the page's order; the baseline policies last."""
    found: dict[str, MediationRule] = {}
    section, last = "", ""
    for line in shipped(PAGE, "docs").read_text(encoding="utf-8").splitlines():
        if heading := HEADING.match(line):
            section = heading["title"]
        elif rule := RULE.match(line):
            last = rule["name"]
            found[last] = _rule(last, section, f"{rule['title']} {rule['text']}".strip())
        elif (part := PART.match(line)) and last:
            whole, name, text = found[last], last + part["name"], _plain(part["text"])
            ended = f"{whole.text.partition(LINE_END)[0]} {text.rstrip(';.')}."
            found[name] = MediationRule(name, section, ended, _brief(text))
            added = f"{whole.text}{LINE_END}{part['name']}: {text}"
            found[last] = MediationRule(last, whole.section, added, whole.brief)
        elif section == "Baseline policies" and (policy := POLICY.match(line)):
            text = _plain(policy["text"])
            text = f"{text[:1].upper()}{text[1:]}."
            found[policy["name"]] = MediationRule(policy["name"], section, text, _brief(text))
    return found


def _rule(name: str, section: str, text: str) -> MediationRule:
    """A rule of the page; its section says whether it is in the thesis."""
    own = _plain(text.removeprefix(DECIDED))
    section = f"{section}, decided" if text.startswith(DECIDED) else section
    return MediationRule(name, section, own, _brief(own))


def _brief(text: str) -> str:
    """The first sentence of a rule, for a list."""
    return text.partition(". ")[0].partition(" [")[0].rstrip(".:;")


def _plain(text: str) -> str:
    """A line of the page without markup."""
    return LINK.sub(r"\1", text).replace("**", "").replace("*", "").replace("`", "")


def named(word: str) -> str:
    """A rule's name as written on the page; empty if there is no such rule."""
    return next((name for name in rules() if name.lower() == word.lower()), "")


def suggestion(word: str) -> str:
    """A list of rules for a word that looks like a rule's name; otherwise empty."""
    if not re.fullmatch(r"[A-Za-z]\d+[a-z]?", word):
        return ""
    alike = [name for name in rules() if name[0] == word[0].upper() and name[1:2].isdigit()]
    return f"Rules with {word[0].upper()} are {', '.join(alike)}." if alike else ""


@dataclass(frozen=True, slots=True)
class Shown:
    """An example's run: the rows around the important one, its number, and a picture."""

    rows: list[Row]
    number: int
    picture: str


def run_of(name: str, columns: int = 80) -> Shown:
    """Run a rule's example, and find the row that shows the rule."""
    example = EXAMPLES[name]
    made = api.rehearse(api.documents_folder() / example.scenario, example.policy or None)
    rows = made.rows()
    number = _looked_at(name, example, rows, made.run())
    end = made.run().end
    time = rows[number].time
    span = (0.0, end) if end <= WHOLE else (max(time - BEFORE, 0.0), min(time + AFTER, end))
    picture = strip.draw(made.run(), rows, *span, columns)
    return Shown(rows[max(number - AROUND, 0) : number + AROUND + 1], number, picture)


def _looked_at(name: str, example: RuleExample, rows: list[Row], run: Run) -> int:
    """The number of the important row."""
    found = (row.number for row in rows if example.row in row.what)
    return next(found if example.row else _decided(name, rows, run))


def _decided(name: str, rows: list[Row], run: Run) -> Iterator[int]:
    """The rows that a rule selected, or that it held back before."""
    yield from (row.number for row in rows if row.rule == name)
    for entry in (one for one in run.entries if one.rule == name):
        behavior = base(entry.behavior or entry.winner)
        for row in rows:
            if base(row.behavior) == behavior and row.time >= entry.time:
                yield row.number


def commands(name: str) -> list[str]:
    """The commands that run a rule's example in this folder."""
    example = EXAMPLES[name]
    policy = f" --policy {example.policy}" if example.policy else ""
    folder, copied = "documents", f"documents/{example.scenario}"
    count = 1
    while Path(folder).exists() and not Path(copied).is_file():  # it is another folder
        count += 1
        folder = f"documents-{count}"
        copied = f"{folder}/{example.scenario}"
    run = f"prima run {copied}{policy} --why"
    return [run] if Path(copied).is_file() else [f"prima documents {folder}", run]


def shown(name: str, columns: int = 80) -> str:
    """A rule as text: its sentences, a picture, rows of the example, and the command to run it."""
    rule, run = rules()[name], run_of(name, columns)
    lines: list[str] = []
    for piece in f"{name} ({rule.section}): {rule.text}".split("\n"):
        lines += wrap(piece, columns, break_long_words=False, break_on_hyphens=False)
    look = wrap(f"Row {run.number}: {EXAMPLES[name].look}", columns)
    table = format_rows(run.rows, True, columns).rstrip("\n")
    tried = [f"    {one}" for one in commands(name)]
    return "\n".join([*lines, "", run.picture, "", *look, "", table, "", "Try it:", *tried])


def data(name: str) -> dict[str, Any]:
    """A rule as data for JSON."""
    rule, run, example = rules()[name], run_of(name), EXAMPLES[name]
    return {
        "rule": name,
        "section": rule.section,
        "text": rule.text,
        "example": {
            "scenario": example.scenario,
            "policy": example.policy or None,
            "row": run.number,
            "look": example.look,
            "picture": run.picture,
            "commands": commands(name),
        },
    }
