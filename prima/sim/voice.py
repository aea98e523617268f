"""How long speech takes, by language and script."""

from __future__ import annotations

import unicodedata

RATES = {"en": 14.0, "ja": 8.0, "zh": 5.0, "ko": 6.0}
"""Letters a second where a robot profile does not say otherwise."""
DEFAULT_RATE = 13.0
PAUSE_MS = 300
"""What every utterance takes beyond its letters."""
SENTENCE_MS = 250
"""The pause after a sentence inside an utterance."""
KANJI = 2.0
"""A kanji in Japanese is read as about two kana."""


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

    ``lang`` is a language tag; the letters are counted, never the spaces, so a
    sentence of a language without spaces takes its due.
    """
    primary = lang.lower().partition("-")[0]
    rate = rates.get(lang.lower()) or rates.get(primary) or RATES.get(primary, DEFAULT_RATE)
    letters = sum(weight(letter, primary) for letter in text)
    stops = sum(1 for letter in text[:-1] if letter in ".!?。！？")
    return max(round(letters / rate * 1000) + PAUSE_MS + stops * SENTENCE_MS, 1)


def beginning(text: str, lang: str, share: float) -> str:
    """What has been heard of a text when a share of its time (0 to 1) has gone, in whole words."""
    primary = lang.lower().partition("-")[0]
    weights = [weight(letter, primary) for letter in text]
    left, cut = share * sum(weights), 0
    for index, heavy in enumerate(weights):
        left -= heavy
        if left < 0:
            break
        after = text[index + 1 : index + 2]
        if not after.strip() or not (text[index].isascii() and after.isascii()):
            cut = index + 1
    return text[:cut].strip()


def language(text: str) -> str:
    """The language of an utterance that has no tag, as far as its letters tell; else nothing."""
    names = {unicodedata.name(letter, "").partition(" ")[0] for letter in text}
    if names & {"HIRAGANA", "KATAKANA"}:
        return "ja"
    return "ko" if "HANGUL" in names else ""
