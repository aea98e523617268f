"""How long speech takes, by language and script."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from prima.messages import STOPS, Cue

RATES = {"en": 14.0, "ja": 8.0, "zh": 5.0, "ko": 6.0}
"""Letters a second, unless a robot profile says otherwise."""
DEFAULT_RATE = 13.0
PAUSE_MS = 300
"""The time that every utterance takes in addition to its letters."""
SENTENCE_MS = 250
"""The pause after a sentence inside an utterance."""
KANJI = 2.0
"""A kanji in Japanese is read as about two kana."""


@lru_cache(maxsize=10_000)
def weight(letter: str, lang: str) -> float:
    """How many of its language's letters a character counts for in speech."""
    category = unicodedata.category(letter)
    if category[0] in "PZCSM":
        return 0.0
    if lang == "ja":
        if "CJK UNIFIED" in unicodedata.name(letter, ""):
            return KANJI
        return 0.6 if letter.isascii() else 1.0
    return 2.0 if category == "Nd" else 1.0


def duration(text: str, lang: str, rates: dict[str, float]) -> int:
    """How long it takes to say a text, in ms.

    ``lang`` is a language tag; letters are counted and spaces are not, so that sentences
    of languages without spaces are timed correctly.
    """
    primary = lang.lower().partition("-")[0]
    letters = sum(weight(letter, primary) for letter in text)
    stops = sum(1 for letter in text[:-1] if letter in STOPS)
    spoken = round(letters / speed(lang, rates) * 1000)
    return max(spoken + PAUSE_MS + stops * SENTENCE_MS, 1)


def speed(lang: str, rates: dict[str, float]) -> float:
    """Letters a second of a language, by a robot's own rates or the usual ones."""
    primary = lang.lower().partition("-")[0]
    return rates.get(lang.lower()) or rates.get(primary) or RATES.get(primary, DEFAULT_RATE)


def beginning(text: str, lang: str, share: float) -> str:
    """The words of a text that have been heard after a share of its time (0 to 1)."""
    primary = lang.lower().partition("-")[0]
    weights = [weight(letter, primary) for letter in text]
    left, said = share * sum(weights), 0
    for heavy in weights:
        left -= heavy
        if left < 0:
            break
        said += 1
    return whole_words(text, said)


def whole_words(text: str, said: int) -> str:
    """The first ``said`` characters of a text, without an unfinished word."""
    for cut in range(said, 0, -1):
        after = text[cut : cut + 1]
        if not after.strip() or not (text[cut - 1].isascii() and after.isascii()):
            return text[:cut].strip()
    return ""


# Speech with cues ---------------------------------------------------------------------------

Beat = tuple[str, float | str]
"""A letter or silence with its ms, a mark, or the beginning or end of a stretch with a set time."""


@dataclass(frozen=True, slots=True)
class SpeechTimeline:
    """When the letters of a text have been said and its marks are passed, in ms from its start."""

    text: str
    total: int
    ends: tuple[float, ...]
    """When each character has been said."""
    marks: tuple[tuple[float, str], ...]
    """When each mark is passed, and its name, in the text's order."""

    def heard(self, time: float) -> str:
        """The words of the text that have been heard after a time."""
        return whole_words(self.text, sum(1 for end in self.ends if round(end) <= time))

    def passed(self, time: float) -> int:
        """How many marks have been passed after a time."""
        return sum(1 for when, _ in self.marks if when <= time)


def timeline(
    text: str, lang: str, rates: dict[str, float], cues: tuple[Cue, ...]
) -> SpeechTimeline:
    """Lay a text out in time, with its pauses, rates and set times (SSML 1.0, 3.2.3 and 3.2.4).

    A stretch with a set time is lengthened or shortened as a whole, including its pauses.
    """
    beats = list(_beats(text, lang, rates, cues))
    scales = iter(_scales(beats))
    ends: list[float] = []
    marks: list[tuple[float, str]] = []
    now, free = 0.0, False
    inside = [(1.0, 0.0)]
    """The factors and ends of the stretches around this place, outermost first."""
    for kind, value in beats:
        match kind:
            case "mark":
                marks.append((round(now), str(value)))
            case "lasts":
                outer = inside[-1][0]
                inside.append((outer * next(scales), now + float(value) * outer))
            case "end":
                now = inside.pop()[1]
            case _:
                now += float(value) * inside[-1][0]
                if kind == "letter":
                    ends.append(now)
                    free = free or (float(value) > 0 and len(inside) == 1)
    total = max(round(now) + (PAUSE_MS if free else 0), 1)
    return SpeechTimeline(text, total, tuple(ends), tuple(marks))


def _beats(text: str, lang: str, rates: dict[str, float], cues: tuple[Cue, ...]) -> Iterator[Beat]:
    """A text's letters and cues in the order in which they occur."""
    primary, rate = lang.lower().partition("-")[0], speed(lang, rates)
    factor, left = 1.0, list(reversed(cues))
    for index in range(len(text) + 1):
        while left and left[-1].at <= index:
            cue = left.pop()
            if cue.kind == "rate":
                factor = float(cue.value or 1.0)
            else:
                yield from _beat(cue)
        if index < len(text):
            yield "letter", weight(text[index], primary) / rate * 1000 / factor
            if index < len(text) - 1 and text[index] in STOPS:
                yield "pause", SENTENCE_MS


def _beat(cue: Cue) -> Iterator[Beat]:
    """The step for a cue other than a rate, if it has a place in the text."""
    match cue.kind:
        case "sentence":
            yield "pause", SENTENCE_MS
        case "mark":
            yield "mark", str(cue.value)
        case "pause" | "lasts" | "end":
            yield cue.kind, float(cue.value or 0.0)


def _scales(beats: list[Beat]) -> list[float]:
    """The factor by which each stretch with a set time is lengthened, in order."""
    scales: list[float] = []
    open_: list[tuple[int, float, float]] = []
    now = 0.0
    for kind, value in beats:
        if kind == "lasts":
            open_.append((len(scales), now, float(value)))
            scales.append(1.0)
        elif kind == "end":
            index, since, wanted = open_.pop()
            scales[index] = wanted / (now - since) if now > since else 0.0
            now = since + wanted
        elif kind != "mark":
            now += float(value)
    return scales


def language(text: str) -> str:
    """The language of an untagged utterance, as far as its letters show; else empty."""
    names = {unicodedata.name(letter, "").partition(" ")[0] for letter in text}
    if names & {"HIRAGANA", "KATAKANA"}:
        return "ja"
    return "ko" if "HANGUL" in names else ""
