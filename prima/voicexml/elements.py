"""Groups of elements that the algorithm, its content and the checks treat alike."""

from __future__ import annotations

from collections.abc import Iterable

from prima.interpreter.deadcontent import branches
from prima.markup.tree import Node

ITEMS = frozenset(["field", "block", "initial", "subdialog", "object", "record", "transfer"])
"""Form items (2.0, 2.1.2)."""
INPUTS = frozenset({"field", "record", "object", "subdialog", "transfer"})
"""Items that a result fills."""
HANDLERS = ("catch", "error", "help", "noinput", "nomatch")
"""Elements that take events (5.2)."""
LEAVING = frozenset(["goto", "submit", "exit", "return", "disconnect"])
"""Content that leaves its dialog, unless it goes to an item of it."""
SILENT = frozenset(["lexicon", "metadata", "meta", "desc"])
"""Elements of prompts that are not spoken."""


def handler_names(handler: Node) -> list[str]:
    """The events that a handler takes; the empty name is for all."""
    if handler.tag != "catch":
        return [handler.tag]
    return [name.rstrip(".") for name in handler.get("event").split()] or [""]


def handler_number(handler: Node) -> int:
    """The count of a handler or a prompt; 1 if it is not a number."""
    count = handler.get("count", "1")
    return max(int(count), 1) if count.isdecimal() else 1


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


def _complete(node: Node, throws: bool) -> bool:
    """Whether each branch of an ``if`` leaves its dialog, the last of them being ``else``."""
    found = [*branches(node)]
    return found[-1][0].tag == "else" and all(leaves(part, throws) for _, part in found)


def says_instead(audio: Node) -> bool:
    """Whether an audio has content, which is said if it cannot be played (4.1.3)."""
    return bool(audio.text) or any(one.tag not in SILENT for one in audio.nodes)


def numbered(node: Node) -> dict[int, str]:
    """The keys of a field's options or a menu's choices, by their index (2.2).

    With ``dtmf="true"`` a menu numbers the first nine choices that have no keys of their own.
    """
    found: dict[int, str] = {}
    number = 0
    for one in node.all("option", "choice"):
        found[one.index] = one.get("dtmf")
        if not one.get("dtmf") and node.get("dtmf") == "true" and number < 9:
            number += 1
            found[one.index] = str(number)
    return found


def words_of(option: Node) -> str:
    """The text of an option or choice, including its markup's."""
    parts: list[str] = []
    for item in option.content:
        if isinstance(item, str):
            parts.append(item)
        elif item.tag not in ("grammar", "desc", "metadata"):
            parts.append(words_of(item))
    return " ".join("".join(parts).split())
