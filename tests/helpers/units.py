"""Units in VoiceXML documents."""

from __future__ import annotations

from prima.errors import DocumentError, Problem
from prima.voicexml.reading import read_page
from tests.helpers.robot import document
from tests.helpers.voice import Call

P = 'xmlns:p="urn:prima:dialogue:1"'
SPEECH = {"speaker", "speech-recognition"}
TOUCHED = '<form id="a"><on event="touch"><speak>Ouch.</speak></on></form>'
"""Another application, which speaks when the robot is touched."""


def unit(
    inner: str, behind: str = "", attributes: str = "", around: str = "", id: str = "a"
) -> str:
    """A form with a unit, and what stands behind and beside it."""
    return f"<form id='{id}' {P}><p:iu {attributes}>{inner}</p:iu>{behind}{around}</form>"


def ask(more: str = "", name: str = "x") -> str:
    """A question."""
    return f"<field name='{name}' type='boolean'><prompt>May I?</prompt>{more}</field>"


def say(text: str) -> str:
    return f"<block>{text}</block>"


PHOTO = unit(
    say("One moment.") + ask("<filled>Thanks.</filled>") + say("Smile!"),
    say("Bye."),
    "longest='20s'",
)


def with_other(text: str) -> Call:
    """A document beside an application that is touched and speaks."""
    return Call(text, document(TOUCHED, name="other"))  # type: ignore[arg-type]


def units(call: Call) -> list[str]:
    """What became of units, in order: ``request``, ``start``, ``end``, ``cancel``, ``fail``."""
    return [r["phase"] for r in call.records if r.get("command") == "iu" and r["phase"] != "select"]


def problems_of(text: str) -> list[Problem]:
    try:
        return list(read_page("app.vxml", "app.vxml", text.encode()).problems)
    except DocumentError as error:
        return error.problems
