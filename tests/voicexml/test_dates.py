"""Date in VoiceXML documents: the run's time, in UTC, and never the host's clock."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import prima
from prima.script.engine import Engine
from prima.script.evaluation import ScriptError
from tests.helpers.old_documents import HEAD, run, said, scenario

NOW = 1109671200000  # 2005-03-01T10:00:00Z
DATES = [
    ("Date()", "Tue Mar 01 2005 10:00:00 GMT+0000 (UTC)"),
    ("new Date().toString()", "Tue Mar 01 2005 10:00:00 GMT+0000 (UTC)"),
    ("Date.now()", NOW),
    ("new Date().getHours()", 10),
    ("new Date().getYear()", 105),
    ("new Date().getTimezoneOffset()", 0),
    ("[1 / new Date(-1).getTimezoneOffset() > 0, String(new Date(NaN).getTimezoneOffset())]", [True, "NaN"]),
    ("new Date().toLocaleString()", "3/1/2005, 10:00:00 AM"),
    ("new Date().toUTCString()", "Tue, 01 Mar 2005 10:00:00 GMT"),
    ("new Date().toGMTString()", "Tue, 01 Mar 2005 10:00:00 GMT"),
    ("new Date().toISOString()", "2005-03-01T10:00:00.000Z"),
    ("JSON.stringify([new Date(0)])", '["1970-01-01T00:00:00.000Z"]'),
    ("new Date(2004, 1, 29, 23, 5).toString()", "Sun Feb 29 2004 23:05:00 GMT+0000 (UTC)"),
    ("new Date(99, 0).getFullYear()", 1999),
    ("new Date(2005, 0, 31) - new Date(2005, 0, 30)", 86_400_000),
    ("new Date(new Date(7)).getTime()", 7),
    ("new Date('2005-03-01').getTime()", NOW - 36_000_000),
    ("new Date('2005-03-01T10:00:00').getTime()", NOW),
    ("new Date('2005-03-01T10:00:00+09:00').getTime()", NOW - 32_400_000),
    ("Date.parse('Mar 1, 2005 5:00 AM EST')", NOW),
    ("Date.parse('1 March 2005 10:00')", NOW),
    ("Date.parse('3/1/05 10:00')", NOW),
    ("Date.parse(Date())", NOW),
    ("Date.parse(new Date().toUTCString())", NOW),
    ("Date.parse(new Date().toLocaleString())", NOW),
    ("String(new Date('tomorrow'))", "Invalid Date"),
    ("Date.parse('2005-13-01')", float("nan")),
    ("(function (d) { d.setHours(26); d.setYear(99); return d.toString(); })(new Date(0))",
     "Sat Jan 02 1999 02:00:00 GMT+0000 (UTC)"),
    ("['setHours', 'setUTCMonth', 'setYear'].map(function (name) {"
     " var d = new Date(0); return [d[name](undefined), d.getTime()].map(isNaN); })", [[True] * 2] * 3),
    ("[-20721, -721, 0, 20721].map(function (year) { return new Date(year, 0).toDateString().slice(11); })",
     ["-20721", "-0721", "1900", "20721"]),
    ("[-271820, -1, 0, 49, 99, 275759].filter(function (year) { var d = new Date(0); d.setFullYear(year);"
     " return ['toString', 'toUTCString', 'toISOString'].some("
     "function (way) { return Date.parse(d[way]()) != d.getTime(); }); })", []),
    ("[Date.parse('3/1/05 10:00'), Date.parse('1-Mar-2005 10:00'), Date.parse('Mar 1, 2005 10:00')]", [NOW] * 3),
    ("new Date() instanceof Date && new Date().constructor === Date", True),
    ("Date.length + Date.name + Date.prototype.getHours.name", "7DategetHours"),
    ("Object.keys(Date.prototype).length", 0),
    ("(class Day extends Date {}).prototype instanceof Date", True),
    ("new (eval('Da' + 'te'))().getTime()", NOW),
    ("typeof Date + typeof Intl + typeof performance", "functionundefinedundefined"),
]  # fmt: skip


@pytest.fixture(scope="module")
def engine() -> Engine:
    made = Engine()
    made.now = NOW
    return made


@pytest.mark.parametrize(("code", "value"), DATES)
def test_date(engine: Engine, code: str, value: object) -> None:
    """``Date`` is ECMAScript's, with the run's clock and UTC as the local time zone."""
    found = engine.value(code, tuple(engine.scope() for _ in range(4)))
    assert found == value or (found != found and value != value)


def test_no_way_to_the_hosts_clock(engine: Engine) -> None:
    """Whatever leads from a date leads to the same one, and its clock stands still."""
    scopes = tuple(engine.scope() for _ in range(4))
    for code in (
        "Date.prototype.constructor",
        "new Date(0).constructor",
        "Object.getPrototypeOf(new Date(0)).constructor",
        "Object.getPrototypeOf(class extends Date {})",
        "(function () { return this.Date })() || Date",
        "globalThis.Date",
    ):
        assert engine.value(f"({code}) === Date && ({code}).now()", scopes) == NOW
    with pytest.raises(ScriptError, match="Date"):
        engine.value("Date.prototype.getHours.call({})", scopes)
    busy = "(function () { while (new Date() < 1109671200001); })()"
    with pytest.raises(ScriptError, match="longer than"):
        engine.value(busy, scopes)


def test_whole_numbers_keep_their_size(engine: Engine) -> None:
    scope = engine.scope({"large": 2**40, "small": -(2**31) - 1})
    blank = engine.scope()
    assert engine.value("large", (blank, blank, blank, scope)) == 2**40
    assert engine.value("small", (blank, blank, blank, scope)) == -(2**31) - 1


CLOCK = "<form><block>It is <value expr='new Date().toISOString()'/></block></form>"


@pytest.mark.parametrize("attribute", ["", 'date="1999-12-31T23:59:59"', 'date="2010-02-03"'])
def test_run_has_its_own_date(tmp_path: Path, attribute: str) -> None:
    """The date is the scenario's, goes on with the run's time, and comes back in a replay."""
    made = run(tmp_path, CLOCK, attribute)
    begins = attribute[6:-1] or "2005-03-01T10:00:00"
    begins = begins if "T" in begins else begins + "T00:00:00"
    assert said(made)[-1] == f'"It is {begins}.000Z"'
    assert made.records[0]["data"]["date"] == begins
    for _ in range(2):
        assert prima.replay(made, tmp_path / "s.xml").dumps() == made.dumps()


def test_date_goes_on_with_the_run(tmp_path: Path) -> None:
    """What is asked later finds it later, by the simulated time, in both languages."""
    field = "<field name='f' type='boolean'><prompt timeout='60s'>Well?</prompt><noinput>{}</noinput></field>"
    seconds = "<value expr='(new Date() - new Date(2005, 2, 1, 10)) / 1000 &gt; 60'/><exit/>"
    made = run(tmp_path, f"<form>{field.format(seconds)}</form>")
    assert said(made)[-1] == '"true"'
    (tmp_path / "app.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app"><form id="f"><block>'
        '<speak>Ten seconds.</speak><log expr="Date.now() &gt; 1109671200000"/>'
        '<log expr="new Date(Date.now() - 1000 * session.time).toISOString()"/>'
        "<exit/></block></form></prima>",
        encoding="utf-8",
    )
    made = prima.rehearse(scenario(tmp_path, "app.xml"))
    logs = [record["message"] for record in made.records if record["phase"] == "log"]
    assert logs == ["true", "2005-03-01T10:00:00.000Z"]


def test_date_knows_no_time_zone(tmp_path: Path) -> None:
    """The host's time zone changes no byte."""
    body = "<form><block><value expr=\"new Date(2005, 6, 1) + Date.parse('7/1/05 1:00')\"/></block></form>"
    (tmp_path / "app.vxml").write_text(f"{HEAD}{body}</vxml>", encoding="utf-8")
    path = scenario(tmp_path, "app.vxml")
    code = f"import prima; print(prima.rehearse({str(path)!r}).dumps())"
    outs = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "TZ": zone},
            capture_output=True,
            check=True,
        ).stdout
        for zone in ("UTC", "Asia/Tokyo", "America/New_York")
    }
    assert len(outs) == 1 and b"2005 00:00:00 GMT+0000" in outs.pop()


@pytest.mark.parametrize("date", ["today", "2005-02-30", "2005-03-01T25:00", "2005-3-1", ""])
def test_wrong_date(tmp_path: Path, date: str) -> None:
    with pytest.raises(prima.DocumentError) as caught:
        run(tmp_path, CLOCK, f'date="{date}"')
    [problem] = caught.value.problems
    assert problem.place.line == 1 and problem.code == "bad-value"
