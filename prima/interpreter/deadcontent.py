"""Content that is never reached, in documents of both languages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from prima.errors import Diagnosis, Problem
from prima.markup.tree import Node

LEAVING = frozenset(["goto", "submit", "exit", "return", "disconnect"])
"""Elements after which nothing of the same content is reached."""
DIVIDED = frozenset(["if", *LEAVING])

DEAD_CONTENT = Diagnosis(
    "dead-content",
    "Content that is never reached",
    "Nothing after a goto, return, exit, or in VoiceXML a submit or disconnect, is ever reached,"
    " nor is anything after an if with an else if all branches have one of them, nor is a handler"
    " whose events another one of the same element takes first: of several with the same count it"
    " is the first.",
    rule="VoiceXML 2.0, 5.3",
    severity="warning",
    message="{what} comes after <{leaving}> and is never reached.",
    remedy="Put it before <{leaving}>, or remove it.",
)
BEHIND_IF = DEAD_CONTENT.says(
    "{what} is never reached: each branch of the <if> before it ends with <goto> or the like.",
    "Put it before the <if>, or remove it.",
)


def branches(node: Node) -> Iterator[tuple[Node, list[Node | str]]]:
    """The branches of an ``if`` (5.3.4), each with the element that has its condition."""
    head, part = node, list[Node | str]()
    for one in node.content:
        if isinstance(one, Node) and one.tag in ("elseif", "else"):
            yield head, part
            head, part = one, []
        else:
            part.append(one)
    yield head, part


def dead_content(root: Node, texts: bool = False) -> Iterator[Problem]:
    """Warn of content after what leaves it, once in each branch; with ``texts``, text counts."""
    for holder in root.walk():
        held = holder.held
        if not isinstance(held, list):
            continue  # nothing comes after it
        if any(isinstance(one, Node) and one.key in DIVIDED for one in held[:-1]):
            for _, part in branches(holder):
                yield from _dead([one for one in part if isinstance(one, Node) or texts])


def _dead(part: Iterable[Node | str]) -> Iterator[Problem]:
    for one, behind in pairwise(one for one in part if isinstance(one, Node) or one.strip()):
        if isinstance(one, str) or not _leaves(one):
            continue
        if isinstance(behind, str):
            what, place = "Text", one.place_behind(behind) or one.place
        elif behind.key:
            what, place = f"<{behind.tag}>", behind.place
        else:
            continue  # it is unknown or misplaced, which is reported
        diagnosis = BEHIND_IF if one.key == "if" else DEAD_CONTENT
        yield diagnosis.at(place, what=what, leaving=one.tag)
        return


def _leaves(node: Node) -> bool:
    """Whether nothing after an element is reached."""
    if node.key in LEAVING or node.key != "if":
        return node.key in LEAVING
    heads = [*branches(node)]
    ends = (any(isinstance(one, Node) and _leaves(one) for one in part) for _, part in heads)
    return heads[-1][0].tag == "else" and all(ends)
