"""What the user may answer: options, built-in types and SRGS rules, matched on text.

Matching folds case, width and punctuation (W3C SRGS works on tokens; a person's
"Prof. Kidode's room." and a recogniser's "prof kidode's room" are one answer).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prima.messages import Json
from prima.script.budget import Budget

CJK = r"\u2e80-\u9fff\uac00-\ud7a3\uf900-\ufaff\uff66-\uff9d\U00020000-\U0003ffff"
_BETWEEN_CJK = f"(?<=[{CJK}]) +| +(?=[{CJK}])"  # takes long to compile, and few texts need it
_KEPT = re.compile(r"(\d+(?:[.,:]\d+)+|(?<=[^\W\d_])[+#]+(?![\w+#]))")
FEW = 8
"""So many alternatives are all tried."""
MAX_STEPS = 100_000
"""How many steps matching one utterance may take."""


@lru_cache(maxsize=512)
def fold(text: str) -> str:
    """Give text without what speech does not carry: case, width, punctuation, CJK spaces."""
    folded = _wide(text).casefold()
    for quote in "'\u2019\u2018`\u00b4":
        folded = folded.replace(quote, "")
    # Separators inside numbers and times are kept, and what tells C++ and C# from C.
    kept = "+" in folded or "#" in folded or any(map(str.isdecimal, folded))
    pieces = _KEPT.split(folded) if kept else [folded]
    pieces[::2] = ["".join(map(_letter, piece)) for piece in pieces[::2]]
    said = " ".join("".join(pieces).split())
    return said if said.isascii() else re.sub(_BETWEEN_CJK, "", said)


def _wide(text: str) -> str:
    """Text in the usual width (NFKC)."""
    if text.isascii():
        return text
    from unicodedata import normalize  # few grammars need it

    return normalize("NFKC", text)


def _letter(letter: str) -> str:
    if letter.isascii():
        return letter if letter.isalnum() else " "
    from unicodedata import category

    return " " if category(letter)[0] in "PSZC" else letter


YES = "yes|yeah|yep|yes please|yes i do|yes you may|sure|of course|ok|okay|はい|ええ|うん|お願いします|はいお願いします"
NO = "no|nope|nah|no thanks|no thank you|no i dont|not now|いいえ|いや|ううん|結構です|いいえ結構です"
_SMALL = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
_TENS = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
_KANJI = dict(zip("〇一二三四五六七八九", range(10), strict=True))


def read_number(text: str) -> float | None:
    """A number said in digits, English words up to 99, or Japanese ones; or None."""
    plain = _wide(text).strip(" .!?。").replace("\u2212", "-")
    if re.fullmatch(r"-?[0-9]{1,3}(?:,[0-9]{3})+(?:\.[0-9]+)?", plain):
        return float(plain.replace(",", ""))
    if re.fullmatch(r"-?[0-9]+(?:[.,][0-9]+)?", plain):
        return float(plain.replace(",", "."))
    folded = fold(text)
    words = folded.split()
    if len(words) == 1 and words[0] in _SMALL:
        return float(_SMALL.index(words[0]))
    if 1 <= len(words) <= 2 and words[0] in _TENS:
        ones = _SMALL.index(words[1]) if len(words) == 2 and words[1] in _SMALL[1:10] else 0
        return float(20 + 10 * _TENS.index(words[0]) + ones) if len(words) == 1 or ones else None
    match = re.fullmatch("([一二三四五六七八九]?)(十?)([〇一二三四五六七八九]?)", folded)
    if match and folded and (match[2] or len(folded) == 1):
        tens = (_KANJI.get(match[1], 1) if match[2] else 0) * 10
        ones = _KANJI.get(match[3] or ("" if match[2] else match[1]), 0)
        return float(tens + ones)
    return None


def _boolean(text: str) -> Json:
    folded = fold(text)
    if folded in map(fold, YES.split("|")):
        return True
    return False if folded in map(fold, NO.split("|")) else None


def _number(text: str) -> Json:
    value = read_number(text)
    return int(value) if value is not None and value == int(value) else value


def _digits(text: str) -> Json:
    joined = fold(text).replace(" ", "")
    return joined if joined.isascii() and joined.isdigit() else None


def _time(text: str) -> Json:
    folded = fold(text)
    match = re.fullmatch(
        r"(\d{1,2})(?:[:.](\d{2}))?(?: ?oclock| hours| h|時)?(?:(\d{1,2})分)? ?(am|pm|a m|p m)?",
        folded,
    )
    if match is None:
        return None
    hour, minute = int(match[1]), int(match[2] or match[3] or 0)
    if match[4]:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if match[4].startswith("p") else 0)
    return f"{hour:02d}:{minute:02d}" if hour < 24 and minute < 60 else None


def _date(text: str) -> Json:
    match = re.fullmatch(r"\s*(\d{4})[-/年](\d{1,2})[-/月](\d{1,2})日?[.。]?\s*", text)
    if match is None:
        return None
    from calendar import monthrange  # not needed by most commands

    year, month, day = int(match[1]), int(match[2]), int(match[3])
    if not (year and 1 <= month <= 12 and 1 <= day <= monthrange(year, month)[1]):
        return None
    return f"{match[1]}-{month:02d}-{day:02d}"


def _text(text: str) -> Json:
    return " ".join(text.split()) if fold(text) else None


BUILT_IN: dict[str, Callable[[str], Json]] = {
    "boolean": _boolean,
    "number": _number,
    "digits": _digits,
    "date": _date,
    "time": _time,
    "text": _text,
}
"""The built-in types: text to value, None where it does not match."""


# SRGS ---------------------------------------------------------------------------


@dataclass(slots=True)
class Words:
    """Words to be said, folded."""

    words: str


@dataclass(slots=True)
class Sequence:
    """Parts said one after another, between ``low`` and ``high`` times."""

    parts: list[Part]
    low: int = 1
    high: int = 1


@dataclass(slots=True)
class Index:
    """Alternatives, by number, by what they begin with; see :mod:`prima.interpreter.leads`."""

    by_lead: dict[str, list[int]]
    """Without spaces; an alternative stands under each of its beginnings."""
    lengths: list[int]
    """How long these are, the shortest first."""
    others: list[int]
    """Those of which nothing is known."""

    def likely(self, rest: str) -> list[int]:
        """Those that may match what goes on with a text without spaces, in order."""
        found = set(self.others)
        for length in self.lengths:
            if length > len(rest):
                break
            found.update(self.by_lead.get(rest[:length], ()))
        return sorted(found)


@dataclass(slots=True)
class Choice:
    """Alternatives; where there are many, with an index of them."""

    parts: list[Part]
    index: Index | None = None


@dataclass(slots=True)
class Reference:
    """Another rule."""

    rule: str


@dataclass(slots=True)
class Tag:
    """The value given."""

    value: str


Part = Words | Sequence | Choice | Reference | Tag


Ends = dict[int, str | None]
"""Where an expansion may end, with the value of the last tag on the way there."""
Asking = Generator[tuple[Part, int], Ends, Ends]
"""Finds where a part may end, and asks for that of others at some places."""


@dataclass(slots=True)
class Grammar:
    """Rules by name, and the root rule's name."""

    rules: dict[str, Part] = field(default_factory=dict)
    root: str = ""

    def large(self) -> Iterator[Choice]:
        """Where there are so many alternatives that an index of them is worth while."""
        todo = list(self.rules.values())
        while todo:
            part = todo.pop()
            if isinstance(part, Choice):
                if len(part.parts) > FEW:
                    yield part
                todo += part.parts
            elif isinstance(part, Sequence):
                todo += part.parts

    def match(self, text: str, budget: Budget | None = None) -> str | None:
        """The value of an utterance (the last tag met, else the utterance), or None."""
        said = fold(text)
        matching = Matching(self.rules, said)
        ends = matching.ends(Reference(self.root), 0)
        if budget is not None:
            budget.steps -= MAX_STEPS - matching.left
        if len(said) not in ends:
            return None
        tag = ends[len(said)]
        return text.strip() if tag is None else tag


class Matching:
    """Matches one utterance; every part is matched at every place only once."""

    def __init__(self, rules: dict[str, Part], said: str) -> None:
        self.rules = rules
        self.said = said
        self.left = MAX_STEPS
        self.known: dict[tuple[int, int], Ends] = {}

    def ends(self, part: Part, start: int) -> Ends:
        """Where a part that begins at ``start`` may end."""
        begun: list[tuple[tuple[int, int], Asking]] = []  # no recursion: rules may go very deep
        found: Ends | None = self._ask(begun, part, start)
        while begun:
            key, asking = begun[-1]
            try:
                asked = next(asking) if found is None else asking.send(found)
                found = self._ask(begun, *asked)
            except StopIteration as done:
                begun.pop()
                found = self.known[key] = done.value
        assert found is not None
        return found

    def _ask(
        self, begun: list[tuple[tuple[int, int], Asking]], part: Part, start: int
    ) -> Ends | None:
        """What is known of a part at a place; None where it has to be found, which is begun."""
        key = (id(part), start)
        found = self.known.get(key)
        if found is None:
            self.known[key] = {}  # what refers to itself before saying anything leads nowhere
            self.left -= 1
            if self.left <= 0:
                return {}
            begun.append((key, self._ends(part, start)))
        return found

    def _ends(self, part: Part, start: int) -> Asking:
        match part:
            case Words(words):
                end = _said(self.said, start, words)
                return {} if end is None else {end: None}
            case Tag(value):
                return {start: value}
            case Reference(rule):
                return (yield self.rules[rule], start)
            case Choice():
                found: Ends = {}
                for choice in self._likely(part, start):
                    for end, tag in (yield choice, start).items():
                        found.setdefault(end, tag)
                return found
            case Sequence():
                return (yield from self._times(part, start))

    def _likely(self, part: Choice, start: int) -> list[Part]:
        """The alternatives that may match at a place."""
        if part.index is None:
            return part.parts
        rest = self.said[start:].replace(" ", "")
        return [part.parts[number] for number in part.index.likely(rest)]

    def _times(self, part: Sequence, start: int) -> Asking:
        """A sequence said between ``low`` and ``high`` times."""
        found: Ends = {start: None} if part.low == 0 else {}
        here: Ends = {start: None}
        for times in range(1, part.high + 1):
            if self.left <= 0:
                return {}
            here = yield from self._once(part.parts, here)
            new = {end: tag for end, tag in here.items() if end not in found}
            if times >= part.low:
                found |= new
            if not here or (times >= part.low and not new):
                break
        return found

    def _once(self, parts: list[Part], here: Ends) -> Asking:
        for part in parts:
            after: Ends = {}
            for start, tag in here.items():
                for end, later in (yield part, start).items():
                    self.left -= 1
                    after.setdefault(end, tag if later is None else later)
            here = after
        return here


def _said(said: str, start: int, words: str) -> int | None:
    """Where the words end if they stand at ``start``, at the edge of a word."""
    while start < len(said) and said[start] == " ":
        start += 1
    if not words:
        return start
    end = start + len(words)
    if said[start:end] != words:
        return None
    inside = end < len(said) and said[end] != " " and said[end - 1].isascii()
    return None if inside and said[end].isascii() and said[end].isalnum() else end


@dataclass(slots=True)
class Answers:
    """All that a field takes: options first, then grammars, then its built-in type."""

    options: dict[str, Json] = field(default_factory=dict)
    grammars: list[Grammar] = field(default_factory=list)
    type: str = ""

    def match(self, text: str, budget: Budget | None = None) -> Json:
        """The field's value for an utterance, or None where it takes no such answer."""
        said = fold(text)
        if said in self.options:
            return self.options[said]
        for grammar in self.grammars:
            value = grammar.match(text, budget)
            if value is not None:
                return value
        return BUILT_IN[self.type](text) if self.type else None
