"""Diagnoses made while an application is built from its elements."""

from __future__ import annotations

from prima.errors.diagnoses.grammars import BAD_TOKEN, EMPTY_ANSWER, NO_ANSWER
from prima.errors.diagnoses.names import FA_ONLY
from prima.errors.diagnoses.structure import (
    AFTER_ELSE,
    DUPLICATE_ANSWER,
    DUPLICATE_ID,
    EMPTY,
    MISPLACED_ELEMENT,
    MISSING_ATTRIBUTE,
    MISSING_ELEMENT,
    NO_FORM,
    UNKNOWN_ATTRIBUTE,
)
from prima.errors.diagnoses.values import (
    BAD_VALUE,
    EXCLUSIVE,
    LONG_TURN,
    NOTHING_TO_SAY,
    OUT_OF_RANGE,
    TOO_LONG,
)

BEYOND = OUT_OF_RANGE.says("{wrong}")
NEVER_FITS = BAD_VALUE.says("{wrong}", severity="warning")
NEVER_WITHIN = OUT_OF_RANGE.says("{wrong}", severity="warning")
NEEDS_EITHER = MISSING_ATTRIBUTE.says("<{tag}> needs either {first} or {second}.")
NEEDS_VALUE = MISSING_ATTRIBUTE.says("<param> needs a value or an expr.")
NEEDS_ARGUMENT = MISSING_ATTRIBUTE.says("{wrong}")
HAS_BOTH = EXCLUSIVE.says('<{tag}> has both "{first}" and "{second}".', "Keep one of them.")
ONLY_ONE = EXCLUSIVE.says("{wrong}", "Keep one of them.")
NO_DELAY = EXCLUSIVE.says("Only an event to the application itself has a delay.", "Remove it.")
TWO_FORMS = DUPLICATE_ID.says('There are two forms "{name}".', "Rename one.")
ID_WITH_DOT = BAD_VALUE.says(
    'id "{name}" has a dot.', "Use letters, digits and hyphens: transcripts count with dots."
)
NAME_WITH_DOT = BAD_VALUE.says(
    '{attribute_name} "{name}" has a dot.', "Declare it where it belongs, without a scope's name."
)
RESERVED_NAME = BAD_VALUE.says(
    '{attribute_name} "{name}" is a word of ECMAScript\'s own.', "Choose another name."
)
BAD_PROPERTY = BAD_VALUE.says('{name} "{value}" {wrong}')
OF_FORMS = UNKNOWN_ATTRIBUTE.says(
    "A <filled> in an item has no {name}: it waits for that item alone.",
    "Remove it, or move the <filled> to the end of the form.",
    "warning",
)
NO_FORM_AT_ALL = NO_FORM.says("The application has no form.", "Write at least one <form>.")
NO_GRAMMAR = MISSING_ELEMENT.says(
    "<link> needs one <grammar>.", "Write what the user says into one."
)
SECOND_GRAMMAR = MISPLACED_ELEMENT.says(
    "<link> takes one <grammar>.", "Write all that the user may say into the first, as <one-of>."
)
EMPTY_OPTION = EMPTY_ANSWER.says(
    "This option has no words.", "Write the words of the answer into it."
)
BARRED_OPTION = BAD_TOKEN.says(
    'There is no "|" here: the words before and behind it are one answer.',
    "Write an <option> for each answer.",
    "warning",
)
TWO_OPTIONS = DUPLICATE_ANSWER.says(
    '"{answer}" is an option of this field already.', "Remove one of them."
)
TAKES_NO_ANSWER = NO_ANSWER.says(
    'The field "{name}" takes no answer at all.', "Give it options, a grammar or a type."
)
EMPTY_UNIT = EMPTY.says("This <iu> holds no Command.", "Write what must not be cut into it.")
NO_ITEM = EMPTY.says("This <iu> holds no item of the form.", EMPTY_UNIT.remedy)
FOR_FAS = FA_ONLY.says(
    "Additional arguments are for an FA alone: an EA does not know the robot.",
    "Remove the <param>.",
)
SAYS_NOTHING = NOTHING_TO_SAY.says("<{tag}> has nothing to say.", "Write its text inside it.")
ONLY_A_PAUSE = NOTHING_TO_SAY.says(
    SAYS_NOTHING.message, f'{SAYS_NOTHING.remedy} A pause between Commands is <pause time="1s"/>.'
)
SPEAKS_TOO_LONG = TOO_LONG.says("{wrong}", "Divide it: say it in several Commands.")
TURN_TOO_LONG = LONG_TURN.says("{wrong}", "Divide it, or shorten its pauses and timeout.")
BEHIND_ELSE = AFTER_ELSE.says("<{tag}> comes after <else>.", "<else> comes last.")
