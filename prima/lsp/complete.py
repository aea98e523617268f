"""Completion."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html import escape
from pathlib import Path

from prima.language.commands import DEVICES, TABLE_4_2
from prima.lsp.descriptions import EVENTS, VOICEXML_EVENTS
from prima.lsp.hover import attribute_text, element_text
from prima.lsp.meanings import DEFINES, EVENTS_OF, FILES, REFERS, ReferenceUse
from prima.lsp.names import FoundName, dialect
from prima.lsp.paths import name_for
from prima.lsp.scan import Attr, ScannedTag, ScannedText
from prima.lsp.scopes import given, reaches, visible
from prima.lsp.snippets import opening, snippet
from prima.lsp.tables import BY_NAMESPACE, children, is_code, roots, values
from prima.lsp.workspace import Text, Workspace
from prima.markup.vocabulary import attributes_by_name

MOST = 500
"""Maximum number of proposals."""
END_TAG = re.compile(r"</([^\s<>]*)$")
END_TAG_AFTER = re.compile(r"[^\s<>]*>")
IS = re.compile(r"\s*=")
"""What follows the name of an attribute that has a value."""
WORD_BEFORE = re.compile(r"(?:(?P<of>[\w$.]+)\.)?(?P<word>(?:[^\W\d]|\$)[\w$]*)?$")
WORD_AFTER = re.compile(r"[\w$]*")
MEMBERS = {
    "dialogue": {
        "event": ("name", "data", "message"),
        "session": ("time",),
        "$": ("utterance", "confidence"),
    },
    "voicexml": {
        "session": ("connection", "event"),
        "application": ("lastresult$",),
        "$": ("utterance", "confidence", "inputmode", "interpretation"),
    },
}
"""Members of variables, by vocabulary; ``$`` stands for an item's result."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """A proposal that replaces a piece of the text.

    ``kind`` is ``element``, ``attribute``, ``value``, ``name``, ``variable``, ``event``,
    ``file`` or ``text``; in a ``snippet``, ``$1`` and ``$0`` are tab stops.
    """

    label: str
    kind: str
    start: int
    end: int
    insert: str = ""
    snippet: str = ""
    detail: str = ""
    doc: str = ""


def complete(workspace: Workspace, path: Path, offset: int, typed: str = "") -> list[Proposal]:
    """Proposals at an offset; ``typed`` is the character that triggered the request."""
    text = workspace.text(path)
    if text is None or text.page.aside(offset):
        return []
    return list(_Completion(workspace, path, text, offset, typed).proposals())[:MOST]


class _Completion:
    """One completion request."""

    def __init__(
        self, workspace: Workspace, path: Path, text: Text, offset: int, typed: str
    ) -> None:
        self.workspace, self.path, self.text = workspace, path, text
        self.page: ScannedText = text.page
        self.offset, self.typed = offset, typed

    def proposals(self) -> Iterator[Proposal]:
        """The proposals that fit the place."""
        tag = self.page.tag_at(self.offset)
        if tag is None:
            return self._content()
        if self.offset <= tag.name_end:
            return self._elements(tag.parent, tag.start + 1, tag.name_end, tag)
        for attr in tag.attributes:
            if attr.first >= 0 and attr.first <= self.offset <= attr.last:
                return self._value(tag, attr)
            if attr.start <= self.offset <= attr.end:
                return self._attributes(tag, attr.start, attr.end, attr)
        if self.page.text[self.offset - 1].isspace():
            return self._attributes(tag, self.offset, self.offset, None)
        return iter(())

    # Elements -----------------------------------------------------------------

    def _content(self) -> Iterator[Proposal]:
        """Between tags: an end tag, names in a script, or a new element."""
        ending = END_TAG.search(self.page.text, max(0, self.offset - 200), self.offset)
        if ending is not None:
            around = self.page.around(ending.start())
            if around is not None:
                after = END_TAG_AFTER.match(self.page.text, self.offset)
                start, end = ending.start(1), after.end() if after else self.offset
                yield Proposal(f"/{around.name}", "element", start, end, f"{around.name}>")
            return
        around = self.page.around(self.offset)
        if around is not None and around.key == "script":
            yield from self._variables(around, self.page.text[around.end : self.offset])
        elif self.typed in ("", "<") and self.page.text[self.offset - 1 : self.offset] != "<":
            yield from self._elements(around, self.offset, self.offset, None)

    def _elements(
        self, parent: ScannedTag | None, start: int, end: int, tag: ScannedTag | None
    ) -> Iterator[Proposal]:
        """Elements allowed in another; ``tag`` is the unfinished element there, if any."""
        if parent is None and not self._may_be_root(tag):
            return
        begin = "" if tag is not None else "<"
        alone = tag is None or not (tag.attributes or tag.finished)
        choices, whole = (children(parent), snippet) if parent else (roots(), opening)
        for choice in choices:
            yield Proposal(
                choice.name,
                "element",
                start,
                end,
                begin + choice.name,
                begin + whole(choice) if alone else "",
                choice.element.source,
                element_text(choice.element),
            )
        if parent and tag and alone:
            yield Proposal(f"/{parent.name}", "element", start, end, f"/{parent.name}>")

    def _may_be_root(self, tag: ScannedTag | None) -> bool:
        """Whether an unfinished element, or one yet to be written, can be the root."""
        return not self.page.tags or tag in (self.page.tags[0], self.page.root)

    def _attributes(
        self, tag: ScannedTag, start: int, end: int, now: Attr | None
    ) -> Iterator[Proposal]:
        if (element := tag.element) is None:
            return
        given = {attr.name for attr in tag.attributes if attr is not now}
        bare = IS.match(self.page.text, end) is None
        for name, (item, _) in attributes_by_name(element).items():
            forms = {item.name, f"{item.name}-expr"} if item.dynamic else {name}
            if given.isdisjoint(forms):
                detail = "required" if item.required else ""
                yield _attribute(name, start, end, bare, detail, attribute_text(element, name))
        for name in ("xmlns", "xml:lang") if tag.parent is None else ():
            if name not in given:
                yield _attribute(name, start, end, bare)

    # Values -------------------------------------------------------------------

    def _value(self, tag: ScannedTag, attr: Attr) -> Iterator[Proposal]:
        vocabulary, element = tag.vocabulary, tag.element
        if attr.name == "xmlns" or attr.name.startswith("xmlns:"):
            yield from self._plain(attr, [*BY_NAMESPACE])
            return
        if vocabulary is None or element is None:
            return
        key = (vocabulary.name, tag.key, attr.name)
        yield from self._plain(attr, values(vocabulary, element, attr.name))
        if is_code(tag, attr.name):
            yield from self._variables(tag, self.page.text[attr.first : self.offset])
        elif key in REFERS:
            yield from self._references(tag, attr, REFERS[key])
        elif DEFINES.get(key) == "event":
            yield from self._events(tag, attr, own=True)
        if key in FILES:
            yield from self._files(attr, FILES[key])
        if attr.name == "xml:lang" or key == ("robot", "voice", "lang"):
            yield from self._plain(attr, ("en", "ja"))
        if key[1:] == ("param", "name"):
            yield from self._plain(attr, self._parameters(tag))

    def _span(self, attr: Attr, words: bool = False) -> tuple[int, int]:
        """The part of a value that a proposal replaces: all of it, or the word at the offset."""
        start, end = attr.first, attr.last if attr.closed else self.offset
        if words:
            before = self.page.text[start : self.offset]
            start = self.offset - len(before.split(" ")[-1])
            after = self.page.text.find(" ", self.offset, end)
            end = after if after >= 0 else end
        return start, end

    def _plain(self, attr: Attr, words: Iterable[str]) -> Iterator[Proposal]:
        start, end = self._span(attr)
        for word in words:
            yield Proposal(word, "value", start, end, escape(word))

    def _references(self, tag: ScannedTag, attr: Attr, use: ReferenceUse) -> Iterator[Proposal]:
        if use.kinds == ("event",):
            yield from self._events(tag, attr)
            return
        if use.kinds == ("variable",):
            span = self._span(attr, use.how == "list")
            for name, detail in visible(self.text.marks, tag, attr.name).items():
                yield Proposal(name, "variable", *span, name, detail=detail)
            return
        if use.kinds == ("command",):
            yield from self._commands(tag, attr)
            return
        yield from self._defined(tag, attr, use)
        if use.kinds == ("device",) and not self._known(self.path, use.kinds, tag):
            yield from self._plain(attr, DEVICES)

    def _defined(self, tag: ScannedTag, attr: Attr, use: ReferenceUse) -> Iterator[Proposal]:
        """Names that documents define, in the notation of a reference."""
        path, sign, start = self.path, "", self._span(attr, use.how == "list")
        if use.how in ("#", "uri"):
            file, sign, _ = attr.value.partition("#")
            sign = f"{file}#"
            target = self.workspace.target(self.path, file) if file and use.how == "uri" else None
            path = target or self.path
        elif use.how == "fixed:":
            sign = use.how
        for found in self._known(path, use.kinds, tag):
            name = found.mark.name
            insert = sign + escape(name)  # the sign is written there already
            yield Proposal(sign + name, "name", *start, insert, "", self._where(found))
        for name in self.workspace.called(path) if use.kinds == ("application",) else ():
            yield Proposal(sign + name, "name", *start, sign + name)

    def _known(self, path: Path, kinds: tuple[str, ...], tag: ScannedTag) -> list[FoundName]:
        if kinds == ("form",) and tag.key in ("expect", "never"):
            return self.workspace.forms(path, tag.get("by"))
        found = self.workspace.known(path, kinds)
        if kinds == ("rule",) and path == self.path:
            grammar = tag.inside("grammar")
            home = grammar.start if grammar else -1
            found = [one for one in found if one.mark.scope == home]
        return found

    def _events(self, tag: ScannedTag, attr: Attr, own: bool = False) -> Iterator[Proposal]:
        """Events that may occur, or with ``own`` those that this document handles."""
        known = self._occurring(tag)
        for found in self.workspace.known(self.path, ("event",)):
            known.setdefault(found.mark.name, self._where(found))
        for mark in self.text.marks if own else ():
            if mark.kind == ("event",) and mark.start != attr.first:
                known.setdefault(mark.name, "handled here")
        span = self._span(attr, True)
        for name, doc in known.items():
            if reaches(name, tag) and (name != attr.value or not own):
                yield Proposal(name, "event", *span, name, doc=doc)

    def _occurring(self, tag: ScannedTag) -> dict[str, str]:
        """Events of the language, the robot and its services."""
        voice = dialect(self.page) == "voicexml"
        known = dict(VOICEXML_EVENTS | EVENTS if voice else EVENTS)
        for begin, kind in EVENTS_OF.items():
            for found in self.workspace.known(self.path, (kind,)):
                known.setdefault(f"{begin}.{found.mark.name}", self._where(found))
        if tag.parent is not None and tag.parent.key in TABLE_4_2:
            for begin in ("end.", "cancel."):
                known[begin + tag.parent.key] = EVENTS[begin[:-1]]
        return known

    def _commands(self, tag: ScannedTag, attr: Attr) -> Iterator[Proposal]:
        span = self._span(attr)
        for found in self.workspace.known(self.path, ("command",)):
            name = found.mark.name
            yield Proposal(name, "name", *span, name, detail=self._where(found))
        if tag.key != "command":
            for row in TABLE_4_2.values():
                yield Proposal(row.name, "name", *span, row.name, detail=row.title, doc=row.doc)

    def _parameters(self, tag: ScannedTag) -> list[str]:
        """Names for a param: arguments of an added Command, variables of a form."""
        holder = tag.parent
        if holder is None:
            return []
        found: list[ScannedTag] = []
        called = holder.get("src").strip()
        if holder.key == "subdialog" and called[:1] == "#":
            forms = self.page.forms.get(called[1:], ())
            found = [one for form in forms for one in form.children if one.key == "var"]
        elif holder.key == "command":
            found = self._arguments(holder.get("type"))
        return [name for one in found if (name := one.get("name"))]

    def _arguments(self, command: str) -> list[ScannedTag]:
        """The arguments of an added Command."""
        known = self.workspace.known(self.path, ("command",))
        tags = [one.mark.tag for one in known if one.mark.name == command]
        return [child for tag in tags for child in tag.children if child.key == "argument"]

    def _files(self, attr: Attr, wanted: tuple[str, ...]) -> Iterator[Proposal]:
        """Documents of the workspace, as paths relative to this one."""
        span, folder = self._span(attr), self.path.parent
        uris = self.workspace.has_uris(self.path)
        for path in self.workspace.files():
            text = self.workspace.text(path)
            if path == self.path or text is None:
                continue
            if wanted and dialect(text.top) not in wanted:
                continue
            try:
                name = name_for(path, folder, uris)
            except ValueError:  # another drive
                continue
            yield Proposal(name, "file", *span)

    def _where(self, found: FoundName) -> str:
        """Where a name is defined, as text."""
        tag = found.mark.tag
        title = tag.get("title")
        at = "" if found.path == self.path else f" in {found.path.name}"
        return f"<{tag.name}>{at}{f': {title}' if title else ''}"

    # Variables ------------------------------------------------------------------

    def _variables(self, tag: ScannedTag, before: str) -> Iterator[Proposal]:
        match = WORD_BEFORE.search(before[-200:])
        after = WORD_AFTER.match(self.page.text, self.offset)
        word = (match["word"] or "") if match else ""
        start, end = self.offset - len(word), after.end() if after else self.offset
        of = match["of"] if match else None
        known: dict[str, str] = {}
        if of is None:
            known = visible(self.text.marks, tag) | given(self.page, tag)
        elif of in ("dialog", "document"):
            known = visible(self.text.marks, tag, of=of)
        elif of == "sensor":
            readings = self.workspace.known(self.path, ("reading",))
            known = {one.mark.name: self._where(one) for one in readings}
        else:
            members = MEMBERS.get(dialect(self.page), {})
            known = dict.fromkeys(members.get("$" if of.endswith("$") else of, ()), of)
        for name, detail in known.items():
            yield Proposal(name, "variable", start, end, name, detail=detail)


def _attribute(
    name: str, start: int, end: int, bare: bool, detail: str = "", doc: str = ""
) -> Proposal:
    """An attribute; ``bare`` if it needs a value."""
    insert, snippet = (f'{name}=""', f'{name}="$1"$0') if bare else (name, "")
    return Proposal(name, "attribute", start, end, insert, snippet, detail, doc)
