"""Limits on documents, which users may raise, and the errors for exceeding them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prima.errors import MOST_TOLD, DocumentError, Place


@dataclass(slots=True)
class Limits:
    """Limits on one document. A document that exceeds one is refused."""

    bytes: int = 2_000_000
    elements: int = 200_000
    attributes: int = 64
    """Of one element."""
    depth: int = 100
    """Maximum nesting of elements."""
    problems: int = MOST_TOLD
    """Number of problems listed; the others are counted. No document is refused for it."""


HIGHEST = Limits(1_000_000_000, 20_000_000, 10_000, 200, 20_000_000)
"""How far the limits can be raised, within the capacity of the machine."""
LIMITS = Limits()
"""The limits of this process."""


def set_limits(numbers: Mapping[str, int]) -> None:
    """Set limits of this process, by name."""
    for name, number in numbers.items():
        setattr(LIMITS, name, number)


def too_large(file: str, size: int) -> DocumentError:
    """The error for a file of too many bytes, which is not read."""
    message = f"The file has {size:,} bytes; at most {LIMITS.bytes:,} are read."
    remedy = f"Divide it, or raise the limit: --limit bytes={size}."
    return DocumentError.of(Place(file), "too-large", message, remedy)


def too_deep(place: Place) -> DocumentError:
    """The error for elements that are nested too deep."""
    message = f"Elements are nested more than {LIMITS.depth} deep."
    return DocumentError.of(place, "too-deep", message, "Divide the document into smaller parts.")
