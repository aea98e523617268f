"""The language of worlds."""

from __future__ import annotations

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute

_X = attribute("x", "number", "metres east", "required", low=-1000, high=1000)
_Y = attribute("y", "number", "metres north", "required", low=-1000, high=1000)
HEADING = attribute(
    "heading", "number", "degrees counter-clockwise from east", default="0", low=-360, high=360
)
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
        Element("place", "A place of the topological map.", (ID, _X, _Y, HEADING, TITLE)),
        Element(
            "way",
            "A way between two places, usable in both directions.",
            (
                attribute("from", "id", "a place", "required"),
                attribute("to", "id", "another place", "required"),
            ),
        ),
        Element(
            "wall",
            "A straight wall: the robot neither sees nor moves through it. The user ignores walls.",
            (
                *(
                    attribute(name, "number", doc, "required", low=-1000, high=1000)
                    for name, doc in (
                        ("x1", "metres east of one end"),
                        ("y1", "metres north of one end"),
                        ("x2", "metres east of the other end"),
                        ("y2", "metres north of the other end"),
                    )
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
            " enters and unloads it when it leaves.",
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
        **dict.fromkeys(("robot", "person"), "The scenario says who is where."),
    },
)
