"""Conditions that do not ask what they seem to ask."""

from __future__ import annotations

import re
from collections.abc import Collection

from prima.errors.diagnosis import Diagnosis
from prima.errors.guesses import suggestion
from prima.errors.problems import Hint, Place, Problem, Span
from prima.errors.words import one_of

ASSIGNING_CONDITION = Diagnosis(
    "assigning-condition",
    "Condition that assigns",
    "A condition has = where a comparison, ==, was most likely meant: it changes the variable, and"
    " holds whenever the new value does. With =>, meant for >=, it is a function, which always holds.",
    severity="warning",
    message="This condition gives a variable a value; it does not compare.",
    remedy="Write ==.",
)
FUNCTION_CONDITION = ASSIGNING_CONDITION.says(
    "This condition is a function, which is always true; it does not compare.", "Write >=."
)

NEVER_EQUAL = Diagnosis(
    "never-equal",
    "Comparison with no answer",
    "A condition compares the variable of a question with a text that is the value of none of its"
    " answers. It never holds, or with != always. A question of the type boolean gives true or false"
    " and no text; an option its value, or else its own text; a grammar what its tags say. Upper and"
    " lower case count.",
    severity="warning",
    message='No answer to "{field}" gives it the value "{text}".',
)
TRUE_OR_FALSE = 'It is true or false: write "{field}" or "!{field}".'
NUMERIC = re.compile(r"\s*([-+.\d].*)?", re.DOTALL)
"""A text that may equal true, false or a number; an empty one may stand for no answer."""
PLAIN = re.compile(r"[\w .-]*")
"""A text that is written in an attribute as it is."""
MOST = 5
"""Maximum number of values that a message lists."""
LONGEST = 100
"""Characters of a text above which a comparison is not checked."""


def may_equal(text: str, values: Collection[str]) -> bool:
    """Whether one of some values, or true or false, may equal a text as code has it."""
    return "\\" in text or bool(NUMERIC.fullmatch(text)) or len(text) > LONGEST or text in values


def never_equal(
    quote: Place, inside: Place, field: str, text: str, values: Collection[str] | None
) -> Problem:
    """A comparison with a text that is none of a field's values; without any, it is boolean.

    Args:
        quote: where the text begins, with its quote.
        inside: where it begins without it.
        field: the name of the field.
        text: the text.
        values: the values that answers give.
    """
    if values is None:
        hint = Hint(TRUE_OR_FALSE.format(field=field))
    else:
        plain = filter(PLAIN.fullmatch, values) if PLAIN.fullmatch(text) else ()
        hint = suggestion(text, plain, Span.of(inside, text))
        hint = hint or Hint(f"It is {one_of(values, MOST)}.")
    return NEVER_EQUAL.at(quote, hint, field=field, text=text)
