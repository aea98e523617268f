"""Parts of VoiceXML documents, and the targets of their content."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.interpreter.selection import takes
from prima.markup.tree import Node
from prima.voicexml.arranging import UNIT
from prima.voicexml.elements import HANDLERS, ITEMS
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

HOLDING = frozenset([*ITEMS, *HANDLERS, "form", "menu", "filled", "if", "foreach"])
"""Elements whose text is spoken, or that contain such elements."""
SERVICES = "error.service"
OWN = ("noinput", "nomatch", "help", "cancel", "exit", "error", "maxspeechtimeout")
"""VoiceXML's own events: handling them is not a reaction."""


def holders(node: Node) -> Iterator[Node]:
    """An element and its descendants that may speak themselves."""
    if node.tag in HOLDING:
        yield node
    if node.tag in HOLDING or node.key == UNIT:
        for inner in node.nodes:
            yield from holders(inner)


def commands_in(node: Node) -> Iterator[Node]:
    """The outermost elements of PRIMA's namespace in an element, or the element itself."""
    if node.namespace == PRIMA_NAMESPACE:
        yield node
        return
    for inner in node.nodes:
        yield from commands_in(inner)


def says(pieces: Iterable[Node | str]) -> bool:
    """Whether some pieces contain anything to say."""
    return any(isinstance(one, Node) or one.strip() for one in pieces)


def is_foreign(name: str) -> bool:
    """Whether an event may come from the user or the surroundings."""
    return takes(SERVICES, name) or not any(takes(one, name) for one in OWN)


def thrown_by(root: Node) -> Iterator[str]:
    """The events that a document throws itself; the empty name means those of expressions."""
    for node in root.walk():
        if node.tag in ("throw", "link", "choice", "return"):
            if node.get("event"):
                yield node.get("event")
            elif node.get("eventexpr"):
                yield ""


def returns(node: Node) -> bool:
    """Whether there is a return in an element."""
    return any(one.tag == "return" for one in node.walk())
