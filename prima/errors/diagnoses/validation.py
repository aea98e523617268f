"""Validation itself: ignores, and omitted problems."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

BAD_IGNORE = Diagnosis(
    "bad-ignore",
    "Incomplete ignore",
    (
        "An ignore lacks its code or its reason: a comment in a document, <!-- prima-ignore: "
        "CODE reason -->, or an [[ignore]] of prima.toml. It has no effect."
    ),
    severity="warning",
)
NO_REASON = BAD_IGNORE.says('Nothing says why "{code}" is ignored.', "Say it. {form}")
UNKNOWN_CODE = BAD_IGNORE.says('There is no code "{code}".', "{form}")
NO_CODE = BAD_IGNORE.says("Nothing says which code is ignored.", "{form}")
NO_COLON = BAD_IGNORE.says('"{word}" needs a colon.', "{form}")
NOT_READ = BAD_IGNORE.says("The settings cannot be read: {error}.", severity="error")
NOT_TOML = BAD_IGNORE.says("This is not TOML: {error}.", "Correct it.", "error")
UNKNOWN_SETTING = BAD_IGNORE.says(
    'Unknown setting "{name}".', "Write [[ignore]], with code, reason and files.", "error"
)
NO_ENTRIES = BAD_IGNORE.says(
    "ignore holds no entries.", "Write [[ignore]], with code, reason and files.", "error"
)
UNKNOWN_KEY = BAD_IGNORE.says('An [[ignore]] has no "{name}".', "It may have {keys}.")
NO_FILES = BAD_IGNORE.says(
    "files names no files.", 'Write files = "ea/*.xml", or a list of such names.'
)

UNUSED_IGNORE = Diagnosis(
    "unused-ignore",
    "Unused ignore",
    (
        "A comment or an [[ignore]] of prima.toml ignores a warning that is not there (any "
        "more), or an error: errors are never ignored. Warnings that a document gets only "
        "from a scenario are not counted, and an entry is checked only when all files that it "
        "names are."
    ),
    severity="warning",
    message='Nothing is ignored here: there is no warning or note "{code}".',
    remedy="Remove it.",
)

MORE_PROBLEMS = Diagnosis(
    "more-problems",
    "More problems than shown",
    (
        "There are too many problems: only some are shown, errors first, with the number of "
        "the others. --limit problems=NUMBER raises the limit."
    ),
)
