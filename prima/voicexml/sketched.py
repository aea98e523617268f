"""Checks of VoiceXML documents that are shared with PRIMA's own language.

Units around form items and what they reach (U4, U5), how long units speak, what is said twice (O3).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prima.errors import Problem
from prima.interpreter.entering import EnteredDocument
from prima.interpreter.repeats import told_twice
from prima.interpreter.selection import beginnings
from prima.interpreter.speaking import long_group, long_unit, speak, unit_speaks
from prima.interpreter.units import Reached, unit_problem
from prima.language.commands import TABLE_4_2, CommandType
from prima.voicexml.acting import commands_in
from prima.voicexml.arranging import UNIT, is_unit, longest_of
from prima.voicexml.caught import thrown_in
from prima.voicexml.document import Page, broken
from prima.voicexml.elements import HANDLERS
from prima.voicexml.sketch import Sketch

PREFIX = "p:"
OWN = ("noinput", "nomatch", "help", "cancel", "exit", "error", "maxspeechtimeout", "connection")
"""Prefixes of VoiceXML's own events, by which nothing is said twice."""
REMEDY = "Leave out the <goto>: the dialog goes on then. Or give the speech a cond."
LATER = " At run time it is error.semantic."


def unit_errors(page: Page) -> list[Problem]:
    """Commands of a document that is not allowed in its units, or that these cannot reach (U5)."""
    return list(_unit_problems(Sketch(page, None)))


def check_sketched(pages: Iterable[tuple[Page, Page | None]]) -> Iterator[Problem]:
    """Warnings for the documents of an application.

    Args:
        pages: the documents, each with its application root document.
    """
    sound = [one for one in pages if broken(one[0]) is None]  # others are reported later
    every = {one.uri: one.root for both in sound for one in both if one is not None}
    nodes = (node for root in every.values() for node in root.walk())
    if not any(node.tag in HANDLERS or is_unit(node) for node in nodes):
        return  # all of it is about units, and about where handlers lead back to
    sources = []
    for page, root in sound:
        sketch = Sketch(page, root)
        yield from _check_units(sketch, root)
        sources.append(_source(sketch, root))
    yield from told_twice(sources, REMEDY)


def _check_units(sketch: Sketch, root: Page | None) -> Iterator[Problem]:
    page = sketch.page
    places = {one.place for one in page.problems}
    for problem in _unit_problems(sketch) if root is not None else ():
        if problem.place not in places:  # a handler of the root's, which is another's document
            yield problem._replace(severity="warning", remedy=problem.remedy + LATER)
    for _, unit in sketch.units:
        yield from long_unit(unit.node, unit_speaks(unit, page.lang))
    for node in page.root.walk():
        if is_unit(node) and node.key != UNIT:
            yield from long_group(node, speak(commands_in(node), page.lang), longest_of(node))


def _source(sketch: Sketch, root: Page | None) -> EnteredDocument:
    """A document as the check for repeated speech sees it."""
    own = {*OWN, *thrown_in(sketch.page.root), *(thrown_in(root.root) if root is not None else ())}
    return EnteredDocument(
        sketch.document, lambda name: _is_foreign(name, own), sketch.leads, queues=True
    )


def added_in_units(page: Page, commands: Mapping[str, CommandType]) -> Iterator[Problem]:
    """Commands that a robot adds and that cannot be in the units that contain them."""
    added = {name: row for name, row in commands.items() if name not in TABLE_4_2}
    for problem in _unit_problems(Sketch(page, None), added):
        yield problem._replace(severity="warning", remedy=problem.remedy + LATER)
    for node in page.root.walk():
        for one in commands_in(node) if is_unit(node) and node.key != UNIT else ():
            found = unit_problem(Reached(one, True), added.get(one.type), prefix=PREFIX)
            if found is not None:
                yield found._replace(severity="warning", remedy=found.remedy + LATER)


def _unit_problems(
    sketch: Sketch, commands: Mapping[str, CommandType] = TABLE_4_2
) -> Iterator[Problem]:
    for _, unit in sketch.units:
        for one in sketch.reach(unit).commands:
            problem = unit_problem(one, commands.get(one.command.type), unit, PREFIX)
            if problem is not None:
                yield problem


def _is_foreign(name: str, own: set[str]) -> bool:
    """Whether a handler that names an event waits for one from outside the dialog."""
    return bool(name) and own.isdisjoint(beginnings(name))
