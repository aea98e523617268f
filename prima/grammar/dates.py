"""Dates and times as people say them."""

from __future__ import annotations

import calendar
import re

from prima.grammar.numbers import cardinal, digits, ordinal
from prima.grammar.text import AROUND

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
DAYS = range(1, 32)
YEARS = range(1500, 3000)
"""Years that are recognised without a month."""


def date(text: str, folded: str) -> str | None:
    """``yyyymmdd`` with a question mark for each digit that was not said, or None."""
    figures = text.strip(f"{AROUND}.。").lower()
    for pattern in _FIGURES:
        if match := pattern.fullmatch(figures):
            found = match.groupdict()
            return _written(*(int(found[one]) if found.get(one) else None for one in "ymd"))
    if match := _JAPANESE.fullmatch(folded):
        year, month, day = map(_counted, match.groups())
        if (year or month) and (month or not day):
            return _written(year, month, day)
    return _english_date(folded.replace(",", " ").split())


def _counted(said: str | None) -> int | None:
    """A number in Japanese; 0, not a year, month or day, if it cannot be read."""
    return None if said is None else cardinal(said) or 0


def _english_date(words: list[str]) -> str | None:
    """``march third two thousand four``, ``3 march``, ``the third of march``, ``2004``."""
    words = [word for word in words if word not in _PASSED_OVER]
    at = next((index for index, word in enumerate(words) if word in MONTHS), None)
    if at is None:
        return _without_month(words)
    month, before, after = MONTHS[words[at]], words[:at], words[at + 1 :]
    if before:
        readings = [(before, after), (after, before)]
    else:  # the longest day first
        readings = [(after[:2], after[2:]), (after[:1], after[1:]), ([], after)]
    for days, years in readings:
        day, year = ordinal(" ".join(days)), _year(years)
        if (day in DAYS or not days) and (year is not None or not years):
            return _written(year, month, day)
    return None


def _without_month(words: list[str]) -> str | None:
    """A year alone, or a day: ``the fifth``."""
    year = _year(words) if words else None
    if year in YEARS:
        return _written(year, None, None)
    said = " ".join(words)
    counted = cardinal(said) is not None  # "fifth" is a day, "five" is not
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
    if folded in _NOON | _MIDNIGHT:
        return "1200p" if folded in _NOON else "1200a"
    if match := re.fullmatch(r"(\d{1,2})(\d{2})", folded):
        return _clock(int(match[1]), int(match[2]), "")
    if match := _CLOCK_JA.fullmatch(folded):
        return _japanese_time(match)
    part = "h" if folded.endswith(" hours") else ""
    folded = folded.removesuffix(" hours")
    if match := _PART.fullmatch(folded):
        folded, said = match["rest"], match["x"].removeprefix("in the ").removeprefix("this ")
        part = _PARTS.get(said, "p")
    if match := _CLOCK.fullmatch(folded):
        return _clock(int(match["h"]), int(match["m"] or 0), part)
    words = folded.removesuffix(" oclock").split()
    return _past(words, part) if _LINKS.keys() & set(words) else _words(words, part)


def _japanese_time(match: re.Match[str]) -> str | None:
    """``午後三時半``."""
    minute = 30 if match["half"] else cardinal(match["m"]) if match["m"] else 0
    hour, part = cardinal(match["h"]), {"午前": "a", "午後": "p"}.get(match["x"] or "", "")
    if hour is None or minute is None:
        return None
    return _clock(12 if part and hour == 0 else hour, minute, part)


def _past(words: list[str], part: str) -> str | None:
    """``half past five``, ``a quarter to six``, ``ten minutes before noon``."""
    at = next(index for index, word in enumerate(words) if word in _LINKS)
    sign, named = _LINKS[words[at]], " ".join(words[at + 1 :])
    minutes = _minutes([word for word in words[:at] if word not in ("a", "minute", "minutes")])
    hour = 12 if named in _NOON | _MIDNIGHT else cardinal(named)
    if minutes is None or not 0 < minutes < 60 or hour is None:
        return None
    part = part or _half_of_day(named, after=sign > 0)
    if sign < 0:
        hour, minutes = hour - 1 or 12, 60 - minutes
    return _clock(hour, minutes, part)


def _half_of_day(named: str, after: bool) -> str:
    """a or p for a time shortly after or before noon or midnight; nothing for other times."""
    if named in _NOON:
        return "p" if after else "a"
    return "" if named not in _MIDNIGHT else "a" if after else "p"


def _words(words: list[str], part: str) -> str | None:
    """``five thirty``, ``oh five hundred``, ``seventeen forty five``."""
    if words[:1] in (["oh"], ["o"], ["zero"]) and len(digits(" ".join(words[1:2])) or "") == 1:
        words = words[1:]
        part = part or ("h" if words[-1] == "hundred" else "")
    hour, rest = _hour(words)
    if len(digits(" ".join(rest)) or "") == 1:  # minutes below ten have a nought: "twenty oh four"
        return None
    minutes = _minutes(rest) if rest else 0
    return None if hour is None or minutes is None else _clock(hour, minutes, part)


def _hour(words: list[str]) -> tuple[int | None, list[str]]:
    """The hour in the first one or two words, and the remaining words."""
    if not words:
        return None, []
    hour, rest = cardinal("zero" if words[0] in ("oh", "o") else words[0]), words[1:]
    if hour is not None and hour >= 20 and rest and (ones := cardinal(rest[0])) and ones < 4:
        return hour + ones, rest[1:]
    return hour, rest


def _minutes(words: list[str]) -> int | None:
    if words in (["half"], ["quarter"]):
        return 30 if words == ["half"] else 15
    if words[:1] in (["oh"], ["o"]):
        words = words[1:]
    if words == ["hundred"]:
        return 0
    return cardinal(" ".join(words))


def _clock(hour: int, minute: int, part: str) -> str | None:
    """A time as written; ``part`` is a, p, h, night, or empty if it was not said."""
    if not 0 <= minute < 60 or not 0 <= hour < 24:
        return None
    if part == "night":
        part = "a" if hour == 12 or hour < 5 else "p"
    if part in ("a", "p") and not 1 <= hour <= 12:
        return None
    return f"{hour:02d}{minute:02d}{part or ('?' if 1 <= hour <= 12 else 'h')}"
