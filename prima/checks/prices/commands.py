"""Maximum durations of Commands on a robot, according to the simulator."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from operator import or_

from prima.checks.prices.model import Price, devices_of
from prima.devices.profile import Profile
from prima.language.arguments import check_argument
from prima.language.commands import TABLE_4_2, Argument, CommandType
from prima.markup.tree import Node

SETTLING_MS = 1500
"""Time of a turn beyond its angle at full speed: for slowing down and detecting the end (ms)."""
MOST_STEPS = 1000
"""Limit of a unit's steps, above which they are only added up."""
SEARCH = 360.0 + 180.0
"""How far (degrees) the robot turns at most to face a user who stands still."""

Value = object | None
"""An argument's value; None if only a run determines it."""


def command_price(
    node: Node,
    name: str,
    args: Mapping[str, Value],
    speech: tuple[int, str] | None,
    profile: Profile,
) -> Price:
    """The cost of a Command to others.

    Args:
        node: its element.
        name: its type.
        args: its arguments; None for one that an expression gives.
        speech: how long (ms) it speaks, and why that may be longer; None if it does not
            speak.
        profile: the robot.
    """
    row = profile.commands.get(name) or TABLE_4_2.get(name)
    said, unknown = speech or (0, "")
    if row is None:
        return Price(node, name, frozenset(), 1, unknown)
    devices = row.occupied("x" if speech else None)
    lasts = max(said, _motion(row, args, profile), 1)
    return Price(node, name, devices, lasts, unknown, row.leaves, row.engages, row.feedback)


def group_price(
    node: Node, longest: int, inner: Sequence[Price], afters: Sequence[tuple[int, ...]]
) -> Price:
    """The cost of a unit around Commands to others (U4).

    Args:
        node: its element.
        longest: its longest duration (ms), after which running Commands still run to their end.
        inner: the cost of its steps.
        afters: the indices of the steps that each of them waits for.
    """
    last = max((one.lasts for one in inner), default=0)
    lasts = min(_together(inner, afters), longest + last)
    return unit_price(node, devices_of(inner), lasts, inner)


def unit_price(node: Node, devices: frozenset[str], lasts: int, inner: Sequence[Price]) -> Price:
    """The cost to others of a unit that keeps devices for a time (ms), by its content."""
    unknown = next((one.unknown for one in inner if one.unknown), "")
    return Price(
        node,
        "unit",
        devices,
        lasts,
        unknown,
        engages=any(one.engages for one in inner),
        listens=any(one.listens for one in inner),
        inner=tuple(inner),
    )


def _together(prices: Sequence[Price], afters: Sequence[tuple[int, ...]]) -> int:
    """The longest duration of a unit's steps.

    A step may have to wait for each one that is neither before nor after it and needs a device
    of it: which goes first depends on how long the steps before them take.
    """
    total = sum(price.lasts for price in prices)
    if len(prices) > MOST_STEPS:
        return total
    ends: list[int] = []
    for price, after, others in zip(prices, afters, _beside(prices, afters), strict=True):
        begins = max((ends[one] for one in after), default=0)
        ends.append(begins + sum(prices[one].lasts for one in others) + price.lasts)
    return min(max(ends, default=0), total)


def _beside(prices: Sequence[Price], afters: Sequence[tuple[int, ...]]) -> list[list[int]]:
    """For each step, those in other branches that need a device of it."""
    before: list[int] = []
    """The steps that come before each, as bits."""
    found: list[list[int]] = [[] for _ in prices]
    for at, after in enumerate(afters):
        before.append(reduce(or_, (before[one] | 1 << one for one in after), 0))
        for one in range(at):
            if not before[at] >> one & 1 and prices[at].devices & prices[one].devices:
                found[at].append(one)
                found[one].append(at)
    return found


def _motion(row: CommandType, args: Mapping[str, Value], profile: Profile) -> int:
    """The longest movement of a Command (ms), by its arguments or their bounds."""
    moves = MOTIONS.get(row.name)
    if moves is not None:
        return moves(row, args, profile)
    return row.lasts or (profile.loop if row.feedback else 1)


def _turn(row: CommandType, args: Mapping[str, Value], profile: Profile) -> int:
    """The duration of a turn by an angle; toward something it is half a turn at most."""
    angle = _most(row.arguments["angle"], args["angle"]) if "angle" in args else 180.0
    return _turning(angle, profile)


def _turning(angle: float, profile: Profile) -> int:
    return round(angle / profile.turn_speed * 1000) + SETTLING_MS


def _head(row: CommandType, args: Mapping[str, Value], profile: Profile) -> int:
    """The duration of a head's movement from its farthest direction."""
    farthest = _most(row.arguments["pan"], None)
    angle = farthest + _most(row.arguments["pan"], args.get("pan", 0.0))
    return round(angle / profile.head_speed * 1000)


def _gesture(_row: CommandType, args: Mapping[str, Value], profile: Profile) -> int:
    name = args.get("name")
    if name is None:
        return max(profile.gestures.values(), default=1)
    return profile.gestures.get(str(name), 1)


def _for_a_time(row: CommandType, args: Mapping[str, Value], _profile: Profile) -> int:
    return round(_most(row.arguments["time"], args.get("time")))


def _face(_row: CommandType, _args: Mapping[str, Value], profile: Profile) -> int:
    return _turning(SEARCH, profile)


def _most(argument: Argument, value: Value) -> float:
    """The size of an argument's value, or the largest that it may have."""
    largest = max(abs(argument.low or 0.0), abs(argument.high or 0.0))
    if value is None:
        return largest
    try:
        return abs(float(check_argument("", argument, str(value))))
    except ValueError:
        return largest  # it is refused when requested


MOTIONS: Mapping[str, Callable[[CommandType, Mapping[str, Value], Profile], int]] = {
    "speak": lambda *_: 1,
    "gesture": _gesture,
    "move-head": _head,
    "pause": _for_a_time,
    "set-speed-and-time": _for_a_time,
    "turn": _turn,
    "turn-and-speak": _turn,
    "set-direction": lambda _row, _args, profile: _turning(180.0, profile),
    "face-human": _face,
    "face-human-and-speak": _face,
}
"""The duration (ms) of movements without feedback that varies."""
