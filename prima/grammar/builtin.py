"""The built-in types of VoiceXML 2.0 (Appendix P), for voice and for keys.

Their values are in the appendix's format: ``true``, ``19990204``, ``USD10.50``, ``0530p``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Literal
from urllib.parse import unquote

from prima.errors import one_of, suggestion
from prima.grammar import dates
from prima.grammar.assent import assent
from prima.grammar.model import BuiltIn
from prima.grammar.numbers import cardinal, dialled, digits, number
from prima.grammar.text import AROUND, fold, wide

if TYPE_CHECKING:
    from prima.messages import Json

CURRENCIES = {
    "$": "USD", "dollar": "USD", "dollars": "USD", "buck": "USD", "bucks": "USD",
    "€": "EUR", "euro": "EUR", "euros": "EUR", "£": "GBP", "pound": "GBP", "pounds": "GBP",
    "pound sterling": "GBP", "pounds sterling": "GBP", "¥": "JPY", "yen": "JPY", "円": "JPY",
    "ドル": "USD", "ユーロ": "EUR", "swiss franc": "CHF", "swiss francs": "CHF", "yuan": "CNY",
    "rupee": "INR", "rupees": "INR", "indian rupees": "INR", "mexican peso": "MXN",
    "mexican pesos": "MXN", "korean won": "KRW", "won": "KRW", "british pounds": "GBP",
}  # fmt: skip
"""Currencies by their signs and names, with their codes (ISO 4217)."""
CURRENCIES |= {
    f"{nation} {unit}": code
    for nation, code in (
        *(("us", "USD"), ("u s", "USD"), ("american", "USD"), ("canadian", "CAD")),
        *(("australian", "AUD"), ("new zealand", "NZD"), ("hong kong", "HKD")),
    )
    for unit in ("dollar", "dollars")
}
CURRENCIES |= {code.lower(): code for code in CURRENCIES.values()}
MOST_WORDS = 20
"""Maximum number of words of an amount of money without a currency."""
PARTS = {"cent": "", "cents": "", "penny": "", "pennies": "", "pence": "GBP", "p": "GBP",
         "セント": ""}  # fmt: skip
"""Hundredths, with the currency if they imply one."""


class Conflict(ValueError):
    """Parameters of a built-in type that exclude each other."""


class WrongParameter(ValueError):
    """A parameter that a built-in type does not have, or that is of another kind."""

    def __init__(self, message: str, remedy: str) -> None:
        super().__init__(message)
        self.remedy = remedy


COURTESY = re.compile(
    r"^\W*please\b[\s,]*"
    r"|(?<![\s,、])[\s,、]*+(?:\b(?:please|thanks|thank you|bitte|danke|merci|por favor|gracias|per favore|grazie"
    r"|s['’]?il (?:vous|te) pla[iî]t)|を?お願いします|です)[\s.!。]*$",
    re.IGNORECASE,
)
"""Words of courtesy before or after a value."""
LENGTHS = ("length", "minlength", "maxlength")
PARAMETERS = {"digits": LENGTHS, "boolean": ("y", "n")}
"""The parameters of the types that have any."""
_URI = re.compile(r"(?:builtin:(?:(?:grammar|voice|dtmf)/)?)?([\w-]+)(?:\?(.*))?", re.DOTALL)
_EXTENSION = re.compile(r" ?(?:\bextension\b|\bext\b|(?:\b|(?<=\d))x(?=\d|\b)|内線) ?")
_JOINED = re.compile(r"(?<=\d)[.,:](?=\d)")
"""A sign between digits of a telephone number."""
_MONEY = re.compile(r"([$€£¥]|[A-Za-z]{3})?\s*([0-9][0-9.,]*)\s*([$€£¥]|[A-Za-z]{3})?")
_LOST_SIGN = re.compile(r"[$€£¥\u20a0-\u20bf]|(?<!\w)[-\u2212]\s*[0-9]")
"""A currency or a minus that folding removes."""
_UNIT = re.compile(
    "|".join(
        rf"\b{name}\b" if name.isascii() else name
        for name in sorted(CURRENCIES, key=len, reverse=True)
        if name.isalpha() or " " in name
    )
)
_POINT_FIRST = re.compile(r"(?<![0-9])\.(?=[0-9])")

Reader = Callable[[dict[str, str], str, str, str], "Json"]
"""Parameters, language, text and mode to value; None if it does not match."""


def built_in(uri: str, lang: str) -> BuiltIn:
    """The built-in type that a URI names.

    Raises:
        ValueError: the type or its parameters are unknown.
    """
    match = _URI.fullmatch(uri)
    name = match[1] if match else ""
    if match is None or name not in TYPES:
        raise ValueError(f'There is no built-in type "{uri[:80]}".')
    given = _parameters(name, match[2] or "")
    read = partial(_READERS[name], given, lang.split("-")[0].lower())
    return BuiltIn(name, partial(_read, read), partial(_open, name, given))


def _read(read: Callable[[str, str], Json], text: str, mode: str) -> Json:
    """The value of an utterance, or else of what is left without words of courtesy."""
    value = read(text, mode)
    if value is not None or mode == "dtmf":
        return value
    bare = COURTESY.sub("", text)
    return read(bare, mode) if bare != text else None


def uri_mode(uri: str) -> Literal["voice", "dtmf", ""]:
    """The mode that the URI of a built-in type names; empty if it names none."""
    kind, mark, _ = uri.partition("?")[0].removeprefix("builtin:").partition("/")
    if not mark or not uri.startswith("builtin:"):
        return ""
    return "dtmf" if kind == "dtmf" else "voice"


def _parameters(name: str, text: str) -> dict[str, str]:
    given: dict[str, str] = {}
    for piece in filter(None, re.split("[;&]", text)):
        key, _, value = unquote(piece).partition("=")
        given[key.strip()] = value.strip()
    known = PARAMETERS.get(name, ())
    for key, value in given.items():
        if key not in known:
            message = f'The built-in type {name} has no parameter "{key[:40]}".'
            raise WrongParameter(message, suggestion(key, known).text or _without(name, key, value))
        if name == "digits" and re.fullmatch("[0-9]{1,4}", value) is None:
            message = f'{key} is a number of digits, not "{value[:40]}".'
            raise WrongParameter(message, f"Write a whole number up to 9999, such as {key}=4.")
        if name == "boolean" and re.fullmatch("[0-9*#A-D]", value) is None:
            message = f'{key} is one key, not "{value[:40]}".'
            raise WrongParameter(message, "Write one key: 0 to 9, *, # or A to D.")
    if name == "digits":
        _check_lengths(given)
    elif name == "boolean" and given.get("y", "1") == given.get("n", "2"):
        raise Conflict("y and n are one key.")
    return given


def _without(name: str, key: str, value: str) -> str:
    """The remedy for a parameter that a type does not have."""
    if name in PARAMETERS:
        return f"Write {one_of(PARAMETERS[name])}."
    if key in LENGTHS:
        return f'Only digits has it: write "digits?{key}={value[:40]}".'
    return "Remove it: only boolean and digits have parameters."


def _check_lengths(given: dict[str, str]) -> None:
    low, high = _lengths(given)
    if "length" in given and len(given) > 1:
        raise Conflict("length excludes minlength and maxlength.")
    if low > high:
        raise Conflict("minlength is more than maxlength.")


def _lengths(given: dict[str, str]) -> tuple[int, int]:
    if "length" in given:
        return int(given["length"]), int(given["length"])
    return int(given.get("minlength", "1")), int(given.get("maxlength", "9999"))


def _open(name: str, given: dict[str, str], text: str, mode: str) -> bool:
    """Whether more may follow."""
    if mode != "dtmf":
        return True
    most = {"boolean": 1, "date": 8, "time": 4}.get(name)
    if name == "digits":
        most = _lengths(given)[1]
    only = "0123456789*" if name in ("number", "currency", "phone") else "0123456789"
    return set(text) <= set(only) and (most is None or len(text) < most)


# Types


def _boolean(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf":
        pressed = {given.get("y", "1"): True, given.get("n", "2"): False}
        return pressed.get(text.strip())
    return assent(fold(text), lang)


def _digits(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    found = _keys(text) if mode == "dtmf" else digits(fold(text))
    low, high = _lengths(given)
    return found if found and found.isdigit() and low <= len(found) <= high else None


def _keys(text: str) -> str:
    return text.replace(" ", "")


def _number(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf":
        whole, part = _decimal_keys(text)
        return f"{whole}.{part}" if part else whole or None
    plain = _POINT_FIRST.sub("0.", wide(text).strip(AROUND).replace("\u2212", "-"))
    sign = plain[0] if plain[:1] in ("-", "+") else ""
    return number(f"{sign}{fold(plain)}")


def _decimal_keys(text: str) -> tuple[str, str]:
    """The digits of a number in keys before and after its point, which is ``*``, if it is one."""
    match = re.fullmatch(r"([0-9]*)(?:\*([0-9]*))?", _keys(text))
    if match is None or not (match[1] or match[2]):
        return "", ""
    return _plain(match[1]), match[2] or ""


def _plain(figures: str) -> str:
    """Digits without needless zeros."""
    return figures.lstrip("0") or "0"


def _currency(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf":
        whole, part = _decimal_keys(text)
        return f"{whole}.{part:0<2}" if whole and len(part) <= 2 else None
    plain = _POINT_FIRST.sub("0.", wide(text).strip(AROUND).rstrip(".。"))
    plain = plain.replace("¢", " cents")
    if match := _MONEY.fullmatch(plain):
        return _written_money(match)
    return None if _LOST_SIGN.search(plain) else _spoken_money(fold(plain))


def _written_money(match: re.Match[str]) -> str | None:
    """``$12.50``, ``EUR 3``."""
    unit = (match[1] or match[3] or "").lower()
    code = CURRENCIES.get(unit)
    main, cents = _amount(match[2])
    if (unit and code is None) or (match[1] and match[3]) or main is None or cents is None:
        return None
    return f"{code or ''}{main}.{cents:02d}"


def _spoken_money(said: str) -> str | None:
    """``twelve dollars and fifty cents``, ``500円``, ``twelve fifty``, ``fifty cents``."""
    unit = _UNIT.search(said)
    if unit is None:
        return _small_money(said) or _bare_money(said)
    code, tail = CURRENCIES[unit[0]], said[unit.end() :].strip()
    main, cents = _amount(said[: unit.start()].strip())
    if main is None or cents is None:
        return None
    if tail:
        found = _before(tail.removeprefix("and ").strip(), PARTS)
        found = cardinal(tail.removeprefix("and ")) if found is None else found
        if found is None or found > 99 or cents:
            return None
        cents = found
    return f"{code}{main}.{cents:02d}"


def _amount(said: str) -> tuple[int | None, int | None]:
    """A number before the name of a currency: whole units, and hundredths."""
    whole = "1" if said in ("a", "an") else number(said)
    if whole is None or whole[0] in "+-":
        return None, None
    main, _, part = whole.partition(".")
    return int(main), int(f"{part:0<2}") if len(part) <= 2 else None


def _small_money(said: str) -> str | None:
    """``fifty cents``, ``twenty pence``."""
    cents = _before(said, PARTS)
    if cents is None:
        return None
    code = next(code for part, code in PARTS.items() if said.endswith(part))
    return f"{code}{cents // 100}.{cents % 100:02d}"


def _bare_money(said: str) -> str | None:
    """``twelve``, ``twelve fifty``: no currency was said."""
    main, cents = _amount(said)
    words = said.split()
    for at in range(1, min(len(words), MOST_WORDS)):
        if main is not None:
            break
        low = words[at:]
        rest = cardinal(" ".join(low[1:] if low[0] in ("oh", "o") else low))
        if rest is not None and (rest >= 10) == (low[0] not in ("oh", "o")) and rest <= 99:
            main, cents = cardinal(" ".join(words[:at])), rest
    return None if main is None or cents is None else f"{main}.{cents:02d}"


def _before(said: str, words: Iterable[str]) -> int | None:
    """The number before one of the words, which ends the text."""
    for word in words:
        if said.endswith(word):
            head = said.removesuffix(word)
            if head.endswith(" ") or not word.isascii() or head.isdigit():
                return 1 if head.strip() == "a" else cardinal(head.strip())
    return None


def _phone(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf":
        match = re.fullmatch(r"[0-9]+(?:\*[0-9]+)?", _keys(text))
        return match[0].replace("*", "x") if match else None
    parts = _EXTENSION.split(fold(_JOINED.sub(" ", text.lower())))
    read = [digits(part.strip()) or dialled(part.strip()) for part in parts]
    if len(parts) > 2 or any(one is None for one in read):
        return None
    return "x".join(one for one in read if one)


def _date(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf" and re.fullmatch("[0-9]{8}", _keys(text)) is None:
        return None
    return dates.date(_keys(text) if mode == "dtmf" else text, fold(text))


def _time(given: dict[str, str], lang: str, text: str, mode: str) -> Json:
    if mode == "dtmf":
        pressed = _keys(text)
        found = re.fullmatch("[0-9]{4}", pressed)
        return dates.time(f"{pressed[:2]}:{pressed[2:]}") if found else None
    return dates.time(fold(text))


_READERS: dict[str, Reader] = {
    "boolean": _boolean,
    "currency": _currency,
    "date": _date,
    "digits": _digits,
    "number": _number,
    "phone": _phone,
    "time": _time,
}
TYPES = tuple(_READERS)
"""The names of the types; checks, editors and the interpreter read them here."""
