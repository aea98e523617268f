"""Values with the same syntax in both forms of SRGS: repeats, weights, names, languages."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from prima.grammar.model import Alternatives, Part, PrefixIndex, Sequence
from prima.language.values import LANGUAGE, SHORT_NAME

LEAST = 1e-20
"""The value used for a weight of 0, which ranks after everything else."""
MOST_TIMES = 10**9
RESERVED = frozenset(["NULL", "VOID", "GARBAGE"])
MODES = ("voice", "dtmf")
_REPEAT = re.compile(r"([0-9]+)(?:(-)([0-9]+)?)?")
_DECIMAL = re.compile(r"[0-9]+(?:\.[0-9]*)?|\.[0-9]+")


class RepeatBounds(NamedTuple):
    """How often something is said; ``high`` None means unbounded."""

    low: int
    high: int | None


def repeat(text: str) -> RepeatBounds:
    """Read ``n``, ``n-m`` or ``n-`` (SRGS 2.5).

    Raises:
        ValueError: it has another form, or its end is before its beginning.
    """
    match = _REPEAT.fullmatch(text.strip())
    if match is None:
        raise ValueError(f'repeat "{text[:40]}" is not of the form 2, 0-1 or 1-.')
    low = min(int(match[1][:12]), MOST_TIMES)
    if not match[2]:
        return RepeatBounds(low, low)
    high = None if match[3] is None else min(int(match[3][:12]), MOST_TIMES)
    if high is not None and high < low:
        raise ValueError(f'repeat "{text[:40]}" ends before it begins.')
    return RepeatBounds(low, high)


def decimal(text: str, kind: str) -> float:
    """Read a weight: a number of 0 or more, without exponent (SRGS 2.4.1).

    Raises:
        ValueError: it is not such a number.
    """
    if _DECIMAL.fullmatch(text.strip()) is None or len(text) > 40:
        raise ValueError(f'{kind} "{text[:40]}" is not a number such as 0.5 or 3.')
    return float(text)


def probability(text: str) -> float:
    """Read a repeat probability (SRGS 2.5.1).

    Raises:
        ValueError: it is not a number from 0 to 1.
    """
    value = decimal(text, "repeat-prob")
    if value > 1:
        raise ValueError(f'repeat-prob "{text}" is more than 1.')
    return value


def cost(chance: float) -> float:
    """The cost of something with a given probability."""
    return -math.log(max(chance, LEAST))


def choice(parts: list[Part], weights: list[float | None]) -> Part:
    """Alternatives; weights are relative to the greatest, and 1 by default."""
    if len(parts) == 1:
        return parts[0]
    given = [1.0 if weight is None else weight for weight in weights]
    greatest = max(given, default=1.0)
    scale = greatest if greatest > 0 else 1.0
    costs = [0.0 if weight == greatest else cost(weight / scale) for weight in given]
    return Alternatives(parts, costs, PrefixIndex({}, [], list(range(len(parts)))))


def sequence(parts: list[Part]) -> Part:
    """A sequence, or its only part."""
    return parts[0] if len(parts) == 1 else Sequence(parts)


def name_problem(name: str) -> str:
    """The problem of a rule's name (SRGS 3.1; Appendix D: ConstrainedName), or nothing."""
    if name in RESERVED:
        return f'"{name}" is a special rule and cannot be defined.'
    if re.fullmatch(SHORT_NAME, name) is None:
        return f'"{name[:60]}" is not a valid rule name: letters, digits and "_", no digit first.'
    return ""


def is_language(text: str) -> bool:
    """Whether a text names a language (RFC 3066)."""
    return re.fullmatch(LANGUAGE, text) is not None
