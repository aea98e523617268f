"""A pytest plugin: scenarios with expectations are tests (docs/testing.md).

It reads only the beginning of XML files, and imports PRIMA only if one is a scenario.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from prima.testing.running import Result

OPTION = "prima_scenarios"
BEGINNING = 65_536
"""Bytes of a file that are searched for a scenario's namespace."""
NAMESPACE = b"urn:prima:scenario:"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that turns the plugin off."""
    parser.addini(OPTION, "whether scenarios of PRIMA are tests", type="bool", default=True)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """Collect XML files that are scenarios with expectations."""
    if file_path.suffix != ".xml" or not parent.config.getini(OPTION):
        return None
    if not _begins_as_scenario(file_path):
        return None
    from prima.testing.finding import expects, is_scenario

    if not is_scenario(file_path) or not expects(file_path):
        return None
    made: ScenarioFile = ScenarioFile.from_parent(parent, path=file_path)
    return made


def _begins_as_scenario(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return NAMESPACE in stream.read(BEGINNING).replace(b"\0", b"")
    except OSError:
        return False


class ScenarioFile(pytest.File):
    """A scenario's file, which holds one test."""

    def collect(self) -> Iterator[pytest.Item]:
        """The run of the scenario."""
        yield ScenarioItem.from_parent(self, name="scenario")


class ScenarioFailed(Exception):
    """A run did not meet its scenario's expectations."""


class ScenarioItem(pytest.Item):
    """The run of a scenario."""

    result: Result | None = None

    def runtest(self) -> None:
        """Run it and check the expectations."""
        import os

        from prima.testing.running import TestOptions, run_one
        from prima.testing.summary import format_result

        self.result = run_one(os.path.relpath(self.path), TestOptions())
        if self.result.status != "passed":
            raise ScenarioFailed(format_result(self.result))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The failures; PRIMA's own errors without a traceback."""
        from prima.errors import PrimaError

        if isinstance(excinfo.value, ScenarioFailed | PrimaError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """The place of the first failure, once known (lines count from 0)."""
        failures = self.result.failures if self.result is not None else []
        line = failures[0].place.line - 1 if failures else None
        return self.path, line, f"scenario: {self.path.stem}"
