"""The report's page by keyboard, touch, screen reader and on narrow screens."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests import ROOT

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page
from tests.helpers.opened import DESK, PHONE, Opened, until

AXE = ROOT / "tests" / "browser" / "node_modules" / "axe-core" / "axe.min.js"


def test_the_keyboard_goes_everywhere(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        page = opened.page
        focused = "document.activeElement.id || document.activeElement.closest('tr')?.id || document.activeElement.tagName"
        seen = []
        for _ in range(22):
            page.keyboard.press("Tab")
            seen.append(page.evaluate(focused))
            outline = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
            assert outline != "none", seen
        for wanted in ("A", "play", "speed", "moment", "closer", "timeline-0", "row-0"):
            assert wanted in seen
        page.focus("#row-0 button")
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowDown")
        assert page.evaluate(focused) == "row-2"
        page.keyboard.press("Enter")
        assert page.locator("#why-2").count() == 1
        page.keyboard.press("End")
        assert page.evaluate(focused) == "row-34"
        page.focus("#timeline-0")
        whole = page.get_attribute(".timeline svg", "aria-label")
        page.keyboard.press("+")
        until(
            page,
            "document.querySelector('.timeline svg').getAttribute('aria-label') !== old",
            whole,
        )
        page.keyboard.press("0")
        until(
            page,
            "document.querySelector('.timeline svg').getAttribute('aria-label') === old",
            whole,
        )
        page.focus("#moment")
        page.keyboard.press("PageUp")
        assert opened.clock() > 1
        assert "s: " in (page.get_attribute("#moment", "aria-valuetext") or "")
        page.keyboard.press("Home")
        assert opened.clock() == 0


def test_a_touch_screen_needs_no_pointer_that_hovers(
    browser: Browser, pages: dict[str, Path]
) -> None:
    with Opened(browser, pages["one"], PHONE, has_touch=True, is_mobile=True) as opened:
        page = opened.page
        assert page.locator("[title]").count() == page.locator("svg title").count() == 0
        small = page.locator(
            "button:visible, select:visible, summary:visible, input:visible"
        ).evaluate_all(
            "all => all.filter((one) => { const box = one.getBoundingClientRect();"
            " return box.height < 43.9 || box.width < 43.9; }).map((one) => one.outerHTML)"
        )
        assert small == []
        short = page.locator(".timeline rect.bar").evaluate_all(
            "all => all.filter((one) => one.getBoundingClientRect().height < 24).length"
        )
        assert short == 0
        page.locator(".help summary >> nth=0").tap()
        assert "tap on any mark opens its row" in page.inner_text(".help >> nth=0")
        page.locator("rect.bar[data-row='10'] >> nth=0").tap()
        assert page.is_visible("#why-10")
        page.wait_for_timeout(100)
        box = page.locator("#row-10").bounding_box()
        assert box and 0 <= box["y"] < PHONE[1], "it has come into view"


def test_the_skip_link_leads_to_the_transcript(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        opened.page.keyboard.press("Tab")
        opened.page.keyboard.press("Enter")
        assert opened.page.evaluate("document.activeElement.id") == "transcript"


def test_less_motion_plays_in_steps(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK, reduced_motion="reduce") as opened:
        page = opened.page
        page.evaluate(
            "window.moves = 0; new MutationObserver(() => window.moves++)"
            ".observe(document.querySelector('#controls .clock'), {childList: true})"
        )
        page.click("#play")
        page.wait_for_timeout(1300)
        page.click("#play")
        assert 1 <= page.evaluate("window.moves") <= 6


def axe(page: Page) -> list[str]:
    """What axe-core finds, each with its place."""
    if not AXE.is_file() and "CI" not in os.environ:
        pytest.skip("axe-core is not installed: npm ci --prefix tests/browser")
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate("async () => (await axe.run(document)).violations")
    return [
        f"{one['id']}: {node['html'][:200]} {node['failureSummary']}"
        for one in found
        for node in one["nodes"]
    ]


PAIRS = [("light", DESK), ("dark", PHONE)], [("dark", DESK), ("light", PHONE)]
"""Each scheme in each size, on one page or another."""


@pytest.mark.parametrize(
    ("name", "scheme", "size"),
    [
        (name, *pair)
        for names, pairs in zip((["one", "ja"], ["two", "bare"]), PAIRS, strict=True)
        for name in names
        for pair in pairs
    ],
)
def test_axe_finds_nothing(
    browser: Browser, pages: dict[str, Path], name: str, scheme: str, size: tuple[int, int]
) -> None:
    with Opened(browser, pages[name], size, color_scheme=scheme) as opened:
        opened.page.click("#row-12 button")
        opened.page.click("summary >> nth=0")
        assert axe(opened.page) == []


@pytest.mark.parametrize("name", ["one", "two"])
def test_a_narrow_page_needs_no_sideways_scrolling(
    browser: Browser, pages: dict[str, Path], name: str
) -> None:
    with Opened(browser, pages[name], (320, 640)) as opened:
        opened.page.click("#row-12 button")
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= 320


CONTRAST = """() => {
  const paint = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const numbers = (css) => {
    paint.fillStyle = css; paint.fillRect(0, 0, 1, 1);
    return [...paint.getImageData(0, 0, 1, 1).data].slice(0, 3);
  };
  const light = (css) => {
    const [r, g, b] = numbers(css).map((v) => v / 255).map((v) => v <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4);
    return .2126 * r + .7152 * g + .0722 * b;
  };
  const root = getComputedStyle(document.documentElement);
  const colour = (name) => light(root.getPropertyValue(name).trim());
  const ratio = (a, b) => (Math.max(colour(a), colour(b)) + .05) / (Math.min(colour(a), colour(b)) + .05);
  const text = [];
  for (const ground of ['--paper', '--soft', '--fill0', '--fill1', '--fill2', '--fill3', '--fill4', '--fill5', '--fill6']) text.push(['--ink', ground]);
  for (const ground of ['--paper', '--soft']) for (const ink of ['--quiet', '--strong']) text.push([ink, ground]);
  text.push(['--on-strong', '--strong']);
  const marks = [0, 1, 2, 3, 4, 5, 6].map((n) => ['--line' + n, '--paper']);
  marks.push(['--focus', '--paper'], ['--focus', '--soft'], ['--hatch', '--paper']);
  return [...text.map(([a, b]) => [a, b, ratio(a, b), 4.5]), ...marks.map(([a, b]) => [a, b, ratio(a, b), 3])];
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_colours_can_be_told_apart_from_their_ground(
    browser: Browser, pages: dict[str, Path], scheme: str
) -> None:
    with Opened(browser, pages["one"], DESK, color_scheme=scheme) as opened:
        for ink, ground, ratio, least in opened.page.evaluate(CONTRAST):
            assert ratio >= least, (ink, ground, ratio)
