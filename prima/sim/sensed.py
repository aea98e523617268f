"""Sensors of a scenario that no application reads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from prima.errors import Problem, suggestion
from prima.errors.diagnoses.names import NO_SUCH_NAME
from prima.interpreter.elements import Document
from prima.interpreter.sensors import sensors_read
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.session import AnyDocument

UNREAD = NO_SUCH_NAME.says(
    'No application reads the sensor "{name}".',
    'Read it: <watch name="..." when="sensor.{name} ..."/>, or remove it.',
    "warning",
)


def check_sensors(nodes: Sequence[Node], documents: Sequence[AnyDocument]) -> Iterator[Problem]:
    """Sensors by the first part of their names, if all that applications read are known."""
    sensors = [node for node in nodes if node.tag == "sensor"]
    read: set[str] = set()
    for document in documents if sensors else ():
        known = sensors_read(document) if isinstance(document, Document) else None
        if known is None:
            return
        read |= known
    for node in sensors:
        name = node.get("name").partition(".")[0]
        if name and name not in read:
            hint = suggestion(name, read, *value_span(node, "name", name))
            yield UNREAD.at(node.attribute_place("name"), hint, name=name)
