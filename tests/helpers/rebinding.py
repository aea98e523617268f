"""Puts another function in the place of one of the scheduler's, wherever that is called."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

import pytest

from prima import scheduler

MODULES = [
    importlib.import_module(f"prima.scheduler.{one.name}")
    for one in pkgutil.iter_modules(scheduler.__path__)
]


def rebind(
    patch: pytest.MonkeyPatch, where: ModuleType | type, name: str, what: Callable[..., Any] | Any
) -> None:
    """Replace an attribute; a function also in the modules that have imported it."""
    before = getattr(where, name)
    patch.setattr(where, name, what)
    if isinstance(where, ModuleType) and isinstance(before, FunctionType):
        for module in MODULES:
            if getattr(module, name, None) is before:
                patch.setattr(module, name, what)
