"""Examples of the documentation are valid and run."""

from __future__ import annotations

import re
import shlex
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from lxml import etree

from prima import api
from tests import ROOT
from tests.helpers.pages import BEGIN, FENCE, PAGES, compiled_schema, run


@dataclass
class Example:
    """A fenced block of a page: its language, the file's name if it has one, its text."""

    page: Path
    line: int
    language: str
    name: str
    text: str

    @property
    def complete(self) -> bool:
        """Whether it is a whole document and no fragment."""
        namespaces = ('xmlns="urn:prima:', 'xmlns="http://www.w3.org/2001/vxml"')
        known = self.name.endswith(".grxml") or any(one in self.text for one in namespaces)
        return self.language == "xml" and known

    def __str__(self) -> str:
        return f"{self.page.name}:{self.line}"


@dataclass
class Shown:
    """A command of a console block, and the output that the page shows for it."""

    example: Example
    words: list[str]
    output: list[str] = field(default_factory=list)


def examples(page: Path) -> list[Example]:
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    return [
        Example(
            page,
            text.count("\n", 0, match.start()) + 1,
            match["language"],
            match["name"] or "",
            match["text"],
        )
        for match in FENCE.finditer(text)
    ]


def commands(example: Example) -> list[Shown]:
    found: list[Shown] = []
    marked = re.search(r"^\$ ", example.text, re.MULTILINE) is not None
    for line in example.text.splitlines():
        if line.startswith("$ " if marked else "prima "):
            found.append(Shown(example, shlex.split(line.removeprefix("$ "), comments=True)))
        elif marked and found:
            found[-1].output.append(line)
    return found


def stage(page: Path, folder: Path) -> None:
    """A folder in which a page's commands work: the demo documents and the page's own."""
    shutil.copytree(ROOT / "documents", folder / "documents")
    for number, example in enumerate(examples(page)):
        if example.complete:
            (folder / (example.name or f"example-{number}.xml")).write_text(
                example.text, encoding="utf-8"
            )


def save(example: Example, folder: Path) -> None:
    """Write a named file when the page comes to it, as a reader does.

    A part takes the place of the element with the same tag and id or name; if there
    is none, it is added at the document's end.
    """
    path, part = folder / example.name, example.text
    if not example.complete and example.language != "toml":
        whole = path.read_text(encoding="utf-8")
        start = re.match(r"\s*(<([\w-]+)(?: (?:id|name)=\"[^\"]*\")?)", part)
        assert start, str(example)
        old = re.compile(
            rf"^ *{re.escape(start[1])}(?=[\s>]).*?</{start[2]}>\n", re.DOTALL | re.MULTILINE
        )
        end = whole.rindex("</")
        found = old.search(whole)
        at = found.span() if found else (end, end)
        part = whole[: at[0]] + part + whole[at[1] :]
    path.write_text(part, encoding="utf-8")


def piped(words: list[str]) -> tuple[str | None, list[str]]:
    """What a command is given through a pipe (printf TEXT | COMMAND), and the command."""
    if words[:1] != ["printf"] or words[2:3] != ["|"]:
        return None, words
    return words[1].replace("\\n", "\n"), words[3:]


BUSY = "prima: An instant was carried out "
"""The beginning of what a live run says of a machine that does other things besides."""


def alike(shown: list[str], made: list[str]) -> bool:
    """Whether the output is as shown; a line of three dots stands for any lines."""
    if not shown:
        return not made
    if shown[0].strip() == "...":
        return any(alike(shown[1:], made[start:]) for start in range(len(made) + 1))
    return bool(made) and shown[0].rstrip() == made[0] and alike(shown[1:], made[1:])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_complete_examples_are_valid(page: Path, tmp_path: Path) -> None:
    stage(page, tmp_path)
    for path in sorted(tmp_path.glob("*.xml")):
        errors = [p for p in api.validate([path]) if p.severity == "error"]
        assert not errors, (page.name, path.name, errors)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_give_what_is_shown(page: Path, tmp_path: Path) -> None:
    stage(page, tmp_path)
    for example in examples(page):
        if example.language in ("xml", "wrong", "toml") and example.name:  # wrong: to be validated
            save(example, tmp_path)
        if example.language not in ("", "console", "sh", "bash", "shell"):
            continue
        for shown in commands(example):
            given, words = piped(shown.words)
            if words[:1] != ["prima"]:
                continue
            code, made = run(words[1:], tmp_path, given)
            made = [one for one in made if not one.startswith(BUSY)]
            assert code != 2, (str(example), shown.words, made)
            while shown.output and not shown.output[-1].strip():
                shown.output.pop()
            if shown.output:
                assert alike(shown.output, made), (str(example), shown.words, "\n".join(made))


SCENE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="x" world="w" robot="r">',
    "</scenario>",
)
PROFILE = '<robot xmlns="urn:prima:robot:1" version="1.0" id="x">'
CONTEXTS = {
    "dialogue": (
        (BEGIN, "</prima>"),
        (f'{BEGIN}<form id="f">', "</form></prima>"),
        (f'{BEGIN}<form id="f"><block>', "</block></form></prima>"),
        (f'{BEGIN}<form id="f"><field name="n">', "</field></form></prima>"),
    ),
    "scenario": (SCENE, (f'{SCENE[0]}<when at="1s">', f"</when>{SCENE[1]}")),
    "robot": (
        (PROFILE, "</robot>"),
        (f'{PROFILE}<driver kind="x">', "</driver></robot>"),
    ),
    "world": (('<world xmlns="urn:prima:world:1" version="1.0" id="x">', "</world>"),),
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_fragments_are_valid_where_they_belong(page: Path) -> None:
    for example in examples(page):
        if example.language != "xml" or example.complete:
            continue
        valid = [
            name
            for name, contexts in CONTEXTS.items()
            for begin, end in contexts
            if compiled_schema(name).validate(etree.fromstring(begin + example.text + end))
        ]
        assert valid, f"{example}: this fragment is valid nowhere"
