"""Schema problems in the author's terms, from the same table as the schema."""

from __future__ import annotations

from collections.abc import Callable

from prima.errors import (
    Hint,
    Place,
    Problem,
    meant,
    nearest_word,
    one_of,
    replaced,
)
from prima.errors.diagnoses.structure import (
    MISPLACED_ELEMENT,
    MISSING_ATTRIBUTE,
    STRAY_TEXT,
    UNKNOWN_ATTRIBUTE,
    UNKNOWN_ELEMENT,
    WRONG_NAMESPACE,
)
from prima.errors.diagnoses.values import BAD_VALUE
from prima.language.values import KINDS, XML_SPACE, BadValue, is_beyond, outside, read_value
from prima.markup import hints
from prima.markup.spans import (
    added,
    attribute_span,
    name_spans,
    renamed,
    similar_attribute,
    value_span,
)
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute, Instead, Vocabulary

EVERYWHERE = frozenset({"xml:lang", "xsi:schemaLocation", "xsi:noNamespaceSchemaLocation"})

FOREIGN = WRONG_NAMESPACE.says('<{tag}> is of another namespace, "{namespace}".')
UNKNOWN = UNKNOWN_ELEMENT.says("There is no <{tag}>.")
NOT_HERE = MISPLACED_ELEMENT.says("<{tag}> is not allowed in <{parent}>.")
HOLDS_TEXT = STRAY_TEXT.says('<{tag}> holds text: "{text}".')
NO_ATTRIBUTE = UNKNOWN_ATTRIBUTE.says('<{tag}> has no attribute "{name}".')
NEEDS = MISSING_ATTRIBUTE.says('<{tag}> needs the attribute "{name}": {doc}.')
NOT_OF_ITS_KIND = BAD_VALUE.says('{name} "{value}" {wrong}')


def check_tree(root: Node, vocabulary: Vocabulary, problems: list[Problem]) -> None:
    """Give every node its table key, and add the problems found by the table of elements."""
    namespace = vocabulary.namespace
    known: dict[str, _Rules] = {}
    read: dict[str, set[str]] = {}
    root.key = vocabulary.root
    stack = [root]
    while stack:
        node = stack.pop()
        rules = known.get(node.key)
        if rules is None:
            rules = known[node.key] = _Rules(vocabulary, node.key, read)
        if not rules.allow(node.attributes):
            _check_attributes(node, rules, node is root, problems)
        stray = False
        for child in node.content:
            if isinstance(child, str):
                stray = stray or not (rules.element.text or child.isspace())
                continue
            key = rules.children.get(child.tag)
            if key is None or child.namespace != namespace:
                problems.append(_misplaced(child, node, vocabulary))
            else:
                child.key = key
                stack.append(child)
        if stray:
            problems.append(_stray_text(node, vocabulary, rules))


class _Rules:
    """The table's rules for elements of one key, cached for a document."""

    def __init__(self, vocabulary: Vocabulary, key: str, read: dict[str, set[str]]) -> None:
        self.element = vocabulary.elements[key]
        self.known = vocabulary.attributes[key]
        self.children = vocabulary.children(key)
        self.required = [item for item in self.element.attributes if item.required]
        self.needed = frozenset(item.name for item in self.required)
        self.values: dict[str, tuple[set[str], Callable[[str], object] | None]] = {}
        """Correct values by attribute, and the reader of other values, if others are allowed.

        Values are cached by kinds in ``read``: most occur many times."""
        for name, (item, is_expression) in self.known.items():
            kind = "expression" if is_expression else item.kind
            if item.choices and not is_expression:
                self.values[name] = set(item.choices), None
            else:
                self.values[name] = read.setdefault(kind, set()), KINDS[kind].read

    def allow(self, attributes: dict[str, str]) -> bool:
        """Whether the element may have these attributes, and needs no others."""
        for name, text in attributes.items():
            values = self.values.get(name)
            if values is None:
                return False
            right, read = values
            if text not in right:
                if read is None:
                    return False
                try:
                    read(text.strip(XML_SPACE))
                except ValueError:
                    return False
                right.add(text)
        return self.needed <= attributes.keys() or not self.lacking(attributes)

    def lacking(self, attributes: dict[str, str]) -> list[Attribute]:
        """The missing attributes of an element with these."""
        return [
            item
            for item in self.required
            if item.name not in attributes and f"{item.name}-expr" not in attributes
        ]


def _misplaced(child: Node, parent: Node, vocabulary: Vocabulary) -> Problem:
    tag = child.tag
    if child.namespace != vocabulary.namespace:
        known = vocabulary.child(parent.key, tag)
        hint = Hint(hints.OWN_NAMESPACE if known else hints.REMOVE)
        return FOREIGN.at(child.place, hint, tag=tag, namespace=child.namespace)
    if tag not in vocabulary.tags:
        return UNKNOWN.at(child.place, _known_instead(child, parent, vocabulary), tag=tag)
    hint = Hint(hints.misplaced_remedy(tag, parent, vocabulary))
    return NOT_HERE.at(child.place, hint, tag=tag, parent=parent.tag)


def _known_instead(child: Node, parent: Node, vocabulary: Vocabulary) -> Hint:
    """The element to write instead of an unknown one."""
    hint = vocabulary.hints.get(child.tag)
    if isinstance(hint, Instead):
        return renamed(str(hint), child, hint.tag)
    if hint:
        return Hint(hint)
    inside = vocabulary.children(parent.key)
    if tag := nearest_word(child.tag, inside):
        return meant(tag, *name_spans(child))
    tag = nearest_word(child.tag, vocabulary.tags)
    other = meant(tag, *name_spans(child)) if tag else Hint(hints.held(parent, inside))
    if "command" not in inside:
        return other
    added_one = f'A Command that the robot adds is <command type="{child.tag}">.'
    return other._replace(text=f"{other.text} {added_one}".lstrip())


def _stray_text(node: Node, vocabulary: Vocabulary, rules: _Rules) -> Problem:
    shown = node.text if len(node.text) <= 30 else node.text[:27] + "..."
    missing = [] if "speak" in rules.children else rules.lacking(node.attributes)
    only = missing[0].name if len(missing) == 1 else ""
    hint = Hint(hints.text_remedy(node, "speak" in vocabulary.tags, only))
    return HOLDS_TEXT.at(_text_place(node), hint, tag=node.tag, text=shown)


def _text_place(node: Node) -> Place:
    """Where an element's own text begins, if that is certain; else where the element does."""
    before: Node | None = None
    for item in node.content:
        if isinstance(item, Node):
            before = item
        elif item.strip():
            if before is None:
                return node.source.inside(node.index, "", len(item) - len(item.lstrip()))
            return before.place_behind(item) or node.place
    return node.place


def _check_attributes(node: Node, rules: _Rules, root: bool, problems: list[Problem]) -> None:
    unknown: list[str] = []
    for name, text in node.attributes.items():
        if root and name in EVERYWHERE:
            language = name == "xml:lang" and text.strip(XML_SPACE)
            bad = _not_of_kind("language", text) if language else None
        elif name in rules.known:
            bad = _value_problem(*rules.known[name], text)
        else:
            unknown.append(name)
            continue
        if bad is not None:
            problems.append(_bad_value(node, name, bad))
    missing = rules.lacking(node.attributes)
    for name in unknown:
        problems.append(_unknown_attribute(node, name, rules, missing))
    for item in missing:
        written = one_of(f'{item.name}="{value}"' for value in item.choices or ("...",))
        hint = added(f"Write {written}.", node, item)
        problems.append(NEEDS.at(node.place, hint, tag=node.tag, name=item.name, doc=item.doc))


def _bad_value(node: Node, name: str, bad: BadValue) -> Problem:
    spans = value_span(node, name) if bad.right else ()
    title = f"Change to {bad.right}" if bad.right.startswith("#") else ""
    hint = replaced(bad.remedy, bad.right, *spans, title=title)
    place, value = node.attribute_place(name), node.get(name)
    return NOT_OF_ITS_KIND.at(place, hint, name=name, value=value, wrong=bad.wrong)


def _unknown_attribute(node: Node, name: str, rules: _Rules, missing: list[Attribute]) -> Problem:
    """The problem of an unknown attribute; a missing one that it means is not reported as well."""
    known = list(rules.known)
    hint = _other_attribute(node, name, rules) or _missing_attribute(node, name, known, missing)
    if not hint and rules.element.text:
        hint = Hint(hints.inside(node, name, "value" in rules.children))
    hint = hint or similar_attribute(node, name, known)
    place = node.attribute_place(name, value=False)
    return NO_ATTRIBUTE.at(place, hint, tag=node.tag, name=name)


def _other_attribute(node: Node, name: str, rules: _Rules) -> Hint:
    """The remedy for an attribute of other languages."""
    if name == "xml:lang":
        return Hint("Only the root element may have it.")
    if name == "lang" and node.index == 0:
        return replaced("Write xml:lang.", "xml:lang", attribute_span(node, name))
    if name == "next" and "goto" in rules.element.children:
        return Hint(f'Put a goto inside: <goto next="{node.get(name)}"/>.')
    return Hint(hints.other_attribute(node.tag, name))


def _missing_attribute(node: Node, name: str, known: list[str], missing: list[Attribute]) -> Hint:
    """The missing attribute that an unknown one means; it is removed from those missing."""
    names = [item.name for item in missing]
    computed = [one for one in (f"{name}-expr" for name in names) if one in known]
    right = f"{name[:-4]}-expr" if name != "expr" else "".join(computed[:1])
    if name.endswith("expr") and right in known:
        hint = replaced(f"Write {right}.", right, attribute_span(node, name))
        meant_name = right[:-5]
    elif near := nearest_word(name, names + computed):
        meant_name, hint = near.removesuffix("-expr"), meant(near, attribute_span(node, name))
    elif missing:
        meant_name, hint = names[0], Hint(f'Write {names[0]}="...": {missing[0].doc}.')
    else:
        return Hint()
    missing[:] = [item for item in missing if item.name != meant_name]
    return hint


def _value_problem(item: Attribute, is_expression: bool, text: str) -> BadValue | None:
    if is_expression:
        return _not_of_kind("expression", text)
    if item.choices:
        return None if text in item.choices else _no_choice(item, text)
    bad = _not_of_kind(item.kind, text)
    if bad is None:
        return None
    if right := hints.meant_value(item.kind, text, item.default):
        value = read_value(item.kind, right)
        if is_beyond(value, item.low, item.high):
            return BadValue(bad.wrong, f'"{right}" {outside(item.kind, item.low, item.high)}')
        return BadValue(bad.wrong, f'Write "{right}".', right=right)
    code = hints.expression(text) if item.dynamic else ""
    written = f'For an expression write {item.name}-expr="{code}".'
    return BadValue(bad.wrong, written) if code else bad


def _no_choice(item: Attribute, text: str) -> BadValue:
    near = hints.meant_choice(text, item.choices)
    remedy = f'Did you mean "{near}"?' if near else f"Write {one_of(item.choices)}."
    only = item.choices[0] if len(item.choices) == 1 else ""
    return BadValue("is not allowed here.", remedy, right=near or only)


def _not_of_kind(kind: str, text: str) -> BadValue | None:
    try:
        read_value(kind, text)
    except BadValue as error:
        return error
    return None
