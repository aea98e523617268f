"""The chapter on grammars is true: its examples run."""

from __future__ import annotations

import re

import pytest

from prima.grammar import builtin, chart, legacy, linking, text
from tests import ROOT

PAGE = ROOT / "docs" / "grammars.md"
TEXT = PAGE.read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^```python\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", EXAMPLES)
def test_examples_run(code: str) -> None:
    exec(compile(code, str(PAGE), "exec"), {})


def test_all_formats_types_and_parameters_are_named() -> None:
    parameters = [*builtin.LENGTHS, "y", "n"]
    for name in [*filter(None, legacy.FORMATS), *builtin.TYPES, *parameters]:
        assert f"`{name}`" in TEXT or name == "semantics/1.0.2006", name


def test_limits_are_those_of_the_code() -> None:
    for number in (text.LONGEST, chart.MAX_STEPS, linking.MOST_DOCUMENTS):
        assert f"{number:,}" in TEXT
