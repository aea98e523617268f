"""Factors of an experiment: what is varied, and its levels or distribution.

Levels are written as in ``prima sweep --vary touch=0s..20s/200ms``:

- ``a|b|c``: a list; an empty level takes the attribute, or an answer, away;
- ``0s..20s/200ms``: a range of times or numbers with its step;
- ``0s..20s``: anything between, drawn by seed;
- ``normal(5s,1s)``: mean and standard deviation; ``lognormal(5s,0.4)``: median and the standard
  deviation of the logarithm; ``uniform(0s,20s)``; ``exponential(5s)``: mean;
  ``empirical(delays.csv)``: a value a line, or a column as ``delays.csv:seconds``.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from statistics import NormalDist

from prima.errors import UsageError, counted, did_you_mean
from prima.language.values import LONGEST_MS, read_value
from prima.sim.paths import Target

MEASURED = ("duration", "number", "integer")
"""Kinds whose levels may be ranges and distributions."""
MOST_LEVELS = 100_000
MOST_VALUES = 1_000_000
"""Values that a distribution's file may have."""
RANGE = re.compile(r"(?P<low>.+?)\.\.(?P<high>[^/]+)(?:/(?P<step>.+))?")
CALL = re.compile(r"(?P<name>[a-z]+)\((?P<arguments>.*)\)")
SPLIT = re.compile(r"(?<!\\)\|")
EDGE = 1e-9
"""How near quantiles come to 0 and 1."""

Quantile = Callable[[float], float]


@dataclass(frozen=True)
class Factor:
    """What is varied: levels one after the other, or values drawn from a distribution."""

    path: str
    kind: str
    """The kind of its values; times are in seconds in a table."""
    levels: tuple[str, ...] = ()
    quantile: Quantile | None = None
    """The value (ms for times) below which a share of all values lies, if they are drawn."""
    low: float = -math.inf
    high: float = math.inf

    def drawn(self, share: float) -> str:
        """The value at a share, from 0 to 1, of all values."""
        if self.quantile is None:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        value = self.quantile(min(max(share, EDGE), 1 - EDGE))
        return written(self.kind, min(max(value, self.low), self.high))


def written(kind: str, value: float) -> str:
    """A number as an attribute has it; times are given in ms."""
    if kind == "duration":
        return f"{round(value)}ms"
    return str(round(value)) if kind == "integer" else f"{value:.6g}"


def cell(kind: str, text: str) -> str | float | int | None:
    """A level as a table has it: times in seconds, None where nothing is written."""
    if kind not in MEASURED:
        return text
    if not text:
        return None
    value = read_value(kind, text)
    assert isinstance(value, int | float)
    return value / 1000 if kind == "duration" else value


def read_factor(target: Target, text: str, folder: str = "") -> Factor:
    """Read the levels of a value.

    Args:
        target: the value, of a scenario.
        text: its levels, as written.
        folder: where files of values are.

    Raises:
        UsageError: they are malformed, or none, or out of range.
    """
    return _Levels(target, folder).read(text)


class _Levels:
    """Reads the levels of one factor."""

    def __init__(self, target: Target, folder: str) -> None:
        self.target = target
        self.kind = target.kind
        self.folder = folder
        bounds = target.attribute
        low = bounds.low if bounds else None
        high = bounds.high if bounds else None
        least, most = (0.0, float(LONGEST_MS)) if self.kind == "duration" else (-1e12, 1e12)
        self.low = least if low is None else float(low)
        self.high = most if high is None else float(high)

    def wrong(self, why: str) -> UsageError:
        return UsageError(f"{self.target.path}: {why}")

    def read(self, text: str) -> Factor:
        path, kind = self.target.path, self.kind
        pieces = [one.replace("\\|", "|") for one in SPLIT.split(text)]
        if kind not in MEASURED:
            return Factor(path, kind, self.checked(pieces))
        if len(pieces) == 1 and (drawn := self.distribution(pieces[0].strip())):
            return Factor(path, kind, (), drawn, self.low, self.high)
        levels: list[str] = []
        for piece in pieces:
            levels += self.several(piece.strip())
        return Factor(path, kind, self.checked(levels))

    def checked(self, levels: Sequence[str]) -> tuple[str, ...]:
        """Levels of which none is twice, none is of another kind, and none is left out in vain."""
        attribute = self.target.attribute
        for level in levels:
            if level or attribute is None:
                self.value(level)
            elif attribute.required:
                raise self.wrong(f"<{self.target.node.tag}> needs {attribute.name}.")
        if len(set(levels)) < len(levels):
            twice = next(one for one in levels if levels.count(one) > 1)
            raise self.wrong(f'The level "{twice}" is there twice.')
        return tuple(levels)

    def value(self, text: str) -> float:
        """A number, or a time in ms; 0 for a text.

        Raises:
            UsageError: it is not of the factor's kind, or out of range.
        """
        attribute = self.target.attribute
        try:
            value = read_value(self.kind, text)
        except ValueError as error:
            raise self.wrong(f'"{text}" {error}') from None
        if attribute and attribute.choices and text not in attribute.choices:
            hint = did_you_mean(text, attribute.choices) or f"Write {'|'.join(attribute.choices)}."
            raise self.wrong(f'There is no "{text}" here. {hint}')
        if self.kind not in MEASURED:
            return 0.0
        assert isinstance(value, int | float)
        if not self.low <= value <= self.high:
            low, high = written(self.kind, self.low), written(self.kind, self.high)
            raise self.wrong(f'"{text}" is out of range: from {low} to {high}.')
        return float(value)

    def several(self, piece: str) -> list[str]:
        """The levels of a range with a step, or one level."""
        match = RANGE.fullmatch(piece)
        if match is None:
            return [piece]
        if match["step"] is None:
            raise self.wrong(f'The range "{piece}" has no step: write {piece}/STEP.')
        low, high, step = (self.value(match[name].strip()) for name in ("low", "high", "step"))
        if step <= 0 or low > high:
            why = "its step is not above 0" if low <= high else "it ends before it begins"
            raise self.wrong(f'The range "{piece}" is empty: {why}.')
        count = math.floor((high - low) / step + 1e-9) + 1
        if count > MOST_LEVELS:
            raise self.wrong(f"The range has {count:,} levels; at most {MOST_LEVELS:,} can be run.")
        return [written(self.kind, low + step * index) for index in range(count)]

    def distribution(self, piece: str) -> Quantile | None:
        """The quantiles of a distribution, if it is one."""
        match = RANGE.fullmatch(piece)
        if match is not None and match["step"] is None:
            return self.uniform([match["low"].strip(), match["high"].strip()])
        call = CALL.fullmatch(piece)
        if call is None:
            return None
        kinds = {
            "normal": self.normal,
            "lognormal": self.lognormal,
            "uniform": self.uniform,
            "exponential": self.exponential,
            "empirical": self.empirical,
        }
        if call["name"] not in kinds:
            hint = did_you_mean(call["name"], kinds) or f"There are {', '.join(kinds)}."
            raise self.wrong(f'There is no distribution "{call["name"]}". {hint}')
        return kinds[call["name"]]([one.strip() for one in call["arguments"].split(",")])

    def arguments(self, name: str, given: list[str], *meanings: str) -> list[str]:
        if len(given) != len(meanings) or not all(given):
            raise self.wrong(f"Write {name}({','.join(meanings)}).")
        return given

    def spread(self, name: str, text: str) -> float:
        """A standard deviation of a distribution: above 0."""
        value = self.value(text)
        if value <= 0:
            raise self.wrong(f"The standard deviation of {name}(...) has to be above 0.")
        return value

    def normal(self, given: list[str]) -> Quantile:
        mean, deviation = self.arguments("normal", given, "MEAN", "DEVIATION")
        made = NormalDist(self.value(mean), self.spread("normal", deviation))
        return made.inv_cdf

    def lognormal(self, given: list[str]) -> Quantile:
        median, deviation = self.arguments("lognormal", given, "MEDIAN", "DEVIATION")
        middle = self.value(median)
        try:
            made = NormalDist(0.0, float(deviation))
            made.inv_cdf(0.5)
        except ValueError:
            raise self.wrong(
                f'"{deviation}" is not the standard deviation of a logarithm.'
            ) from None
        return lambda share: middle * math.exp(min(made.inv_cdf(share), 100.0))

    def uniform(self, given: list[str]) -> Quantile:
        low, high = (self.value(one) for one in self.arguments("uniform", given, "LOW", "HIGH"))
        if low > high:
            raise self.wrong("The range ends before it begins.")
        return lambda share: low + (high - low) * share

    def exponential(self, given: list[str]) -> Quantile:
        mean = self.value(self.arguments("exponential", given, "MEAN")[0])
        return lambda share: -mean * math.log(1 - share)

    def empirical(self, given: list[str]) -> Quantile:
        name, _, column = self.arguments("empirical", given, "FILE.csv")[0].partition(":")
        values = sorted(self.value(one) for one in self.cells(name, column))
        if not values:
            raise self.wrong(f"{name} has no values.")
        return lambda share: values[int(share * len(values))]

    def cells(self, name: str, column: str) -> list[str]:
        """The texts of a column of a CSV file; without its name, of the first one.

        Bare numbers are seconds where times are wanted.
        """
        try:
            with (Path(self.folder) / name).open(encoding="utf-8-sig", newline="") as stream:
                lines = [row for row in islice(csv.reader(stream), MOST_VALUES + 2) if row]
        except (OSError, ValueError, csv.Error) as error:
            why = getattr(error, "strerror", None) or error
            raise self.wrong(f"{name} cannot be read: {why}.") from None
        if len(lines) > MOST_VALUES:
            raise self.wrong(f"{name} has more than {counted(MOST_VALUES, 'value')}.")
        place = 0
        if column:
            if not lines or column not in lines[0]:
                raise self.wrong(f'{name} has no column "{column}".')
            place = lines[0].index(column)
        if column or (lines and not re.match(r"[-+.\d]", lines[0][0])):
            lines = lines[1:]
        unit = "s" if self.kind == "duration" else ""
        texts = [row[place].strip() for row in lines if place < len(row)]
        return [f"{one}{unit}" if re.fullmatch(r"[\d.]+", one) else one for one in texts if one]
