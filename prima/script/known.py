"""The variables visible to code of a document, by scope."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import islice

from prima.errors.guesses import MANY_WORDS
from prima.script.globals import IDENTIFIER


class NameScope(set[str]):
    """The names of the variables of one scope."""

    @cached_property
    def written(self) -> list[str]:
        """Names that documents may write, up to the number considered for guesses.

        Only to be read after all names have been added.
        """
        meant = (one for one in self if IDENTIFIER.fullmatch(one) and not one.startswith("$"))
        return list(islice(meant, MANY_WORDS + 1))


class Known:
    """The variables visible to some code: looked up in their scopes, which are never merged."""

    __slots__ = ("scopes",)

    def __init__(self, *scopes: NameScope) -> None:
        self.scopes = scopes

    def __contains__(self, name: object) -> bool:
        found = False
        for scope in self.scopes:
            found = found or name in scope
        return found

    def written(self) -> Iterator[str]:
        """Variables that an author may have meant."""
        return (name for scope in self.scopes for name in scope.written)
