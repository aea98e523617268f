"""Counts the functions that one value passes on its way through ``prima``.

``python tools/walks.py`` prints, for each walk, the functions, their files, and how often the next
function is in another file. A function counts once, when it is first given the value or returns it:
a text with the walk's word, or an object that holds such a text in a field of its own.
``PYTHONPATH=DIR python tools/walks.py`` counts another state of the package; ``--list`` names
the functions.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

import prima

PACKAGE = Path(prima.__file__).parent
ROBOT = Path(__file__).parent.parent / "documents" / "robots" / "papero.xml"
MOST_FIELDS = 40
"""An object with more fields or elements holds a value among others: it is not the value."""
WORLD = """<world xmlns="urn:prima:world:1" version="1.0" id="w">
<place id="door" x="0" y="0"/><place id="{0}" x="2" y="0"/><way from="door" to="{0}"/></world>"""
SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"
robot="robot.xml"><application src="app.xml"/><robot at="door"/><person x="0.9" y="0.5"/>{}</scenario>"""
OWN = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app"><form id="f">
{}</form></prima>"""
VOICE = """<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1" xml:lang="en"><form><block>
<prompt>{}</prompt></block></form></vxml>"""
FIELD = """<field name="what"><prompt>What is it?</prompt><option>zebra</option>
<filled><exit/></filled></field>"""
WALKS = {
    "a `topological-move` from XML to its row": (
        OWN.format('<block><topological-move to="zebra"/><exit/></block>'),
        "",
        "zebra",
    ),
    "a VoiceXML prompt": (VOICE.format("A zebra."), "", "hall"),
    "an utterance from the ear to its handler": (
        OWN.format(FIELD),
        '<answer to="What is it?">zebra</answer>',
        "hall",
    ),
}
"""The application of each walk, what its scenario has besides, and a place of its world."""


def fields(thing: object) -> Iterable[object]:
    """The elements of a container, or the fields of an object of the package."""
    if isinstance(thing, dict):
        return [*thing.keys(), *thing.values()]
    if isinstance(thing, list | tuple | set | frozenset):
        return thing
    if not type(thing).__module__.startswith("prima"):
        return []
    slots = [name for one in type(thing).__mro__ for name in one.__dict__.get("__slots__", ())]
    named = [getattr(thing, name, None) for name in slots if name.isidentifier()]
    return [*named, *getattr(thing, "__dict__", {}).values()]


def told(thing: object) -> bool:
    """Whether a text has the word of all walks."""
    return (isinstance(thing, str) and "zebra" in thing) or (
        isinstance(thing, bytes) and b"zebra" in thing
    )


def carries(thing: object) -> bool:
    """Whether a thing is the value of the walk."""
    if told(thing):
        return True
    held = list(fields(thing))
    return len(held) <= MOST_FIELDS and any(map(told, held))


class Walk:
    """Notes the functions that the value passes, in the order of their first visits."""

    def __init__(self) -> None:
        self.passed: dict[tuple[str, str], None] = {}
        self._busy = False

    def note(self, frame: FrameType, event: str, result: object) -> None:
        """A call or a return, as :func:`sys.setprofile` reports it."""
        code = frame.f_code
        own = code.co_filename.startswith(f"{PACKAGE}/") and not code.co_name.startswith("<")
        if self._busy or not own or event not in ("call", "return"):
            return
        step = (code.co_filename.removeprefix(f"{PACKAGE}/"), code.co_qualname)
        if step in self.passed:
            return
        self._busy = True
        given = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        things = [frame.f_locals.get(one) for one in given if one not in ("self", "cls")]
        if any(map(carries, things if event == "call" else [result])):
            self.passed[step] = None
        self._busy = False


def walk(application: str, scenario: str, place: str) -> Walk:
    """Run an application twice, and note the second time: imports do not count."""
    found = Walk()
    with TemporaryDirectory() as folder:
        files = {
            "world.xml": WORLD.format(place),
            "robot.xml": ROBOT.read_text(encoding="utf-8"),
            "app.xml": application,
            "run.xml": SCENARIO.format(scenario),
        }
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        prima.rehearse(f"{folder}/run.xml").table()
        sys.setprofile(found.note)
        table = prima.rehearse(f"{folder}/run.xml").table()
        sys.setprofile(None)
    if "zebra" not in table.lower():
        raise SystemExit(f"The value is not in the table:\n{table}")
    return found


def main() -> None:
    """Print the table, in Markdown."""
    print("| walk | functions | files | changes of file |\n| --- | --- | --- | --- |")
    for name, given in WALKS.items():
        steps = list(walk(*given).passed)
        changes = sum(one[0] != other[0] for one, other in pairwise(steps))
        print(f"| {name} | {len(steps)} | {len({file for file, _ in steps})} | {changes} |")
        if "--list" in sys.argv:
            print(*(f"{file} {function}" for file, function in steps), sep="\n", end="\n\n")


if __name__ == "__main__":
    main()
