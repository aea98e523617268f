"""Pieces of a document's text that fixes change: values, names, and places of missing ones."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable

from prima.errors import Edit, Fix, Hint, Span, meant, nearest_word, one_of, replaced
from prima.language.commands import Argument
from prima.language.values import read_value, written
from prima.markup.limits import LIMITS
from prima.markup.tree import MARKUP, NAME, Node
from prima.markup.vocabulary import Attribute

LONG = 1_000
"""Length of a value above which only whole words are found in it."""

BY_NAME = {"version": "2.1", "array": "[]", "expr": "''", "cond": "true"}
BY_KIND = {
    **dict.fromkeys(("duration", "delay"), "1s"),
    **dict.fromkeys(("expression", "boolean"), "true"),
    "events": "touch",
    "language": "en",
}
"""Initial values of attributes by their names, or else by their kinds."""
NUMBERS = ("number", "integer", "quantity")
NAMES = ("id", "variable", "event")
GIVEN = ("id", "name", "item")
"""Attributes that define a name; others refer to one."""


def value_span(node: Node, attribute: str, word: str = "") -> tuple[Span, ...]:
    """The value of an attribute as written, or a word in it; none if one of them is missing."""
    source = node.source
    first = source.offset(node.index, attribute, value=True)
    if first <= source.tag(node.index):
        return ()
    last, words = source.words(first)
    if not word:
        return (source.span(first, last),)
    if word in words:
        return (source.span(words[word], words[word] + len(word)),)
    at = _found(node.get(attribute), word) if last - first <= LONG else -1
    if at < 0:
        return ()
    begin, end = (source.inside(node.index, attribute, one) for one in (at, at + len(word)))
    return (Span(begin.line, begin.column, end.line, end.column),)


def nearest_allowed(item: Attribute | Argument, text: str, node: Node, attribute: str) -> Hint:
    """The allowed number nearest to one beyond its bounds; the fix writes it as an attribute."""
    low = item.low is not None and float(read_value(item.kind, text)) < item.low
    bound = item.low if low else item.high
    if bound is None:
        return Hint()
    right = written(item.kind, bound)
    return replaced(f'The nearest is "{right}".', right, *value_span(node, attribute))


def _found(text: str, word: str) -> int:
    """The position of a word that may begin a longer name, such as ``a`` of ``a.b``; or -1."""
    match = re.search(rf"(?<![\w.\-]){re.escape(word)}(?![\w\-])", text)
    return match.start() if match else -1


def attribute_span(node: Node, attribute: str) -> Span:
    """An attribute's name."""
    first = node.source.offset(node.index, attribute)
    return node.source.span(first, first + len(attribute))


def similar_attribute(node: Node, name: str, known: Iterable[str]) -> Hint:
    """The hint for an unknown attribute: the known one that it resembles, or all of them."""
    near = nearest_word(name, known)
    if near in node.attributes:
        return Hint(f'Remove it: there is "{near}" already.')
    if near:
        return meant(near, attribute_span(node, name))
    every = one_of(known)
    return Hint(f"It may have {every}." if every else "It has no attributes.")


def name_spans(node: Node) -> tuple[Span, ...]:
    """The names in an element's tags, without their prefixes."""
    source = node.source
    start = source.tag(node.index)
    names = [start + 1, *([source.closes[node.index]] if node.index in source.closes else [])]
    prefix, length = len(prefix_of(node)), len(node.tag)
    return tuple(source.span(at + prefix, at + prefix + length) for at in names)


def prefix_of(node: Node) -> str:
    """The prefix in an element's tags with its colon, or nothing."""
    begin = NAME.match(node.source.text, node.source.tag(node.index))
    return begin[0][1 : begin[0].find(":") + 1] if begin else ""


def behind_name(node: Node) -> Span:
    """Where another attribute goes: after the name in an element's start tag."""
    start = node.source.tag(node.index)
    begin = NAME.match(node.source.text, start)
    at = begin.end() if begin else start + 1
    return node.source.span(at, at)


def renamed(text: str, node: Node, tag: str) -> Hint:
    """A sentence, with a fix that gives an element another name."""
    return replaced(text, tag, *name_spans(node), title=f"Change to <{tag}>")


def added(text: str, node: Node, item: Attribute) -> Hint:
    """A sentence, with a fix that adds an attribute to an element if its value can be guessed."""
    value = _likely(node, item)
    if value is None:
        return Hint(text)
    edit = Edit(behind_name(node), f' {item.name}="{value}"')
    return Hint(text, (Fix(f'Add {item.name}="{value}"', (edit,)),))


def _likely(node: Node, item: Attribute) -> str | None:
    """An initial value valid in its place; None if it depends on other elements."""
    if item.default or item.choices:
        return item.default or item.choices[0]
    if value := BY_NAME.get(item.name) or BY_KIND.get(item.kind):
        return value
    if item.kind in NUMBERS:
        return f"{max(item.low or 0, 0):g}"
    return _new_name(node, item)


def _new_name(node: Node, item: Attribute) -> str | None:
    """An unused name; None if the attribute refers to a name."""
    given = item.name in GIVEN and node.tag != "assign"  # which refers to a declared name
    if item.kind not in NAMES or not (given or item.kind == "event"):
        return None
    name = node.tag if given else item.name
    return f"{name.replace('-', '_')}_{node.index}"  # no other element has its number


def with_namespace(text: str, node: Node, namespace: str) -> Hint:
    """A sentence, with a fix that puts an element and its content into a namespace."""
    edit = Edit(behind_name(node), f' xmlns="{namespace}"')
    return Hint(text, (Fix("Add the namespace", (edit,)),))


def instead(text: str, node: Node, attribute: str, name: str, value: str) -> Hint:
    """A sentence, with a fix that replaces an attribute by another."""
    spans = value_span(node, attribute)
    if not spans:
        return Hint(text)
    name_at, value_at = attribute_span(node, attribute), spans[0]
    whole = Span(name_at.line, name_at.column, value_at.end_line, value_at.end_column)
    quote = node.source.text[node.source.offset(node.index, attribute, value=True) - 1]
    return replaced(text, f"{name}={quote}{value}", whole, title=f'Change to {name}="{value}"')


class Declarations:
    """Where variables may be declared: at the beginning of a form, or of the document.

    Only as many problems get fixes as are listed for a document.
    """

    def __init__(self, root: Node) -> None:
        self.root = root
        self.nodes = root.nodes
        self.starts = [one.index for one in self.nodes]
        self._beginnings: dict[int, tuple[Span, str] | None] = {}
        """By element: where its content begins, and what goes there before a variable's name."""
        self._left = LIMITS.problems

    def hint(self, text: str, name: str, node: Node) -> Hint:
        """A sentence, with fixes that declare a variable which an element uses."""
        self._left -= 1
        if self._left < 0:
            return Hint(text)
        at = bisect_right(self.starts, node.index) - 1
        holders = [("document", self.root)]
        if at >= 0 and self.nodes[at].tag == "form":
            holders.insert(0, ("form", self.nodes[at]))
        fixes = []
        for where, holder in holders:
            beginning = self._beginning(holder)
            if beginning is not None:
                span, begin = beginning
                edit = Edit(span, f'{begin}"{name}"/>')
                fixes.append(Fix(f"Declare it in the {where}", (edit,)))
        return Hint(text, tuple(fixes))

    def _beginning(self, holder: Node) -> tuple[Span, str] | None:
        if holder.index not in self._beginnings:
            span = first_inside(holder)
            begin = f"\n{indent(holder)}<{prefix_of(holder)}var name="
            self._beginnings[holder.index] = span and (span, begin)
        return self._beginnings[holder.index]


def first_inside(node: Node) -> Span | None:
    """Where an element's content begins; None for an empty-element tag."""
    found = MARKUP.match(node.source.text, node.source.tag(node.index))
    if found is None or found[0].endswith("/>"):
        return None
    return node.source.span(found.end(), found.end())


def indent(node: Node) -> str:
    """The space before an element's first child on its line, or two spaces."""
    child = next((one for one in node.content if isinstance(one, Node)), None)
    if child is None:
        return "  "
    text, first = node.source.text, node.source.tag(child.index)
    space = text[text.rfind("\n", 0, first) + 1 : first]
    return space if not space.strip() else "  "
