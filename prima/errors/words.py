"""Numbers, lists and file names in sentences."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import PurePath


def counted(number: int, noun: str) -> str:
    """A number with its noun: ``1 reaction``, ``2 reactions``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def argument(path: str | PurePath) -> str:
    """A file's name as it is written in a command line, where ``-v.xml`` would be an option."""
    name = str(path)
    return shlex.quote(f"./{name}" if name.startswith("-") else name)


def with_article(noun: str) -> str:
    """A noun, or an element, with its article: ``a form``, ``an <on>``."""
    return f"{'an' if noun.lstrip('<').startswith(('a', 'e', 'i', 'o')) else 'a'} {noun}"


def one_of(words: Iterable[str], most: int = 0) -> str:
    """Join words for a message: ``a, b or c``; of more than ``most`` of them ``a, b and 5 more``."""
    listed = sorted(words)
    if 0 < most < len(listed):
        return f"{', '.join(listed[:most])} and {len(listed) - most} more"
    *head, last = listed or [""]
    return f"{', '.join(head)} or {last}" if head else last
