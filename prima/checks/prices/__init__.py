"""Prices: how long a reaction may have to wait for parts of another application.

Nothing that runs is cut (rule U1), and units are indivisible (U4, U5); so a reaction that needs
the same device waits for the end. The times are those of the simulator's voice and gestures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.checks.prices.model import Gap, Outline, Price, PricedReaction, worst
from prima.devices.profile import Profile
from prima.errors import Problem
from prima.errors.diagnoses.behaviour import UNIT_PRICE
from prima.interpreter.elements import Document

if TYPE_CHECKING:
    from prima.voicexml.document import VoiceDocument

__all__ = ["Gap", "Outline", "Price", "PricedReaction", "notes", "outline", "worst"]


def outline(document: Document | VoiceDocument, profile: Profile) -> Outline:
    """The outline of an application in either language, with its further documents."""
    if isinstance(document, Document):
        from prima.checks.prices.dialogue import DialoguePrices

        return DialoguePrices(document, profile).price().outline()
    from prima.checks.prices.voice import VoicePrices

    return VoicePrices(document, profile).outline()


UNIT_WAITS = UNIT_PRICE.says(
    "While this unit runs, a reaction that needs its devices waits up to {seconds}."
)


def notes(document: Document, profile: Profile) -> list[Problem]:
    """The cost of units, as notes for ``prima validate --notes``."""
    from prima.checks.prices.dialogue import DialoguePrices

    return [
        UNIT_WAITS.at(price.place, seconds=price.seconds)
        for price in DialoguePrices(document, profile).price().parts
        if price.what == "unit"
    ]
