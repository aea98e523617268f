"""The report's page in a browser: it opens, is filtered, compared and read without scripts."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from prima import api
from prima.messages import Record
from prima.report import make

if TYPE_CHECKING:
    from playwright.sync_api import Browser
from tests.helpers.opened import DESK, PHONE, SCENARIO, SMALL_DESK, Opened, until


@pytest.mark.parametrize("name", ["one", "two", "bare", "ja"])
def test_it_opens_without_complaint_or_network(
    browser: Browser, pages: dict[str, Path], name: str
) -> None:
    with Opened(browser, pages[name], DESK) as opened:
        assert opened.page.locator(".timeline svg").count() == (2 if name == "two" else 1)
        assert opened.page.locator(".timeline rect.bar").count() > 10
        assert opened.page.locator("tr.row").count() > 30


def test_a_click_shows_why_and_moves_the_cursor(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        page = opened.page
        page.click("#row-14 .what")
        assert opened.clock() == 18.57
        why = page.inner_text("#why-14")
        for words in (
            "Why row 14 came at 18.57 s",
            "navigate.xml:61",
            "selected by rule S1; nothing else could start in its place",
            "an AB starts when no running AB occupies one of its devices",
            "follow:1 is suspended by navigate:1",
        ):
            assert words in why
        assert page.get_attribute("#row-14 button", "aria-expanded") == "true"
        assert page.get_attribute("#row-14", "aria-current") == "true"
        page.click("#row-14 .what")
        assert page.locator("#why-14").count() == 0
        page.click("#row-10 .what")
        assert "It reacts to row 9" in page.inner_text("#why-10")
        page.click("#why-10 a >> text=row 6")
        page.wait_for_selector("#why-6")
        assert opened.clock() == 5.3
        page.click("#row-4 .what")
        assert "came from outside" in page.inner_text("#why-4")


def test_rows_are_filtered_by_application_who_and_text(
    browser: Browser, pages: dict[str, Path]
) -> None:
    with Opened(browser, pages["one"], SMALL_DESK) as opened:
        page = opened.page
        every = page.locator("tr.row").count()
        page.click("#row-10 .what")
        page.select_option("#by-app", "navigate")
        apps = page.locator("tr.row:visible td.app").all_inner_texts()
        assert apps and set(apps) == {"navigate"} and not page.is_visible("#why-10")
        assert page.inner_text("#found") == f"{len(apps)} of {every} rows"
        page.fill("#by-text", "MESSAGE")
        rows = page.locator("tr.row:visible .what").all_inner_texts()
        assert rows and all("message" in row.lower() for row in rows)
        page.fill("#by-text", "no such thing")
        assert page.inner_text("#found") == f"0 of {every} rows"
        page.click("rect.bar[data-row='10'] >> nth=0")
        assert page.is_visible("#why-10") and page.inner_text("#found") == ""
        page.select_option("#by-who", "U")
        assert set(page.locator("tr.row:visible td:nth-child(3)").all_inner_texts()) == {"user"}
        page.focus("tr.row:visible button >> nth=0")
        page.keyboard.press("ArrowDown")
        assert page.evaluate("document.activeElement.closest('tr').classList.contains('who-U')")


def test_differences_are_filtered_as_well(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["two"], SMALL_DESK) as opened:
        page = opened.page
        page.check("#only")
        some = page.locator("tr.row:visible").count()
        page.select_option("#by-app", "follow")
        both = page.locator("tr.row:visible").count()
        assert 0 < both < some
        assert page.inner_text("#found").startswith(f"{both} of ")


def test_two_runs_show_what_differs(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["two"], DESK) as opened:
        page = opened.page
        kinds = page.locator("table.diff .kind").all_inner_texts()
        for word in ("> moved", "+ added", "- lost", "\\ joined", "~ changed", "t delayed"):
            assert any(kind.strip() == word for kind in kinds), word
        moved = page.locator("tr.kind-moved").first
        moved.locator("td.what").click()
        why = page.inner_text("tr.why")
        assert "Why in run A" in why and "Why in run B" in why
        assert page.locator("#timeline-0 .chosen").count() == 1
        assert page.locator("#timeline-1 .chosen").count() == 1
        every = page.locator("tr.row:visible").count()
        page.check("#only")
        some = page.locator("tr.row:visible").count()
        assert 0 < some < every
        assert page.locator("tr.kind-same:visible").count() == 0


def test_an_address_names_a_row(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        opened.page.goto(f"{pages['one'].as_uri()}#row-19")
        opened.page.reload()
        assert "held back by navigate:1 (rule F2)" in opened.page.inner_text("#why-19")
        opened.page.goto(f"{pages['one'].as_uri()}#row-99999")
        opened.requests.clear()
        opened.page.reload()


@pytest.mark.parametrize("name", ["one", "two"])
def test_paper_has_the_timeline_the_table_and_the_open_reasons(
    browser: Browser, pages: dict[str, Path], name: str
) -> None:
    with Opened(browser, pages[name], DESK, color_scheme="dark") as opened:
        page = opened.page
        page.click("#row-14 button")
        printed = page.evaluate(
            "addEventListener('afterprint', () => 0); window.strips = 0;"
            "new MutationObserver((all) => { window.strips = Math.max(window.strips, document.querySelectorAll('#paper svg').length); })"
            ".observe(document.getElementById('paper'), {childList: true})"
        )
        assert printed is None
        pdf = page.pdf(format="A4")
        assert pdf.startswith(b"%PDF") and len(pdf) > 20_000
        assert page.evaluate("window.strips") >= 3
        page.emulate_media(media="print")
        assert page.is_visible("#why-14") and not page.is_visible("#controls")
        assert not page.is_visible(".pictures")
        ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert ground == "rgb(255, 255, 255)"


def test_without_scripts_the_transcript_can_be_read(
    browser: Browser, pages: dict[str, Path]
) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(pages["one"].as_uri())
    assert page.is_visible("#row-34") and not page.is_visible("#play")
    assert "need JavaScript" in page.inner_text("main")
    context.close()


@pytest.mark.parametrize(("size", "most"), [(DESK, 150), (PHONE, 60)])
def test_a_long_run_opens_at_what_can_be_read(
    browser: Browser, long_page: Path, size: tuple[int, int], most: int
) -> None:
    with Opened(browser, long_page, size) as opened:
        page = opened.page
        told = re.fullmatch(
            r"Shown: 0 to (\d+) s of (\d+) s; .*Whole run.*", page.inner_text("#shown")
        )
        assert told and 30 <= int(told[1]) <= most < int(told[2])
        page.focus("#moment")
        page.keyboard.press("End")
        assert f"to {told[2]} s of {told[2]} s" in page.inner_text("#shown")
        page.click("#whole")
        assert page.inner_text("#shown") == "The whole run is shown."


def test_a_short_run_is_shown_whole(browser: Browser, pages: dict[str, Path]) -> None:
    with Opened(browser, pages["one"], DESK) as opened:
        assert opened.page.inner_text("#shown") == "The whole run is shown."


def spent(browser: Browser, path: Path, rows: int) -> dict[str, float]:
    """Processor time of the page's thread, in s, which other work on the machine does not change."""
    taken: dict[str, float] = {}
    with Opened(browser, path, DESK) as opened:
        page = opened.page
        clock = opened.context.new_cdp_session(page)
        clock.send("Performance.enable", {"timeDomain": "threadTicks"})

        def done(what: str) -> None:
            told = {
                one["name"]: one["value"] for one in clock.send("Performance.getMetrics")["metrics"]
            }
            taken[what] = told["TaskDuration"] - sum(taken.values())

        page.reload()
        page.wait_for_selector("#play")
        page.evaluate(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        assert page.locator("tr.row").count() >= rows
        done("open")
        page.click("#whole")
        until(page, "document.querySelectorAll('.timeline svg *').length > 20")
        assert page.locator(".timeline svg *").count() < 6000
        done("whole")
        page.evaluate(
            """async () => {
              for (let step = 0; step < 60; step += 1) {
                scrollBy(0, 700);
                await new Promise(requestAnimationFrame);
              }
            }"""
        )
        done("scroll")
        page.evaluate(f"location.hash = '#row-{rows - 100}'")
        page.wait_for_selector(f"#why-{rows - 100}")
        page.select_option("#speed", "60")
        page.click("#play")
        page.wait_for_timeout(500)
        page.click("#play")
        done("play")
    return taken


def test_five_thousand_rows_stay_usable(
    browser: Browser, short_page: Path, long_page: Path
) -> None:
    """Ten times as many rows cost at most five times as much: most of them are out of sight."""
    short, long = spent(browser, short_page, 500), spent(browser, long_page, 5000)
    most = {"open": 3, "scroll": 60 * 0.1, "play": 4}  # s: 0.1 s for each step
    slow = {
        what: (short[what], long[what])
        for what, bound in most.items()
        if long[what] > min(5 * short[what], bound)
    }
    assert slow == {}


HOSTILE = "</script><script>window.bad=1</script><img src=x onerror='window.bad=1'>\u2028\"'&\u202e"


def hostile(transcript: api.Transcript) -> api.Transcript:
    """A transcript in which every text is an attack."""
    text = json.dumps(transcript.records, ensure_ascii=False)
    for word in ("follow", "navigate", "Where are you?", "kidode-room", "speaker"):
        text = re.sub(rf'"{re.escape(word)}"', lambda _: json.dumps(HOSTILE), text)
    records: list[Record] = json.loads(text)
    for record in records:
        for name in ("text", "message", "source", "rule", "by"):
            if name in record:
                record[name] = HOSTILE
        if record["phase"] == "decision":
            record.update(losers=["__proto__", "constructor", HOSTILE], rule="toString")
    return api.Transcript(records, HOSTILE, cut=HOSTILE)


@pytest.mark.parametrize("count", [1, 2])
def test_nothing_that_a_transcript_says_is_run(
    browser: Browser, tmp_path: Path, count: int
) -> None:
    bad = hostile(api.rehearse(SCENARIO))
    path = tmp_path / "bad.html"
    path.write_text(make([bad, api.rehearse(SCENARIO)][:count]), encoding="utf-8")
    with Opened(browser, path, DESK) as opened:
        for row in (3, 9, 10, 12, 14):
            opened.page.click(f"#row-{row} button")
        opened.page.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert opened.page.evaluate("window.bad") is None
        assert opened.page.locator("img").count() == 0
        assert opened.page.locator("script").count() == 2
        assert HOSTILE.replace("\u2028", "")[:30] in opened.page.inner_text("#transcript")
