"""Dates and times as people say them."""

from __future__ import annotations

import calendar
import re

from prima.grammar.numbers import cardinal, ordinal

MONTHS = {
    name: number
    for number, names in enumerate(
        ("january jan", "february feb", "march mar", "april apr", "may", "june jun", "july jul",
         "august aug", "september sept sep", "october oct", "november nov", "december dec"), 1
    )
    for name in names.split()
}  # fmt: skip
_FIGURES = (
    re.compile(r"(?P<y>\d{4})[-/. 年](?P<m>\d{1,2})[-/. 月](?P<d>\d{1,2})日?"),
    re.compile(r"(?P<m>\d{1,2})/(?P<d>\d{1,2})/(?P<y>\d{4})"),
    re.compile(r"(?P<m>\d{1,2})/(?P<d>\d{1,2})"),
    re.compile(r"(?P<y>\d{4})(?P<m>\d{2})(?P<d>\d{2})"),
)
_JAPANESE = re.compile(
    r"(?:(?P<y>[^年月日時]{1,9})年)?(?:(?P<m>[^年月日時]{1,4})月)?(?:(?P<d>[^年月日時]{1,4})日)?"
)
_CLOCK = re.compile(r"(?P<h>\d{1,2})(?:[:. ](?P<m>\d{2}))?(?: ?(?:oclock|h))?")
_CLOCK_JA = re.compile(
    r"(?P<x>午前|午後)?(?P<h>[^時分半]{1,4})時(?:(?P<m>[^時分半]{1,4})分|(?P<half>半))?"
)
_PART = re.compile(
    r"(?P<rest>.*?) ?(?P<x>(?:\b|(?<=\d))(?:a ?m|p ?m)|(?:in the|this) (?:morning|afternoon|evening)"
    r"|at night|tonight)"
)
_PARTS = {"am": "a", "a m": "a", "morning": "a", "at night": "night", "tonight": "night"}
_LINKS = {"past": 1, "after": 1, "to": -1, "before": -1, "till": -1, "til": -1, "of": -1}
_NOON = {"noon", "twelve noon", "12 noon", "twelve oclock noon", "正午"}
_MIDNIGHT = {"midnight", "twelve midnight", "12 midnight", "twelve oclock midnight"}
_PASSED_OVER = {"the", "of", "on", "in", "year"} | {
    f"{day}day" for day in ("mon", "tues", "wednes", "thurs", "fri", "satur", "sun")
}
YEARS = range(1500, 3000)
"""Years that are understood alone, without a month."""


def date(text: str, folded: str) -> str | None:
    """``yyyymmdd`` with a question mark for each digit that was not said, or None."""
    plain = text.strip(" .。!").lower()
    for pattern in _FIGURES:
        if match := pattern.fullmatch(plain):
            found = match.groupdict()
            year = int(found["y"]) if found.get("y") else None
            return _written(year, int(found["m"]), int(found["d"]))
    if match := _JAPANESE.fullmatch(folded):
        given = [match[name] for name in "ymd"]
        read = [None if one is None else cardinal(one) for one in given]
        if any(given) and (read[1] or read[0]) and not (read[2] and not read[1]):
            wrong = any(
                one is not None and two is None for one, two in zip(given, read, strict=True)
            )
            return None if wrong else _written(*read)
    return _english_date(folded.replace(",", " ").split())


def _english_date(words: list[str]) -> str | None:
    """``march third two thousand four``, ``3 march``, ``the third of march``, ``2004``."""
    words = [word for word in words if word not in _PASSED_OVER]
    at = next((index for index, word in enumerate(words) if word in MONTHS), None)
    if at is None:
        return _without_month(words)
    month, before, after = MONTHS[words[at]], words[:at], words[at + 1 :]
    if before:
        day = ordinal(" ".join(before))
        if day is None and (year := _year(before)) is not None:
            day = ordinal(" ".join(after)) if after else None
            return None if after and day is None else _written(year, month, day)
        year = _year(after) if after else None
        return None if day is None or (after and year is None) else _written(year, month, day)
    for size in (2, 1):  # the longest day first
        day = ordinal(" ".join(after[:size])) if len(after) >= size else None
        rest = after[size:]
        if day is not None and 1 <= day <= 31:
            year = _year(rest) if rest else None
            if not rest or year is not None:
                return _written(year, month, day)
    year = _year(after) if after else None
    return None if after and year is None else _written(year, month, None)


def _without_month(words: list[str]) -> str | None:
    """A year alone, or a day: ``the fifth``."""
    year = _year(words) if words else None
    if year in YEARS:
        return _written(year, None, None)
    said = " ".join(words)
    counted = cardinal(said) is not None  # "five" is no day, "fifth" is
    day = None if counted or not words else ordinal(said)
    return None if day is None else _written(None, None, day)


def _year(words: list[str]) -> int | None:
    """``2004``, ``two thousand four``, ``nineteen ninety nine``."""
    value = cardinal(" ".join(words))
    if value is not None and 1000 <= value <= 9999:
        return value
    for split in (1, 2):
        high, rest = cardinal(" ".join(words[:split])), words[split:]
        small = rest[:1] in (["oh"], ["o"]) or (len(rest) == 1 and rest[0][0] == "0")
        low = cardinal(" ".join(rest).removeprefix("oh ").removeprefix("o "))
        if high and low is not None and 10 <= high <= 99 and (0 if small else 10) <= low <= 99:
            return high * 100 + low
    return None


def _written(year: int | None, month: int | None, day: int | None) -> str | None:
    if (month is not None and not 1 <= month <= 12) or (year is not None and not 1 <= year <= 9999):
        return None
    if day is not None:
        most = calendar.monthrange(2000 if year is None else year, month)[1] if month else 31
        if not 1 <= day <= most:
            return None
    shown = [(year, 4), (month, 2), (day, 2)]
    return "".join("?" * size if one is None else f"{one:0{size}d}" for one, size in shown)


def time(folded: str) -> str | None:
    """``hhmmx``: x is a, p, h for 24 hours, or ? where it was not said; or None."""
    folded = folded.removeprefix("at ")
    if folded in _NOON or folded in _MIDNIGHT:
        return "1200p" if folded in _NOON else "1200a"
    if match := re.fullmatch(r"(\d{1,2})(\d{2})", folded):
        return _clock(int(match[1]), int(match[2]), "")
    if match := _CLOCK_JA.fullmatch(folded):
        hour, minute = cardinal(match["h"]), cardinal(match["m"]) if match["m"] else 0
        if match["half"]:
            minute = 30
        if hour is None or minute is None:
            return None
        part = {"午前": "a", "午後": "p"}.get(match["x"] or "", "")
        return _clock(12 if part and hour == 0 else hour, minute, part)
    part = "h" if folded.endswith(" hours") else ""
    folded = folded.removesuffix(" hours")
    if match := _PART.fullmatch(folded):
        folded, said = match["rest"], match["x"].removeprefix("in the ").removeprefix("this ")
        part = _PARTS.get(said, "p")
    if match := _CLOCK.fullmatch(folded):
        return _clock(int(match["h"]), int(match["m"] or 0), part)
    words = folded.removesuffix(" oclock").split()
    return _past(words, part) if _LINKS.keys() & set(words) else _words(words, part)


def _past(words: list[str], part: str) -> str | None:
    """``half past five``, ``a quarter to six``, ``ten minutes before noon``."""
    at = next(index for index, word in enumerate(words) if word in _LINKS)
    sign, named = _LINKS[words[at]], " ".join(words[at + 1 :])
    minutes = _minutes([word for word in words[:at] if word not in ("a", "minute", "minutes")])
    hour = 12 if named in _NOON | _MIDNIGHT else cardinal(named)
    if minutes is None or not minutes or hour is None:
        return None
    if named in _NOON | _MIDNIGHT and not part:
        part = "p" if (named in _NOON) == (sign > 0) else "a"
    if sign < 0:
        hour, minutes = hour - 1 or 12, 60 - minutes
    return _clock(hour, minutes, part)


def _words(words: list[str], part: str) -> str | None:
    """``five thirty``, ``oh five hundred``, ``seventeen forty five``."""
    if words[:1] in (["oh"], ["o"], ["zero"]) and len(words) > 1 and words[1] != "hundred":
        words = words[1:]
        part = part or ("h" if words[-1] == "hundred" else "")
    hour = cardinal("zero" if words[0] in ("oh", "o") else words[0]) if words else None
    if hour is None:
        return None
    rest = words[1:]
    if hour >= 20 and rest and (ones := cardinal(rest[0])) and ones < 4:
        hour, rest = hour + ones, rest[1:]
    minutes = _minutes(rest) if rest else 0
    return None if minutes is None else _clock(hour, minutes, part)


def _minutes(words: list[str]) -> int | None:
    if words in (["half"], ["quarter"]):
        return 30 if words == ["half"] else 15
    if words[:1] in (["oh"], ["o"]):
        words = words[1:]
    if words == ["hundred"]:
        return 0
    return cardinal(" ".join(words))


def _clock(hour: int, minute: int, part: str) -> str | None:
    """A time as it is written; ``part`` is a, p, h, night, or empty where it was not said."""
    if not 0 <= minute < 60 or not 0 <= hour < 24:
        return None
    if part == "night":
        part = "a" if hour == 12 or hour < 5 else "p"
    if part in ("a", "p") and not 1 <= hour <= 12:
        return None
    return f"{hour:02d}{minute:02d}{part or ('?' if 1 <= hour <= 12 else 'h')}"
