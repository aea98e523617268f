"""Commands of the robot that ``p:par``, ``p:seq`` and ``p:iu`` arrange (rules U3 and U4)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar

from prima.commands import TABLE_4_2
from prima.errors import Problem, did_you_mean, one_of
from prima.interpreter.units import LONGEST_UNIT_MS, not_in_unit
from prima.interpreter.vocabulary import DIALOGUE
from prima.markup.tree import Node
from prima.messages import Command, Cue, Step
from prima.values import milliseconds, read_value
from prima.voicexml.vocabulary import COMMANDS, PRIMA_NAMESPACE

ARRANGING = ("par", "seq", "iu")
Made = TypeVar("Made")
DEEPEST = 50
"""Such elements inside each other."""


@dataclass(slots=True)
class Arranged:
    """Commands that stand in the queue as one; ``after`` of a step counts within them.

    Like a Command in the queue it has a type, cues and a hook: it is no prompt, and nobody may
    break in on it.
    """

    steps: list[Step]
    source: str
    type: str = "par"
    cues: tuple[Cue, ...] = ()
    hook: object = False


Queued = Command | Arranged
"""What is played on reaching a wait."""


def arrange(
    nodes: Iterable[Node],
    make: Callable[[Node], Made],
    visit: Callable[[Node], None] = lambda _: None,
) -> list[tuple[Made, tuple[int, ...]]]:
    """Commands and units one after another, each with the indices of those that it waits for (U3).

    Args:
        nodes: the elements, ``p:par`` and ``p:seq`` among them.
        make: makes a step of a Command or of a ``p:iu``.
        visit: is called for each element before what is in it.
    """
    found: list[tuple[Made, tuple[int, ...]]] = []

    def add(nodes: Iterable[Node], after: tuple[int, ...]) -> tuple[int, ...]:
        """Gives what whatever follows has to wait for."""
        for node in nodes:
            visit(node)
            if node.tag == "par":
                ends = [end for branch in node.nodes for end in add([branch], after)]
                after = tuple(dict.fromkeys(ends)) or after
            elif node.tag == "seq":
                after = add(node.nodes, after)
            else:
                found.append((make(node), after))
                after = (len(found) - 1,)
        return after

    add(nodes, ())
    return found


def longest_of(unit: Node) -> int:
    """The longest duration (ms) of a ``p:iu``."""
    return milliseconds(unit.get("longest"), LONGEST_UNIT_MS)


def said_last(queue: Sequence[Queued]) -> Command | None:
    """What is said last of a queue; nothing if something else comes behind it."""
    last = queue[-1] if queue else None
    return last if isinstance(last, Command) and last.type == "speak" else None


def take_last_said(queue: list[Queued]) -> Command | None:
    """Take what is said last off a queue, if nothing else comes behind it."""
    last = said_last(queue)
    if last is not None:
        queue.pop()
    return last


def steps_of(queue: Sequence[Queued]) -> list[Step]:
    """What is queued as one tree: each piece waits for all of the one before it (U3)."""
    made: list[Step] = []
    after: tuple[int, ...] = ()
    for piece in queue:
        first = len(made)
        if isinstance(piece, Command):
            made.append(Step(piece, after))
            after = (first,)
            continue
        for step in piece.steps:
            inner = tuple(first + index for index in step.after)
            made.append(replace(step, after=inner or after))
        after = tuple(first + index for index in _last(piece.steps))
    return made


def _last(steps: list[Step]) -> list[int]:
    """The steps for which no other one of them waits."""
    waited = {index for step in steps for index in step.after}
    return [index for index in range(len(steps)) if index not in waited]


# Checks --------------------------------------------------------------------------------------


def check_arranged(node: Node, problems: list[Problem], depth: int = 0) -> list[Node]:
    """What is wrong with such an element; gives the Commands in it, in document order."""
    _check_attributes(node, problems)
    if depth == DEEPEST:
        message = f"There are more than {DEEPEST} such elements inside each other."
        problems.append(Problem(node.place, "error", "too-deep", message, "Divide them."))
        return []
    found: list[list[Node]] = []
    for child in node.content:
        if isinstance(child, str):
            _check_text(node, child, problems)
        elif _fits(child, node, problems):
            inner = child.tag in ARRANGING
            found.append(check_arranged(child, problems, depth + 1) if inner else [child])
    commands = [command for branch in found for command in branch]
    if not node.nodes:
        message = f"This <{node.tag}> holds no Command."
        problems.append(Problem(node.place, "error", "empty", message, "Write Commands into it."))
    if node.tag == "iu":
        _check_unit(commands, problems)
    elif node.tag == "par":
        _check_branches(found, problems)
    return commands


def _check_text(node: Node, text: str, problems: list[Problem]) -> None:
    if text.strip():
        message = f'Text cannot stand in <{node.tag}>: "{text.strip()[:40]}".'
        remedy = "Write it into a <p:speak>."
        problems.append(Problem(node.place, "error", "stray-text", message, remedy))


def _check_attributes(node: Node, problems: list[Problem]) -> None:
    known = {one.name: one for one in DIALOGUE.elements[node.tag].attributes}
    for name, text in node.attributes.items():
        if name.startswith(("xml:", "{")):
            continue
        if name not in known:
            place = node.attribute_place(name, value=False)
            message = f'<{node.tag}> has no attribute "{name}".'
            hint = did_you_mean(name, known)
            problems.append(Problem(place, "error", "unknown-attribute", message, hint))
            continue
        try:
            read_value(known[name].kind, text)
        except ValueError as error:
            place = node.attribute_place(name)
            problems.append(Problem(place, "error", "bad-value", str(error)))


def _fits(child: Node, node: Node, problems: list[Problem]) -> bool:
    """Whether a child may stand in such an element."""
    own = child.namespace == PRIMA_NAMESPACE
    if own and child.tag in (*COMMANDS, *(one for one in ARRANGING if one != node.tag)):
        return True
    name = child.tag if not own else f"p:{child.tag}"
    message = f"<{name}> cannot stand in <p:{node.tag}>."
    remedy = "Write what is said as <p:speak>." if child.tag in ("prompt", "audio") else ""
    others = [f"<p:{one}>" for one in ARRANGING if one != node.tag]
    remedy = remedy or f"It holds Commands of the robot, {one_of(others)}."
    problems.append(Problem(child.place, "error", "misplaced-element", message, remedy))
    return False


def _check_unit(commands: list[Node], problems: list[Problem]) -> None:
    """U4: no feedback Command and none that leaves the user may be in a unit."""
    for command in commands:
        row = TABLE_4_2.get(_type(command))
        if row is not None and (why := not_in_unit(row)):
            message = f"<p:{command.tag}> {why}; it cannot stand in a unit."
            remedy = "Move it out of the <p:iu>."
            problems.append(Problem(command.place, "error", "not-in-unit", message, remedy))


def _check_branches(branches: list[list[Node]], problems: list[Problem]) -> None:
    """U3: branches of a par that share a device run one after the other."""
    for one, other in combinations(branches, 2):
        both = _devices(one) & _devices(other)
        if both:
            message = (
                f"This branch shares {', '.join(sorted(both))} with another:"
                " they run one after the other."
            )
            remedy = "Write them one after the other, in a <p:seq>."
            place = other[0].place
            problems.append(Problem(place, "warning", "shared-device", message, remedy))
            return


def _type(command: Node) -> str:
    return command.get("type") if command.tag == "command" else command.tag


def _devices(commands: list[Node]) -> frozenset[str]:
    found: frozenset[str] = frozenset()
    for command in commands:
        row = TABLE_4_2.get(_type(command))
        if row is not None:
            found |= row.occupied("x" if command.content else None)
    return found
