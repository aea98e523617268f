"""Every diagnosis by its code, wherever it is declared."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from prima.errors import Diagnosis

HOMES = ("prima.errors.diagnoses", "prima.interpreter.checks", "prima.voicexml.checks")
"""Packages whose modules declare diagnoses, shared or of one check."""


@cache
def diagnoses() -> dict[str, Diagnosis]:
    """All diagnoses, sorted by code."""
    found: dict[str, Diagnosis] = {}
    for one in _declared():
        found.setdefault(one.code, one)
    return dict(sorted(found.items()))


def _declared() -> Iterator[Diagnosis]:
    for home in HOMES:
        for module in iter_modules(import_module(home).__path__, f"{home}."):
            declared = vars(import_module(module.name)).values()
            yield from (one for one in declared if isinstance(one, Diagnosis))
