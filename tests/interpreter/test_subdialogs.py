"""Subdialogs: their own context, and the values they return."""

from __future__ import annotations

import pytest

from tests.helpers.robot import Bench


def test_a_subdialog_has_its_own_context_and_gives_values_back() -> None:
    bench = Bench(
        """<var name="n" expr="1"/>
        <form id="a"><subdialog name="r" src="#sub"><param name="p" expr="n + 1"/>
            <filled><log expr="r.q + ' ' + n"/></filled></subdialog>
          <block><log>after</log></block></form>
        <form id="sub"><var name="p"/><var name="q"/>
          <block><assign name="n" expr="99"/><speak>Inside.</speak>
            <assign name="q" expr="p * 10"/><return namelist="q"/></block></form>"""
    )
    assert bench.saying() == ["Inside."]
    bench.finish("Inside.")
    assert bench.logs() == ["20 1", "after"]


def test_a_subdialog_that_never_waits_and_one_that_goes_on_elsewhere() -> None:
    bench = Bench(
        """<form id="a"><subdialog name="r" src="#sub"><filled><log expr="r.x"/></filled></subdialog></form>
        <form id="sub"><block><goto next="#more"/></block></form>
        <form id="more"><var name="x" expr="7"/><block><return namelist="x"/></block></form>"""
    )
    assert bench.logs() == ["7"]


def test_a_subdialog_may_return_an_event() -> None:
    bench = Bench(
        """<form id="a"><subdialog name="r" src="#sub"><on event="nope"><log>nope</log></on></subdialog></form>
        <form id="sub"><block><speak>Hm.</speak><return event="nope"/></block></form>"""
    )
    bench.finish("Hm.")
    assert "nope" in bench.logs()


@pytest.mark.parametrize("head", ["", "<script>var own = 1</script>"])
def test_a_subdialog_may_give_what_is_not_a_number(head: str) -> None:
    bench = Bench(
        f"""{head}<form id="a"><subdialog name="s" src="#b"/>
          <block><log><value expr="s.p"/> <value expr="s.q.r"/></log></block></form>
        <form id="b"><var name="p" expr="0 / 0"/><var name="q"/>
          <block><var name="q" expr="{{r: 1}}"/><return namelist="p q"/></block></form>"""
    )
    assert bench.logs() == ["NaN 1"]


@pytest.mark.parametrize("first", ["", "<speak>Hm.</speak>"])
@pytest.mark.parametrize(
    "content", ['<throw event="own"/>', '<log expr="no.value"/>', '<goto next="#more"/>']
)
def test_what_a_subdialog_throws_does_not_reach_its_callers_handlers(
    first: str, content: str
) -> None:
    bench = Bench(
        f"""<var name="no"/>
        <form id="a"><subdialog name="r" src="#sub">
          <on event="own error"><log>caller</log></on></subdialog></form>
        <form id="sub"><block>{first}{content}</block></form>
        <form id="more"><block><throw event="own"/></block></form>"""
    )
    if first:
        bench.finish("Hm.")
    assert bench.logs() == []
    assert len(bench.session.failures) == 1


def test_a_param_is_a_variable_of_the_form_that_is_called_alone() -> None:
    bench = Bench(
        """<form id="a"><subdialog name="r" src="#sub"><param name="p" expr="5"/></subdialog></form>
        <form id="sub"><var name="p" expr="1"/><block>
          <log><value expr="p"/></log><goto next="#more"/></block></form>
        <form id="more"><var name="p" expr="2"/><block>
          <log><value expr="p"/></log><return/></block></form>"""
    )
    assert bench.logs() == ["5", "2"]


def test_a_param_counts_also_when_the_form_that_is_called_is_entered_anew() -> None:
    bench = Bench(
        """<form id="a"><block><assign name="turns" expr="7"/></block>
          <subdialog name="r" src="#sub"><param name="p" expr="5"/></subdialog></form>
        <var name="turns" expr="0"/>
        <form id="sub"><var name="p" expr="1"/><block>
          <log><value expr="turns"/> <value expr="p"/></log><assign name="p" expr="9"/>
          <assign name="turns" expr="turns + 1"/>
          <if cond="turns == 1"><goto next="#sub"/></if><return/></block></form>"""
    )
    assert bench.logs() == ["0 5", "1 5"], "the document's variables are fresh at the call alone"


def test_a_param_that_fails_is_an_error_of_the_caller() -> None:
    bench = Bench(
        """<var name="no"/>
        <form id="a"><subdialog name="r" src="#sub"><param name="p" expr="no.value"/>
          <error><log>caller</log><assign name="r" expr="1"/></error></subdialog></form>
        <form id="sub"><var name="p"/><error><log>called</log></error></form>"""
    )
    assert bench.logs() == ["caller"]


@pytest.mark.parametrize("head", ["", "<script>var own = Math.max(1, 2)</script>"])
def test_a_param_without_a_value_leaves_a_variable_undefined(head: str) -> None:
    bench = Bench(
        f"""{head}<var name="no"/>
        <form id="a"><subdialog name="r" src="#sub"><param name="town" expr="no"/>
          <param name="day" expr="null"/></subdialog></form>
        <form id="sub"><var name="town" expr="'Nara'"/><var name="day" expr="'today'"/>
          <field name="to" expr="town" type="text"><prompt>Where to?</prompt></field>
          <field name="on" expr="day" type="text"><prompt>When?</prompt></field>
          <block><log>so</log></block></form>"""
    )
    assert bench.saying() == ["Where to?"]
    bench.listens()
    bench.hears("Kyoto")
    assert bench.logs() == ["so"]
