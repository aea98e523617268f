"""Utterances, folded to what speech conveys, and key presses.

Grammars are matched on folded text: case, width and punctuation are inaudible, and scripts
without spaces between words are matched without them.
"""

from __future__ import annotations

import re
import unicodedata
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

UNSPACED = (
    r"\u0e00-\u0eff\u0f00-\u0fff\u1000-\u109f\u1780-\u17ff"  # Thai, Lao, Tibetan, Burmese, Khmer
    r"\u2e80-\u9fff\uac00-\ud7a3\uf900-\ufaff\uff66-\uff9d\U00020000-\U0003ffff"
)
"""Letters of scripts that are written without spaces, or (Korean) with loose ones."""
_UNSPACED = f"[{UNSPACED}]"
_LOOSE = f"(?<=[{UNSPACED}]) +| +(?=[{UNSPACED}])"
# Patterns of so many letters take long to compile: these two are compiled on first use.
_KEPT = re.compile(r"((?<!\d)\d++(?:[.,:]\d++)+|(?<=[^\W\d_])[+#]+(?![\w+#]))")
_APOSTROPHE = re.compile(r"['\u2019\u2018`\u00b4]")
_PLAIN = re.compile(r"[a-z0-9]+(?: [a-z0-9]+)*")
_TOKEN = re.compile(r'"([^"]*)"|([^\s"]+)')
_GIVEN = re.compile(r"\S+")
CURRENCY_SIGNS = frozenset("$€£¥¢＄￥￡￠")
AROUND = " \"'“”()!?,;:"
"""Signs of the sentence around a value."""
KEYS = frozenset("0123456789*#ABCD")
"""The keys of a telephone (SRGS Appendix E)."""
KEY_NAMES = {"star": "*", "pound": "#"}
LONGEST = 10_000
"""Maximum length of an utterance; a longer one matches nothing."""


@lru_cache(maxsize=4096)
def fold(text: str) -> str:
    """Remove from text what speech does not convey: case, width, punctuation, loose spaces."""
    if _PLAIN.fullmatch(text):
        return text
    folded = _APOSTROPHE.sub("", wide(text).casefold())
    # Keep separators inside numbers and times, and the signs that distinguish C++ and C# from C.
    pieces = _KEPT.split(folded)
    pieces[::2] = ["".join(map(_letter, piece)) for piece in pieces[::2]]
    return _closed(" ".join("".join(pieces).split()))


def wide(text: str) -> str:
    """Text in the usual width, without compatibility forms (NFKC)."""
    return unicodedata.normalize("NFKC", text)


def _letter(letter: str) -> str:
    category = unicodedata.category(letter)
    if category == "Cf" and letter != "\u200b":  # which may separate words
        return ""  # a soft hyphen or joiner inside a word
    return " " if category[0] in "PSZC" else letter


def tokens(text: str) -> list[str] | None:
    """The tokens of a text (SRGS 2.1), quoted ones as one; None if a quote is left open."""
    if '"' not in text:
        return text.split()
    if text.count('"') % 2:
        return None
    return [" ".join((match[1] or match[2] or "").split()) for match in _TOKEN.finditer(text)]


def join(words: tuple[str, ...] | list[str]) -> str:
    """Tokens as text, without spaces in scripts that have none."""
    return _closed(" ".join(words))


def _closed(text: str) -> str:
    return text if text.isascii() else re.sub(_LOOSE, "", text)


def keys(text: str) -> str | None:
    """Key presses, written with or without spaces; None if there is anything else."""
    pressed: list[str] = []
    for word in text.split():
        pressed.append(KEY_NAMES.get(word.lower(), word.upper()))
    joined = "".join(pressed)
    return joined if KEYS.issuperset(joined) else None


@dataclass(slots=True)
class MatchedUtterance:
    """An utterance prepared for matching."""

    text: str
    """The utterance as given."""
    said: str
    """Folded, or the keys pressed."""
    edges: list[bool]
    """Whether a word may end at a position."""
    mode: str
    ends: list[int]
    """Where words end."""

    def after(self, end: int) -> int:
        """Where the next word begins, after one that ended."""
        return end + 1 if end < len(self.said) and self.said[end] == " " else end

    def words_from(self, start: int) -> list[int]:
        """Where a stretch of whole words that begins at a position may end."""
        return self.ends[bisect_right(self.ends, start) :]


class AsGiven:
    """What was given for a stretch of whole words, with the signs that folding removes."""

    def __init__(self, heard: MatchedUtterance) -> None:
        self._heard = heard
        self._starts: dict[int, int] = {}
        self._ends: dict[int, int] = {}
        """Where words of the folded utterance begin and end in the text."""
        at = end = 0
        for word in _GIVEN.finditer(heard.text if heard.mode == "voice" else ""):
            folded = fold(word[0])
            if not heard.said.startswith(folded, at):
                return  # what follows is known as it is folded
            if not folded and word[0].strip(AROUND) not in CURRENCY_SIGNS:
                continue
            self._starts.setdefault(at, word.start())
            if folded:
                end = at + len(folded)
                at = heard.after(end)
            self._ends[end] = word.end()  # a sign of currency belongs to the words around it

    def text(self, start: int, end: int) -> str:
        """The text of a stretch; folded where it begins or ends inside a word."""
        first, last = self._starts.get(start), self._ends.get(end)
        known = first is not None and last is not None
        return self._heard.text[first:last] if known else self._heard.said[start:end]


def utterance(text: str, mode: str) -> MatchedUtterance | None:
    """Prepare an utterance; None if it can match nothing."""
    if len(text) > LONGEST:
        return None
    if mode == "dtmf":
        pressed = keys(text)
        if pressed is None:
            return None
        everywhere = [True] * (len(pressed) + 1)
        return MatchedUtterance(text, pressed, everywhere, mode, list(range(1, len(pressed) + 1)))
    said = fold(text)
    edges = _edges(said)
    ends = [end for end in range(1, len(edges)) if edges[end] and said[end - 1] != " "]
    return MatchedUtterance(text, said, edges, mode, ends)


def _edges(said: str) -> list[bool]:
    loose = [letter == " " or _is_unspaced(letter) for letter in said]
    inner = [before or after for before, after in pairwise(loose)]
    return [True, *inner, True] if said else [True]


def _is_unspaced(letter: str) -> bool:
    return not letter.isascii() and re.match(_UNSPACED, letter) is not None
