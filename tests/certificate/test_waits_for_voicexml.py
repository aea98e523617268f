"""How long a certified reaction may wait for prompts of VoiceXML that are said elsewhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.devices.voice import SENTENCE_MS
from tests.helpers.certified import faults
from tests.helpers.certifying import PROFILE, TOUCH, lasting, run, voiced, waited

LONG = "A long story that goes on and on and on and on and on and on and on and on and on."
ASKS = '<field name="q" type="boolean"/>'
BACK = f'<form id="b"><block>{LONG}<return/></block></form>'
SAID = '<say>yes</say></when><when at="1100ms"><touch sensor="head"/>'


@pytest.mark.parametrize(
    ("body", "more", "timeout"),
    [
        (f'<form><block>{LONG}<goto next="#b"/></block></form><form id="b">{ASKS}</form>', "", 5),
        (
            f'<form><block><prompt timeout="9s">{LONG}</prompt><goto next="#b"/></block></form>'
            f'<form id="b"><field name="q" type="boolean"><prompt cond="false">X.</prompt></field></form>',
            "",
            9,
        ),
        (
            f'<form><property name="timeout" value="20s"/><block>{LONG}<goto next="#b"/></block>'
            f'</form><form id="b">{ASKS}</form>',
            "",
            20,
        ),
        (
            f'<form><block>{LONG}<goto next="more.vxml#b"/></block></form>',
            f'<form id="b">{ASKS}</form>',
            5,
        ),
        (f'<form><subdialog name="s" src="more.vxml#b"/>{ASKS}</form>', BACK, 5),
        (f'<form><subdialog name="s" src="#b"/>{ASKS}</form>{BACK}', "", 5),
        (
            f'<form><block><if cond="true"><goto nextitem="q"/></if>Hm.</block>{ASKS}</form>'
            f'<form id="b"><block>{LONG}</block></form>',
            "",
            5,
        ),
    ],
)
def test_a_question_may_ask_with_what_another_dialog_has_queued(
    tmp_path: Path, body: str, more: str, timeout: int
) -> None:
    """Prompts are queued until something listens, wherever that is (4.1.8)."""
    found, fa, ea = voiced(tmp_path, body, more=more)
    (delay,) = found.delays
    assert delay.known and delay.what == "question"
    assert 0 <= delay.lasts - lasting(LONG) - timeout * 1000 <= 1
    touch = TOUCH.replace("1s", "1ms")
    records = run(tmp_path, fa, ea, touch)
    assert faults(found, records, PROFILE.voices) == []


@pytest.mark.parametrize(
    "first",
    [
        "<block>Well?</block>",
        '<field name="p" type="boolean"><prompt>Well?</prompt></field>',
        f'<p:iu longest="9s"><block>Well?</block>{ASKS.replace("q", "p")}</p:iu><block>So.</block>',
    ],
)
def test_a_dialog_that_speaks_before_it_asks_asks_with_its_own_words(
    tmp_path: Path, first: str
) -> None:
    asks = f'<form id="b">{first}{ASKS}</form>'
    body = f'<form><block>{LONG}<goto next="#b"/></block></form>{asks}'
    (delay,) = voiced(tmp_path, body)[0].delays
    unit = "iu" in first
    assert unit or delay.lasts < lasting(LONG) + 5000


@pytest.mark.parametrize("src", ["#b", "more.vxml#b"])
@pytest.mark.parametrize(
    "first",
    [
        "<block>Well?</block>",
        '<field name="p" type="boolean"><prompt timeout="1s">Well?</prompt>'
        '<noinput><assign name="p" expr="true"/></noinput></field>',
    ],
)
def test_a_subdialog_may_queue_words_although_its_caller_speaks_first(
    tmp_path: Path, first: str, src: str
) -> None:
    body = f'<form>{first}<subdialog name="s" src="{src}"/>{ASKS}</form>{BACK}'
    found, fa, ea = voiced(tmp_path, body, more=BACK)
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "3s"))
    assert waited(records) > 7
    assert faults(found, records, PROFILE.voices) == []


def test_what_a_handler_of_another_item_says_may_be_asked_with(tmp_path: Path) -> None:
    """The item is filled, so that the next one listens; after a handler nothing is asked (C)."""
    fills = f'<noinput>{LONG}<assign name="p" expr="true"/></noinput>'
    record = '<record name="r" beep="true" maxtime="9s"><prompt>Now.</prompt></record>'
    prompt = '<prompt timeout="1s">Well?</prompt>'
    body = f'<form><field name="p" type="boolean">{prompt}{fills}</field>{record}</form>'
    found, fa, ea = voiced(tmp_path, body)
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "1600ms"))
    assert waited(records) * 1000 > lasting(LONG) + 5000
    assert faults(found, records, PROFILE.voices) == []


def test_a_beep_comes_after_the_pause_of_a_sentence(tmp_path: Path) -> None:
    body = f'<form><record name="r" beep="true" maxtime="9s">{LONG}</record></form>'
    found, fa, ea = voiced(tmp_path, body)
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "1ms"))
    assert waited(records) * 1000 >= lasting(LONG) + 5000 + 500 + SENTENCE_MS - 1
    assert faults(found, records, PROFILE.voices) == []


LISTED = "".join(
    f'<choice next="#m">the choice number {one}, a long one</choice>' for one in "abcd"
)
OPTIONS = LISTED.replace('choice next="#m"', "option").replace("/choice", "/option")
SAYS = "<noinput>Say <enumerate/></noinput>"


@pytest.mark.parametrize(
    "body",
    [
        f'<menu id="m"><prompt timeout="1s">Well?</prompt>{LISTED}{SAYS}</menu>',
        f'{SAYS}<menu id="m"><prompt timeout="1s">Well?</prompt>{LISTED}</menu>',
        f'{SAYS}<form><block><goto next="more.vxml#m"/></block></form>',
        f'<form>{SAYS}<field name="m"><prompt timeout="1s">Well?</prompt>{OPTIONS}</field></form>',
    ],
)
def test_a_handler_enumerates_the_choices_of_the_item_that_asks(tmp_path: Path, body: str) -> None:
    root = '<menu id="m"><prompt timeout="1s">Well?</prompt>' + LISTED + "</menu>"
    more = f"{SAYS if 'more' in body else ''}{root}"
    found, fa, ea = voiced(tmp_path, body, more=more)
    (delay,) = found.delays
    assert delay.known
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "1600ms"))
    assert waited(records) > 12
    assert faults(found, records, PROFILE.voices) == []


def test_a_handler_enumerates_the_choices_of_its_own_item(tmp_path: Path) -> None:
    short = f'<menu id="s"><choice next="#m">tea</choice>{SAYS}</menu>'
    long = f'<menu id="m"><prompt timeout="1s">Well?</prompt>{LISTED}</menu>'
    (delay,) = voiced(tmp_path, short + long)[0].delays
    assert delay.lasts < 12_000
