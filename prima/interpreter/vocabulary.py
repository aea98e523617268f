"""The dialogue language: its elements as one table.

Words that VoiceXML has mean what they mean there; Commands are the rows of the
thesis's Table 4.2, ``iu`` is its Information Unit, ``seq`` and ``par`` are
SMIL's.
"""

from __future__ import annotations

from prima.grammar.answers import TYPES
from prima.language.commands import TABLE_4_2, CommandType
from prima.markup.vocabulary import Attribute, Element, Instead, Vocabulary, attribute

NAMESPACE = "urn:prima:dialogue:1"

USUAL_CONFIDENCE = 0.5
"""How sure a recogniser has to be where no document says so (VoiceXML 2.0, 6.3.2)."""
_ASKING = TABLE_4_2["q-and-a"].arguments
PROPERTIES = {
    item.name: item
    for item in (
        attribute("timeout", "duration", _ASKING["timeout"].doc),
        attribute("bargein", "boolean", _ASKING["bargein"].doc),
        attribute(
            "confidencelevel",
            "number",
            "how sure the recogniser has to be of an answer; below it, it is nomatch",
            default=f"{USUAL_CONFIDENCE}",
            low=0,
            high=1,
        ),
    )
}
"""Settings of questions, by name."""

SPEAKING = tuple(row.name for row in TABLE_4_2.values() if row.name != "q-and-a")
ACTING = (*SPEAKING, "command", "par", "seq", "iu")
CONTENT = (
    *("var", "assign", "clear", "if", "foreach", "script", "log", "throw", "goto", "return"),
    *("exit", "reprompt", "send", *ACTING),
)
HANDLERS = ("on", "noinput", "nomatch", "help", "error")

_EXPR = attribute("expr", "expression", "the value")
_COND = attribute(
    "cond", "expression", "a condition; it counts only while this is true", default="true"
)
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
_LONGEST = attribute(
    "longest",
    "duration",
    "its longest duration; then error.unit.timeout is thrown and it ends",
    default="60s",
    low=1,
)
_ORDER = attribute(
    "order",
    "text",
    "after what the application asked for last, or now, cancelling what wants the same devices",
    default="after",
    choices=("after", "now"),
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
_RESTARTABLE = attribute(
    "restartable",
    "boolean",
    "whether it gives way to a reaction at once and starts again from its beginning afterwards"
    " (extension x2)",
    default="false",
)


def _command(row: CommandType) -> Element:
    arguments = tuple(
        Attribute(
            name,
            argument.kind,
            argument.doc,
            argument.required,
            "" if argument.default is None else _shown(argument.kind, argument.default),
            dynamic=True,
            low=argument.low,
            high=argument.high,
        )
        for name, argument in row.arguments.items()
    )
    order = () if row.now else (_ORDER,)
    restart = () if row.feedback or row.now else (_RESTARTABLE,)
    says = row.text != "none"
    marks = [
        "devices " + ", ".join(sorted(row.devices)) if row.devices else "no devices",
        *(["one Atomic Behavior for each loop"] if row.feedback else []),
        *(["leaves the user"] if row.leaves else []),
        *(["engages the user"] if row.engages else []),
    ]
    return Element(
        row.name,
        f"{row.title}. {row.doc} [{'; '.join(marks)}]",
        (*arguments, *order, *restart),
        ("param", "on", *(("value", "break") if says else ())),
        says,
        source="" if row.name == "pause" else "thesis Table 4.2",
    )


def _shown(kind: str, value: object) -> str:
    if kind == "duration" and isinstance(value, int):
        return f"{value / 1000:g}s"
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


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
            attribute("name", "text", "what it tells", "required"),
            attribute("content", "text", "the fact", "required"),
        ),
    ),
    Element(
        "var",
        "Declares a variable of the document, the form or the content that it is in.",
        (attribute("name", "variable", "its name", "required"), _EXPR),
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
        (_NAME, _START, _COND, *_STREAM),
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
            _COND,
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
            _COND,
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
    Element(
        "grammar",
        "Answers as an SRGS grammar: rules, one expansion written at once, or a file.",
        (
            attribute("root", "id", "the rule to begin with; by default the first"),
            attribute("src", "text", "a file with an SRGS grammar, and # and a rule of it"),
        ),
        ("rule", "one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 1.0",
    ),
    Element(
        "rule",
        "A named part of a grammar.",
        (attribute("id", "id", "its name", "required"),),
        ("one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 3.1",
    ),
    Element("one-of", "Alternatives.", (), ("item",), source="SRGS 2.4"),
    Element(
        "item",
        "A part of an expansion, or an alternative.",
        (attribute("repeat", "text", "how often: 2, 0-1, 1-"),),
        ("one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 2.5",
    ),
    Element(
        "ruleref",
        "Another rule of the same grammar.",
        (attribute("uri", "target", "# and the rule's id", "required"),),
        source="SRGS 2.2",
    ),
    Element(
        "tag",
        "The value that matching this gives, as a literal.",
        text=True,
        source="SISR 1.0 literals",
    ),
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
            _COND,
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
            _EXPR,
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
        (_NAME, _COND, _LONGEST),
        ("block", "field", *HANDLERS),
        name="iu",
        source="thesis 4.1 (2); rule U5",
    ),
    Element(
        "iu",
        "An Information Unit around Commands: they are one Atomic Behavior that nothing breaks.",
        (_LONGEST, _RESTARTABLE),
        (*SPEAKING, "command", "par", "seq"),
        source="thesis 4.1 (2); rule U4",
    ),
    Element(
        "par",
        "Branches that run in parallel; what follows waits for all of them.",
        (),
        (*SPEAKING, "command", "seq", "iu"),
        source="SMIL; thesis Figure 4.1",
    ),
    Element(
        "seq",
        "Commands one after another, inside a par or a unit.",
        (),
        (*SPEAKING, "command", "par", "iu"),
        source="SMIL; rule U3",
    ),
    Element(
        "command",
        "A Command that the robot's profile adds. A param with the name of one of its motion"
        " arguments gives that argument; others are additional arguments.",
        (
            attribute("type", "id", "the Command's name in the profile", "required"),
            _ORDER,
            _RESTARTABLE,
        ),
        ("param", "on", "value"),
        text=True,
        source="thesis 5.3 (6)",
    ),
    *(_command(row) for row in TABLE_4_2.values() if row.name != "q-and-a"),
    Element(
        "on",
        "A handler of events: touch, human.found, human.lost, message, a corner, a service's"
        " reply, a watch, end and cancel of Commands, errors. Found as VoiceXML finds a catch:"
        " innermost scope, name by prefix, count, document order.",
        (
            attribute("event", "events", "which; touch also takes touch.head", "required"),
            _COND,
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
            (_COND, _COUNT),
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
    Element(
        "assign",
        "Gives a declared variable a value.",
        (
            attribute("name", "variable", "the variable", "required"),
            attribute("expr", "expression", "the value", "required"),
        ),
        source="VoiceXML 5.3.2",
    ),
    Element(
        "clear",
        "Makes form items undefined again, with their counters; without names, all of the form.",
        (attribute("namelist", "variables", "which"),),
        source="VoiceXML 5.3.3",
    ),
    Element(
        "if",
        "Content under a condition; elseif and else divide it.",
        (attribute("cond", "expression", "the condition", "required"),),
        (*CONTENT, "elseif", "else"),
        source="VoiceXML 5.3.4",
    ),
    Element(
        "elseif",
        "Divides an if.",
        (attribute("cond", "expression", "the condition", "required"),),
    ),
    Element("else", "Divides an if."),
    Element(
        "foreach",
        "Runs its content once for every element of an array.",
        (
            attribute("item", "variable", "the variable of the element", "required"),
            attribute("array", "expression", "the array", "required"),
        ),
        CONTENT,
        source="VoiceXML 2.1, 8",
    ),
    Element(
        "log",
        "Writes a line into the transcript.",
        (attribute("label", "text", "a word before it"), _EXPR),
        ("value",),
        text=True,
        source="VoiceXML 5.3.13",
    ),
    Element(
        "throw",
        "Throws an event in this application.",
        (
            attribute("event", "event", "its name", "required", "dynamic"),
            attribute("message", "text", "more about it", "dynamic"),
        ),
        source="VoiceXML 5.2.1",
    ),
    Element(
        "goto",
        "Leaves the state for another form, or goes on with another item of this one.",
        (
            attribute("next", "target", "the form", "dynamic"),
            attribute("nextitem", "variable", "the form item", "dynamic"),
        ),
        source="VoiceXML 5.3.7; rule O3",
    ),
    Element("exit", "Ends the application.", source="VoiceXML 5.3.9"),
    Element(
        "reprompt",
        "Asks that the field say its prompt again when it is visited next.",
        source="VoiceXML 5.3.6",
    ),
    Element(
        "send",
        "Sends a message to a named service, whose answer comes as the event reply.NAME or"
        " error.service.NAME; or an event to this application itself, after a delay, unless the state"
        " is left before.",
        (
            attribute("to", "id", "the service", "dynamic"),
            attribute("event", "event", "an event for this application itself"),
            attribute("delay", "duration", "when, from now", "dynamic"),
        ),
        ("param",),
        source="thesis Figure 5.2; SCXML send",
    ),
    Element(
        "value",
        "The value of an expression, as text.",
        (attribute("expr", "expression", "the expression", "required"),),
        source="VoiceXML 4.1.4",
    ),
    Element(
        "break",
        "A pause in what is said: the robot goes on with the same utterance after it.",
        (attribute("time", "duration", "how long", "required", low=1, high=60000),),
        source="SSML 2.2.3",
    ),
)

HINTS: dict[str, str | Instead] = {
    "catch": Instead("on", 'event="..."'),
    "vxml": "Begin with <prima>.",
    "say": Instead("speak"),
    "ask": "Write <field> with a <prompt>.",
    "q-and-a": "Q&A is written as a <field> with a <prompt>.",
    "audio": Instead("speak"),
    "choice": "Write <option> in a <field>.",
    "menu": "Write a <form> with a <field>.",
    **dict.fromkeys(
        (
            "a",
            "b",
            "br",
            "center",
            "div",
            "font",
            "h1",
            "h2",
            "h3",
            "li",
            "span",
            "strong",
            "u",
            "ul",
        ),
        "Speech is plain text: leave the mark out.",
    ),
    **dict.fromkeys(
        ("b", "emphasis", "em", "i", "p", "phoneme", "prosody", "s", "say-as", "sub"),
        "Speech is plain text: leave the mark out.",
    ),
    "else-if": Instead("elseif"),
    "img": 'Point to a thing: <point-by-hand toward="..."/>.',
    "input": "Write a <field> with a <prompt>.",
    "select": "Write a <field> with an <option> for each answer.",
    "button": 'Write <option> in a <field>, or <on event="touch">.',
    "title": 'Write <meta name="title" content="..."/>.',
    "head": "Leave it out: facts about the document belong in <meta>.",
    "body": "Leave it out: forms belong in <prima>.",
    "html": "Begin with <prima>.",
    **dict.fromkeys(
        ("delay", "silence", "sleep", "wait"),
        'Write <pause time="1s"/>; or, for an event afterwards, <send event="..." delay="1s"/>.',
    ),
    "submit": Instead("send", 'to="..."'),
    "disconnect": Instead("exit", "/"),
    "transfer": Instead("send", 'to="..."'),
    "record": 'Write a <field type="text">.',
    "initial": "Write a <field>, or a <block>.",
    "object": Instead("command", 'type="..."'),
    "stop": Instead("stop-moving"),
    "move": Instead("topological-move"),
}

DIALOGUE = Vocabulary(NAMESPACE, "dialogue", "prima", ELEMENTS, HINTS)
