"""Whether a fact of a run is what a scenario expects."""

from __future__ import annotations

from collections.abc import Callable
from difflib import SequenceMatcher
from typing import Any

from prima.grammar.text import fold
from prima.interpreter.selection import takes
from prima.language.values import read_value, shown
from prima.messages import SERVICE
from prima.sim.expectations import Expectation
from prima.sim.triggers import fires, holds
from prima.testing.facts import Fact

MOST_COMPARED = 500
"""Texts compared to find the nearest one."""
LONGEST_COMPARED = 200
"""Characters of each text that are compared."""
ALIKE = 0.5
"""Similarity (0 to 1) above which a text is mentioned."""


def fits(one: Expectation, fact: Fact, whoever: bool = False, whatever: bool = False) -> bool:
    """Whether a fact is what is expected, by whichever application, or with whatever values."""
    record = fact.record
    if one.by and not whoever and record.app != one.by:
        return False
    if not all(MATCHES[name](word, fact) for name, word in one.words.items()):
        return False
    if whatever:
        return True
    if one.reason and not _reason(one.reason, record.outcome):
        return False
    held = values(fact) if one.data else {}
    return all(name in held and _same(text, held[name]) for name, text in one.data.items())


MATCHES: dict[str, Callable[[str, Fact], bool]] = {
    "says": lambda word, fact: fact.phase == "start" and holds(word, fact.said),
    "does": lambda word, fact: fact.phase == "start" and fact.record.command == word,
    "finishes": lambda word, fact: fires("done", word, fact.record, fact.said),
    "event": lambda word, fact: fires("on", word, fact.record, fact.said),
    "logs": lambda word, fact: fact.phase == "log" and fold(word) in fold(fact.record.message),
    "sends": lambda word, fact: (
        fact.phase == "send" and _to(word, str(fact.record.data.get("to") or ""))
    ),
    "ends": lambda word, fact: fact.phase == "unload" and fact.record.app == word,
}
"""Whether a fact is what each attribute of an expectation names."""


def _to(word: str, target: str) -> bool:
    """Whether a target is a service with this name, or a URI with this prefix."""
    return target in (word, SERVICE + word) or (":" in word and target.startswith(word))


def _reason(word: str, outcome: str) -> bool:
    """Whether an outcome is the reason, or an event of which the reason is a prefix."""
    name = outcome.partition(":")[0]
    return outcome == word or takes(word, name)


def values(fact: Fact) -> dict[str, Any]:
    """The arguments of a Command, or the values of an event or a message."""
    record, request = fact.record, fact.request
    if fact.phase in ("start", "end"):
        return {**request.args, **request.extra}
    data = dict(record.data)
    params = data.get("params")
    return params if isinstance(params, dict) else data


def _same(text: str, value: Any) -> bool:
    """Whether a value is the one written; times are in ms."""
    if isinstance(value, bool):
        return text == str(value).lower()
    if isinstance(value, int | float):
        for kind in ("number", "duration"):
            try:
                return abs(float(read_value(kind, text)) - value) < 1e-6
            except ValueError:
                continue
        return False
    return " ".join(text.split()) == " ".join(shown(value).split())


def text_of(fact: Fact, name: str) -> str:
    """The text that a fact says or logs."""
    return fact.said if name == "says" else str(fact.record.message)


def most_alike(word: str, name: str, facts: list[Fact]) -> Fact | None:
    """The fact with the text most similar to a text, if any holds it or is similar."""
    wanted = fold(word)[:LONGEST_COMPARED]
    phase = "start" if name == "says" else "log"
    held = [fact for fact in facts if fact.phase == phase and text_of(fact, name)]
    if holding := next((fact for fact in held if MATCHES[name](word, fact)), None):
        return holding
    best, found = ALIKE, None
    for fact in held[:MOST_COMPARED]:
        alike = SequenceMatcher(None, wanted, fold(text_of(fact, name))[:LONGEST_COMPARED]).ratio()
        if alike > best:
            best, found = alike, fact
    return found
