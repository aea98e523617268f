"""Documents written to a folder, and what prima validate says of them."""

from __future__ import annotations

from pathlib import Path

from prima import loading
from prima.errors import Fix
from prima.lsp.text import Lines
from tests import ROOT


def wrong(places: int) -> str:
    """A world with a warning, and an error in each of so many places."""
    wall = '  <way from="a" to="b"/><wall x1="0.5" y1="-1" x2="0.5" y2="1"/>\n'
    good = '  <place id="a" x="0" y="0"/><place id="b" x="1" y="0"/>\n'
    bad = "".join(f'  <place id="p{index}" x="zero" y="0"/>\n' for index in range(places))
    return f'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n{good}{wall}{bad}</world>\n'


VXML = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"{}>{}</vxml>'


def told(folder: Path, content: str, attributes: str = "", **others: str) -> list[str]:
    """What is told of an application of several documents."""
    for name, text in others.items():
        (folder / f"{name}.vxml").write_text(text)
    (folder / "main.vxml").write_text(VXML.format(attributes, content))
    found = loading.validate([folder / "main.vxml"])
    return [f"{Path(one.place.file).name} {one.code} {one.message} {one.remedy}" for one in found]


def mended(text: str, fix: Fix) -> str:
    """A text after a fix."""
    lines = Lines(text)
    for span, new in sorted(fix.edits, key=lambda one: one.span[:2], reverse=True):
        start, end = lines.offsets(span)
        text = text[:start] + new + text[end:]
    return text


def mended_all(path: Path, named: Path | None = None) -> list[str]:
    """A document, or one that it names, after each of its fixes."""
    file = named or path
    text = file.read_text(encoding="utf-8")
    problems = [one for one in loading.validate([path]) if one.place.file == str(file)]
    return [mended(text, fix) for one in problems for fix in one.fixes]


PASSAGE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" world="{0}/passage.xml"'
    ' robot="{0}/robot.xml"><robot at="door"/><application src="{1}"/>{2}</scenario>'
)


def in_the_passage(folder: Path, name: str, more: str = "") -> list[str]:
    """What is told of an application and a scenario with it, and where."""
    beside = ROOT / "tests" / "mistakes" / "beside"
    (folder / "visit.xml").write_text(PASSAGE.format(beside, name, more))
    found = loading.validate([folder / "visit.xml"])
    assert {one.code for one in found} <= {"unknown-event", "no-such-name"}
    return [f"{Path(one.place.file).name} {one.message} {one.remedy}" for one in found]
