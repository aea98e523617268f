"""Distributions as written in documents, and values drawn from them by seed.

``normal(5s,1s)``: mean and standard deviation; ``lognormal(5s,0.4)``: median and the standard
deviation of the logarithm; ``uniform(0s,20s)`` or ``0s..20s``; ``exponential(5s)``: mean;
``empirical(delays.csv)``: one value per line, or a column as ``delays.csv:seconds``.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from random import Random
from statistics import NormalDist

from prima.errors import counted, did_you_mean
from prima.language.values import LONGEST_MS, read_value

MEASURED = ("duration", "number", "integer")
"""Kinds that may be drawn."""
MOST_VALUES = 1_000_000
"""Maximum number of values in a distribution's file."""
MOST_BYTES = 100_000_000
"""Maximum size of such a file."""
RANGE = re.compile(r"(?P<low>.(?:(?!\.\.).)*)\.\.(?P<high>[^/]+)(?:/(?P<step>.+))?")
CALL = re.compile(r"(?P<name>[a-z]+)\((?P<arguments>.*)\)")
EDGE = 1e-9
"""How near shares come to 0 and 1."""

Quantile = Callable[[float], float]
"""The value (ms for times) below which a share, between 0 and 1, of all values lies."""


def share(seed: int, path: str) -> float:
    """A number from 0 to 1, determined by a seed and the path of the value to draw.

    Each path has its own stream: other draws do not change it.
    """
    return Random(f"{seed}/{path}").random()


def written(kind: str, value: float) -> str:
    """A number as an attribute has it; times are given in ms."""
    if kind == "duration":
        return f"{round(value)}ms"
    return str(round(value)) if kind == "integer" else f"{value:.6g}"


class Distributions:
    """Reads the distributions of one kind of values within bounds."""

    def __init__(
        self,
        kind: str,
        low: float | None = None,
        high: float | None = None,
        folder: str | None = "",
    ) -> None:
        """Set the kind and bounds.

        Args:
            kind: one of :data:`MEASURED`.
            low: the least value (ms for times); by default the kind's own.
            high: the greatest value (ms for times); by default the kind's own.
            folder: the folder of files of values; None if none may be named.
        """
        self.kind = kind
        self.folder = folder
        least, most = (0.0, float(LONGEST_MS)) if kind == "duration" else (-1e12, 1e12)
        self.low = least if low is None else float(low)
        self.high = most if high is None else float(high)
        self.file = b""
        """The content of the file of values that was read, if any."""

    def value(self, text: str) -> float:
        """A number, or a time in ms.

        Raises:
            ValueError: it is not of the kind, or out of range; the message is a sentence.
        """
        value = self.difference(text)
        if not self.low <= value <= self.high:
            low, high = written(self.kind, self.low), written(self.kind, self.high)
            raise ValueError(f'"{text}" is out of range: from {low} to {high}.')
        return value

    def difference(self, text: str) -> float:
        """A difference of two values, such as a step; it may be less than the least value.

        Raises:
            ValueError: it is not of the kind; the message is a sentence.
        """
        try:
            value = read_value(self.kind, text)
        except ValueError as error:
            raise ValueError(f'"{text}" {error}') from None
        assert isinstance(value, int | float)
        return float(value)

    def read(self, piece: str) -> Quantile | None:
        """The quantiles of a distribution, in ms for times, or None if the text is not one.

        They stay within the bounds.

        Raises:
            ValueError: it is malformed, unknown or out of range; the message is a sentence.
        """
        made = self._read(piece)
        if made is None:
            return None
        return lambda share: min(max(made(min(max(share, EDGE), 1 - EDGE)), self.low), self.high)

    def _read(self, piece: str) -> Quantile | None:
        match = RANGE.fullmatch(piece)
        if match is not None and match["step"] is None:
            return self._uniform([match["low"].strip(), match["high"].strip()])
        call = CALL.fullmatch(piece)
        if call is None:
            return None
        kinds = {
            "normal": self._normal,
            "lognormal": self._lognormal,
            "uniform": self._uniform,
            "exponential": self._exponential,
            "empirical": self._empirical,
        }
        if call["name"] not in kinds:
            there = [one for one in kinds if self.folder is not None or one != "empirical"]
            hint = did_you_mean(call["name"], there) or f"There are {', '.join(there)}."
            raise ValueError(f'There is no distribution "{call["name"]}". {hint}')
        return kinds[call["name"]]([one.strip() for one in call["arguments"].split(",")])

    def _arguments(self, name: str, given: list[str], *meanings: str) -> list[str]:
        if len(given) != len(meanings) or not all(given):
            raise ValueError(f"Write {name}({','.join(meanings)}).")
        return given

    def _spread(self, name: str, text: str) -> float:
        """A standard deviation of a distribution: above 0."""
        value = self.difference(text)
        if value <= 0:
            raise ValueError(f"The standard deviation of {name}(...) has to be above 0.")
        return value

    def _normal(self, given: list[str]) -> Quantile:
        mean, deviation = self._arguments("normal", given, "MEAN", "DEVIATION")
        made = NormalDist(self.value(mean), self._spread("normal", deviation))
        return made.inv_cdf

    def _lognormal(self, given: list[str]) -> Quantile:
        median, deviation = self._arguments("lognormal", given, "MEDIAN", "DEVIATION")
        middle = self.value(median)
        try:
            made = NormalDist(0.0, float(deviation))
            sound = math.isfinite(made.inv_cdf(0.5))
        except ValueError:
            sound = False
        if not sound:
            why = f'"{deviation}" is not the standard deviation of a logarithm.'
            raise ValueError(f'{why} Write a number above 0, as "0.4".')
        return lambda share: middle * math.exp(min(made.inv_cdf(share), 100.0))

    def _uniform(self, given: list[str]) -> Quantile:
        low, high = (self.value(one) for one in self._arguments("uniform", given, "LOW", "HIGH"))
        if low > high:
            raise ValueError("The range ends before it begins.")
        return lambda share: low + (high - low) * share

    def _exponential(self, given: list[str]) -> Quantile:
        mean = self.value(self._arguments("exponential", given, "MEAN")[0])
        return lambda share: -mean * math.log(1 - share)

    def _empirical(self, given: list[str]) -> Quantile:
        name, _, column = self._arguments("empirical", given, "FILE.csv")[0].partition(":")
        if self.folder is None:
            remedy = f"vary it: prima sweep --vary PATH=empirical({name})"
            raise ValueError(f"A document draws nothing from a file; {remedy}.")
        values = sorted(self._measured(name, *one) for one in self._cells(name, column))
        if not values:
            raise ValueError(f"{name} has no values.")
        return lambda share: values[int(share * len(values))]

    def _measured(self, name: str, line: int, text: str) -> float:
        try:
            return self.value(text)
        except ValueError as error:
            raise ValueError(f"{name}:{line}: {error}") from None

    def _cells(self, name: str, column: str) -> list[tuple[int, str]]:
        """The lines and texts of a column of a CSV file; without its name, of the first one.

        Bare numbers are seconds where times are wanted.
        """
        rows = self._rows(name)
        place, titled = _column(name, rows, column)
        texts = [(at, row[place].strip()) for at, row in rows[titled:] if place < len(row)]
        return [(at, self._with_unit(one)) for at, one in texts if one]

    def _with_unit(self, text: str) -> str:
        return f"{text}s" if self.kind == "duration" and re.fullmatch(r"[\d.]+", text) else text

    def _rows(self, name: str) -> list[tuple[int, list[str]]]:
        """The rows of a CSV file that are not empty, with their lines."""
        path = Path(self.folder or "") / name
        try:
            if path.exists() and not path.is_file():
                raise ValueError("it is not a file")
            with path.open("rb") as stream:
                self.file = data = stream.read(MOST_BYTES + 1)
            if len(data) > MOST_BYTES:
                raise ValueError(f"it is larger than {MOST_BYTES:,} bytes")
            reader = csv.reader(io.StringIO(data.decode("utf-8-sig"), newline=""))
            rows = [(reader.line_num, row) for row in islice(reader, MOST_VALUES + 2) if row]
        except UnicodeDecodeError:
            raise ValueError(f"{name} cannot be read: it is not UTF-8.") from None
        except (OSError, ValueError, csv.Error) as error:
            why = getattr(error, "strerror", None) or error
            raise ValueError(f"{name} cannot be read: {why}.") from None
        if len(rows) > MOST_VALUES:
            raise ValueError(f"{name} has more than {counted(MOST_VALUES, 'value')}.")
        return rows


def _column(name: str, rows: list[tuple[int, list[str]]], column: str) -> tuple[int, bool]:
    """Where a column is in the rows of a file, and whether the first row has titles.

    Raises:
        ValueError: there is no such column, or it is not clear where values end.
    """
    head = rows[0][1] if rows else []
    if any(";" in one for one in head):
        raise ValueError(f"{name}: its cells are separated by ';'; save it with ','.")
    if column and column not in head:
        hint = did_you_mean(column, head)
        raise ValueError(f'{name} has no column "{column}". {hint}'.rstrip())
    if column:
        return head.index(column), True
    titled = bool(head) and not re.match(r"[-+.\d]", head[0])
    wide = next((at for at, row in rows if len(row) > 1), 0)
    if wide and not titled:
        remedy = "write 1.5 for 1,5, or give the columns names in the first line"
        raise ValueError(f"{name}:{wide}: there are several cells; {remedy}.")
    return 0, titled
