"""Arguments of Commands: their values, and those that are missing or exclude each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from prima.errors import did_you_mean, one_of
from prima.language.commands import Argument, CommandType
from prima.language.values import BadValue, Value, is_beyond, outside, quoted, read_value

_A_KIND = {
    "number": "a number",
    "duration": "a time: a number of seconds, or a text with its unit",
    "boolean": "true or false",
    "id": "a name",
    "text": "a text",
}


def check_argument(name: str, argument: Argument, value: object) -> Value:
    """Give ``value`` as the argument's Python value.

    Text is read as an attribute would be; a number given for a time counts
    seconds.

    Raises:
        BadValue: with a sentence about the argument, for the author.
    """
    said = f"{name} {quoted(value)}"
    try:
        kind = argument.kind
        result = read_value(kind, value) if isinstance(value, str) else _converted(kind, value)
    except BadValue as error:
        raise BadValue(f"{said} {error.wrong}", error.remedy, right=error.right) from None
    if is_beyond(result, argument.low, argument.high):
        wrong = f"{said} {outside(argument.kind, argument.low, argument.high)}"
        raise BadValue(wrong, beyond=True)
    return result


def _converted(kind: str, value: object) -> Value:
    """A value that is not text, as one of a kind.

    Raises:
        BadValue: it is of another kind.
    """
    found: Value | None
    if isinstance(value, bool):
        found = value if kind == "boolean" else None
    else:
        number = value if isinstance(value, int | float) and math.isfinite(value) else None
        found = None if number is None else _of_number(kind, number)
    if found is None:
        raise BadValue(f"is not {_A_KIND[kind]}.")
    return found


def _of_number(kind: str, value: float) -> Value | None:
    """A number as a value of a kind; None if it is not one."""
    if kind == "duration":
        return round(value * 1000) if abs(value) < 1e9 else -1
    if kind == "number":
        return float(value)
    return str(int(value)) if kind == "id" and value == int(value) else None


def check_arguments(
    row: CommandType, text: str | None, given: Mapping[str, object]
) -> dict[str, Value]:
    """Give all arguments of a Command with defaults filled in (rule E3).

    Raises:
        ValueError: unknown, missing, contradicting or out-of-range arguments, or
            a text missing or too much.
    """
    if row.text == "required" and not text:
        raise ValueError(f"{row.name} has nothing to say.")
    if row.text == "none" and text:
        raise ValueError(f"{row.name} cannot say anything.")
    values: dict[str, Value] = {}
    for name, value in given.items():
        argument = row.arguments.get(name)
        if argument is None:
            hint = did_you_mean(name, row.arguments)
            raise ValueError(f'{row.name} has no argument "{name}". {hint}'.rstrip())
        values[name] = check_argument(name, argument, value)
    problem = missing_argument(row, values) or excluding_arguments(row, values)
    if problem:
        raise ValueError(problem)
    for name, argument in row.arguments.items():
        if name not in values and argument.default is not None:
            values[name] = argument.default
    return values


def missing_argument(row: CommandType, given: Iterable[str]) -> str:
    """Say which argument ``row`` still needs."""
    names = set(given)
    for name, argument in row.arguments.items():
        if argument.required and name not in names:
            return f'{row.name} needs "{name}".'
    choices = alternatives(row)
    if choices and not choices & names:
        return f"{row.name} needs one of {one_of(choices)}."
    return ""


def excluding_arguments(row: CommandType, given: Iterable[str]) -> str:
    """Say which arguments of ``row`` exclude each other, where several of them are given."""
    choices = alternatives(row)
    if len(choices & set(given)) > 1:
        return f"{row.name} needs only one of {one_of(choices)}."
    return ""


def alternatives(row: CommandType) -> set[str]:
    """The arguments of which a Command has exactly one."""
    return {name for name, argument in row.arguments.items() if argument.choice}
