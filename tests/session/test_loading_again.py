"""An application that is loaded again is another one than before."""

from __future__ import annotations

from prima.invariants import check
from prima.messages import ApplicationLoaded, ApplicationUnloaded, Fetched, Heard
from tests.helpers.robot import Bench
from tests.helpers.voice import Online

MENU = "http://menu.example/today"


def test_an_answer_to_what_an_application_asked_before_it_was_loaded_again_is_not_its_own() -> None:
    asks = f"""<form><block><data name="menu" src="{MENU}"/>
        <value expr="menu.documentElement.firstChild.data"/></block></form>"""
    call = Online({MENU: None}, asks)
    call.step(ApplicationUnloaded("app"))
    call.step(ApplicationLoaded("app"))
    before, now = (one["serial"] for one in call.phases("send"))
    call.step(Fetched("app", before, MENU, "<menu>Soup.</menu>"))
    assert call.said() == []
    call.step(Fetched("app", now, MENU, "<menu>Tea.</menu>"))
    assert call.said() == ["Tea."]


def test_a_late_answer_to_its_former_run_is_not_its_own() -> None:  # X10
    asks = """<form id="ask"><field name="q" type="boolean"><prompt>Shall we go?</prompt>
        <noinput><exit/></noinput><filled><log expr="q"/></filled></field></form>"""
    bench = Bench(asks, policy="prima+x10")
    bench.listens()
    bench.silence()
    bench.step(ApplicationLoaded("app"))
    assert bench.saying() == ["Shall we go?"]
    bench.step(Heard("yes", {}, 1000), at=bench.now + 1100)
    assert bench.logs() == []
    assert bench.session.hearing.take_unheard() == "yes"
    assert check(bench.records, "prima+x10") == []
    bench.listens()
    bench.step(Heard("no"), at=bench.now + 2000)
    assert bench.logs() == ["false"]
