"""What this platform says by itself, and cannot do (VoiceXML 2.0, 2.2.4, 2.3.6, 2.3.7, 5.2.5, E)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

FORMATS = frozenset(["audio/basic", "audio/x-alaw-basic", "audio/x-wav", "audio/wav"])
"""Formats in which every platform records (appendix E)."""
TELEPHONE = re.compile(r"tel:\+?[-.() 0-9A-Da-dpw*#]+(;.*)?")
ADDRESS = re.compile(r"sips?:[^\s@]+(@[^\s@]+)?")
UNREAL = re.compile(r"(?:[A-Za-z]|[A-Za-z]{4,8})(?:-.*)?")
"""Tags that no real language has, such as ``x-elvish``: their first part is too short or long."""
WORDS = {
    "en": {
        "help": "There is no help here.",
        "nomatch": "I did not understand.",
        "maxspeechtimeout": "That was too long.",
    },
    "ja": {
        "help": "ヘルプはありません。",
        "nomatch": "わかりませんでした。",
        "maxspeechtimeout": "長すぎます。",
    },
}
"""The first words of the platform's own handlers, by language; nothing in any other language."""


class Unsupported(NamedTuple):
    """The event that refuses something, and why."""

    event: str
    message: str


NO_CHOICES = Unsupported("error.semantic", "there are no choices here to enumerate")


def own_words(lang: str) -> Mapping[str, str]:
    """What the platform's own handlers say in a language, by their events."""
    return WORDS.get(lang.partition("-")[0].lower(), {})


def listens_in(tag: str) -> bool:
    """Whether grammars may be in a language: words are compared, so any real one will do."""
    return UNREAL.fullmatch(tag) is None


def unrecorded(media_type: str) -> Unsupported | None:
    """Why nothing can be recorded in a format (2.3.6; 2.1, 7.2); any is fine if it is empty."""
    name = media_type.partition(";")[0].strip().lower()
    if not name or name in FORMATS:
        return None
    return Unsupported("error.unsupported.format", f'nothing is recorded as "{name}"')


def uncalled(uri: str) -> Unsupported | None:
    """Why a destination cannot be called (2.3.7.3): its scheme, or what it lacks in its scheme."""
    scheme = uri.partition(":")[0].lower()
    known = scheme in ("tel", "sip", "sips")
    if ":" in uri and not known:
        message = f'"{uri}" cannot be called; write "tel:", "sip:" or "sips:"'
        return Unsupported("error.unsupported.uri", message)
    form = TELEPHONE if scheme == "tel" else ADDRESS
    if known and form.fullmatch(scheme + uri[len(scheme) :]) is not None:
        return None
    message = f'"{uri}" is not a telephone number; write it as "tel:+1-555-1234"'
    return Unsupported("error.connection.baddestination", message)
