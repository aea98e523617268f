"""Content that a user would hear twice, because it is cancelled and run again (O3)."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api, loading
from prima.errors import Problem
from prima.interpreter.reader import read_document
from prima.messages import Ended
from tests.helpers.robot import Bench
from tests.helpers.validating import VXML
from tests.helpers.voice import Call

ASKS = """<form id="a"><field name="x" type="boolean"><prompt>Well?</prompt>{}</field>{}</form>"""
THEN = """<form id="b">{}</form>"""
BACK = '<block><goto next="#a"/></block>'


@pytest.mark.parametrize(
    "first, then",
    [
        (ASKS.format("", '<on event="touch"><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'), THEN.format(BACK)),
        (ASKS.format('<on event="touch"><speak>Oh.</speak><goto next="#a"/></on>', ""), ""),
        ('<form id="a"><block><speak>Hi.</speak></block><on event="touch"><if cond="true"><goto next="#a"/></if></on></form>', ""),
        (ASKS.format("", ""), '<on event="message"><goto next="#b"/></on>' + THEN.format(BACK)),
        ('<form id="a"><block><speak>Hi.</speak></block><on event="human.lost"><goto next="#a"/></on></form>', ""),
    ],
    ids=["at once", "by way of another", "behind a Command", "a sentence", "of the document", "to nobody"],
)  # fmt: skip
def test_what_an_event_makes_it_tell_twice_is_warned_of(first: str, then: str) -> None:
    (problem,) = told_twice_in(first + then)
    assert problem.severity == "warning" and problem.remedy.startswith("Leave out the <goto>")
    assert "it is said twice" in problem.message and "(line 1)" in problem.message


@pytest.mark.parametrize(
    "first, then",
    [
        (ASKS.format("", '<on event="touch"><gesture name="bow"/></on>'), ""),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'), THEN.format("")),
        (ASKS.format("<noinput><goto next='#a'/></noinput>", ""), ""),
        (ASKS.format("", '<on event="human.lost"><goto next="#b"/></on>'), THEN.format(BACK)),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'),
         THEN.format('<field name="y" type="boolean"><prompt>So?</prompt></field>' + BACK)),
        (ASKS.replace("<prompt>", '<prompt cond="first">').format("", '<on event="touch"><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<on event="message"><assign name="n" expr="event.data.text"/><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<link event="again"><grammar>again</grammar></link><on event="again"><goto next="#a"/></on>'), ""),
        ('<form id="a"><block><send event="late" delay="9s"/><speak>Hi.</speak></block><on event="late"><goto next="#a"/></on></form>', ""),
        ('<form id="a"><block><move-head pan="9"/></block><on event="touch"><goto next="#a"/></on></form>', ""),
    ],
    ids=["stays", "goes and waits", "own event", "user gone", "asks between", "cond", "news", "asked for", "timer", "silent"],
)  # fmt: skip
def test_what_is_meant_to_be_told_again_is_not_warned_of(first: str, then: str) -> None:
    assert told_twice_in(first + then) == []


SAYS = '<block name="h"><speak>Hello there, and welcome.</speak></block>'
TO = "<on event='touch'>{}</on>"
BY = '<goto next-expr="{}"/>'
CALLS = """<form id="b"><subdialog name="s" src="#c">{}</subdialog><block>{}</block></form>
<form id="c">{}</form>"""
BACK_THEN, RETURNS = '<goto next="#a"/>', "<block><gesture name='nod'/><return/></block>"
CALLED_BACK = ASKS.format("", TO.format('<goto next="#b"/>'))
END = '<form id="end"><block><exit/></block></form>'


def form_of(inside: str, form: str = "a") -> str:
    return f'<form id="{form}">{inside}</form>'


ANSWERED = '<field name="x" type="boolean"><prompt>Well?</prompt>{}<filled><exit/></filled></field>'
AGAIN = {
    "a text": (form_of(SAYS + TO.format(BY.format("'#a'"))), "this leads back to"),
    "one of two": (form_of(SAYS + TO.format(BY.format("n ? 'end' : (first ? 'a' : 'end')"))) + END, "leads back"),
    "anywhere": (form_of(SAYS + TO.format(BY.format("n"))), "it may be said twice: where this leads depends"),
    "begins so": (form_of(SAYS + TO.format(BY.format("'#a' + n"))), "may be said twice"),
    "anywhere from elsewhere": (
        CALLED_BACK + THEN.format(f"<block>{BY.format('n')}</block>"), "may be said twice"),
    "anywhere, of the document": (form_of(SAYS) + TO.format(BY.format("n")), "may be said twice"),
    "a subdialog returns with an event": (
        '<form id="s"><subdialog name="d" src="#a"><on event="bang"><log>x</log></on></subdialog></form>'
        + ASKS.format("", TO.format('<return event="bang"/>')), "calls it again"),
    "a subdialog": (CALLED_BACK + CALLS.format("", BACK_THEN, RETURNS), "leads back"),
    "what was called is over": (
        CALLED_BACK + CALLS.format(f"<filled>{BACK_THEN}</filled>", "", RETURNS), "leads back"),
    "the form's filled": (
        CALLED_BACK + CALLS.format("", "", RETURNS).replace("<block></block>", f"<filled>{BACK_THEN}</filled>"),
        "leads back"),
    "an event of a subdialog": (
        CALLED_BACK + CALLS.format(f"<on event='over'>{BACK_THEN}</on>", "",
                                   "<block><return event='over'/></block>"), "leads back"),
    "a subdialog by way of others": (
        CALLED_BACK + CALLS.format("", BACK_THEN, "<subdialog name='s' src='#d'/><block><return/></block>")
        + '<form id="d"><block><goto next="#e"/></block></form><form id="e"><block><return/></block></form>',
        "leads back"),
    "in a subdialog": (CALLED_BACK + CALLS.format("", "", f"<block>{BACK_THEN}</block>"), "leads back"),
    "thrown on the way": (
        CALLED_BACK + THEN.format(f"<on event='over'>{BACK_THEN}</on><block><throw event='over'/></block>"),
        "leads back"),
    "its item": (form_of(ANSWERED.format("") + TO.format('<clear/><goto nextitem="x"/>')), "asks this (line 1), it is"),
    "its item, not cleared": (form_of(ANSWERED.format("") + TO.format('<goto nextitem="x"/>')), "visits it again"),
    "its item, by a text": (form_of(SAYS + TO.format("<goto nextitem-expr=\"'h'\"/>")), "says this (line 1), it is"),
    "any item": (form_of(SAYS + TO.format('<goto nextitem-expr="n"/>')), "which item is next depends"),
    "its first item, then it": (
        form_of('<block name="s"/>' + ANSWERED.format("") + TO.format('<goto nextitem="s"/>')), "asks this"),
    "cleared": (
        form_of(SAYS + '<block name="s"/>' + TO.format('<clear namelist="h"/><goto nextitem="s"/>')), "says this"),
    "all cleared": (
        form_of(SAYS + '<block name="s"/>' + TO.format('<clear/><goto nextitem="s"/>')), "says this"),
    "round and round": (
        form_of('<block><speak>Hello.</speak><goto next="#b"/></block>' + TO.format('<goto next="#b"/>'))
        + THEN.format('<block><gesture name="nod"/><goto next="#a"/></block>'), "leads back"),
    "an item, of the document": (form_of(SAYS) + TO.format('<clear/><goto nextitem="h"/>'), "says this"),
    "tapered, cleared": (
        form_of(ANSWERED.format('<prompt count="2">Yes or no?</prompt>')
                     + TO.format('<clear namelist="x"/><goto nextitem="x"/>')), "asks this"),
}  # fmt: skip


@pytest.mark.parametrize("name", AGAIN)
def test_all_ways_back_are_warned_of(name: str) -> None:
    body, says = AGAIN[name]
    (problem,) = told_twice_in(body)
    assert problem.severity == "warning" and says in problem.message
    assert ("in the expression" in problem.remedy) == ("may be" in problem.message)


VALUES = {"begins so": "''", "one of two": "0", "any item": "'h'"}
"""What the variable ``n`` is where its form is not "a"."""


@pytest.mark.parametrize("name", AGAIN)
def test_what_is_warned_of_is_said_twice_in_a_run(name: str) -> None:
    variables = f"""<var name="first" expr="1"/><var name="n" expr="{VALUES.get(name, "'a'")}"/>"""
    assert_said_twice(Bench(AGAIN[name][0] + variables))


def assert_said_twice(bench: Bench) -> None:
    """A touch while the first sentence is said makes an application say it again."""
    (first,) = bench.said()
    bench.event("touch")
    for _ in range(9):
        if bench.said().count(first) == 1:
            bench.step(*[Ended(one, data={"outcome": "noinput"}) for one in bench.running()])
    assert bench.said()[1:] in ([first], ["Oh.", first])


CALLER = '<form id="s"><subdialog name="d" src="#a"><on event="bang">{}</on></subdialog></form>'
BANG = ASKS.format("", TO.format('<return event="bang"/>'))
NEVER_AGAIN = {
    "who called goes elsewhere": CALLER.format("<goto next='#end'/>") + END + BANG,
    "who called ends": CALLER.format("<exit/>") + BANG,
    "who called takes it for answered": CALLER.format("<assign name='d' expr='1'/>") + BANG,
    "who called handles another event": CALLER.replace("bang", "other").format("") + BANG,
    "returns with no event": CALLER.format("") + ASKS.format("", TO.format("<return/>")),
    "a text": form_of(SAYS + TO.format(BY.format("'#end'"))) + END,
    "one of two": form_of(SAYS + TO.format(BY.format("n ? 'end' : 'other'"))) + END + form_of(SAYS, "other"),
    "begins otherwise": form_of(SAYS + TO.format(BY.format("'#en' + n"))) + END,
    "asks before it goes anywhere": CALLED_BACK
    + THEN.format('<field name="y" type="boolean"><prompt>So?</prompt></field>' + f"<block>{BY.format('n')}</block>"),
    "a subdialog that asks": CALLED_BACK + CALLS.format("", BACK_THEN, ANSWERED.format("") + RETURNS),
    "a subdialog that never returns": CALLED_BACK + CALLS.format("", BACK_THEN, "<block><gesture name='nod'/></block>"),
    "subdialogs of each other": CALLED_BACK + CALLS.format("", BACK_THEN, "<subdialog name='s' src='#b'/>" + RETURNS),
    "waits for more than a subdialog": CALLED_BACK
    + CALLS.format("", "", RETURNS).replace(
        "<block></block>", f"<field name='y' type='boolean'/><filled>{BACK_THEN}</filled>"),
    "an event that nobody takes": CALLED_BACK + CALLS.format("", BACK_THEN, "<block><return event='over'/></block>"),
    "ends before": CALLED_BACK + THEN.format("<block><exit/></block>" + BACK),
    "another item": form_of(SAYS + '<block name="s"/>' + TO.format('<goto nextitem="s"/>')),
    "a text of another item": form_of(SAYS + '<block name="s"/>' + TO.format("<goto nextitem-expr=\"'s'\"/>")),
    "an item that asks, then what is cleared": form_of(
        '<block name="h"><speak>Hello.</speak></block><field name="y" type="boolean"><prompt cond="n">So?</prompt></field>'
        + TO.format('<clear namelist="h"/><goto nextitem="y"/>')),
    "a question between, cleared": form_of(
        '<field name="y" type="boolean"><prompt cond="n">So?</prompt></field>' + SAYS + '<block name="s"/>'
        + TO.format('<clear/><goto nextitem="s"/>')),
    "an item, taken by the form": form_of(SAYS + TO.format("<gesture name='nod'/>"))
    + TO.format('<goto nextitem="h"/>'),
    "leaves the form": form_of(SAYS + '<block name="s" expr="true"><goto next="#end"/></block>'
                                    + TO.format('<clear/><goto nextitem="s"/>')) + END,
    "tapered": form_of(ANSWERED.format('<prompt count="2">Yes or no?</prompt>') + TO.format('<goto nextitem="x"/>')),
    "the handler of another item": form_of(
        SAYS + '<field name="y" type="boolean"><prompt cond="n">So?</prompt>' + TO.format('<goto nextitem="h"/>') + "</field>"),
    "taken by the form": form_of(SAYS + TO.format("<gesture name='nod'/>")) + TO.format(BY.format("'a'")),
}  # fmt: skip


@pytest.mark.parametrize("name", NEVER_AGAIN)
def test_other_ways_are_not_warned_of(name: str) -> None:
    assert told_twice_in(NEVER_AGAIN[name]) == []


def test_of_a_goto_that_may_lead_anywhere_one_example_is_told() -> None:
    forms = "".join(form_of(SAYS, name) for name in "abcd")
    (problem,) = told_twice_in(forms + TO.format(BY.format("n")))
    assert 'the form "a" says this' in problem.message


def told_twice_in(body: str) -> list[Problem]:
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="x"><var name="first"/><var name="n"/>'
    _, problems = read_document("x.xml", f"{head}{body}</prima>".encode())
    assert [one for one in problems if one.severity == "error"] == []
    return [one for one in problems if one.code == "told-twice"]


ASKS_VOICE = "<form id='a'><field name='x' type='boolean'><prompt>Well?</prompt>{}</field>{}</form>"
BACK_VOICE = "<form id='b'>{}<block><goto next='#a'/></block></form>"
TOUCHED = "<catch event='touch'>{}<goto next='#{}'/></catch>"
HANDLED = "<catch event='message'>{}<goto next='#a'/></catch>"


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (ASKS_VOICE.format("", TOUCHED.format("", "a")), 'the form "a" asks this (line 2)'),
        (ASKS_VOICE.format("", TOUCHED.format("Oh.", "b")) + BACK_VOICE.format(""), "asks this"),
        (ASKS_VOICE.format("<catch event='touch.head'><goto next='#a'/></catch>", ""), "touch.head"),
        (ASKS_VOICE.format("", "") + TOUCHED.format("", "a"), 'If "touch" comes'),
        ("<form id='a'><block>Hi.</block>" + TOUCHED.format("", "a") + "</form>", "says this (line 2)"),
        ("<form id='a'><block>Hi.</block><catch event='touch'><if cond='true'><goto next='#a'/></if>"
         "</catch></form>", "says this"),
        ("<form><block><prompt>Hi.</prompt></block><catch event='touch'><goto next='main.vxml'/></catch>"
         "</form>", "the form #1 says this (line 2), it is said twice: this leads back to the form's"),
        ("<menu id='a'>Well? <choice next='#a'>yes</choice>" + TOUCHED.format("", "a") + "</menu>",
         'the menu "a" asks this (line 2), it is said twice: this leads back to the menu\'s beginning'),
        ("<form id='a'><p:iu xmlns:p='urn:prima:dialogue:1'><block>Hi.</block></p:iu>"
         + TOUCHED.format("", "a") + "</form>", "says this"),
        (ASKS_VOICE.format("", "<catch event='touch'><submit next='service:s#a'/></catch>"), "asks"),
    ],
    ids=["at once", "by way of another", "in a field", "of the document", "a sentence", "in an if",
         "by its file", "a menu", "in a unit", "by a submit"],
)  # fmt: skip
def test_voicexml_is_warned_of_what_it_tells_twice(tmp_path: Path, body: str, says: str) -> None:
    (problem,) = told_twice_by(tmp_path, body)
    assert problem.severity == "warning" and says in problem.message
    assert problem.remedy.startswith("Leave out the <goto>: the dialog goes on then.")
    at = f"<vxml>\n{body}".splitlines()[problem.place.line - 1][problem.place.column - 1 :]
    assert at.startswith(("<goto", "<submit"))


@pytest.mark.parametrize(
    "body",
    [
        ASKS_VOICE.format("", "<catch event='touch'>Oh. <reprompt/></catch>"),
        ASKS_VOICE.format("", TOUCHED.format("", "b")) + "<form id='b'/>",
        ASKS_VOICE.format("<noinput><goto next='#a'/></noinput>", ""),
        ASKS_VOICE.format("<catch><goto next='#a'/></catch>", ""),
        ASKS_VOICE.format("<error><goto next='#a'/></error>", ""),
        ASKS_VOICE.format("<catch event='connection.disconnect'><goto next='#a'/></catch>", ""),
        ASKS_VOICE.format("", TOUCHED.format("", "b"))
        + BACK_VOICE.format("<field name='y' type='boolean'><prompt>So?</prompt></field>"),
        ASKS_VOICE.replace("<prompt>", "<prompt cond='!first'>").format("", TOUCHED.format("", "a")),
        ASKS_VOICE.format("", HANDLED.format("<assign name='n' expr='session.event.data.text'/>")),
        ASKS_VOICE.format("", "<link event='again' dtmf='1'/><catch event='again'><goto next='#a'/></catch>"),
        ASKS_VOICE.format("<filled><throw event='touch'/></filled>", TOUCHED.format("", "a")),
        "<form id='a'><block><log>Hi.</log></block>" + TOUCHED.format("", "a") + "</form>",
        "<form id='a'><block cond='!first'>Hi.</block>" + TOUCHED.format("", "a") + "</form>",
    ],
    ids=["stays", "goes and ends", "own event", "any event", "error", "hangup", "asks between", "cond",
         "news", "asked for", "thrown", "silent", "a condition"],
)  # fmt: skip
def test_voicexml_may_tell_again_what_is_meant_so(tmp_path: Path, body: str) -> None:
    assert told_twice_by(tmp_path, body) == []


H = "<block name='h'>Hello there, and welcome.</block>"
TOUCH = "<catch event='touch'>{}</catch>"
VOICE_CALLS = """<form id='b'><subdialog name='s' src='{}'>{}</subdialog><block>{}</block></form>
<form id='c'>{}</form>"""
TO_B, TO_A, NODS = "<goto next='#b'/>", "<goto next='#a'/>", "<block>Oh.<return/></block>"
VX = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"{}>{}</vxml>'
OVER_THERE = VX.format("", "<form id='b'><block>Oh.<goto next='main.vxml#a'/></block></form>")
Q = "<field name='x' type='boolean'><prompt>Well?</prompt>{}</field>"
HQ = H + Q.format("")
VOICE_AGAIN: dict[str, tuple[str, str, dict[str, str]]] = {
    "a text": (form_of(HQ + TOUCH.format("<goto expr=\"'#a'\"/>")), "leads back", {}),
    "one of two": (
        form_of(HQ + TOUCH.format("<goto expr=\"n ? 'other.vxml' : '#a'\"/>")), "leads back", {}),
    "anywhere": (form_of(HQ + TOUCH.format("<goto expr='n'/>")), "where this leads depends", {}),
    "begins so": (form_of(HQ + TOUCH.format("<goto expr=\"'#' + n.substring(1)\"/>")), "may be said", {}),
    "begins with a file's name": (
        form_of(HQ + TOUCH.format("<goto expr=\"'mai' + n\"/>")), "may be said", {}),
    "another document": (
        form_of(HQ + TOUCH.format("<goto next='other.vxml'/>")), "leads back", {"other": OVER_THERE}),
    "a dialog of another document": (
        form_of(Q.format("") + TOUCH.format("<submit next='other.vxml#b'/>")), "leads back",
        {"other": OVER_THERE}),
    "two other documents": (
        form_of(HQ + TOUCH.format("<goto next='third.vxml'/>")), "leads back",
        {"other": OVER_THERE,
         "third": VX.format("", "<form><block><goto next='other.vxml'/></block></form>")}),
    "a subdialog of another document": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("other.vxml#c", "", TO_A, ""), "leads back",
        {"other": VX.format("", form_of(NODS, "c"))}),
    "a subdialog": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, NODS), "leads back", {}),
    "a subdialog's filled": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", f"<filled>{TO_A}</filled>", "", NODS),
        "leads back", {}),
    "an event of a subdialog": (
        form_of(HQ + TOUCH.format(TO_B))
        + VOICE_CALLS.format("#c", f"<catch event='over'>{TO_A}</catch>", "",
                             "<block><return event='over'/></block>"), "leads back", {}),
    "its item": (form_of(HQ + TOUCH.format("<clear/><goto nextitem='h'/>")), "visits it again", {}),
    "its item, not cleared": (form_of(HQ + TOUCH.format("<goto nextitem='h'/>")), "says", {}),
    "in the question behind it": (
        form_of(H + Q.format(TOUCH.format("<clear/><goto nextitem='h'/>"))), "says", {}),
    "a silent item": (
        form_of("<block name='s'/>" + Q.format("") + TOUCH.format("<goto nextitem='s'/>")), "asks", {}),
    "any item": (form_of(HQ + TOUCH.format("<goto expritem=\"'h' + n.slice(9)\"/>")), "may be this one", {}),
    "tapered, cleared": (
        form_of("<block name='s'/>" + Q.format("<prompt count='2'>So?</prompt>")
                + TOUCH.format("<clear namelist='dialog.x'/><goto nextitem='s'/>")), "asks", {}),
}  # fmt: skip


@pytest.mark.parametrize("name", VOICE_AGAIN)
def test_all_ways_back_in_voicexml_are_warned_of(tmp_path: Path, name: str) -> None:
    body, says, others = VOICE_AGAIN[name]
    for other, text in others.items():
        (tmp_path / f"{other}.vxml").write_text(text)
    (problem,) = told_twice_by(tmp_path, body)
    assert says in problem.message and problem.place.file.endswith("main.vxml")
    assert ("in the expression" in problem.remedy) == ("may be" in problem.message)
    value = {"one of two": "", "begins with a file's name": "n.vxml"}.get(name, "#a")
    main = VX.format("", f"""{body}<var name="n" expr="'{value}'"/>""")
    assert_said_twice(Call(main, **{"app": main, "main": main, **others}))


VOICE_NEVER_AGAIN: dict[str, tuple[str, dict[str, str]]] = {
    "another dialog": (form_of(H + TOUCH.format("<goto expr=\"'#e' + n\"/>")), {}),
    "an answer of a service": (form_of(H + TOUCH.format("<submit next='service:main.vxml'/>")), {}),
    "a service's document": (form_of(H + TOUCH.format("<goto expr=\"'service:s' + n\"/>")), {}),
    "another host": (form_of(H + TOUCH.format("<goto expr=\"'http://x.example/main.vxml'\"/>")), {}),
    "another document that ends": (
        form_of(H + TOUCH.format("<goto next='other.vxml'/>")),
        {"other": VX.format("", "<form><block>Oh.<exit/></block><block><goto next='main.vxml'/></block></form>")}),
    "another document that asks": (
        form_of(H + TOUCH.format("<goto next='other.vxml'/>")),
        {"other": VX.format("", "<form><field name='y' type='boolean'/><block><goto next='main.vxml'/></block></form>")}),
    "another dialog of another document": (
        form_of(H + TOUCH.format("<goto next='other.vxml#c'/>")),
        {"other": OVER_THERE.replace("</form>", "</form><form id='c'><block>Bye.</block></form>")}),
    "a dialog of that name in another document": (
        form_of(H + TOUCH.format("<goto next='other.vxml#a'/>")),
        {"other": VX.format("", form_of("<block>Bye.</block>"))}),
    "a subdialog that asks": (
        form_of(H + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, Q.format("") + NODS), {}),
    "a subdialog without an end": (
        form_of(H + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, "<block>Oh.</block>"), {}),
    "a call": (
        form_of(H + TOUCH.format(TO_B))
        + "<form id='b'><transfer dest='tel:1' type='bridge'/><block><goto next='#a'/></block></form>", {}),
    "a question is not asked again": (
        form_of(Q.format("") + TOUCH.format("<clear/><goto nextitem='x'/>")), {}),
    "a prompt with a condition": (
        form_of("<block><prompt cond='!n'>Hi.</prompt></block>" + TOUCH.format(TO_A)), {}),
    "other words": (
        form_of("<block name='s'/>" + Q.format("<prompt count='2'>So?</prompt>")
                + TOUCH.format("<goto nextitem='s'/>")), {}),
}  # fmt: skip


@pytest.mark.parametrize("name", VOICE_NEVER_AGAIN)
def test_other_ways_in_voicexml_are_not_warned_of(tmp_path: Path, name: str) -> None:
    body, others = VOICE_NEVER_AGAIN[name]
    for other, text in others.items():
        (tmp_path / f"{other}.vxml").write_text(text)
    assert told_twice_by(tmp_path, body) == []


def test_a_handler_of_the_application_root_makes_its_leaf_tell_twice(tmp_path: Path) -> None:
    (tmp_path / "root.vxml").write_text(VXML.format("", TOUCHED.format("", "a")))
    leaf = VXML.format(' application="root.vxml"', ASKS_VOICE.format("", ""))
    (tmp_path / "leaf.vxml").write_text(leaf)
    found = loading.validate([tmp_path / "leaf.vxml"])
    (problem,) = [one for one in found if one.code == "told-twice"]
    assert problem.place.file.endswith("root.vxml")


def told_twice_by(folder: Path, body: str) -> list[Problem]:
    """The warnings about a VoiceXML document, whose content is in line 2."""
    head = "<var name='first'/><var name='n'/>"
    (folder / "main.vxml").write_text(VXML.format("", f"\n{body}{head}"))
    found = loading.validate([folder / "main.vxml"])
    assert [str(one) for one in found if one.severity == "error"] == []
    return [one for one in found if one.code == "told-twice"]


@pytest.mark.parametrize("thrown", ["x.y", "z"])
def test_a_way_back_that_goes_by_a_thrown_event_is_told_too(tmp_path: Path, thrown: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">\n'
        f'<on event="touch"><throw event="{thrown}"/></on>'
        '<on event="x.y"><goto next="#g"/></on><on event="z"><log>z</log></on>\n'
        '<form id="f"><field name="q"><prompt>Well?</prompt><option>yes</option>'
        '<noinput count="3"><exit/></noinput><filled><exit/></filled></field></form>'
        '<form id="g"><block><goto next="#f"/></block></form></prima>'
    )
    told = [one.message for one in api.validate([str(path)]) if one.code == "told-twice"]
    assert [message for message in told if 'If "touch" comes' in message] == (
        [told[0]] if thrown == "x.y" else []
    )
