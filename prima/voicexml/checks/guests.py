"""Commands and other elements of PRIMA's language in a VoiceXML document."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from prima.errors import Problem, few, suggestion
from prima.errors.diagnoses.names import UNSUPPORTED_COMMAND
from prima.errors.diagnoses.structure import MISPLACED_ELEMENT, MISSING_ATTRIBUTE, UNKNOWN_ATTRIBUTE
from prima.errors.diagnoses.values import EXCLUSIVE, NOTHING_TO_SAY
from prima.interpreter.acts import type_of
from prima.interpreter.checks import given_to
from prima.interpreter.checks.robot import Ability
from prima.interpreter.units import ARRANGING, QUESTION
from prima.language.arguments import excluding_arguments
from prima.language.commands import TABLE_4_2, CommandType
from prima.markup.spans import similar_attribute, value_span
from prima.markup.tree import Node
from prima.voicexml.arranging import arguments_of, check_arranged, unknown_command
from prima.voicexml.elements import HANDLERS, handler_names
from prima.voicexml.vocabulary import HOLDING, NAMESPACE, PRIMA_NAMESPACE, VOICEXML

QUESTIONS = frozenset({"field", "initial", "menu"})
"""Elements that ask the user."""

NOT_HERE = MISPLACED_ELEMENT.says(
    "A Command is not allowed in <{parent}>.", "It is allowed in prompts and executable content."
)
ARRANGING_NOT_HERE = MISPLACED_ELEMENT.says(
    "<p:{tag}> is not allowed in <{parent}>: it is around Commands.", NOT_HERE.remedy
)
UNIT_NOT_HERE = MISPLACED_ELEMENT.says(
    "<p:iu> is not allowed in <{parent}>.",
    "Write it around Commands in content, or around the items of a <form>.",
)
HOLDS_NONE = MISPLACED_ELEMENT.says(
    "<{tag}> is not allowed in <p:{parent}>.", "A Command holds text, <value> and <param>."
)
NO_ATTRIBUTE = UNKNOWN_ATTRIBUTE.says('<{tag}> has no attribute "{name}".', "Remove it.")
NO_COMMAND = UNSUPPORTED_COMMAND.says(
    'This robot has no Command "{command}".', "Add it to the robot's document, or name another."
)
ONLY_ONE = EXCLUSIVE.says("{wrong}", "Keep one of them.", "warning")
HAS_BOTH = EXCLUSIVE.says(
    '<p:{tag}> has both "{name}" and "{name}-expr".', "Keep one of them.", "warning"
)
SAYS_NOTHING = NOTHING_TO_SAY.says(
    "<p:{tag}> has nothing to say.", "Write its text inside it.", "warning"
)


def check_guest(node: Node, parent: Node) -> list[Problem]:
    """Check an element of PRIMA's language among VoiceXML's own."""
    if problem := unknown_command(node):
        return [problem]
    problems: list[Problem] = []
    if parent.key not in HOLDING and VOICEXML.child(parent.key, "assign") is None:
        diagnosis = ARRANGING_NOT_HERE if node.tag in ARRANGING else NOT_HERE
        diagnosis = UNIT_NOT_HERE if node.tag == "iu" else diagnosis
        problems.append(diagnosis.at(node.place, tag=node.tag, parent=parent.tag))
    commands = check_arranged(node, problems) if node.tag in ARRANGING else [node]
    for command in commands:
        problems += _check_arguments(command)
        problems += _check_content(command)
    return problems


def _check_content(command: Node) -> Iterator[Problem]:
    """What a Command cannot hold: others, and elements that are neither speech nor arguments."""
    for child in command.nodes:
        speech = child.tag == "param" or VOICEXML.child("prompt", child.tag) is not None
        if child.namespace == PRIMA_NAMESPACE:
            yield HOLDS_NONE.at(child.place, tag=f"p:{child.tag}", parent=command.tag)
        elif child.namespace == NAMESPACE and not speech:
            yield HOLDS_NONE.at(child.place, tag=child.tag, parent=command.tag)


def _check_arguments(node: Node) -> Iterator[Problem]:
    known = _known(node)
    for name in _unknown(node, known):
        hint = similar_attribute(node, name, known)
        place = node.attribute_place(name, value=False)
        yield NO_ATTRIBUTE.at(place, hint, tag=node.tag, name=name)


def _known(node: Node) -> set[str]:
    """The arguments that a Command's element may have as attributes."""
    row = TABLE_4_2.get(node.tag)
    return set(row.arguments) if row is not None else {"type"}


def _unknown(node: Node, known: set[str]) -> list[str]:
    """The attributes of a Command's element that the Command does not have."""
    own = (one for one in node.attributes if not one.startswith(("xml:", "{")))
    return [one for one in own if one.removesuffix("-expr") not in known]


def check_commands(
    roots: Sequence[Node], commands: Mapping[str, CommandType], devices: frozenset[str]
) -> list[Problem]:
    """Warn of Commands that a robot adds or lacks: at run time they cause events.

    ``roots`` are the root elements of the document and of its application root, if it has one.
    """
    nodes = [one for root in roots for one in root.walk()]
    heard = {name for one in nodes if one.tag in HANDLERS for name in handler_names(one)}
    robot = Ability(commands, devices, heard, handler="catch")
    problems: list[Problem] = []
    lacking: list[Problem] = []
    for node in roots[0].walk():
        if name := _asked_for(node):
            lacking += [robot.problem(node, name)] if robot.lacks(name) else []
        elif node.namespace == PRIMA_NAMESPACE and node.tag == "command" and node.get("type"):
            problems += _check_added(node, commands)
    return problems + few(lacking, 1)


def _asked_for(node: Node) -> str:
    """The Command of Table 4.2 for which an element asks, or nothing."""
    if node.namespace == PRIMA_NAMESPACE and type_of(node) in TABLE_4_2:
        return type_of(node)
    if node.namespace != NAMESPACE:
        return ""
    if node.tag == "block":
        return "speak" if node.own_text.strip() or node.all("prompt") else ""
    return QUESTION if node.tag in QUESTIONS else ""


def _check_added(node: Node, commands: Mapping[str, CommandType]) -> list[Problem]:
    """The problems of a ``<command>``, whose type only the robot defines."""
    row = commands.get(node.get("type"))
    if row is not None:
        return command_problems(node, row)
    hint = suggestion(node.get("type"), commands, *value_span(node, "type"))
    return [NO_COMMAND.at(node.attribute_place("type"), hint, command=node.get("type"))]


def command_problems(node: Node, row: CommandType) -> list[Problem]:
    """Arguments and texts that make a Command fail with an event when it is requested."""
    given = arguments_of(node, row)
    says = bool(node.own_text.strip() or node.all("value"))
    told = {MISSING_ATTRIBUTE.code} if _unknown(node, _known(node)) else set()
    found = [
        one._replace(severity="warning")
        for one in given_to(node, row, given, says, prefix="p:")
        if one.code not in told  # an attribute meant for it is reported already
    ]
    if excluding := excluding_arguments(row, given):
        found.append(ONLY_ONE.at(node.place, wrong=excluding))
    for name in row.arguments:
        if {name, f"{name}-expr"} <= node.attributes.keys():
            found.append(HAS_BOTH.at(node.place, tag=node.tag, name=name))
    if row.text == "required" and not says and not node.nodes:
        found.append(SAYS_NOTHING.at(node.place, tag=node.tag))
    return found
