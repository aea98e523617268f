"""A wrong and a right example for every code of a problem, for ``prima explain CODE``.

Each code has a folder with ``wrong.*`` and ``right.*``; files that they name are beside the
folders. A test reads every one: the wrong one has exactly the problem of its code.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from prima.checks.codes import diagnoses
from prima.errors import DocumentError, Problem, UsageError, did_you_mean
from prima.markup.limits import LIMITS

FOLDER = Path(__file__).parent
LOWERED = {"too-large": ("elements", 4), "too-deep": ("depth", 5), "more-problems": ("problems", 1)}
"""Lower limits for the examples of some codes, so that they can be short."""
BY_HAND = {
    "language": "load(..., languages=...) does not take it",
    "not-fetched": "load(...) is given no fetch",
}
"""Codes that occur only with :func:`prima.grammar.load`, with the condition."""


@dataclass(frozen=True, slots=True)
class Example:
    """A document: file name, text and problems."""

    name: str
    text: str
    problems: list[Problem]


def examples(code: str) -> tuple[Example, Example]:
    """Read and check the wrong and the right example for a code.

    Raises:
        UsageError: there is no such code.
    """
    if code not in diagnoses():
        hint = did_you_mean(code, diagnoses()) or "prima explain lists them."
        raise UsageError(f'There is no code "{code}". {hint}')
    return _example(code, "wrong"), _example(code, "right")


def _example(code: str, which: str) -> Example:
    path = next((FOLDER / code).glob(f"{which}.*"))
    problems = [
        _named(problem)
        for problem in _problems(code, path)
        if problem.severity != "note" or problem.code == code
    ]
    return Example(path.name, path.read_text(encoding="utf-8"), problems)


def _named(problem: Problem) -> Problem:
    """A problem with its file's path relative to the package's folder."""
    name = Path(problem.place.file).name
    return problem._replace(place=problem.place._replace(file=name))


def _problems(code: str, path: Path) -> list[Problem]:
    if code in BY_HAND:
        return _loaded(path)
    from prima import api

    limit, number = LOWERED.get(code, ("depth", LIMITS.depth))
    before = getattr(LIMITS, limit)
    setattr(LIMITS, limit, number)
    try:
        return api.validate([path])
    finally:
        setattr(LIMITS, limit, before)


def _loaded(path: Path) -> list[Problem]:
    """The problems of a grammar read alone, for English only."""
    from prima.grammar import load

    try:
        load(path.read_bytes(), base=path.name, languages=lambda tag: tag.startswith("en"))
    except DocumentError as error:
        return error.problems
    return []


def shown(code: str) -> str:
    """A code's explanation with its wrong and its right example, as text.

    Raises:
        UsageError: there is no such code.
    """
    wrong, right = examples(code)
    parts = [meaning(code)]
    for name, text in beside(code).items():
        parts += [f"{name}:", _indented(text)]
    parts += [headline(code, "Wrong"), _indented(wrong.text), problems_of(wrong)]
    return "\n\n".join([*parts, headline(code, "Right"), _indented(right.text)])


def meaning(code: str) -> str:
    """The meaning of a code, with its rule or section."""
    one = diagnoses()[code]
    return (
        f"{one.meaning} ({one.rule})" if one.rule and one.rule not in one.meaning else one.meaning
    )


def data(code: str) -> dict[str, Any]:
    """A code's explanation and examples as data for JSON.

    Raises:
        UsageError: there is no such code.
    """
    from prima.errors.rendering import problem_data

    wrong, right = examples(code)
    return {
        "code": code,
        "title": diagnoses()[code].title,
        "explanation": diagnoses()[code].meaning,
        "rule": diagnoses()[code].rule,
        "wrong": {"name": wrong.name, "text": wrong.text},
        "problems": [problem_data(problem) for problem in wrong.problems],
        "right": {"name": right.name, "text": right.text},
        "beside": beside(code),
    }


def beside(code: str) -> dict[str, str]:
    """The other files of a code's folder, by name, to which its examples refer."""
    return {
        path.name: path.read_text(encoding="utf-8")
        for path in sorted((FOLDER / code).iterdir())
        if path.stem not in ("wrong", "right")
    }


def headline(code: str, word: str) -> str:
    """A note above an example that is read in an unusual way."""
    if code in LOWERED:
        limit, number = LOWERED[code]
        return f"{word}, with --limit {limit}={number}:"
    return f"{word}, where {BY_HAND[code]}:" if code in BY_HAND else f"{word}:"


def problems_of(example: Example) -> str:
    """The problems of an example as ``prima validate`` prints them."""
    from prima.errors.rendering import render

    def lines(name: str) -> list[str]:
        path = FOLDER / name
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        return (example.text if name == example.name else text).split("\n")

    return "\n".join(render(problem, lines) for problem in example.problems)


def _indented(text: str) -> str:
    return "\n".join(f"    {line}" if line else "" for line in text.splitlines())
