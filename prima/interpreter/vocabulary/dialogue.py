"""The dialogue language."""

from __future__ import annotations

from prima.grammar.answers import TYPES
from prima.interpreter.vocabulary.commands import COMMANDS, LONGEST
from prima.interpreter.vocabulary.content import ACTS
from prima.interpreter.vocabulary.hints import HINTS
from prima.interpreter.vocabulary.names import COND, CONTENT, EXPR, HANDLERS
from prima.interpreter.vocabulary.questions import GRAMMARS, PROPERTIES
from prima.markup.vocabulary import Element, Vocabulary, attribute

NAMESPACE = "urn:prima:dialogue:1"

_NAME = attribute("name", "variable", "the name of its variable; it is visited while undefined")
_START = attribute(
    "expr", "expression", "the variable's first value; if given, it is not visited until cleared"
)
_COUNT = attribute(
    "count", "integer", "used from this occurrence on", default="1", low=1, high=1000
)
_REACTIVE = attribute(
    "reactive",
    "boolean",
    "whether what it asks for first is a reaction; by default it is for events of the user and"
    " the surroundings",
)
_STREAM = (
    attribute(
        "stream",
        "text",
        "hold: its stream stays open, and the floor with it, while the application waits for an"
        " event afterwards (extension x3)",
        choices=("hold",),
    ),
    attribute("hold-for", "duration", "how long at most", default="15s", low=1, high=600000),
)
_CHANNEL = attribute(
    "channel",
    "text",
    "connect: the robot turns to the user before its first word, if it does not see them"
    " (extension x4)",
    choices=("connect",),
)
_WORDS = attribute(
    "resume-text",
    "text",
    "what the robot says first when the form's stream resumes after another application has"
    " spoken (extension x9)",
)
ELEMENTS = (
    Element(
        "prima",
        "An application of a robot: its personality (fa) or a place's service (ea).",
        (
            attribute("version", "text", "the language's version", "required", choices=("1.0",)),
            attribute(
                "kind",
                "text",
                "familiarity-oriented or environment-oriented",
                "required",
                choices=("fa", "ea"),
            ),
            attribute("id", "id", "the application's name in transcripts", "required"),
        ),
        ("meta", "var", "script", "property", "form", *HANDLERS, "link", "watch"),
        source="VoiceXML vxml; thesis 2.2",
    ),
    Element(
        "meta",
        "A fact about the document, for people and tools.",
        (
            attribute("name", "text", "its meaning", "required"),
            attribute("content", "text", "the fact", "required"),
        ),
    ),
    Element(
        "var",
        "Declares a variable of the document, the form or the content that it is in.",
        (attribute("name", "variable", "its name", "required"), EXPR),
        source="VoiceXML 5.3.1",
    ),
    Element(
        "script",
        "ECMAScript that runs when its scope is entered; its functions and variables stay there.",
        text=True,
        source="VoiceXML 5.3.12",
    ),
    Element(
        "property",
        f"A setting for the same element: {', '.join(PROPERTIES)}.",
        (
            attribute("name", "text", "which", "required", choices=tuple(PROPERTIES)),
            attribute("value", "text", "its value", "required"),
        ),
        source="VoiceXML 6.3",
    ),
    Element(
        "form",
        "A state of the application. Its items are visited in document order while their"
        " variables are undefined and their conditions true; then it waits for events.",
        (attribute("id", "id", "its name, for goto", "required"), *_STREAM, _CHANNEL, _WORDS),
        (
            *("var", "script", "property", "block", "field", "subdialog", "iu-items"),
            *("filled", *HANDLERS, "link", "watch"),
        ),
        source="VoiceXML 2.1; thesis Figure 2.1",
    ),
    Element(
        "block",
        "Content that runs once, in document order. Commands that follow one another are one"
        " tree; what follows them runs when they have ended.",
        (_NAME, _START, COND, *_STREAM),
        CONTENT,
        source="VoiceXML 2.3.2; rule O4",
    ),
    Element(
        "field",
        "Asks the user something and keeps the answer: the Command Q&A, one Atomic Behavior"
        " from the question to the answer or the timeout.",
        (
            attribute("name", "variable", "the variable that the answer fills", "required"),
            _START,
            COND,
            attribute("type", "text", "a built-in grammar for the answer", choices=TYPES),
            *_STREAM,
            _CHANNEL,
        ),
        ("prompt", "option", "grammar", "property", "filled", *HANDLERS),
        source="VoiceXML 2.3.1; thesis Table 4.2, 4.4 exception 2",
    ),
    Element(
        "prompt",
        "What a field asks. Of several, those with the highest count reached are said.",
        (
            _COUNT,
            COND,
            attribute("timeout", "duration", "how long to wait for an answer", high=600000),
            attribute("bargein", "boolean", "whether the user may answer before it ends"),
        ),
        ("value", "break"),
        text=True,
        source="VoiceXML 4.1",
    ),
    Element(
        "option",
        "An answer that the field takes: what the user may say.",
        (attribute("value", "text", "the field's value then; by default the text itself"),),
        text=True,
        source="VoiceXML 2.3.1.3",
    ),
    *GRAMMARS,
    Element(
        "filled",
        "What happens when fields have been filled.",
        (
            attribute(
                "mode",
                "text",
                "when all of the namelist are filled, or any",
                default="all",
                choices=("all", "any"),
            ),
            attribute("namelist", "variables", "the fields; by default all of the form"),
        ),
        CONTENT,
        source="VoiceXML 2.4",
    ),
    Element(
        "subdialog",
        "Goes to another form in a context of its own and comes back with its result.",
        (
            attribute("name", "variable", "the variable that its result fills"),
            _START,
            COND,
            attribute("src", "target", "the form", "required"),
        ),
        ("param", "filled", *HANDLERS),
        source="VoiceXML 2.3.4",
    ),
    Element(
        "param",
        "A named value given along: to a subdialog, a service, or (an FA alone) to a Command as"
        " an additional argument.",
        (
            attribute("name", "text", "its name", "required"),
            attribute("value", "text", "its value, as text"),
            EXPR,
        ),
        source="VoiceXML 6.4; thesis Table 4.1",
    ),
    Element(
        "return",
        "Ends a subdialog, with the values of the named variables.",
        (
            attribute("namelist", "variables", "variables to give back"),
            attribute("event", "event", "an event to throw in the caller instead"),
        ),
        source="VoiceXML 5.3.10",
    ),
    Element(
        "iu-items",
        "An Information Unit around form items: one Atomic Behavior that spans questions. It owns"
        " all devices of its content from its start until it is left, by whatever way.",
        (_NAME, COND, LONGEST),
        ("block", "field", *HANDLERS),
        name="iu",
        source="thesis 4.1 (2); rule U5",
    ),
    *COMMANDS,
    Element(
        "on",
        "A handler of events: touch, human.found, human.lost, message, a corner, a service's"
        " reply, a watch, end and cancel of Commands, errors. Found as VoiceXML finds a catch:"
        " innermost scope, name by prefix, count, document order.",
        (
            attribute("event", "events", "which; touch also takes touch.head", "required"),
            COND,
            _COUNT,
            _REACTIVE,
            attribute(
                "fresh-for",
                "duration",
                "for how long the reaction is worth starting: later it is given up (extension x8)",
                low=1,
                high=600000,
            ),
        ),
        CONTENT,
        source="VoiceXML 5.2.2; thesis 4.4",
    ),
    *(
        Element(
            name,
            f"A handler of {what}: short for an on with event {name}.",
            (COND, _COUNT),
            CONTENT,
            source="VoiceXML 5.2.3",
        )
        for name, what in (
            ("noinput", "a question that nobody answered in time"),
            ("nomatch", "an answer that the question does not take"),
            ("help", "a request for help"),
            ("error", "every error"),
        )
    ),
    Element(
        "link",
        "Something the user may say at any time in its scope: it goes to a form or throws an"
        " event.",
        (
            attribute("next", "target", "the form to go to"),
            attribute("event", "event", "the event to throw"),
        ),
        ("grammar",),
        source="VoiceXML 2.5; rule V1",
    ),
    Element(
        "watch",
        "Raises an event when a condition on sensor values turns true.",
        (
            attribute("name", "event", "the event", "required"),
            attribute("when", "expression", "the condition, over sensor.NAME", "required"),
        ),
        source="thesis 2.2, 4.4; rule C6",
    ),
    *ACTS,
)

DIALOGUE = Vocabulary(NAMESPACE, "dialogue", "prima", ELEMENTS, HINTS)
