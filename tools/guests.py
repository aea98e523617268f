"""What schemas for editors allow in a kind of document besides its own elements."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from prima.markup.vocabulary import Element, Vocabulary


@dataclass(frozen=True, slots=True)
class Guests:
    """Elements of a foreign namespace that are allowed among a vocabulary's own.

    They may contain each other and anything else; of the vocabulary only the elements listed in
    their ``children``, if any.
    """

    namespace: str
    name: str
    elements: tuple[Element, ...]


class OpenVocabulary(Vocabulary):
    """A vocabulary in whose documents elements of other namespaces are allowed.

    Args:
        own: the vocabulary.
        elements: its elements, with descriptions.
        free: keys of elements that may contain anything.
        guests: elements of another namespace that are checked.
    """

    def __init__(
        self, own: Vocabulary, elements: Iterable[Element], free: Iterable[str], guests: Guests
    ) -> None:
        super().__init__(own.namespace, own.name, own.root, elements)
        self.free = frozenset(free)
        self.guests = guests


def is_free(vocabulary: Vocabulary, key: str) -> bool:
    """Whether an element may contain anything."""
    return isinstance(vocabulary, OpenVocabulary) and key in vocabulary.free
