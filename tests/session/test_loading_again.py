"""An application that is loaded again is another one than before."""

from __future__ import annotations

from prima.messages import ApplicationLoaded, ApplicationUnloaded, Fetched
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
