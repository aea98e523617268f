"""Objects, recordings and transfers as form items: VoiceXML 2.0, 2.3.5 to 2.3.7."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import SILENT, Case, Cases, rule
from tests.helpers.voice import Call

case = Cases()

case(
    "an object the platform does not have is error.unsupported.objectname",
    "2.3.5",
    """<form><object name="o" classid="method://x"><catch event="error.unsupported.objectname">
    <log>none</log><assign name="o" expr="1"/></catch></object><block><log>on</log></block></form>""",
    logs=["none", "on"],
)
case(
    "a recording fills its variable and runs filled",
    "2.3.6",
    """<form><record name="r" maxtime="10s"><prompt>Speak.</prompt>
    <filled><log expr="typeof r"/></filled></record></form>""",
    "anything at all",
    said=["Speak."],
    logs=["string"],
    ended="exit",
)
case(
    "a recording's shadow variables tell of it",
    "2.3.6",
    """<form><record name="r"/><block><log expr="[typeof r$.duration, typeof r$.size,
    r$.maxtime, r$.termchar === null].join()"/></block></form>""",
    "anything",
    logs=["number,number,false,true"],
)
case(
    "silence at a recording is noinput",
    "2.3.6",
    """<form><record name="r"><noinput><log>silent</log></noinput></record></form>""",
    SILENT,
    logs=["silent"],
)
case(
    "a blind transfer is connection.disconnect.transfer",
    "2.3.7.1",
    """<form><transfer name="t" dest="tel:1" bridge="false"><catch
    event="connection.disconnect.transfer"><log>gone</log><exit/></catch></transfer></form>""",
    logs=["gone"],
)
case(
    "a bridged transfer fills its variable",
    "2.3.7.2",
    """<form><transfer name="t" dest="tel:1" bridge="true"><prompt>Wait.</prompt>
    <filled><log expr="typeof t"/><log expr="t$.duration"/></filled></transfer></form>""",
    said=["Wait."],
    logs=["string", "0"],
    ended="exit",
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def recorded(said: str, more: str = "") -> list[str]:
    call = Call(
        f'<link event="odd">{rule("stop")}</link><catch event="odd"><log>odd</log><exit/></catch>'
        f'<form><record name="r" {more}><prompt>Speak.</prompt>'
        '<filled><log expr="r"/></filled></record></form>'
    )
    call.answer(said)
    return call.logs()


def test_a_record_takes_whatever_is_said() -> None:  # 2.3.6
    assert recorded("I like it") == ["I like it"]
    assert recorded("stop") == ["stop"]


def test_a_record_that_is_not_modal_hears_grammars_first() -> None:  # 2.3.6
    assert recorded("stop", 'modal="false"') == ["odd"]


def test_a_transfers_destination_may_be_an_expression() -> None:  # 2.3.7
    call = Call(
        """<form><transfer name="t" destexpr="'tel:' + 1" bridge="true">
        <filled><log expr="t"/></filled></transfer></form>"""
    )
    call.play()
    assert call.logs() == ["noanswer"]
