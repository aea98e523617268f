"""The page of a sweep in a browser: maps of other factors, copied tables, keyboard, print, axe-core."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("scipy")

from prima import results
from tests.browser.test_accessibility import axe
from tests.helpers.opened import DESK, PHONE, Opened
from tests.helpers.swept import runs, write

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sweep")
    path = folder / "page.html"
    path.write_text(results.make(results.read(write(folder, runs())), folder), encoding="utf-8")
    return path


def opened(browser: Browser, page: Path, size: tuple[int, int] = DESK, **more: Any) -> Opened:
    return Opened(browser, page, size, wait="#map-rows", **more)


@pytest.mark.parametrize(("scheme", "size"), [("light", DESK), ("dark", PHONE)])
def test_axe_finds_nothing(
    browser: Browser, page: Path, scheme: str, size: tuple[int, int]
) -> None:
    with opened(browser, page, size, color_scheme=scheme) as shown:
        for summary in shown.page.locator("summary").all():
            summary.click()
        assert axe(shown.page) == []


@pytest.mark.parametrize("width", [320, 1440])
def test_a_page_needs_no_sideways_scrolling(browser: Browser, page: Path, width: int) -> None:
    with opened(browser, page, (width, 700)) as shown:
        assert shown.page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_map_is_drawn_anew_for_other_factors(browser: Browser, page: Path) -> None:
    with opened(browser, page) as shown:
        first = shown.page.inner_html("#map")
        shown.page.select_option("#map-rows", label="policy")
        shown.page.select_option("#map-columns", label="when.at")
        rows = shown.page.locator("#map tbody tr")
        assert rows.all_inner_texts() == [
            "\t".join(["prima", *["1"] * 10]),
            "\t".join(["fifo", *["2"] * 8, "3", "3"]),
        ]
        link = shown.page.locator("#map tbody a").first
        assert link.get_attribute("href") == "./sweep/orders/aaaaaaaaaaaa.jsonl"
        assert link.get_attribute("aria-label") == "Order 1, 3 of 3 runs"
        assert "by policy and when.at" in shown.page.inner_text("#said")
        shown.page.select_option("#map-columns", label="none")
        assert rows.all_inner_texts() == ["prima\t1", "fifo\t2 +1"]
        shown.page.select_option("#map-columns", label="policy")
        assert rows.all_inner_texts() == ["prima\t1", "fifo\t2 +1"], "by itself is by none"
        shown.page.select_option("#map-rows", label="when.at")
        shown.page.select_option("#map-columns", label="answer")
        assert shown.page.inner_html("#map") == first.replace("\n", ""), "as Python drew it"


def test_colours_are_those_of_the_orders(browser: Browser, page: Path) -> None:
    with opened(browser, page) as shown:
        shown.page.select_option("#map-columns", label="policy")
        colour = "one => getComputedStyle(one).backgroundColor"
        cells = shown.page.locator("#map tbody tr").first.locator("td")
        keys = shown.page.locator("#orders .key")
        for index in (0, 1):
            assert cells.nth(index).evaluate(colour) == keys.nth(index).evaluate(colour)
        assert len({keys.nth(index).evaluate(colour) for index in range(3)}) == 3


def test_a_table_is_copied_with_tabs(browser: Browser, page: Path) -> None:
    with opened(browser, page, permissions=["clipboard-read", "clipboard-write"]) as shown:
        button = shown.page.locator("button.copy[data-table=measures]")
        button.focus()
        shown.page.keyboard.press("Enter")
        shown.page.wait_for_function("() => document.getElementById('said').textContent")
        copied = shown.page.evaluate("navigator.clipboard.readText()").splitlines()
        assert copied[0].split("\t")[:4] == ["Measure", "Runs", "Missing", "Mean"]
        assert copied[1].split("\t")[:4] == ["seconds (s)", "60", "0", "29.5"]
        assert len(copied) == 5
        assert "Copied 5 rows of “Measures over all runs”." in shown.page.inner_text("#said")
        assert button.inner_text() == "Copied" and button.evaluate(
            "one => one === document.activeElement"
        )


def test_the_keyboard_goes_everywhere(browser: Browser, page: Path) -> None:
    with opened(browser, page) as shown:
        seen = set()
        for _ in range(120):
            shown.page.keyboard.press("Tab")
            if shown.page.evaluate("document.activeElement === document.body"):
                break
            outline = "getComputedStyle(document.activeElement).outlineStyle"
            assert shown.page.evaluate(outline) != "none"
            seen.add(
                shown.page.evaluate(
                    "(({id, href, dataset, className, tagName}) => id || dataset.table ||"
                    " (tagName === 'A' && new URL(href).hash) || className || tagName)(document.activeElement)"
                )
            )
        wanted = {"#measures-title", "#m0", "scroll", "SUMMARY", "tests", "map-rows", "map-columns"}
        assert wanted <= seen


def test_without_scripts_everything_but_the_choice_is_there(browser: Browser, page: Path) -> None:
    with Opened(browser, page, DESK, wait="#map", java_script_enabled=False) as shown:
        assert shown.page.locator("#map td").count() == 30
        assert shown.page.is_hidden(".choose") and shown.page.is_hidden("button.copy >> nth=0")


def test_paper_has_figures_tables_and_map(browser: Browser, page: Path) -> None:
    with opened(browser, page, color_scheme="dark") as shown:
        shown.page.emulate_media(media="print")
        for hidden in ("nav", ".choose", "button.copy"):
            assert shown.page.is_hidden(f"{hidden} >> nth=0")
        for there in (
            "#factors",
            "#measures",
            "figure >> nth=3",
            "#tests",
            "#map",
            "#orders",
            "math >> nth=0",
        ):
            assert shown.page.is_visible(there), there
        ground = "getComputedStyle(document.body).backgroundColor"
        assert shown.page.evaluate(ground) == "rgb(255, 255, 255)"
        bars = "getComputedStyle(document.querySelector('.bin')).fill"
        assert shown.page.evaluate(bars) == "rgb(156, 195, 234)", "as in the light"
        assert len(shown.page.pdf()) > 20_000
