"""Speech and key grammars: SRGS 1.0 in both forms, their meaning (SISR 1.0), built-in types.

The interface is loaded on first use: most applications have few grammars, or none.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    from prima.grammar.errors import (
        GrammarError,
        UnsupportedBuiltIn,
        UnsupportedFormat,
        UnsupportedLanguage,
    )
    from prima.grammar.grammar import Grammar, Match
    from prima.grammar.loading import load
    from prima.grammar.media import supports
    from prima.grammar.semantics import SemanticError

__all__ = [
    "Grammar", "GrammarError", "Match", "SemanticError", "UnsupportedBuiltIn", "UnsupportedFormat",
    "UnsupportedLanguage", "load", "supports",
]  # fmt: skip

_HOMES = {"Grammar": "grammar", "Match": "grammar", "SemanticError": "semantics", "load": "loading",
          "supports": "media"}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES.get(name, 'errors')}"), name)
