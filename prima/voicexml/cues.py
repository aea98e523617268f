"""Timing in the markup of a prompt: pauses, rates, set durations and marks (SSML 1.0)."""

from __future__ import annotations

import re
from collections.abc import Iterable

from prima.language.values import milliseconds
from prima.messages import STOPS, Cue

PAUSES = {"none": 0, "x-weak": 100, "weak": 250, "medium": 500, "strong": 750, "x-strong": 1000}
"""The duration of a break of each strength, in ms (SSML 1.0, 3.2.3)."""
SIZES = {"none": 0, "small": 250, "medium": 500, "large": 1000}
"""The same for the sizes of VoiceXML 1.0."""
RATES = {"x-slow": 0.5, "slow": 0.8, "medium": 1.0, "default": 1.0, "fast": 1.25, "x-fast": 2.0}
"""Named rates, as multiples of the usual one (SSML 1.0, 3.2.4)."""
SLOWEST, FASTEST = 0.1, 10.0
"""The slowest and fastest rate of the voice, whatever a document asks for."""
MAX_CUES = 1000
"""How many pauses, rates and marks a prompt may have; further ones have no effect."""
MAX_NAME = 200
"""Characters of a mark's name that are kept."""
NUMBER = re.compile(r"([+-]?)([0-9]{1,9}(?:\.[0-9]{0,9})?|\.[0-9]{1,9})(%?)")


def break_ms(time: str, strength: str, size: str) -> int:
    """How long a break is: by its time, else its strength or size; medium with none of them."""
    known = milliseconds(time, None)
    if known is not None:
        return known
    return PAUSES.get(strength, SIZES.get(size, PAUSES["medium"]))


def is_rate(text: str) -> bool:
    """Whether a prosody element may have this rate."""
    return text in RATES or NUMBER.fullmatch(text) is not None


def rate_of(text: str, around: float) -> float:
    """A rate as a multiple of the usual one; ``around`` is the rate of the surrounding text.

    A number or an unsigned percentage is relative to the usual rate; ``+10%`` is a tenth faster
    than the surrounding text, and ``+0.5`` adds half the usual rate to it.
    """
    if text in RATES:
        return RATES[text]
    found = NUMBER.fullmatch(text)
    if found is None:
        return around
    sign, digits, percent = found.groups()
    number = float(digits) / (100 if percent else 1)
    if sign:
        number = -number if sign == "-" else number
        number = around * (1 + number) if percent else around + number
    return round(min(max(number, SLOWEST), FASTEST), 6)


def fold(parts: Iterable[str | Cue]) -> tuple[str, tuple[Cue, ...]]:
    """Pieces of text as one, its white space folded, and the cues among them in their places."""
    said: list[str] = []
    length, gap = 0, False
    cues: list[Cue] = []
    for part in parts:
        if isinstance(part, Cue):
            cues.append(Cue(length, part.kind, part.value))
            continue
        for index, word in enumerate(part.split()):
            if length and (gap or index or part[0].isspace()):
                said.append(" ")
                length += 1
            said.append(word)
            length += len(word)
            gap = False
        gap = gap or part[-1:].isspace()
    text = "".join(said)
    return text, _tidy(text, cues) if cues else ()


def _tidy(text: str, cues: list[Cue]) -> tuple[Cue, ...]:
    """Drop cues that change nothing, and set durations that are unclosed or hold no text."""
    kept = _Kept(text)
    for cue in cues:
        kept.take(cue)
    return kept.closed()


class _Kept:
    """The cues kept of a text, with the durations opened and not yet closed."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._cues: list[Cue] = []
        self._opened: list[int] = []
        """Where each open duration begins among the cues; -1 for one that was dropped."""
        self._rate = 1.0

    def take(self, cue: Cue) -> None:
        """Keep a cue if it changes something, as long as there are not too many."""
        if cue.kind == "end":
            self._end(cue)
            return
        full = len(self._cues) >= MAX_CUES
        if cue.kind == "lasts":
            self._opened.append(-1 if full else len(self._cues))
        if full or not self._changes(cue):
            return
        if cue.kind == "rate":
            self._rate = float(cue.value or 1.0)
        self._cues.append(cue)

    def _changes(self, cue: Cue) -> bool:
        if cue.kind == "sentence":
            return _wants_pause(self._text, cue.at, self._cues)
        return cue.kind != "rate" or cue.value != self._rate

    def _end(self, cue: Cue) -> None:
        begun = self._opened.pop()
        if begun < 0:
            return
        if self._cues[begun].at < cue.at:
            self._cues.append(cue)
            return
        marks = [one for one in self._cues[begun:] if one.kind == "mark"]
        self._cues[begun:] = [Cue(cue.at, "pause", self._cues[begun].value), *marks]

    def closed(self) -> tuple[Cue, ...]:
        """All of them, without the durations that are still open."""
        for index in reversed([one for one in self._opened if one >= 0]):
            del self._cues[index]
        return tuple(self._cues)


def _wants_pause(text: str, at: int, before: list[Cue]) -> bool:
    """Whether the end of a sentence inside a text needs a pause that no stop makes."""
    if not 0 < at < len(text) or text[at - 1] in STOPS:
        return False
    return not any(cue.kind == "sentence" and cue.at == at for cue in before[-3:])


def clipped(cues: Iterable[Cue], length: int) -> tuple[Cue, ...]:
    """The cues of a text that has been cut off at a length."""
    return tuple(Cue(min(cue.at, length), cue.kind, cue.value) for cue in cues)


def later(cues: Iterable[Cue], characters: int) -> tuple[Cue, ...]:
    """The pauses and marks among a text's cues, placed after so many characters of another text."""
    return tuple(
        Cue(characters, cue.kind, cue.value) for cue in cues if cue.kind in ("pause", "mark")
    )
