"""What the tests of this room share."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from prima import api
from prima.report import make
from tests.helpers.generated_report import long_run

if TYPE_CHECKING:
    from playwright.sync_api import Browser
from tests.helpers.opened import CHROMIUM, SCENARIO


@pytest.fixture(scope="module")  # its event loop must not outlast these tests
def browser() -> Iterator[Browser]:
    pytest.importorskip("playwright")
    from playwright.sync_api import sync_playwright

    if CHROMIUM is None:
        assert "CI" not in os.environ, "CI has to install chromium"
        pytest.skip("there is no chromium on this machine")
    with sync_playwright() as started:
        opened = started.chromium.launch(
            executable_path=CHROMIUM,
            args=["--no-sandbox", "--disable-gpu", "--disable-software-rasterizer"],
        )
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One run, two runs, one without its scenario, and one in Japanese, as files."""
    folder = tmp_path_factory.mktemp("pages")
    loaded = api.load_scenario(SCENARIO)
    first, second = api.rehearse(SCENARIO), api.rehearse(SCENARIO, "fifo")
    japanese = SCENARIO.with_name("follow-during-navigation-ja.xml")
    made = {
        "one": make([first], [loaded]),
        "two": make([first, second], [loaded]),
        "bare": make([first]),
        "ja": make([api.rehearse(japanese)]),
    }
    return {name: written(folder, name, text) for name, text in made.items()}


@pytest.fixture(scope="session")
def short_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 500 rows, as a file."""
    return written(tmp_path_factory.mktemp("pages"), "short", make([long_run(500)]))


@pytest.fixture(scope="session")
def long_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 5,000 rows, as a file."""
    return written(tmp_path_factory.mktemp("pages"), "long", make([long_run(5000)]))


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / f"{name}.html"
    path.write_text(text, encoding="utf-8")
    return path
