"""Which of several handlers takes an event: VoiceXML 2.0, 5.2.4."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import LEAF, PAGE, Case, Cases, block, leaf, thrown
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "a handler takes an event by its whole name",
    "5.2.4",
    thrown("<catch event='a.b.c'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "a handler takes events by a prefix of whole tokens",
    "5.2.4",
    thrown("<catch event='a.b'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "part of a token is not a prefix",
    "5.2.4",
    thrown("<catch event='a.b.cc a.bb a.'><log expr='_event'/></catch>", "a.bbb"),
    logs=["a.bbb"],
)
case(
    "half a token takes nothing",
    "5.2.4",
    thrown("<catch event='a.b'><log>x</log></catch>", "a.bc"),
    logs=[],
    ended="a.bc",
)
case(
    "document order decides, not the longer name",
    "5.2.4",
    thrown("<catch event='a'><log>1</log></catch><catch event='a.b.c'><log>2</log></catch>"),
    logs=["1"],
)
case(
    "the inner scope comes first",
    "5.2.4",
    "<catch event='a.b.c'><log>doc</log></catch>"
    + thrown("<catch event='a'><log>form</log></catch>"),
    logs=["form"],
)
case(
    "a document's handler takes what the form does not",
    "5.2.4",
    "<catch event='a'><log>doc</log></catch>" + thrown("<catch event='b'><log>no</log></catch>"),
    logs=["doc"],
)
case(
    "the root's handler comes after the document's",
    "5.2.4",
    f"""{LEAF}<catch event="a"><log>leaf</log></catch><form><block><throw event="a"/></block>
    <block><throw event="b"/></block></form></vxml>""",
    logs=["leaf", "root"],
    files={"root": f"{PAGE}<catch event='a b'><log>root</log></catch></vxml>"},
)
case(
    "a handler whose condition is false is passed over",
    "5.2.4",
    thrown(
        "<catch event='a' cond='false'><log>1</log></catch>"
        "<catch event='a' cond=\"_event == 'a.b.c'\"><log>2</log></catch>"
    ),
    logs=["2"],
)
case(
    "a higher count in an outer scope wins",
    "5.2.4",
    """<nomatch count="2"><log>doc</log></nomatch><form><field name="f"><option>x</option>
    <nomatch><log>field</log></nomatch></field></form>""",
    "y",
    "y",
    logs=["field", "doc"],
)
case(
    "a handler runs as if it were copied to where the event was thrown",
    "5.2.4",
    """<var name="x" expr="'doc'"/><catch event="a"><log expr="x"/><log expr="dialog.x"/></catch>
    <form><var name="x" expr="'dlg'"/><block><throw event="a"/></block></form>""",
    logs=["dlg", "dlg"],
)
case(
    "a handler's gotos are of the active document",
    "5.2.4",
    f"""{LEAF}<form><block><throw event="a"/></block></form>
    <form id="t"><block><log>leaf</log></block></form></vxml>""",
    logs=["leaf"],
    files={
        "root": f"{PAGE}<catch event='a'><goto next='#t'/></catch>"
        "<form id='t'><block><log>root</log></block></form></vxml>"
    },
)
case(
    "a handler's goto nextitem is of the active form",
    "5.2.4",
    """<catch event="a"><goto nextitem="c"/></catch><form><block><throw event="a"/></block>
    <block><log>b</log></block><block name="c"><log>c</log></block></form>""",
    logs=["c", "b"],
)
case(
    "an error in a handler's condition is an event itself",
    "5.2.4",
    """<form><catch event="a" cond="zz"><log>a</log></catch>
    <catch event="error.semantic"><log expr="_event"/><exit/></catch>
    <block><throw event="a"/></block></form>""",
    logs=["error.semantic"],
)
case(
    "the condition of a handler that takes another event is not looked at",
    "5.2.4",
    """<form><catch event="b" cond="zz"><log>b</log></catch>
    <catch event="a"><log>a</log></catch><block><throw event="a"/></block></form>""",
    logs=["a"],
)
case(
    "conditions are looked at before counts",
    "5.2.4",
    """<form><catch event="a" count="9" cond="zz"><log>a</log></catch>
    <catch event="error.semantic"><log expr="_event"/><exit/></catch>
    <block><throw event="a"/></block></form>""",
    logs=["error.semantic"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_leafs_handler_comes_before_the_roots() -> None:  # 5.2.4
    call = Call(
        leaf('<catch event="odd"><log>leaf</log><exit/></catch>' + block('<throw event="odd"/>')),
        root=vxml('<catch event="odd"><log>root</log><exit/></catch>'),
    )
    assert call.logs() == ["leaf"]
