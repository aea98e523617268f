"""Events that an application sends or causes itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.certificate import (
    certificate_data,
    format_certificate,
)
from tests.helpers.certified import faults
from tests.helpers.certifying import (
    ASKS,
    FA,
    PROFILE,
    certified,
    lasting,
    run,
    voiced,
    waited,
    without_more_for_each_event,
)


def test_other_events_of_the_ea_make_the_wait_longer(tmp_path: Path) -> None:
    body = '<form id="f"><on event="message"><speak>A message has come.</speak></on></form>'
    (delay,) = certified(tmp_path, body).delays
    assert delay.each == lasting("A message has come.")


ROUNDS = {
    "its own end": "<block><speak>Hello.</speak></block>"
    '<on event="end.speak" reactive="true"><speak>I go on and on.</speak></on>',
    "two ends in turn": "<block><speak>Hello.</speak></block>"
    '<on event="end.speak" reactive="true"><turn-and-speak toward="door">So.</turn-and-speak></on>'
    '<on event="end.turn-and-speak" reactive="true"><speak>And so on.</speak></on>',
    "what goes on beside": '<block><gesture name="nod"/></block>'
    '<on event="end.gesture"><move-head pan="3"/><gesture name="nod"/></on>'
    '<on event="end.move-head" reactive="true"><speak>A sentence longer than a nod.</speak></on>',
    "a send": '<block><send event="x"/></block><on event="x" reactive="true">'
    '<send event="x" delay="900ms"/><speak>A sentence that is longer.</speak></on>',
}
"""Reactions of an EA to its own events that come again and again, without a turn for others."""


@pytest.mark.parametrize("body", ROUNDS.values(), ids=ROUNDS)
def test_reactions_to_own_events_that_go_round_have_no_bound(tmp_path: Path, body: str) -> None:
    found = certified(tmp_path, f'<form id="f">{body}</form>')
    (delay,) = found.delays
    assert delay.endless and not delay.known
    data = certificate_data(found)["delays"][0]
    assert (data["known"], data["lasts"]) == (False, None)
    assert data["without_end"][0]["place"].startswith(str(tmp_path / "theirs.xml:1:"))
    assert data["response"]["without_end"] == data["without_end"]
    text = format_certificate(found)
    assert "touch: without a bound, for the" in text and "more for each" not in text
    assert "(K1, K2)" not in text
    at = '<when at="4s"><touch sensor="head"/></when>'
    records = run(tmp_path, "mine.xml", "theirs.xml", at)
    assert "Yes?" not in [one.get("text") for one in records if one["phase"] == "start"]


def test_the_reason_names_the_loop_and_its_line(tmp_path: Path) -> None:
    found = certified(tmp_path, f'\n<form id="f">\n{ROUNDS["its own end"]}</form>')
    line = "without an end: what is done about end.speak leads to it again, at"
    assert f"{line} {tmp_path}/theirs.xml:3:" in format_certificate(found)


def test_a_watch_that_the_robot_itself_makes_true_has_no_bound(tmp_path: Path) -> None:
    watch = '<watch name="still" when="{}"/><form id="f"><on event="still"><turn angle="20"/></on></form>'
    own = FA.replace("<speak>", '<turn angle="40"/><speak>')
    (delay,) = certified(tmp_path, watch.format("!sensor.moving"), own).delays
    assert [gap.reason for gap in delay.endless] == ["what is done about still leads to it again"]
    (delay,) = certified(tmp_path, watch.format("sensor.battery &lt; 3"), own).delays
    assert delay.known and delay.each == delay.lasts


@pytest.mark.parametrize(
    "body",
    [
        '<block><speak>Hello.</speak></block><on event="end.speak" reactive="true">'
        '<turn-and-speak toward="door">Once.</turn-and-speak></on>',
        '<block><send event="x" delay="99s"/></block><on event="x" reactive="true">'
        '<send event="x" delay="99s"/><speak>It is time.</speak></on>',
        '<block><send event="x"/></block><on event="x" reactive="true">'
        '<speak>I let others in.</speak><send event="x"/></on>',
        '<block><speak>Hello.<on event="end" reactive="true"><speak>Once.</speak></on></speak></block>',
    ],
)
def test_how_often_own_events_come_is_not_known(tmp_path: Path, body: str) -> None:
    (delay,) = certified(tmp_path, f'<form id="f">{body}</form>').delays
    assert not delay.endless and not delay.known and delay.each == 0
    assert [gap.reason[:24] for gap in delay.unknown] == ["how often its own event "]


def test_own_events_count_only_for_the_devices_of_their_reactions(tmp_path: Path) -> None:
    body = (
        '<form id="f"><block><speak>Hello.</speak></block>'
        '<on event="end.speak"><speak>I go on.</speak></on>'
        '<on event="end.gesture" reactive="true"><gesture name="nod"/></on></form>'
    )
    (delay,) = certified(tmp_path, body).delays
    assert delay.known, "what is not a reaction gives way, and a nod needs no speaker"


def test_own_events_are_nobody_elses(tmp_path: Path) -> None:
    own = '<form id="s"><on event="end.gesture" reactive="true"><speak>Yes?</speak></on></form>'
    body = '<form id="f"><on event="end.gesture" reactive="true"><gesture name="nod"/></on></form>'
    assert [one.after for one in certified(tmp_path, body, own).delays] == []


def test_what_own_delayed_events_say_later_is_not_known(tmp_path: Path) -> None:
    own = (
        '<form id="s"><on event="touch"><gesture name="nod"/><send event="x" delay="9s"/></on>'
        '<on event="x"><speak>Yes?</speak></on></form>'
    )
    (delay,) = certified(tmp_path, ASKS, own).delays
    assert delay.known and delay.response is not None
    assert [gap.reason for gap in delay.response.unknown] == [
        "its own event x makes it go on later"
    ]


def test_an_event_asks_the_question_of_a_voicexml_document_anew(tmp_path: Path) -> None:
    field = '<field name="a" type="boolean"><prompt timeout="9s">Well?</prompt></field>'
    catch = "<catch event='touch'>That was me, and I am a robot.</catch>"
    own = FA.replace("touch", "bell")
    found, fa, ea = voiced(tmp_path, f"<form>{field}</form>{catch}", own)
    (delay,) = found.delays
    assert delay.each is not None and delay.each > 9000
    touches = "".join(f'<when at="{at}s"><touch sensor="head"/></when>' for at in (8, 16, 24))
    bell = '<when at="2s"><event name="bell"/></when>'
    records = run(tmp_path, fa, ea, bell + touches)
    assert faults(found, records, PROFILE.voices) == []
    without_more_for_each_event(found)
    assert faults(found, records, PROFILE.voices) != []


KEPT = {
    "what the watch sees is the robot's own turn": (
        '<watch name="moves" when="sensor.moving"/><form id="f"><block><turn angle="90"/></block>'
        '<on event="moves"><speak>I turn.</speak><turn angle="90"/></on></form>',
        "what is done about moves leads to it again",
    ),
    "the robot turns away and finds the user again": (
        '<form id="f"><block><turn angle="180"/></block>'
        '<on event="human"><speak>There.</speak><turn angle="180"/></on></form>',
        "what is done about human may bring it again",
    ),
    "two questions to a service that is not there are under way": (
        '<form id="f"><block><send to="nobody"/><send to="nobody"/></block>'
        '<on event="error.service"><speak>I ask it again.</speak><send to="nobody"/></on></form>',
        "what is done about error.service may bring it again",
    ),
    "a service that an expression names is not there": (
        """<form id="f"><block><send to="nobody"/><send to="nobody"/></block><on event="error.service">
        <speak>I ask it again.</speak><send to-expr="'no' + 'body'"/></on></form>""",
        "what is done about error.service may bring it again",
    ),
    "one service is asked because of the other's answer": (
        '<form id="f"><block><send to="a"/><send to="b"/></block>'
        '<on event="error.service.a"><speak>Now the other.</speak><goto next="#b"/></on></form>'
        '<form id="b"><block><send to="b"/><send to="b"/></block>'
        '<on event="error.service.b"><speak>And the first.</speak><goto next="#f"/></on></form>',
        "what is done about error.service.a may bring it again",
    ),
}
"""EAs that keep the floor by reactions to what they bring themselves, from outside as well."""


@pytest.mark.parametrize(("body", "why"), KEPT.values(), ids=KEPT)
def test_reactions_to_what_the_ea_itself_brings_may_starve_all_else(
    tmp_path: Path, body: str, why: str
) -> None:
    own = (
        '<form id="s"><block><send event="now" delay="5s"/></block>'
        '<on event="now"><speak>It is time.</speak></on></form>'
    )
    found = certified(tmp_path, body, own)
    (starved,) = found.starves
    assert (starved.what, starved.everything) == (why, True)
    assert "nothing: others than reactions" not in format_certificate(found)
    records = run(tmp_path, "mine.xml", "theirs.xml", "", until="120s")
    assert faults(found, records, PROFILE.voices) == []


def test_the_runs_of_the_first_three_starve(tmp_path: Path) -> None:
    own = (
        '<form id="s"><block><send event="now" delay="5s"/></block>'
        '<on event="now"><speak>It is time.</speak></on></form>'
    )
    for body, _ in [*KEPT.values()][:3]:
        certified(tmp_path, body, own)
        records = run(tmp_path, "mine.xml", "theirs.xml", "", until="120s")
        assert "It is time." not in [r.get("text") for r in records if r["phase"] == "start"]
        (told,) = [one for one in records if one["phase"] == "starve"]
        assert (told["app"], told["rule"]) == ("mine", "F2")


def test_what_the_user_brings_keeps_nothing_for_ever(tmp_path: Path) -> None:
    """An answer of the user, or the end of a move, lies between one answer of a service and the next."""
    body = (
        '<form id="ask"><field name="q" type="boolean"><prompt>Shall I?</prompt><noinput><exit/></noinput>'
        '<nomatch><exit/></nomatch><filled><goto next="#send"/></filled></field></form>'
        '<form id="send"><block><send to="x"/></block>'
        '<on event="error.service"><speak>No.</speak><goto next="#ask"/></on>'
        '<on event="touch"><speak>Yes?</speak></on></form>'
    )
    assert not [one for one in certified(tmp_path, body).starves if "bring" in one.what]


def test_only_what_waits_for_the_speaker_alone_has_a_turn(tmp_path: Path) -> None:
    body = block_again('<par><speak>On and on.</speak><move-head pan="3"/></par>')
    own = '<form id="s"><block><speak>Yes?</speak><move-head pan="9"/></block></form>'
    told = format_certificate(certified(tmp_path, body, own))
    assert "equal ones on neck, speaker (S2c), what waits for the speaker alone for a run's" in told


def block_again(content: str) -> str:
    return f'<form id="f"><block>{content}<goto next="#f"/></block></form>'


BRANCHES = "<speak>One one one one.</speak><speak>Two two two two.</speak>"


@pytest.mark.parametrize(
    ("content", "most"),
    [
        (f"<par>{BRANCHES}</par>", 2),
        (f'<par>{BRANCHES}<gesture name="wave"/></par>', 2),
        (f"<if cond='true'><par>{BRANCHES}</par><else/>{BRANCHES}</if>", 2),
        (f'<par>{BRANCHES[: len(BRANCHES) // 2]}<gesture name="wave"/></par>', 1),
        (BRANCHES, 1),
    ],
)
def test_all_branches_of_a_reaction_go_first(tmp_path: Path, content: str, most: int) -> None:
    """Each is a reaction until it starts, so those that need one device go one after another."""
    body = f'<form id="f"><on event="message">{content}</on></form>'
    found = certified(tmp_path, body)
    (delay,) = found.delays
    assert (delay.lasts, delay.each) == (lasting("One one one one."), most * delay.lasts)
    message = '<message from="A">Hello.</message>'
    doings = {900: message, 920: '<touch sensor="head"/>', 940: message}
    whens = "".join(f'<when at="{at}ms">{doing}</when>' for at, doing in doings.items())
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), whens)
    assert faults(found, records, PROFILE.voices) == []
    assert waited(records) > delay.lasts * (1 + most) / 1000 - 0.1


def test_all_branches_of_a_reaction_in_voicexml_go_first(tmp_path: Path) -> None:
    par = BRANCHES.replace("<", "<p:").replace("<p:/", "</p:")
    catch = '<catch event="message">{}</catch><form><field name="q" type="boolean"/></form>'
    later = f'<form id="g"><block><p:par>{par}</p:par></block></form>'
    for content, more in ((f"<p:par>{par}</p:par>", ""), ('<goto next="#g"/>', later)):
        found, _, _ = voiced(tmp_path, catch.format(content) + more)
        (delay,) = found.delays
        assert delay.each is not None and delay.each >= 2 * lasting("One one one one.")
