"""Conditions that do not ask what they seem to ask."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

ASSIGNING_CONDITION = Diagnosis(
    "assigning-condition",
    "Condition that assigns",
    "A condition has = where a comparison, ==, was most likely meant: it changes the variable, and"
    " holds whenever the new value does. With =>, meant for >=, it is a function, which always holds,"
    " as do a list, a text and what stands in { and }.",
    severity="warning",
    message="This condition gives a variable a value; it does not compare.",
    remedy="Write ==.",
)
FUNCTION_CONDITION = ASSIGNING_CONDITION.says(
    "This condition is a function, which is always true; it does not compare.", "Write >=."
)
LITERAL_CONDITION = ASSIGNING_CONDITION.says(
    "This condition is {kind}, which is always true; it does not compare.",
    "Write it without {signs}.",
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
