"""Triggers, users' actions and other events of a scenario, as a table."""

from __future__ import annotations

from dataclasses import replace

from prima.markup.vocabulary import Element, attribute

AFTER = attribute("after", "delay", "how long afterwards", default="0s")
DOINGS = ("say", "hang-up", "touch", "walk", "wait", "look", "follow", "stay", "leave", "note")
"""Users' actions, without those of the surroundings."""
_ACTIONS = (
    *DOINGS,
    *("message", "event", "sensor", "fail", "repair", "emergency", "release", "unload", "load"),
)
_CONFIDENCE = attribute(
    "confidence", "number", "the recogniser's confidence in the words", default="1", low=0, high=1
)
_CALLED = attribute("id", "id", "its name, for experiments that vary it (prima sweep)")
CHANCE = attribute(
    "chance",
    "number",
    "its probability each time, from 0 to 1; drawn by the scenario's seed",
    default="1",
    low=0,
    high=1,
)
_PERSON = attribute(
    "person", "id", "the person who does it, if there are several; by default the first"
)
SPEED = attribute("speed", "quantity", "metres a second", default="1", low=0.05, high=5)
TRIGGERS = (
    attribute("at", "delay", "a time of the run"),
    attribute("said", "text", "the robot has said something with these words"),
    attribute("asked", "text", "the robot has asked something with these words and listens"),
    attribute("doing", "id", "the robot begins such a Command"),
    attribute("done", "id", "the robot ends such a Command"),
    attribute("on", "event", "such an event happens"),
)

HAPPENINGS = (
    Element(
        "answer",
        "What the user answers whenever the robot asks something with these words.",
        (
            _CALLED,
            _PERSON,
            attribute("to", "text", "words of the question", "required"),
            attribute("after", "delay", "how long after it", default="1s"),
            attribute("times", "integer", "how often at most", default="1000", low=1, high=1000),
            CHANCE,
            _CONFIDENCE,
        ),
        ("alternative",),
        text=True,
    ),
    Element(
        "when",
        "What happens at a time, or when the robot has done something: in sequence.",
        (
            _CALLED,
            _PERSON,
            *TRIGGERS,
            AFTER,
            attribute("times", "integer", "how often at most", default="1", low=1, high=1000),
            attribute(
                "count",
                "integer",
                "the first time at which it happens; `times` counts from then on",
                default="1",
                low=1,
            ),
            CHANCE,
        ),
        ("one-of", *_ACTIONS),
    ),
    Element(
        "one-of",
        "One of these happens, with equal probability; drawn by the scenario's seed.",
        (),
        _ACTIONS,
    ),
    Element("say", "The user says something.", (_CONFIDENCE,), ("alternative",), text=True),
    Element(
        "alternative",
        "An alternative result of the recogniser, with a lower confidence.",
        (replace(_CONFIDENCE, required=True, default=""),),
        text=True,
    ),
    Element(
        "hang-up",
        "The user hangs up, in the middle of what they say if they speak: the event"
        " connection.disconnect.hangup.",
    ),
    Element(
        "touch", "The user touches a sensor.", (attribute("sensor", "id", "which", "required"),)
    ),
    Element(
        "walk",
        "The user walks somewhere in a straight line.",
        (
            attribute("to", "id", "a place or thing"),
            attribute("x", "number", "metres east", low=-1000, high=1000),
            attribute("y", "number", "metres north", low=-1000, high=1000),
        ),
    ),
    Element("wait", "Nothing, for a while.", (attribute("for", "delay", "how long", "required"),)),
    Element(
        "look",
        "The user looks at something.",
        (attribute("at", "id", "a place or thing, or robot", "required"),),
    ),
    Element(
        "follow",
        "The user follows the robot from now on.",
        (attribute("distance", "number", "metres", default="1.2", low=0.3, high=10),),
    ),
    Element("stay", "The user stays where they are."),
    Element("leave", "The user goes away and is seen no more."),
    Element("note", "A remark for the reader.", text=True),
    Element(
        "message",
        "A message arrives from the network: the event message, with its sender and text.",
        (
            attribute("from", "text", "who sends it", default=""),
            attribute("to", "id", "the only application that gets it; by default all do"),
        ),
        text=True,
    ),
    Element(
        "event",
        "An event of the surroundings.",
        (attribute("name", "event", "its name", "required"),),
        ("data",),
    ),
    Element(
        "data",
        "A value passed with it.",
        (
            attribute("name", "text", "its name", "required"),
            attribute("value", "text", "its value", "required"),
        ),
    ),
    Element(
        "sensor",
        "A sensor's value changes.",
        (
            attribute("name", "event", "its dotted name", "required"),
            attribute("value", "text", "its value: a number, true, false or a text", "required"),
        ),
    ),
    Element(
        "fail",
        "A device fails from now on, or hangs.",
        (
            attribute("device", "id", "which", "required"),
            attribute("hangs", "boolean", "whether it hangs instead of failing", default="false"),
        ),
    ),
    Element("repair", "The device works again.", (attribute("device", "id", "which", "required"),)),
    Element("emergency", "The emergency stop is pressed."),
    Element(
        "release",
        "The emergency stop is released.",
        (attribute("resume", "boolean", "whether streams resume", default="true"),),
    ),
    Element(
        "unload",
        "An application is unloaded.",
        (attribute("application", "id", "its id", "required"),),
    ),
    Element(
        "load",
        "An application that has ended or was unloaded is loaded again: it starts anew.",
        (attribute("application", "id", "its id", "required"),),
    ),
)
