"""Elements of executable content other than Commands."""

from __future__ import annotations

from prima.interpreter.vocabulary.names import CONTENT, EXPR
from prima.markup.vocabulary import Element, attribute

ACTS = (
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
        "elseif", "Divides an if.", (attribute("cond", "expression", "the condition", "required"),)
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
        (attribute("label", "text", "a word before it"), EXPR),
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
        "The value of an expression, as text; that of a variable without a value is null.",
        (attribute("expr", "expression", "the expression", "required"),),
        source="VoiceXML 4.1.4",
    ),
    Element(
        "break",
        "A pause in what is said: the robot goes on with the same utterance after it.",
        (attribute("time", "duration", "how long", "required", low=1, high=60000),),
        source="SSML 3.2.3",
    ),
)
