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
LEAVING = ("goto", "submit", "exit", "return", "disconnect")
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


def to_item(node: Node) -> bool:
    """Whether a goto leads to an item of its own dialog."""
    return bool(node.attributes.keys() & {"nextitem", "expritem"})


def leaves(content: Iterable[Node | str], throws: bool = False) -> bool:
    """Whether content always leaves its dialog; with ``throws``, an event does."""
    for node in (one for one in content if isinstance(one, Node)):
        if node.tag in LEAVING or (throws and node.tag == "throw"):
            return not to_item(node)
        if node.tag == "if" and _complete(node, throws):
            return True
    return False


def returns(node: Node) -> bool:
    """Whether there is a return in an element."""
    return any(one.tag == "return" for one in node.walk())


def _complete(node: Node, throws: bool) -> bool:
    """Whether each branch of an ``if`` leaves its dialog, one of them being ``else``."""
    branches: list[list[Node | str]] = [[]]
    for one in node.content:
        if isinstance(one, Node) and one.tag in ("elseif", "else"):
            branches.append([])
        else:
            branches[-1].append(one)
    complete = any(one.tag == "else" for one in node.nodes)
    return complete and all(leaves(one, throws) for one in branches)
