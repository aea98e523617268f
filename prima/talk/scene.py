"""A scenario as text: the one played, and the one that a session is saved as."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable
from html import escape
from pathlib import Path

from prima.language.values import NAME
from prima.markup.tree import Node
from prima.sim.vocabulary.happenings import DOINGS
from prima.sim.vocabulary.scenario import SCENARIO

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
MARK = "Played with prima talk."
"""The comment in a saved session, by which it is recognized and may be overwritten."""
USERS = frozenset(DOINGS) - {"wait", "note"}
"""Elements of a ``when`` that are actions of the user."""
KEPT = ("robot", "person", "connection", "application", "service", "transfer", "answer", "when")
"""Elements of a scenario that are played, in the order in which they are written."""
PATHS = {
    (tag, item.name)
    for tag, element in SCENARIO.elements.items()
    for item in element.attributes
    if item.kind == "path"
}
"""Attributes that name a file, with their elements."""


class Scene:
    """The scenario that is played: a given one, by default without its user's actions.

    Args:
        root: that scenario's document.
        folder: its folder.
        policy: the mediator's policy.
        scripted: whether its user's actions are kept.
    """

    def __init__(self, root: Node, folder: str, policy: str, scripted: bool) -> None:
        self.root = root
        self.folder = folder
        self.policy = policy
        self.scripted = scripted
        self.left_out = 0
        """The number of the scenario's user actions that are left out."""
        if not scripted:
            for node in root.nodes:
                self.left_out += node.tag == "answer"
                self.left_out += len(node.all(*USERS)) if node.tag == "when" else 0

    def text(
        self,
        whens: Iterable[str] = (),
        until: str = "86400s",
        target: str | None = None,
        remark: str = "",
    ) -> str:
        """The scenario's document.

        Args:
            whens: the author's actions, as elements with comments.
            until: the end of the run.
            target: the output file, to which paths are made relative; by default they stay.
            remark: a comment at the beginning.
        """
        given = dict(self.root.attributes)
        stem = Path(target).stem if target else ""
        given["id"] = stem if re.fullmatch(NAME, stem) else given["id"]
        given |= {"policy": self.policy, "until": until}
        if self.policy == "prima":
            del given["policy"]
        lines = [HEAD + (f"<!-- {comment(remark)} -->\n" if remark else "")]
        paths = {name: given.pop(name) for name in ("world", "robot")}
        lines.append(f'<scenario xmlns="{self.root.namespace}"')
        lines.append(f"{self._attributes('scenario', given, target)}\n         ")
        lines.append(f"{self._attributes('scenario', paths, target)}>\n")
        nodes = [node for tag in KEPT for node in self.root.all(tag)]
        lines += [f"  {made}\n" for node in nodes if (made := self._element(node, target))]
        lines += [f"  {when}\n" for when in whens]
        return "".join([*lines, "</scenario>\n"])

    def _attributes(self, tag: str, given: dict[str, str], target: str | None) -> str:
        made = ""
        for name, value in given.items():
            if (tag, name) == ("person", "user") and not self.scripted:
                continue  # whoever plays behaves as they like
            if (tag, name) in PATHS and target is not None:
                value = self._path(value, target)
            made += f' {name}="{_quoted(value)}"'
        return made

    def _path(self, path: str, target: str) -> str:
        """A path in the scenario, relative to another file."""
        if os.path.isabs(path):
            return path
        start = os.path.dirname(target) or "."
        relative = os.path.relpath(os.path.join(self.folder, path), start)
        return posixpath.normpath(Path(relative).as_posix())

    def _element(self, node: Node, target: str | None) -> str:
        """An element as text; empty if none of it is played."""
        if not self.scripted and (node.tag in USERS or node.tag == "answer"):
            return ""
        content = "".join(
            self._element(item, target) if isinstance(item, Node) else _text(item)
            for item in node.content
        )
        if node.tag in ("when", "one-of") and not self.scripted and not _kept(node):
            return ""
        start = f"<{node.tag}{self._attributes(node.tag, node.attributes, target)}"
        return f"{start}>{content}</{node.tag}>" if content else f"{start}/>"


def _kept(node: Node) -> bool:
    """Whether something happens in an element that is not the user's doing."""
    inside = {one.tag for one in node.nodes} - USERS - {"wait", "one-of"}
    return bool(inside) or any(_kept(one) for one in node.all("one-of"))


def _text(text: str) -> str:
    """Text of an element; white space between elements is dropped."""
    return escape(text, quote=False) if text.strip() else ""


def _quoted(value: str) -> str:
    """A value as written in an attribute, with its white space preserved."""
    return re.sub(r"[\t\n\r]", lambda found: f"&#{ord(found[0])};", escape(value))


def comment(text: str) -> str:
    """Text that is allowed in a comment."""
    return re.sub(r"-(?=-|$)", "- ", text)


def when(at: int, xml: str) -> str:
    """A trigger at a time (ms)."""
    return f'<when at="{seconds(at)}">{xml}</when>'


def seconds(ms: int) -> str:
    """A time as documents have it."""
    return f"{ms / 1000:.3f}".rstrip("0").rstrip(".") + "s"
