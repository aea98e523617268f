"""A VoiceXML document as the values that checks of PRIMA's own language look at.

What is found out without running anything is found out of both languages in the same way: what
units reach (U5), how long they speak, what is told twice (O3). A sketch has what such checks need
and nothing else: of a prompt its words, of a question that it asks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from itertools import chain
from urllib.parse import urldefrag, urlsplit

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Exit,
    Expression,
    Foreach,
    Goto,
    Handler,
    If,
    Pause,
    Return,
    StepTemplate,
    Text,
    Throw,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Prompt,
    Subdialog,
    Unit,
)
from prima.interpreter.entering import FormTarget
from prima.interpreter.units import Finder, Reach, thrown_by
from prima.markup.tree import Node
from prima.messages import Json
from prima.script.choices import PossibleText, choices
from prima.voicexml.arranging import ARRANGING, is_unit, longest_of
from prima.voicexml.cues import break_ms
from prima.voicexml.document import Page
from prima.voicexml.elements import HANDLERS, ITEMS, SILENT, handler_names, handler_number
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN

ASKING = ("field", "initial", "record", "menu")
FETCHING = ("goto", "submit", "data", "script")
"""Elements of content while whose fetch something may be played."""
LEADING = ("goto", "submit", "subdialog")
FAILURES = ("error.badfetch", "error.unsupported.format", "error.unsupported.builtin")
"""What a question's grammars, and what is fetched, may throw beside what PRIMA's language has."""
UNIVERSAL = ("help", "cancel", "exit")


class Sketch:
    """One document, with the handlers that it has from its application root."""

    def __init__(self, page: Page, root: Page | None) -> None:
        self.page = page
        self._wider = [page.root, *([root.root] if root is not None else [])]
        self._units: dict[int, tuple[Form, Unit]] = {}
        handlers = [one for node in self._wider for one in self._handlers(node)]
        forms = {name: self._form(name, node) for name, node in page.dialogs.items()}
        self.document = Document(
            "", "", page.lang, page.uri, forms, tuple(handlers), (), (), (), {}, page.root
        )
        self._finder = Finder(self.document, self._thrown)

    @property
    def units(self) -> list[tuple[Form, Unit]]:
        """The units around form items, each with its form."""
        return [*self._units.values()]

    def reach(self, unit: Node | Unit) -> Reach:
        """All that may run in a unit."""
        node = unit.node if isinstance(unit, Unit) else unit
        return self._finder.reach(*self._units[node.index])

    # Dialogs ------------------------------------------------------------------------------

    def _form(self, name: str, node: Node) -> Form:
        items = [node] if node.tag == "menu" else node.nodes
        made = [self._item(one) for one in items if _is_item(one)]
        filled = [self._filled(one) for one in node.all("filled")]
        if node.all("grammar"):  # an answer may fill any item of the form
            filled += _filled_in(made)
        handlers = () if node.tag == "menu" else self._handlers(node)
        form = Form(name, tuple(made), handlers, (), (), (), tuple(filled), {}, node)
        self._units |= {one.node.index: (form, one) for one in made if isinstance(one, Unit)}
        return form

    def _item(self, node: Node) -> Item:
        name = node.get("name") or f"#{node.index}"
        expr, cond = _code(node, "expr"), _code(node, "cond")
        properties: dict[str, Json] = {}
        own = (name, expr, cond, self._handlers(node), properties, node, None)
        if is_unit(node):
            inner = tuple(self._item(one) for one in node.nodes if _is_item(one))
            return Unit(*own, items=inner, longest=longest_of(node))
        if node.tag == "block":
            return Block(*own, content=self._acts(node, node.content))
        filled = tuple(self._filled(one) for one in node.all("filled"))
        if node.tag not in ASKING:
            return Subdialog(*own, filled=filled)
        # Commands among what it asks: they are done before the question.
        asked = tuple(one for one in self._acts(node, node.content) if isinstance(one, CommandRun))
        filled = (*filled, Filled("any", (), asked, node))
        return Field(*own, prompts=tuple(self._prompts(node)), filled=filled)

    def _filled(self, node: Node) -> Filled:
        names = tuple(node.get("namelist").split())
        return Filled(node.get("mode") or "all", names, self._acts(node, node.content), node)

    def _handlers(self, holder: Node) -> tuple[Handler, ...]:
        return tuple(
            Handler(
                tuple(handler_names(node)),
                _code(node, "cond"),
                handler_number(node),
                None,
                self._acts(node, node.content),
                node,
            )
            for node in holder.all(*HANDLERS)
        )

    def _prompts(self, item: Node) -> Iterator[Prompt]:
        for pieces, node in _spoken(item.content):
            words = text_of(pieces)
            if words and node is not None:
                count = handler_number(node)
                yield Prompt(words, count, _code(node, "cond"), None, None, node)
            elif words:
                yield Prompt(words, 1, None, None, None, item)

    # Content ------------------------------------------------------------------------------

    def _acts(self, holder: Node, content: Iterable[Node | str]) -> tuple[Act, ...]:
        """Content of an element as acts; what is said without an element of its own is its."""
        made: list[Act] = []
        for pieces, node in _spoken(content):
            cond = _code(node, "cond") if pieces and node is not None else None
            if pieces and cond is not None:
                made.append(If(((cond, tuple(self._saying(pieces, node or holder))),), holder))
            elif pieces:
                made += self._saying(pieces, node or holder)
            elif node is not None:
                made += self._act(node)
        return tuple(made)

    @staticmethod
    def _saying(pieces: list[Node | str], node: Node) -> Iterator[Act]:
        """What is said, and the Commands of the robot among it."""
        words = text_of(pieces)
        if words:
            yield _run([_speak(words, node)])
        for piece in pieces:
            commands = commands_in(piece) if isinstance(piece, Node) else []
            if commands:
                yield _run(commands)

    def _act(self, node: Node) -> Iterator[Act]:
        if node.namespace == PRIMA_NAMESPACE:
            commands = commands_in(node)
            yield from [_run(commands)] if commands else ()  # none in a document with errors
            return
        if node.tag in FETCHING and self._plays(node):
            yield _run([_speak((Expression("", node, "fetchaudio"),), node)])
        if node.tag == "if":
            branches = [(cond, self._acts(node, part)) for cond, part in _divided(node)]
            yield If(tuple(branches), node)
        elif node.tag == "foreach":
            array = Expression(node.get("array"), node, "array")
            yield Foreach(node.get("item"), array, self._acts(node, node.content), node)
        elif node.tag in ACTS:
            yield ACTS[node.tag](node)

    def _plays(self, node: Node) -> bool:
        """Whether something is played while an element's resource is fetched."""
        if node.get("fetchaudio"):
            return True
        return self._plays_somewhere

    @cached_property
    def _plays_somewhere(self) -> bool:
        properties = (one for wider in self._wider for one in wider.walk() if one.key == "property")
        return any(one.get("name") == "fetchaudio" for one in properties)

    def leads(self, act: Goto | Subdialog) -> list[FormTarget]:
        """The dialogs that an element leads to, of this document or of others."""
        node, where = act.node, "src" if isinstance(act, Subdialog) else "next"
        if node.tag not in LEADING:
            return []  # somebody else's number, or an object
        if where in node.attributes:
            return self._targets(node, PossibleText(node.get(where).strip(), True))
        found = choices(node.get("srcexpr" if where == "src" else "expr"))
        return [target for one in found for target in self._targets(node, one)]

    def _targets(self, node: Node, uri: PossibleText) -> list[FormTarget]:
        """The dialog of a URI, or those of all URIs that begin so."""
        own = self.page.uri
        if uri.text[:1] == "#" or (not uri.text and not uri.whole):
            return [FormTarget(f"{own}#{uri.text[1:]}", uri.whole)]
        base, name = urldefrag(self.page.resolve(uri.text, node) if uri.text else "")
        parts = urlsplit(base)
        if parts.scheme == "service" and name:
            return [FormTarget(f"{own}#{name}", uri.whole)]
        if not parts.path or parts.scheme or parts.netloc:
            return []
        mark = "#" if uri.whole or "#" in uri.text else ""
        return [FormTarget(f"{parts.path}{mark}{name}", uri.whole)]

    # Events -------------------------------------------------------------------------------

    def _thrown(self, item: Item) -> Iterator[str | None]:
        """What visiting an item may throw by itself: also by what the user says to a link."""
        yield from thrown_by(item)
        yield from FAILURES
        if not isinstance(item, Field):
            return
        yield "maxspeechtimeout"
        yield from self._called_in(item.node)
        yield from self._called_outside
        form = self._holders.get(id(item))
        yield from self._called_in(form.node) if form is not None else ()

    @cached_property
    def _called_outside(self) -> list[str | None]:
        """What the user may bring about anywhere in the document."""
        return list(dict.fromkeys(one for node in self._wider for one in self._called_in(node)))

    @cached_property
    def _holders(self) -> dict[int, Form]:
        """The forms of the items in units."""
        return {id(item): form for form, unit in self._units.values() for item in unit.items}

    @staticmethod
    def _called_in(node: Node) -> Iterator[str | None]:
        """What the user may bring about by what is directly in an element."""
        for link in node.all("link"):
            if link.attributes.keys() & {"event", "eventexpr"}:
                yield link.get("event") or None
        if any(one.get("name") == "universals" for one in node.all("property")):
            yield from UNIVERSAL


def _filled_in(items: Iterable[Item]) -> Iterator[Filled]:
    """The ``filled`` of all fields, of those in units too."""
    inner = chain.from_iterable(one.items if isinstance(one, Unit) else [one] for one in items)
    return chain.from_iterable(item.filled for item in inner if isinstance(item, Field))


def text_of(pieces: Iterable[Node | str]) -> Text:
    """What is said of some pieces of a prompt, with its pauses; nothing of blanks alone."""
    found = tuple(_words(pieces))
    return found if any(not isinstance(one, str) or one.strip() for one in found) else ()


def _words(pieces: Iterable[Node | str]) -> Iterator[str | Expression | Pause]:
    for piece in pieces:
        if isinstance(piece, str):
            yield piece
        elif piece.tag == "break":
            yield Pause(break_ms(piece.get("time"), piece.get("strength"), piece.get("size")))
        elif piece.tag in ("value", "enumerate") or (piece.tag == "audio" and not piece.content):
            yield Expression(piece.get("expr"), piece)
        elif piece.tag == "sub":
            yield piece.get("alias")
        elif piece.namespace != PRIMA_NAMESPACE and piece.tag not in SILENT:
            yield from _words(piece.content)


def commands_in(piece: Node) -> list[CommandTemplate]:
    """The Commands of the robot in an element, itself included, in document order."""
    return [
        command_of(node)
        for node in piece.walk()
        if node.namespace == PRIMA_NAMESPACE and node.tag not in (*ARRANGING, "param")
    ]


def command_of(node: Node) -> CommandTemplate:
    """A Command's element as PRIMA's language has it, without its arguments."""
    name = node.get("type") if node.tag == "command" else node.tag
    return CommandTemplate(name, {}, text_of(node.content) or None, False, (), (), node)


def _speak(words: Text, node: Node) -> CommandTemplate:
    return CommandTemplate("speak", {}, words, False, (), (), node)


def _run(commands: list[CommandTemplate]) -> CommandRun:
    steps = [StepTemplate(one, (index - 1,) if index else ()) for index, one in enumerate(commands)]
    return CommandRun(tuple(steps), commands[0].node)


def _is_item(node: Node) -> bool:
    return node.tag in ITEMS or node.tag == "menu" or is_unit(node)


def _code(node: Node, attribute: str) -> Expression | None:
    return (
        Expression(node.get(attribute), node, attribute) if attribute in node.attributes else None
    )


def _spoken(content: Iterable[Node | str]) -> Iterator[tuple[list[Node | str], Node | None]]:
    """Content as what is said, with its prompt where it has one, and as other elements alone."""
    loose: list[Node | str] = []
    for piece in content:
        if isinstance(piece, str) or piece.tag in SPOKEN - {"prompt"}:
            loose.append(piece)
            continue
        if loose:
            yield loose, None
            loose = []
        yield ([*piece.content] if piece.tag == "prompt" else []), piece
    if loose:
        yield loose, None


def _divided(node: Node) -> Iterator[tuple[Expression | None, list[Node | str]]]:
    """The branches of an ``if``, each with its condition; that of ``else`` is none."""
    cond, part = _code(node, "cond"), list[Node | str]()
    for child in node.content:
        if isinstance(child, Node) and child.tag in ("elseif", "else"):
            yield cond, part
            cond, part = _code(child, "cond"), []
        else:
            part.append(child)
    yield cond, part


# Acts of elements without content


def _assign(node: Node) -> Act:
    return Assign(node.get("name"), Expression(node.get("expr"), node), node)


def _throw(node: Node) -> Act:
    event = node.get("event") or Expression(node.get("eventexpr"), node, "eventexpr")
    return Throw(event, "", node)


def _goto(node: Node) -> Act:
    return Goto(None, node.get("nextitem") or _code(node, "expritem"), node)


def _clear(node: Node) -> Act:
    names = (one.removeprefix("dialog.") for one in node.get("namelist").split())
    return Clear(tuple(names), node)


def _return(node: Node) -> Act:
    if node.get("eventexpr"):
        return Exit(node)
    return Return(tuple(node.get("namelist").split()), node.get("event"), node)


ACTS: Mapping[str, Callable[[Node], Act]] = {
    "assign": _assign,
    "throw": _throw,
    "goto": _goto,
    "submit": _goto,
    "clear": _clear,
    "return": _return,
    "exit": Exit,
    "disconnect": Exit,
}
