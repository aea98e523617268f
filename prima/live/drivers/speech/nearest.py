"""What was heard, as phrases of what listens now: hypotheses with their confidence."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

from prima.grammar.text import fold
from prima.messages import Hypothesis

MOST = 5
"""Hypotheses that are told."""
LONGEST = 400
"""Letters that are compared."""
SURE, HEARD, ALONE = 0.99, 0.9, 0.6
"""How sure it is of words that both recognisers have heard, the open one, the grammar's alone."""
EASIER = 0.2
"""How much less like what was said a phrase may be that the grammar's recogniser has heard."""
AGREED = 0.5
"""By how much of what it lacks a phrase is surer when both recognisers have heard it."""


def likeness(one: str, other: str) -> float:
    """How alike two texts sound, as far as their letters tell: 0 to 1."""
    one, other = (fold(text).replace(" ", "")[:LONGEST] for text in (one, other))
    return SequenceMatcher(None, one, other, autojunk=False).ratio() if one and other else 0.0


def hypotheses(said: str, fits: str, phrases: Iterable[str], cutoff: float) -> list[Hypothesis]:
    """What an utterance may have been, the likeliest first.

    What the open recogniser has heard comes first: it may be just what a question takes. Phrases
    follow that are like it, for the question that takes them only.

    Args:
        said: what the open recogniser has heard; empty if there is none.
        fits: what the recogniser of the grammar has heard, which hears nothing else.
        phrases: what listens, as far as it can be told.
        cutoff: how alike a phrase must be to what was said (0 to 1).
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
