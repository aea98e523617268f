"""Questions of VoiceXML documents without an active grammar: error.semantic when asked."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Problem
from prima.errors.diagnoses.grammars import NO_ANSWER
from prima.markup.tree import Node
from prima.voicexml.arranging import parts_of
from prima.voicexml.document import Page, broken
from prima.voicexml.elements import numbered, words_of

ASKING = ("field", "initial")
REMEDY = "Give it a <grammar>, <option>s or a type. At run time it is error.semantic."
CHOICES = "Give its <choice>s words or keys. At run time it is error.semantic."
NO_GRAMMAR = NO_ANSWER.says(
    "No grammar listens at the <{tag}>{name}: it takes no answer at all.", REMEDY, "warning"
)
NO_CHOICE = NO_ANSWER.says(
    "No grammar listens at the <menu>{name}: it takes no answer at all.", CHOICES, "warning"
)


def check_listening(page: Page, root: Page | None) -> Iterator[Problem]:
    """Warnings of questions that nobody can answer (2.0, 3.1.4), unless they may never be asked."""
    if broken(page) is not None or (page.application and root is None):
        return
    wider = [page.root, *([root.root] if root is not None else [])]
    shared = any(map(_shares, wider))
    yield from _unanswered(page, shared)
    for menu in page.root.all("menu"):
        if not (shared or _listens(menu)):
            yield NO_CHOICE.at(menu.place, name=f" {menu.get('id')}".rstrip())


def _unanswered(page: Page, shared: bool) -> Iterator[Problem]:
    """Items at which nothing listens; ``shared`` says whether something does in all of them."""
    given = {node.get("name") for node in page.root.walk() if node.key == "assign"}
    for item in _asked_alone(page):
        everywhere = shared and item.get("modal") != "true"
        if not (everywhere or _listens(item) or item.get("name") in given):
            name = f" {item.get('name')}".rstrip()
            yield NO_GRAMMAR.at(item.place, tag=item.tag, name=name)


def _asked_alone(page: Page) -> Iterator[Node]:
    """The questions that are certainly asked, in forms without any grammar."""
    for form in page.root.all("form"):
        if not _listens(form):
            yield from filter(_surely_asked, parts_of(form))


def _surely_asked(item: Node) -> bool:
    """Whether an item is a question that nothing in its own element prevents."""
    return item.tag in ASKING and {"expr", "cond"}.isdisjoint(item.attributes)


def _listens(node: Node) -> bool:
    """Whether an item or dialog has a grammar of its own, or commands that listen everywhere."""
    keys = numbered(node)
    held = any(_is_heard(one, keys.get(one.index, "")) for one in node.nodes)
    return held or bool(node.get("type")) or _universals(node)


def _is_heard(node: Node, dtmf: str) -> bool:
    """Whether something that the user says or types is taken by a part of an item or dialog."""
    match node.tag:
        case "grammar":
            return True
        case "link":
            return bool(node.all("grammar")) or bool(node.get("dtmf"))
        case "option" | "choice":
            return bool(words_of(node)) or bool(dtmf) or bool(node.all("grammar"))
        case _:
            return False


def _shares(root: Node) -> bool:
    """Whether something listens in all of a document: links, dialogs and grammars of its scope."""
    dialogs = root.all("form", "menu")
    return (
        any(_is_heard(one, "") for one in root.all("link"))
        or _universals(root)
        or any(one.get("scope") == "document" and _listens(one) for one in dialogs)
        or any(one.get("scope") == "document" for node in dialogs for one in node.all("grammar"))
    )


def _universals(node: Node) -> bool:
    return any(one.get("name") == "universals" for one in node.all("property"))
