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
from prima.errors.diagnoses.structure import (
    MISPLACED_ELEMENT,
    MISSING_ATTRIBUTE,
    STRAY_TEXT,
    UNKNOWN_ATTRIBUTE,
    UNKNOWN_ELEMENT,
    WRONG_NAMESPACE,
    WRONG_ROOT,
)
from prima.errors.diagnoses.values import BAD_VALUE
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
    "urn:prima:user:1": "a user",
}
"""What documents are, by their namespaces."""
VOICEXML = "a VoiceXML document"

OTHER_ROOT = WRONG_ROOT.says(
    "The root element is <{tag}>; it must be <{root}>.", "Begin with <{root}>."
)
OTHER_DOCUMENT = WRONG_NAMESPACE.says(
    "This is {own}; {wanted} is needed here.", "Name the file of {wanted}."
)
ROOT_HAS = WRONG_NAMESPACE.says("The root element <{tag}> has {found}.", "Begin with {wanted}.")
FOREIGN = WRONG_NAMESPACE.says('<{tag}> is of another namespace, "{namespace}".')
UNKNOWN = UNKNOWN_ELEMENT.says("There is no <{tag}>.")
NOT_HERE = MISPLACED_ELEMENT.says("<{tag}> cannot stand in <{parent}>.")
HOLDS_TEXT = STRAY_TEXT.says('<{tag}> holds text: "{text}".')
NO_ATTRIBUTE = UNKNOWN_ATTRIBUTE.says('<{tag}> has no attribute "{name}".')
NEEDS = MISSING_ATTRIBUTE.says('<{tag}> needs the attribute "{name}": {doc}.')
NOT_OF_ITS_KIND = BAD_VALUE.says('{name} "{value}" {wrong}')


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
            raise DocumentError([OTHER_ROOT.at(root.place, tag=root.tag, root=tag)])
    own = kind_of(root)
    if own:
        wanted = one_of(DOCUMENTS.get(name, VOICEXML) for _, name in expected)
        runs = own in ("an application", VOICEXML) and wanted == "a scenario"
        hint = Hint(_as_application(root) if runs else "")
        raise DocumentError([OTHER_DOCUMENT.at(root.place, hint, own=own, wanted=wanted)])
    found = f'namespace "{root.namespace}"' if root.namespace else "no namespace"
    expected = [entry for entry in expected if entry[0] == root.tag] or expected
    wanted = " or ".join(f'<{tag} xmlns="{namespace}">' for tag, namespace in expected)
    spaces = [namespace for _, namespace in expected]
    near = suggestion(root.namespace, spaces, *value_span(root, "xmlns"))
    place = root.source.place(root.index, "xmlns", value=True)
    raise DocumentError([ROOT_HAS.at(place, near, tag=root.tag, found=found, wanted=wanted)])


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
        return FOREIGN.at(child.place, tag=tag, namespace=child.namespace)
    if tag not in vocabulary.tags:
        return UNKNOWN.at(child.place, _known_instead(child, parent, vocabulary), tag=tag)
    hint = Hint(misplaced_remedy(tag, parent, vocabulary))
    return NOT_HERE.at(child.place, hint, tag=tag, parent=parent.tag)


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
    hint = Hint(text_remedy(node, "speak" in vocabulary.tags))
    return HOLDS_TEXT.at(_text_place(node), hint, tag=node.tag, text=shown)


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
        value = item.choices[0] if len(item.choices) == 1 else "..."
        hint = added(f'Write {item.name}="{value}".', node, item)
        problems.append(NEEDS.at(node.place, hint, tag=node.tag, name=item.name, doc=item.doc))


def _bad_value(node: Node, name: str, bad: BadValue) -> Problem:
    spans = value_span(node, name) if bad.right else ()
    title = f"Change to {bad.right}" if bad.right.startswith("#") else ""
    hint = replaced(bad.remedy, bad.right, *spans, title=title)
    place, value = node.attribute_place(name), node.get(name)
    return NOT_OF_ITS_KIND.at(place, hint, name=name, value=value, wrong=bad.wrong)


def _language_problem(node: Node, text: str) -> list[Problem]:
    try:
        read_value("language", text)
    except BadValue as error:
        return [_bad_value(node, "xml:lang", error)]
    return []


def _unknown_attribute(
    node: Node, name: str, element: Element, known: list[str], missing: list[Attribute]
) -> Problem:
    """An attribute that is not known, with what is missing and meant by it."""
    hint = _attribute_instead(node, name, element, known, missing)
    if not hint:
        hint = Hint(f"It may have {one_of(known)}." if known else "It has no attributes.")
    place = node.attribute_place(name, value=False)
    return NO_ATTRIBUTE.at(place, hint, tag=node.tag, name=name)


def _attribute_instead(
    node: Node, name: str, element: Element, known: list[str], missing: list[Attribute]
) -> Hint:
    """What to write instead of an unknown attribute; what it means is no longer missing."""
    span = attribute_span(node, name)
    if name == "xml:lang":
        return Hint("Only the root element may have it.")
    if name == "lang" and node.index == 0:
        return replaced("Write xml:lang.", "xml:lang", span)
    if name.endswith("expr") and (right := f"{name[:-4]}-expr") in known:
        missing[:] = [item for item in missing if item.name != name[:-4]]
        return replaced(f"Write {right}.", right, span)
    if name == "next" and "goto" in element.children:
        return Hint(f'Put a goto inside: <goto next="{node.get(name)}"/>.')
    if near := nearest_word(name, [item.name for item in missing]):
        missing[:] = [item for item in missing if item.name != near]
        return meant(near, span)
    if missing:
        item = missing.pop(0)
        return Hint(f'Write {item.name}="...": {item.doc}.')
    if element.text and name in TEXTS:
        return Hint(f"Write the text inside: <{node.tag}>...</{node.tag}>.")
    return suggestion(name, known, span)


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
