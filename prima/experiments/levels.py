"""Factors of an experiment: the value to vary, and its levels or distribution.

Levels are written as in ``prima sweep --vary touch=0s..20s/200ms``:

- ``a|b|c``: a list; an empty level takes the attribute, or an answer, away;
- ``0s..20s/200ms``: a range of times or numbers with its step;
- ``0s..20s``: anything between, drawn by seed;
- ``normal(5s,1s)`` and other distributions (:mod:`prima.language.distributions`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from prima.errors import UsageError, did_you_mean
from prima.language.distributions import MEASURED, RANGE, Distributions, Quantile, written
from prima.language.values import read_value
from prima.loading.applications import digest
from prima.script.surrogates import SURROGATE
from prima.sim.paths import ScenarioValue

Read = TypeVar("Read")

MOST_LEVELS = 100_000
"""Maximum number of levels of a factor."""
MOST_LETTERS = 10_000
"""Maximum number of characters of a level; far below what a cell of a table can be read with."""
SPLIT = re.compile(r"(?<!\\)\|")


@dataclass(frozen=True)
class Factor:
    """A value to vary: by levels one after the other, or by draws from a distribution."""

    path: str
    kind: str
    """The kind of its values; times are in seconds in a table."""
    levels: tuple[str, ...] = ()
    quantile: Quantile | None = None
    """The value (ms for times) below which a share of all values lies, if they are drawn."""
    file: str = ""
    """The SHA-256 of the file that they are drawn from, if any."""

    def drawn(self, share: float) -> str:
        """The quantile at a share, from 0 to 1."""
        if self.quantile is None:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        return written(self.kind, self.quantile(share))


def cell(kind: str, text: str) -> str | float | int | None:
    """A level as in a table: times in seconds, None if the value is absent."""
    if kind not in MEASURED:
        return text
    if not text:
        return None
    value = read_value(kind, text)
    assert isinstance(value, int | float)
    return value / 1000 if kind == "duration" else value


def read_factor(target: ScenarioValue, text: str, folder: str = "") -> Factor:
    """Read the levels of a value.

    Args:
        target: the value, of a scenario.
        text: its levels, as written.
        folder: the folder for files of values.

    Raises:
        UsageError: they are malformed, empty or out of range.
    """
    return _Levels(target, folder).read(text)


class _Levels:
    """Reads the levels of one factor."""

    def __init__(self, target: ScenarioValue, folder: str) -> None:
        self.target = target
        self.kind = target.kind
        bounds = target.attribute
        self.values = Distributions(
            self.kind, bounds.low if bounds else None, bounds.high if bounds else None, folder
        )

    def wrong(self, why: str) -> UsageError:
        return UsageError(f"{self.target.path}: {why}")

    def read(self, text: str) -> Factor:
        path, kind = self.target.path, self.kind
        if SURROGATE.search(text):  # bytes of the command line
            raise self.wrong("Its levels are not UTF-8. Write them anew.")
        pieces = [one.replace("\\|", "|") for one in SPLIT.split(text)]
        self.count(len(pieces))
        if kind not in MEASURED:
            if (longest := max(map(len, pieces))) > MOST_LETTERS:
                most = f"at most {MOST_LETTERS:,} can be run"
                raise self.wrong(f"A level has {longest:,} characters; {most}.")
            return Factor(path, kind, self.checked(pieces))
        if len(pieces) == 1 and (drawn := self.read_by(self.values.read, pieces[0].strip())):
            file = self.values.file
            return Factor(path, kind, (), drawn, digest(file) if file else "")
        levels: list[str] = []
        for piece in pieces:
            levels += self.several(piece.strip())
            self.count(len(levels))
        return Factor(path, kind, self.checked(levels))

    def count(self, levels: int) -> None:
        """Reject more levels than a factor may have."""
        if levels > MOST_LEVELS:
            raise self.wrong(f"It has {levels:,} levels; at most {MOST_LEVELS:,} can be run.")

    def checked(self, levels: Sequence[str]) -> tuple[str, ...]:
        """The levels, checked: no duplicates, one kind, empty only if the attribute is optional."""
        attribute = self.target.attribute
        seen: dict[float | str, str] = {}
        for level in levels:
            same: float | str = level
            if level or attribute is None:
                value = self.value(level)
                same = value if self.kind in MEASURED else level
            elif attribute.required:
                raise self.wrong(f"<{self.target.node.tag}> needs {attribute.name}.")
            if same in seen:
                as_well = "" if seen[same] == level else f', as "{seen[same]}"'
                raise self.wrong(f'The level "{level}" is there twice{as_well}.')
            seen[same] = level
        return tuple(levels)

    def value(self, text: str) -> float:
        """A number, or a time in ms; 0 for a text.

        Raises:
            UsageError: it does not have the factor's kind, or is out of range.
        """
        attribute = self.target.attribute
        try:
            read_value(self.kind, text)
        except ValueError as error:
            raise self.wrong(f'"{text}" {error}') from None
        if attribute and attribute.choices and text not in attribute.choices:
            hint = did_you_mean(text, attribute.choices) or f"Write {'|'.join(attribute.choices)}."
            raise self.wrong(f'There is no "{text}" here. {hint}')
        if self.kind not in MEASURED:
            return 0.0
        return self.read_by(self.values.value, text)

    def read_by(self, read: Callable[[str], Read], text: str) -> Read:
        """A text as a value, a difference or a distribution.

        Raises:
            UsageError: it is not one.
        """
        try:
            return read(text)
        except ValueError as error:
            raise self.wrong(str(error)) from None

    def several(self, piece: str) -> list[str]:
        """The levels of a range with a step, or one level."""
        match = RANGE.fullmatch(piece)
        if match is None:
            return [piece]
        if match["step"] is None:
            raise self.wrong(f'The range "{piece}" has no step: write {piece}/STEP.')
        low, high = (self.value(match[name].strip()) for name in ("low", "high"))
        step = self.read_by(self.values.difference, match["step"].strip())
        if step <= 0 or low > high:
            why = "its step is not above 0" if low <= high else "it ends before it begins"
            raise self.wrong(f'The range "{piece}" is empty: {why}.')
        count = math.floor(min((high - low) / step, 1e15) + 1e-9) + 1  # it may be infinite
        self.count(count)
        return [written(self.kind, low + step * index) for index in range(count)]
