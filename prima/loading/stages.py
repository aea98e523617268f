"""Applications on a robot without a scenario."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import repeat
from pathlib import Path
from typing import TYPE_CHECKING

from prima.errors import DocumentError, Problem, UsageError
from prima.loading.applications import read_application
from prima.loading.files import check_path, paths_of, read_file, texts_of
from prima.loading.folders import documents_folder
from prima.loading.kinds import is_voicexml
from prima.loading.reading import STAGE, other_kind
from prima.loading.scenarios import Loaded, load_whole, without_ignored
from prima.loading.voicedocuments import mappings
from prima.markup.edits import quoted

if TYPE_CHECKING:
    from prima.sim.map import Map

UNFIT = "[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
"""Characters that XML cannot hold."""


def stage(
    fas: str | Path | Iterable[str | Path],
    eas: str | Path | Iterable[str | Path],
    says: str | Iterable[str] = (),
    world: str | Path | None = None,
    robot: str | Path | None = None,
    maps: Iterable[str] = (),
    entrances: bool = False,
) -> Loaded:
    """Put applications on a robot in an empty room, with a user in front of it.

    Args:
        fas: paths of the robot's own applications.
        eas: paths of the place's.
        says: the user's answers to the questions, in order; a single text is the first.
        world: path of another world; the robot is at its first place.
        robot: path of another robot's profile.
        maps: folders of VoiceXML documents and where they are served, as ``URI=FOLDER``.
        entrances: whether applications that areas of the world offer are loaded as well.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
        UsageError: a file cannot be read, no application is named, or two have one id.
    """
    given = [*zip(repeat("fa"), paths_of(fas, "fas")), *zip(repeat("ea"), paths_of(eas, "eas"))]
    demo = documents_folder()
    place = check_path(demo / "worlds" / "room.xml" if world in (None, "") else world, "world")
    body = check_path(demo / "robots" / "papero.xml" if robot in (None, "") else robot, "robot")
    for path in (*(path for _, path in given), place, body):
        read_file(path)  # a missing file is a wrong option, not a wrong document
    there = _site(place)
    taken_up = _offers(place, there, bool(given), entrances)
    inside = f"{_standing(there)}{_applications(given, maps)}{_answers(says)}"
    try:
        loaded = load_whole(Path(STAGE), _scenario(place, body, taken_up, inside))
    except DocumentError as error:
        own = (one.code for one in error.problems if one.place.file == STAGE)
        if "duplicate-id" in own:
            _refuse_same_id(given)
        raise
    loaded.problems = sorted(_problems(given, loaded))
    return without_ignored(loaded)


def _offers(place: str, there: Map, others: bool, entrances: bool) -> bool:
    """Whether the applications that a world's areas offer are loaded, beside ``others``.

    Raises:
        UsageError: they are not, and there are no others.
    """
    if not others and not entrances:
        raise UsageError("Name an application, in fas or eas.")
    if not others and not there.areas:
        raise UsageError(f"{place}: no <area> offers an application; name some by --fa and --ea.")
    return entrances and bool(there.areas)


def _problems(given: list[tuple[str, str]], loaded: Loaded) -> Iterator[Problem]:
    """All problems; documents of another kind than their options are reported at these."""
    yield from (one for one in loaded.problems if one.code != "other-kind")
    for (kind, _), document in zip(given, loaded.cast.documents, strict=False):
        own, place = document.node.get("kind"), document.node.attribute_place("kind")
        remedy = f'Name it with --{own}, or write kind="{kind}".'
        yield from other_kind(document, "The document", f"--{kind} names it", place, remedy)


def _scenario(world: str, robot: str, entrances: bool, inside: str) -> bytes:
    """The text of the scenario."""
    taken_up = ' entrances="open"' if entrances else ""
    return (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="stage"'
        f" world={_quoted(world)} robot={_quoted(robot)}{taken_up}>{inside}</scenario>"
    ).encode()


def _applications(given: list[tuple[str, str]], maps: Iterable[str]) -> str:
    """The applications of a scenario, by their kinds and paths, and where they are served.

    Only VoiceXML is served; the folder of a site may hold applications in PRIMA's language too.

    Raises:
        UsageError: a mapping is invalid, or no VoiceXML application is in its folder.
    """
    from prima.voicexml.site import mapped

    voice = {path for _, path in given if is_voicexml(read_file(path))}
    held = mappings(maps, voice)
    made = ""
    for kind, path in given:
        site = mapped(path, held) if path in voice else None
        served = f" uri={_quoted(site[0])} folder={_quoted(site[1])}" if site else ""
        made += f'<application src={_quoted(path)} kind="{kind}"{served}/>'
    return made


def _quoted(name: str) -> str:
    """A file's name as an attribute's value.

    Raises:
        UsageError: it holds a character that no document can hold.
    """
    if re.search(UNFIT, name):
        raise UsageError(
            f"{name!r}: the name of this file holds a control character, or is not UTF-8."
            " Rename it."
        )
    return quoted(name)


def _answers(says: str | Iterable[str]) -> str:
    """The user's answers to the questions, one after the other.

    Raises:
        UsageError: one of them holds a character that no document can hold.
    """
    from html import escape

    said = texts_of(says, "says")
    for text in said:
        if re.search(UNFIT, text):
            raise UsageError(
                f'The answer "{text}" holds a control character, or is not UTF-8. Write it anew.'
            )
    return "".join(
        f'<when asked="" count="{number}" after="1s"><say>{escape(text)}</say></when>'
        for number, text in enumerate(said, 1)
        if text.strip()
    )


def _site(world: str) -> Map:
    """A world in which the robot can be.

    Raises:
        DocumentError: the world is wrong.
        UsageError: it cannot be read, or has no place.
    """
    from prima.sim.map import read_world

    there = read_world(world, read_file(world))
    if not there.places:
        raise UsageError(f"{world}: this world has no place for the robot; write a <place> in it.")
    return there


def _standing(there: Map) -> str:
    """The robot at a world's first place, and the user a metre in front of it."""
    from math import cos, radians, sin

    name, (x, y) = next(iter(there.places.items()))
    angle = radians(there.headings[name])
    return f'<robot at={quoted(name)}/><person x="{x + cos(angle):.3f}" y="{y + sin(angle):.3f}"/>'


def _refuse_same_id(given: list[tuple[str, str]]) -> None:
    """Refuse two applications with one id, naming their options: the stage has no file.

    Raises:
        UsageError: two have the same id.
    """
    seen: dict[str, str] = {}
    for kind, path in given:
        name, option = read_application(path, read_file(path))[0].id, f"--{kind} {path}"
        if name in seen:
            both = f"{option} is given twice"
            if seen[name] != option:
                both = f'{seen[name]} and {option} have the same id, "{name}"'
            raise UsageError(f"{both}. Leave one out, or run a copy with another id.")
        seen[name] = option
