"""Names in a text: definitions and uses."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.lsp.meanings import DEFINES, REFERS, SHARED, ReferenceUse
from prima.lsp.scan import Attr, ScannedTag, ScannedText
from prima.lsp.tables import is_code
from prima.script.globals import GLOBALS, RESERVED
from prima.script.names import Use, expression_names, script_names

ENTITY = re.compile(r"&(?:lt|gt|amp|quot|apos|#[0-9]{1,7}|#x[0-9a-fA-F]{1,6});")
LETTERS = {"&lt;": "<", "&gt;": ">", "&amp;": "&", "&quot;": '"', "&apos;": "'"}
WORD = re.compile(r"\S+")
OF_DOCUMENT = ("document", "application")
"""Objects whose members are variables of the document."""
KNOWN = RESERVED | GLOBALS
SCRIPTED = "semantics/1.0"
"""The format of tags that are scripts."""
RESULTS = ("rules", "meta")
"""Objects whose members are the results of rules."""
WITH_RESULTS = ("field", "initial", "record", "subdialog", "transfer", "object")
"""Items with a second variable, whose name has a ``$`` at its end."""
LONGEST_CODE = 100_000
"""Maximum length of code that is searched for names."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A name in a text; ``scope`` is the start of the form or grammar in which it is visible.

    ``file`` is the relative path of another document that defines the name; ``short`` says that
    it is a property's name as well, as in ``{x}``. ``holder`` is the scope that is written before
    the name. ``nearer`` are the scopes that would come first if they had the name.
    """

    kind: tuple[str, ...]
    name: str
    start: int
    end: int
    defines: bool
    tag: ScannedTag
    scope: int = -1
    file: str = ""
    short: bool = False
    holder: str = ""
    nearer: tuple[int, ...] = ()
    shadow: bool = False
    """Whether a ``$`` follows: the result of the item with this name (VoiceXML 2.0, 2.3.1)."""
    use: Use | None = field(default=None, compare=False)
    """Its use in code, if it is a variable there."""

    def names(self, other: Mark) -> bool:
        """Whether this and another mark of the same document mean the same thing."""
        return (self.scope, self.file) == (other.scope, other.file) and self.is_like(other)

    def is_like(self, other: Mark) -> bool:
        """Whether this and another mark of different documents may mean the same thing."""
        return self.name == other.name and not set(self.kind).isdisjoint(other.kind)

    @property
    def is_state(self) -> bool:
        """Whether it is a form of an application that a scenario's expectation names."""
        return self.kind == ("form",) and self.tag.key in ("expect", "never")

    @property
    def of_document(self) -> bool:
        """Whether it is a variable of no form."""
        return self.kind == ("variable",) and self.scope < 0

    @property
    def inherited(self) -> bool:
        """Whether the leaves of a VoiceXML application may use it, if the document is its root."""
        own = self.of_document and not self.file
        return own and self.tag.vocabulary is not None and self.tag.vocabulary.name == "voicexml"

    @property
    def shared(self) -> bool:
        """Whether other documents may use the name too."""
        return not SHARED.isdisjoint(self.kind)


class NameSpot(NamedTuple):
    """A piece of a document."""

    path: Path
    start: int
    end: int


@dataclass(slots=True)
class FoundName:
    """A name in a document."""

    path: Path
    mark: Mark

    @property
    def spot(self) -> NameSpot:
        """Where it is."""
        return NameSpot(self.path, self.mark.start, self.mark.end)


def plain(code: str) -> str:
    """Code with character references replaced, padded to their written length."""
    return ENTITY.sub(lambda match: LETTERS.get(match[0], " ").ljust(len(match[0])), code)


def marks(page: ScannedText) -> list[Mark]:
    """All names of a page, in the order of the text."""
    found = [mark for tag in page.tags if tag.element for mark in _of_tag(page, tag)]
    own = list(_linked(_scoped(_shadows(found))))
    return sorted(_rooted(page, own), key=lambda mark: mark.start)


def _of_tag(page: ScannedText, tag: ScannedTag) -> Iterator[Mark]:
    for attr in tag.attributes:
        if attr.first >= 0:
            yield from _of_attribute(page, tag, attr)
    if tag.empty or tag.children:
        return
    if tag.key == "script":
        yield from _script(page.text[tag.end : tag.content], tag)
    elif tag.key == "tag":
        yield from _rules_in_tag(page, tag)


def _of_attribute(page: ScannedText, tag: ScannedTag, attr: Attr) -> Iterator[Mark]:
    assert tag.vocabulary is not None
    key = (tag.vocabulary.name, tag.key, attr.name)
    if key in DEFINES:
        kind = DEFINES[key]
        for start, end in _words(attr, 1):
            yield Mark((kind,), page.text[start:end], start, end, True, tag, _home(kind, tag))
    elif key in REFERS:
        yield from _references(page, tag, attr, REFERS[key])
    elif is_code(tag, attr.name):
        yield from _code(plain(attr.value), attr.first, tag)
    elif attr.name == "name" and tag.key == "param":
        yield from _given(page, tag, attr)
    elif attr.name == "value" and tag.key == "data":
        yield from _argument(page, tag, attr)


def _argument(page: ScannedText, tag: ScannedTag, attr: Attr) -> Iterator[Mark]:
    """The name that an expectation expects as an argument of a Command."""
    around = tag.parent
    command = "" if around is None else around.get("does") or around.get("finishes")
    use = REFERS.get(("dialogue", command, tag.get("name")))
    if use is not None:
        yield from _references(page, tag, attr, use)


def _words(attr: Attr, most: int = 1000) -> list[tuple[int, int]]:
    """The positions of the words of a value."""
    spans = [(attr.first + m.start(), attr.first + m.end()) for m in WORD.finditer(attr.value)]
    return spans[:most]


def _home(kind: str, tag: ScannedTag) -> int:
    """The start of the form or grammar in which a name is visible; -1 for the document."""
    if kind == "variable":
        form = tag.inside("form", "menu") if tag.key not in ("form", "menu") else None
        return form.start if form else -1
    if kind == "rule":
        grammar = tag.inside("grammar")
        return grammar.start if grammar else -1
    return -1


def _references(
    page: ScannedText, tag: ScannedTag, attr: Attr, use: ReferenceUse
) -> Iterator[Mark]:
    home = _home(use.kinds[0], tag)
    for start, end in _words(attr, 1000 if use.how == "list" else 1):
        file = ""
        if use.how in ("#", "uri"):
            path, sign, _ = page.text[start:end].partition("#")
            if not sign or (path and use.how == "#"):
                continue
            file, start = path, start + len(path) + 1
        elif use.how == "fixed:":
            if not page.text.startswith(use.how, start, end):
                continue
            start += len(use.how)
        if use.how and use.kinds == ("variable",):
            yield from _code(page.text[start:end], start, tag)
        else:
            name = page.text[start:end]
            yield Mark(use.kinds, name, start, end, False, tag, home, file)


def _code(code: str, first: int, tag: ScannedTag) -> Iterator[Mark]:
    """Variables that an expression uses."""
    if len(code) > LONGEST_CODE:
        return
    home = _home("variable", tag)
    for use in expression_names(code).uses:
        if use.name not in KNOWN:
            yield _variable(use, first, False, tag, home)


def _variable(use: Use, first: int, defines: bool, tag: ScannedTag, home: int) -> Mark:
    """A variable's name in code that begins at ``first``."""
    start, scope = first + use.start, -1 if use.holder in OF_DOCUMENT else home
    end = start + len(use.name)
    return Mark(
        ("variable",), use.name, start, end, defines, tag, scope, short=use.short,
        holder=use.holder, use=use,
    )  # fmt: skip


def _content(code: str) -> str:
    """The code in an element's content, padded to its written length."""
    inner = code.replace("<![CDATA[", " " * 9).replace("]]>", "   ")
    return inner if "<![CDATA[" in code else plain(inner)


def _rules_in_tag(page: ScannedText, tag: ScannedTag) -> Iterator[Mark]:
    """Members of the results of rules that a grammar's tag reads: ``rules.size`` (SISR 1.0, 3.3)."""
    grammar = tag.inside("grammar")
    code = _content(page.text[tag.end : tag.content])
    if grammar is None or grammar.get("tag-format").strip() != SCRIPTED or len(code) > LONGEST_CODE:
        return
    for use in script_names(code).uses:
        if use.name in RESULTS and use.part is not None:
            first, name = tag.end + use.part[0], use.part[1]
            yield Mark(("rule",), name, first, first + len(name), False, tag, grammar.start)


def _linked(found: list[Mark]) -> Iterator[Mark]:
    """The names, but of the members that tags read only those of rules that are referred to."""
    files = {(one.scope, one.name): one.file for one in found if one.tag.key == "ruleref"}
    for one in found:
        if one.tag.key != "tag":
            yield one
        elif (one.scope, one.name) in files:
            yield replace(one, file=files[one.scope, one.name])


def _script(code: str, tag: ScannedTag) -> Iterator[Mark]:
    """Names that a script declares, and those that it uses."""
    inner = _content(code)
    if len(inner) > LONGEST_CODE:
        return
    home, names = _home("variable", tag), script_names(inner)
    defined: set[str] = set()
    for use in names.uses:
        if use.name in KNOWN:
            continue
        defines = not use.holder and use.name in names.declared and use.name not in defined
        yield _variable(use, tag.end, defines, tag, home)
        if defines:
            defined.add(use.name)


def _given(page: ScannedText, tag: ScannedTag, attr: Attr) -> Iterator[Mark]:
    """A subdialog's param is a variable of the form that it calls."""
    caller = tag.parent
    if caller is None or caller.key != "subdialog":
        return
    called = caller.get("src").strip()
    for form in page.forms.get(called[1:], ()) if called[:1] == "#" else ():
        for start, end in _words(attr, 1):
            defines = tag.vocabulary is DIALOGUE
            name = page.text[start:end]
            yield Mark(("variable",), name, start, end, defines, tag, form.start, holder="dialog")


def _shadows(found: list[Mark]) -> list[Mark]:
    """The names, but those of results, such as ``town$``, as uses of their items' names."""
    variables = [mark for mark in found if mark.defines and mark.kind == ("variable",)]
    given = {mark.name for mark in variables}
    items = {mark.name for mark in variables if mark.tag.key in WITH_RESULTS}
    return [
        replace(mark, name=mark.name[:-1], end=mark.end - 1, shadow=True)
        if mark.name[-1:] == "$" and mark.name[:-1] in items and mark.name not in given
        else mark
        for mark in found
    ]


def _scoped(found: list[Mark]) -> list[Mark]:
    """Give names of variables that no form declares the document's scope."""
    own = {(mark.name, mark.scope) for mark in found if mark.defines and "variable" in mark.kind}
    return [
        replace(mark, scope=-1, nearer=() if mark.scope < 0 or mark.holder else (mark.scope,))
        if mark.kind == ("variable",) and (mark.name, mark.scope) not in own
        else mark
        for mark in found
    ]


def _rooted(page: ScannedText, found: list[Mark]) -> Iterator[Mark]:
    """The names; those of variables of the application's root with its file (VoiceXML 2.0, 5.1.2)."""
    file = page.root.get("application").strip() if page.root and dialect(page) == "voicexml" else ""
    own = {mark.name for mark in found if mark.of_document and mark.defines}
    for mark in found:
        if not file or not mark.of_document:
            yield mark
        elif mark.holder == "application":
            yield replace(mark, file=file)
        elif mark.holder or mark.name in own:
            yield mark
        else:
            yield replace(mark, file=file, nearer=(*mark.nearer, -1))


def mark_at(found: list[Mark], offset: int) -> Mark | None:
    """The name at an offset, or that ends there."""
    return next((mark for mark in found if mark.start <= offset <= mark.end), None)


def dialect(page: ScannedText) -> str:
    """The name of a page's vocabulary."""
    root = page.root
    return root.vocabulary.name if root is not None and root.vocabulary else ""
