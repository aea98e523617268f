"""CONTRIBUTING.md is true: what its recipes and its glossary name exists; the changelog is grouped."""

from __future__ import annotations

import re
from collections.abc import Iterator

from tests import ROOT

CONTRIBUTING = ROOT / "CONTRIBUTING.md"
FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def contributing() -> str:
    return CONTRIBUTING.read_text(encoding="utf-8")


def recipes() -> Iterator[tuple[str, str]]:
    """Each step of a recipe: the file or folder that it begins with, and its text."""
    text = FENCE.sub("", contributing())
    for step in re.findall(r"^\d\. (`.*(?:\n   .*)*)", text, re.MULTILINE):
        yield step.split("`")[1], step


def test_files_that_recipes_name_exist() -> None:
    named = re.findall(r"`([\w.]+/[\w./]*)`", contributing())
    assert len(named) > 50
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_steps_of_recipes_name_what_is_in_their_files() -> None:
    found = list(recipes())
    assert len(found) > 25
    for name, step in found:
        path = ROOT / name
        files = [path] if path.is_file() else sorted(path.glob("*.py"))
        text = "".join(one.read_text(encoding="utf-8") for one in files)
        words = re.findall(r"`(\w+)`", step)
        assert [word for word in words if not re.search(rf"\b{word}\b", text)] == [], step


def test_tests_that_recipes_name_exist() -> None:
    named = re.findall(r"`pytest (tests/[\w/]+\.py)(?: -k (\w+))?`", contributing())
    assert len(named) > 10
    for path, word in named:
        text = (ROOT / path).read_text(encoding="utf-8")
        assert re.search(rf"^def test_\w*{word}", text, re.MULTILINE), (path, word)


def test_every_recipe_is_counted() -> None:
    page = (ROOT / "docs" / "development.md").read_text(encoding="utf-8")
    table = page.partition("## Change requests")[2].partition("\n## ")[0]
    counted = re.findall(r"^\| an? (.+?) \|", table, re.MULTILINE)
    part = contributing().partition("## Recipes")[2].partition("\n## ")[0]
    titles = re.findall(r"^### An? (.+)$", part, re.MULTILINE)
    assert sorted(counted) == sorted(
        title.replace("built-in grammar", "built-in") for title in titles
    )


def test_classes_of_the_glossary_exist() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "prima").rglob("*.py"))
    glossary = contributing().partition("## Glossary")[2]
    names = set(re.findall(r"`([A-Z][a-z]\w+)[`.]", glossary))
    assert len(names) > 10
    assert {name for name in names if not re.search(rf"^(class )?{name}\b", code, re.M)} == set()


def test_the_changelog_is_grouped() -> None:
    groups = ["Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"]
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    for version in re.split(r"^## .+$", text, flags=re.MULTILINE)[1:]:
        before, *parts = re.split(r"^### ", version, flags=re.MULTILINE)
        titles = [part.partition("\n")[0] for part in parts]
        assert titles == [one for one in groups if one in titles] and not before.strip()
        assert all(part.partition("\n")[2].strip().startswith("- ") for part in parts)
