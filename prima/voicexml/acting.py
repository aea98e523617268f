"""Executable content of VoiceXML as the acts of PRIMA's own language."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Exit,
    Expression,
    Goto,
    Pause,
    Return,
    StepTemplate,
    Text,
    Throw,
)
from prima.interpreter.units import ARRANGING
from prima.markup.tree import Node
from prima.voicexml.arranging import type_of
from prima.voicexml.cues import break_ms
from prima.voicexml.elements import SILENT, says_instead
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN


def text_of(pieces: Iterable[Node | str]) -> Text:
    """The spoken text of some pieces of a prompt, with pauses; empty for white space alone."""
    found = tuple(_words(pieces))
    return found if any(not isinstance(one, str) or one.strip() for one in found) else ()


def _words(pieces: Iterable[Node | str]) -> Iterator[str | Expression | Pause]:
    for piece in pieces:
        if isinstance(piece, str):
            yield piece
        elif piece.tag == "break":
            yield Pause(break_ms(piece.get("time"), piece.get("strength"), piece.get("size")))
        elif _is_unknown(piece):
            yield Expression(piece.get("expr"), piece)
        elif piece.tag == "sub":
            yield piece.get("alias")
        elif piece.namespace != PRIMA_NAMESPACE and piece.tag not in SILENT:
            yield from _words(piece.content)


def _is_unknown(piece: Node) -> bool:
    """Whether only a run determines what an element says, or how long its recording plays."""
    alone = piece.tag == "audio" and not says_instead(piece)
    return alone or piece.tag in ("value", "enumerate")


def commands_in(piece: Node) -> list[CommandTemplate]:
    """The Commands of the robot in an element, itself included, in document order."""
    return [
        command_of(node)
        for node in piece.walk()
        if node.namespace == PRIMA_NAMESPACE and node.tag not in (*ARRANGING, "param")
    ]


def command_of(node: Node) -> CommandTemplate:
    """A Command's element as PRIMA's language has it, without its arguments."""
    words = text_of(node.content) or None
    return CommandTemplate(type_of(node), {}, words, False, (), (), node)


def speak(words: Text, node: Node) -> CommandTemplate:
    """Spoken text as a Command."""
    return CommandTemplate("speak", {}, words, False, (), (), node)


def run_of(commands: list[CommandTemplate]) -> CommandRun:
    """Commands one after another, as an act."""
    steps = [StepTemplate(one, (index - 1,) if index else ()) for index, one in enumerate(commands)]
    return CommandRun(tuple(steps), commands[0].node)


def saying(pieces: list[Node | str], node: Node) -> Iterator[Act]:
    """Spoken text, and the Commands of the robot among it."""
    words = text_of(pieces)
    if words:
        yield run_of([speak(words, node)])
    for piece in pieces:
        commands = commands_in(piece) if isinstance(piece, Node) else []
        if commands:
            yield run_of(commands)


def code_of(node: Node, attribute: str) -> Expression | None:
    """The code of an attribute, if present."""
    return (
        Expression(node.get(attribute), node, attribute) if attribute in node.attributes else None
    )


def spoken_pieces(content: Iterable[Node | str]) -> Iterator[tuple[list[Node | str], Node | None]]:
    """Content split into spoken pieces, each with its prompt if any, and other elements."""
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


# Acts of elements without content


def _assign(node: Node) -> Act:
    return Assign(node.get("name"), Expression(node.get("expr"), node), node)


def _throw(node: Node) -> Act:
    event = node.get("event") or Expression(node.get("eventexpr"), node, "eventexpr")
    return Throw(event, "", node)


def _goto(node: Node) -> Act:
    return Goto(None, node.get("nextitem") or code_of(node, "expritem"), node)


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
