"""Patterns that every supported version of Python matches alike."""

from __future__ import annotations

import ast
import re

from tests import ROOT

POSSESSIVE = re.compile(r"\(\?>|\)(?:[*+?]|\{[\d,]+\})\+")


def test_no_group_is_possessive_or_atomic() -> None:
    """Python before 3.11.5 forgets alternatives in such a group (gh-106052): "yes" matched no question."""
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {node.value!r}"
        for path in sorted((ROOT / "prima").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
        if POSSESSIVE.search(
            node.value if isinstance(node.value, str) else node.value.decode("latin-1")
        )
    ]
    assert found == []


def test_what_is_looked_for_is_found() -> None:
    wrong = (r"(?:a|b)*+c", r"(?>ab|a)", r"(a)++", r"(a|b){2,}+")
    assert [one for one in wrong if not POSSESSIVE.search(one)] == []
    assert not POSSESSIVE.search(r"(?:a++|b*+)*(c)+\++")
