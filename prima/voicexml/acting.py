"""Executable content of VoiceXML as the acts of PRIMA's own language."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Exit,
    Expression,
    Flattened,
    Goto,
    GroupTemplate,
    Pause,
    Return,
    Script,
    StepTemplate,
    Text,
    Throw,
    arrange,
    type_of,
)
from prima.interpreter.units import ARRANGING
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.messages import Json
from prima.voicexml.arranging import arguments_of, longest_of
from prima.voicexml.cues import break_ms
from prima.voicexml.elements import SILENT, says_instead
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN


@dataclass(slots=True, eq=False)
class VoiceCommand(CommandTemplate):
    """A Command, or spoken text, with the markup that ``text`` leaves out."""

    pieces: Sequence[Node | str] = ()
    """What is spoken, with its markup."""
    holder: Node | None = None
    """The element in which a prompt is."""


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


def command_of(node: Node) -> VoiceCommand:
    """A Command's element as PRIMA's language has it."""
    name = type_of(node)
    args: dict[str, Json | Expression] = {**arguments_of(node, TABLE_4_2.get(name))}
    pieces = [one for one in node.content if isinstance(one, str) or one.tag != "param"]
    return VoiceCommand(name, args, text_of(pieces) or None, False, (), (), node, pieces=pieces)


def speak(
    words: Text, node: Node, pieces: Sequence[Node | str] = (), holder: Node | None = None
) -> CommandRun:
    """Spoken text as a Command."""
    command = VoiceCommand("speak", {}, words, False, (), (), node, pieces=pieces, holder=holder)
    return CommandRun((StepTemplate(command, ()),), node)


def runs_in(piece: Node) -> Iterator[CommandRun]:
    """The Commands of the robot in an element, itself included, as they are arranged."""
    if piece.namespace != PRIMA_NAMESPACE:
        for inner in piece.nodes:
            yield from runs_in(inner)
    elif steps := _steps([piece]):
        yield CommandRun(steps, piece)  # an element without Commands is in a document with errors


def _steps(nodes: Iterable[Node]) -> tuple[StepTemplate, ...]:
    arranged: Flattened[CommandTemplate | GroupTemplate] = arrange(nodes, _step)
    return tuple(StepTemplate(what, after) for what, after in arranged)


def _step(node: Node) -> CommandTemplate | GroupTemplate | None:
    """A Command, or a unit of them (U4)."""
    if node.tag == "iu":
        return GroupTemplate(_steps(node.nodes), longest_of(node), node)
    return command_of(node) if node.tag != "param" else None


def saying(pieces: list[Node | str], node: Node, holder: Node) -> Iterator[Act]:
    """Spoken text of an element, and the Commands of the robot among it."""
    words = text_of(pieces)
    if words:
        yield speak(words, node, pieces, holder)
    for piece in pieces:
        yield from runs_in(piece) if isinstance(piece, Node) else ()


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


def _script(node: Node) -> Act:
    return Script(Expression(node.own_text, node, ""), node)


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
    "script": _script,
    "throw": _throw,
    "goto": _goto,
    "submit": _goto,
    "clear": _clear,
    "return": _return,
    "exit": Exit,
    "disconnect": Exit,
}
