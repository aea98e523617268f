"""Worlds, robot profiles and scenarios: their elements as tables."""

from __future__ import annotations

from dataclasses import replace

from prima.devices.vocabulary import ID, TITLE, VERSION
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute
from prima.script.sandbox import START

_X = attribute("x", "number", "metres east", "required", low=-1000, high=1000)
_Y = attribute("y", "number", "metres north", "required", low=-1000, high=1000)
_HEADING = attribute(
    "heading", "number", "degrees counter-clockwise from east", default="0", low=-360, high=360
)
_AFTER = attribute("after", "delay", "how long afterwards", default="0s")

WORLD = Vocabulary(
    "urn:prima:world:1",
    "world",
    "world",
    (
        Element(
            "world",
            "A place that a robot visits: its map, walls and things. Lengths in metres.",
            (VERSION, ID, TITLE),
            ("place", "way", "wall", "thing", "corner", "area"),
        ),
        Element("place", "A place of the topological map.", (ID, _X, _Y, _HEADING, TITLE)),
        Element(
            "way",
            "A way between two places, to be gone in both directions.",
            (
                attribute("from", "id", "a place", "required"),
                attribute("to", "id", "another place", "required"),
            ),
        ),
        Element(
            "wall",
            "A straight wall: the robot neither sees nor goes through it. The user goes as told.",
            (
                attribute(
                    "x1", "number", "metres east of one end", "required", low=-1000, high=1000
                ),
                attribute(
                    "y1", "number", "metres north of one end", "required", low=-1000, high=1000
                ),
                attribute(
                    "x2", "number", "metres east of the other end", "required", low=-1000, high=1000
                ),
                attribute(
                    "y2",
                    "number",
                    "metres north of the other end",
                    "required",
                    low=-1000,
                    high=1000,
                ),
            ),
        ),
        Element("thing", "Something to look at or point to.", (ID, _X, _Y, TITLE)),
        Element(
            "corner",
            "Raises an event when the robot comes near it.",
            (
                ID,
                _X,
                _Y,
                attribute("radius", "number", "how near", default="0.8", low=0.05, high=50),
                attribute("event", "event", "which event", default="corner"),
            ),
        ),
        Element(
            "area",
            "A building or room whose entrance offers an application: the robot loads it when it"
            " comes in and unloads it when it goes out.",
            (
                ID,
                TITLE,
                attribute("application", "path", "the application's document", "required"),
                *(
                    attribute(name, "number", what, "required", low=-1000, high=1000)
                    for name, what in (
                        ("x1", "metres east of its west side"),
                        ("y1", "metres north of its south side"),
                        ("x2", "metres east of its east side"),
                        ("y2", "metres north of its north side"),
                    )
                ),
            ),
        ),
    ),
    hints={
        **dict.fromkeys(("room", "location", "position", "node", "waypoint"), Instead("place")),
        **dict.fromkeys(("path", "road", "route", "edge", "link"), Instead("way")),
        **dict.fromkeys(("object", "item", "landmark"), Instead("thing")),
        **dict.fromkeys(("robot", "person"), "It is the scenario that says who is where."),
    },
)

_ACTIONS = (
    *("say", "hang-up", "touch", "walk", "wait", "look", "follow", "stay", "leave", "note"),
    *("message", "event", "sensor", "fail", "repair", "emergency", "release", "unload", "load"),
)
_CONFIDENCE = attribute(
    "confidence", "number", "how sure the recogniser is of the words", default="1", low=0, high=1
)
_CALLED = attribute("id", "id", "its name, for experiments that vary it (prima sweep)")
_CHANCE = attribute(
    "chance",
    "number",
    "how likely it is, each time, from 0 to 1; drawn by the scenario's seed",
    default="1",
    low=0,
    high=1,
)
_PERSON = attribute("person", "id", "whose doing it is, of several persons; by default the first's")
_SPEED = attribute("speed", "quantity", "metres a second", default="1", low=0.05, high=5)
_TRIGGERS = (
    attribute("at", "delay", "a time of the run"),
    attribute("said", "text", "the robot has said something with these words"),
    attribute("asked", "text", "the robot has asked something with these words and listens"),
    attribute("doing", "id", "the robot begins such a Command"),
    attribute("done", "id", "the robot ends such a Command"),
    attribute("on", "event", "such an event happens"),
)
_EXPECTED = (
    attribute("says", "text", "the robot begins to say something with these words"),
    attribute("does", "id", "the robot begins a Command of this type; may stand beside says"),
    attribute("finishes", "id", "the robot ends a Command of this type"),
    attribute("event", "event", "such an event happens"),
    attribute("logs", "text", "an application logs something with these words"),
    attribute("sends", "text", "an application sends something to this service or URI"),
    attribute("state", "id", "an application is in this form"),
    attribute("ends", "id", "this application ends"),
    attribute("reason", "text", "why it ends: exit, unloaded or an error's name"),
    attribute("by", "id", "the application whose doing it is; without, any"),
    attribute("after", "text", "it comes after this other expectation, by its id"),
    attribute("before", "text", "it comes before this other expectation, by its id"),
    attribute("at", "text", "it comes from this time of the run on; for a state also end"),
    *(replace(one, doc=f"it comes after {one.doc}") for one in _TRIGGERS[1:]),
    attribute("count", "integer", "which time of these counts", default="1", low=1),
    attribute("within", "duration", "how long afterwards at most"),
)

SCENARIO = Vocabulary(
    "urn:prima:scenario:1",
    "scenario",
    "scenario",
    (
        Element(
            "scenario",
            "A run: who is where, what the user does and when, what services answer.",
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
                    "when the run begins, for Date in documents; in UTC, as all times",
                    default=START,
                ),
                attribute("policy", "text", "the mediator's policy", default="prima"),
                attribute(
                    "patience",
                    "duration",
                    "how long an application may keep others from the speaker (E6); 0s for ever",
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
                    "which of all possible runs it is: what is drawn in it depends on this alone",
                    default="1",
                    low=0,
                ),
            ),
            (
                "robot",
                "person",
                "application",
                "answer",
                "when",
                "service",
                "connection",
                "transfer",
                "expect",
                "never",
                "in-order",
            ),
        ),
        Element(
            "robot",
            "Where the robot is at first.",
            (attribute("at", "id", "a place", "required"), _HEADING),
        ),
        Element(
            "person",
            "The user, and where at first; of several the robot attends to one at a time.",
            (
                attribute("id", "id", "their name; needed where there are several", default="user"),
                attribute("at", "id", "a place or thing"),
                attribute("x", "number", "metres east", low=-1000, high=1000),
                attribute("y", "number", "metres north", low=-1000, high=1000),
                _SPEED,
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
                    "whether it is the robot's own or a place's; it counts, whatever the document says",
                    default="ea",
                    choices=("fa", "ea"),
                ),
                attribute("uri", "text", "where a VoiceXML document is served as it runs for real"),
                attribute("folder", "path", "its folder, or one above it, that is served there"),
            ),
        ),
        Element(
            "answer",
            "What the user answers whenever the robot asks something with these words.",
            (
                _CALLED,
                _PERSON,
                attribute("to", "text", "words of the question", "required"),
                attribute("after", "delay", "how long after it", default="1s"),
                attribute(
                    "times", "integer", "how often at most", default="1000", low=1, high=1000
                ),
                _CHANCE,
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
                *_TRIGGERS,
                _AFTER,
                attribute("times", "integer", "how often at most", default="1", low=1, high=1000),
                attribute("count", "integer", "the first time that counts", default="1", low=1),
                _CHANCE,
            ),
            ("one-of", *_ACTIONS),
        ),
        Element(
            "one-of",
            "One of these happens, each as likely as the others; drawn by the scenario's seed.",
            (),
            _ACTIONS,
        ),
        Element("say", "The user says something.", (_CONFIDENCE,), ("alternative",), text=True),
        Element(
            "alternative",
            "What else it may have been, as the recogniser hears it: it is less sure of this.",
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
        Element(
            "wait", "Nothing, for a while.", (attribute("for", "delay", "how long", "required"),)
        ),
        Element(
            "look",
            "The user looks at something.",
            (attribute("at", "id", "a place or thing, or robot", "required"),),
        ),
        Element(
            "follow",
            "The user goes behind the robot from now on.",
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
                attribute("to", "id", "the application that alone gets it; without, all do"),
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
            "A value given along.",
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
                attribute(
                    "value", "text", "its value: a number, true, false or a text", "required"
                ),
            ),
        ),
        Element(
            "fail",
            "A device fails from now on, or hangs.",
            (
                attribute("device", "id", "which", "required"),
                attribute(
                    "hangs", "boolean", "whether it hangs instead of failing", default="false"
                ),
            ),
        ),
        Element(
            "repair", "The device works again.", (attribute("device", "id", "which", "required"),)
        ),
        Element("emergency", "The emergency stop is pressed."),
        Element(
            "release",
            "The emergency stop is released.",
            (attribute("resume", "boolean", "whether streams resume", default="true"),),
        ),
        Element(
            "unload",
            "An application is taken out.",
            (attribute("application", "id", "its id", "required"),),
        ),
        Element(
            "load",
            "An application that has ended, or was taken out, is put in again: it starts anew.",
            (attribute("application", "id", "its id", "required"),),
        ),
        Element(
            "service",
            "A service that applications send to. Its replies are given in order; the last repeats. One"
            " without replies takes what it is sent and says nothing.",
            (
                attribute("name", "id", "its name", "required"),
                attribute(
                    "uri", "text", "an http(s) URI: it answers what is fetched from there or below"
                ),
                attribute(
                    "application", "id", "the application that alone may ask it; without, all may"
                ),
            ),
            ("reply", "failure"),
        ),
        Element(
            "reply",
            "An answer.",
            (
                _AFTER,
                attribute(
                    "src",
                    "path",
                    "the file that a fetch of a VoiceXML document is answered with; without one,"
                    " with XML of its data",
                ),
            ),
            ("data",),
        ),
        Element(
            "failure",
            "No answer but an error.",
            (
                _AFTER,
                attribute("reason", "text", "why", default="the service does not answer"),
                attribute("status", "integer", "the status of HTTP that a fetch is answered with"),
            ),
        ),
        Element(
            "connection",
            "What VoiceXML applications know of the user's call, as session.connection; without"
            " it, or an attribute of it, that is undefined.",
            (
                attribute("remote", "text", "the URI of the user's telephone"),
                attribute("local", "text", "the URI that they have called"),
                attribute("protocol", "text", "the protocol's name, as sip"),
                attribute("version", "text", "the protocol's version"),
                attribute("aai", "text", "what came along with the call"),
                attribute("originator", "text", "who has called", choices=("local", "remote")),
            ),
            ("redirect",),
        ),
        Element(
            "redirect",
            "A station that the call has been redirected from, the last one first.",
            (
                attribute("uri", "text", "its URI", "required"),
                attribute("pi", "text", "the presentation information"),
                attribute("si", "text", "the screening information"),
                attribute("reason", "text", "why it was redirected"),
            ),
        ),
        Element(
            "transfer",
            "How calls to a destination go that a VoiceXML application transfers the user to."
            " Of several for a destination each is for one call, in order; the last repeats.",
            (
                attribute(
                    "to", "text", "the destination's URI, or what it begins with", default=""
                ),
                attribute(
                    "outcome",
                    "text",
                    "how it ends: busy, noanswer or network_busy before anybody answers;"
                    " far_end_disconnect, network_disconnect, near_end_disconnect,"
                    " maxtime_disconnect or unknown after it; or an event whose name begins with"
                    " error",
                    default="far_end_disconnect",
                ),
                attribute(
                    "after", "delay", "how long until it is answered, or fails", default="0s"
                ),
                attribute("lasts", "delay", "how long it lasts once it is answered", default="10s"),
            ),
        ),
        Element(
            "expect",
            "What has to happen in the run. prima test checks it; a run itself takes no notice.",
            (
                attribute("id", "id", "its name, for after and before of others"),
                *_EXPECTED,
                attribute("times", "integer", "how often exactly; without, at least once", low=1),
            ),
            ("data",),
        ),
        Element("never", "What must not happen in the run.", _EXPECTED, ("data",)),
        Element(
            "in-order",
            "Expectations that have to come true one after the other.",
            (),
            ("expect",),
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
        **dict.fromkeys(("forbid", "must-not", "not"), Instead("never")),
        "world": 'Name it in the root element: <scenario world="..." robot="...">.',
        "question": 'Write what the user answers: <answer to="words of the question">Yes.</answer>.',
        "comment": "Write <note>, or a comment of XML: <!-- ... -->.",
    },
)

_ITS = ("say", "hang-up", "touch", "walk", "wait", "look", "follow", "stay", "leave", "note")
"""What a user does, without what happens in the surroundings."""


def _without(element: Element, name: str, children: tuple[str, ...] = ()) -> Element:
    """An element of scenarios as users have it."""
    kept = tuple(one for one in element.attributes if one.name != name)
    return replace(element, attributes=kept, children=children or element.children)


USER = Vocabulary(
    "urn:prima:user:1",
    "user",
    "user",
    (
        Element(
            "user",
            "A kind of users: how a person of a scenario behaves, whatever the scenario is about.",
            (VERSION, ID, TITLE, _SPEED),
            ("answers", "answer", "when"),
        ),
        Element(
            "answers",
            "How they give the scenario's answers, where these do not say so themselves.",
            (attribute("after", "delay", "how long after the question", default="1s"), _CHANCE),
        ),
        _without(SCENARIO.elements["answer"], "person"),
        _without(SCENARIO.elements["when"], "person", ("one-of", *_ITS)),
        replace(SCENARIO.elements["one-of"], children=_ITS),
        SCENARIO.elements["alternative"],
        *(SCENARIO.elements[name] for name in _ITS),
    ),
    hints={
        **{tag: hint for tag, hint in SCENARIO.hints.items() if tag != "user"},
        **dict.fromkeys(
            ("event", "message", "sensor", "fail", "repair", "service"),
            "It is the scenario that says what happens around the user.",
        ),
        "person": "It is the scenario that says who is where.",
    },
)
