"""Sensors whose values are read by a wrong name, or before there are any."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Problem, Span, meant, replaced
from prima.errors.diagnoses.names import UNDECLARED_VARIABLE
from prima.interpreter.acts import Expression
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Document, Watch
from prima.interpreter.events import near
from prima.interpreter.sensors import hides_sensors
from prima.script.parse import Code, Node, parse_expression

OF_EVERY_ROBOT = {
    "human": ("distance", "visible"),
    "moving": (),
    "position": ("heading", "x", "y"),
}
"""The sensors that every robot has, with the parts of their values."""
NO_PART = UNDECLARED_VARIABLE.says('There is no "sensor.{sensor}.{part}".', severity="warning")
NOT_YET = UNDECLARED_VARIABLE.says(
    "sensor.{sensor} has no value before the robot reports one: until then this is error.semantic.",
    severity="warning",
)


def check_sensors(facts: Facts) -> Iterator[Problem]:
    """Warn of misspelt parts of sensors, and of watches that fail before the first value."""
    watching = {id(watch.when) for watch in _watches(facts.document)}
    if not watching or hides_sensors(facts.document):
        return
    for expr in facts.document.expressions:
        code = parse_expression(expr.code) if "sensor" in expr.code else None
        if code is not None and code.sound:
            read = [(whole, name) for whole in code.walk() if (name := _sensor(code, whole))]
            yield from _misspelt(expr, code, read)
            yield from _too_early(expr, code, read) if id(expr) in watching else ()


def _watches(document: Document) -> Iterator[Watch]:
    yield from document.watches
    for form in document.forms.values():
        yield from form.watches


def _misspelt(expr: Expression, code: Code, read: list[tuple[Node, str]]) -> Iterator[Problem]:
    for whole, sensor in read:
        known, part = OF_EVERY_ROBOT.get(sensor, ()), _member(whole, "property")
        if part is None or (name := code.of(part)) in known:
            continue
        if word := near(name, known):
            place = place_in(expr, code.start(part))
            yield NO_PART.at(place, meant(word, Span.of(place, name)), sensor=sensor, part=name)


def _too_early(expr: Expression, code: Code, read: list[tuple[Node, str]]) -> Iterator[Problem]:
    """Plain members of sensors that the condition does not ask for a value before."""
    asked = {sensor for whole, sensor in read if _member(whole, "property") is None}
    for whole, sensor in read:
        dot = _member(whole, ".")
        if dot is not None and sensor not in asked and sensor not in OF_EVERY_ROBOT:
            span = Span.of(place_in(expr, code.start(dot)), ".")
            hint = replaced(f"Write sensor.{sensor}?. instead.", "?.", span)
            yield NOT_YET.at(place_in(expr, code.start(whole)), hint, sensor=sensor)


def _sensor(code: Code, node: Node) -> str:
    """The name in ``sensor.NAME``; nothing for other nodes."""
    if node.type != "member_expression" or code.of(node.children[0]) != "sensor":
        return ""
    name = node.child_by_field_name("property")
    return code.of(name) if name is not None else ""


def _member(whole: Node, part: str) -> Node | None:
    """The name that is read of an expression's value, or the dot before it; None if there is none."""
    parent = whole.parent
    if parent is None or parent.type != "member_expression":
        return None
    if part == "property":
        return parent.child_by_field_name(part)
    return next((one for one in parent.children if one.type == part), None)
