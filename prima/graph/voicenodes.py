"""Texts, inputs and targets of VoiceXML elements."""

from __future__ import annotations

from prima.graph.labels import ASKED, LEAVES_USER, sayings
from prima.graph.model import clean
from prima.graph.throws import Taker
from prima.graph.transitions import Branches
from prima.interpreter.acts import type_of
from prima.interpreter.deadcontent import branches
from prima.markup.tree import Node
from prima.voicexml.arranging import is_unit, parts_of
from prima.voicexml.elements import HANDLERS, ITEMS, LEAVING, handler_names, handler_number, leaves
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, WORDED

MOST_DEEP = 40
"""Maximum depth of speech that is read."""


def takers(scope: Node) -> list[Taker[Node]]:
    """The handlers of a document, a dialog, a unit or an item."""
    return [_taker(node) for node in scope.all(*HANDLERS)]


def _taker(node: Node) -> Taker[Node]:
    named = node.tag == "catch"
    events = handler_names(node)
    stays = _does_something(node) and not ASKED.issuperset(events)
    return Taker(node.nodes, events, handler_number(node), node.get("cond").strip(), stays, named)


def _does_something(handler: Node) -> bool:
    """Whether a handler has content, and none that leads away."""
    empty = not handler.nodes and not handler.text
    return not empty and not any(one.tag in {*LEAVING, "throw"} for one in handler.walk())


def divided(node: Node) -> Branches[Node]:
    """The parts of an ``if`` with their conditions; ``else`` has none."""
    parts: list[tuple[str | None, list[Node]]] = []
    for head, part in branches(node):
        cond = None if head.tag == "else" else head.get("cond")
        parts.append((cond, [one for one in part if isinstance(one, Node)]))
    return parts


def leaves_user(node: Node) -> bool:
    """Whether an element is a Command of the robot that leaves the user."""
    return node.namespace == PRIMA_NAMESPACE and type_of(node) in LEAVES_USER


def leaves_at_its_end(form: Node) -> bool:
    """Whether a form is left before its items end; otherwise the application ends (2.1.6)."""
    units = [one for one in form.nodes if is_unit(one)]
    conditional = {id(item) for unit in units if unit.get("cond") for item in unit.nodes}
    contents = form.all("filled")
    for item in parts_of(form):
        asked_for = item.attributes.keys() & {"cond", "expr"} or id(item) in conditional
        if item.tag in ITEMS and not asked_for:
            contents += [item] if item.tag == "block" else item.all("filled")
    return any(leaves(content.nodes, throws=True) for content in contents)


def asked(node: Node) -> str:
    """The first question of a dialog or item."""
    prompts = [one for one in node.all("prompt") if one.get("count", "1") == "1"]
    text = said(prompts[0]) if prompts else ""
    return text or (node.text if node.tag in ("menu", "field") else "")


def said_by(link: Node) -> list[str]:
    """The utterances that follow a link, if its grammars show them."""
    words = sayings(link.all("grammar"))
    return [f"said {words}"] if words else []


def said(node: Node, depth: int = 0) -> str:
    """The words of a prompt or block, without those under conditions."""
    parts: list[str] = []
    for item in node.content:
        if isinstance(item, str):
            parts.append(item)
        elif item.tag == "value":
            parts.append(f"{{{item.get('expr')}}}")
        elif item.tag == "enumerate":
            parts.append("...")
        elif depth < MOST_DEEP and (
            item.namespace == PRIMA_NAMESPACE or item.tag in (*WORDED, "prompt")
        ):
            parts.append(" " + said(item, depth + 1) + " ")
    return clean(" ".join("".join(parts).split()))
