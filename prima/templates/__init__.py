"""New documents from templates, for ``prima new``."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from unicodedata import combining, normalize

from prima.devices.vocabulary.robot import ROBOT
from prima.errors import DocumentError, UsageError, argument, has_errors
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.loading import is_voicexml, validate
from prima.loading.files import read_file
from prima.loading.stages import UNFIT
from prima.markup.reader import parse
from prima.sim.map import read_world
from prima.sim.vocabulary.world import WORLD

TEMPLATES = Path(__file__).parent
ANSWERS = {
    "Would you like something to drink?": "Yes.",
    "Would you like juice or tea?": "Tea.",
    "Tea or juice?": "Tea.",
    "Shall I wave, or nod?": "Wave.",
}
"""The user's answers in a new scenario to the questions of the other templates."""
AWAY = 0.9
"""The user's distance from the robot at the start (m)."""


def write(kind: str, name: str) -> list[Path]:
    """Write a new document, and the documents that a scenario lacks; return the files.

    Args:
        kind: the name of a template.
        name: its file, with or without ``.xml`` (``.vxml``); its id is derived from this.

    Raises:
        UsageError: the file already exists, cannot be written, or has a name that no document
            can hold as its title.
    """
    ending = ".vxml" if kind == "vxml" else ".xml"
    stem = name.removesuffix(".vxml").removesuffix(".xml")
    if Path(name).name in ("", ".", "..") or name.endswith("/"):
        raise UsageError(f'"{name}" is not a file name.')
    if re.search(UNFIT, name):
        raise UsageError(
            f'The name "{name}" holds a control character, or is not UTF-8. Name another file.'
        )
    path = Path(stem + ending)
    if path.exists():
        raise UsageError(f"{path}: already exists; name another file.")
    if not path.parent.is_dir():
        raise UsageError(f"{path}: there is no folder {path.parent}; make it first.")
    if kind == "scenario":
        return _scenario(path)
    return [_fill(kind, path)]


def identifier(name: str, kind: str) -> str:
    """An id derived from a file's name, or the kind if no character of the name is allowed."""
    plain = "".join(one for one in normalize("NFKD", name) if not combining(one))
    made = re.sub(r"[^A-Za-z0-9_-]+", "-", plain).strip("-_") or kind
    return f"{kind}-{made}" if made[:1].isdigit() else made


def attempt(kind: str, path: Path) -> str:
    """The command that tries a new document."""
    name = argument(path)
    return {
        "fa": "prima new scenario NAME",
        "ea": f"prima run --ea {name} --say Yes. --say tea",
        "vxml": f"prima run --ea {name} --say tea",
        "scenario": f"prima run {name}",
    }.get(kind, f"prima validate {name}")


def _fill(kind: str, path: Path, **values: str) -> Path:
    """Write a template with its values to a new file."""
    text = (TEMPLATES / f"{kind}.xml").read_text(encoding="utf-8")
    title = escape(path.stem)
    given = {"id": identifier(path.stem, kind), "title": title, **values}
    given["file"] = path.name if "--" not in path.name else "FILE"  # -- is not allowed in comments
    text = re.sub(r"\{(\w+)\}", lambda key: given[key[1]], text)  # at once: a value may have braces
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise UsageError(f"{path}: already exists; name another file.") from None
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}.") from None
    return path


def _scenario(path: Path) -> list[Path]:
    """Write a scenario that uses its folder's documents, and the documents that are missing."""
    folder, written = path.parent, []
    found = _documents(folder)
    for kind, other in (("world", "room.xml"), ("robot", "robot.xml"), ("ea", "guide.xml")):
        lacking = not found[kind] and not (kind == "ea" and found["fa"])
        if lacking:
            beside = folder / other if folder / other != path else folder / f"the-{other}"
            written.append(_fill(kind, beside))
            found[kind] = [beside]
    world = read_world(str(found["world"][0]), read_file(found["world"][0]))
    place, (x, y) = next(iter(world.places.items()))
    applications = [
        f'  <application src="{escape(one.name)}" kind="{kind}"/>'
        for kind in ("fa", "ea")
        for one in found[kind]
    ]
    said = "".join(read_file(one).decode(errors="replace") for one in [*found["fa"], *found["ea"]])
    answers = [
        f'  <answer to="{escape(question)}">{escape(answer)}</answer>'
        for question, answer in ANSWERS.items()
        if f"{question}</prompt>" in said
    ]
    made = _fill(
        "scenario",
        path,
        world=escape(found["world"][0].name),
        robot=escape(found["robot"][0].name),
        place=escape(place),
        x=f"{x + AWAY:g}",
        y=f"{y:g}",
        applications="\n".join(applications),
        answers="\n".join(answers),
    )
    return [*written, made]


def _documents(folder: Path) -> dict[str, list[Path]]:
    """The documents of a folder without errors, by kind, sorted by name.

    Of applications with the same id only the first can run; the others are left out.
    """
    found: dict[str, list[Path]] = {"fa": [], "ea": [], "world": [], "robot": []}
    taken: set[str] = set()
    for path in sorted([*folder.glob("*.xml"), *folder.glob("*.vxml")]):
        kind, name = _kind(path)
        if kind in found and not (kind in ("fa", "ea") and name in taken):
            found[kind].append(path)
            taken.add(name)
    return found


def _kind(path: Path) -> tuple[str, str]:
    """The kind and id of a document; empty if it has errors and so could not run."""
    try:
        data = read_file(path)
        root = parse(str(path), data)
        if has_errors(validate([path])):
            return "", ""
    except (DocumentError, UsageError):
        return "", ""
    if is_voicexml(data):
        return "ea", path.stem
    if root.namespace == DIALOGUE.namespace:
        return root.get("kind"), root.get("id")
    return {WORLD.namespace: "world", ROBOT.namespace: "robot"}.get(root.namespace, ""), ""
