"""Searches along one time, and for the smallest shift, on made-up runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from hypothesis import given
from hypothesis import strategies as st

from prima.experiments.examine import Seen
from prima.experiments.lines import (
    EventLine,
    LinePiece,
    Point,
    Search,
    moments,
    pieces,
    shift,
    shrunk,
)

INSTANTS = [0, 400, 900, 901, 2500]


def run(point: Point) -> Seen:
    """Two events that show at their times; which instants they come after is the order."""
    places = [sum(one <= time for one in INSTANTS) for time in point]
    shows = sorted((time, which) for which, time in enumerate(point))
    entries = sorted([*((one, -1) for one in INSTANTS), *shows])
    return Seen(
        order=str((places, [which for _, which in shows])),
        times=[time for time, _ in entries],
        outside=[at for at, (_, which) in enumerate(entries) if which >= 0],
    )


T = TypeVar("T")


def done(search: Search[T], make: Callable[[Point], Seen] = run) -> tuple[T, int]:
    """A search's result, and how many runs it asked for."""
    asked: set[Point] = set()
    try:
        points = next(search)
        while True:
            asked.update(points)
            points = search.send({one: make(one) for one in points})
    except StopIteration as stop:
        return stop.value, len(asked)


@given(st.integers(0, 3000), st.integers(0, 3000))
def test_a_line_finds_every_piece(here: int, other: int) -> None:
    """Every order that any time brings, with the boundaries of each."""
    found, runs = done(EventLine((here, other), 0, 0, 3000).search())
    assert found == pieces({time: run((time, other)).order for time in range(3001)})
    assert runs < 120


def test_a_line_tries_its_grid() -> None:
    asked = []

    def make(point: Point) -> Seen:
        asked.append(point[0])
        return Seen(order="same")

    done(EventLine((1000,), 0, 0, 2000, step=300).search(), make)
    assert {100, 400, 700, 1000, 1300, 1600, 1900, 0, 2000} <= set(asked)


def test_when_an_event_shows() -> None:
    assert moments(run((700,)), run((701,)), 700, 701) == [0]
    late = Seen(times=[0, 700, 1200, 5000], outside=[2])
    later = Seen(times=[0, 701, 1201, 5000], outside=[2])
    assert moments(late, later, 700, 701) == [0, 500]
    assert moments(late, late, 700, 701) == []


def test_pieces_are_joined() -> None:
    orders = {5: "a", 1: "a", 9: "b", 3: "a", 12: "a"}
    assert pieces(orders) == [LinePiece(1, 5, "a"), LinePiece(9, 9, "b"), LinePiece(12, 12, "a")]
    assert LinePiece(3, 7, "a").nearest(1) == 3 and LinePiece(3, 7, "a").nearest(5) == 5


@given(st.integers(0, 3000), st.integers(0, 3000), st.integers(500, 2500))
def test_the_smallest_shift(first: int, second: int, limit: int) -> None:
    """Only the sum matters: each event alone is moved as little as need be."""
    base = (1000, 1000)

    def make(point: Point) -> Seen:
        return Seen(order="far" if point[0] >= 1000 + limit else "near")

    point = (max(first, 1000 + limit), second)
    found, runs = done(shrunk(base, point, lambda seen: seen.order == "far"), make)
    assert found == (1000 + limit, 1000)
    assert shift(base, found) == (1, limit)
    assert runs < 40


def test_a_case_of_two_events_keeps_both() -> None:
    base = (1000, 1000)

    def make(point: Point) -> Seen:
        return Seen(order="bad" if point[0] < 800 and point[1] > 1300 else "good")

    found, _ = done(shrunk(base, (0, 3000), lambda seen: seen.order == "bad"), make)
    assert found == (799, 1301)
