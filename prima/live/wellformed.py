"""Drivers' reports in a form that records can hold: a journal stays readable whatever they say."""

from __future__ import annotations

import json
from math import isfinite
from numbers import Integral, Real
from typing import Any, get_args, get_type_hints

from prima.devices.goals import At, Back, Broke, Done, Lost, News, Report, Sees, Speaks, Stopped
from prima.errors import brief, one_of
from prima.messages import Data, Emergency, Heard, Json, Narrated, Occurred, Sensed

OCCURRED = frozenset(get_args(get_type_hints(Occurred)["actor"])) - {"mediator"}
NARRATED = frozenset(get_args(get_type_hints(Narrated)["actor"]))
"""The actors that may cause an event, and those of a note for the reader."""
EMERGENCY = ("emergency.stop", "emergency.release")
"""Events that applications get when the run has stopped, or goes on: by themselves they stop nothing."""


WRONG = (TypeError, ValueError, OverflowError, RecursionError)
"""The exceptions raised for something that no record can hold."""
MOST = 1_000_000
"""Maximum number of characters of a report's text, and of its data as JSON."""
REASON = 4_000
"""Characters of a reason above which its middle is left out: a library may give a whole page."""


def well_formed(report: Report | News) -> Report | News | None:
    """A driver's report in a form that records can hold.

    A measurement that is NaN or infinite becomes None. A pose that contains one is not reported
    at all.

    Raises:
        TypeError, ValueError, OverflowError, RecursionError: no record can hold it.
    """
    return _report(report) if isinstance(report, Report) else _news(report)


def _report(report: Report) -> Report:
    if isinstance(report, Lost | Back):
        _check_devices(report.devices)
    else:
        _text(report.key)
    match report:
        case Done():
            return Done(report.key, _data(report.data))
        case Stopped():
            said = None if report.said is None else int(report.said)
            return Stopped(report.key, _number(report.share), said)
        case Broke():
            return Broke(
                report.key, _text(report.device), brief(_text(report.reason), REASON), report.lacks
            )
        case Lost():
            return Lost(report.devices, brief(_text(report.reason), REASON))
    return report


def _news(news: News) -> News | None:
    match news:
        case Sensed():
            return Sensed(_data(news.values))
        case Sees():
            return Sees(_flag(news.visible), _number(news.distance), _number(news.angle))
        case At():
            return _pose(news)
        case Speaks():
            return Speaks(_flag(news.begins))
        case Emergency():
            return Emergency(_flag(news.pressed), _flag(news.resume))
        case Heard():
            data = _data(news.data)
            if "lasted" in data:
                raise ValueError("how long it lasted is not among its data: Heard(text, data, ms)")
            return Heard(_short(news.text), data, int(news.lasted))
        case Occurred():
            return _occurred(news)
        case Narrated():
            _check_actor(news.actor, NARRATED)
            return Narrated(news.actor, _short(news.text))
    if not isinstance(news, News):
        raise TypeError(f"a driver reports {one_of(kind.__name__ for kind in get_args(News))}")
    return news


def _pose(news: At) -> At | None:
    pose = (news.x, news.y, news.heading)
    return At(*map(float, pose)) if all(map(isfinite, pose)) else None


def _occurred(news: Occurred) -> Occurred:
    _check_actor(news.actor, OCCURRED)
    if (news.name, news.actor) == ("speech", "user"):
        raise ValueError("report the user's words by Heard(text)")
    if news.name in EMERGENCY:
        how = 'by Emergency(True), in <senses> by as="emergency"'
        raise ValueError(f"report the emergency stop {how}")
    app = None if news.app is None else _short(news.app)
    return Occurred(_short(news.name), news.actor, _data(news.data), app)


def _check_actor(actor: str, actors: frozenset[str]) -> None:
    if actor not in actors:
        raise ValueError(f"its actor must be {one_of(actors)}")


def _check_devices(devices: Any) -> None:
    if not isinstance(devices, set | frozenset):
        raise TypeError(f"its devices must be a set, not {type(devices).__name__}")
    for name in devices:
        _text(name)


def _flag(value: Any) -> bool:
    """Whether something holds: a library may report this as a number, or as a type of its own."""
    if value is None or isinstance(value, str):
        raise TypeError(f"whether it holds must be a bool, not {type(value).__name__}")
    return bool(value)


def _data(value: Any) -> Data:
    if not isinstance(value, dict):
        raise TypeError(f"its data must be a dict, not {type(value).__name__}")
    data = {_text(name): _plain(one) for name, one in value.items()}
    _short(json.dumps(data))
    return data


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"its texts and names must be str, not {type(value).__name__}")
    value.encode()  # half a letter is invalid
    return value


def _short(value: Any) -> str:
    if len(text := _text(value)) > MOST:
        raise ValueError(f"it has more than {MOST:,} characters")
    return text


def _number(value: Any) -> float | None:
    number = None if value is None else float(value)
    return number if number is not None and isfinite(number) else None


def _plain(value: Any) -> Json:
    match value:
        case None | bool():
            return value
        case str():
            return _text(value)
        case Integral():
            float(value)  # other programs could not read what is larger
            return int(value)
        case Real():
            return _number(value)
        case dict():
            return {_text(name): _plain(one) for name, one in value.items()}
        case list() | tuple():
            return [_plain(one) for one in value]
    if callable(item := getattr(value, "item", None)):
        return _plain(item())  # a boolean of NumPy
    raise TypeError(f"a record cannot hold {type(value).__name__}")
