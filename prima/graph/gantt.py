"""The picture of Communication Streams over time, with a row for each."""

from __future__ import annotations

from html import escape

from prima.graph.run import History, in_words
from prima.graph.svg import box, fit, line, measure, picture, text
from prima.transcript.colours import NOBODY
from prima.transcript.spans import StreamPiece, StreamSpan

ROW, BAR = 26.0, 14.0
MARGIN = 18.0
PLOT = 860.0
"""Width of the time axis."""
STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600, 7200, 14400)
MOST_APPS = 4
"""Maximum number of applications in the legend."""
LEGEND = (
    ("away", "suspended, then resumed"),
    ("broken", "broken by no reaction"),
    ("line", "open, nothing of it runs"),
)


def draw(history: History) -> str:
    """The streams' history as SVG."""
    names = [stream.name for stream in history.streams]
    left = MARGIN + min(max([measure(name, 11.5) for name in names], default=0) + 12, 240)
    end = max(history.end, 0.001)
    scale = PLOT / end
    width = left + PLOT + MARGIN + 30
    top = MARGIN + 30
    bottom = top + ROW * len(names)
    parts = [text(MARGIN, MARGIN + 8, history.title, "name"), *_axis(left, end, top, bottom)]
    for number, stream in enumerate(history.streams):
        shade = history.shades.get(stream.app, NOBODY)
        parts += _row(stream, shade, left, top + ROW * number, scale)
    x, y = MARGIN, bottom + 40
    for kind, words in [*_applications(history), *LEGEND]:
        mark = line(x, y - 4, x + 22, y - 4) if kind == "line" else box(x, y - 10, 22, 12, kind, 2)
        parts += [mark, text(x + 28, y, words, "small")]
        x += 46 + measure(words, 10)
    return picture(history.title, describe(history), width, y + MARGIN, parts)


def _axis(left: float, end: float, top: float, bottom: float) -> list[str]:
    """The grid, and its times in seconds."""
    parts = []
    step = next((one for one in STEPS if end / one <= 12), STEPS[-1])
    for tick in range(int(end // step) + 1):
        x = left + tick * step * PLOT / end
        parts += [
            line(x, top - 2, x, bottom + 4, "grid"),
            text(x - 3, bottom + 16, f"{tick * step}", "small"),
        ]
    return [*parts, text(MARGIN, bottom + 16, "seconds", "small")]


def _applications(history: History) -> list[tuple[str, str]]:
    """The colours in which applications are active."""
    apps = list(dict.fromkeys(stream.app for stream in history.streams))
    return [(f"s{history.shades.get(app, NOBODY)}", fit(app, 90, 10)) for app in apps[:MOST_APPS]]


def _row(stream: StreamSpan, shade: int, left: float, y: float, scale: float) -> list[str]:
    """A stream's name, its line and its pieces."""
    middle = y + BAR / 2
    parts = [text(MARGIN, middle + 4, fit(stream.name, left - MARGIN - 8))]
    parts += [
        line(left + begin * scale, middle, left + end * scale, middle)
        for begin, end in _open(stream)
    ]
    if stream.ended:
        end = left + stream.end * scale
        parts.append(line(end, y, end, y + BAR))
    for span in sorted(stream.pieces, key=lambda span: span.kind != "away"):
        x, wide = left + span.begin * scale, max((span.end - span.begin) * scale, 1.5)
        hint = f"{stream.name} {in_words(span)}, {span.begin:.2f} to {span.end:.2f} s"
        thin = 0 if span.kind == "runs" else 3
        kind = f"s{shade}" if span.kind == "runs" else span.kind
        parts += [
            f"<g><title>{escape(hint)}</title>",
            box(x, y - thin, wide, BAR + 2 * thin, kind, 2),
            *_words(stream, span, left, middle, scale),
            "</g>",
        ]
    return parts


def _open(stream: StreamSpan) -> list[tuple[float, float]]:
    """When a stream is open and nothing of it runs."""
    gaps = []
    at = stream.begin
    for span in sorted(stream.pieces, key=lambda span: span.begin):
        gaps.append((at, span.begin))
        at = max(at, span.end)
    return [(begin, end) for begin, end in [*gaps, (at, stream.end)] if begin < end]


def _words(
    stream: StreamSpan, span: StreamPiece, left: float, middle: float, scale: float
) -> list[str]:
    """The words on a suspension or break, if there is room."""
    if span.kind == "runs":
        return []
    start = _uncovered(stream, span) if span.kind == "away" else span.begin
    words = in_words(span)
    if measure(words, 10) > (span.end - start) * scale - 8:
        return []
    return [text(left + start * scale + 5, middle + 3.5, words, "small")]


def _uncovered(stream: StreamSpan, away: StreamPiece) -> float:
    """Where a suspension can be seen: a behavior that still runs covers its beginning."""
    runs = [one for one in stream.pieces if one.kind == "runs"]
    return max([away.begin, *(one.end for one in runs if one.begin <= away.begin < one.end)])


def describe(history: History) -> str:
    """The history as text, for accessibility."""
    sentences = []
    for stream in history.streams[:40]:
        what = [
            f"{in_words(span)} from {span.begin:.2f} to {span.end:.2f}"
            for span in stream.pieces
            if span.kind != "runs"
        ]
        more = ", ".join(["", *what[:6]])
        sentences.append(f"{stream.name} from {stream.begin:.2f} to {stream.end:.2f} s{more}.")
    return " ".join(sentences)
