"""Schema problems in the author's words, from the same table that makes the schema."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from prima.errors import (
    DocumentError,
    Hint,
    Place,
    Problem,
    meant,
    nearest_word,
    one_of,
    replaced,
    suggestion,
)
from prima.language.values import KINDS, XML_SPACE, BadValue, read_value
from prima.markup.slips import TEXTS, meant_value, misplaced_remedy, text_remedy
from prima.markup.spans import added, attribute_span, name_spans, renamed, value_span
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute, Element, Instead, Vocabulary

EVERYWHERE = frozenset({"xml:lang", "xsi:schemaLocation", "xsi:noNamespaceSchemaLocation"})

DOCUMENTS = {
    "urn:prima:dialogue:1": "an application",
    "urn:prima:world:1": "a world",
    "urn:prima:robot:1": "a robot",
    "urn:prima:scenario:1": "a scenario",
}
"""What documents are, by their namespaces."""
VOICEXML = "a VoiceXML document"


def check_root(root: Node, vocabularies: Sequence[Vocabulary]) -> Vocabulary:
    """Find the vocabulary of a document by its root element's namespace.

    Raises:
        DocumentError: it is none of them.
    """
    expected = [(v.elements[v.root].tag, v.namespace) for v in vocabularies]
    for vocabulary, (tag, namespace) in zip(vocabularies, expected, strict=True):
        if root.namespace == namespace:
            if root.tag == tag:
                return vocabulary
            message = f"The root element is <{root.tag}>; it must be <{tag}>."
            remedy = f"Begin with <{tag}>."
            raise DocumentError([Problem(root.place, "error", "wrong-root", message, remedy)])
    own = kind_of(root)
    if own:
        wanted = one_of(DOCUMENTS.get(name, VOICEXML) for _, name in expected)
        message = f"This is {own}; {wanted} is needed here."
        remedy = f"Name the file of {wanted}."
        if own in ("an application", VOICEXML) and wanted == "a scenario":
            remedy = _as_application(root)
        raise DocumentError([Problem(root.place, "error", "wrong-namespace", message, remedy)])
    found = f'namespace "{root.namespace}"' if root.namespace else "no namespace"
    expected = [entry for entry in expected if entry[0] == root.tag] or expected
    wanted = " or ".join(f'<{tag} xmlns="{namespace}">' for tag, namespace in expected)
    message = f"The root element <{root.tag}> has {found}."
    spaces = [namespace for _, namespace in expected]
    near = suggestion(root.namespace, spaces, *value_span(root, "xmlns"))
    hint = near or f"Begin with {wanted}."
    place = root.source.place(root.index, "xmlns", value=True)
    raise DocumentError([Problem(place, "error", "wrong-namespace", message, hint)])


def kind_of(root: Node) -> str:
    """What document an element is the root of, such as ``a world``; nothing where it is none."""
    if root.tag == "vxml" and root.namespace in ("", "http://www.w3.org/2001/vxml"):
        return VOICEXML
    return DOCUMENTS.get(root.namespace, "")


def _as_application(root: Node) -> str:
    """How a run takes an application."""
    file = root.source.file
    option = f"--{root.get('kind', 'ea')} {file}"
    return (
        f"prima run and prima talk take it by {option}."
        ' A scenario names it by <application src="..."/>.'
    )


def check_tree(root: Node, vocabulary: Vocabulary, problems: list[Problem]) -> None:
    """Give every node its table key, and add what is wrong by the table of elements."""
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
            problems.append(_stray_text(node, vocabulary))


class _Rules:
    """What the table says of elements of one key, at hand for all of them in a document."""

    def __init__(self, vocabulary: Vocabulary, key: str, read: dict[str, set[str]]) -> None:
        self.element = vocabulary.elements[key]
        self.known = vocabulary.attributes[key]
        self.children = vocabulary.children(key)
        self.required = [item.name for item in self.element.attributes if item.required]
        self.values: dict[str, tuple[set[str], Callable[[str], object] | None]] = {}
        """Values that are right, by attributes, and what reads others if there may be others;
        those that have been read are kept by kinds in ``read``: most are written again and again."""
        for name, (item, is_expression) in self.known.items():
            kind = "expression" if is_expression else item.kind
            if item.choices and not is_expression:
                self.values[name] = set(item.choices), None
            else:
                self.values[name] = read.setdefault(kind, set()), KINDS[kind].read

    def allow(self, attributes: dict[str, str]) -> bool:
        """Whether these are attributes that the element may have, and all that it needs."""
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
        for name in self.required:
            if name not in attributes and f"{name}-expr" not in attributes:
                return False
        return True


def _misplaced(child: Node, parent: Node, vocabulary: Vocabulary) -> Problem:
    tag = child.tag
    if child.namespace != vocabulary.namespace:
        message = f'<{tag}> is of another namespace, "{child.namespace}".'
        return Problem(child.place, "error", "wrong-namespace", message)
    if tag not in vocabulary.tags:
        hint = _known_instead(child, parent, vocabulary)
        return Problem(child.place, "error", "unknown-element", f"There is no <{tag}>.", hint)
    message = f"<{tag}> cannot stand in <{parent.tag}>."
    remedy = misplaced_remedy(tag, parent, vocabulary)
    return Problem(child.place, "error", "misplaced-element", message, remedy)


def _known_instead(child: Node, parent: Node, vocabulary: Vocabulary) -> Hint:
    """The element to write instead of one that the language lacks."""
    hint = vocabulary.hints.get(child.tag)
    if isinstance(hint, Instead):
        return renamed(str(hint), child, hint.tag)
    if hint:
        return Hint(hint)
    inside = vocabulary.children(parent.key)
    tag = nearest_word(child.tag, inside) or nearest_word(child.tag, vocabulary.tags)
    return meant(tag, *(name_spans(child) if tag else ()))


def _stray_text(node: Node, vocabulary: Vocabulary) -> Problem:
    shown = node.text if len(node.text) <= 30 else node.text[:27] + "..."
    message = f'<{node.tag}> holds text: "{shown}".'
    remedy = text_remedy(node, "speak" in vocabulary.tags)
    return Problem(_text_place(node), "error", "stray-text", message, remedy)


def _text_place(node: Node) -> Place:
    """Where an element's own text begins, if it can be told for certain; else the element."""
    before: Node | None = None
    for item in node.content:
        if isinstance(item, Node):
            before = item
        elif item.strip():
            if before is None:
                return node.source.inside(node.index, "", len(item) - len(item.lstrip()))
            source, start = node.source, node.source.tag(before.index)
            word = item.split()[0]
            ends = re.compile(rf">\s*({re.escape(word)})")
            found = ends.search(source.text, start)
            return source.at(found.start(1)) if found else node.place
    return node.place


def _check_attributes(node: Node, rules: _Rules, root: bool, problems: list[Problem]) -> None:
    element, known = rules.element, rules.known
    unknown: list[str] = []
    for name, text in node.attributes.items():
        if root and name in EVERYWHERE:
            if name == "xml:lang" and text.strip(XML_SPACE):
                problems += _language_problem(node, text)
            continue
        entry = known.get(name)
        if entry is None:
            unknown.append(name)
            continue
        bad = _value_problem(*entry, text)
        if bad is not None:
            problems.append(_bad_value(node, name, bad))
    missing: list[Attribute] = []
    for item in element.attributes:
        if not item.required or item.name in node.attributes:
            continue
        if f"{item.name}-expr" not in node.attributes:
            missing.append(item)
    for name in unknown:
        problems.append(_unknown_attribute(node, name, element, list(known), missing))
    for item in missing:
        message = f'<{node.tag}> needs the attribute "{item.name}": {item.doc}.'
        value = item.choices[0] if len(item.choices) == 1 else "..."
        remedy = added(f'Write {item.name}="{value}".', node, item)
        problems.append(Problem(node.place, "error", "missing-attribute", message, remedy))


def _bad_value(node: Node, name: str, bad: BadValue) -> Problem:
    message = f'{name} "{node.get(name)}" {bad.wrong}'
    spans = value_span(node, name) if bad.right else ()
    title = f"Change to {bad.right}" if bad.right.startswith("#") else ""
    remedy = replaced(bad.remedy, bad.right, *spans, title=title)
    return Problem(node.attribute_place(name), "error", "bad-value", message, remedy)


def _language_problem(node: Node, text: str) -> list[Problem]:
    try:
        read_value("language", text)
    except BadValue as error:
        return [_bad_value(node, "xml:lang", error)]
    return []


def _unknown_attribute(
    node: Node, name: str, element: Element, known: list[str], missing: list[Attribute]
) -> Problem:
    """An attribute that is not known; what is missing and meant by it is told with it."""
    wanted = [item.name for item in missing]
    remedy: str | Hint = ""
    if name == "xml:lang":
        remedy = "It stands on the root element alone."
    elif name == "lang" and node.index == 0:
        remedy = "Write xml:lang."
    elif name.endswith("expr") and f"{name[:-4]}-expr" in known:
        remedy = f"Write {name[:-4]}-expr."
        missing[:] = [item for item in missing if item.name != name[:-4]]
    elif name == "next" and "goto" in element.children:
        remedy = f'Put a goto inside: <goto next="{node.get(name)}"/>.'
    elif near := nearest_word(name, wanted):
        remedy = meant(near, attribute_span(node, name))
        missing[:] = [item for item in missing if item.name != near]
    elif missing:
        item = missing.pop(0)
        remedy = f'Write {item.name}="...": {item.doc}.'
    elif element.text and name in TEXTS:
        remedy = f"Write the text inside: <{node.tag}>...</{node.tag}>."
    else:
        remedy = suggestion(name, known, attribute_span(node, name))
    if not remedy:
        remedy = f"It may have {one_of(known)}." if known else "It has no attributes."
    message = f'<{node.tag}> has no attribute "{name}".'
    place = node.attribute_place(name, value=False)
    return Problem(place, "error", "unknown-attribute", message, remedy)


def _value_problem(item: Attribute, is_expression: bool, text: str) -> BadValue | None:
    if item.choices and not is_expression:
        if text in item.choices:
            return None
        near = nearest_word(text, item.choices)
        remedy = f'Did you mean "{near}"?' if near else f"Write {one_of(item.choices)}."
        only = item.choices[0] if len(item.choices) == 1 else ""
        return BadValue("is not allowed here.", remedy, right=near or only)
    try:
        read_value("expression" if is_expression else item.kind, text)
    except BadValue as error:
        right = "" if is_expression else meant_value(item.kind, text)
        return BadValue(error.wrong, f'Write "{right}".', right=right) if right else error
    return None
