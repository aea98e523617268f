"""Pages of reports, opened in a browser."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests import ROOT

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


SCENARIO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"
CHROMIUM = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)  # fmt: skip
DESK, PHONE = (1440, 900), (390, 844)


def until(page: Page, condition: str, old: object = None) -> None:
    """Wait until a condition holds; the page lets nobody evaluate text, playwright neither."""
    end = time.monotonic() + 20
    while not page.evaluate(f"old => {condition}", old):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(50)


class Opened:
    """A page with all that it complained of and asked for."""

    def __init__(
        self,
        browser: Browser,
        path: Path,
        size: tuple[int, int],
        wait: str = "#play",
        **more: Any,
    ) -> None:
        viewport = {"width": size[0], "height": size[1]}
        self.context = browser.new_context(viewport=viewport, **more)  # type: ignore[arg-type]
        self.page: Page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector(wait)

    def close(self) -> None:
        assert self.complaints == []
        own = [url for url in self.requests if not url.startswith("file:")]
        assert own == [] and len(set(self.requests)) == 1
        self.context.close()

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.context.close()

    def clock(self) -> float:
        return float((self.page.text_content("#controls .clock") or "").split(" ")[0])


SMALL_DESK = (1280, 800)
