"""A certificate for a pair: what a place's application can do to the robot's own one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from prima.errors import DocumentError, Place, UsageError
from prima.interpreter.checks import check_commands, document_commands
from prima.interpreter.elements import Document
from prima.loading import documents_folder, read_application, read_file
from prima.prices import OUTSIDE, Price, prices, reactions, worst
from prima.session import AnyDocument
from prima.sim.scenario import Profile, read_robot


@dataclass(frozen=True, slots=True)
class Delay:
    """How long one reaction of the FA may wait for the EA, and for which part of it."""

    event: str
    devices: tuple[str, ...]
    lasts: int
    known: bool
    what: str
    place: Place


@dataclass(slots=True)
class Certificate:
    """What an EA can do to an FA on one robot. Times are in ms, as far as documents tell."""

    fa: str
    ea: str
    robot: str
    both: list[str]
    only_fa: list[str]
    only_ea: list[str]
    longest_unit: Price | None
    delays: list[Delay]
    leaves: list[Price]
    holds: list[tuple[Place, int]] = field(default_factory=list)
    loops: list[Price] = field(default_factory=list)
    lacks: dict[str, list[str]] = field(default_factory=dict)
    """What the EA asks for and a robot has not, by robot; empty where it has all."""


def certify(
    fa: AnyDocument, ea: AnyDocument, profile: Profile, others: Iterable[Profile]
) -> Certificate:
    """Compare two applications on a robot, and the EA with other robots."""
    own, theirs = prices(fa, profile), prices(ea, profile)
    mine = _devices(own)
    used = _devices(theirs)
    needed = reactions(fa) if isinstance(fa, Document) else {}
    delays = []
    for event, devices in sorted(needed.items()):
        price = worst(theirs, devices)
        if price is not None:
            held = tuple(sorted(price.devices & devices))
            delays.append(Delay(event, held, price.lasts, price.known, price.what, price.place))
    units = [price for price in theirs if price.what == "unit"]
    return Certificate(
        fa.id,
        ea.id,
        profile.id,
        sorted(mine & used),
        sorted(mine - used),
        sorted(used - mine),
        max(units, key=lambda price: price.lasts, default=None),
        delays,
        [price for price in theirs if price.leaves],
        _holds(ea),
        [price for price in theirs if price.loops and price.devices & mine],
        {one.id: _lacks(ea, one) for one in (profile, *others)},
    )


def _devices(held: list[Price]) -> set[str]:
    return set().union(*(price.devices for price in held))


def _holds(document: AnyDocument) -> list[tuple[Place, int]]:
    """Where the application keeps its stream open for an event (X3), and how long."""
    if not isinstance(document, Document):
        return []
    found = []
    for form in document.forms.values():
        if form.hold:
            found.append((form.node.attribute_place("stream"), form.hold))
        found += [
            (item.node.attribute_place("stream"), item.hold) for item in form.items if item.hold
        ]
    return found


def _lacks(document: AnyDocument, profile: Profile) -> list[str]:
    """Commands that a robot cannot do."""
    if not isinstance(document, Document):
        return []
    problems = check_commands(document, profile.commands, profile.devices)
    places = {problem.place for problem in problems if problem.code == "unsupported-command"}
    names = {one.type for one in document_commands(document) if one.node.place in places}
    return sorted(names) or sorted({problem.message for problem in problems})


def certificates(fas: Iterable[str], eas: Iterable[str], robot: str = "") -> list[Certificate]:
    """Certificates of all pairs of files, on a robot's profile or the demo's.

    Raises:
        DocumentError: a document is wrong.
        UsageError: a file cannot be read.
    """
    folder = documents_folder() / "robots"
    chosen = Path(robot) if robot else folder / "papero.xml"
    profile = read_robot(str(chosen), read_file(chosen))
    others = [
        read_robot(str(path), read_file(path))
        for path in sorted(folder.glob("*.xml"))
        if path != chosen
    ]
    fas, eas = list(fas), list(eas)
    read = {name: _read(name) for name in {*fas, *eas}}
    for names, kind, other in ((fas, "fa", "an EA"), (eas, "ea", "an FA")):
        for name in names:
            document = read[name]
            if isinstance(document, Document) and document.kind != kind:
                raise UsageError(f"{name}: is {other}; --with FA EA compares an FA with an EA.")
    return [certify(read[fa], read[ea], profile, others) for ea in eas for fa in fas]


def _read(path: str) -> AnyDocument:
    document, problems = read_application(path, read_file(path))
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return document


# For people and machines -------------------------------------------------------------------


def format_certificate(one: Certificate) -> str:
    """A certificate as text."""
    lines = [f"What {one.ea} can do to {one.fa}, on {one.robot}"]
    lines += ["", "Devices", f"  both use      {_list(one.both)}"]
    lines += [f"  {one.fa} alone  {_list(one.only_fa)}", f"  {one.ea} alone  {_list(one.only_ea)}"]
    lines += ["", f"How long reactions of {one.fa} may wait for {one.ea}"]
    for delay in one.delays:
        lasts = _seconds(delay.lasts, delay.known)
        lines.append(f"  {delay.event}: {lasts}, for the {delay.what} at {delay.place}")
    if not one.delays:
        lines.append(f"  never: {one.fa} reacts to no event ({', '.join(OUTSIDE)}) on its devices")
    unit = one.longest_unit
    lines += ["", f"Longest unit of {one.ea}"]
    lines.append(f"  {_seconds(unit.lasts, unit.known)}, at {unit.place}" if unit else "  none")
    lines += ["", f"Where {one.ea} drives away from where the user may be"]
    lines += [f"  {price.what} at {price.place}" for price in one.leaves] or ["  nowhere"]
    if one.leaves:
        lines.append(f"  It waits while {one.fa} is in a conversation with the user (K1, K2).")
    lines += ["", f"What of {one.fa} may starve"]
    lines += [f"  while {price.what} at {price.place} goes on: equal Commands of {one.fa} on"
              f" {_list(price.devices)} (E4)" for price in one.loops]  # fmt: skip
    lines += [f"  for {lasts / 1000:g} s at {place}: all but reactions, with x3 (a hold)"
              for place, lasts in one.holds]  # fmt: skip
    if not one.loops and not one.holds:
        lines.append("  nothing")
    lines += ["", f"Robots that can run {one.ea}"]
    for robot, lacking in sorted(one.lacks.items()):
        lines.append(f"  {robot}: {'all of it' if not lacking else f'not {_list(lacking)}'}")
    return "\n".join(lines) + "\n"


def certificate_data(one: Certificate) -> dict[str, Any]:
    """A certificate as plain data; times in ms."""

    def price(held: Price) -> dict[str, Any]:
        return {"what": held.what, "place": str(held.place), "lasts": held.lasts,
                "known": held.known, "devices": sorted(held.devices)}  # fmt: skip

    return {
        "fa": one.fa,
        "ea": one.ea,
        "robot": one.robot,
        "devices": {"both": one.both, "fa": one.only_fa, "ea": one.only_ea},
        "delays": [
            {"event": delay.event, "lasts": delay.lasts, "known": delay.known, "what": delay.what,
             "place": str(delay.place), "devices": list(delay.devices)}
            for delay in one.delays
        ],
        "longest_unit": price(one.longest_unit) if one.longest_unit else None,
        "leaves": [price(held) for held in one.leaves],
        "holds": [{"place": str(place), "lasts": lasts} for place, lasts in one.holds],
        "loops": [price(held) for held in one.loops],
        "lacks": one.lacks,
    }  # fmt: skip


def _list(words: Iterable[str]) -> str:
    return ", ".join(sorted(words)) or "none"


def _seconds(lasts: int, known: bool) -> str:
    return f"up to {lasts / 1000:.1f} s" if known else f"{lasts / 1000:.1f} s or more"
