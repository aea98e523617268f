"""Schema problems in the author's words, from the same table that makes the schema."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from prima.errors import DocumentError, Place, Problem, did_you_mean, one_of, parted
from prima.language.values import KINDS, XML_SPACE, read_value
from prima.markup.slips import TEXTS, meant, misplaced_remedy, text_remedy
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute, Element, Vocabulary

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
    near = did_you_mean(root.namespace, [namespace for _, namespace in expected])
    remedy = near or f"Begin with {wanted}."
    place = root.source.place(root.index, "xmlns", value=True)
    raise DocumentError([Problem(place, "error", "wrong-namespace", message, remedy)])


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
        remedy = vocabulary.hints.get(tag) or did_you_mean(tag, vocabulary.children(parent.key))
        remedy = remedy or did_you_mean(tag, vocabulary.tags)
        return Problem(child.place, "error", "unknown-element", f"There is no <{tag}>.", remedy)
    message = f"<{tag}> cannot stand in <{parent.tag}>."
    remedy = misplaced_remedy(tag, parent, vocabulary)
    return Problem(child.place, "error", "misplaced-element", message, remedy)


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
        message = _value_problem(*entry, text)
        if message:
            place = node.attribute_place(name)
            wrong, remedy = parted(message)
            wrong = f'{name} "{text}" {wrong}'
            problems.append(Problem(place, "error", "bad-value", wrong, remedy))
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
        remedy = f'Write {item.name}="{value}".'
        problems.append(Problem(node.place, "error", "missing-attribute", message, remedy))


def _language_problem(node: Node, text: str) -> list[Problem]:
    try:
        read_value("language", text)
    except ValueError as error:
        wrong, remedy = parted(f'xml:lang "{text}" {error}')
        place = node.attribute_place("xml:lang")
        return [Problem(place, "error", "bad-value", wrong, remedy)]
    return []


def _unknown_attribute(
    node: Node, name: str, element: Element, known: list[str], missing: list[Attribute]
) -> Problem:
    """An attribute that is not known; what is missing and meant by it is told with it."""
    wanted = [item.name for item in missing]
    if name == "xml:lang":
        remedy = "It stands on the root element alone."
    elif name == "lang" and node.index == 0:
        remedy = "Write xml:lang."
    elif name.endswith("expr") and f"{name[:-4]}-expr" in known:
        remedy = f"Write {name[:-4]}-expr."
        missing[:] = [item for item in missing if item.name != name[:-4]]
    elif name == "next" and "goto" in element.children:
        remedy = f'Put a goto inside: <goto next="{node.get(name)}"/>.'
    elif near := did_you_mean(name, wanted):
        remedy = near
        missing[:] = [item for item in missing if f'"{item.name}"' not in near]
    elif missing:
        item = missing.pop(0)
        remedy = f'Write {item.name}="...": {item.doc}.'
    elif element.text and name in TEXTS:
        remedy = f"Write the text inside: <{node.tag}>...</{node.tag}>."
    else:
        remedy = did_you_mean(name, known)
    if not remedy:
        remedy = f"It may have {one_of(known)}." if known else "It has no attributes."
    message = f'<{node.tag}> has no attribute "{name}".'
    place = node.attribute_place(name, value=False)
    return Problem(place, "error", "unknown-attribute", message, remedy)


def _value_problem(item: Attribute, is_expression: bool, text: str) -> str:
    if item.choices and not is_expression:
        if text in item.choices:
            return ""
        hint = did_you_mean(text, item.choices) or f"Write {one_of(item.choices)}."
        return f"is not allowed here. {hint}"
    try:
        read_value("expression" if is_expression else item.kind, text)
    except ValueError as error:
        right = "" if is_expression else meant(item.kind, text)
        wrong = str(error).partition(". ")[0].rstrip(".")
        return f'{wrong}. Write "{right}".' if right else str(error)
    return ""
