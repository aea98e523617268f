"""The pictures of the documentation, drawn from documents and runs.

Each picture is what a transcript's records say: nothing in it is placed by hand.
``python -m tools.pictures`` writes them into docs/pictures; with ``--check`` it
writes nothing, names what differs and exits with 1. It works in a checkout.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from prima import api, graph
from prima.graph.svg import applications as applications_style
from prima.language.commands import TABLE_4_2
from prima.messages import Record
from prima.transcript.colours import colours
from prima.transcript.run import run_of

ROOT = Path(__file__).resolve().parent.parent
WIDTH, LEFT = 760, 62
BAR, PITCH = 20, 34
LETTER = 5.4
"""About how wide a letter is, in pixels."""
LEGEND = (
    "grey: the stream is suspended;  dashed: it waits, by the rule named;  flag: an event;"
    "  ring: the application handles an end"
)
Point = tuple[float, float]
SEEN = 0.1
"""Seconds that are long enough to be drawn."""

STYLE = f"""
text {{ font: 10.5px sans-serif; fill: #1f2328 }}
.small {{ font-size: 9px; fill: #59636e }}
.name {{ font-weight: bold }}
.line {{ stroke: #59636e; fill: none }}
.dash {{ stroke: #59636e; fill: none; stroke-dasharray: 4 3 }}
.flag {{ fill: #59636e }}
.away {{ fill: #8c959f; fill-opacity: 0.22 }}
{applications_style()}
.none {{ fill-opacity: 0 }}
.linked {{ fill-opacity: 0; stroke-dasharray: 4 3 }}
@media (prefers-color-scheme: dark) {{
  text {{ fill: #e6edf3 }}
  .small {{ fill: #9aa4af }}
  .line, .dash {{ stroke: #9aa4af }}
  .flag {{ fill: #9aa4af }}
{applications_style(dark=True)}
}}
"""


@dataclass
class Bar:
    """Something that lasts: an AB with its loops, a wait, a stream, a floor."""

    name: str
    app: str
    begin: float
    end: float = -1.0
    text: str = ""
    cuts: list[float] = field(default_factory=list)
    """Where one loop ends and the next begins."""


# What the records say ------------------------------------------------------------------


def base(name: str) -> str:
    """An AB's name without the number of its loop."""
    return name.partition(".")[0]


def words(record: Record) -> str:
    """An AB's text, else its Command's title."""
    text, row = record.get("text"), TABLE_4_2.get(record["command"])
    return str(text or (row.title if row else record["command"]))


def between(records: list[Record], name: str, begins: str, *ends: str) -> list[Bar]:
    """From each record of a phase to the next of other phases, with the same in the field named."""
    made: list[Bar] = []
    for record in records:
        key = base(record.get(name) or "")
        if record["phase"] in ends:
            for bar in (bar for bar in made if bar.name == key and bar.end < 0):
                bar.end = record["time"]
        if record["phase"] == begins:
            made.append(Bar(key, record["app"], record["time"], text=record.get("rule") or ""))
    for bar in made:
        bar.end = finish(records) if bar.end < 0 else bar.end
    return [bar for bar in made if bar.end - bar.begin >= SEEN]


def finish(records: list[Record]) -> float:
    """When the last AB ends."""
    return max(float(record["time"]) for record in records if record["phase"] == "end")


def runs(records: list[Record]) -> list[Bar]:
    """Every AB that ran; loops that follow one another without a gap are one bar."""
    made: list[Bar] = []
    for record in records:
        name, time = base(record.get("behavior") or ""), record["time"]
        last = next((bar for bar in reversed(made) if bar.name == name), None)
        if record["phase"] == "start" and last is not None and last.end == time:
            last.cuts.append(time)
            last.end = -1.0
        elif record["phase"] == "start":
            made.append(Bar(name, record["app"], time, text=words(record)))
        elif record["phase"] in ("end", "cancel") and last is not None:
            last.end = time
    return [bar for bar in made if bar.end >= 0]


def streams(records: list[Record]) -> list[Bar]:
    """Every Communication Stream, from its first request to its end."""
    made = {bar.name: bar for bar in reversed(between(records, "tree", "request", "stream-end"))}
    return list(reversed(made.values()))


def floors(records: list[Record]) -> list[Bar]:
    """Who holds the floor, and from when to when."""
    made: list[Bar] = []
    for record in records:
        if record["phase"] == "floor":
            if made and made[-1].end < 0:
                made[-1].end = record["time"]
            if record["floor"]:
                holder = record["floor"][-1]
                app = holder.partition(":")[0]
                made.append(Bar(holder, app, record["time"], text=holder))
    return made


def talks(records: list[Record]) -> list[Bar]:
    """The streams with questions for which another application's leaving has to wait (K1)."""
    asking = {r["tree"] for r in records if r.get("command") == "q-and-a"}
    leaving = {r["app"] for r in records if r.get("leaves")}
    made = [bar for bar in streams(records) if bar.name in asking and leaving - {bar.app}]
    for bar in made:
        bar.text = f"{bar.name} engages the user (K1)"
    return made


def rows_of(bars: Iterable[Bar]) -> list[tuple[int, Bar]]:
    """Put what overlaps in time into rows; what an AB does later stays in its row if it can."""
    placed: list[tuple[int, Bar]] = []
    for bar in bars:
        busy = {row for row, one in placed if one.begin < bar.end and bar.begin < one.end}
        own = [row for row, one in placed if one.name == bar.name]
        free = [row for row in [*own, *range(len(placed) + 1)] if row not in busy]
        placed.append((free[0], bar))
    return placed


# Drawing ---------------------------------------------------------------------------------


def text(x: float, y: float, what: str, kind: str = "", space: float = WIDTH) -> str:
    """Text that begins at a point, cut to the space that it has."""
    letters = max(int(space / LETTER), 1)
    shown = what if len(what) <= letters else what[: letters - 1] + "…"
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{escape(shown)}</text>'


def box(x: float, y: float, width: float, height: float, kind: str) -> str:
    """A rectangle."""
    return (
        f'<rect class="{kind}" x="{x:.1f}" y="{y:.1f}"'
        f' width="{width:.1f}" height="{height:.1f}" rx="3"/>'
    )


def line(x1: float, y1: float, x2: float, y2: float, kind: str = "line") -> str:
    """A straight line."""
    return f'<path class="{kind}" d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}"/>'


def svg(title: str, description: str, height: float, parts: list[str]) -> str:
    """A whole picture."""
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}"'
        f' width="{WIDTH}" height="{height:.0f}" role="img" aria-labelledby="title description">'
    )
    names = f'<title id="title">{escape(title)}</title>\n<desc id="description">{escape(description)}</desc>'
    return "\n".join([head, names, f"<style>{STYLE}</style>", *parts, "</svg>\n"])


def timeline(records: list[Record], title: str, description: str) -> str:
    """A run over time: events on top, a lane for each application, floor and conversation."""
    scale = (WIDTH - LEFT - 12) / finish(records)
    parts: list[str] = []
    y = 30.0
    shades = colours(run_of(records).apps)
    for app in applications(records):
        parts.append(text(4, y + 24, app, "name"))
        drawn, rows = lane(records, app, shades[app], y, scale)
        parts += drawn
        y += rows * PITCH + 8
        drawn, rows = ropes(records, app, y, scale)
        parts += drawn
        y += rows * 12 + 10
    for label, bars in (("floor", floors(records)), ("channel", talks(records))):
        if bars:
            parts.append(text(4, y + 14, label, "name"))
        for bar in bars:
            left, wide = LEFT + bar.begin * scale, (bar.end - bar.begin) * scale
            parts.append(box(left, y + 3, wide, 15, f"s{shades[bar.app]}"))
            parts.append(text(left + 4, y + 14, bar.text, "", wide - 4))
        y += 22 if bars else 0
    flags: list[str] = []
    for record in events(records):
        x = LEFT + record["time"] * scale
        said = f"“{record['text']}”" if record.get("text") else record["event"]
        flags.append(line(x, 16, x, y + 4, "dash"))
        flags.append(f'<path class="flag" d="M{x:.1f} 16v-12l9 4l-9 4z"/>')
        flags.append(text(x + 11, 12, said))
    for second in range(int(finish(records)) + 1):
        x = LEFT + second * scale
        parts.append(line(x, y + 4, x, y + 9))
        parts.append(text(x - 3, y + 19, str(second), "small"))
    parts.append(text(4, y + 19, "seconds", "small"))
    parts.append(text(LEFT, y + 34, LEGEND, "small"))
    return svg(title, description, y + 42, flags + parts)


def lane(
    records: list[Record], app: str, shade: int, y: float, scale: float
) -> tuple[list[str], int]:
    """An application's ABs, and when they wait; how many rows they take."""
    placed = rows_of(bar for bar in runs(records) if bar.app == app)
    row_of = {bar.name: row for row, bar in placed}
    rows = 1 + max(row_of.values())
    parts = []
    for bar in between(records, "tree", "suspend", "resume", "stream-end"):
        if bar.app == app:
            wide = (bar.end - bar.begin) * scale
            parts.append(box(LEFT + bar.begin * scale, y, wide, rows * PITCH + 16, "away"))
    for bar in between(records, "behavior", "hold", "hold", "start", "cancel"):
        if bar.app == app and bar.name in row_of:
            left, middle = LEFT + bar.begin * scale, y + row_of[bar.name] * PITCH + 20
            parts.append(line(left, middle, LEFT + bar.end * scale, middle, "dash"))
            parts.append(text(left + 4, middle - 4, f"waits: {bar.text}", "small"))
    for row, bar in placed:
        left, top, wide = LEFT + bar.begin * scale, y + row * PITCH + 10, bar.end - bar.begin
        parts.append(box(left, top, wide * scale, BAR, f"s{shade}"))
        for cut in bar.cuts:
            parts.append(line(LEFT + cut * scale, top + 14, LEFT + cut * scale, top + BAR))
        parts.append(text(left + 2, top - 2, bar.name + (", loops" if bar.cuts else ""), "small"))
        parts.append(text(left + 4, top + 13, bar.text, "", wide * scale - 4))
    return parts, rows


def ropes(records: list[Record], app: str, y: float, scale: float) -> tuple[list[str], int]:
    """An application's streams as lines, with their windows; how many rows they take."""
    placed = rows_of(bar for bar in streams(records) if bar.app == app)
    parts = []
    for row, bar in placed:
        left, right, low = LEFT + bar.begin * scale, LEFT + bar.end * scale, y + row * 12
        parts += [line(left, low, right, low), line(right, low - 4, right, low + 4)]
        parts.append(text(left + 2, low + 9, f"stream {bar.name}", "small"))
        for record in records:
            if record["phase"] == "window" and record["tree"] == bar.name:
                x = LEFT + record["time"] * scale
                parts.append(f'<circle class="line" cx="{x:.1f}" cy="{low:.1f}" r="3"/>')
    return parts, 1 + max(row for row, _ in placed)


def applications(records: list[Record]) -> list[str]:
    """The applications, in the order in which they are loaded."""
    return [r["app"] for r in records if r["phase"] == "load" and r["actor"] == "mediator"]


def events(records: list[Record]) -> list[Record]:
    """Events of the user and the surroundings."""
    actors = ("user", "environment")
    return [r for r in records if r["phase"] == "event" and r["actor"] in actors]


# Working memory ------------------------------------------------------------------------------


def memory_at(records: list[Record], time: float) -> dict[str, str]:
    """The state of every AB in working memory when all that happens at a time is done."""
    asked: dict[str, Record] = {}
    state: dict[str, str] = {}
    for record in records:
        if record["time"] > time:
            break
        name = base(record.get("behavior") or "")
        if record["phase"] == "request":
            asked[name], state[name] = record, "linked"
        elif record["phase"] == "start":
            state[name] = "running"
        elif record["phase"] == "cancel" or record.get("outcome") == "done":
            state.pop(name, None)
    for name, now in state.items():
        if now == "linked" and not state.keys() & set(parents(asked[name])):
            state[name] = "waiting"
    return state


def parents(request: Record) -> list[str]:
    """The ABs that an AB waits for."""
    found = request.get("parents") or [request.get("parent") or ""]
    return [base(name) for name in found if name]


def depths(asked: dict[str, Record]) -> dict[str, int]:
    """How many ABs come before each one, along the longest way."""
    found: dict[str, int] = {}
    for name, request in asked.items():
        found[name] = 1 + max([found[parent] for parent in parents(request)], default=-1)
    return found


def places(names: list[str], depth: dict[str, int], left: float, top: float) -> dict[str, Point]:
    """Where the ABs of one application are drawn: those of one depth below one another."""
    used: Counter[int] = Counter()
    found: dict[str, Point] = {}
    for name in names:
        found[name] = (left + 4 + depth[name] * 124, top + 14 + used[depth[name]] * 48)
        used[depth[name]] += 1
    return found


def behavior(request: Record, state: str, colour: int, where: dict[str, Point]) -> list[str]:
    """One AB of working memory, with lines from those before it."""
    x, top = where[request["behavior"]]
    kind = {"running": "", "waiting": "none", "linked": "linked"}[state]
    before = [where[parent] for parent in parents(request) if parent in where]
    return [
        box(x, top, 108, 34, f"s{colour} {kind}"),
        text(x + 5, top + 14, f"{request['behavior']} {state}", "small"),
        text(x + 5, top + 27, words(request), "", 104),
        *(line(from_x + 108, from_y + 17, x, top + 17) for from_x, from_y in before),
    ]


def moment(records: list[Record], left: float, time: float) -> tuple[list[str], float]:
    """Working memory at a time, and the height that it takes."""
    asked = {r["behavior"]: r for r in records if r["phase"] == "request"}
    depth, state = depths(asked), memory_at(records, time)
    parts, y = [text(left + 4, 14, f"at {time:.2f} s", "name")], 30.0
    for app in applications(records):
        colour = colours(run_of(records).apps)[app]
        names = [name for name in state if asked[name]["app"] == app]
        where = places(names, depth, left, y)
        for name in names:
            parts += behavior(asked[name], state[name], colour, where)
        parts.append(text(left + 4, y + 8, f"{app}: one tree, one stream", "small"))
        y += 30 + 48 * max(Counter(depth[name] for name in names).values(), default=0)
    running = [name for name, now in state.items() if now == "running"]
    busy = [f"{device} by {name}" for name in running for device in asked[name]["devices"]]
    parts.append(text(left + 4, y + 4, "occupied: " + ", ".join(busy), "small"))
    return parts, y + 14


def memory(records: list[Record], title: str, description: str) -> str:
    """Working memory at the first event, and when the first AB after it has ended."""
    event = float(events(records)[0]["time"])
    after = next(float(r["time"]) for r in records if r["phase"] == "end" and r["time"] > event)
    one, other = moment(records, 0, event), moment(records, WIDTH / 2 + 6, after)
    return svg(title, description, max(one[1], other[1]), [*one[0], *other[0]])


# Files -----------------------------------------------------------------------------------------

Draw = Callable[[list[Record], str, str], str]
PICTURES: dict[str, tuple[str, Draw, str, str]] = {
    "streams": (
        "interleaved",
        timeline,
        "Two streams on one robot",
        "The tour speaks; the user touches the robot; the sentence that runs is finished. Then the"
        " reaction takes the floor and the tour is suspended. When the reaction's stream has"
        " ended, the tour goes on with the behaviour that it had not started.",
    ),
    "channel": (
        "channel",
        timeline,
        "Leaving waits for the end of the conversation",
        "While one application asks its questions, another is touched and wants to drive away. Its"
        " words come between the questions; its move waits until the conversation has ended.",
    ),
    "memory": (
        "interleaved",
        memory,
        "Working memory at two moments",
        "At the touch the tour's first behaviour runs, its others are linked, and the root of the"
        " other application's tree waits. When the first has ended, that root runs, and two"
        " behaviours of the tour wait.",
    ),
    "trees": (
        "trees",
        timeline,
        "A tree that goes on in a window, and reactions that are new trees",
        "The answer opens a window; what is requested in it belongs to the same stream. The move"
        " is a chain of loops. A reaction of the same application is a new stream beside it; a"
        " reaction of another one suspends it between two loops.",
    ),
}
"""Each picture's scenario in documents/tutorial, how it is drawn, its title and description."""


def swept(path: Path) -> str:
    """How long the robot takes, by policy, the time of the touch, and the user's answer."""
    from prima import results, sweep

    with TemporaryDirectory() as folder:
        table = Path(folder) / "sweep.csv"
        vary = {"when.at": "0s..30s/2s", "answer": ["Never mind.", "Come on, follow me."]}
        sweep(path, vary, policies=["prima", "fifo"], output=table, workers=1)
        figures = results.draw(results.read(table))
    return next(one for one in figures if one.name == "seconds").whole()


GRAPHS: dict[str, tuple[str, Callable[[Path], str]]] = {
    "graph-museum": ("ea/museum.xml", graph.picture),
    "graph-office": ("worlds/office.xml", graph.picture),
    "graph-memory": (
        "scenarios/touched-on-the-way.xml",
        lambda path: graph.tree(api.rehearse(path), 5),
    ),
    "touched": (
        "scenarios/touched-on-the-way.xml",
        lambda path: graph.streams(api.rehearse(path)),
    ),
    "graph-streams": (
        "scenarios/three-applications.xml",
        lambda path: graph.streams(api.rehearse(path)),
    ),
    "sweep": ("scenarios/touched-on-the-way.xml", swept),
}
"""The pictures of other pages: each one's document, and how it is drawn."""


def outputs(root: Path) -> dict[Path, str]:
    """Every picture of a checkout, by its file."""
    made = {}
    for name, (scenario, draw, title, description) in PICTURES.items():
        run = api.rehearse(root / "documents" / "tutorial" / f"{scenario}.xml")
        made[root / "docs" / "pictures" / f"{name}.svg"] = draw(run.records, title, description)
    for name, (path, show) in GRAPHS.items():
        made[root / "docs" / "pictures" / f"{name}.svg"] = show(root / "documents" / path)
    return made


def main(arguments: list[str], root: Path = ROOT) -> int:
    """Write the pictures, or with ``--check`` name those that differ."""
    if arguments not in ([], ["--check"]):
        print("usage: python -m tools.pictures [--check]", file=sys.stderr)
        return 2
    code = 0
    for path, made in outputs(root).items():
        if path.is_file() and path.read_text(encoding="utf-8") == made:
            continue
        name = path.relative_to(root).as_posix()
        if arguments:
            print(f"{name} differs from its run; run python -m tools.pictures", file=sys.stderr)
            code = 1
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(made, encoding="utf-8", newline="\n")
            print(f"written: {name}")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
