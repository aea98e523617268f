"""An error in one application ends that application alone (E2)."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from prima import api
from prima.interpreter import bounds
from prima.interpreter.application import Interpreter
from prima.interpreter.transfers import Thrown, Transfer
from prima.messages import Ended, Event, Sensed
from prima.script.evaluation import ScriptError
from prima.script.sandbox import reason
from tests.helpers.robot import Bench, document
from tests.helpers.voice import Call

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="x">'
VXML = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form><block>{}</block></form></vxml>'
)
HELLO = '<form id="f"><on event="touch"><speak>Hello.</speak></on></form>'


@pytest.mark.parametrize(
    "content", ["<par/>", "<seq/>", "<par><seq/></par>", "<par><seq/><seq/></par>"]
)
def test_branches_without_commands_take_no_time(content: str) -> None:
    bench = Bench(f'<form id="f"><block>{content}<speak>Hi.</speak></block></form>')
    assert bench.saying() == ["Hi."]


def test_a_watch_that_fails_leaves_the_others_alone() -> None:
    bench = Bench(
        """<watch name="one" when="sensor.arm.joint.angle > 1"/><watch name="two" when="sensor.light &lt; 5"/>
        <on event="error"><log>failed</log></on><on event="two"><log>dark</log></on>
        <form id="f"/>"""
    )
    bench.step(Sensed({"light": 3}))
    assert sorted(bench.logs()) == ["dark", "failed"]


@pytest.mark.parametrize(
    ("handler", "outcome"),
    [("", "error.semantic: app.xml:"), ('<on event="error"><exit/></on>', "exit")],
)
def test_a_watch_that_ends_the_application_is_the_last_one(handler: str, outcome: str) -> None:
    bench = Bench(
        f"""<var name="a"/><watch name="one" when="a.b.c"/><watch name="two" when="sensor.light &lt; 5"/>
        {handler}<form id="f"/>"""
    )
    bench.step(Sensed({"light": 3}))
    (over,) = bench.phases("unload")
    assert str(over["outcome"]).startswith(outcome) and bench.session.defects == []


@pytest.mark.parametrize(
    "content",
    [
        '<goto next="%00"/>',
        "<goto expr=\"'a%00.vxml'\"/>",
        "<script srcexpr=\"'a%00b'\"/>",
        '<goto next="round.vxml"/>',
    ],
)
def test_what_names_no_file_is_badfetch(content: str, tmp_path: Path) -> None:
    (tmp_path / "round.vxml").symlink_to("about.vxml")
    (tmp_path / "about.vxml").symlink_to("round.vxml")
    (tmp_path / "y.vxml").write_text(VXML.format(content))
    (tmp_path / "fa.xml").write_text(HEAD.replace("ea", "fa") + HELLO + "</prima>")
    loaded = api.stage([str(tmp_path / "fa.xml")], [str(tmp_path / "y.vxml")])
    made = api.rehearse(loaded)
    assert made.defects == []
    assert len(made.failures) == 1 and "error.badfetch" in made.failures[0]


@pytest.mark.parametrize("where", ["event", "start", "takes", "notice", "sensed"])
def test_a_defect_of_an_interpreter_costs_its_application_alone(
    where: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = getattr(Interpreter, where)

    def broken(self: Interpreter, *given: object) -> object:
        if self.name == "bad":
            raise IndexError("list index out of range")
        return whole(self, *given)

    monkeypatch.setattr(Interpreter, where, broken)
    bad = '<form id="f"><block><speak>One.</speak><speak>Two.</speak></block></form>'
    bench = Bench(document(bad, "ea", "bad"), document(HELLO, "fa", "good"))
    for _ in range(3):
        bench.event("touch.head")
        while bench.running():
            bench.step(*[Ended(name) for name in bench.running()])
        bench.step(Sensed({"light": 1}))
    assert bench.said().count("Hello.") == 3
    assert {type(error) for error in bench.session.defects} == {IndexError}
    (over,) = bench.phases("unload")
    assert over["app"] == "bad" and "this is a defect of prima: IndexError" in over["outcome"]


def test_a_defect_names_the_line_that_was_gone_through(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(
        '<form id="f">\n<block><log>on</log></block>\n<on event="a"><log>b</log></on></form>'
    )

    def broken(self: Interpreter, now: int, event: Event) -> None:
        raise KeyError("b")

    monkeypatch.setattr(Interpreter, "event", broken)
    bench.event("a")
    (error,) = bench.phases("error")
    assert error["message"].startswith("app.xml:2:8: this is a defect of prima")


AGAIN = '<assign name="n" expr="n + 1"/><if cond="n == 60"><log>sixty</log></if><if cond="n == 90"><exit/></if>'
FAILS = '<assign name="m" expr="m.a.b"/>'


@pytest.mark.parametrize(
    "forms",
    [
        f"""<form id="f"><on event="error">{AGAIN}<pause time="1s"/><goto next="#f"/></on>
        <block>{FAILS}</block></form>""",
        f"""<form id="f"><on event="a"><pause time="1s"/><throw event="b"/></on>
        <on event="b">{AGAIN}<pause time="1s"/><goto next="#f"/></on><block><throw event="a"/></block></form>""",
        f"""<form id="f"><on event="touch"/><block cond="m.a.b"/>
        <on event="error">{AGAIN}<pause time="1s"/><goto next="#f"/></on></form>""",
        f"""<form id="f"><subdialog name="s" src="#g"/><on event="a">{AGAIN}<pause time="1s"/><goto next="#f"/></on></form>
        <form id="g"><on event="error"><pause time="1s"/><return event="a"/></on><block>{FAILS}</block></form>""",
    ],
)
def test_what_failed_is_forgotten_once_it_is_handled(forms: str, tmp_path: Path) -> None:
    """A content that waits would keep the frames of all that failed before, without end."""
    (tmp_path / "x.xml").write_text(f'{HEAD}<var name="n" expr="0"/><var name="m"/>{forms}</prima>')
    kept: list[int] = []

    def look(line: str) -> None:
        if '"phase":"log"' in line:
            gc.collect()
            kinds = (Thrown, Transfer, ScriptError)
            kept.append(sum(isinstance(one, kinds) for one in gc.get_objects()))

    gc.collect()
    api.rehearse(api.stage([], [str(tmp_path / "x.xml")]), sink=look)
    assert len(kept) == 1 and kept[0] < 20


def test_a_dialog_that_begins_again_and_again_ends_soon() -> None:
    """An item takes more work than other content: the engine is asked several times."""
    call = Call('<form><block name="b"><log>x</log><clear/></block></form>')
    (failure,) = call.session.failures
    assert failure.endswith("it loops without ever waiting") and len(call.logs()) < 2_000


@pytest.mark.parametrize(
    ("forms", "most"),
    [
        ('<form id="f"><subdialog name="s" src="#g"/><block><goto next="#f"/></block></form>', 5_000),
        ('<form id="f"><block name="b"><clear/></block></form>', 5_000),
        ('<form id="f">{}<block name="b"><clear/></block></form>', 100),
    ],
)  # fmt: skip
def test_what_begins_again_and_again_asks_the_engine_a_bounded_number_of_times(
    forms: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A form, an item and each name of a clear take more work than other content."""
    begun: list[tuple[str, str]] = []
    monkeypatch.setattr(
        Interpreter, "note", lambda _self, node, what="in": begun.append((node.tag, what))
    )
    items = "".join(f'<block name="b{i}" cond="false"/>' for i in range(400))
    bench = Bench(forms.format(items) + '<form id="g"><block><return/></block></form>')
    assert begun.count(("block", "in")) <= most and bench.session.failures


def test_memory_that_leaves_none_for_an_error_is_told_as_such() -> None:
    assert reason("[uninitialized]", 0.5) == "it used too much memory"


LOOPS = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r"
 tag-format="semantics/1.0"><rule id="r">yes<tag>for(;;){}</tag></rule></grammar>"""
ASKS = HEAD + (
    '<form id="f"><field name="a"><prompt>Well?</prompt><grammar src="g.grxml"/>'
    '<nomatch><reprompt/></nomatch><noinput count="2"><exit/></noinput></field></form></prima>'
)
ASKS_BY_VOICEXML = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"><form>'
    '<field name="a"><prompt>Well?</prompt><grammar src="g.grxml"/><nomatch><reprompt/></nomatch>'
    "</field></form></vxml>"
)


@pytest.mark.parametrize(("name", "text"), [("a.xml", ASKS), ("a.vxml", ASKS_BY_VOICEXML)])
def test_tags_that_take_long_at_each_answer_end_their_application(
    name: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each utterance alone is within its bound, and the question is asked again."""
    monkeypatch.setattr(bounds, "MAX_RUN_SECONDS", 0.8)
    (tmp_path / "g.grxml").write_text(LOOPS)
    path = tmp_path / name
    path.write_text(text)
    made = api.rehearse(api.stage([], [str(path)], ["yes"] * 6))
    assert "its scripts took 1." in made.failures[0]
    asked = [one for one in made.records if one["phase"] == "start" and one.get("text") == "Well?"]
    assert len(asked) == 2


AMBIGUOUS = """<grammar root="r" version="1.0" xmlns="http://www.w3.org/2001/06/grammar"><rule id="r">
  <one-of><item><ruleref uri="#r"/><ruleref uri="#r"/></item><item>a</item></one-of></rule></grammar>"""


@pytest.mark.parametrize("handled", ["", "<nomatch>Pardon?</nomatch>"])
def test_an_application_that_listens_for_too_much_ends(handled: str) -> None:
    """It was over, and yet never ended: its end came with the next thing that it asked for."""
    call = Call(
        f"<form><field name='f'>{AMBIGUOUS * 2}<prompt>Well?</prompt>{handled}</field></form>"
    )
    call.listens()
    call.hears("a " * 200)
    (over,) = call.phases("unload")
    assert "what it listens for takes too long" in over["outcome"] and over["rule"] == "E2"
    assert call.session.defects == []
