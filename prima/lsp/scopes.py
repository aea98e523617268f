"""What a place in a document can use: variables, and events that reach a handler."""

from __future__ import annotations

from collections.abc import Iterable

from prima.interpreter.events import OWN
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2
from prima.lsp.descriptions import SESSION
from prima.lsp.names import Mark, dialect
from prima.lsp.scan import ScannedTag, ScannedText
from prima.script.globals import HANDLED
from prima.voicexml.arranging import UNIT

HANDLERS = ("on", "catch", "error", "help", "noinput", "nomatch")
CONTENT = ("block", "filled", *HANDLERS)
"""Elements with content that has variables of its own."""
NO_ITEMS = ("var", "foreach", "said-foreach", "script", "data")
"""Elements that declare variables and are not form items."""
UNFIT = {
    ("goto", "nextitem"): NO_ITEMS,
    ("filled", "namelist"): (*NO_ITEMS, "block", "initial", UNIT),
}
"""Elements whose variables do not fit an attribute, by element and attribute."""


def visible(
    marks: Iterable[Mark], tag: ScannedTag, attribute: str = "", of: str = ""
) -> dict[str, str]:
    """Variables visible in an element, with their declarations, or those that fit an attribute.

    ``marks`` are those of the document; ``of`` is ``dialog`` or ``document`` for members of
    that scope alone.
    """
    form, unfit = tag.inside("form", "menu"), UNFIT.get((tag.key, attribute), ())
    home, content = form.start if form else -1, None if of else _content_of(tag)
    scopes = {"dialog": {home} - {-1}, "document": {-1}}.get(of, {home, -1})
    found: dict[str, str] = {}
    for mark in marks:
        if not (mark.defines and mark.kind == ("variable",) and mark.scope in scopes):
            continue
        if mark.tag.key not in unfit and _content_of(mark.tag) in (None, content):
            owner = form.get("id") if form and mark.scope == home else "the document"
            found.setdefault(mark.name, f"<{mark.tag.name}> of {owner}")
    return found


def given(page: ScannedText, tag: ScannedTag) -> dict[str, str]:
    """The predefined variables that there are in an element."""
    absent = set() if tag.inside(*HANDLERS) else {*HANDLED}
    if dialect(page) == "voicexml":
        absent.add("event")
    if not any(one.key == "watch" for one in page.tags):
        absent.add("sensor")
    return {name: text for name, text in SESSION.items() if name not in absent}


def reaches(event: str, handler: ScannedTag) -> bool:
    """Whether an event may reach a handler.

    One in a Command takes events of the Command itself; in a unit no more than its errors.
    """
    command = handler.parent if handler.key == "on" else None
    if command is None or command.key not in TABLE_4_2:
        return True
    own = () if command.inside("iu") else OWN
    return takes("error", event) or any(takes(event, f"{kind}.{command.key}") for kind in own)


def _content_of(tag: ScannedTag) -> ScannedTag | None:
    """The element whose content an element is in, if any: the variables of that are gone after it."""
    return tag.parent.inside(*CONTENT) if tag.parent else None
