"""Which sensors a document looks at: by the first part of their names, as ``position``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from prima.interpreter.elements import Document
from prima.names import GLOBALS, STRANGE, free_names, tokens_of
from prima.script.ecmascript import CONSTANTS

SENSOR = re.compile(r"\bsensor\b(?:\s*\??\.\s*([\w$]+))?")
HIDING = re.compile(
    r"""\bname\s*=\s*["']\s*(?:sensor|undefined|NaN|Infinity)\s*["']"""
    r"""|\bsensor\s*=[^=]|\b(?:var|let|const|function|class)\s+sensor\b"""
)
"""Where a document declares, or a script gives a value to, what conditions take for granted."""
OTHER = frozenset(["application", "document", "dialog", "session", "event", "_event", "_message"])
UNCLEAR = re.compile(
    r"\bapplication\b(?!\s*\??\.\s*(?!valueOf)[\w$]+(?![\w$])(?!\s*[(]))"
    rf"|\bthis\b|{STRANGE}|\beval\b|\\"
)
"""By what code may look at ``sensor`` without saying so."""


NOTHING_READ: frozenset[str] = frozenset()
"""What :func:`sensors_read` gives for a document that depends on no sensor."""


def hides_sensors(document: Document) -> bool:
    """Whether the document may have a variable of its own by a name that conditions look at."""
    return HIDING.search(document.node.source.text) is not None


@lru_cache(maxsize=1000)
def sensors_of(code: str) -> frozenset[str] | None:
    """The sensors that a condition looks at.

    None where it may depend on anything else, or where which ones cannot be told.
    """
    used = {token.text for token in tokens_of(code)}
    found = SENSOR.findall(code)
    if free_names(code) or used & (OTHER | (GLOBALS - CONSTANTS.keys()) - {"sensor"}):
        return None
    return frozenset(found) if found and all(found) else None


def sensors_read(document: Document) -> frozenset[str] | None:
    """All sensors on which what a document does may depend; None where these cannot be told.

    A condition that depends on other things too is looked at whenever any sensor changes, and so is
    what turned true while a subdialog had the place of the form that watches for it.
    """
    if document.sensors is None:
        document.sensors = (_sensors_read(document),)
    return document.sensors[0]


def _sensors_read(document: Document) -> frozenset[str] | None:
    inner = [watch for form in document.forms.values() for watch in form.watches]
    if inner and any(node.tag == "subdialog" for node in document.node.walk()):
        return None
    if (inner or document.watches) and hides_sensors(document):
        return None
    if any(sensors_of(watch.when.code) is None for watch in (*document.watches, *inner)):
        return None
    read: set[str] = set()
    for code in map(_without_texts, _codes(document)):
        found = SENSOR.findall(code)
        if UNCLEAR.search(code) or not all(found):
            return None
        read.update(found)
    return frozenset(read)


def _without_texts(code: str) -> str:
    """Code without what is only said in it; a template may hold code."""
    kept = (one.text for one in tokens_of(code) if not one.text.startswith(("'", '"')))
    return " ".join(kept)


def _codes(document: Document) -> Iterator[str]:
    """All code of a document, with the variables that elements name."""
    for expression in document.expressions:
        yield expression.code
    for node in document.node.walk():
        if node.tag == "script":
            yield node.own_text
        for name in ("name", "namelist"):
            yield node.attributes.get(name, "")
