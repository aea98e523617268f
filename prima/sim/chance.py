"""Chance in a scenario: random times, and whether something happens, drawn by the run's seed.

Each random value has a stream of its own, named by its place in the document, so that other
draws do not change it. The first, second ... number of a stream is for the first, second ...
time that the value is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from prima.devices.reading import Reader
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.language.distributions import Quantile

Made = TypeVar("Made")


def _share(seed: int, stream: str, number: int) -> float:
    """A number from 0 to 1; a sweep's own draws use other names."""
    from prima.language.distributions import share  # few scenarios need it

    return share(seed, f"run/{stream}/{number}")


@dataclass(frozen=True, slots=True)
class Amount:
    """A time (ms) or a number, fixed or drawn anew each time from a distribution."""

    value: float
    quantile: Quantile | None = None
    stream: str = ""

    def drawn(self, seed: int, number: int = 1) -> float:
        """The value for the use with this number, from 1."""
        if self.quantile is None:
            return self.value
        return self.quantile(_share(seed, self.stream, number))

    def ms(self, seed: int, number: int = 1) -> int:
        """The same in whole milliseconds."""
        return round(self.drawn(seed, number))


@dataclass(frozen=True, slots=True)
class Chance:
    """The probability, from 0 to 1, that something happens each time that it may."""

    likely: float = 1.0
    stream: str = ""

    def happens(self, seed: int, number: int) -> bool:
        """Whether it happens this time, from 1."""
        return self.likely >= 1 or _share(seed, self.stream, number) < self.likely


@dataclass(frozen=True, slots=True)
class ChoiceStream:
    """The stream by which one of several is chosen, with equal probability."""

    stream: str

    def of(self, several: Sequence[Made], seed: int, number: int) -> Made:
        """The choice for the use with this number, from 1."""
        return several[min(int(_share(seed, self.stream, number) * len(several)), len(several) - 1)]


class Draws:
    """Reads the random values of a document.

    Args:
        reader: the document's reader.
        whose: the prefix of its streams' names, which distinguishes them from another document's.
    """

    def __init__(self, reader: Reader, whose: str = "") -> None:
        self.reader = reader
        self.any = False
        """Whether anything is random."""
        self._whose = whose
        self._names: dict[int, str] = {}

    def amount(self, node: Node, name: str, default: float = 0) -> Amount:
        """An attribute that may be random; ``default`` if it is missing or invalid."""
        value = self.reader.get(node, name)
        if not callable(value):
            return Amount(default if value is None else value)
        return Amount(default, value, self._stream(node, name))

    def chance(self, node: Node) -> Chance:
        """The probability that an element happens."""
        likely = self.reader.get(node, "chance")
        if likely is None or likely >= 1:
            return Chance()
        return Chance(likely, self._stream(node, "chance"))

    def choice(self, node: Node) -> ChoiceStream:
        """The stream by which one of an element's children is chosen."""
        return ChoiceStream(self._stream(node, "one-of"))

    def _stream(self, node: Node, name: str) -> str:
        self.any = True
        return f"{self.name(node)}.{name}"

    def name(self, node: Node) -> str:
        """The prefix of the names of an element's streams."""
        if not self._names:
            self._name_all()
        return self._names[node.index]

    def _name_all(self) -> None:
        """Name elements by their ids, or as the first, second ... of their tag in their parent."""
        left = [(self.reader.root, self._whose)]
        while left:
            node, name = left.pop()
            self._names[node.index] = name
            seen: dict[str, int] = {}
            for child in node.nodes:
                seen[child.tag] = seen.get(child.tag, 0) + 1
                own = child.get("id") or f"{child.tag}[{seen[child.tag]}]"
                left.append((child, f"{name}.{own}" if name else own))
