"""The language of robots: their body, devices and Commands."""

from __future__ import annotations

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.language.commands import DEVICES
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute

LIMITS = (
    attribute("accept", "duration", "how long the robot may take to begin", low=1),
    attribute("progress", "duration", "how long it may continue without a report", low=1),
    attribute("cancel", "duration", "how long it may take to stop", low=1),
)
"""How long a driver may take before it is given up."""
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
                    "speed",
                    "number",
                    "how fast it drives, in metres a second, where a Command or step names no speed",
                    default="0.5",
                    low=0.01,
                    high=3,
                ),
                attribute(
                    "turn-speed",
                    "number",
                    "how fast it turns, in degrees a second, where a Command or step names no speed",
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
                    "how long the user has to be neither seen, heard nor felt to count as absent (K1)",
                    default="20s",
                ),
            ),
            (
                *("device", "camera", "voice", "touch", "gesture"),
                *("adds", "allows", "substitute", "driver"),
            ),
        ),
        Element(
            "device",
            "A device that the robot has; it cannot do Commands whose devices it lacks.",
            (attribute("name", "id", "as in Table 4.2, or one of its own", "required"),),
        ),
        Element(
            "camera",
            "The camera by which it sees humans.",
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
            "An additional argument of a Command, for FAs only.",
            (
                attribute("command", "id", "the Command", "required"),
                attribute("argument", "id", "the argument's name", "required"),
            ),
        ),
        Element(
            "driver",
            "Carries out Commands on the real robot, and reports what its sensors say.",
            (
                attribute("kind", "id", "which driver, such as `sim` or `ros2`", "required"),
                attribute("address", "text", "where it reaches the robot: a URL, a host, a port"),
                attribute(
                    "devices",
                    "text",
                    "its devices, separated by spaces; by default all that no other driver names",
                ),
                attribute(
                    "open", "duration", "how long it may take to connect", default="10s", low=1
                ),
                attribute(
                    "heartbeat",
                    "duration",
                    "how often it checks that the robot is still there",
                    default="2s",
                    low=100,
                ),
                *LIMITS,
            ),
            ("does", "senses", "place", "option"),
        ),
        Element(
            "does",
            "How the driver carries out a Command or a gesture.",
            (
                attribute("command", "id", "the Command; `say` for what any Command says"),
                attribute("gesture", "id", "the gesture, where the Command is `gesture`"),
                attribute("by", "text", "the robot's action, service, topic, method or move"),
                attribute("type", "text", "the type of its messages"),
                attribute(
                    "as",
                    "text",
                    "the kind of interface that `by` names",
                    choices=("action", "service", "topic"),
                ),
                attribute(
                    "stop", "text", "the service or method that stops it, if cancelling does not"
                ),
                *LIMITS,
            ),
            ("set",),
        ),
        Element(
            "set",
            "An argument of the robot's interface, or a field of its message.",
            (
                attribute("name", "text", "its name; dots lead into a message", "required"),
                attribute(
                    "value",
                    "text",
                    "its value; {NAME} stands for an argument of the Command, its {text} or {lang},"
                    " or the {x}, {y} and {heading} of the place it names",
                    "required",
                ),
            ),
        ),
        Element(
            "senses",
            "What the driver reports by itself: an event, a sensor's value, or what users say.",
            (
                attribute("event", "id", "the event that is raised"),
                attribute("sensor", "id", "the sensor whose value it is"),
                attribute(
                    "as",
                    "text",
                    "what it is otherwise: what a user says, the robot's pose, whether the user is seen,"
                    " or the emergency stop",
                    choices=("heard", "pose", "human", "emergency"),
                ),
                attribute("by", "text", "the robot's topic, event or memory key", "required"),
                attribute("type", "text", "the type of its messages"),
                attribute("field", "text", "the part of the message; dots lead into it"),
                attribute("when", "text", "the value at which the event is raised; any by default"),
                attribute(
                    "actor",
                    "text",
                    "who causes the event",
                    default="user",
                    choices=("user", "environment", "robot"),
                ),
            ),
        ),
        Element(
            "place",
            "Where a place of the site is on the robot's own map.",
            (
                attribute("name", "id", "its name, as in Commands", "required"),
                attribute("x", "number", "metres", "required"),
                attribute("y", "number", "metres", "required"),
                attribute("heading", "number", "degrees to the left of the x axis", default="0"),
            ),
        ),
        Element(
            "option",
            "A setting of the driver's own.",
            (
                attribute("name", "id", "its name", "required"),
                attribute("value", "text", "its value", "required"),
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
