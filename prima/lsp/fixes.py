"""What can be done at once about a problem: the remedies that are exact."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from prima.errors import CUT, Problem
from prima.lsp.problems import Spot
from prima.lsp.scan import Page, Tag
from prima.lsp.tables import attributes
from prima.markup.vocabulary import Attribute

MEANT = re.compile(r'Did you mean "([^"<>&]+)"\?')
WRITE_TARGET = re.compile(r'Write "(#[^"<>&]+)"')
WRITE_VALUE = re.compile(r'(?:Write|The nearest is) "([^"<>&#]+)"\.')
WRITE_TAG = re.compile(r"^Write <([\w.-]+)((?: [\w-]+=\"\.\.\.\")*)/?>\.$")
DECLARE = re.compile(r'Declare it: (<var name="([^"<>&]+)"/>)\.')
NAMED = re.compile(r'"([^"]+)"')
NEEDS = re.compile(r'^<[^>]+> needs the attribute "([\w:.-]+)"')
NEEDS_ONE = re.compile(r"^<[^>]+> needs one of ([\w:., -]+)\.$")
CLOSE = re.compile(r"write (</[^<>\s]+>)")
WRITE_NEXT = re.compile(r'write ([\w-]+)="(#[^"<>&]+)"')
NAMESPACE = re.compile(r'^Write <vxml xmlns="([^"]+)">\.$')


@dataclass(frozen=True, slots=True)
class Change:
    """A piece of text in place of another."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A remedy that can be applied."""

    title: str
    problem: Problem
    changes: tuple[Change, ...]


def fixes(page: Page, spot: Spot) -> list[Fix]:
    """What can be done about a problem."""
    return list(_found(page, spot))


def _found(page: Page, spot: Spot) -> Iterator[Fix]:
    problem, remedy = spot.problem, spot.problem.remedy
    whole = f"{problem.message} {remedy}"
    if CUT in whole:
        return  # what it names is not all there
    if meant := MEANT.search(whole):
        changes = _replaced(page, spot, meant[1])
        if changes:
            yield Fix(f'Change to "{meant[1]}"', problem, changes)
    if target := WRITE_TARGET.search(whole):
        yield Fix(f"Change to {target[1]}", problem, (Change(spot.start, spot.end, target[1]),))
    if problem.code in ("bad-value", "out-of-range") and (value := WRITE_VALUE.fullmatch(remedy)):
        change = Change(spot.start, spot.end, value[1])
        yield Fix(f'Change to "{value[1]}"', problem, (change,))
    if (write := WRITE_TAG.match(remedy)) and problem.code in ("unknown-element",):
        changes = _renamed(page, spot.start, write[1])
        if changes:
            yield Fix(f"Change to <{write[1]}>", problem, changes)
    if declare := DECLARE.search(remedy):
        yield from _declared(page, spot, declare[1])
    if other := WRITE_NEXT.search(remedy):
        yield from _instead(page, spot, other[1], other[2])
    if problem.code == "missing-attribute":
        yield from _given(page, spot)
    if (namespace := NAMESPACE.match(remedy)) and (tag := _tag(page, spot.start)):
        change = Change(tag.name_end, tag.name_end, f' xmlns="{namespace[1]}"')
        yield Fix("Add the namespace", problem, (change,))
    if problem.code == "not-xml" and (close := CLOSE.search(remedy)):
        yield Fix(f"Write {close[1]}", problem, (_closing(page, spot, close[1]),))


def _tag(page: Page, offset: int) -> Tag | None:
    tag = page.begun(offset)
    return tag if tag is not None and offset < max(tag.end, tag.start + 1) else None


def _replaced(page: Page, spot: Spot, word: str) -> tuple[Change, ...]:
    """A word in place of the one that the message quotes, or of all that is wrong."""
    if page.text[spot.start : spot.start + 1] == "<":
        if spot.problem.code in ("unknown-element", "wrong-root"):
            return _renamed(page, spot.start, word)
        if spot.problem.code == "wrong-namespace" and (tag := _tag(page, spot.start)):
            attr = tag.attr("xmlns")
            return (Change(attr.first, attr.last, word),) if attr and attr.first >= 0 else ()
        return _quoted(page, spot, word)
    wrong = page.text[spot.start : spot.end]
    if spot.problem.code == "no-such-file" and "/" not in word:
        word = wrong[: wrong.rfind("/") + 1] + word
    named = [one for one in NAMED.findall(spot.problem.message) if one in wrong]
    for one in sorted(named, key=len):
        match = re.search(rf"(?<![\w.\-]){re.escape(one)}(?![\w\-])", wrong)
        if match:
            start = spot.start + match.start()
            sign = "#" if one.startswith("#") and not word.startswith("#") else ""
            return (Change(start, start + len(one), sign + word),)
    sign = "#" if wrong.startswith("#") and not word.startswith("#") else ""
    return (Change(spot.start, spot.end, sign + word),)


def _quoted(page: Page, spot: Spot, word: str) -> tuple[Change, ...]:
    """A word in place of the value of an element's attribute that the message quotes."""
    tag = _tag(page, spot.start)
    for one in NAMED.findall(spot.problem.message) if tag is not None else ():
        for attr in tag.attributes if tag is not None else ():
            if attr.value == one:
                return (Change(attr.first, attr.last, word),)
    return ()


def _renamed(page: Page, start: int, name: str) -> tuple[Change, ...]:
    """Another name for an element, in both of its tags."""
    tag = _tag(page, start)
    if tag is None:
        return ()
    name = tag.prefix + name
    changes = [Change(tag.start + 1, tag.name_end, name)]
    if tag.close is not None:
        changes.append(Change(*tag.close, name))
    return tuple(changes)


def _declared(page: Page, spot: Spot, text: str) -> Iterator[Fix]:
    """A variable that is declared at the beginning of its form, or of the document."""
    tag = page.tag_at(spot.start) or page.around(spot.start)
    for key, where in (("form", "the form"), ("prima", "the document")):
        holder = tag.inside(key) if tag is not None else None
        if holder is not None and not holder.empty:
            first = next(iter(holder.children), None)
            line = _indent(page, first.start if first else holder.end, "  ")
            change = Change(holder.end, holder.end, f"\n{line}{text}")
            yield Fix(f"Declare it in {where}", spot.problem, (change,))


def _indent(page: Page, offset: int, default: str) -> str:
    line, _ = page.lines.position(offset)
    start = page.lines.starts[line]
    space = page.text[start:offset]
    return space if not space.strip() else default


def _given(page: Page, spot: Spot) -> Iterator[Fix]:
    """The attribute that is missing, or each of those of which one is."""
    tag = _tag(page, spot.start)
    element = tag.element if tag is not None else None
    needs, one_of = NEEDS.match(spot.problem.message), NEEDS_ONE.match(spot.problem.message)
    names = [needs[1]] if needs else re.split(r", | or ", one_of[1]) if one_of else []
    for name in names:
        item, _ = attributes(element).get(name, (None, False)) if element else (None, False)
        if tag is None or item is None:
            continue
        value = _likely(item)
        change = Change(tag.name_end, tag.name_end, f' {name}="{value}"')
        yield Fix(f'Add {name}="{value}"', spot.problem, (change,))


def _likely(item: Attribute) -> str:
    """A value to begin with."""
    if item.default or item.choices:
        return item.default or item.choices[0]
    return "2.1" if item.name == "version" else ""


def _closing(page: Page, spot: Spot, text: str) -> Change:
    """An end tag before the one that ends something else, or at the end of the text."""
    here = page.text.startswith("</", spot.start)
    offset = spot.start if here else len(page.text.rstrip())
    return Change(offset, offset, text)


def _instead(page: Page, spot: Spot, name: str, value: str) -> Iterator[Fix]:
    """Another attribute in place of the one whose value is wrong."""
    tag = _tag(page, spot.start)
    for attr in tag.attributes if tag is not None else ():
        if attr.first <= spot.start <= attr.last and attr.closed:
            change = Change(attr.start, attr.last, f'{name}="{value}')
            yield Fix(f'Change to {name}="{value}"', spot.problem, (change,))
