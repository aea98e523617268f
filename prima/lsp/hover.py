"""Hover: the meaning of a word in a text."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from prima.interpreter.selection import prefixes
from prima.language.commands import TABLE_4_2
from prima.language.values import KINDS
from prima.lsp.descriptions import EVENTS, RULES, SESSION, VOICEXML_ATTRIBUTES, VOICEXML_EVENTS
from prima.lsp.names import FoundName, Mark, mark_at
from prima.lsp.scan import ScannedTag
from prima.lsp.workspace import Workspace
from prima.markup.vocabulary import Attribute, Element, attributes_by_name

NAMED = re.compile(r"\b([A-Z][0-9])\b")
MOST_LETTERS = 200
"""Maximum length of a line of a document that is shown."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """Markdown about a piece of the text."""

    text: str
    start: int
    end: int


def hover(workspace: Workspace, path: Path, offset: int) -> Meaning | None:
    """The meaning of the word at an offset, or None."""
    text = workspace.text(path)
    if text is None or text.page.aside(offset):
        return None
    page = text.page
    for start, end, _ in page.ends:
        if start <= offset <= end:
            tag = next((one for one in page.tags if one.close == (start, end)), None)
            return _element(tag, start, end)
    tag = page.tag_at(offset) or page.tag_at(offset + 1)
    if tag is not None and tag.start <= offset <= tag.name_end:
        return _element(tag, tag.start + 1, tag.name_end)
    mark = mark_at(text.marks, offset)
    if mark is not None:
        return Meaning(_name(workspace, path, mark), mark.start, mark.end)
    return _attribute(tag, offset) if tag is not None else None


def _element(tag: ScannedTag | None, start: int, end: int) -> Meaning | None:
    element = tag.element if tag is not None else None
    return Meaning(element_text(element), start, end) if element is not None else None


def element_text(element: Element) -> str:
    """The description of an element: meaning, source, rules and attributes."""
    lines = [f"**`<{element.tag}>`** {element.doc}"]
    if element.source:
        lines.append(f"*{_source(element.source)}*")
    for rule in NAMED.findall(element.source):
        if rule in RULES:
            lines.append(f"**{rule}** {RULES[rule]}")
    shown = [f"`{item.name}`" + ("*" if item.required else "") for item in element.attributes]
    if shown:
        lines.append("Attributes: " + ", ".join(shown))
    return "\n\n".join(lines)


def _source(source: str) -> str:
    return f"VoiceXML {source}" if source[:1].isdigit() else source


def _attribute(tag: ScannedTag, offset: int) -> Meaning | None:
    for attr in tag.attributes:
        if attr.start <= offset <= max(attr.end, attr.last) and tag.element is not None:
            text = attribute_text(tag.element, attr.name)
            return Meaning(text, attr.start, attr.end) if text else None
    return None


def attribute_text(element: Element, name: str) -> str:
    """The description of an attribute: meaning, kind, default and bounds."""
    item, expression = attributes_by_name(element).get(name, (None, False))
    if item is None:
        return ""
    words = item.doc or VOICEXML_ATTRIBUTES.get(item.name, "")
    if expression:
        return f"**`{name}`** An expression that gives {item.name}: {words}."
    kind = ", ".join(f"`{one}`" for one in item.choices) or KINDS[item.kind].doc
    lines = [f"**`{name}`** {words[:1].upper()}{words[1:]}{'.' if words else ''}"]
    lines.append(("Required. " if item.required else "") + f"Value: {kind}.")
    if bounds := _bounds(item):
        lines.append(f"Bounds: {bounds}.")
    if item.default:
        lines.append(f"Default: `{item.default}`.")
    if item.dynamic:
        lines.append(f"Or `{item.name}-expr` with an expression.")
    return "\n\n".join(lines)


def _bounds(item: Attribute) -> str:
    low = "" if item.low is None else f"from {_bound(item.kind, item.low)}"
    high = "" if item.high is None else f"up to {_bound(item.kind, item.high)}"
    return f"{low} {high}".strip()


def _bound(kind: str, value: float) -> str:
    if kind != "duration":
        return f"{value:g}"
    return f"{value / 1000:g}s" if value >= 1000 else f"{value:g}ms"


def _name(workspace: Workspace, path: Path, mark: Mark) -> str:
    """A name and its declarations."""
    lines = [f"**{mark.kind[0]} `{mark.name}`**"]
    known = _known(mark)
    if known:
        lines.append(known)
    given = workspace.given(path, mark)
    lines += [_declaration(workspace, path, found) for found in given[:5]]
    if not given and not known:
        lines.append("Nothing here declares it.")
    return "\n\n".join(lines)


def _known(mark: Mark) -> str:
    """The description of a predefined name."""
    if mark.kind == ("variable",):
        return SESSION.get(mark.name, "")
    if mark.kind == ("command",) and mark.name in TABLE_4_2:
        row = TABLE_4_2[mark.name]
        return f"{row.title}. {row.doc} Devices: {', '.join(sorted(row.devices))}."
    if mark.kind == ("event",):
        described = VOICEXML_EVENTS | EVENTS
        longest_first = reversed(prefixes(mark.name))
        return next((described[one] for one in longest_first if one in described), "")
    return ""


def _declaration(workspace: Workspace, path: Path, found: FoundName) -> str:
    text = workspace.text(found.path)
    if text is None:
        return ""
    line, _ = text.page.lines.position(found.mark.start)
    tag = found.mark.tag
    shown = " ".join(text.text[tag.start : tag.end].split())[:MOST_LETTERS]
    shown = shown.replace("`", "'")
    file = "" if found.path == path else f"{found.path.name}, "
    form = tag.inside("form", "menu")
    of = f" of the form `{form.get('id')}`" if form is not None and form is not tag else ""
    return f"Declared in {file}line {line + 1}{of}:\n\n```xml\n{shown}\n```"
