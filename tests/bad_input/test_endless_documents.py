"""Documents that never wait, send themselves events, or want memory without end."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from tests.helpers.bad_input import (
    BAD,
    CATCH,
    GIGABYTE,
    GOOD,
    PLAY,
    SECONDS,
    Prima,
    app,
    block,
    form,
    grammar,
    messages,
    process,
    scenario,
    stage,
    write,
)

# Documents that do not wait ---------------------------------------------------------
AT_ONCE = '<send event="a.b" delay="0s"/>'
LOOPS = [
    ("goto", block('<goto next="#f"/>'), "loops without ever waiting"),
    ("goto-cycle", block('<goto next="#g"/>') + form('<block><goto next="#f"/></block>', "g"), "without ever waiting"),
    ("item", form('<block name="b"><goto nextitem="b"/></block>'), "without ever waiting"),
    ("clear", block("<clear/>"), "without ever waiting"),
    ("send", block(AT_ONCE).replace("</form>", f'<on event="a.b">{AT_ONCE}<log>x</log></on></form>'), "without ever waiting"),
    ("sends", block(AT_ONCE * 40).replace("</form>", f'<on event="a.b"><log>x</log>{AT_ONCE}</on></form>'), "without ever waiting"),
    ("throw", block('<throw event="a"/>').replace("</form>", '<on event="a"><throw event="a"/></on></form>'), "throw without end"),
    ("throw-deep", block('<throw event="a"/>').replace("</form>", '<on event="a">' + '<if cond="true">' * 90 + '<throw event="a"/>' + "</if>" * 90 + "</on></form>"), "throw without end"),
    ("error-in-error", form(f'<block><throw event="error.x"/></block><on event="error"><log expr="{BAD}"/></on>'), "throw without end"),
    ("subdialog", form('<subdialog src="#f"/>'), "more than 32 subdialogs"),
    ("subdialog-loop", form('<subdialog name="s" src="#g"><filled><clear/></filled></subdialog>') + form("<block><return/></block>", "g"), "without ever waiting"),
    ("foreach", block('<foreach item="i" array="Array(9000).fill(1)"><foreach item="j" array="Array(9000).fill(1)"><log>x</log></foreach></foreach>'), "without ever waiting"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "body", "message"), LOOPS)
def test_loops(prima: Prima, tmp_path: Path, name: str, body: str, message: str) -> None:
    prima("run", stage(tmp_path, app(body))).check(3, "prima: a: ", "app.xml:2", message)


def test_who_sends_himself_event_after_event_ends_alone(prima: Prima, tmp_path: Path) -> None:
    loops = block(AT_ONCE).replace("</form>", f'<on event="a.b">{AT_ONCE}</on></form>')
    write(tmp_path, "bad.xml", app(loops, name="bad"))
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", scenario('<application src="bad.xml"/>' + PLAY))
    prima("run", "s.xml", "-o", "t").check(3, "prima: bad: error.semantic: bad.xml:2:1: it loops")
    assert messages(tmp_path / "t") == ["alive"]
    assert len((tmp_path / "t").read_bytes()) < 5_000_000


def test_who_waits_between_his_events_may_go_on(prima: Prima, tmp_path: Path) -> None:
    ticks = AT_ONCE.replace("0s", "20ms")
    path = stage(
        tmp_path,
        app(block(AT_ONCE).replace("</form>", f'<on event="a.b">{ticks}</on></form>')),
        attributes='until="600s"',
    )
    prima("run", path, "-o", "t").check(0)
    assert (tmp_path / "t").read_text().count('"a.b"') > 29_000


def test_subdialogs_inside_each_other_can_be_handled(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(form(f'<subdialog src="#f"/>{CATCH}')))
    prima("run", path).check(0, "caught app.xml:2:14: more than 32")


STORMS = [
    ("noinput", form('<field name="q" type="text"><prompt timeout="0s">x</prompt><noinput><reprompt/></noinput></field>'), "", 0),
    ("cancel", form('<on event="go"><speak order="now">x</speak></on><on event="cancel"><speak order="now">y</speak></on>'), '<when at="1s">' + '<event name="go"/>' * 3 + "</when>", 3),
    ("end", form('<block><speak>x</speak></block><on event="end"><speak>y</speak></on>'), "", 0),
    ("handlers", form('<on event="go"><speak>x</speak></on>'), '<when at="1s">' + '<event name="go"/>' * 200 + "</when>", 3),
    ("timers", block("<foreach item=\"i\" array=\"Array(999).fill(1)\"><send event=\"x\" delay=\"9s\"/></foreach>"), "", 3),
]  # fmt: skip


@pytest.mark.parametrize(("name", "body", "happens", "code"), STORMS)
def test_storms(
    prima: Prima, tmp_path: Path, name: str, body: str, happens: str, code: int
) -> None:
    prima("run", stage(tmp_path, app(body), happens), "-o", "t").check(code)


EATERS = [
    ("huge-array", app(block('<foreach item="i" array="Array(100000)"><log>x</log></foreach>')), 3),
    ("endless-array", app(block('<foreach item="i" array="Array(1e9)"><log>x</log></foreach>')), 3),
    ("no-array", app(block("<script>Array.isArray = function () { return true }</script><foreach item=\"i\" array=\"({length: 'z'})\"/>")), 3),
    ("slow-errors", app(block('<log expr="(function(){while(1);})()"/>').replace("</form>", '<on event="error"><goto next="#f"/></on></form>')), 3),
    ("logs", app(block("<foreach item=\"i\" array=\"Array(9000).fill(1)\"><log expr=\"'x'.repeat(99999)\"/></foreach><exit/>")), 3),
    ("values", app(block("<var name=\"b\" expr=\"'x'.repeat(99999)\"/><speak>" + '<value expr="b"/>' * 30_000 + "</speak><exit/>")), 0),
    ("handlers-of-new-events", app(form("<block><assign name=\"n\" expr=\"n + 1\"/><throw event-expr=\"'a.' + n\"/></block>" + '<on event="a" count="999"/>' * 20_000 + '<on event="a"><goto next="#f"/></on>').replace("<form", '<var name="n" expr="0"/><form', 1)), 3),
    ("event-name", app(block('<throw event="' + "a." * 60_000 + 'a"/>').replace("</form>", '<on event="a"><exit/></on></form>')), 1),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "code"), EATERS, ids=lambda value: str(value)[:20])
def test_time_and_memory(tmp_path: Path, name: str, data: str, code: int) -> None:
    path = stage(tmp_path, data)
    process(tmp_path, "run", path, "-o", "t", seconds=6, memory=GIGABYTE).check(code)


def test_events_among_very_many_handlers_of_voicexml(tmp_path: Path) -> None:
    many = "".join(f'<catch event="e{number}"/>' for number in range(40_000))
    write(
        tmp_path,
        "a.vxml",
        f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form id="f">{many}'
        '<block><throw event="go"/></block><catch event="go"><goto next="#f"/></catch></form></vxml>',
    )
    process(tmp_path, "run", "--ea", "a.vxml", "-o", "t", seconds=6, memory=GIGABYTE).check(3)


HAPPENINGS = [
    ("text", '<sensor name="a" value="&#x1F600;"/>', 0),
    ("late-clash", '<sensor name="a.b" value="1"/><sensor name="a" value="1"/>', 0),
    ("nan", '<sensor name="a" value="nan"/>', 0),
    ("clash", '<sensor name="a" value="1"/><sensor name="a.b" value="1"/>', 0),
    ("far", '<walk x="1e308" y="-1e308"/>', 1),
]  # fmt: skip


@pytest.mark.parametrize(("name", "happens", "code"), HAPPENINGS)
def test_happenings(prima: Prima, tmp_path: Path, name: str, happens: str, code: int) -> None:
    document = app(form('<watch name="w" when="sensor.a > 1"/><on event="w"><exit/></on>'))
    body = f'<person x="-1e300" y="0"/><when at="0s">{happens}</when>'
    if name != "far":
        body = body.replace("-1e300", "1")
    prima("run", stage(tmp_path, document, body)).check(code)


# Grammars ---------------------------------------------------------------------------
GRAMMARS = [
    ("left", '<rule id="a"><ruleref uri="#a"/>x</rule>'),
    ("mutual", '<rule id="a"><ruleref uri="#b"/></rule><rule id="b"><ruleref uri="#a"/>x</rule>'),
    ("exponential", '<rule id="a"><item repeat="0-"><item repeat="0-"><item repeat="0-">a</item></item></item>b</rule>'),
    ("choices", '<rule id="a">' + '<item repeat="0-1">a</item>' * 40 + "</rule>"),
    ("repeats", '<item repeat="0-999"><item repeat="0-999">a</item></item>'),
    ("nothing", '<item repeat="1-"><item repeat="0-1"/></item>b'),
    ("long", "<item>a</item>" * 5_000),
]  # fmt: skip


@pytest.mark.parametrize(("name", "content"), GRAMMARS)
def test_grammars(prima: Prima, tmp_path: Path, name: str, content: str) -> None:
    body = grammar(content).replace("<grammar>", "<prompt>Well?</prompt><grammar>", 1)
    body = body.replace("</field>", "<nomatch><exit/></nomatch><filled><exit/></filled></field>")
    answer = f'<person x="1" y="0"/><answer to="Well?">{"a " * 60}c</answer>'
    began = time.monotonic()
    prima("run", stage(tmp_path, app(body), answer)).check(0)
    assert time.monotonic() - began < SECONDS


def test_a_service_nobody_offers(prima: Prima, tmp_path: Path) -> None:
    body = form(f'<block><send to="mars"/></block>{CATCH}')
    prima("run", stage(tmp_path, app(body))).check(0, 'there is no service "mars"', "caught")
