"""Speech and key grammars: SRGS 1.0 in both forms, their meaning (SISR 1.0), built-in types."""

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
    "Grammar",
    "GrammarError",
    "Match",
    "SemanticError",
    "UnsupportedBuiltIn",
    "UnsupportedFormat",
    "UnsupportedLanguage",
    "load",
    "supports",
]
