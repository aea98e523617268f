"""The read-only DOM of ``data`` in ECMAScript (VoiceXML 2.1, appendix D)."""

from __future__ import annotations

from prima.errors import DocumentError
from prima.markup.reader import parse
from prima.markup.tree import Node
from prima.messages import Json
from prima.voicexml.state import Thrown

DATA = r"""function (tree) {
  const ELEMENT = 1, ATTRIBUTE = 2, TEXT = 3, DOCUMENT = 9;
  function no() { const error = new Error('the document cannot be changed'); error.code = 7; throw error; }
  const base = { ELEMENT_NODE: 1, ATTRIBUTE_NODE: 2, TEXT_NODE: 3, CDATA_SECTION_NODE: 4,
    ENTITY_REFERENCE_NODE: 5, ENTITY_NODE: 6, PROCESSING_INSTRUCTION_NODE: 7, COMMENT_NODE: 8,
    DOCUMENT_NODE: 9, DOCUMENT_TYPE_NODE: 10, DOCUMENT_FRAGMENT_NODE: 11, NOTATION_NODE: 12,
    hasChildNodes: function () { return this.childNodes.length > 0; },
    hasAttributes: function () { return this.attributes !== null && this.attributes.length > 0; },
    toJSON: function () { return this.textContent; },
    toString: function () { return this.textContent; } };
  for (const name of ['insertBefore', 'replaceChild', 'removeChild', 'appendChild', 'setAttribute',
      'removeAttribute', 'setAttributeNode', 'removeAttributeNode', 'normalize', 'appendData',
      'insertData', 'deleteData', 'replaceData', 'splitText', 'createElement', 'createTextNode'])
    base[name] = no;
  function list(items) {
    items.item = function (i) { return i >= 0 && i < items.length ? items[i] : null; };
    return Object.freeze(items);
  }
  function make(type, name, value, parent, owner) {
    const node = Object.create(base);
    return Object.assign(node, { nodeType: type, nodeName: name, nodeValue: value, parentNode: parent,
      ownerDocument: owner, childNodes: [], firstChild: null, lastChild: null, previousSibling: null,
      nextSibling: null, attributes: null, namespaceURI: null, prefix: null, localName: null });
  }
  function find(node, fits, found) {
    for (const child of node.childNodes) {
      if (child.nodeType === ELEMENT && fits(child)) found.push(child);
      find(child, fits, found);
    }
    return found;
  }
  function search(node) {
    node.getElementsByTagName = function (name) {
      return list(find(node, function (one) { return name === '*' || one.nodeName === name; }, [])); };
    node.getElementsByTagNameNS = function (uri, name) {
      return list(find(node, function (one) {
        return (uri === '*' || one.namespaceURI === uri) && (name === '*' || one.localName === name); }, [])); };
  }
  function add(parent, child) {
    const before = parent.lastChild;
    child.previousSibling = before;
    if (before) before.nextSibling = child; else parent.firstChild = child;
    parent.lastChild = child;
    parent.childNodes.push(child);
  }
  function attributesOf(data, node, owner) {
    const made = Object.keys(data).map(function (name) {
      const one = make(ATTRIBUTE, name, data[name], null, owner);
      one.name = one.localName = name; one.value = one.textContent = data[name];
      one.specified = true; one.ownerElement = node; one.childNodes = list([]);
      return Object.freeze(one);
    });
    made.getNamedItem = function (name) {
      return made.find(function (one) { return one.name === name; }) || null; };
    return list(made);
  }
  function text(data, parent, owner) {
    const node = make(TEXT, '#text', data, parent, owner);
    node.data = node.textContent = data; node.length = data.length;
    node.substringData = function (from, count) { return data.substr(from, count); };
    return node;
  }
  function element(data, parent, owner) {
    const node = make(ELEMENT, data.tag, null, parent, owner);
    node.tagName = node.localName = data.tag;
    node.namespaceURI = data.namespace || null;
    node.attributes = attributesOf(data.attributes, node, owner);
    node.getAttribute = function (name) { const own = data.attributes[name]; return own === undefined ? '' : own; };
    node.hasAttribute = function (name) { return data.attributes[name] !== undefined; };
    node.getAttributeNode = node.attributes.getNamedItem;
    search(node);
    for (const child of data.content)
      add(node, typeof child === 'string' ? text(child, node, owner) : element(child, node, owner));
    node.textContent = node.childNodes.map(function (one) { return one.textContent; }).join('');
    return node;
  }
  function close(node) {
    node.childNodes.forEach(close);
    list(node.childNodes);
    return Object.freeze(node);
  }
  const whole = make(DOCUMENT, '#document', null, null, null);
  whole.documentElement = element(tree, whole, whole);
  add(whole, whole.documentElement);
  whole.textContent = whole.documentElement.textContent;
  search(whole);
  whole.getElementById = function (id) {
    return find(whole, function (one) { return one.getAttribute('id') === id; }, [])[0] || null; };
  return close(whole);
}"""
"""Makes the document of a :func:`plain_tree`. Nothing in it can be changed."""


def plain_tree(uri: str, data: bytes, place: str) -> Json:
    """An XML document as plain data.

    Raises:
        Thrown: ``error.badfetch``: it is not well-formed.
    """
    try:
        return _plain(parse(uri, data))
    except DocumentError as error:
        raise Thrown("error.badfetch", f"{place}: {error.problems[0]}", place) from None


def _plain(node: Node) -> Json:
    return {
        "tag": node.tag,
        "namespace": node.namespace,
        "attributes": node.attributes,
        "content": [item if isinstance(item, str) else _plain(item) for item in node.content],
    }
