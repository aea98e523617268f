"""The language of robot profiles, as a table."""

from __future__ import annotations

from prima.language.commands import DEVICES
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute

VERSION = attribute("version", "text", "the language's version", "required", choices=("1.0",))
ID = attribute("id", "id", "its name", "required")
TITLE = attribute("title", "text", "what people call it")
ROBOT = Vocabulary(
    "urn:prima:robot:1",
    "robot",
    "robot",
    (
        Element(
            "robot",
            "A robot's body, devices and Commands.",
            (
                VERSION,
                ID,
                TITLE,
                attribute("radius", "number", "the body's", default="0.2", low=0.05, high=2),
                attribute(
                    "speed", "number", "metres a second at most", default="0.5", low=0.01, high=3
                ),
                attribute(
                    "turn-speed",
                    "number",
                    "degrees a second at most",
                    default="90",
                    low=1,
                    high=720,
                ),
                attribute(
                    "head-speed", "number", "degrees a second", default="120", low=1, high=720
                ),
                attribute(
                    "loop", "duration", "a loop of a feedback Command", default="500ms", low=10
                ),
                attribute(
                    "absence",
                    "duration",
                    "after how long without being seen, heard or felt the user is absent (K1)",
                    default="20s",
                ),
            ),
            ("device", "camera", "voice", "touch", "gesture", "adds", "allows", "substitute"),
        ),
        Element(
            "device",
            "A device that the robot has; Commands whose devices it lacks it cannot do.",
            (attribute("name", "id", "as in Table 4.2, or its own", "required"),),
        ),
        Element(
            "camera",
            "What it sees humans with.",
            (
                attribute(
                    "angle", "number", "field of view in degrees", default="60", low=1, high=360
                ),
                attribute("range", "number", "metres", default="4", low=0.1, high=100),
            ),
        ),
        Element(
            "voice",
            "How fast it talks in a language.",
            (
                attribute("lang", "language", "the language", "required"),
                attribute("rate", "number", "letters a second", "required", low=0.5, high=100),
            ),
        ),
        Element("touch", "A touch sensor.", (attribute("sensor", "id", "its name", "required"),)),
        Element(
            "gesture",
            "A gesture that it knows.",
            (
                attribute("name", "id", "its name", "required"),
                attribute("duration", "duration", "how long it takes", default="1s"),
            ),
        ),
        Element(
            "adds",
            "A Command that the hardware developer adds.",
            (
                attribute("command", "id", "its name", "required"),
                TITLE,
                attribute(
                    "devices", "text", "the devices it occupies, separated by spaces", "required"
                ),
                attribute(
                    "duration", "duration", "how long it takes, or a loop of it", default="1s"
                ),
                attribute("feedback", "boolean", "whether it works in loops", default="false"),
                attribute("leaves", "boolean", "whether it leaves the user", default="false"),
                attribute("engages", "boolean", "whether it engages the user", default="false"),
                attribute("says", "boolean", "whether it takes a text", default="false"),
                attribute(
                    "stray",
                    "number",
                    "how far (m) its steps may take the robot off the way of a move that goes on"
                    " meanwhile (extension x5)",
                    default="0.3",
                    low=0,
                    high=5,
                ),
            ),
            ("argument", "step"),
        ),
        Element(
            "step",
            "A part of an added motion such as a dance: how the body moves for a while.",
            (
                attribute("for", "duration", "how long", "required", low=1),
                attribute(
                    "speed",
                    "number",
                    "metres a second, backward negative",
                    default="0",
                    low=-2,
                    high=2,
                ),
                attribute(
                    "turn-speed",
                    "number",
                    "degrees a second to the left",
                    default="0",
                    low=-180,
                    high=180,
                ),
            ),
        ),
        Element(
            "substitute",
            "Another Command that takes the place of one that the robot lacks (extension x6).",
            (
                attribute("command", "id", "the Command of Table 4.2 that it lacks", "required"),
                attribute("by", "id", "the Command that takes its place", "required"),
            ),
        ),
        Element(
            "argument",
            "A motion argument of an added Command.",
            (
                attribute("name", "id", "its name", "required"),
                attribute(
                    "kind",
                    "text",
                    "its type",
                    default="text",
                    choices=("text", "number", "duration", "boolean", "id"),
                ),
                attribute("low", "number", "the least"),
                attribute("high", "number", "the most"),
                attribute("required", "boolean", "whether it is needed", default="false"),
            ),
        ),
        Element(
            "allows",
            "An additional argument of a Command, for an FA alone.",
            (
                attribute("command", "id", "the Command", "required"),
                attribute("argument", "id", "the argument's name", "required"),
            ),
        ),
    ),
    hints={
        **dict.fromkeys(("sensor", "touch-sensor"), Instead("touch", 'sensor="..."/')),
        **{name: f'Write <device name="{name}"/>.' for name in DEVICES},
        **dict.fromkeys(("command", "add"), Instead("adds", 'command="..."')),
        "language": Instead("voice", 'lang="..."/'),
    },
)
