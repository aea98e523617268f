"""The pictures of the report's page: bars, marks, the map, and playing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from prima import api
from prima.graph import streams
from prima.transcript.colours import colours

if TYPE_CHECKING:
    from playwright.sync_api import Browser
from tests.helpers.opened import DESK, PHONE, SCENARIO, SMALL_DESK, Opened, until


@pytest.mark.parametrize("name", ["one", "two"])
@pytest.mark.parametrize("size", [SMALL_DESK, PHONE], ids=["desk", "phone"])
def test_tiles_are_on_one_line_and_maps_in_view(
    browser: Browser, pages: dict[str, Path], name: str, size: tuple[int, int]
) -> None:
    with Opened(browser, pages[name], size) as opened:
        heads = opened.page.locator(".measures")
        for index in range(heads.count()):
            tops = (
                heads.nth(index)
                .locator("div")
                .evaluate_all("all => all.map((one) => one.getBoundingClientRect().top)")
            )
            assert len(tops) >= 9 and len(set(tops)) == 1
        box = opened.page.locator(".map svg").first.bounding_box()
        assert box and box["y"] + box["height"] <= size[1]
        if size == SMALL_DESK:
            strips = "[...document.querySelectorAll('.strip')].every((one) => one.scrollWidth <= one.clientWidth)"
            assert opened.page.evaluate(strips)


def test_a_bar_can_be_read_under_the_pointer_and_by_keyboard(
    browser: Browser, pages: dict[str, Path]
) -> None:
    with Opened(browser, pages["one"], SMALL_DESK) as opened:
        page = opened.page
        told = page.locator("#pointed.shown")
        page.hover("rect.bar[data-row='10'] >> nth=0")
        whole = '"What\'s the matter with you?", 11.30 to 15.48 s'
        assert whole in told.inner_text()
        page.mouse.move(2, 2)
        assert told.count() == 0
        page.focus("#timeline-0")
        page.keyboard.press("ArrowDown")
        assert "Prof. Kidode's room." in told.inner_text()
        page.keyboard.press("ArrowRight")
        assert "goes along with the robot" in told.inner_text()
        page.keyboard.press("ArrowDown")
        assert "navigate" in told.inner_text() or "follow" in told.inner_text()
        seen = told.inner_text()
        page.keyboard.press("ArrowRight")
        assert told.inner_text() != seen
        page.keyboard.press("Escape")
        assert page.evaluate("document.activeElement.id") == "timeline-0" and told.count() == 0


def test_a_mark_is_opened_by_enter(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], SMALL_DESK) as opened:
        page = opened.page
        page.focus("rect.bar[data-row='10'] >> nth=0")
        page.keyboard.press("Enter")
        assert "Why row 10" in page.inner_text("#why-10")
        assert page.evaluate("document.activeElement.closest('tr').id") == "row-10"


KINDS = ("rect.bar", "path.flag", "rect.away", "line.near", "path.near", "text.said")


def test_a_click_on_anything_opens_the_row_that_it_marks(
    browser: Browser, pages: dict[str, Path]
) -> None:
    with Opened(browser, pages["one"], SMALL_DESK) as opened:
        page = opened.page
        lanes = page.locator("[data-lane]").evaluate_all(
            "all => all.filter((one) => !one.dataset.row).map((one) => one.outerHTML)"
        )
        assert lanes == [], "each mark has its row"
        for kind in KINDS:
            mark = page.locator(f".timeline {kind}").first
            row = mark.get_attribute("data-row")
            box = mark.bounding_box()
            assert box
            page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            assert page.get_attribute(f"#row-{row} button", "aria-expanded") == "true", kind
            page.wait_for_timeout(50)
        page.click("#now-0 a >> nth=0")
        assert page.locator("tr.why").count() >= 1


def test_a_click_on_the_map_goes_to_the_moment_there(
    browser: Browser, pages: dict[str, Path]
) -> None:
    with Opened(browser, pages["one"], SMALL_DESK) as opened:
        page = opened.page
        ends = page.locator(".trail:not(.person)").evaluate(
            "one => { const point = one.getPointAtLength(one.getTotalLength() * .97), m = one.getScreenCTM();"
            " return [point.x * m.a + m.e, point.y * m.d + m.f]; }"
        )
        page.mouse.click(*ends)
        assert opened.clock() > 70
        assert page.locator("tr.why").count() == 1


def test_an_application_has_its_colour_in_all_pictures(
    browser: Browser, pages: dict[str, Path]
) -> None:
    made = api.rehearse(SCENARIO)
    shades = colours(made.run().apps)
    drawn = streams(made)
    with Opened(browser, pages["two"], SMALL_DESK) as opened:
        page = opened.page
        for app, shade in shades.items():
            cell = page.locator("td.app", has_text=app).first
            assert f"app{shade}" in (cell.get_attribute("class") or "")
            lane = page.locator(f"rect.bar[data-lane^='app'][data-text^='{app}#']")
            for index in (0, lane.count() - 1):
                assert f"fill{shade}" in (lane.nth(index).get_attribute("class") or "")
            fill = page.evaluate(
                "name => getComputedStyle(document.documentElement).getPropertyValue(name).trim()",
                f"--fill{shade}",
            )
            assert f".s{shade} {{ fill: {fill};" in drawn
        shade = shades["navigate"]
        assert page.locator(f".map .area.line{shade}").count() == 2


def test_it_plays_faster_pauses_and_ends(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        page = opened.page
        before = page.get_attribute(".robot", "cx")
        page.select_option("#speed", "10")
        page.click("#play")
        until(page, "Number(document.getElementById('moment').value) > 8")
        page.click("#play")
        held = opened.clock()
        assert page.text_content("#play") == "Play"
        assert page.get_attribute(".robot", "cx") != before
        page.wait_for_timeout(200)
        assert opened.clock() == held
        page.select_option("#speed", "60")
        page.click("#play")
        until(page, "document.getElementById('play').textContent === 'Play'")
        assert opened.clock() == 78.16
