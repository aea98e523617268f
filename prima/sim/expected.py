"""Names in a scenario's expectations that its robot and applications do not know."""

from __future__ import annotations

from collections.abc import Iterable

from prima.errors import Problem, did_you_mean, one_of
from prima.interpreter.elements import Document
from prima.session import AnyDocument
from prima.sim.scenario import Expectation, Profile, Scenario

COMMANDS = ("does", "finishes", "doing", "done")
"""Attributes that name a Command."""
MOST_NAMES = 12
"""Names that a remedy lists."""


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
            _known(one, name, set(words), what, problems)
        if not one.by or one.by in applications:
            _state(one, documents, problems)
    return problems


def _known(
    one: Expectation, name: str, words: set[str], what: str, problems: list[Problem]
) -> None:
    word = one.node.attributes.get(name)
    if word is None or word in words:
        return
    remedy = did_you_mean(word, words)
    if not remedy and 0 < len(words) <= MOST_NAMES:
        remedy = f"There is {one_of(words)}."
    message = f'There is no {what} "{word}".'
    place = one.node.attribute_place(name)
    problems.append(Problem(place, "error", "no-such-name", message, remedy))


def _state(one: Expectation, documents: list[AnyDocument], problems: list[Problem]) -> None:
    """A form of the application, or of any; a VoiceXML application may have other documents."""
    meant = [document for document in documents if one.by in ("", document.id)]
    forms: set[str] = set()
    for document in meant:
        if not isinstance(document, Document):
            return
        forms |= set(document.forms)
    whose = f"form of {one.by}" if one.by else "form of these applications"
    _known(one, "state", forms, whose, problems)
