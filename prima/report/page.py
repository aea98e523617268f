"""The page as text: everything that a document or transcript says is escaped here."""

from __future__ import annotations

from collections.abc import Sequence
from string import Template

from prima.errors import counted
from prima.report.data import page_data
from prima.report.lanes import LONGEST_NAME
from prima.report.parts import described, json_text, part, policy_of, style_of, text
from prima.report.view import View, parted
from prima.transcript import colours
from prima.transcript.colours import NOBODY
from prima.transcript.diff import MARKS, Change, Difference, compare, remark, summary_line
from prima.transcript.row import Row

ROOM = "prima.report"
WHO = {"R": "robot", "U": "user", "E": "surroundings"}
LETTERS = "AB"
PART = 50
"""The number of rows in each part of a table."""
KINDS = {
    "moved": "comes in another order",
    "added": "is new",
    "lost": "is gone",
    "split": "an interrupted Command goes on here, as it did not before",
    "joined": "is no longer split here",
    "changed": "says something else",
    "delayed": "comes at least half a second later or earlier",
}


def page(views: Sequence[View]) -> str:
    """The page of one run, or of two with their differences."""
    difference = compare(views[0].rows, views[1].rows) if len(views) == 2 else None
    shades = colours.colours(app for view in views for app in view.lanes.every)
    style, script = style_of(ROOM, "report.css"), part(ROOM, "report.js")
    title = " and ".join(view.title for view in views)
    body = {
        "title": text(title),
        "heading": text("Two runs compared" if difference else title),
        "policy": policy_of(style, script),
        "style": style,
        "script": script,
        "kind": "two" if difference else "one",
        "heads": "".join(_head(view, index, len(views)) for index, view in enumerate(views)),
        "figures": "".join(_figure(index, len(views)) for index in range(len(views))),
        "maps": "".join(_map(view, index, len(views)) for index, view in enumerate(views)),
        "filter": _filter(views),
        "table": (
            _differences(views, difference, shades) if difference else _table(views[0], shades)
        ),
        "data": json_text(page_data(views, difference, shades)),
    }
    return Template(part(ROOM, "template.html")).substitute(body)


# Heads ---------------------------------------------------------------------------------------


def _named(index: int, runs: int) -> str:
    return f"Run {LETTERS[index]}" if runs > 1 else "The run"


def _head(view: View, index: int, runs: int) -> str:
    measures = described((name, value) for name, value, _ in view.measures)
    meanings = "".join(f"<li>{text(a)}: {text(c)}</li>" for a, _, c in view.measures)
    listed = "".join(
        f"<li>{text(name)} <code>{text(digest[:12])}</code></li>" for name, digest in view.files
    )
    held = f"<p>Files, with the beginning of their digests:</p><ul>{listed}</ul>" if listed else ""
    cut = f'<p class="cut">The transcript is not whole: {text(view.cut)}</p>' if view.cut else ""
    name = _named(index, runs)
    lower = name.lower() if runs == 1 else name
    title = f'{text(name)}: <span class="run-title">{text(view.title)}</span>' if runs > 1 else name
    return (
        f'<section class="run-head" aria-labelledby="head-{index}">'
        f'<h2 id="head-{index}">{title}</h2>{cut}'
        f'<div class="strip" role="group" tabindex="0" aria-label="Measures of {text(lower)}">'
        f'<dl class="measures">{measures}</dl></div>'
        f'<details class="about"><summary>About {text(lower)}, and what is counted</summary>'
        f'<dl class="facts">{described(view.facts)}</dl><ul>{meanings}</ul>'
        f"<p>Made from {text(view.name)}.</p>{held}</details>"
        "</section>\n"
    )


def _figure(index: int, runs: int) -> str:
    label = f"Timeline of run {LETTERS[index]}" if runs > 1 else "Timeline"
    heading = f"<h3>{_named(index, runs)}</h3>" if runs > 1 else ""
    return (
        f'{heading}<div class="timeline" id="timeline-{index}" tabindex="0" role="group"'
        f' aria-label="{label}" aria-describedby="keys"></div>\n'
    )


def _map(view: View, index: int, runs: int) -> str:
    if view.walk.source == "run":
        caption = "Places as the simulation had them when the run was made again."
    elif view.walk.plan is not None:
        caption = (
            "The run could not be made again alike, so only the places that the robot"
            " reported are shown; between them its way is a straight line."
        )
    elif view.walk.robot:
        caption = (
            "Only the places that the robot reported: a transcript holds neither the map nor"
            " the user's way. prima report with --scenario shows both."
        )
    else:
        caption = (
            "The robot reported no places in this run."
            " prima report with --scenario shows the map and the user."
        )
    drawn = bool(view.walk.robot or view.walk.plan)
    frame = f'<div class="map" id="map-{index}"></div>' if drawn else ""
    label = f"<h3>{_named(index, runs)}</h3>" if runs > 1 else ""
    return (
        f'<div class="place">{label}{frame}<p class="note">{caption}</p>'
        f'<h3 class="now-head">At <span class="clock"></span></h3>'
        f'<ul class="now" id="now-{index}"></ul></div>\n'
    )


def _filter(views: Sequence[View]) -> str:
    """The filter for rows of the table: application, who, and text."""
    apps = dict.fromkeys(app for view in views for app in view.lanes.every)
    named = "".join(
        f'<option value="{text(app[:LONGEST_NAME])}">{text(app[:LONGEST_NAME])}</option>'
        for app in apps
    )
    whos = "".join(f'<option value="{key}">{who}</option>' for key, who in WHO.items())
    return (
        '<form class="filter" role="search" aria-label="Filter of rows" hidden>'
        f'<label>Application <select id="by-app"><option value="">all</option>{named}</select></label>'
        f'<label>Who <select id="by-who"><option value="">all</option>{whos}</select></label>'
        '<label>Text <input type="search" id="by-text" autocomplete="off" spellcheck="false"></label>'
        '<output id="found" aria-live="polite"></output></form>'
    )


# Tables --------------------------------------------------------------------------------------


def _what(view: View, row: Row) -> str:
    """The description of a row, with the language of its speech."""
    said = view.spoken.get(row.number)
    if said is None:
        return text(row.what)
    words, lang = said
    before, found, after = parted(row, words)
    if not found:
        return text(row.what)
    return f'{text(before)}<bdi lang="{text(lang)}">{text(found)}</bdi>{text(after)}'


def _marks(row: Row) -> str:
    """The marks before the number in the printed table, in words."""
    made = []
    if row.star:
        made.append("<span>loops</span>")
    if row.bracket:
        made.append("<span>unit</span>")
    if row.event:
        made.append("<span>event</span>")
    return f' <span class="marks">{" ".join(made)}</span>' if made else ""


def _who(row: Row, shades: dict[str, int]) -> str:
    """The two cells for who does it: the actor, and the application."""
    who = WHO.get(row.actor, "")
    if not row.app:  # a narrow page has only the second
        return f'<td role="cell">{who}</td><td role="cell"><span class="narrow">{who}</span></td>'
    number = shades.get(row.app, NOBODY)
    return f'<td role="cell">{who}</td><td role="cell" class="app app{number}">{text(row.app)}</td>'


def _row(number: int, kind: str, label: str, cells: str) -> str:
    """A row that can be opened. The roles keep it a table row whatever its style."""
    return (
        f'<tr role="row" id="row-{number}" class="row {kind}"><th role="rowheader" scope="row">'
        '<button type="button" class="open" tabindex="-1" aria-expanded="false">'
        f"{label}</button></th>{cells}</tr>"
    )


def _whole_table(kind: str, caption: str, heads: Sequence[tuple[str, str]], rows: list[str]) -> str:
    """A table with rows in parts: a browser need not lay out those out of sight."""
    parts = "\n".join(
        f'<tbody role="rowgroup">{"".join(rows[place : place + PART])}</tbody>'
        for place in range(0, len(rows), PART)
    )
    head = "".join(
        f'<th role="columnheader" scope="col" class="{name}">{title}</th>' for title, name in heads
    )
    return (
        f'<table role="table" class="rows{kind}"><caption>{text(caption)}</caption>'
        f'<thead role="rowgroup"><tr role="row">{head}</tr></thead>\n{parts}</table>'
    )


def _table(view: View, shades: dict[str, int]) -> str:
    """The complete table of the transcript, readable, searchable and printable without scripts."""
    lines = [
        _row(
            row.number,
            f"who-{row.actor}",
            str(row.number),
            f'<td role="cell" class="time">{row.time:.2f}</td>{_who(row, shades)}'
            f'<td role="cell" class="what">{_what(view, row)}{_marks(row)}</td>'
            f'<td role="cell">{text(row.rule)}</td>',
        )
        for row in view.rows
    ]
    caption = f"What was done, by whom, and by which rule. {counted(len(view.rows), 'row')}."
    heads = [
        ("Row", "first"),
        ("Seconds", "time"),
        ("Who", "who"),
        ("Application", "by"),
        ("Behaviour", "what"),
        ("Rule", "rule"),
    ]
    return _whole_table("", caption, heads, lines)


def _differences(views: Sequence[View], difference: Difference, shades: dict[str, int]) -> str:
    """Both transcripts side by side, in the order of the second."""
    lines = [
        _change(views, shades, index, change) for index, change in enumerate(difference.changes)
    ]
    counts = difference.counts
    listed = "".join(
        f"<li>{_badge(kind)} {counts[kind]}: {meaning}</li>"
        for kind, meaning in KINDS.items()
        if counts[kind]
    )
    found = f'<ul class="counts">{listed}</ul>' if listed else "<p>The two runs are alike.</p>"
    choice = (
        '<p class="choice"><label><input type="checkbox" id="only"> Show only what differs'
        "</label></p>"
    )
    caption = f"What both runs did, from run A to run B: {summary_line(difference)}."
    heads = [
        ("Change", "first"),
        ("Seconds in A", "time"),
        ("Seconds in B", "time"),
        ("Who", "who"),
        ("Application", "by"),
        ("Behaviour", "what"),
    ]
    return f"{found}{choice}{_whole_table(' diff', caption, heads, lines)}"


def _badge(kind: str) -> str:
    mark = MARKS[kind]  # type: ignore[index]
    return f'<span class="kind {kind}"><span aria-hidden="true">{text(mark)}</span> {kind}</span>'


def _change(views: Sequence[View], shades: dict[str, int], index: int, change: Change) -> str:
    row, view = change.after or change.before, views[1 if change.after else 0]
    assert row is not None
    note = remark(change)
    said = f' <span class="remark">({text(note)})</span>' if note else ""
    label = _badge(change.kind) if change.kind != "same" else '<span class="kind">same</span>'
    return _row(
        index,
        f"kind-{change.kind}",
        f'{label}<span class="hidden">, row {index}</span>',
        f"{_time(change.before)}{_time(change.after)}{_who(row, shades)}"
        f'<td role="cell" class="what">{_what(view, row)}{_marks(row)}{said}</td>',
    )


def _time(row: Row | None) -> str:
    if row is None:
        return '<td role="cell" class="time"><span aria-hidden="true">–</span></td>'
    number = f'<span class="number">#{row.number}</span>'
    return f'<td role="cell" class="time">{row.time:.2f} {number}</td>'
