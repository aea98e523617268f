"""Wrong values and texts of elements."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

BAD_VALUE = Diagnosis(
    "bad-value",
    "Bad value",
    (
        "An attribute's text is not of the attribute's kind: a time has its unit (2s, 500ms), "
        "a number is written in digits, and so on. A literal as the expression of a Command's "
        "argument is checked in the same way: a warning, as at run time it is error.semantic."
    ),
)

OUT_OF_RANGE = Diagnosis(
    "out-of-range",
    "Number out of range",
    "A number is greater or smaller than the attribute or argument allows.",
)

EXCLUSIVE = Diagnosis(
    "exclusive",
    "Attributes that exclude each other",
    (
        "Two attributes exclude each other: they express the same thing in different ways, or "
        "request two things of which the element does one. Keep one."
    ),
)

TOO_LONG = Diagnosis(
    "too-long",
    "Speech too long",
    (
        "An utterance or a question keeps the speaker for ten minutes at most, counted at 50 "
        "ms a character: meanwhile nobody can answer the user, as no unit is cut. A run "
        "refuses it as error.semantic (rule E3)."
    ),
    rule="E3",
)

LONG_TURN = Diagnosis(
    "long-turn",
    "Speech too long beside another",
    (
        "Beside another application, an utterance or a question keeps the speaker no longer than "
        "the run's patience, 60 s by default, counted at 50 ms a character. A run refuses it "
        "as error.semantic then (rule E6)."
    ),
    rule="E6",
    severity="warning",
)

NOTHING_TO_SAY = Diagnosis(
    "nothing-to-say",
    "Nothing to say",
    (
        "A Command that speaks has no text. Of a question's prompt that is a warning, and so is a "
        "question whose first prompt has a count above 1: prompts are counted from 1, so that the "
        "robot listens without a word the first time."
    ),
    rule="E3",
)
ASKED_LATER = NOTHING_TO_SAY.says(
    "The first time, nothing is asked: this is the first prompt, and it begins at count {count}.",
    'Remove count="{count}", or write a <prompt> before it.',
    "warning",
)
