"""The language of scenarios."""

from __future__ import annotations

from dataclasses import replace

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute
from prima.script.sandbox import START
from prima.sim.vocabulary.happenings import HAPPENINGS, SPEED, TRIGGERS
from prima.sim.vocabulary.served import SERVED
from prima.sim.vocabulary.world import HEADING

_EXPECTED = (
    attribute("says", "text", "the robot begins to say something with these words"),
    attribute("does", "id", "the robot begins a Command of this type; may be combined with says"),
    attribute("finishes", "id", "the robot ends a Command of this type"),
    attribute("event", "event", "such an event happens"),
    attribute("logs", "text", "an application logs something with these words"),
    attribute("sends", "text", "an application sends something to this service or URI"),
    attribute("state", "id", "an application is in this form"),
    attribute("ends", "id", "this application ends"),
    attribute("reason", "text", "why it ends: exit, unloaded or an error's name"),
    attribute("by", "id", "the application that does it; by default any"),
    attribute("after", "text", "it comes after the expectation with this id"),
    attribute("before", "text", "it comes before the expectation with this id"),
    attribute("at", "text", "it comes from this time of the run on; for a state also end"),
    *(replace(one, doc=f"it comes after {one.doc}") for one in TRIGGERS[1:]),
    attribute("count", "integer", "which of these occurrences counts", default="1", low=1),
    attribute("within", "duration", "how long afterwards at most"),
)

SCENARIO = Vocabulary(
    "urn:prima:scenario:1",
    "scenario",
    "scenario",
    (
        Element(
            "scenario",
            "A run: who is where, what the user does and when, and how services answer.",
            (
                VERSION,
                ID,
                TITLE,
                attribute("world", "path", "the world's document", "required"),
                attribute("robot", "path", "the robot's profile", "required"),
                attribute(
                    "until", "duration", "when the run ends, if not by itself", default="600s"
                ),
                attribute(
                    "date",
                    "date",
                    "when the run begins, for Date in documents; in UTC, like all times",
                    default=START,
                ),
                attribute("policy", "text", "the mediator's policy", default="prima"),
                attribute(
                    "patience",
                    "duration",
                    "how long an application may keep others from the speaker (E6); 0s for no limit",
                    default="60s",
                ),
                attribute(
                    "entrances",
                    "text",
                    "whether the robot takes up the applications that the world's areas offer",
                    default="closed",
                    choices=("open", "closed"),
                ),
                attribute(
                    "seed",
                    "integer",
                    "which of all possible runs it is: its random values depend on this alone",
                    default="1",
                    low=0,
                ),
            ),
            (
                *("robot", "person", "application", "answer", "when", "service", "connection"),
                *("transfer", "expect", "never", "in-order"),
            ),
        ),
        Element(
            "robot",
            "Where the robot starts.",
            (
                attribute("at", "id", "a place", "required"),
                replace(HEADING, doc=f"{HEADING.doc}; by default the place's heading", default=""),
            ),
        ),
        Element(
            "person",
            "The user, and where they start; of several the robot attends to one at a time.",
            (
                attribute("id", "id", "their name; needed where there are several", default="user"),
                attribute("at", "id", "a place or thing"),
                attribute("x", "number", "metres east", low=-1000, high=1000),
                attribute("y", "number", "metres north", low=-1000, high=1000),
                SPEED,
                attribute("user", "path", "the document that says how they behave; see <user>"),
            ),
        ),
        Element(
            "application",
            "An application that the robot runs, in the order in which they are declared.",
            (
                attribute("src", "path", "its document", "required"),
                attribute("start", "delay", "when it is loaded", default="0s"),
                attribute(
                    "id", "id", "its name, for a VoiceXML document; by default that of its file"
                ),
                attribute(
                    "kind",
                    "text",
                    "whether it is the robot's own or a place's; overrides the document",
                    default="ea",
                    choices=("fa", "ea"),
                ),
                attribute("uri", "text", "where a VoiceXML document is served in real use"),
                attribute(
                    "folder", "path", "the folder that is served there: its own, or one above it"
                ),
            ),
        ),
        *HAPPENINGS,
        *SERVED,
        Element(
            "expect",
            "What has to happen in the run. prima test checks it; a run itself ignores it.",
            (
                attribute("id", "id", "its name, for after and before of others"),
                *_EXPECTED,
                attribute("times", "integer", "how often exactly; by default at least once", low=1),
            ),
            ("data",),
        ),
        Element("never", "What must not happen in the run.", _EXPECTED, ("data",)),
        Element(
            "in-order", "Expectations that have to be met one after the other.", (), ("expect",)
        ),
    ),
    hints={
        **dict.fromkeys(("user", "human", "visitor"), Instead("person")),
        **dict.fromkeys(("app", "fa", "ea", "prima", "vxml"), Instead("application", 'src="..."/')),
        **dict.fromkeys(("speak", "prompt", "says"), "Write <say>: what the user says."),
        **dict.fromkeys(("tap", "press", "stroke"), Instead("touch", 'sensor="..."/')),
        **dict.fromkeys(("go", "goto", "move", "topological-move"), Instead("walk", 'to="..."/')),
        **dict.fromkeys(("sleep", "pause", "delay", "after"), 'Write <wait for="3s"/>.'),
        **dict.fromkeys(("on", "at", "if", "then", "catch"), "Write <when>, with its trigger."),
        **dict.fromkeys(("choice", "choose", "random", "any"), Instead("one-of")),
        **dict.fromkeys(("assert", "expected", "must"), Instead("expect")),
        "param": Instead("data", 'name="..." value="..."/'),
        **dict.fromkeys(("forbid", "must-not", "not"), Instead("never")),
        "world": 'Name it in the root element: <scenario world="..." robot="...">.',
        "question": 'Write what the user answers: <answer to="words of the question">Yes.</answer>.',
        "comment": "Write <note>, or a comment of XML: <!-- ... -->.",
    },
)

NAMING_APPLICATIONS = (
    *(("unload", "application"), ("load", "application")),
    *(("service", "application"), ("message", "to")),
    *((tag, name) for tag in ("expect", "never") for name in ("by", "ends")),
)
"""Elements of scenarios, and their attributes, that name an application."""
