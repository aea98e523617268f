"""The data of a page: lists for its script."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from prima.errors.visible import visible
from prima.report.lanes import LONGEST_NAME, Bar, Lanes
from prima.report.view import View, parted
from prima.scheduler.policy import BASELINES
from prima.transcript.colours import NOBODY
from prima.transcript.diff import MARKS, Difference
from prima.transcript.row import Row
from prima.transcript.rules import RULES


def page_data(
    views: Sequence[View], difference: Difference | None, shades: dict[str, int]
) -> dict[str, Any]:
    """The data of a page: its runs, the rules that they name, and the differences."""
    used = set().union(*map(_rules, views))
    known = RULES | dict.fromkeys(BASELINES, "the baseline policy of that name")
    data: dict[str, Any] = {
        "runs": [_run(view, shades) for view in views],
        "nobody": NOBODY,
        "rules": {rule: known[rule] for rule in sorted(used) if rule in known},
    }
    if difference is not None:
        data["changes"] = [
            [
                change.kind,
                change.before.number if change.before else -1,
                change.after.number if change.after else -1,
            ]
            for change in difference.changes
        ]
        data["marks"] = MARKS
    return data


def _rules(view: View) -> set[str]:
    """The rules that rows and reasons name."""
    explained = [one for why in view.whys for one in why.get("reasons", [])]
    return {row.rule for row in view.rows} | {one[2] for one in explained}


def _run(view: View, shades: dict[str, int]) -> dict[str, Any]:
    lanes = view.lanes
    return {
        "title": visible(view.title),
        "seconds": lanes.seconds,
        "apps": [visible(app[:LONGEST_NAME]) for app in lanes.apps],
        "colours": [shades[app] for app in lanes.apps],
        "devices": [visible(device)[:LONGEST_NAME] for device in lanes.devices],
        "rows": [_row_data(view, row) for row in view.rows],
        "whys": view.whys,
        "names": view.names,
        "bars": [_bar(bar, lanes) for bar in lanes.behaviors],
        "away": [_bar(bar, lanes) for bar in lanes.away],
        "held": [_bar(bar, lanes) for bar in lanes.held],
        "floor": [_bar(bar, lanes) for bar in lanes.floor],
        "streams": [_bar(bar, lanes) for bar in lanes.streams],
        "walk": asdict(view.walk),
    }


def _row_data(view: View, row: Row) -> list[Any]:
    """Time, who, application, what, whether an event; for speech its language and place."""
    made = [row.time, row.actor, visible(row.app[:LONGEST_NAME]), row.what, int(row.event)]
    words, lang = view.spoken.get(row.number, ("", ""))
    before, found, _ = parted(row, words)
    return [*made, lang, _units(before), _units(found)] if found else made


def _units(words: str) -> int:
    """The length of a text in JavaScript, which counts in UTF-16."""
    return len(words.encode("utf-16-le")) // 2


def _bar(bar: Bar, lanes: Lanes) -> list[Any]:
    """Begin, end, name, application, text, row, devices, cuts."""
    app = lanes.apps.index(bar.app) if bar.app in lanes.apps else -1
    devices = [lanes.devices.index(one) for one in bar.devices if one in lanes.devices]
    words = visible(bar.text)
    words = words if len(words) <= 300 else words[:300] + "…"
    return [
        bar.begin,
        bar.end,
        visible(bar.name)[:LONGEST_NAME],
        app,
        words,
        bar.row,
        devices,
        bar.cuts,
    ]
