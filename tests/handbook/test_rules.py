"""prima explain RULE: every rule has an example, and is explained in the words of its page."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from prima.handbook import rulebook
from prima.handbook.situations import EXAMPLES
from prima.report import strip
from prima.scheduler.policy import BASELINES
from prima.transcript.rules import RULES
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.pages import run


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_every_example_of_a_rule_shows_it(name: str) -> None:
    run = rulebook.run_of(name)
    looked = next(row for row in run.rows if row.number == run.number)
    assert EXAMPLES[name].row in looked.what
    assert max(map(len, run.picture.splitlines())) <= 80
    assert "\0" not in run.picture


def test_every_rule_of_the_page_has_an_example_and_is_explained_in_its_words() -> None:
    rules = rulebook.rules()
    assert set(rules) == set(EXAMPLES), "each rule needs an example"
    assert {*RULES, *BASELINES} <= set(rules), "each rule that records name is in the page"
    page = (ROOT / "docs" / "mediation.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^- \*\*([A-Z]\d+)", page, re.MULTILINE))
    assert named <= set(rules)
    bare = " ".join(re.sub(r"[*`]", "", re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", page)).split())
    for name in sorted(named - {"S2"}):
        assert " ".join(rules[name].text.split()) in bare, name


@pytest.mark.parametrize("name", ["S2", "S2d", "K1", "X1", "none"])
def test_a_rule_is_explained_with_a_picture_and_a_run(name: str, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "documents", tmp_path / "documents")
    code, made = run(["explain", name.lower()], tmp_path)
    assert code == 0 and max(map(len, made)) <= 80
    first = rulebook.rules()[name].text.split("\n")[0]
    assert " ".join(made).startswith(f"{name} (") and first[:40] in " ".join(made)
    assert strip.LEGEND in made
    assert run(shlex.split(made[-1])[1:], tmp_path)[0] == 0
    code, told = run(["explain", name, "--format", "json"], tmp_path)
    data = json.loads("\n".join(told))
    assert data["rule"] == name and data["example"]["commands"] == [made[-1].strip()]


@pytest.mark.parametrize("there", [(), ("documents",), ("documents", "documents-2")])
def test_a_rule_is_tried_by_the_commands_as_they_are_printed(
    tmp_path: Path, there: tuple[str, ...]
) -> None:
    for folder in there:
        (tmp_path / folder).mkdir()
    _, made = run(["explain", "F2"], tmp_path)
    copy, example = made[made.index("Try it:") + 1 :]
    for line in (copy, example):
        assert run(shlex.split(line)[1:], tmp_path)[0] == 0, line
    _, made = run(["explain", "F2"], tmp_path)
    assert made[made.index("Try it:") + 1 :] == [example], "the documents are there now"


def test_a_rule_that_is_not_there_is_told(tmp_path: Path) -> None:
    for words, told in (
        (["F99"], "Rules with F are F1, F2"),
        (["F2", "3"], "F2 is a rule, which has no rows"),
        (["undeclared-varable"], 'Did you mean "undeclared-variable"?'),
        (["qqqq"], "prima explain lists them all"),
    ):
        code, made = run(["explain", *words], tmp_path)
        assert code == 2 and told in " ".join(made), made
    code, made = run(["explain"], tmp_path)
    assert code == 0 and any(line.startswith("F2 ") for line in made)
    assert max(map(len, made)) <= 80


def test_every_example_of_a_rule_is_as_it_expects() -> None:
    done = prima("test", "documents/rules", cwd=ROOT)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("columns", [1, 20, 80])
def test_the_list_is_printed_in_the_narrowest_terminal(
    columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prima.cli.explain.columns", lambda: columns)
    made = prima("explain")
    assert made.returncode == 0 and "undeclared-variable" in made.stdout
