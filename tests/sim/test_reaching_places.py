"""Areas and corners are noticed wherever the robot goes, though not compared at each place."""

from __future__ import annotations

from itertools import accumulate
from math import dist
from typing import cast

from hypothesis import given, settings
from hypothesis import strategies as st

from prima.devices.profile import Profile
from prima.markup.tree import Node
from prima.messages import ApplicationLoaded
from prima.sim.entrances import THRESHOLD, Entrances
from prima.sim.map import Area, Corner, Map
from prima.sim.plan import Point
from prima.sim.world import World

metres = st.floats(-4, 4, allow_nan=False).map(lambda one: round(one, 2))
points = st.tuples(metres, metres)
steps = st.lists(st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)), max_size=40)


def way(begin: Point, steps: list[Point]) -> list[Point]:
    """The places from one on, step by step."""
    return [*accumulate(steps, lambda at, by: (at[0] + by[0], at[1] + by[1]), initial=begin)]


@given(st.lists(st.tuples(points, points), min_size=1, max_size=3), points, steps)
@settings(deadline=None)
def test_areas_are_entered_and_left(
    corners: list[tuple[Point, Point]], begin: Point, steps: list[Point]
) -> None:
    areas = []
    for number, (a, b) in enumerate(corners):
        low, high = (min(a[0], b[0]), min(a[1], b[1])), (max(a[0], b[0]), max(a[1], b[1]))
        areas.append(Area(str(number), "", low, high, "", cast(Node, None)))
    entrances = Entrances([(one, one.id) for one in areas])
    inside: set[str] = set()
    for place in way(begin, steps):
        for one in entrances.cross(place):
            loaded = isinstance(one, ApplicationLoaded)
            assert loaded == (one.app not in inside)
            (inside.add if loaded else inside.discard)(one.app)
        assert {one.id for one in areas if one.beyond(place) <= 0} <= inside
        assert not {one.id for one in areas if one.beyond(place, THRESHOLD) > 0} & inside


@given(
    st.lists(st.tuples(points, st.floats(0.05, 2)), min_size=1, max_size=3),
    st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-90, 90)), max_size=40),
)
@settings(deadline=None)
def test_corners_are_told_when_the_robot_comes_near(
    places: list[tuple[Point, float]], drives: list[tuple[float, float]]
) -> None:
    corners = [Corner(str(number), at, near, "") for number, (at, near) in enumerate(places)]
    world = World(Map("m", corners=corners), Profile("r"), (0.0, 0.0), 0.0)

    def near() -> set[str]:
        return {one.id for one in corners if dist(world.position, one.at) <= one.radius}

    before = near()
    for number, world.drive in enumerate(drives, 1):
        world.advance(number * 500)
        assert {one.id for one in world.corners()} == near() - before
        before = near()
