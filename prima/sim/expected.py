"""Names in a scenario's expectations that are unknown to its robot and applications."""

from __future__ import annotations

from collections.abc import Iterator

from prima.devices.profile import Profile
from prima.devices.reading import unknown_name
from prima.errors import Hint, Problem, one_of, suggestion
from prima.errors.diagnoses.names import NO_SUCH_NAME
from prima.interpreter.elements import Document
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2
from prima.markup.spans import value_span
from prima.messages import SERVICE
from prima.session import AnyDocument
from prima.sim.expectations import Expectation
from prima.sim.scenario import Scenario

NO_VALUE = NO_SUCH_NAME.says('{whose} no {what} "{name}".', severity="warning")

COMMANDS = ("does", "finishes", "doing", "done")
"""Attributes that name a Command."""


def check_expectations(
    scenario: Scenario, documents: list[AnyDocument], robot: Profile
) -> list[Problem]:
    """Unknown names in a scenario's expectations."""
    problems: list[Problem] = []
    commands = {*robot.commands, *TABLE_4_2}  # those it cannot do are warnings
    applications = {document.id for document in documents}
    names = {service.name for service in scenario.services}
    services = names | {SERVICE + name for name in names}
    forms: dict[str, set[str] | None] = {}
    for one in scenario.expectations:
        for name in COMMANDS:
            problems += unknown_name(one.node, name, commands, "There is no Command")
        if ":" not in one.words.get("sends", "").removeprefix(SERVICE):
            problems += unknown_name(one.node, "sends", services, "There is no service")
        if not one.by or one.by in applications:
            if one.by not in forms:
                forms[one.by] = _forms(one.by, documents)
            known = forms[one.by]
            if known is not None:
                wrong = f"{one.by} has no form" if one.by else "No application has a form"
                problems += unknown_name(one.node, "state", known, wrong)
    return problems


def check_values(scenario: Scenario, robot: Profile) -> Iterator[Problem]:
    """Warnings about the values that a scenario's expectations name."""
    for one in scenario.expectations:
        yield from _values(one, robot, scenario)


def _values(one: Expectation, robot: Profile, scenario: Scenario) -> Iterator[Problem]:
    """Values that an expected Command does not have, or that are likely a typo of an event's."""
    nodes = one.node.all("data")
    command = one.words.get("does") or one.words.get("finishes", "")
    row = robot.commands.get(command) or TABLE_4_2.get(command)
    event = one.words.get("event", "")
    known = _event_values(event, scenario) if nodes and event else set()
    if row is not None:
        known = {*row.arguments, *row.extra}
    for node in nodes:
        name = node.get("name")
        if name in known:
            continue
        hint = suggestion(name, known, *value_span(node, "name"))
        if row is not None or hint:
            whose, what = (command, "argument") if row is not None else (event, "value")
            place = node.attribute_place("name")
            yield NO_VALUE.at(
                place, hint or _listed(known), whose=f"{whose} has", what=what, name=name
            )


def _listed(known: set[str]) -> Hint:
    """The arguments that a Command has."""
    return Hint(f"It has {one_of(known).replace(' or ', ' and ')}." if known else "Remove it.")


def _event_values(event: str, scenario: Scenario) -> set[str]:
    """The names of the values that the scenario gives an event."""
    replies = [(f"reply.{service.name}", service.replies) for service in scenario.services]
    given = [(name, reply.data) for name, several in replies for reply in several]
    nodes = [node for node in scenario.node.walk() if node.tag == "event"]
    given += [
        (node.get("name"), {one.get("name"): "" for one in node.all("data")}) for node in nodes
    ]
    return {value for name, data in given if takes(event, name) for value in data}


def _forms(by: str, documents: list[AnyDocument]) -> set[str] | None:
    """The forms of an application, or of all; a VoiceXML application may have other documents."""
    forms: set[str] = set()
    for document in documents:
        if by in ("", document.id):
            if not isinstance(document, Document):
                return None
            forms |= set(document.forms)
    return forms
