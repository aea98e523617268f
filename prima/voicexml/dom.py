"""The read-only DOM of ``data`` in ECMAScript (VoiceXML 2.1, appendix D)."""

from __future__ import annotations

from typing import Any
from xml.parsers import expat

from prima.errors import DocumentError
from prima.interpreter.transfers import Thrown
from prima.markup.reader import parse
from prima.messages import Json

XMLNS = "http://www.w3.org/2000/xmlns/"
ELEMENT, ATTRIBUTE, TEXT, CDATA, INSTRUCTION, COMMENT = 1, 2, 3, 4, 7, 8

DOM = r"""(function () {
  const KINDS = { ELEMENT_NODE: 1, ATTRIBUTE_NODE: 2, TEXT_NODE: 3, CDATA_SECTION_NODE: 4,
    ENTITY_REFERENCE_NODE: 5, ENTITY_NODE: 6, PROCESSING_INSTRUCTION_NODE: 7, COMMENT_NODE: 8,
    DOCUMENT_NODE: 9, DOCUMENT_TYPE_NODE: 10, DOCUMENT_FRAGMENT_NODE: 11, NOTATION_NODE: 12 };
  const CODES = { INDEX_SIZE_ERR: 1, DOMSTRING_SIZE_ERR: 2, HIERARCHY_REQUEST_ERR: 3,
    WRONG_DOCUMENT_ERR: 4, INVALID_CHARACTER_ERR: 5, NO_DATA_ALLOWED_ERR: 6,
    NO_MODIFICATION_ALLOWED_ERR: 7, NOT_FOUND_ERR: 8, NOT_SUPPORTED_ERR: 9,
    INUSE_ATTRIBUTE_ERR: 10, INVALID_STATE_ERR: 11, SYNTAX_ERR: 12,
    INVALID_MODIFICATION_ERR: 13, NAMESPACE_ERR: 14, INVALID_ACCESS_ERR: 15 };
  const NAMES = { 3: '#text', 4: '#cdata-section', 8: '#comment', 9: '#document' };
  const OWN = Symbol('own');  // what a node is made of: nothing else refers to it
  function DOMException(message, code) { this.message = message; this.code = code; }
  DOMException.prototype = Object.assign(Object.create(Error.prototype), CODES);
  DOMException.prototype.constructor = DOMException;
  DOMException.prototype.name = 'DOMException';
  Object.assign(DOMException, CODES);
  function Node() { throw new TypeError('nodes are made by data alone'); }
  Object.assign(Node, KINDS);
  function no() { throw new DOMException('the document cannot be changed', 7); }
  function item(i) { return this[i >>> 0] || null; }
  function named(name) { return this.find(function (one) { return one.name === name; }) || null; }
  function namedNS(uri, name) {
    return this.find(function (one) {
      return one.namespaceURI === (uri || null) && one.localName === name; }) || null; }
  const LIST = Object.create(Array.prototype, { item: { value: item } });
  const MAP = Object.create(LIST, { getNamedItem: { value: named }, getNamedItemNS: { value: namedNS },
    setNamedItem: { value: no }, setNamedItemNS: { value: no },
    removeNamedItem: { value: no }, removeNamedItemNS: { value: no } });
  function list(items, kind) { return Object.freeze(Object.setPrototypeOf(items, kind || LIST)); }
  const NONE = list([]);
  function hasFeature(name, version) {
    return String(name).toLowerCase() === 'core' && [undefined, null, '', '1.0', '2.0'].includes(version); }
  function text(data) {
    if (data.content === undefined) return data.value || '';
    return data.content.map(function (one) { return one.type === 7 || one.type === 8 ? '' : text(one); }).join('');
  }
  function beside(node, step) {
    const own = node[OWN];
    return (own.parent && own.index >= 0 && own.parent.childNodes[own.index + step]) || null; }
  const node = Node.prototype = Object.assign({
    get nodeType() { return this[OWN].data.type; },
    get nodeName() { return this[OWN].data.name || NAMES[this.nodeType]; },
    get nodeValue() { const value = this[OWN].data.value; return value === undefined ? null : value; },
    get parentNode() { return this[OWN].index >= 0 ? this[OWN].parent : null; },
    get ownerDocument() { return this[OWN].owner; },
    get childNodes() {
      const own = this[OWN], me = this;
      if (own.data.content !== undefined && own.nodes === undefined)
        own.nodes = list(own.data.content.map(function (one, i) { return make(one, me, own.owner || me, i); }));
      return own.nodes || NONE; },
    get firstChild() { return this.childNodes.item(0); },
    get lastChild() { return this.childNodes.item(this.childNodes.length - 1); },
    get previousSibling() { return beside(this, -1); },
    get nextSibling() { return beside(this, 1); },
    get attributes() { return null; },
    get namespaceURI() { return this[OWN].data.uri || null; },
    get prefix() { return this[OWN].data.prefix || null; },
    get localName() { return this[OWN].data.local || null; },
    get textContent() { return text(this[OWN].data); },
    hasChildNodes: function () { return this.childNodes.length > 0; },
    hasAttributes: function () { return this.attributes !== null && this.attributes.length > 0; },
    isSupported: hasFeature }, KINDS);
  Object.defineProperties(node, { toJSON: { value: function () { return this.textContent; } },
    toString: { value: function () { return this.textContent; } }, constructor: { value: Node } });
  for (const name of ['insertBefore', 'replaceChild', 'removeChild', 'appendChild', 'normalize',
      'setAttribute', 'removeAttribute', 'setAttributeNode', 'removeAttributeNode', 'setAttributeNS',
      'removeAttributeNS', 'setAttributeNodeNS', 'appendData', 'insertData', 'deleteData',
      'replaceData', 'splitText', 'createElement', 'createElementNS', 'createTextNode',
      'createAttribute', 'createAttributeNS', 'createComment', 'createCDATASection',
      'createProcessingInstruction', 'createDocumentFragment', 'createEntityReference', 'importNode'])
    node[name] = no;
  function kind(properties) {
    return Object.create(node, Object.getOwnPropertyDescriptors(properties)); }
  function find(from, fits, found) {
    for (const child of from.childNodes)
      if (child.nodeType === 1) {
        if (fits(child)) found.push(child);
        find(child, fits, found);
      }
    return found;
  }
  function byName(name) {
    return list(find(this, function (one) { return name === '*' || one.nodeName === name; }, [])); }
  function byNameNS(uri, name) {
    return list(find(this, function (one) {
      return (uri === '*' || one.namespaceURI === (uri || null)) && (name === '*' || one.localName === name); }, [])); }
  const characters = kind({
    get data() { return this.nodeValue; }, get length() { return this.nodeValue.length; },
    substringData: function (from, count) {
      if (from < 0 || from > this.length || count < 0) throw new DOMException('there are no such characters', 1);
      return this.nodeValue.substr(from, count); } });
  const KIND = { 3: characters, 4: characters, 8: characters,
    1: kind({
      get tagName() { return this.nodeName; },
      get attributes() {
        const own = this[OWN], me = this;
        return own.map || (own.map = list(own.data.attributes.map(function (one) {
          return make(one, me, own.owner, -1); }), MAP)); },
      getAttributeNode: function (name) { return this.attributes.getNamedItem(name); },
      getAttributeNodeNS: function (uri, name) { return this.attributes.getNamedItemNS(uri, name); },
      getAttribute: function (name) { const one = this.getAttributeNode(name); return one ? one.value : ''; },
      getAttributeNS: function (uri, name) { const one = this.getAttributeNodeNS(uri, name); return one ? one.value : ''; },
      hasAttribute: function (name) { return this.getAttributeNode(name) !== null; },
      hasAttributeNS: function (uri, name) { return this.getAttributeNodeNS(uri, name) !== null; },
      getElementsByTagName: byName, getElementsByTagNameNS: byNameNS }),
    2: kind({
      get name() { return this.nodeName; }, get value() { return this.nodeValue; },
      get specified() { return true; }, get ownerElement() { return this[OWN].parent; },
      get childNodes() {
        const own = this[OWN];
        return own.nodes || (own.nodes = list(this.value === '' ? []
          : [make({ type: 3, value: this.value }, this, own.owner, 0)])); } }),
    7: kind({ get target() { return this.nodeName; }, get data() { return this.nodeValue; } }),
    9: kind({
      get doctype() { return null; },
      get implementation() { return Object.freeze({ hasFeature: hasFeature }); },
      get documentElement() { return this.childNodes.find(function (one) { return one.nodeType === 1; }); },
      getElementById: function (id) {
        return find(this, function (one) { return one.getAttribute('id') === id; }, [])[0] || null; },
      getElementsByTagName: byName, getElementsByTagNameNS: byNameNS }) };
  for (const one of [node, ...Object.values(KIND)]) Object.freeze(one);
  function make(data, parent, owner, index) {
    return Object.defineProperty(Object.create(KIND[data.type]), OWN,
      { value: { data: data, parent: parent, owner: owner, index: index, nodes: undefined, map: undefined } });
  }
  return { Node: Node, DOMException: DOMException,
    whole: function (content) { return make({ type: 9, content: content }, null, null, -1); } };
})()"""
"""Makes read-only documents of :func:`plain_tree`, and their two classes.

A node is created when a script first accesses it.
"""


def plain_tree(uri: str, data: bytes, place: str) -> list[Any]:
    """An XML document as plain data: the nodes beside and with its root element.

    Raises:
        Thrown: ``error.badfetch``: it is not well-formed, or beyond the limits of documents.
    """
    try:
        text = parse(uri, data).source.text
    except DocumentError as error:
        raise Thrown("error.badfetch", f"{place}: {error.problems[0]}", place) from None
    return _DomBuilder().build(text)


class _DomBuilder:
    """Collects the nodes of a document that is known to be well-formed."""

    def __init__(self) -> None:
        self.top: list[Any] = []
        self._open: list[list[Any]] = [self.top]
        self._declared: list[Json] = []
        self._cdata = False

    def build(self, text: str) -> list[Any]:
        parser = expat.ParserCreate(encoding="utf-8", namespace_separator=" ")
        parser.namespace_prefixes = True
        parser.buffer_text = True
        data = text.encode()
        parser.buffer_size = max(len(data), 1)  # the text between two tags is one node
        parser.StartNamespaceDeclHandler = self._declare
        parser.StartElementHandler = self._start
        parser.EndElementHandler = lambda _name: self._open.pop()
        parser.CharacterDataHandler = self._text
        parser.CommentHandler = lambda text: self._add(COMMENT, text)
        parser.ProcessingInstructionHandler = self._instruct
        parser.StartCdataSectionHandler = lambda: self._section(True)
        parser.EndCdataSectionHandler = lambda: self._section(False)
        parser.Parse(data, True)
        return self.top

    def _add(self, kind: int, value: str, **more: Json) -> None:
        self._open[-1].append({"type": kind, "value": value, **more})

    def _text(self, text: str) -> None:
        self._add(CDATA if self._cdata else TEXT, text)

    def _section(self, begins: bool) -> None:
        self._cdata = begins

    def _instruct(self, target: str, text: str) -> None:
        self._add(INSTRUCTION, text, name=target)

    def _declare(self, prefix: str | None, uri: str | None) -> None:
        """A namespace declaration is an attribute as well (DOM 2, 1.1.8)."""
        named = {"name": f"xmlns:{prefix}", "prefix": "xmlns", "local": prefix}
        bare = {"name": "xmlns", "prefix": "", "local": "xmlns"}
        more = {"type": ATTRIBUTE, "uri": XMLNS, "value": uri or ""}
        self._declared.append({**(named if prefix else bare), **more})

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        own: list[Json] = [
            {"type": ATTRIBUTE, **_named(key), "value": value} for key, value in attributes.items()
        ]
        content: list[Any] = []
        made = {"type": ELEMENT, **_named(name), "attributes": own + self._declared}
        self._open[-1].append({**made, "content": content})
        self._open.append(content)
        self._declared = []


def _named(name: str) -> dict[str, str]:
    """The parts of a name as the parser gives it: namespace, local name and prefix."""
    uri, local, prefix = (["", name, ""] if " " not in name else [*name.split(" "), ""])[:3]
    whole = f"{prefix}:{local}" if prefix else local
    made = {"name": whole, "uri": uri, "prefix": prefix, "local": local}
    return {key: value for key, value in made.items() if value}
