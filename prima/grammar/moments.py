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
_CLOCK = re.compile(
    r"(?P<h>\d{1,2})(?:[:. ](?P<m>\d{2}))?(?: ?(?:oclock|hours|h))?(?: ?(?P<x>a m|p m|am|pm))?"
)
_CLOCK_JA = re.compile(
    r"(?P<x>午前|午後)?(?P<h>[^時分半]{1,4})時(?:(?P<m>[^時分半]{1,4})分|(?P<half>半))?"
)
_PART = re.compile(
    r"(?P<rest>.*?) ?(?P<x>\b(?:a ?m|p ?m)|in the (?:morning|afternoon|evening)|at night)"
)


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
    """``march third two thousand four``, ``3 march``, ``the third of march``."""
    words = [word for word in words if word not in ("the", "of")]
    at = next((index for index, word in enumerate(words) if word in MONTHS), None)
    if at is None:
        return None
    month, before, after = MONTHS[words[at]], words[:at], words[at + 1 :]
    if before:
        day = ordinal(" ".join(before))
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


def _year(words: list[str]) -> int | None:
    """``2004``, ``two thousand four``, ``nineteen ninety nine``."""
    value = cardinal(" ".join(words))
    if value is not None and 1000 <= value <= 9999:
        return value
    for split in (1, 2):
        high, low = cardinal(" ".join(words[:split])), cardinal(" ".join(words[split:]))
        if words[split : split + 1] in (["oh"], ["o"]):
            low = cardinal(" ".join(words[split + 1 :]))
        if high and low is not None and 10 <= high <= 99 and low <= 99:
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
    if folded in ("noon", "midnight", "正午"):
        return "1200a" if folded == "midnight" else "1200p"
    if match := _CLOCK.fullmatch(folded):
        return _clock(int(match["h"]), int(match["m"] or 0), (match["x"] or "").replace(" ", ""))
    if match := _CLOCK_JA.fullmatch(folded):
        hour, minute = cardinal(match["h"]), cardinal(match["m"]) if match["m"] else 0
        if match["half"]:
            minute = 30
        if hour is None or minute is None:
            return None
        part = {"午前": "am", "午後": "pm"}.get(match["x"] or "", "")
        return _clock(12 if part and hour == 0 else hour, minute, part)
    part = ""
    if match := _PART.fullmatch(folded):
        folded, said = match["rest"], match["x"].replace(" ", "")
        part = "am" if said in ("am", "inthemorning") else "pm"
        if clock := _CLOCK.fullmatch(folded):
            return _clock(int(clock["h"]), int(clock["m"] or 0), part)
    return _words(folded.removesuffix(" oclock").split(), part)


def _words(words: list[str], part: str) -> str | None:
    """``half past five``, ``quarter to six``, ``five thirty``."""
    for link, sign in (("past", 1), ("after", 1), ("to", -1), ("before", -1)):
        if link in words:
            at = words.index(link)
            minutes = _minutes([word for word in words[:at] if word not in ("a", "minutes")])
            hour = cardinal(" ".join(words[at + 1 :]))
            if minutes is None or hour is None:
                return None
            if sign < 0:
                hour, minutes = hour - 1 or 12, 60 - minutes
            return _clock(hour, minutes, part)
    hour = cardinal(words[0]) if words else None
    if hour is None and len(words) > 1:
        return None
    rest = words[1:]
    if hour is not None and hour >= 20 and rest and (ones := cardinal(rest[0])) and ones < 4:
        hour, rest = hour + ones, rest[1:]
    minutes = _minutes(rest) if rest else 0
    return None if hour is None or minutes is None else _clock(hour, minutes, part)


def _minutes(words: list[str]) -> int | None:
    if words in (["half"], ["quarter"]):
        return 30 if words == ["half"] else 15
    if words[:1] in (["oh"], ["o"]):
        words = words[1:]
    if words == ["hundred"]:
        return 0
    return cardinal(" ".join(words))


def _clock(hour: int, minute: int, part: str) -> str | None:
    if not 0 <= minute < 60 or not 0 <= hour < 24:
        return None
    if part:
        return f"{hour:02d}{minute:02d}{part[0]}" if 1 <= hour <= 12 else None
    return f"{hour:02d}{minute:02d}{'?' if 1 <= hour <= 12 else 'h'}"
