"""Commands of the robot that ``p:par``, ``p:seq`` and ``p:iu`` arrange (rules U3 and U4)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from prima.errors import Hint, Problem, one_of, replaced, suggestion
from prima.errors.diagnoses.behaviour import SHARED_DEVICE
from prima.errors.diagnoses.reading import TOO_DEEP
from prima.errors.diagnoses.structure import (
    EMPTY,
    MISPLACED_ELEMENT,
    STRAY_TEXT,
    UNKNOWN_ATTRIBUTE,
    UNKNOWN_ELEMENT,
)
from prima.errors.diagnoses.values import BAD_VALUE
from prima.interpreter.acts import CommandTemplate, arrange, type_of
from prima.interpreter.units import (
    ARRANGING,
    LONGEST_UNIT_MS,
    Reached,
    leading,
    now_inside,
    unit_problem,
)
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.language.commands import TABLE_4_2, CommandType
from prima.language.values import BadValue, milliseconds, read_value
from prima.markup.hints import meant_value
from prima.markup.spans import name_spans, similar_attribute, value_span
from prima.markup.tree import Node
from prima.messages import Command, Cue, Step
from prima.voicexml.elements import ITEMS
from prima.voicexml.vocabulary import COMMANDS, HANDLERS, NAMESPACE, PRIMA_NAMESPACE, VOICEXML

UNIT = "iu-items"
"""The key of a ``p:iu`` around form items (U5), as PRIMA's own language has it."""
UNIT_ITEMS = ("block", "field", "initial", "record")
"""Form items that a unit may hold: they end by themselves and act by the robot alone."""
UNIT_HOLDS = frozenset([*UNIT_ITEMS, *HANDLERS.split()])
BESIDE = {"filled": ", with a namelist of its fields"} | dict.fromkeys(
    ("grammar", "link", "property", "var", "script", "data", "subdialog", "transfer", "object"), ""
)
"""Elements that belong in the form, each with the remedy."""
DEEPEST = 50
"""Maximum nesting of such elements."""


@dataclass(slots=True)
class Arranged:
    """Commands queued as one; ``after`` of a step counts within them.

    Like a Command in the queue it has a type, cues and a hook: it is not a prompt, and nobody may
    break in on it.
    """

    steps: list[Step]
    type: str = "par"
    cues: tuple[Cue, ...] = ()
    hook: object = False

    @property
    def now(self) -> bool:
        """Whether it is wanted now, as its first Command is (O2)."""
        return self.steps[0].what.now


def is_unit(node: Node) -> bool:
    """Whether an element is a ``p:iu``: among form items it is a unit around them (U5)."""
    return node.tag == "iu" and node.namespace == PRIMA_NAMESPACE


def parts_of(dialog: Node) -> list[Node]:
    """A dialog's items in document order: each unit around form items before its contents."""
    found = []
    for node in dialog.nodes:
        found.append(node)
        if is_unit(node):
            found += node.nodes
    return found


def items_in(form: Node) -> list[Node]:
    """The items of a form: each unit around items before those that it holds."""
    return [one for one in parts_of(form) if one.tag in ITEMS or is_unit(one)]


def holds(item: Node, name: str) -> bool:
    """Whether a form item has a name, or is a unit around the one that has."""
    return item.get("name") == name or holds_inside(item, name)


def holds_inside(item: Node, name: str) -> bool:
    """Whether a form item is a unit around the one that has a name."""
    return is_unit(item) and any(one.get("name") == name for one in item.nodes)


def arguments_of(command: Node, row: CommandType | None) -> dict[str, str | None]:
    """The arguments of a Command with the values written; None for an expression."""
    given: dict[str, str | None] = {}
    known = row.arguments if row is not None and command.tag != "command" else {}
    for name, text in command.attributes.items():
        bare = name.removesuffix("-expr")
        if bare in known:
            given[bare] = text if bare == name else None
    return given | {one.get("name"): one.attributes.get("value") for one in command.all("param")}


Queued = Command | Arranged
"""Prompts and Commands that are played when a wait is reached."""


def longest_of(unit: Node) -> int:
    """The longest duration (ms) of a ``p:iu``."""
    return milliseconds(unit.get("longest"), LONGEST_UNIT_MS)


def requests_of(queue: Sequence[Queued]) -> list[list[Queued]]:
    """The queue as requests: what is wanted now begins one, as it is never linked (O2)."""
    made: list[list[Queued]] = []
    for piece in queue:
        if piece.now or not made:
            made.append([])
        made[-1].append(piece)
    return made


def steps_of(queue: Sequence[Queued]) -> list[Step]:
    """The steps of a request, one tree: each piece waits for all of the one before it (U3)."""
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
    """The steps for which no other step waits."""
    waited = {index for step in steps for index in step.after}
    return [index for index in range(len(steps)) if index not in waited]


# Checks --------------------------------------------------------------------------------------

NESTED_TOO_DEEP = TOO_DEEP.says(
    "There are more than {most} such elements inside each other.", "Divide them."
)
UNKNOWN_COMMAND = UNKNOWN_ELEMENT.says("PRIMA has no Command <{tag}>.", "Remove it.")
NO_COMMAND = EMPTY.says("This <p:{tag}> holds no Command.", "Write Commands into it.")
NO_ITEM = EMPTY.says("This <p:iu> holds no form item.", "Write {items} into it, or remove it.")
NO_TEXT_HERE = STRAY_TEXT.says(
    'Text is not allowed in <p:{tag}>: "{text}".', "Write it into a <{inside}>."
)
NOT_AMONG_ITEMS = MISPLACED_ELEMENT.says("<{name}> is not allowed in a <p:iu> around form items.")
NOT_HERE = MISPLACED_ELEMENT.says("<{name}> is not allowed in <p:{parent}>.")
NO_ATTRIBUTE = UNKNOWN_ATTRIBUTE.says('<p:{tag}> has no attribute "{name}".')
NOT_OF_ITS_KIND = BAD_VALUE.says('{name} "{value}" {wrong}')
ONE_AFTER_THE_OTHER = SHARED_DEVICE.says(
    "This branch shares {devices} with another: they run one after the other.",
    "Write them one after the other, in a <p:seq>.",
)


def check_arranged(node: Node, problems: list[Problem], depth: int = 0) -> list[Node]:
    """Check such an element; gives the Commands in it, in document order."""
    check_own(node, node.tag, problems)
    if depth == DEEPEST:
        problems.append(NESTED_TOO_DEEP.at(node.place, most=DEEPEST))
        return []
    found = [*_branches(node, problems, depth)]
    if not node.nodes and not node.text:
        problems.append(NO_COMMAND.at(node.place, tag=node.tag))
    if not depth or node.tag == "iu":
        _check_now(node, problems)
    if node.tag == "par":
        _check_branches(found, problems)
    commands = [command for branch in found for command in branch]
    if node.tag == "iu":
        _check_unit(commands, problems)
    return commands


def _branches(node: Node, problems: list[Problem], depth: int) -> Iterator[list[Node]]:
    """The Commands of each element in such an element."""
    for child in node.content:
        if isinstance(child, str):
            _check_text(node, child, problems)
        elif _fits(child, node, problems):
            inner = child.tag in ARRANGING
            yield check_arranged(child, problems, depth + 1) if inner else [child]


def _check_text(node: Node, text: str, problems: list[Problem]) -> None:
    if text.strip():
        inside = "p:speak" if node.key != UNIT else "block"
        shown = text.strip()[:40]
        problems.append(NO_TEXT_HERE.at(node.place, tag=node.tag, text=shown, inside=inside))


def check_items(unit: Node, problems: list[Problem]) -> Iterator[Node]:
    """Check a unit around form items (U5) itself; gives what it holds."""
    unit.key = UNIT
    check_own(unit, UNIT, problems)
    for child in unit.content:
        if isinstance(child, str):
            _check_text(unit, child, problems)
        elif child.namespace == NAMESPACE and child.tag in UNIT_HOLDS:
            child.key = child.tag
            yield child
        else:
            problems.append(_not_among_items(child))
    if not any(one.tag in UNIT_ITEMS for one in unit.nodes):
        items = one_of(f"<{one}>" for one in UNIT_ITEMS)
        problems.append(NO_ITEM.at(unit.place, items=items))


def _not_among_items(child: Node) -> Problem:
    name = f"p:{child.tag}" if child.namespace == PRIMA_NAMESPACE else child.tag
    remedy = f"It holds {one_of(f'<{one}>' for one in UNIT_ITEMS)}, and handlers of events."
    own = child.namespace == PRIMA_NAMESPACE and child.tag in (*COMMANDS, "par", "seq")
    if own or (child.namespace == NAMESPACE and VOICEXML.child("block", child.tag)):
        remedy = "Write it into a <block>."
    if child.tag == "on":
        remedy = 'Write <catch event="...">.'
    elif child.tag in BESIDE and not own:
        remedy = f"Write it into the form, beside the <p:iu>{BESIDE[child.tag]}."
    return NOT_AMONG_ITEMS.at(child.place, Hint(remedy), name=name)


def check_own(node: Node, key: str, problems: list[Problem]) -> None:
    """Check the attributes of an element that PRIMA's language has under a key."""
    known = {one.name: one for one in DIALOGUE.elements[key].attributes}
    for name, text in node.attributes.items():
        if name.startswith(("xml:", "{")):
            continue
        if name not in known:
            place = node.attribute_place(name, value=False)
            hint = similar_attribute(node, name, known)
            problems.append(NO_ATTRIBUTE.at(place, hint, tag=node.tag, name=name))
            continue
        try:
            read_value(known[name].kind, text)
        except BadValue as error:
            place = node.attribute_place(name)
            right = meant_value(known[name].kind, text, known[name].default)
            spans = value_span(node, name) if right else ()
            hint = replaced(f'Write "{right}".', right, *spans) if right else Hint(error.remedy)
            problems.append(
                NOT_OF_ITS_KIND.at(place, hint, name=name, value=text, wrong=error.wrong)
            )


def unknown_command(node: Node) -> Problem | None:
    """The problem of an element that PRIMA's language lacks in VoiceXML, if it is one."""
    if node.namespace != PRIMA_NAMESPACE or node.tag in (*COMMANDS, *ARRANGING):
        return None
    hint = suggestion(node.tag, [*COMMANDS, *ARRANGING], *name_spans(node))
    return UNKNOWN_COMMAND.at(node.place, hint, tag=node.tag)


def _fits(child: Node, node: Node, problems: list[Problem]) -> bool:
    """Whether such an element may contain a child."""
    own = child.namespace == PRIMA_NAMESPACE
    if own and child.tag in (*COMMANDS, *(one for one in ARRANGING if one != node.tag)):
        return True
    if problem := unknown_command(child):
        problems.append(problem)
        return False
    name = child.tag if not own else f"p:{child.tag}"
    others = [f"<p:{one}>" for one in ARRANGING if one != node.tag]
    remedy = _as_command(child) or f"It holds Commands of the robot, {one_of(others)}."
    problems.append(NOT_HERE.at(child.place, Hint(remedy), name=name, parent=node.tag))
    return False


def _as_command(child: Node) -> str:
    """The Command to write instead of an element of VoiceXML, or without its prefix."""
    if child.tag in ("prompt", "audio"):
        return "Write what is said as <p:speak>."
    own = child.namespace == NAMESPACE and child.tag in COMMANDS
    return f"Write <p:{child.tag}>." if own else ""


def _check_now(node: Node, problems: list[Problem]) -> None:
    """O2: a Command that is wanted now waits for nothing, so it must come first."""
    for command in (leading(one) for one, _ in arrange(node.nodes, lambda one: one)[1:]):
        row = TABLE_4_2.get(type_of(command)) if command.namespace == PRIMA_NAMESPACE else None
        if row is not None and row.now:
            problems.append(now_inside(command, "p:"))


def _check_unit(commands: list[Node], problems: list[Problem]) -> None:
    """U4: a unit must not contain feedback Commands or Commands that leave the user."""
    for command in commands:
        name = type_of(command)
        one = Reached(CommandTemplate(name, {}, None, False, (), (), command), True)
        problem = unit_problem(one, TABLE_4_2.get(name), prefix="p:")
        problems += [problem] if problem is not None else []


def _check_branches(branches: list[list[Node]], problems: list[Problem]) -> None:
    """U3: branches of a par that share a device run one after the other."""
    for one, other in combinations(branches, 2):
        both = _devices(one) & _devices(other)
        if both:
            devices = ", ".join(sorted(both))
            problems.append(ONE_AFTER_THE_OTHER.at(other[0].place, devices=devices))
            return


def _devices(commands: list[Node]) -> frozenset[str]:
    found: frozenset[str] = frozenset()
    for command in commands:
        row = TABLE_4_2.get(type_of(command))
        if row is not None:
            found |= row.occupied("x" if command.content else None)
    return found
