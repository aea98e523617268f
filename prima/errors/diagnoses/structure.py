"""Elements and attributes that are unknown or misplaced."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

WRONG_ROOT = Diagnosis(
    "wrong-root",
    "Wrong root element",
    "The namespace is right, but the root element is not.",
)

WRONG_NAMESPACE = Diagnosis(
    "wrong-namespace",
    "Wrong namespace",
    (
        "The namespace says what kind of document it is. An application begins with <prima "
        'xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="...">.'
    ),
    rule="XML Namespaces 1.0",
)

NO_NAMESPACE = Diagnosis(
    "no-namespace",
    "VoiceXML without a namespace",
    (
        "A VoiceXML document without a namespace is read as VoiceXML. Other platforms may not "
        "take it for VoiceXML."
    ),
    rule="VoiceXML 2.0, 1.5.1",
    severity="warning",
)

UNKNOWN_ELEMENT = Diagnosis(
    "unknown-element",
    "Unknown element",
    "The language has no such element. Nothing in a document is silently ignored.",
)

MISPLACED_ELEMENT = Diagnosis(
    "misplaced-element",
    "Element in the wrong place",
    "The element exists, but not here; the message says where it may be.",
)

STRAY_TEXT = Diagnosis(
    "stray-text",
    "Text in the wrong place",
    (
        "The language has no place for text here. What the robot is to say goes into <speak> "
        "or another Command that speaks."
    ),
)

UNKNOWN_ATTRIBUTE = Diagnosis(
    "unknown-attribute",
    "Unknown attribute",
    "The element has no such attribute. Nothing is silently ignored.",
)

MISSING_ATTRIBUTE = Diagnosis(
    "missing-attribute", "Missing attribute", "The element needs an attribute, or one of several."
)

MISSING_ELEMENT = Diagnosis(
    "missing-element", "Missing element", "The element needs a child element."
)

DUPLICATE_ID = Diagnosis(
    "duplicate-id",
    "Id used twice",
    "Two things have the same id, so that a reference to it is ambiguous.",
)

DUPLICATE_NAME = Diagnosis(
    "duplicate-name",
    "Name used twice",
    (
        "Two items of a form have the same name: they would share their variable. Or two "
        "services of a scenario: a request by that name is ambiguous. Or two devices, touch "
        "sensors, gestures, voices or arguments of a robot: only one would count. Or the item of "
        "a foreach has the name of its array and hides it from then on, which is a warning."
    ),
    rule="VoiceXML 2.0, 2.3",
)

DUPLICATE_ELEMENT = Diagnosis(
    "duplicate-element",
    "Element written twice",
    (
        "The element may be there only once. Of a world's ways between the same places, and of "
        "places at the same point with the same heading, that is a warning."
    ),
)

DUPLICATE_ANSWER = Diagnosis(
    "duplicate-answer",
    "Answer written twice",
    "Two options of a field are the same, apart from case and punctuation.",
    rule="VoiceXML 2.0, 2.3.1.3",
)

EMPTY = Diagnosis("empty", "Empty element", "The element holds nothing.")

AFTER_ELSE = Diagnosis(
    "after-else",
    "Element after <else>",
    "Only content may follow <else>, which takes all remaining cases.",
    rule="VoiceXML 2.0, 5.3.4",
)

NO_FORM = Diagnosis(
    "no-form",
    "Application without a form",
    "An application is made of forms, its states; it begins with the first.",
)

OTHER_KIND = Diagnosis(
    "other-kind",
    "FA and EA mixed up",
    (
        "A document says that it is an FA, but the scenario, the command line or the world "
        "says that it is an EA, or the other way round. These decide: no document makes "
        "itself the robot's own."
    ),
    severity="warning",
)
