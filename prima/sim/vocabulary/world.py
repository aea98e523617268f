"""The language of worlds."""

from __future__ import annotations

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.markup.vocabulary import Instead, Vocabulary, elements

POINT = """x*: number -1000..1000 | metres east
  y*: number -1000..1000 | metres north"""
TABLE = f"""
world > place way wall thing corner area | A place that a robot visits: its map, walls and things.
    Lengths in metres.
  {VERSION}
  {ID}
  {TITLE}
place | A place of the topological map.
  {ID}
  {POINT}
  heading: number -360..360 = 0 | degrees counter-clockwise from east
  {TITLE}
way | A way between two places, usable in both directions.
  from*: id | a place
  to*: id | another place
wall | A straight wall: the robot neither sees nor moves through it. The user ignores walls.
  x1*: number -1000..1000 | metres east of one end
  y1*: number -1000..1000 | metres north of one end
  x2*: number -1000..1000 | metres east of the other end
  y2*: number -1000..1000 | metres north of the other end
thing | Something to look at or point to.
  {ID}
  {POINT}
  {TITLE}
corner | Raises an event when the robot comes near it.
  {ID}
  {POINT}
  radius: number 0.05..50 = 0.8 | how near
  event: event = corner | which event
area | A building or room whose entrance offers an application: the robot loads it when it enters
    and unloads it when it leaves.
  {ID}
  {TITLE}
  application*: path | the application's document
  x1*: number -1000..1000 | metres east of its west side
  y1*: number -1000..1000 | metres north of its south side
  x2*: number -1000..1000 | metres east of its east side
  y2*: number -1000..1000 | metres north of its north side
"""
WORLD = Vocabulary(
    "urn:prima:world:1",
    "world",
    "world",
    elements(TABLE),
    hints={
        **dict.fromkeys(("room", "location", "position", "node", "waypoint"), Instead("place")),
        **dict.fromkeys(("path", "road", "route", "edge", "link"), Instead("way")),
        **dict.fromkeys(("object", "item", "landmark"), Instead("thing")),
        **dict.fromkeys(("robot", "person"), "The scenario says who is where."),
    },
)
