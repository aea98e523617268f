"""Certificates as text, and as data for JSON."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from prima.certificate.model import Certificate, Delay, Starving
from prima.checks.prices import Gap, Price
from prima.language.commands import PATIENCE_MS
from prima.transcript.table import pad, width

RESPONSE = "first word or movement towards the user"
MOST_REASONS = 5
"""Maximum number of reasons of one kind in the text; the data have all."""


def format_certificate(one: Certificate) -> str:
    """A certificate as text."""
    lines = [f"What {one.ea} can do to {one.fa}, on {one.robot}, under the policy prima"]
    who = {"both use": one.both, f"{one.fa} alone": one.only_fa, f"{one.ea} alone": one.only_ea}
    widest = max(map(width, who))
    lines += ["", "Devices"]
    lines += [f"  {pad(name, widest)}  {_list(used)}" for name, used in who.items()]
    lines += _reasons(one.gaps, "not known")
    lines += ["", f"How long reactions of {one.fa} may wait for {one.ea}"]
    lines += _delays(one)
    unit = one.longest_unit
    lines += ["", f"Longest unit of {one.ea}"]
    lines.append(f"  {_seconds(unit.lasts, unit.known)}, at {unit.place}" if unit else "  none")
    lines += ["", f"Where {one.ea} drives away from where the user may be"]
    lines += [f"  {price.what} at {price.place}" for price in one.leaves] or ["  nowhere"]
    if one.leaves:
        lines.append(f"  It waits while {one.fa} is in a conversation with the user (K1, K2).")
    lines += ["", f"What of {one.fa} may starve, but for reactions"]
    lines += [line for starved in one.starves for line in _starving(starved, one)]
    lines += [f"  {place}: a hold, for {lasts / 1000:g} s, with x3\n    waiting: all"
              for place, lasts in one.holds]  # fmt: skip
    lines += _others(one)
    lines += _long(one)
    lines += ["", f"Robots that can run {one.ea}"]
    for robot, lacking in sorted(one.lacks.items()):
        lines.append(f"  {robot}: {'all of it' if not lacking else f'not {_list(lacking)}'}")
    return "\n".join(lines) + "\n"


def _delays(one: Certificate) -> list[str]:
    """The waits of reactions; events with equal waits are combined."""
    if not one.delays:
        return [f"  never: {one.ea} does nothing that reactions of {one.fa} wait for"]
    groups: dict[tuple[str, ...], list[str]] = {}
    for delay in one.delays:
        groups.setdefault(tuple(_delay(delay, one)), []).append(delay.event)
    return [
        line
        for (first, *rest), events in groups.items()
        for line in (f"  {', '.join(events)}: {first}", *rest)
    ]


def _delay(delay: Delay, one: Certificate) -> list[str]:
    """The wait of the first Command, and of the response if different."""
    response = delay.response
    found = _wait(delay, one)
    if response is None or response == replace(delay, response=None):
        return found
    first, *rest = _wait(response, one)
    return [*found, f"    {RESPONSE}: {first}", *(f"  {line}" for line in rest)]


def _wait(delay: Delay, one: Certificate) -> list[str]:
    first = ", ".join([_bound(delay), *filter(None, [", and ".join(_causes(delay, one))])])
    if delay.listens:
        first += ", and while the user speaks"
    found = [first]
    if not delay.endless and (delay.each is None or delay.each):
        found.append(f"    {_more(delay)} for each {_further(one.ea, delay)}")
    found += _reasons(delay.endless, "without an end", 4)
    return found + _reasons(delay.unknown, "not known", 4)


def _causes(delay: Delay, one: Certificate) -> Iterable[str]:
    """The causes of a wait."""
    if delay.place is not None:
        yield f"for the {delay.what} at {delay.place}"
    if delay.after:
        places = " and ".join(map(str, delay.after[:MOST_REASONS]))
        if len(delay.after) > MOST_REASONS:
            places += f" and {len(delay.after) - MOST_REASONS} more such places"
        yield f"for what {one.ea} does about the same event at {places} (F2)"
    if delay.everything:
        yield f"for all that {one.ea} does (K1, K2)"


def _more(delay: Delay) -> str:
    return "longer, without a bound," if delay.each is None else f"{delay.each / 1000:.1f} s more"


def _further(ea: str, delay: Delay) -> str:
    """The events that make a wait longer."""
    found = f"event that {ea} reacts to meanwhile"
    return f"other {found}, or has not done with" if delay.whole else found


def _bound(delay: Delay) -> str:
    if delay.endless:
        return "without a bound"
    if not delay.lasts and delay.known:
        return "not at all"
    return _seconds(delay.lasts, delay.known)


def _reasons(gaps: Iterable[Gap], why: str, indent: int = 2) -> list[str]:
    gaps = list(gaps)
    lines = [f"{' ' * indent}{why}: {gap.reason}, at {gap.place}" for gap in gaps[:MOST_REASONS]]
    if len(gaps) > MOST_REASONS:
        lines.append(f"{' ' * indent}{why}: {len(gaps) - MOST_REASONS} more such places")
    return lines


def _starving(starved: Starving, one: Certificate) -> list[str]:
    kinds = []
    if starved.everything:
        kinds.append(f"all, where {one.ea} has the floor (F2)")
    if starved.devices:
        rule = f" ({starved.rule})" if starved.rule else ""
        if starved.rule == "S2c" and "speaker" in starved.devices:
            alone = {*starved.devices} <= {"speaker", "speech-recognition"}
            which = "each" if alone else "what waits for the speaker alone"
            rule += f", {which} for a run's patience, {PATIENCE_MS / 1000:g} s by default (E6)"
        kinds.append(f"equal ones on {_list(starved.devices)}{rule}")
    if starved.leaving:
        kinds.append("those that leave the user (K1)")
    return [f"  {starved.place}: {starved.what}", *(f"    waiting: {kind}" for kind in kinds)]


def _others(one: Certificate) -> list[str]:
    """The wait of Commands other than reactions, if nothing may starve."""
    if one.starves:
        return []
    if one.others.unknown:
        return _reasons(
            one.others.unknown, "not known how long Commands that are not reactions wait"
        )
    longest = f"{one.others.lasts / 1000:.1f} s"
    nothing = "nothing else" if one.holds else "nothing"
    return [f"  {nothing}: others than reactions wait up to {longest} each time {one.ea} is busy"]


def _long(one: Certificate) -> list[str]:
    """Activities longer than a run's patience (E6), if any."""
    if not one.long:
        return []
    patience = f"a run's patience, {PATIENCE_MS // 1000} s by default (E6)"
    found = ["", f"What of {one.ea} is longer than {patience}"]
    for price in one.long:
        meets = "it ends then" if price.what == "unit" else "it may be refused"
        found.append(f"  {price.what} at {price.place}, {price.seconds}: {meets}")
    return found


def certificate_data(one: Certificate) -> dict[str, Any]:
    """A certificate as data for JSON; times in ms, null if unbounded or unknown."""
    return {
        "fa": one.fa,
        "ea": one.ea,
        "robot": one.robot,
        "policy": "prima",
        "devices": {
            "both": one.both,
            "fa": one.only_fa,
            "ea": one.only_ea,
            "not_known": _gaps(one.gaps),
        },
        "delays": [
            {
                "event": delay.event,
                **_wait_data(delay),
                "response": _wait_data(delay.response) if delay.response else None,
            }
            for delay in one.delays
        ],
        "longest_unit": _price(one.longest_unit) if one.longest_unit else None,
        "leaves": [_price(held) for held in one.leaves],
        "holds": [{"place": str(place), "lasts": lasts} for place, lasts in one.holds],
        "starves": [_starving_data(starved) for starved in one.starves],
        "others": {
            "lasts": None if one.others.unknown or one.others.endless else one.others.lasts,
            "not_known": _gaps(one.others.unknown),
            "without_end": _gaps(one.others.endless),
        },
        "long": [_price(held) for held in one.long],
        "lacks": one.lacks,
    }


def _wait_data(delay: Delay) -> dict[str, Any]:
    return {
        "lasts": delay.lasts if delay.known else None,
        "at_least": delay.lasts,
        "known": delay.known,
        "what": delay.what or None,
        "place": str(delay.place) if delay.place else None,
        "devices": list(delay.devices),
        "user_speaks": delay.listens,
        "same_event": [str(place) for place in delay.after],
        "each_event": delay.each,
        "not_known": _gaps(delay.unknown),
        "without_end": _gaps(delay.endless),
    }


def _starving_data(starved: Starving) -> dict[str, Any]:
    return {
        "place": str(starved.place),
        "what": starved.what,
        "rule": starved.rule or None,
        "devices": list(starved.devices),
        "leaving": starved.leaving,
        "everything": starved.everything,
    }


def _price(held: Price) -> dict[str, Any]:
    return {
        "what": held.what,
        "place": str(held.place),
        "lasts": held.lasts if held.known else None,
        "at_least": held.lasts,
        "known": held.known,
        "devices": sorted(held.devices),
    }


def _gaps(gaps: Iterable[Gap]) -> list[dict[str, str]]:
    return [{"place": str(gap.place), "reason": gap.reason} for gap in gaps]


def _list(words: Iterable[str]) -> str:
    return ", ".join(sorted(words)) or "none"


def _seconds(lasts: int, known: bool) -> str:
    return f"up to {lasts / 1000:.1f} s" if known else f"{lasts / 1000:.1f} s or more"
