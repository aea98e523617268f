"""What a page tells of one run, as values: head, rows with their reasons, lanes, ways."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from prima.errors import UsageError
from prima.errors.visible import visible
from prima.messages import Json, Record
from prima.report.lanes import Lanes, make_lanes
from prima.report.walk import Walk, walk_of
from prima.transcript.criteria import observe
from prima.transcript.table import LONGEST_SHOWN, Row, describe
from prima.transcript.why import Reasons

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded

MOST_REASONS = 12
"""Reasons of each kind that a row shows, the latest."""
LONGEST_NAME = 200
"""Letters of a name that are shown."""
KANA = re.compile("[\u3041-\u30ff\u31f0-\u31ff\uff66-\uff9d]")
HAN = re.compile("[\u2e80-\u2fdf\u3400-\u4dbf\u4e00-\u9fff\uf900-\ufaff]")
HANGUL = re.compile("[\u1100-\u11ff\u3130-\u318f\uac00-\ud7af]")


@dataclass(slots=True)
class View:
    """One run, ready to be shown."""

    name: str
    """The transcript's name, as the user gave it."""
    facts: list[tuple[str, str]]
    measures: list[tuple[str, str, str]]
    """What is measured, how much of it, and what that means."""
    rows: list[Row]
    spoken: dict[int, tuple[str, str]]
    """What a row says: its words and their language, empty where nobody knows."""
    whys: list[dict[str, Json]]
    names: dict[str, list[Json]]
    """ABs and streams that the reasons name: what they do, the document's line, their first row or -1."""
    lanes: Lanes
    walk: Walk
    title: str
    files: list[tuple[str, str]] = field(default_factory=list)
    cut: str = ""


def view_of(transcript: Transcript, rows: list[Row], loaded: Loaded | None) -> View:
    """All that a page shows of a transcript.

    Raises:
        UsageError: a record lacks what its phase has, or the scenario is not the transcript's.
    """
    walk = walk_of(transcript, loaded)
    try:
        return _view(transcript, rows, loaded, walk)
    except (KeyError, TypeError, ValueError, AttributeError):
        raise UsageError(f"{transcript.name}: a record lacks what its phase has.") from None


def _view(transcript: Transcript, rows: list[Row], loaded: Loaded | None, walk: Walk) -> View:
    records = transcript.records
    head = records[0].get("data") if records[0]["phase"] == "run" else None
    head = head if isinstance(head, dict) else {}
    requests = [record for record in records if record["phase"] == "request"]
    asked = {request["behavior"]: request for request in requests}
    asked |= {request["tree"]: request for request in reversed(requests) if "tree" in request}
    whys, names = _whys(records, rows, asked)
    scenario = _short(head.get("scenario")) or transcript.name
    files = head.get("files")
    files = files if isinstance(files, dict) else {}
    view = View(
        transcript.name,
        _facts(records, head),
        _measures(records),
        rows,
        _spoken(rows, asked, _languages(records)),
        whys,
        names,
        make_lanes(records, rows),
        walk,
        f"{scenario}, policy {_short(head.get('policy')) or 'not told'}",
        [(_short(name), _short(digest)) for name, digest in list(files.items())[:200]],
        transcript.cut or transcript.early,
    )
    for row in rows:
        row.what = shown(row.what)
    return view


def shown(text: str) -> str:
    """Text for people: no control characters, and not without end."""
    text = visible(text)
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."


def _short(value: Any) -> str:
    text = visible("" if value is None else str(value))
    return text if len(text) <= LONGEST_NAME else text[:LONGEST_NAME] + "..."


ENDS = {
    "over": "all applications had ended",
    "quiet": "nothing more was to happen",
    "until": "the scenario's time was over",
    "limit": "it made more records than a run may",
}


def _facts(records: Sequence[Record], head: dict[str, Json]) -> list[tuple[str, str]]:
    """What a transcript's head and end tell of the run."""
    apps = []
    for record in records:
        if record["phase"] == "load" and record["actor"] == "mediator":
            kind = (record.get("data") or {}).get("kind")
            apps.append(record["app"] + (f" ({str(kind).upper()})" if kind else ""))
    apps = list(dict.fromkeys(apps))
    last = records[-1]
    outcome = last.get("outcome") or "" if last["phase"] == "over" else ""
    end = ENDS.get(outcome, outcome) if outcome else "the transcript is cut off"
    told = [
        ("Scenario", _short(head.get("scenario"))),
        ("Policy", _short(head.get("policy"))),
        ("Bound (E4)", _short(head.get("bound"))),
        ("Patience (E6), in seconds", _short(head.get("patience"))),
        ("Applications", _short(", ".join(apps))),
        ("Date of the run", _short(head.get("date"))),
        ("PRIMA", _short(head.get("version"))),
        ("Length", f"{last['time']:.2f} s; {_short(end)}"),
    ]
    return [(name, value) for name, value in told if value]


def _starved(records: Sequence[Record]) -> list[tuple[str, str, str]]:
    """What another application has kept waiting for too long, if anything."""
    count = sum(record["phase"] == "starve" for record in records)
    told = "behaviours that another application has kept waiting for too long (E4, E6)"
    return [("Starved", str(count), told)] if count else []


def _measures(records: Sequence[Record]) -> list[tuple[str, str, str]]:
    """The measures of docs/measures.md."""
    found = observe(records)
    reaction = f"{found.reaction_mean:.2f} / {found.reaction_max:.2f} s"
    response = f"{found.response_mean:.2f} / {found.response_max:.2f} s"
    return [
        ("Units cut", str(found.units_cut), "behaviours that lost a device while they ran"),
        ("Restarts", str(found.restarts), "behaviours that gave way to a reaction (X2)"),
        ("Broken", str(found.broken), "streams broken by no reaction"),
        ("Waiting", str(found.broken_waiting), "waits for a server that were broken"),
        ("Unfaced", str(found.unfaced), "conversations begun without the channel"),
        ("Left", str(found.left), "conversations that the robot left"),
        *_starved(records),
        ("Reactions", str(found.reactions), "events that were answered with a Command"),
        ("Reaction time", reaction, "mean and longest, from the event to the first Command"),
        (
            "Response time",
            response,
            "mean and longest, from the event to the first word or movement towards the user",
        ),
    ]


# What is said, and in which language ---------------------------------------------------------


def _spoken(
    rows: Iterable[Row], asked: dict[str, Record], own: dict[str, str]
) -> dict[int, tuple[str, str]]:
    """The words of each row that says something, with their language; ``own`` are applications'."""
    alike = set(own.values())
    common = next(iter(alike)) if len(alike) == 1 else ""
    said: dict[int, tuple[str, str]] = {}
    for row in rows:
        if row.kind == "speech":
            said[row.number] = (row.what[1:-1], common)
            continue
        request = asked.get(row.behavior.partition(".")[0])
        text = request.get("text") if request is not None else None
        if text and f'"{text}"' in row.what:
            said[row.number] = (text, own.get(row.app, ""))
    japanese = any(KANA.search(text) for text, _ in said.values())
    return {
        number: (shown(text), lang or language(text, japanese))
        for number, (text, lang) in said.items()
    }


def _languages(records: Iterable[Record]) -> dict[str, str]:
    """The languages of applications, as far as the transcript tells."""
    loads = [r for r in records if r["phase"] == "load" and r["actor"] == "mediator"]
    told = {record["app"]: (record.get("data") or {}).get("lang") for record in loads}
    return {app: lang for app, lang in told.items() if isinstance(lang, str)}


def language(text: str, japanese: bool = False) -> str:
    """A text's language as far as its script tells; ``japanese`` settles Chinese characters."""
    if KANA.search(text):
        return "ja"
    if HANGUL.search(text):
        return "ko"
    if HAN.search(text):
        return "ja" if japanese else "zh"
    return ""


# Why -----------------------------------------------------------------------------------------


def _whys(
    records: Sequence[Record], rows: Sequence[Row], asked: dict[str, Record]
) -> tuple[list[dict[str, Json]], dict[str, list[Json]]]:
    """Why each row came where it did, and what the ABs are that are named there."""
    reasons = Reasons(records)
    first: dict[str, int] = {}
    for row in rows:
        if row.behavior:
            first.setdefault(row.behavior.partition(".")[0], row.number)
    places = {(row.time, row.kind): row.number for row in reversed(rows)}
    events: dict[int, int] = {}
    for record in records:
        if record["phase"] == "event" and record.get("serial"):
            number = places.get((record["time"], record["event"]))
            if number is not None:
                events[record["serial"]] = number
    whys: list[dict[str, Json]] = []
    names: dict[str, list[Json]] = {}
    for row in rows:
        base = row.behavior.partition(".")[0]
        found = reasons.of(row, MOST_REASONS)
        why: dict[str, Json] = {}
        if row.source:
            why["source"] = _short(row.source)
        if row.actor != "R":
            why["outside"] = True
        cause = (asked.get(base) or {}).get("cause")
        if cause in events:
            why["cause"] = events[cause]
        told: list[Json] = []
        for reason in found:
            rivals: list[Json] = []
            for name in (*reason.lost, reason.by):
                one = name.partition(".")[0]
                if not one or one == base:
                    continue
                if one not in names:
                    names[one] = _named(one, asked, first)
                rivals.append(one)
            told.append([reason.time, shown(reason.text), _short(reason.rule), rivals])
        if told:
            why["told"] = told
        whys.append(why)
    return whys, names


def _named(name: str, asked: dict[str, Record], first: dict[str, int]) -> list[Json]:
    """What an AB is that a reason names, or the first AB of a stream."""
    request = asked.get(name)
    if request is None:
        return ["the transcript does not tell what it is", "", -1]
    text = describe(request["command"], request.get("text"), request.get("args"))
    words = "a unit" if request["command"] == "iu" else shown(text)
    words = f"the stream that began with {words}" if name == request.get("tree") else words
    return [words, _short(request.get("source")), first.get(request["behavior"], -1)]
