"""Where handlers run: in place of content, beside it, in the state that wrote them."""

from __future__ import annotations

import pytest

from tests.helpers.robot import Bench


def test_after_an_error_in_a_condition_the_form_waits() -> None:
    bench = Bench(
        """<form id="a"><block><speak>One.</speak></block><block cond="undefined.y"><exit/></block>
          <error><log>sorry</log><speak>Oops.</speak></error>
          <error count="2"><log>twice</log><exit/></error>
          <on event="touch"><log>touched</log></on></form>"""
    )
    bench.finish("One.")
    bench.finish("Oops.")
    assert bench.logs() == ["sorry"] and bench.running() == {}
    bench.event("touch")  # after whose handler the form looks for items again
    assert bench.logs() == ["sorry", "touched", "twice"]


UNIT = """<form id="a">
  <iu><block><throw event="own"/></block><block><log>inside</log></block></iu>
  <block><log>after</log></block>
  <on event="own" cond="undefined.y"><log>never</log></on>
  <error><log>error</log></error></form>"""


def test_an_error_in_a_handlers_condition_is_handled_in_place_of_what_was_thrown() -> None:
    assert Bench(UNIT).logs() == ["error", "inside", "after"]


def test_an_error_in_a_handlers_condition_is_its_own_forms() -> None:
    bench = Bench(
        """<form id="a"><block><speak>One.</speak></block><subdialog name="s" src="#b"/>
          <on event="touch"><speak>Two.<on event="end"><throw event="own"/></on></speak></on>
          <on event="own" cond="undefined.y"/><error><log>caller</log></error></form>
        <form id="b"><field name="q"><option>x</option></field><error><log>called</log></error></form>"""
    )
    bench.event("touch")
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == ["caller"]


def test_conditions_that_fail_without_end_end_the_application() -> None:
    bench = Bench(
        """<form id="a"><block><throw event="own"/></block>
          <on event="own"/><error cond="undefined.y"/><on event="own" cond="undefined.x"/></form>"""
    )
    (failure,) = bench.session.failures
    assert "its handlers throw without end" in failure


CALLER = """<form id="a"><var name="v" expr="'caller'"/><block><speak>One.</speak></block>
    <subdialog name="s" src="#b"/><block><log>back</log></block>
    <on event="touch"><speak>Two.<on event="end"><log expr="v"/>{}</on></speak></on></form>
  <form id="b"><var name="v" expr="'called'"/><field name="q"><option>x</option></field>
    <on event="end.speak"><log expr="v"/></on></form>"""


@pytest.mark.parametrize(
    ("more", "logged"),
    [
        ("", ["caller"]),
        ("<goto next='#b'/>", ["caller"]),
        ("<goto nextitem='s'/>", ["caller"]),
        ("<exit/>", ["caller"]),
    ],
)
def test_a_commands_handlers_run_in_the_state_that_asked_for_it(
    more: str, logged: list[str]
) -> None:
    bench = Bench(CALLER.format(more))
    bench.event("touch")
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == logged and not bench.session.failures


def test_other_ends_of_the_callers_commands_are_the_called_forms() -> None:
    body = CALLER.replace('<on event="end"><log expr="v"/>{}</on>', "")
    bench = Bench(body)
    bench.event("touch")
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == ["called"]


def test_ends_of_commands_count_though_no_handler_takes_them() -> None:
    bench = Bench(
        """<form id="a"><block><speak>One.</speak><speak>Two.
          <on event="end" count="2"><log>second</log></on></speak></block></form>"""
    )
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == ["second"]


@pytest.mark.parametrize("event", ["end.speak", "cancel.speak", "expired.speak", "own"])
def test_what_is_thrown_and_not_handled_ends_the_application(event: str) -> None:
    bench = Bench(f'<form id="a"><block><throw event="{event}"/></block></form>')
    assert bench.session.failures == [f"app: {event}: app.xml:1:90"]


def test_what_a_forms_filled_throws_is_not_the_units() -> None:
    bench = Bench(
        """<form id="a"><iu><field name="q"><option>red</option></field>
            <on event="own"><log>unit</log></on></iu>
          <filled><throw event="own"/></filled><on event="own"><log>form</log></on></form>"""
    )
    bench.listens()
    bench.hears("red")
    assert bench.logs() == ["form"]


DELAYED = """<form id="a"><block><send event="t.a" delay="1s"/><send event="t.b" delay="1s"/></block>
    <on event="t"><log expr="'a ' + event.name"/>{}</on></form>
  <form id="b"><on event="t"><log expr="'b ' + event.name"/></on></form>"""


@pytest.mark.parametrize(
    ("then", "logged"),
    [
        ("<goto next='#b'/>", ["a t.a"]),
        ("<exit/>", ["a t.a"]),
        ("", ["a t.a", "a t.b"]),
    ],
)
def test_a_state_that_is_left_raises_no_delayed_event(then: str, logged: list[str]) -> None:
    bench = Bench(DELAYED.format(then))
    bench.step(at=5_000)
    assert bench.logs() == logged
    assert len([one for one in bench.records if one.get("event", "").startswith("t.")]) == len(
        logged
    )


@pytest.mark.parametrize(
    ("code", "said"), [("0", "0"), ("false", "false"), ("''", ""), ("null", "")]
)
def test_a_message_is_what_its_expression_gives(code: str, said: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><throw event="own" message-expr="{code}"/></block>
          <on event="own"><log expr="'[' + event.message + ']'"/></on></form>"""
    )
    assert bench.logs() == [f"[{said}]"]
