"""Names of classes: each is found by its name alone."""

from __future__ import annotations

import ast
from collections import Counter

from tests import ROOT


def test_no_two_classes_have_one_name() -> None:
    names = Counter(
        one.name
        for path in (ROOT / "prima").rglob("*.py")
        for one in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(one, ast.ClassDef)
    )
    assert [name for name, number in names.items() if number > 1] == []
