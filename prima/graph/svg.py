"""SVG: text of known width, boxes, lines."""

from __future__ import annotations

import unicodedata
from html import escape

from prima.graph.model import clean
from prima.transcript import colours

SIZE = 11.5
"""The letters' size, in pixels."""
NARROW, WIDE = frozenset("iljtfrI.,:;'|!()[]{} \"-"), frozenset("mwMWQO@%&—…")

STYLE = """
svg { background: #ffffff }
text { font: 11.5px Verdana, "DejaVu Sans", sans-serif; fill: #1f2328 }
.name { font-weight: bold; font-size: 13px }
.small { font-size: 10px; fill: #59636e }
.to { font-weight: bold }
.box { fill: #f6f8fa; stroke: #59636e }
.any { stroke-dasharray: 5 3 }
.first { stroke: #1a7f37; stroke-width: 2.5 }
.rule { stroke: #d1d9e0 }
.mark { fill: #ddf4ff; stroke: #54aeff }
.frame { fill: none; stroke: #8c959f; stroke-dasharray: 2 3 }
.go, .call, .guess, .back, .child { fill: none; stroke: #6e7781; stroke-width: 1.2 }
.call, .back { stroke: #8250df; stroke-dasharray: 6 3 }
.guess { stroke: #9a6700; stroke-dasharray: 2 3 }
.head { fill: #6e7781 }
.call-head, .back-head { fill: #8250df }
.guess-head { fill: #9a6700 }
.lost { opacity: 0.45 }
.state:hover > .edge { stroke: #cf222e; stroke-width: 2.5 }
/* applications */
.waiting { fill-opacity: 0 }
.linked, .cancelled, .failed { fill-opacity: 0; stroke-dasharray: 5 3 }
.away { fill: #8c959f; fill-opacity: 0.3 }
.broken { fill: #cf222e; fill-opacity: 0.25; stroke: #cf222e }
.line { stroke: #59636e; fill: none }
.grid { stroke: #d1d9e0 }
.area { fill-opacity: 0.35; stroke-dasharray: 6 4 }
.way { stroke: #6e7781; stroke-width: 2; stroke-dasharray: 7 5 }
.wall { stroke: #1f2328; stroke-width: 3.5; stroke-linecap: round }
.corner { fill: none; stroke: #9a6700; stroke-dasharray: 3 3 }
.place { fill: #1f2328 }
.thing { fill: #ffffff; stroke: #1f2328; stroke-width: 1.5 }
@media (prefers-color-scheme: dark) {
  svg { background: #0d1117 }
  text { fill: #e6edf3 }
  .small { fill: #9aa4af }
  .box { fill: #161b22; stroke: #9aa4af }
  .first { stroke: #3fb950 }
  .rule, .grid { stroke: #3d444d }
  .mark { fill: #12324f; stroke: #388bfd }
  .frame { stroke: #656c76 }
  .go, .child, .line { stroke: #9aa4af }
  .call, .back { stroke: #bc8cff }
  .guess { stroke: #d29922 }
  .head { fill: #9aa4af }
  .call-head, .back-head { fill: #bc8cff }
  .guess-head { fill: #d29922 }
  .way { stroke: #9aa4af }
  .wall { stroke: #e6edf3 }
  .corner { stroke: #d29922 }
  .place { fill: #e6edf3 }
  .thing { fill: #0d1117; stroke: #e6edf3 }
  /* applications in the dark */
  .waiting, .linked, .cancelled, .failed { fill-opacity: 0 }
}
"""


def applications(dark: bool = False) -> str:
    """The colours of applications, each a class."""
    return "\n".join(
        f".s{index} {{ fill: {colours.fill(index, dark)}; stroke: {colours.stroke(index, dark)} }}"
        for index in range(len(colours.PALETTE))
    )


STYLE = STYLE.replace("/* applications */", applications())
STYLE = STYLE.replace("/* applications in the dark */", applications(dark=True))


def measure(text: str, size: float = SIZE, bold: bool = False) -> float:
    """Maximum width of a text in pixels; real fonts are a little narrower."""
    ems = 0.0
    for letter in text:
        if unicodedata.combining(letter):
            continue
        if unicodedata.east_asian_width(letter) in "WF":
            ems += 1.05
        elif letter in NARROW:
            ems += 0.46
        elif letter in WIDE or ord(letter) > 0x2190:
            ems += 1.0
        else:
            ems += 0.7 if letter.isupper() or letter.isdigit() else 0.635
    return ems * size * (1.13 if bold else 1.0)


def fit(text: str, width: float, size: float = SIZE, bold: bool = False) -> str:
    """A text cut to a width."""
    if measure(text, size, bold) <= width:
        return text
    while text and measure(text + "…", size, bold) > width:
        text = text[:-1]
    return text.rstrip() + "…"


def wrap(text: str, width: float, lines: int, size: float = SIZE) -> list[str]:
    """A text wrapped to a width and a number of lines; the last is cut if too long."""
    found: list[str] = []
    rest = text.strip()
    while rest and len(found) < lines - 1 and measure(rest, size) > width:
        end = len(fit(rest, width, size)) - 1
        space = rest.rfind(" ", 1, end + 1)
        joint = max(rest.rfind(".", 1, end), rest.rfind("-", 1, end)) + 1
        if space > end // 3:
            end = space
        elif joint > end // 3 and " " not in rest[joint:end]:
            end = joint  # of a long name
        end = max(end, 1)
        found.append(rest[:end].rstrip())
        rest = rest[end:].lstrip()
    return [*found, fit(rest, width, size)] if rest else found


def text(x: float, y: float, what: str, kind: str = "") -> str:
    """A line of text, from a point of its base line on."""
    name = f' class="{kind}"' if kind else ""
    return f'<text{name} x="{x:.1f}" y="{y:.1f}">{escape(clean(what))}</text>'


def box(x: float, y: float, width: float, height: float, kind: str, round_: float = 5) -> str:
    """A rectangle."""
    return (
        f'<rect class="{kind}" x="{x:.1f}" y="{y:.1f}"'
        f' width="{width:.1f}" height="{height:.1f}" rx="{round_:g}"/>'
    )


def line(x1: float, y1: float, x2: float, y2: float, kind: str = "line") -> str:
    """A straight line."""
    return f'<path class="{kind}" d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}"/>'


def circle(x: float, y: float, radius: float, kind: str) -> str:
    """A circle around a point."""
    return f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'


def head(x: float, y: float, kind: str, turn: str) -> str:
    """An arrow's head at a point; ``turn`` is ``right``, ``left`` or ``down``."""
    shape = {"right": "l-8 -4v8z", "left": "l8 -4v8z", "down": "l-4 -8h8z"}[turn]
    return f'<path class="{kind}" d="M{x:.1f} {y:.1f}{shape}"/>'


def picture(title: str, description: str, width: float, height: float, parts: list[str]) -> str:
    """A whole picture, with a title and a description for accessibility."""
    begin = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
        f' width="{width:.0f}" height="{height:.0f}" role="img" aria-labelledby="title description">'
    )
    names = f'<title id="title">{escape(clean(title))}</title>\n<desc id="description">{escape(description)}</desc>'
    return "\n".join([begin, names, f"<style>{STYLE}</style>", *parts, "</svg>\n"])
