"""Reading: a VoiceXML document as nodes, checked by the table; its dialogs by name."""

from __future__ import annotations

from prima.errors import Problem
from prima.errors.diagnoses.structure import DUPLICATE_ID, NO_NAMESPACE
from prima.markup.reader import parse
from prima.markup.roots import check_root
from prima.markup.spans import with_namespace
from prima.markup.tree import Node
from prima.voicexml.arranging import is_unit
from prima.voicexml.checks import check_tree
from prima.voicexml.document import Page, broken
from prima.voicexml.site import Site
from prima.voicexml.sketched import unit_errors
from prima.voicexml.upgrade import VERSIONS, old, upgrade
from prima.voicexml.vocabulary import NAMESPACE, VOICEXML

TWO_DIALOGS = DUPLICATE_ID.says('There are two dialogs "{name}".', "Rename one.")
READ_AS_VOICEXML = NO_NAMESPACE.says(
    "The root element <vxml> has no namespace: it is read as VoiceXML."
)


def read_page(uri: str, file: str, data: bytes, site: Site | None = None) -> Page:
    """Read a VoiceXML document; its folder may be a copy of a site.

    Raises:
        DocumentError: it is not well-formed, or not VoiceXML at all.
    """
    root = parse(file, data, (VOICEXML,))
    bare = _without_namespace(root)
    check_root(root, (VOICEXML,))
    if old(root):
        upgrade(root)
    page = Page(uri, root, problems=[*bare, *check_tree(root)], site=site)
    for node in root.all("form", "menu"):
        name = node.get("id") or f"#{len(page.dialogs) + 1}"
        if name in page.dialogs:
            page.problems.append(TWO_DIALOGS.at(node.attribute_place("id"), name=name))
        page.dialogs.setdefault(name, node)
    units = any(is_unit(one) for form in root.all("form") for one in form.nodes)
    if units and broken(page) is None:
        page.problems += unit_errors(page)
    return page


def _without_namespace(root: Node) -> list[Problem]:
    """Accept a ``<vxml>`` without any namespace as VoiceXML, with a warning.

    The platforms for which such documents were written do the same.
    """
    if root.tag != "vxml" or root.namespace:
        return []
    for node in root.walk():
        node.namespace = node.namespace or NAMESPACE
    if root.get("version", VERSIONS[0]).strip() not in VERSIONS:
        return []  # VoiceXML 1.0 has no namespace
    hint = with_namespace(f'Write <vxml xmlns="{NAMESPACE}">.', root, NAMESPACE)
    return [READ_AS_VOICEXML.at(root.place, hint)]
