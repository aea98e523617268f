"""Messages of ROS 2 from values, and values from messages."""

from __future__ import annotations

import importlib
import re
from collections.abc import Sequence
from typing import Any

from prima.live.driver import Refused, Unusable
from prima.messages import Json

LISTED = re.compile(r"(?:sequence<)?(?P<of>[\w/]+)(?:<\d+>)?(?:, \d+>|>|\[\d+\])")
"""The type of a field that holds several values."""


def interface(name: str) -> Any:
    """The class of a type such as ``geometry_msgs/msg/Twist``.

    Raises:
        Unreachable: it is not installed.
    """
    package, kind, of = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), of)
    except (ImportError, AttributeError):
        remedy = f"Install the package {package}, or source the workspace that has it."
        raise Unusable(f"the type {name} is not there. {remedy}") from None


def fill(message: Any, values: dict[str, Json]) -> Any:
    """Put values into a message, and into the messages in it.

    Raises:
        Refused: it has no such field, or the value does not fit.
    """
    types = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in types:
            fields = ", ".join(types) or "none"
            raise Refused(f'{type(message).__name__} has no field "{name}"; it has {fields}')
        try:
            setattr(message, name, _fitting(getattr(message, name), types[name], value))
        except (AssertionError, TypeError, ValueError) as error:
            kind = f"{name} of {type(message).__name__} is {types[name]}"
            raise Refused(f"{kind}; {value!r} does not fit: {error}") from None
    return message


def _fitting(old: Any, kind: str, value: Json) -> Any:
    """A value converted to the type of a field."""
    if isinstance(value, dict) and hasattr(old, "get_fields_and_field_types"):
        return fill(old, value)
    listed = LISTED.fullmatch(kind)
    if listed and isinstance(value, list):
        return [_element(listed["of"], one) for one in value]
    return _plain(type(old), value)


def _element(kind: str, value: Json) -> Any:
    if "/" in kind:
        package, _, name = kind.partition("/")
        return fill(interface(f"{package}/msg/{name}")(), value)
    if kind.startswith(("float", "double")):
        return float(value)
    return _plain({"boolean": bool, "string": str}.get(kind, int), value)


def _plain(kind: type, value: Json) -> Any:
    if kind is str:
        return value if isinstance(value, str) else str(value)
    if kind is int and isinstance(value, float):
        return round(value)
    if kind is float and isinstance(value, int | float):
        return float(value)
    return value


def paths(message: Any, names: Sequence[str]) -> None:
    """Check that a message has fields with these dotted names.

    Raises:
        Refused: it does not.
    """
    for name in names:
        inner = message
        for part in name.split("."):
            if not hasattr(inner, "get_fields_and_field_types"):
                raise Refused(f'"{name}" leads into a field without fields of its own')
            fields = inner.get_fields_and_field_types()
            if part not in fields:
                has = ", ".join(fields) or "none"
                raise Refused(f'{type(inner).__name__} has no field "{part}"; it has {has}')
            inner = getattr(inner, part)


def plain(message: Any) -> Json:
    """A message as nested values."""
    if hasattr(message, "get_fields_and_field_types"):
        return {
            name: plain(getattr(message, name)) for name in message.get_fields_and_field_types()
        }
    if isinstance(message, bool | int | float | str):
        return message
    if isinstance(message, bytes):
        return list(message)
    if hasattr(message, "tolist"):
        return message.tolist()
    return [plain(one) for one in message]
