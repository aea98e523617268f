"""Names in a scenario's expectations that are unknown to its robot and applications."""

from __future__ import annotations

from prima.devices.profile import Profile
from prima.devices.reading import unknown_name
from prima.errors import Problem
from prima.interpreter.elements import Document
from prima.language.commands import TABLE_4_2
from prima.session import AnyDocument
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
            problems += unknown_name(one.node, name, commands, "There is no Command")
        if ":" not in one.words.get("sends", ""):
            problems += unknown_name(one.node, "sends", services, "There is no service")
        if not one.by or one.by in applications:
            if one.by not in forms:
                forms[one.by] = _forms(one.by, documents)
            known = forms[one.by]
            if known is not None:
                wrong = f"{one.by} has no form" if one.by else "No application has a form"
                problems += unknown_name(one.node, "state", known, wrong)
    return problems


def _forms(by: str, documents: list[AnyDocument]) -> set[str] | None:
    """The forms of an application, or of all; a VoiceXML application may have other documents."""
    forms: set[str] = set()
    for document in documents:
        if by in ("", document.id):
            if not isinstance(document, Document):
                return None
            forms |= set(document.forms)
    return forms
