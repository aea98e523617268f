"""The report's page in a browser: as a reader, a keyboard, a screen reader and paper have it."""

from __future__ import annotations

import json
import os
import re
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from prima import api
from prima.graph import streams
from prima.messages import Record
from prima.report import make
from prima.transcript.colours import colours
from tests import ROOT
from tests.helpers.generated_report import long_run

SCENARIO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"
CHROMIUM = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)  # fmt: skip
AXE = ROOT / "tests" / "browser" / "node_modules" / "axe-core" / "axe.min.js"
DESK, PHONE = (1440, 900), (390, 844)

if CHROMIUM is None and "CI" not in os.environ:
    pytest.skip("there is no chromium on this machine", allow_module_level=True)
if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page
else:
    pytest.importorskip("playwright")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    assert CHROMIUM, "CI has to install chromium"
    with sync_playwright() as started:
        opened = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One run, two runs, one in Japanese, and a long one, as files."""
    folder = tmp_path_factory.mktemp("pages")
    loaded = api.load_scenario(SCENARIO)
    first, second = api.rehearse(SCENARIO), api.rehearse(SCENARIO, "fifo")
    japanese = SCENARIO.with_name("follow-during-navigation-ja.xml")
    made = {
        "one": make([first], [loaded]),
        "two": make([first, second], [loaded]),
        "bare": make([first]),
        "ja": make([api.rehearse(japanese)]),
        "long": make([long_run(5000)]),
    }
    paths = {}
    for name, text in made.items():
        paths[name] = folder / f"{name}.html"
        paths[name].write_text(text, encoding="utf-8")
    return paths


def until(page: Page, condition: str, old: object = None) -> None:
    """Wait until a condition holds; the page lets nobody evaluate text, playwright neither."""
    end = time.monotonic() + 20
    while not page.evaluate(f"old => {condition}", old):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(50)


class Opened:
    """A page with all that it complained of and asked for."""

    def __init__(self, browser: Browser, path: Path, size: tuple[int, int], **more: Any) -> None:
        viewport = {"width": size[0], "height": size[1]}
        self.context = browser.new_context(viewport=viewport, **more)  # type: ignore[arg-type]
        self.page: Page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("#play")

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


SMALL_DESK = (1280, 800)


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
            assert len(tops) == 9 and len(set(tops)) == 1
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


@pytest.mark.parametrize("name", ["one", "two", "bare", "ja"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
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
    browser: Browser, pages: dict[str, Path], size: tuple[int, int], most: int
) -> None:
    with Opened(browser, pages["long"], size) as opened:
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


def test_five_thousand_rows_stay_usable(browser: Browser, pages: dict[str, Path]) -> None:
    began = time.monotonic()
    with Opened(browser, pages["long"], DESK) as opened:
        page = opened.page
        page.evaluate(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        assert time.monotonic() - began < 3
        assert page.locator("tr.row").count() >= 5000
        page.click("#whole")
        until(page, "document.querySelectorAll('.timeline svg *').length > 20")
        assert page.locator(".timeline svg *").count() < 6000
        longest = page.evaluate(
            """async () => {
              const frames = [];
              let last = performance.now();
              for (let step = 0; step < 60; step += 1) {
                scrollBy(0, 700);
                await new Promise(requestAnimationFrame);
                frames.push(performance.now() - last);
                last = performance.now();
              }
              return frames.sort((a, b) => a - b)[54];
            }"""
        )
        assert longest < 100, longest  # ms; nine frames of ten, on a machine that has other work
        began = time.monotonic()
        page.evaluate("location.hash = '#row-4900'")
        page.wait_for_selector("#why-4900")
        page.select_option("#speed", "60")
        page.click("#play")
        page.wait_for_timeout(500)
        page.click("#play")
        assert time.monotonic() - began < 4


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
