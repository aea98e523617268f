"""XML Schemas made from tables of elements, with documentation for editors' hover."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape

from prima.language.values import KINDS
from prima.markup.vocabulary import Attribute, Element, Vocabulary
from tools.guests import Guests, OpenVocabulary, is_free

XML_SCHEMA = r"""<?xml version="1.0" encoding="UTF-8"?>
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema"
           targetNamespace="http://www.w3.org/XML/1998/namespace">
  <xs:attribute name="lang">
    <xs:annotation><xs:documentation>The language of the document, as in en or ja.</xs:documentation></xs:annotation>
    <xs:simpleType>
      <xs:restriction base="xs:string">
        <xs:pattern value="\s*|[A-Za-z]{1,8}(-[A-Za-z0-9]{1,8})*"/>
      </xs:restriction>
    </xs:simpleType>
  </xs:attribute>
  <xs:attribute name="base" type="xs:string">
    <xs:annotation><xs:documentation>What relative addresses are relative to.</xs:documentation></xs:annotation>
  </xs:attribute>
</xs:schema>
"""
"""The attributes of the xml namespace that documents use."""


def make_catalog(files: Mapping[str, str]) -> str:
    """Give an OASIS XML catalogue that finds schemas by the namespaces of documents.

    Args:
        files: file names by namespaces.
    """
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<catalog xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog" prefer="public">',
    ]
    for namespace, file in files.items():
        lines.append(f'  <uri name="{namespace}" uri="{file}"/>')
        lines.append(f'  <system systemId="{namespace}" uri="{file}"/>')
    return "\n".join([*lines, "</catalog>", ""])


def make_locating_rules(files: Mapping[str, str]) -> str:
    """Give the rules by which Emacs finds RELAX NG schemas.

    Args:
        files: file names by namespaces.
    """
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<locatingRules xmlns="http://thaiopensource.com/ns/locating-rules/1.0">',
        *(f'  <namespace ns="{namespace}" uri="{file}"/>' for namespace, file in files.items()),
    ]
    return "\n".join([*lines, "</locatingRules>", ""])


def make_schema(vocabulary: Vocabulary) -> str:
    """Give the XML Schema 1.0 of a kind of document as text."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema"',
        f'           xmlns="{vocabulary.namespace}" targetNamespace="{vocabulary.namespace}"',
        '           elementFormDefault="qualified">',
        '  <xs:import namespace="http://www.w3.org/XML/1998/namespace" schemaLocation="xml.xsd"/>',
        *(_import(vocabulary.guests) if isinstance(vocabulary, OpenVocabulary) else ()),
        f'  <xs:element name="{vocabulary.root_tag}" type="{vocabulary.root}"/>',
    ]
    for element in vocabulary.elements.values():
        lines += _complex_type(vocabulary, element)
    return "\n".join([*lines, *_kinds(vocabulary.elements.values()), "</xs:schema>", ""])


def make_guest_schema(guests: Guests) -> str:
    """Give the XML Schema 1.0 of elements in documents of another namespace."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema"',
        f'           xmlns="{guests.namespace}" targetNamespace="{guests.namespace}"',
        '           elementFormDefault="qualified">',
    ]
    for element in guests.elements:
        lines += [f'  <xs:element name="{element.tag}">', '    <xs:complexType mixed="true">']
        lines += [
            _doc(f"{element.doc} ({element.source})", "      "),
            '      <xs:sequence><xs:any namespace="##any" processContents="lax"'
            ' minOccurs="0" maxOccurs="unbounded"/></xs:sequence>',
        ]
        lines += [f"  {line}" for item in element.attributes for line in _attribute(item)]
        lines += ['      <xs:anyAttribute namespace="##other" processContents="skip"/>']
        lines += ["    </xs:complexType>", "  </xs:element>"]
    return "\n".join([*lines, *_kinds(guests.elements), "</xs:schema>", ""])


def _import(guests: Guests) -> list[str]:
    return [f'  <xs:import namespace="{guests.namespace}" schemaLocation="{guests.name}.xsd"/>']


def _kinds(elements: Iterable[Element]) -> list[str]:
    """The simple types of attributes."""
    named = [item for one in elements for item in one.attributes]
    kinds = {item.kind for item in named if not item.choices} | {"expression"}
    return [line for kind in sorted(kinds) for line in _simple_type(kind)]


def _doc(text: str, indent: str) -> str:
    return (
        f"{indent}<xs:annotation><xs:documentation>{escape(text, quote=False)}"
        "</xs:documentation></xs:annotation>"
    )


ANYTHING = '<xs:any namespace="##any" processContents="skip"/>'
FOREIGN = '<xs:any namespace="##other" processContents="lax"/>'


def _complex_type(vocabulary: Vocabulary, element: Element) -> list[str]:
    mixed = ' mixed="true"' if element.text else ""
    source = f" ({element.source})" if element.source else ""
    lines = [f'  <xs:complexType name="{element.key}"{mixed}>', _doc(element.doc + source, "    ")]
    lines += _content(vocabulary, element)
    for item in element.attributes:
        lines += _attribute(item)
    named = {item.name for item in element.attributes}
    if element.key == vocabulary.root and "xml:lang" not in named:
        lines.append('    <xs:attribute ref="xml:lang"/>')
    return [*lines, "  </xs:complexType>"]


def _content(vocabulary: Vocabulary, element: Element) -> list[str]:
    """The possible content of an element, if any."""
    held = [
        f'<xs:element name="{vocabulary.elements[child].tag}" type="{child}"/>'
        for child in element.children
    ]
    held += [FOREIGN] if held and isinstance(vocabulary, OpenVocabulary) else []
    held = [ANYTHING] if is_free(vocabulary, element.key) else held
    if not held:
        return []
    lines = [f"      {one}" for one in held]
    return ['    <xs:choice minOccurs="0" maxOccurs="unbounded">', *lines, "    </xs:choice>"]


def _attribute(item: Attribute) -> list[str]:
    use = ' use="required"' if item.required and not item.dynamic else ""
    if item.name.startswith("xml:"):
        return [f'    <xs:attribute ref="{item.name}"{use}/>']
    doc = item.doc + (f" (default: {item.default})" if item.default else "")
    if item.choices:
        values = "".join(f'<xs:enumeration value="{value}"/>' for value in item.choices)
        simple = f'<xs:restriction base="xs:string">{values}</xs:restriction>'
        held = [f"      <xs:simpleType>{simple}</xs:simpleType>"]
        lines = _attribute_lines(f'name="{item.name}"{use}', doc, *held)
    else:
        lines = _attribute_lines(f'name="{item.name}" type="kind-{item.kind}"{use}', doc)
    if item.dynamic:
        doc = f"An expression that gives {item.name}: {item.doc}"
        lines += _attribute_lines(f'name="{item.name}-expr" type="kind-expression"', doc)
    return lines


def _attribute_lines(attributes: str, doc: str, *held: str) -> list[str]:
    return [f"    <xs:attribute {attributes}>", _doc(doc, "      "), *held, "    </xs:attribute>"]


def _simple_type(kind: str) -> list[str]:
    row = KINDS[kind]
    pattern = f'<xs:pattern value="{escape(row.pattern)}"/>' if row.pattern else ""
    space = "preserve" if kind == "text" else "collapse"
    return [
        f'  <xs:simpleType name="kind-{kind}">',
        _doc(row.doc, "    "),
        f'    <xs:restriction base="xs:string"><xs:whiteSpace value="{space}"/>{pattern}'
        "</xs:restriction>",
        "  </xs:simpleType>",
    ]
