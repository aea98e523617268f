"""Motion arguments and texts of Commands, checked against a row of the table or a profile."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from prima.errors import Problem
from prima.errors.diagnoses.structure import MISSING_ATTRIBUTE, STRAY_TEXT
from prima.errors.diagnoses.values import BAD_VALUE, OUT_OF_RANGE
from prima.interpreter.acts import holder_of
from prima.language.arguments import check_argument, missing_argument
from prima.language.commands import Argument, CommandType
from prima.language.values import BadValue
from prima.markup.spans import nearest_allowed
from prima.markup.tree import Node

MISSING_ARGUMENT = MISSING_ATTRIBUTE.says("{wrong}", 'Write {name}="...".')
MISSING_PARAM = MISSING_ATTRIBUTE.says(
    "{wrong}", 'Write <param name="{name}" value="..."/> into it.'
)
CANNOT_SAY = STRAY_TEXT.says("{command} cannot say anything.", "Say it with <{prefix}speak>.")
BAD_ARGUMENT = BAD_VALUE.says("{wrong}", "{remedy}")
ARGUMENT_BEYOND = OUT_OF_RANGE.says("{wrong}")


def given_to(
    node: Node, row: CommandType, given: Mapping[str, object], says: bool, prefix: str = ""
) -> Iterator[Problem]:
    """The problems of the motion arguments and the text of a Command's element.

    Args:
        node: the element.
        row: the Command's row in the robot's profile.
        given: its arguments by name; only those with texts as values are checked.
        says: whether it has a text.
        prefix: the prefix of Commands in the document, with its colon.
    """
    for name, value in given.items():
        if name in row.arguments and isinstance(value, str):
            yield from _argument(node, name, row.arguments[name], value)
    if missing := missing_argument(row, given):
        diagnosis = MISSING_PARAM if node.tag == "command" else MISSING_ARGUMENT
        yield diagnosis.at(node.place, wrong=missing, name=_lacking(row, given))
    if row.text == "none" and says:
        yield CANNOT_SAY.at(node.place, command=row.name, prefix=prefix)


def _lacking(row: CommandType, given: Mapping[str, object]) -> str:
    """The first required argument that is missing."""
    needed = (name for name, one in row.arguments.items() if one.required or one.choice)
    return next(name for name in needed if name not in given)


def _argument(node: Node, name: str, argument: Argument, text: str) -> Iterator[Problem]:
    """The problem of a motion argument's value."""
    holder, attribute = holder_of(node, name)
    place = holder.attribute_place(attribute)
    try:
        check_argument(name, argument, text)
    except BadValue as error:
        if not error.beyond:
            yield BAD_ARGUMENT.at(place, wrong=error.wrong, remedy=error.remedy)
            return
        hint = nearest_allowed(argument, text, holder, attribute)
        yield ARGUMENT_BEYOND.at(place, hint, wrong=error.wrong)
