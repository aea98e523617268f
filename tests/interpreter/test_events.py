"""Events and errors: which handler takes them, and those that no handler takes."""

from __future__ import annotations

import re

import pytest

from tests.helpers.robot import CAUGHT, Bench, document


# Events and errors ----------------------------------------------------------------------------
def test_the_first_command_because_of_an_event_is_a_reaction_even_through_goto_and_throw() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><throw event="my.own"/></on>
          <on event="my"><goto next="#b"/></on></form>
        <form id="b"><block><assign name="n" expr="1"/><speak>One.</speak></block>
          <block><speak>Two.</speak></block><var name="n"/></form>"""
    )
    bench.event("touch")
    bench.finish("One.")
    flags = [record["reactive"] for record in bench.phases("request")]
    assert flags == [True, False]


def test_a_handler_may_say_that_it_is_no_reaction() -> None:
    bench = Bench(
        '<form id="a"><on event="touch" reactive="false"><speak>Later.</speak></on></form>'
    )
    bench.event("touch")
    assert [record["reactive"] for record in bench.phases("request")] == [False]


def test_end_events_of_commands_reach_handlers_in_the_command_and_in_scope() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>One.<on event="end"><log>in the command</log></on></speak>
            <speak>Two.</speak></block>
          <on event="end.speak"><log>in the form</log></on>
        </form>"""
    )
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == ["in the command", "in the form"]


def test_a_failing_device_is_an_event_with_its_place() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>One.</speak><log>never</log></block>
          <block><log>next</log></block>
          <error><log expr="event.name + ' ' + event.message"/></error>
        </form>"""
    )
    bench.fail("One.")
    assert bench.logs() == ["error.device.speaker app.xml:2:18: broken", "next"]


def test_an_error_that_nobody_handles_ends_this_application_alone() -> None:
    bad = document(
        '<form id="a"><block><log expr="nowhere.to"/></block></form>'.replace(
            "nowhere.to", "JSON.nowhere.to"
        ),
        name="bad",
    )
    good = document('<form id="a"><block><speak>Fine.</speak></block></form>', name="good")
    bench = Bench(bad, good)
    assert bench.saying() == ["Fine."]
    assert bench.session.failures == [
        "bad: error.semantic: bad.xml:1:101: JSON.nowhere.to: TypeError: cannot read property 'to'"
        " of undefined"
    ]


@pytest.mark.parametrize(
    ("expr", "told"),
    [
        ("''", '""'),
        ("'a..b'", '"a..b"'),
        ("'a b'", '"a b"'),
        ("null", "(null or undefined)"),
        ("[]", '"[]"'),
    ],
)
def test_what_is_no_events_name_cannot_be_thrown(expr: str, told: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><throw event-expr="{expr}"/></block>
        <on event="error.semantic"><log expr="event.data.message"/></on></form>"""
    )
    remedy = 'is not an event name. Write one such as "touch.head".'
    assert bench.logs() == [f"app.xml:1:90: event {told} {remedy}"]


@pytest.mark.parametrize("expr", ["'a.b'", "'a' + '.b'", "'a.b.'"])
def test_an_events_name_may_be_computed(expr: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><throw event-expr="{expr}"/></block>
        <on event="a.b"><log>taken</log></on></form>"""
    )
    assert bench.logs() == ["taken"]


@pytest.mark.parametrize(
    "expr",
    [
        "(function () { throw new Error('thrown'); })()",
        "(function () { for (;;); })()",
        "(function f() { return f(); })()",
        "'x'.repeat(1e9)",
        "(() => { const a = []; for (;;) a.push('x'.repeat(1000) + a.length); })()",
        "/(a+)+$/.test('a'.repeat(40) + 'b')",
        "Symbol('s').nothing.more",
    ],
)
def test_an_expression_that_fails_is_a_timely_error_semantic(expr: str) -> None:
    escaped = expr.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    bench = Bench(
        f"""<form id="a"><block><assign name="x" expr="{escaped}"/></block><var name="x"/>
        <on event="error.semantic"><log expr="event.message"/></on></form>"""
    )
    assert len(bench.logs()) == 1
    assert bench.logs()[0].startswith("app.xml:1:1")
    assert not bench.session.over


@pytest.mark.parametrize(
    "body",
    [
        '<form id="a"><block><goto next="#b"/></block></form><form id="b"><block><goto next="#a"/></block></form>',
        '<form id="a"><block name="x"><clear/></block></form>',
        '<form id="a"><on event="t"><throw event="t"/></on><block><throw event="t"/></block></form>',
        '<form id="a"><subdialog src="#a"/></form>',
        '<form id="a"><on event="e"><log>x</log></on><block><foreach item="i" array="Array(9999).fill(0)">'
        '<foreach item="j" array="Array(9999).fill(0)"><log>x</log></foreach></foreach></block></form>',
    ],
)
def test_a_document_that_loops_without_waiting_ends(body: str) -> None:
    bench = Bench(body)
    assert bench.session.over
    assert "error.semantic" in bench.session.failures[0]


def test_applications_do_not_see_each_others_variables() -> None:
    one = document(
        '<var name="secret" expr="1"/><form id="a"><block><script>globalThis.leak = 1; Math.leak = 2;</script>'
        "</block></form>",
        name="one",
    )
    two = document(
        '<form id="a"><block><log expr="typeof secret + typeof leak + typeof Math.leak"/></block></form>'.replace(
            "typeof secret + typeof leak", "typeof globalThis.secret + typeof globalThis.leak"
        ),
        name="two",
    )
    assert Bench(one, two).logs() == ["undefinedundefinedundefined"]


def test_a_document_scripts_random_numbers_are_the_same_in_every_run() -> None:
    body = '<form id="a"><block><log expr="Math.random()"/></block></form>'
    assert Bench(body).logs() == Bench(body).logs()


# Services, timers, watches ------------------------------------------------------------------------
def test_send_asks_a_service_and_its_answer_is_a_reaction() -> None:
    bench = Bench(
        """<form id="a"><block><send to="library"><param name="title" value="C"/></send></block>
        <on event="reply.library"><speak><value expr="event.data.shelf"/></speak></on></form>"""
    )
    assert [order.data for order in bench.orders] == [{"to": "library", "params": {"title": "C"}}]
    bench.event("reply.library", shelf="Shelf 7")
    assert bench.saying() == ["Shelf 7"]
    assert bench.phases("request")[0]["reactive"] is True


def test_numbers_that_json_lacks_are_sent_as_texts() -> None:
    params = "".join(f'<param name="{n}" expr="{n}"/>' for n in ("NaN", "Infinity", "-Infinity"))
    params = params.replace('name="-Infinity"', 'name="less"')
    bench = Bench(f'<form id="a"><block><send to="x">{params}</send></block></form>')
    sent = {"NaN": "NaN", "Infinity": "Infinity", "less": "-Infinity"}
    assert [order.data["params"] for order in bench.orders] == [sent]


def test_an_unhandled_service_failure_ends_the_application() -> None:
    bench = Bench('<form id="a"><block><send to="x"/></block></form>')
    bench.event("error.service.x", message="down")
    assert bench.session.failures == ["app: error.service.x: down"]


def test_a_delayed_event_comes_unless_its_state_is_left() -> None:
    body = """<form id="a"><block><send event="late" delay="2s"/></block>
      <on event="late"><log>late</log></on><on event="go"><goto next="#b"/></on></form>
      <form id="b"><on event="late"><log>wrong</log></on></form>"""
    bench = Bench(body)
    assert bench.session.deadline() == 2100
    bench.step(at=2100)
    assert bench.logs() == ["late"]
    left = Bench(body)
    left.event("go")
    assert left.session.deadline() is None


@pytest.mark.parametrize(
    ("delay", "due"), [("2", 2100), ("'2s'", 2100), ("0.5", 600), ("86400", 86_400_100)]
)
def test_a_delay_may_be_computed_as_a_time_or_in_seconds(delay: str, due: int) -> None:
    bench = Bench(
        f"""<form id="a"><block><send event="late" delay-expr="{delay}"/></block>
        <on event="late"><log>late</log></on></form>"""
    )
    assert bench.session.deadline() == due


@pytest.mark.parametrize("delay", ["'soon'", "'2'", "-1", "86401", "true", "null", "[1]"])
def test_a_delay_that_is_no_time_is_an_error(delay: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><send event="late" delay-expr="{delay}"/></block></form>"""
    )
    (failure,) = bench.session.failures
    assert failure.startswith("app: error.semantic: ") and failure.endswith(" is not a time")


@pytest.mark.parametrize(
    ("name", "least", "content", "told"),
    [
        (
            "MAX_WRITTEN",
            3_000,
            "<log expr=\"'x'.repeat(400)\"/>",
            "3,000 characters come out in this run",
        ),
        ("MAX_RUN_STEPS", 50, "<log/>", "pieces of content in this run"),
        ("MAX_ACTIONS", 20, "<log/>", "21 Commands and messages in this run"),
    ],
)
def test_what_an_application_does_in_a_run_is_bounded(
    name: str, least: int, content: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for one, value in ((name, least), ("STEPS_A_SECOND", 0), ("ACTIONS_A_SECOND", 0)):
        monkeypatch.setattr(f"prima.interpreter.bounds.{one}", value)
    bench = Bench(
        f"""<form id="a"><block>{content}<send event="late" delay="2s"/></block>
        <on event="late">{content}<send event="late" delay="2s"/></on></form>""",
        document('<form id="a"><on event="bye"><log>bye</log></on></form>', "ea", "other"),
    )
    for _ in range(40):
        bench.step(at=bench.now + 2000)
    (failure,) = bench.session.failures
    assert failure.startswith("app: error.semantic: app.xml:") and failure.endswith(told)
    bench.event("bye")
    assert bench.logs()[-1] == "bye"


def test_too_many_delayed_events_are_told_with_their_line() -> None:
    bench = Bench(
        """<form id="a"><block><foreach item="i" array="Array(300)">
        <send event="late" delay="2s"/></foreach></block></form>"""
    )
    (failure,) = bench.session.failures
    assert re.fullmatch(
        r"app: error.semantic: app.xml:\d+:\d+: more than 256 delayed events", failure
    )


def test_a_condition_of_a_handler_that_fails_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <block><speak>A story.</speak><log>told</log></block>
          <on event="touch" cond="null.thing"><log>never</log></on>
        </form>"""
    )
    bench.event("touch")
    assert bench.logs() == ["error.semantic"]
    bench.finish("A story.")
    assert bench.logs() == ["error.semantic", "told"]


def test_a_condition_of_a_handler_that_fails_in_content_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <block><throw event="own.trouble"/></block>
          <block><log>next</log></block>
          <on event="own" cond="null.thing"><log>never</log></on>
        </form>"""
    )
    assert bench.logs() == ["error.semantic", "next"]


@pytest.mark.parametrize(
    "head", ['<var name="x" expr="null.thing"/>', "<script>null.thing</script>"]
)
def test_a_variable_or_script_of_the_document_that_fails_is_an_event(head: str) -> None:
    bench = Bench(f'{CAUGHT}{head}<form id="a"><block><log>on</log></block></form>')
    assert bench.logs() == ["error.semantic", "on"]


def test_a_value_to_return_that_fails_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <subdialog name="s" src="#b"/>
          <block><log expr="s.x === null"/></block>
        </form>
        <form id="b"><block><assign name="x" expr="1"/><clear namelist="x"/>
          <script>dialog.y = {{}}; dialog.y.me = dialog.y;</script><assign name="x" expr="dialog.y"/>
          <return namelist="x"/></block>
          <var name="x"/>
          <on event="error.semantic"><log>circular</log><assign name="x" expr="null"/>
            <return namelist="x"/></on></form>"""
    )
    assert bench.logs() == ["circular", "true"]


def test_an_error_that_nobody_handles_ends_its_application_alone() -> None:
    bench = Bench(
        '<form id="a"><on event="touch" cond="null.thing"><log>never</log></on></form>',
        document('<form id="a"><on event="touch"><log>here</log></on></form>', "ea", "other"),
    )
    bench.event("touch")
    assert bench.logs() == ["here"]
    assert bench.session.failures and bench.session.failures[0].startswith("app: error.semantic")


def test_slow_scripts_of_one_instant_end_their_application_alone() -> None:
    slow = "let n = 0; while (n &lt; 3e6) n++;"
    bench = Bench(
        f"""<form id="a"><block>
          <foreach item="i" array="new Array(1000).fill(0)"><script>{slow}</script></foreach>
        </block></form>""",
        document('<form id="a"><block><log>here</log></block></form>', "ea", "other"),
    )
    assert bench.logs() == ["here"]
    assert "its scripts take too long" in bench.session.failures[0]


def test_what_comes_out_in_one_instant_is_bounded() -> None:
    bench = Bench(
        """<form id="a"><block>
          <foreach item="i" array="new Array(10000).fill(0)"><log expr="'x'.repeat(90000)"/></foreach>
        </block></form>"""
    )
    assert "characters come out at once" in bench.session.failures[0]
    assert sum(len(text) for text in bench.logs()) <= 1_000_000
    assert max(len(text) for text in bench.logs()) == 90_000


def test_an_error_in_a_script_is_told_at_its_own_line() -> None:
    bench = Bench(
        """<form id="a"><block><script>
          let a = 1;
          a.b.c();
        </script></block></form>"""
    )
    assert bench.session.failures[0].startswith("app: error.semantic: app.xml:3:11: ")


def test_an_event_that_nobody_handles_is_told_with_its_place() -> None:
    bench = Bench(
        """<form id="a"><block>
          <throw event="foo"/></block></form>"""
    )
    assert bench.session.failures == ["app: foo: app.xml:2:11"]


def test_what_is_asked_for_instead_of_a_refused_command_is_the_reaction() -> None:
    bench = Bench(
        """<form id="a">
          <block><topological-move to="room"/></block>
          <on event="corner"><command type="fly"/></on>
          <on event="error.semantic"><turn-and-speak angle="9">There.</turn-and-speak></on>
        </form>"""
    )
    bench.event("corner")
    [asked] = [r for r in bench.phases("request") if r["command"] == "turn-and-speak"]
    assert asked["reactive"] and asked["cause"]


def test_handlers_that_wait_in_what_others_throw_are_counted() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><throw event="own.x"/></on>
        <on event="own"><speak>So.</speak></on></form>"""
    )
    for _ in range(100):
        bench.event("touch")
    (end,) = bench.phases("unload")
    assert "too many handlers under way" in end["outcome"]


def test_code_that_is_text_knows_the_event() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><log expr="eval('eve' + 'nt.name')"/></on></form>"""
    )
    bench.event("touch")
    assert bench.logs() == ["touch"]


def test_many_pieces_of_code_in_one_place_take_no_longer_than_scripts_may(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("prima.script.engine.MAX_SCRIPT_SECONDS", 0.05)
    slow = '<value expr="(function () { for (var i = 0; i &lt; 1e4; i++); return 1 })()"/>'
    bench = Bench(f'<form id="a"><block><log>{slow * 2000}</log></block></form>', isolate="none")
    (end,) = bench.phases("unload")
    assert "scripts take too long" in end["outcome"]


@pytest.mark.parametrize("nobody", ["null", "undefined"])
def test_a_message_to_no_service_is_an_error(nobody: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><send to-expr="{nobody}"/></block>
        <on event="error.semantic"><log expr="event.message"/></on></form>"""
    )
    assert len(bench.logs()) == 1 and "it names no service" in bench.logs()[0]
    assert bench.phases("send") == []
