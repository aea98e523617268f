"""The grammar engine against cases as data: one or more for each statement of SRGS and SISR."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from prima.grammar import Grammar, GrammarError, load

FOLDER = Path(__file__).parent / "cases"
CASES = [
    (path.stem, case)
    for path in sorted(FOLDER.glob("*.toml"))
    for case in tomllib.loads(path.read_text(encoding="utf-8"))["case"]
]
Case = dict[str, Any]


def loaded(case: Case) -> Grammar:
    lang, kind = case.get("lang", "en"), case.get("type", "")
    if "xml" in case:
        space = "http://www.w3.org/2001/06/grammar"
        head = f'xmlns="{space}" version="1.0" xml:lang="{lang}" root="r" {case.get("head", "")}'
        text = f"<grammar {head}>{case['xml']}</grammar>"
    elif "abnf" in case:
        tags = f"tag-format <{case['tags']}>;\n" if "tags" in case else ""
        text = f"#ABNF 1.0 UTF-8;\nlanguage {lang};\nroot $r;\n{tags}{case['abnf']}\n"
    else:
        text = case["file"]
    return load(text, lang=lang, type=kind)


def with_null(value: Any) -> Any:
    """TOML has no null; the cases write it as a text."""
    if isinstance(value, dict):
        return {key: with_null(one) for key, one in value.items()}
    if isinstance(value, list):
        return [with_null(one) for one in value]
    return None if value == "null!" else value


@pytest.mark.parametrize(
    "case", [case for _, case in CASES], ids=[f"{name}: {case['about']}" for name, case in CASES]
)
def test_case(case: Case) -> None:
    if "errors" in case:
        with pytest.raises(GrammarError) as caught:
            loaded(case)
        problems = caught.value.problems
        assert sorted(problem.code for problem in problems) == case["errors"], problems
        return
    grammar, mode = loaded(case), case.get("mode", "voice")
    for said, meaning in case.get("accepts", {}).items():
        found = grammar.match(said, mode=mode)
        assert found, f"{said!r} is not taken"
        assert found[0].error is None, found[0].error
        value = found[0].interpretation
        assert (type(value), value) == (type(with_null(meaning)), with_null(meaning)), said
    for said, meanings in case.get("all", {}).items():
        found = grammar.match(said, mode=mode, most=10)
        assert [one.interpretation for one in found] == meanings
    for said in case.get("rejects", []):
        found = grammar.match(said, mode=mode)
        assert not found, f"{said!r} is taken as {found}"
    for said in case.get("fails", []):
        error = grammar.match(said, mode=mode)[0].error
        assert error is not None and error.place.line > 1


def test_cases_are_told_apart() -> None:
    names = [case["about"] for _, case in CASES]
    assert len(set(names)) == len(names)
