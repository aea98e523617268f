"""The content of a page for one run: facts, rows with reasons, lanes, walk."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any

from prima.errors.visible import visible
from prima.messages import Json
from prima.report.lanes import LONGEST_NAME, Lanes, make_lanes
from prima.report.walk import RobotWalk, walk_of
from prima.transcript.criteria import CRITERIA, HEADINGS, MEANINGS, shown_times
from prima.transcript.row import Row, describe
from prima.transcript.run import Run
from prima.transcript.spans import base
from prima.transcript.table import LONGEST_SHOWN
from prima.transcript.why import Reason, origin, reasons

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded

MOST_REASONS = 12
"""Maximum number of reasons of each kind; the latest are shown."""
KANA = re.compile("[\u3041-\u30ff\u31f0-\u31ff\uff66-\uff9d]")
HAN = re.compile("[\u2e80-\u2fdf\u3400-\u4dbf\u4e00-\u9fff\uf900-\ufaff]")
HANGUL = re.compile("[\u1100-\u11ff\u3130-\u318f\uac00-\ud7af]")


@dataclass(slots=True)
class View:
    """One run, ready to be rendered."""

    name: str
    """The transcript's name, as the user gave it."""
    facts: list[tuple[str, str]]
    measures: list[tuple[str, str, str]]
    """Measures: name, value and meaning."""
    rows: list[Row]
    spoken: dict[int, tuple[str, str]]
    """The text that a row says and its language, empty if unknown."""
    whys: list[dict[str, Json]]
    names: dict[str, list[Json]]
    """ABs and streams that the reasons name: what they do, the document's line, their first row or -1."""
    lanes: Lanes
    walk: RobotWalk
    title: str
    files: list[tuple[str, str]] = field(default_factory=list)
    cut: str = ""


def view_of(transcript: Transcript, rows: list[Row], loaded: Loaded | None) -> View:
    """The content of a page for a transcript.

    Raises:
        UsageError: a record lacks a field of its phase, or the scenario is not the transcript's.
    """
    walk, run = walk_of(transcript, loaded), transcript.run()
    head = run.head
    whys, names = _whys(run, rows)
    scenario = _short(head.get("scenario")) or transcript.name
    files = head.get("files")
    files = files if isinstance(files, dict) else {}
    view = View(
        transcript.name,
        _facts(run),
        _measures(run),
        rows,
        _spoken(rows, run),
        whys,
        names,
        make_lanes(run, rows),
        walk,
        f"{scenario}, policy {_short(head.get('policy')) or 'unknown'}",
        [(_short(name), _short(digest)) for name, digest in list(files.items())[:200]],
        transcript.cut or transcript.early,
    )
    for row in rows:
        row.what = shown(row.what)
    return view


def shown(text: str) -> str:
    """Text of limited length without control characters."""
    text = visible(text)
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."


def _short(value: Any) -> str:
    text = visible("" if value is None else str(value))
    return text if len(text) <= LONGEST_NAME else text[:LONGEST_NAME] + "..."


ENDS = {
    "over": "all applications had ended",
    "quiet": "nothing left to do",
    "until": "the scenario's time was over",
    "limit": "too many records",
}


def _facts(run: Run) -> list[tuple[str, str]]:
    """Facts of a run from its first and last records."""
    head = run.head
    apps = []
    for one in run.started:
        kind = one.data.get("kind")
        apps.append(one.app + (f" ({str(kind).upper()})" if kind else ""))
    apps = list(dict.fromkeys(apps))
    last = run.entries[-1]
    outcome = last.outcome if last.phase == "over" else ""
    end = ENDS.get(outcome, outcome) if outcome else "the transcript is cut off"
    facts = [
        ("Scenario", _short(head.get("scenario"))),
        ("Policy", _short(head.get("policy"))),
        ("Bound (E4)", _short(head.get("bound"))),
        ("Patience (E6), in seconds", _short(head.get("patience"))),
        ("Seed", _short(head.get("seed"))),
        ("Applications", _short(", ".join(apps))),
        ("Date of the run", _short(head.get("date"))),
        ("PRIMA", _short(head.get("version"))),
        ("Length", f"{last.time:.2f} s; {_short(end)}"),
    ]
    return [(name, value) for name, value in facts if value]


RARE = frozenset({"third_turns", "misanswered", "wordless", "late_reactions"})
"""Criteria that are shown only if there is something to count."""
FROM = "mean and longest, from the event to the first"


def _measures(run: Run) -> list[tuple[str, str, str]]:
    """The measures of docs/measures.md."""
    found, starved = run.measure.criteria(), len(run.of("starve"))
    waiting = "behaviors that another application has kept waiting for too long (E4, E6)"
    reaction = shown_times(found.reaction_mean, found.reaction_max)
    response = shown_times(found.response_mean, found.response_max)
    counts = [
        (HEADINGS[name].capitalize(), str(number), MEANINGS[name])
        for name in CRITERIA
        if isinstance(number := getattr(found, name), int) and (number or name not in RARE)
    ]
    return [
        *counts,
        *([("Starved", str(starved), waiting)] if starved else []),
        ("Reaction time", reaction, f"{FROM} Command"),
        ("Response time", response, f"{FROM} word or movement towards the user"),
    ]


# What is said, and in which language ---------------------------------------------------------


def _spoken(rows: Iterable[Row], run: Run) -> dict[int, tuple[str, str]]:
    """The words of each row that says something, with their language."""
    own = run.languages
    alike = set(own.values())
    common = next(iter(alike)) if len(alike) == 1 else ""
    heard = (one.text for one in run.of("event") if one.spoken)  # each has a row, in this order
    said: dict[int, tuple[str, str]] = {}
    for row in rows:
        if row.kind == "speech":
            text, lang = next(heard, ""), common
        else:
            request = run.asked(row.behavior)
            text, lang = request.text if request is not None else "", own.get(row.app, "")
        if text and f'"{text}"' in row.what:
            said[row.number] = (text, lang)
    japanese = any(KANA.search(text) for text, _ in said.values())
    return {
        number: (shown(text), lang or language(text, japanese))
        for number, (text, lang) in said.items()
    }


def parted(row: Row, words: str) -> tuple[str, str, str]:
    """A row's text before, in and after the words said, which are in quotation marks."""
    place = row.what.find(f'"{words}"') + 1 if words else 0
    end = place + len(words) if place else 0
    return row.what[:place], row.what[place:end], row.what[end:]


def language(text: str, japanese: bool = False) -> str:
    """A text's language according to its script; ``japanese`` decides for Chinese characters."""
    if KANA.search(text):
        return "ja"
    if HANGUL.search(text):
        return "ko"
    if HAN.search(text):
        return "ja" if japanese else "zh"
    return ""


# Why -----------------------------------------------------------------------------------------


def _whys(run: Run, rows: Sequence[Row]) -> tuple[list[dict[str, Json]], dict[str, list[Json]]]:
    """The reasons for each row, and descriptions of the ABs that they name."""
    first = {base(row.behavior): row.number for row in reversed(rows) if row.behavior}
    events = _event_rows(run, rows)
    whys: list[dict[str, Json]] = []
    names: dict[str, list[Json]] = {}
    for row in rows:
        explained = [_reason(reason, row) for reason in reasons(run, row, MOST_REASONS)]
        whys.append(_why(run, row, events, explained))
        for name in chain.from_iterable(rivals for *_, rivals in explained):
            if name not in names:
                names[name] = _named(name, run, first)
    return whys, names


def _event_rows(run: Run, rows: Iterable[Row]) -> dict[int, int]:
    """The rows of events by their serial numbers; events of one name and instant are in order."""
    places: dict[tuple[float, str], list[int]] = {}
    for row in rows:
        places.setdefault((row.time, row.kind), []).append(row.number)
    found: dict[int, int] = {}
    for serial, event in run.events.items():
        if serial and (there := places.get((event.time, event.event))):
            found[serial] = there.pop(0) if len(there) > 1 else there[0]
    return found


def _why(
    run: Run, row: Row, events: Mapping[int, int], explained: Sequence[Json]
) -> dict[str, Json]:
    """The reasons of a row: its place in a document, the event behind it, and decisions."""
    asked = run.asked(row.behavior)
    why: dict[str, Json] = {}
    if row.source:
        why["source"] = _short(row.source)
    if text := origin(row):
        why["origin"] = shown(text)
    if asked is not None and asked.cause and asked.cause in events:
        why["cause"] = events[asked.cause]
    if explained:
        why["reasons"] = explained
    return why


def _reason(reason: Reason, row: Row) -> list[Any]:
    """A reason: time, text, rule, and the other ABs that it names."""
    others = (base(name) for name in (*reason.lost, reason.by))
    rivals = [one for one in others if one and one != base(row.behavior)]
    return [reason.time, shown(reason.text), _short(reason.rule), rivals]


def _named(name: str, run: Run, first: dict[str, int]) -> list[Json]:
    """The description of an AB that a reason names, or of a stream."""
    stream = run.streams.get(name)
    request = stream.asked if stream is not None else run.asked(name)
    if request is None:
        return ["not in the transcript", "", -1]
    text = describe(request.command, request.text, request.args)
    words = "a unit" if request.command == "iu" else shown(text)
    words = f"the stream that began with {words}" if stream is not None else words
    return [words, _short(request.source), first.get(request.behavior, -1)]
