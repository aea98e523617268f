"""Grammars and answers."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

NO_ANSWER = Diagnosis(
    "no-answer",
    "Field that takes no answer",
    (
        "A field without options, grammar or type takes no answer: the user could never leave "
        "it. In VoiceXML grammars of its form, links and document-wide grammars count as "
        "well; if none is active, asking it throws error.semantic at run time."
    ),
    rule="VoiceXML 2.0, 2.3.1",
)

EMPTY_ANSWER = Diagnosis(
    "empty-answer",
    "Answer without words",
    "An option or a grammar without words can never match.",
    rule="SRGS 1.0, 2.1",
)

NO_SUCH_RULE = Diagnosis(
    "no-such-rule",
    "Unknown rule",
    (
        "A grammar names a rule that it does not have; or a tag names one to which its own "
        "rule does not refer."
    ),
    rule="SRGS 1.0, 2.2",
)

BAD_TOKEN = Diagnosis(
    "bad-token",
    "Bad token",
    (
        "A word of a grammar cannot be said or typed: a quote that is not closed, a key that "
        "no telephone has, or in the ABNF form a question mark, which SRGS reserves (2.5). In "
        "PRIMA's own language signs of the ABNF form between words, such as | and [, are a warning: "
        "they have no meaning there."
    ),
    rule="SRGS 1.0, 2.1",
)

FORMAT = Diagnosis(
    "format",
    "Unknown grammar format",
    (
        "The grammar's format is not read: JSGF, GSL or another. SRGS is read, as XML or "
        "ABNF. Or its media type names the other of these two forms, or neither."
    ),
    rule="SRGS 1.0, Appendix G",
)

LANGUAGE = Diagnosis(
    "language",
    "Language not accepted",
    "The grammar is in a language that its reader does not accept.",
    rule="SRGS 1.0, 4.5",
)

MODE = Diagnosis(
    "mode",
    "Voice and DTMF mixed",
    "A grammar is for voice or for dtmf, and grammars that it refers to have the same mode.",
    rule="SRGS 1.0, 4.6",
)

NO_ROOT = Diagnosis(
    "no-root",
    "No root rule",
    "The grammar does not say which of its rules is the root: write root on <grammar>.",
    rule="SRGS 1.0, 4.7",
)

NOT_ABNF = Diagnosis(
    "not-abnf",
    "Not ABNF",
    (
        "The text is not a grammar in the ABNF form of SRGS; the place is where reading "
        "stopped. The first line holds the header, #ABNF 1.0 UTF-8;, and nothing else."
    ),
    rule="SRGS 1.0, 4",
)

NOT_FETCHED = Diagnosis(
    "not-fetched",
    "Grammar not fetched",
    "A grammar refers to another file, and its reader fetches none.",
    rule="SRGS 1.0, 2.2.2",
)

PRIVATE_RULE = Diagnosis(
    "private-rule",
    "Private rule",
    "A grammar refers to a private rule of another grammar. Make it public there.",
    rule="SRGS 1.0, 3.2",
)

TAG_FORMAT = Diagnosis(
    "tag-format",
    "Unknown tag format",
    "tag-format is neither semantics/1.0 nor semantics/1.0-literals.",
    rule="SRGS 1.0, 4.8",
)
