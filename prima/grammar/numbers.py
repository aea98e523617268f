"""Numbers as people say them: digits, English and Japanese words."""

from __future__ import annotations

import re
from math import inf

ONES = {
    word: value
    for value, word in enumerate(
        ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen"]
    )
}  # fmt: skip
TENS = {
    word: 10 * value
    for value, word in enumerate(
        ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"], 2
    )
}
SCALES = {"thousand": 10**3, "million": 10**6, "billion": 10**9, "trillion": 10**12}
_VALUES = ONES | TENS | {"a": 1}
_KINDS = (
    {word: "digit" if 1 <= value <= 9 else "teen" for word, value in ONES.items()}
    | dict.fromkeys(TENS, "tens") | dict.fromkeys(SCALES, "scale")
    | {word: word for word in ("a", "and", "hundred")}
)  # fmt: skip
_BEFORE = {
    "a": ("start",),
    "and": ("hundred", "scale"),
    "digit": ("start", "hundred", "scale", "and", "tens"),
    "teen": ("start", "hundred", "scale", "and"),
    "tens": ("start", "hundred", "scale", "and"),
    "hundred": ("digit", "teen", "a", "tens"),
    "scale": ("digit", "teen", "a", "tens", "hundred"),
}
"""The kinds of words that may precede each kind."""
DIGITS = {word: str(value) for word, value in ONES.items() if value < 10}
DIGITS |= dict.fromkeys(("oh", "o", "nought", "naught"), "0")
TIMES = {"double": 2, "triple": 3, "quadruple": 4}
KANJI = {letter: value for value, letter in enumerate("〇一二三四五六七八九")} | {"零": 0}
_SMALL = {"十": 10, "百": 100, "千": 1000}
_LARGE = {"万": 10**4, "億": 10**8, "兆": 10**12}
_READINGS = {
    "ゼロ": "0", "ぜろ": "0", "れい": "0", "まる": "0", "いち": "1", "に": "2", "さん": "3",
    "よん": "4", "し": "4", "ご": "5", "ろく": "6", "なな": "7", "しち": "7", "はち": "8",
    "きゅう": "9", "く": "9",
}  # fmt: skip
_ONE_DIGIT = re.compile(
    "|".join(
        [
            *sorted(_READINGS, key=len, reverse=True),
            r"[0-9]",
            f"[{''.join(KANJI)}]",
            *(rf"\b(?:{'|'.join(DIGITS)}|{'|'.join(TIMES)})\b",),
        ]
    )
)
MOST_FIGURES = 100
"""Maximum number of digits of a number."""
_FIGURES = re.compile(r"[0-9]{1,3}(?:,[0-9]{3})+|[0-9]+")
_DECIMAL = re.compile(r"([0-9]{1,3}(?:,[0-9]{3})+|[0-9]*)\.([0-9]+)|([0-9]+),(?![0-9]{3}$)([0-9]+)")
"""A decimal point, or a decimal comma that is not a thousands separator."""
_POINT = re.compile(r"(?:(.*?) )?point (.*)|([^点]*)点(.*)")
"""The parts before and after a spoken decimal point."""
_JAPANESE = re.compile(f"[0-9{''.join([*KANJI, *_SMALL, *_LARGE])}]+")


def digits(text: str) -> str | None:
    """A folded text said digit by digit, or None."""
    found: list[str] = []
    times, at = 1, 0
    while at < len(text):
        if text[at] == " ":
            at += 1
            continue
        match = _ONE_DIGIT.match(text, at)
        if match is None:
            return None
        at = match.end()
        if match[0] in TIMES:
            times = TIMES[match[0]] if times == 1 else 0
            continue
        digit = DIGITS.get(match[0]) or _READINGS.get(match[0]) or str(KANJI.get(match[0], ""))
        if times == 0:
            return None
        found.append((digit or match[0]) * times)
        times = 1
    return "".join(found) if found and times == 1 else None


def dialled(text: str) -> str | None:
    """Digits as telephone numbers are said: ``eight hundred five five twelve``; or None."""
    found, words, at = "", text.split(), 0
    while at < len(words):
        read = None
        for size in (3, 2, 1):
            said = " ".join(words[at : at + size])
            single = size == 1 or words[at] in TIMES
            read = (digits(said) if single else None) or _dialled(said)
            if at + size <= len(words) and read is not None:
                found, at = found + read, at + size
                break
        if read is None:
            return None
    return found or None


def _dialled(said: str) -> str | None:
    """``twelve``, ``thirty four``, ``eight hundred``."""
    value = cardinal(said)
    whole = said.endswith((" hundred", " thousand")) and value is not None and value < 10_000
    return str(value) if whole or (value is not None and 10 <= value <= 99) else None


def cardinal(text: str) -> int | None:
    """A whole number in a folded text: digits, English or Japanese words; or None."""
    if _FIGURES.fullmatch(text):
        return int(text.replace(",", "")) if len(text) <= MOST_FIGURES else None
    if text == "ゼロ":
        return 0
    if _JAPANESE.fullmatch(text):
        return _japanese(text)
    return _english(text.split())


def _english(words: list[str]) -> int | None:
    """``two hundred and five``; or None."""
    total, group, scale = 0, 0, 10**15
    before = "start"
    for word in words:
        kind = _KINDS.get(word, "")
        if before not in _BEFORE.get(kind, ()):
            return None
        if word in _VALUES:
            group += _VALUES[word]
        elif kind == "hundred":
            if group >= 100:
                return None
            group *= 100
        elif kind == "scale":
            if SCALES[word] >= scale or not group:
                return None
            scale = SCALES[word]
            total, group = total + group * scale, 0
        before = kind
    return total + group if before not in ("start", "a", "and") else None


def _japanese(text: str) -> int | None:
    """``二百三``, ``3千``; digits alone are read one by one."""
    if not set(text) & (_SMALL.keys() | _LARGE.keys()):
        figures = "".join(str(KANJI.get(letter, letter)) for letter in text)
        return int(figures) if len(figures) <= MOST_FIGURES else None
    total, group, number = 0, 0, ""
    small = large = inf
    for letter in text:
        if letter in _SMALL:
            group += (int(number) if number else 1) * _SMALL[letter]
            wrong, small, number = _SMALL[letter] >= small, _SMALL[letter], ""
        elif letter in _LARGE:
            group += int(number) if number else 0
            total += (group or 1) * _LARGE[letter]
            wrong, large = _LARGE[letter] >= large, _LARGE[letter]
            small, group, number = inf, 0, ""
        else:
            number += str(KANJI.get(letter, letter))
            wrong = len(number) > 15
        if wrong:
            return None
    return total + group + (int(number) if number else 0)


def number(text: str) -> str | None:
    """A number with sign and decimals as text without needless zeros, or None."""
    sign, rest = _sign(text)
    rest, fraction = _fraction(rest)
    if fraction is None:
        return None
    whole = cardinal(rest)
    if whole is None and rest in ("", "oh") and fraction:
        whole = 0
    if whole is None:
        return None
    return f"{sign}{whole}{'.' + fraction if fraction else ''}"


def _sign(text: str) -> tuple[str, str]:
    for word, sign in (("minus ", "-"), ("negative ", "-"), ("plus ", "+"), ("マイナス", "-"),
                       ("プラス", "+"), ("-", "-"), ("+", "+")):  # fmt: skip
        if text.startswith(word):
            return sign, text[len(word) :].strip()
    return "", text


def _fraction(text: str) -> tuple[str, str | None]:
    """The parts before and after the decimal point; None if the latter is not digits."""
    if match := _DECIMAL.fullmatch(text):
        return (match[1], match[2]) if match[2] else (match[3], match[4])
    match = _POINT.fullmatch(text)
    if match is None:
        half = text.endswith(" and a half")
        return text.removesuffix(" and a half").strip(), "5" if half else ""
    before, after = (match[1] or match[3] or "").strip(), match[2] or match[4] or ""
    found = digits(after)
    if found is None and 10 <= (tens := cardinal(after) or 0) <= 99:
        return before, str(tens)
    return before, found


def ordinal(word: str) -> int | None:
    """``first``, ``3rd``, ``twenty first``; or None."""
    match = re.fullmatch(r"([0-9]{1,2})(?:st|nd|rd|th)?", word)
    if match:
        return int(match[1])
    head, _, tail = word.rpartition(" ")
    irregular = {"first": 1, "second": 2, "third": 3, "fifth": 5, "eighth": 8, "ninth": 9,
                 "twelfth": 12, "twentieth": 20, "thirtieth": 30}  # fmt: skip
    value = irregular.get(tail)
    if value is None and tail.endswith("th"):
        value = ONES.get(tail[:-2])
    if value is None and tail in ONES | TENS:
        value = (ONES | TENS)[tail]
    if value is None or not head:
        return value
    return TENS[head] + value if head in TENS and 1 <= value <= 9 else None
