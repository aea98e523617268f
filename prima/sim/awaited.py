"""The events that a scenario's triggers and expectations name, and those of them that never occur."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Hint, Problem, meant
from prima.errors.diagnoses.names import UNKNOWN_EVENT
from prima.interpreter.events import OWN, STANDARD, KnownEvents, near
from prima.interpreter.selection import beginnings
from prima.interpreter.surroundings import NO_SENSOR, nearest
from prima.language.commands import TABLE_4_2
from prima.language.values import read_value
from prima.markup.spans import instead, value_span
from prima.markup.tree import Node
from prima.sim.devices import Cast

ENDINGS = frozenset({"exit", "unloaded"})
"""The reasons for an application's end other than names of events."""
OPEN = (
    *("end.", "cancel.", "interrupted.", "expired.", "reply.", "error.service."),
    *("error.unsupported.", "error.badfetch."),
)
"""Beginnings of events that continue with a name from outside the language."""
OWN_ALONE = frozenset({"noinput", "nomatch", "suspended", "resumed"})
OWN_ERRORS = ("error.device", "error.semantic", "error.badfetch", "error.unsupported", "error.unit")
"""Events that only the application concerned gets, besides those of its Commands."""
ERRORS = ("error.", "connection.")
"""Beginnings of events that end an application, whatever follows."""
MOST = 500
"""Only so many triggers of a kind are checked: each is compared with all possible utterances."""

NEVER_RAISED = UNKNOWN_EVENT.says('Nothing raises an event "{name}".')
NOT_SEEN = UNKNOWN_EVENT.says(
    'Only the application concerned gets "{name}": a scenario never sees it.',
    "Name what its handler says or does.",
)
NO_END = UNKNOWN_EVENT.says(
    'No application ends with "{name}".', "Write exit, unloaded or the name of an error."
)


def awaited(nodes: list[Node]) -> Iterator[tuple[Node, str, str]]:
    """The events named by triggers and expectations: element, attribute, name."""
    for node in [one for one in nodes if one.tag in ("when", "expect", "never")][:MOST]:
        for attribute in ("on", "event", "reason"):
            if name := node.get(attribute):
                yield node, attribute, name


def raised(nodes: list[Node], events: list[KnownEvents]) -> set[str]:
    """The events of the scenario, and those that applications raise."""
    made = {node.get("name") for node in nodes if node.tag == "event"}
    return made | {one.name for known in events for one in known.raised}


def check_awaited(nodes: list[Node], events: list[KnownEvents], cast: Cast) -> Iterator[Problem]:
    """Triggers and expectations of an event that no scenario sees, or that is likely a typo."""
    made = raised(nodes, events)
    services = {one.name for one in cast.scenario.services}
    services = services.union(*(one.services for one in events))
    if any(one.dynamic for one in events):
        services = set()  # any is possible
    there = _There(
        *({*cast.robot.commands, *TABLE_4_2}, services, frozenset(cast.robot.touch)),
        *(made, {corner.event for corner in cast.world.corners}),
    )
    for node, attribute, name in awaited(nodes):
        if attribute == "reason":
            yield from there.check_ending(node, name)
        elif name not in made and _of_application(name):
            yield _unseen(node, attribute, name, there.commands)
        elif name not in there.begins:
            yield from there.check_event(node, attribute, name)


def _of_application(name: str) -> bool:
    """Whether only the application concerned gets an event."""
    kind = name.partition(".")[0]
    return name in OWN_ALONE or kind in OWN or name.startswith(OWN_ERRORS)


def _unseen(node: Node, attribute: str, name: str, commands: set[str]) -> Problem:
    """A trigger or expectation of an event that only an application gets."""
    kind, _, command = name.partition(".")
    command = command if command in commands else near(command, commands) or command
    other = "finishes" if attribute == "event" else "done"
    remedy = Hint()
    if kind == "end" and command:
        remedy = instead(f'Write {other}="{command}".', node, attribute, other, command)
    return NOT_SEEN.at(node.attribute_place(attribute), remedy, name=name)


class _There:
    """The names that events of a scenario may have."""

    def __init__(
        self,
        commands: set[str],
        services: set[str],
        touch: frozenset[str],
        made: set[str],
        corners: set[str],
    ) -> None:
        self.commands = commands
        self.services = services
        self.touch = touch
        self.known = {*STANDARD, *made, *corners, *(f"touch.{sensor}" for sensor in touch)}
        self.begins = {name for one in self.known for name in beginnings(one)}
        self.endings = {*ENDINGS, *made, *(one for one in STANDARD if one.startswith("error"))}

    def check_ending(self, node: Node, name: str) -> Iterator[Problem]:
        """A reason with which no application ends."""
        other = self._other_name(name) if name.startswith(OPEN) else near(name, self.endings)
        begins = {start for one in self.endings for start in beginnings(one)}
        if name not in begins and (other or not name.startswith(ERRORS)):
            remedy = meant(other, *value_span(node, "reason"))
            yield NO_END.at(node.attribute_place("reason"), remedy, name=name)

    def check_event(self, node: Node, attribute: str, name: str) -> Iterator[Problem]:
        """An event that nothing raises: a time, or a typo."""
        place, span = node.attribute_place(attribute), value_span(node, attribute)
        if name.startswith("touch."):
            sensor = name.removeprefix("touch.")
            hint = nearest(sensor, self.touch, *value_span(node, attribute, sensor))
            yield NO_SENSOR.at(place, hint, name=sensor)
        elif attribute == "on" and _is_time(name):
            remedy = instead(f'Write at="{name}".', node, "on", "at", name)
            yield NEVER_RAISED.at(node.attribute_place("on", value=False), remedy, name=name)
        elif other := self._other_name(name) if name.startswith(OPEN) else near(name, self.known):
            yield NEVER_RAISED.at(place, meant(other, *span), name=name)

    def _other_name(self, name: str) -> str:
        """The event of the Command or service of which another's is likely a typo, or nothing."""
        first, _, end = name.rpartition(".")
        known = self.commands if first == "error.unsupported" else set()
        if first in ("reply", "error.service"):
            known = self.services
        other = near(end, known) if end not in known else ""
        return f"{first}.{other}" if other else ""


def _is_time(text: str) -> bool:
    try:
        read_value("duration", text)
    except ValueError:
        return False
    return True
