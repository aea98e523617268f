"""RELAX NG schemas (compact syntax) made from tables of elements, as Emacs reads them."""

from __future__ import annotations

from prima.language.values import KINDS
from prima.markup.vocabulary import Attribute, Element, Vocabulary
from tools.guests import OpenVocabulary, is_free

HEAD = """\
# Made from the tables of elements by python -m tools.reference.
default namespace = "{namespace}"
namespace own = "{namespace}"
namespace xsi = "http://www.w3.org/2001/XMLSchema-instance"
datatypes xsd = "http://www.w3.org/2001/XMLSchema-datatypes"
{more}
start = e-{root}
"""
ANYTHING = """
anything = (attribute * { text } | text | element * { anything })*
"""
GUESTS = """\
foreign = element * - (own:* | p:*) { anything } | guest
guest = {names}
"""


def make_rnc(vocabulary: Vocabulary) -> str:
    """Give the RELAX NG schema of a kind of document in the compact syntax."""
    guests = vocabulary.guests if isinstance(vocabulary, OpenVocabulary) else None
    more = f'namespace p = "{guests.namespace}"\n' if guests is not None else ""
    parts = [HEAD.format(namespace=vocabulary.namespace, root=vocabulary.root, more=more)]
    parts += [_element(vocabulary, element) for element in vocabulary.elements.values()]
    parts += _foreign(vocabulary)
    elements = [*vocabulary.elements.values(), *(guests.elements if guests is not None else ())]
    kinds = {item.kind for one in elements for item in one.attributes if not item.choices}
    parts += ["\n", *(_kind(kind) for kind in sorted(kinds | {"expression"}))]
    return "".join(parts)


def _foreign(vocabulary: Vocabulary) -> list[str]:
    """The elements of other namespaces, where any are allowed."""
    if not isinstance(vocabulary, OpenVocabulary):
        return []
    guests = vocabulary.guests.elements
    names = " | ".join(f"p-{one.key}" for one in guests)
    return [ANYTHING, GUESTS.replace("{names}", names), *map(_guest, guests)]


def _element(vocabulary: Vocabulary, element: Element) -> str:
    parts = [_attribute(item) for item in element.attributes]
    if element.key == vocabulary.root:
        if all(item.name != "xml:lang" for item in element.attributes):
            tag = "[A-Za-z]{1,8}(-[A-Za-z0-9]{1,8})*"
            parts.append(f'attribute xml:lang {{ "" | xsd:token {{ pattern = "{tag}" }} }}?')
        parts.append("attribute xsi:* { text }*")
    body = ",\n    ".join([*parts, *_content(vocabulary, element)]) or "empty"
    return f"\n{_doc(element.doc, element.source)}e-{element.key} =\n  element {element.tag} {{\n    {body}\n  }}\n"


def _content(vocabulary: Vocabulary, element: Element) -> list[str]:
    """The possible content of an element, if any."""
    if is_free(vocabulary, element.key):
        return ["(text | element * { anything })*"]
    held = ["text"] if element.text else []
    held += [f"e-{key}" for key in element.children]
    held += ["foreign"] if isinstance(vocabulary, OpenVocabulary) and element.children else []
    return held if held in ([], ["text"]) else [f"({' | '.join(held)})*"]


def _guest(element: Element) -> str:
    """An element of another namespace: its attributes; its children are the vocabulary's own."""
    parts = [*(_attribute(item) for item in element.attributes), "attribute xml:* { text }*"]
    others = "(own:* | p:*)" if element.children else "p:*"
    own = "".join(f"e-{key} | " for key in element.children)
    parts.append(f"(text | guest | {own}element * - {others} {{ anything }})*")
    body, doc = ",\n    ".join(parts), _doc(element.doc, element.source)
    return f"\n{doc}p-{element.key} =\n  element p:{element.tag} {{\n    {body}\n  }}\n"


def _doc(doc: str, source: str) -> str:
    text = " ".join(f"{doc} ({source})".split()) if source else doc
    return f"## {text.strip()}\n" if text.strip() else ""


def _attribute(item: Attribute) -> str:
    if item.choices:
        value = " | ".join(f'string "{choice}"' for choice in item.choices)
    else:
        value = f"kind-{item.kind}"
    plain = f"attribute {item.name} {{ {value} }}"
    expression = f"attribute {item.name}-expr {{ kind-expression }}"
    if not item.dynamic:
        return plain if item.required else f"{plain}?"
    if item.required:
        return f"({plain} | {expression})"
    return f"{plain}?,\n    {expression}?"


def _kind(kind: str) -> str:
    row = KINDS[kind]
    if kind == "text":
        return "kind-text = text\n"
    return f'kind-{kind} = xsd:token {{ pattern = "{row.pattern}" }}\n'
