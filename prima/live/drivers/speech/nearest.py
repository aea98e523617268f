"""Matches what was heard with phrases of what listens now: hypotheses with their confidence."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

from prima.grammar.text import fold
from prima.messages import Hypothesis

MOST = 5
"""Maximum number of hypotheses."""
LONGEST = 400
"""The number of letters that are compared."""
SURE, HEARD, ALONE = 0.99, 0.9, 0.6
"""The confidence in words that both recognisers, the open one, or only the grammar's have heard."""
EASIER = 0.2
"""How much less similar a phrase may be if the grammar's recogniser has heard it."""
AGREED = 0.5
"""The share of the missing confidence that a phrase gains if both recognisers have heard it."""


def likeness(one: str, other: str) -> float:
    """The similarity of two texts by their letters, from 0 to 1."""
    one, other = (fold(text).replace(" ", "")[:LONGEST] for text in (one, other))
    return SequenceMatcher(None, one, other, autojunk=False).ratio() if one and other else 0.0


def hypotheses(said: str, fits: str, phrases: Iterable[str], cutoff: float) -> list[Hypothesis]:
    """The possible texts of an utterance, the likeliest first.

    What the open recogniser has heard comes first: a question may accept just that. Similar
    phrases follow, for a question that accepts only those.

    Args:
        said: what the open recogniser has heard; empty if there is no such recogniser.
        fits: what the recogniser limited to the grammar has heard.
        phrases: what listens, as far as known.
        cutoff: the minimum similarity of a phrase to what was said (0 to 1).
    """
    if not said:
        return [Hypothesis(fits, ALONE)] if fits else []
    first = Hypothesis(said, SURE if fold(fits) == fold(said) else HEARD)
    found = {fold(phrase): likeness(said, phrase) for phrase in phrases}
    sure = likeness(said, fits)
    if fits and sure >= cutoff - EASIER:
        found[fold(fits)] = max(sure + (1 - sure) * AGREED, cutoff)
    near = {text: sure for text, sure in found.items() if sure >= cutoff and text != fold(said)}
    ranked = sorted(near.items(), key=lambda one: -one[1])[: MOST - 1]
    less = first.confidence - 0.01
    return [first, *(Hypothesis(text, round(min(sure, less), 2)) for text, sure in ranked)]
