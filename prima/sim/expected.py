"""Names in a scenario's expectations that its robot and applications do not know."""

from __future__ import annotations

from collections.abc import Iterable

from prima.errors import Problem
from prima.interpreter.elements import Document
from prima.interpreter.surroundings import nearest
from prima.session import AnyDocument
from prima.sim.scenario import Expectation, Profile, Scenario

COMMANDS = ("does", "finishes", "doing", "done")
"""Attributes that name a Command."""


def check_expectations(
    scenario: Scenario, documents: list[AnyDocument], robot: Profile
) -> list[Problem]:
    """What the expectations of a scenario name and is not there."""
    problems: list[Problem] = []
    applications = {document.id for document in documents}
    services = {service.name for service in scenario.services}
    for one in scenario.expectations:
        checks: list[tuple[str, Iterable[str], str]] = [
            ("by", applications, "application"),
            ("ends", applications, "application"),
            *((name, robot.commands, "Command") for name in COMMANDS),
        ]
        if ":" not in one.words.get("sends", ""):
            checks.append(("sends", services, "service"))
        for name, words, what in checks:
            _known(one, name, set(words), f"There is no {what}", problems)
        if not one.by or one.by in applications:
            _state(one, documents, problems)
    return problems


def _known(
    one: Expectation, name: str, words: set[str], wrong: str, problems: list[Problem]
) -> None:
    word = one.node.attributes.get(name)
    if word is None or word in words:
        return
    place = one.node.attribute_place(name)
    remedy = nearest(word, words)
    problems.append(Problem(place, "error", "no-such-name", f'{wrong} "{word}".', remedy))


def _state(one: Expectation, documents: list[AnyDocument], problems: list[Problem]) -> None:
    """A form of the application, or of any; a VoiceXML application may have other documents."""
    meant = [document for document in documents if one.by in ("", document.id)]
    forms: set[str] = set()
    for document in meant:
        if not isinstance(document, Document):
            return
        forms |= set(document.forms)
    wrong = f"{one.by} has no form" if one.by else "No application has a form"
    _known(one, "state", forms, wrong, problems)
