"""Watches: conditions on sensors and variables that turn true."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.interpreter.acts import Expression
from prima.interpreter.application import Interpreter
from prima.interpreter.frame import Fiber
from prima.interpreter.sensors import sensors_read
from prima.messages import ApplicationLoaded, ApplicationUnloaded, Sensed
from tests.helpers.robot import CAUGHT, Bench, document


def test_a_watch_is_raised_when_its_condition_turns_true_and_armed_again() -> None:
    from prima.messages import Sensed

    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.human.distance &lt; 1"/>
        <on event="near"><speak>Hello.</speak></on></form>"""
    )
    for distance in (3, 0.8, 0.5, 2, 0.9):
        bench.step(Sensed({"human.distance": distance}))
    assert len([r for r in bench.phases("event") if r["event"] == "near"]) == 2
    assert bench.phases("request")[0]["reactive"] is True


@pytest.mark.parametrize(("distance", "raised"), [(0.8, ["near"]), (3, [])])
def test_what_turns_true_during_a_subdialog_is_raised_after_it(
    distance: float, raised: list[str]
) -> None:
    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.human.distance &lt; 1"/>
          <subdialog name="x" src="#b"/><block><speak>Back.</speak></block>
          <on event="near"><log>near</log></on></form>
        <form id="b"><block><speak>Inside.</speak></block><block><return/></block></form>"""
    )
    bench.step(Sensed({"human.distance": distance}))
    assert bench.logs() == []
    bench.finish("Inside.")
    assert (bench.logs(), bench.saying()) == (raised, ["Back."])
    bench.step(Sensed({"moving": True}))
    assert bench.logs() == raised


def test_what_turned_true_during_a_subdialog_may_leave_what_goes_on_after_it() -> None:
    """O3: what the state requests at the subdialog's end is deleted with the state."""
    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.human.distance &lt; 1"/>
          <subdialog name="x" src="#b"><filled><speak>Back.</speak></filled></subdialog>
          <on event="near"><goto next="#c"/></on></form>
        <form id="b"><block><speak>Inside.</speak></block><block><return/></block></form>
        <form id="c"><block><speak>Gone.</speak></block></form>"""
    )
    bench.step(Sensed({"human.distance": 0.8}))
    bench.finish("Inside.")
    assert bench.saying() == ["Gone."]
    assert [one["text"] for one in bench.phases("cancel")] == ["Back."]
    states = [one["state"] for one in bench.phases("request")]
    assert [one["state"] for one in bench.phases("leave")] == [states[0], states[1]]


@pytest.mark.parametrize("handler", ["", '<on event="near"><log>near</log></on>'])
@pytest.mark.parametrize("way", ["goto", "subdialog"])
def test_events_of_watches_on_entry_do_not_lose_the_reactive_flag(handler: str, way: str) -> None:
    """C5: goto, throw and subdialogs in between do not lose it, waiting does."""
    watching = '<watch name="near" when="sensor.human.distance &lt; 1"/>'
    there = f'<form id="b">{watching}{handler}<block><speak>Ouch.</speak></block></form>'
    call = '<form id="c"><subdialog name="x" src="#b"/></form>'
    goal = "b" if way == "goto" else "c"
    bench = Bench(
        f"""<form id="a"><on event="touch" fresh-for="2s"><goto next="#{goal}"/></on></form>
        {there}{call}""",
        policy="prima+x8",
    )
    bench.step(Sensed({"human.distance": 0.5}))
    bench.event("touch")
    [touched] = [r for r in bench.phases("event") if r["event"] == "touch"]
    [asked] = bench.phases("request")
    assert (asked["reactive"], asked["cause"]) == (True, touched["serial"])
    assert asked["fresh"] == 2.0
    assert any(r["event"] == "near" for r in bench.phases("event"))


def test_a_watch_that_fails_is_an_event_and_others_go_on() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <watch name="odd" when="sensor.nosuch.thing == 1"/>
          <watch name="warm" when="sensor.heat == 1"/>
          <on event="warm"><log>warm</log></on>
        </form>"""
    )
    bench.step(Sensed({"heat": 1}))
    assert bench.logs() == ["error.semantic", "warm"]
    bench.step(Sensed({"heat": 2}))
    assert bench.logs() == ["error.semantic", "warm"], "nothing that it looks at has changed"
    bench.step(Sensed({"nosuch.other": 2}))
    assert bench.logs() == ["error.semantic", "warm"], "now it does not fail"


def test_what_a_document_watches_for_may_be_so_when_it_is_loaded() -> None:
    watching = """<watch name="low" when="sensor.battery?.level &lt; 20"/>
      <form id="a"><on event="low"><log>low</log></on></form>"""
    bench = Bench('<form id="a"/>', document(watching, "ea", "late"))
    bench.step(ApplicationUnloaded("late"))
    bench.step(Sensed({"battery.level": 10}))
    bench.step(ApplicationLoaded("late"))
    assert bench.logs() == ["low"]
    bench.step(Sensed({"battery.level": 9}))
    assert bench.logs() == ["low"]


@pytest.mark.parametrize("script", ["", "<script>function f(x) { return x; }</script>"])
def test_a_state_without_watches_sees_what_was_told_last(script: str) -> None:
    bench = Bench(
        script
        + """<form id="a"><watch name="low" when="sensor.battery?.level &lt; 20"/>
          <on event="go"><goto next="#b"/></on></form>
        <form id="b"><on event="show"><log expr="sensor.battery.level"/></on></form>"""
    )
    bench.step(Sensed({"battery.level": 50}))
    bench.event("go")
    for level in range(10, 17):
        bench.step(Sensed({"battery.level": level}))
        bench.event("show")
    assert bench.logs() == [str(level) for level in range(10, 17)]


def test_a_watch_that_is_always_true_where_it_leads_ends_its_application_alone() -> None:
    round_and_round = """<form id="a"><watch name="w" when="!sensor.moving"/>
      <on event="w"><goto next="#a"/></on></form>"""
    other = '<form id="b"><on event="touch"><log>here</log></on></form>'
    bench = Bench(round_and_round, document(other, "ea", "other"))
    bench.step(Sensed({"moving": False}))
    (failure,) = bench.session.failures
    assert "loops without ever waiting" in failure
    bench.event("touch")
    assert bench.logs() == ["here"]


def test_a_watch_sees_the_variables_of_its_form() -> None:
    bench = Bench(
        """<var name="most" expr="5"/>
        <form id="a"><block><speak>Hm.</speak><goto next="#b"/></block></form>
        <form id="b"><var name="least" expr="1"/>
          <watch name="fair" when="sensor.heat &gt; least &amp;&amp; sensor.heat &lt; most"/>
          <on event="fair"><log>fair</log></on>
        </form>"""
    )
    bench.step(Sensed({"heat": 3}))
    bench.finish("Hm.")
    assert bench.logs() == ["fair"]


def test_a_watch_is_looked_at_only_when_its_sensor_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(
        """<var name="n" expr="0"/><form id="a">
        <watch name="low" when="sensor.battery.level &lt; 15"/>
        <watch name="odd" when="sensor.front &lt; 1 &amp;&amp; n == 0"/>
        <on event="low"><log>low</log></on></form>"""
    )
    looked: list[str] = []
    (app,) = bench.session.apps.values()
    assert isinstance(app, Interpreter)
    condition = app.execute.condition

    def noted(expr: Expression, fiber: Fiber) -> bool:
        looked.append(expr.code)
        return condition(expr, fiber)

    monkeypatch.setattr(app.execute, "condition", noted)
    bench.step(Sensed({"battery.level": 50.0, "front": 2.0}))
    bench.step(Sensed({"front": 1.5}))
    assert len(looked) == 2 + 1, "the battery has not changed; the other looks at a variable too"
    bench.step(Sensed({"battery.level": 10.0}))
    bench.step(Sensed({"front": 1.0}))
    assert bench.logs() == ["low"]


LOG = '<form id="a"><block><log><value expr="{}"/></log></block></form>'
WATCH = '<watch name="w" when="{}"/>' + LOG.format("1")


@pytest.mark.parametrize(
    ("body", "read"),
    [
        (WATCH.format("sensor.x &gt; 1"), {"x"}),
        (WATCH.format("sensor.x?.y &gt; sensor?.z.a"), {"x", "z"}),
        (LOG.format("sensor .a + application.sensor.b"), {"a", "b"}),
        ("<script>var a = 1;</script>" + LOG.format("a"), set()),
        ('<form id="a"><block><speak>A sensor\'s application.</speak></block></form>', set()),
        ('<var name="n" expr="1"/>' + WATCH.format("sensor.x &gt; n"), None),
        (LOG.format("sensor"), None),
        (LOG.format("sensor['x']"), None),
        (LOG.format("application"), None),
        (LOG.format("application['sensor']"), None),
        (LOG.format("application.valueOf()['sen' + 'sor'].x"), None),
        (LOG.format("application.mine"), set()),
        (LOG.format("'this application of a sensor'"), set()),
        (
            "<script>var a = \"don't\"; // isn't this it\nvar b = 'x';</script>" + LOG.format("b"),
            set(),
        ),
        (
            "<script>var f = function () { /* ' */ return this; }; // '\n</script>"
            + LOG.format("1"),
            None,
        ),
        ("<script>var f = () => `${sensor.x}`;</script>" + LOG.format("1"), {"x"}),
        ("<script>// all\nfunction f() { return this; }</script>" + LOG.format("1"), None),
        (
            "<script>application.all = function () { return this; };</script>" + LOG.format("1"),
            None,
        ),
        ("<script>for (const k in ap\u01c0) k;</script>" + LOG.format("1"), None),
        ('<var name="Infinity" expr="1"/>' + WATCH.format("sensor.x &lt; Infinity"), None),
        (LOG.format("'a\\tb'"), set()),
        (LOG.format("sensor['h\\x75man']"), None),
        ("<script>function f() { return sens\\u006fr.x; }</script>" + LOG.format("1"), None),
        ("<script>function f() { return eval('sen' + 'sor.x'); }</script>" + LOG.format("1"), None),
        ("<script>function f(s) { return s.sensor; }</script>" + LOG.format("1"), None),
    ],
)
def test_which_sensors_a_document_looks_at(body: str, read: set[str] | None) -> None:
    found = sensors_read(document(body))
    assert (found if found is None else set(found)) == read


def test_a_watch_that_a_subdialog_may_hide_looks_at_whatever_changes() -> None:
    watching = '<form id="a"><watch name="w" when="sensor.x &gt; 1"/>{}</form>'
    assert sensors_read(document(watching.format(""))) == frozenset({"x"})
    calls = '<subdialog name="s" src="#b"/>'
    other = '<form id="b"><block><return/></block></form>'
    assert sensors_read(document(watching.format(calls) + other)) is None


def test_a_watch_knows_what_changed_while_a_subdialog_had_its_place() -> None:
    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.x &gt; 1"/>
          <on event="near"><log>near</log></on>
          <block><speak>First.</speak></block><subdialog name="s" src="#b"/></form>
        <form id="b"><block><speak>Inside.</speak></block>
          <on event="touch"><return/></on></form>"""
    )
    bench.step(Sensed({"x": 0, "y": 0}))
    bench.finish("First.")
    bench.step(Sensed({"x": 5}))
    assert bench.logs() == []
    bench.event("touch")
    assert bench.logs() == ["near"]
    bench.step(Sensed({"y": 1}))
    assert bench.logs() == ["near"]


@pytest.mark.parametrize(("name", "when"), [("sensor", "sensor.x"), ("Infinity", "Infinity")])
def test_a_watch_sees_a_variable_that_hides_what_it_takes_for_granted(name: str, when: str) -> None:
    bench = Bench(
        f"""<form id="a"><var name="{name}" expr="0"/>
          <watch name="near" when="{when} &gt; 1 || sensor.x == 'no'"/>
          <on event="near"><log>near</log></on>
          <on event="message"><assign name="{name}" expr="event.data.it"/></on></form>"""
    )
    bench.step(Sensed({"x": 0}))
    bench.event("message", it={"x": 3} if name == "sensor" else 3)
    bench.step(Sensed({"y": 0}))
    assert bench.logs() == ["near"]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ('<form id="m"><block><log expr="sensor.moving"/><exit/></block></form>', 1),
        ('<form id="m"><block><log expr="typeof sensor"/><exit/></block></form>', 0),
        ('<var name="sensor"/><form id="m"><block><log expr="sensor"/><exit/></block></form>', 0),
        (
            '<form id="m"><watch name="go" when="sensor.moving"/><block><speak>Hi.</speak>'
            '<log expr="sensor.moving"/></block><on event="go"><exit/></on></form>',
            0,
        ),
    ],
)
def test_sensors_are_there_where_one_is_watched(content: str, told: int, tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">{content}</prima>'
    )
    found = [one for one in api.validate([path]) if one.code == "undeclared-variable"]
    assert [(one.severity, one.message[:9]) for one in found] == [("warning", "No <watch")] * told
