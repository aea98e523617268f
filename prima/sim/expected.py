"""Names in a scenario's expectations that are unknown to its robot and applications."""

from __future__ import annotations

from collections.abc import Collection

from prima.devices.profile import Profile
from prima.errors import Problem
from prima.interpreter.elements import Document
from prima.interpreter.surroundings import nearest
from prima.language.commands import TABLE_4_2
from prima.markup.spans import value_span
from prima.session import AnyDocument
from prima.sim.expectations import Expectation
from prima.sim.scenario import Scenario

COMMANDS = ("does", "finishes", "doing", "done")
"""Attributes that name a Command."""


def check_expectations(
    scenario: Scenario, documents: list[AnyDocument], robot: Profile
) -> list[Problem]:
    """Unknown names in a scenario's expectations."""
    problems: list[Problem] = []
    commands = {*robot.commands, *TABLE_4_2}  # those it cannot do are warnings
    applications = {document.id for document in documents}
    services = {service.name for service in scenario.services}
    forms: dict[str, set[str] | None] = {}
    for one in scenario.expectations:
        for name in COMMANDS:
            _known(one, name, commands, "There is no Command", problems)
        if ":" not in one.words.get("sends", ""):
            _known(one, "sends", services, "There is no service", problems)
        if not one.by or one.by in applications:
            if one.by not in forms:
                forms[one.by] = _forms(one.by, documents)
            _state(one, forms[one.by], problems)
    return problems


def _known(
    one: Expectation, name: str, words: Collection[str], wrong: str, problems: list[Problem]
) -> None:
    word = one.node.attributes.get(name)
    if word is None or word in words:
        return
    place = one.node.attribute_place(name)
    remedy = nearest(word, words, *value_span(one.node, name))
    problems.append(Problem(place, "error", "no-such-name", f'{wrong} "{word}".', remedy))


def _forms(by: str, documents: list[AnyDocument]) -> set[str] | None:
    """The forms of an application, or of all; a VoiceXML application may have other documents."""
    forms: set[str] = set()
    for document in documents:
        if by in ("", document.id):
            if not isinstance(document, Document):
                return None
            forms |= set(document.forms)
    return forms


def _state(one: Expectation, forms: set[str] | None, problems: list[Problem]) -> None:
    """A state named in an expectation has to be in an existing form."""
    if forms is not None:
        wrong = f"{one.by} has no form" if one.by else "No application has a form"
        _known(one, "state", forms, wrong, problems)
