"""What parts of applications cost others, and certificates for pairs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prima import api
from prima.certificate import (
    Certificate,
    certificate_data,
    certificates,
    certify,
    format_certificate,
)
from prima.checks.prices import Price, commands, outline, prices
from prima.devices.profile import read_robot
from prima.devices.voice import duration
from prima.loading import load_scenario, read_application
from prima.loading.files import read_file
from prima.messages import Record
from prima.voicexml.vocabulary import PRIMA_NAMESPACE
from tests import ROOT
from tests.helpers.certified import faults
from tests.helpers.generated_pairs import pair

ROBOT = ROOT / "documents" / "robots" / "papero.xml"
PROFILE = read_robot(str(ROBOT), read_file(ROBOT))
SITUATIONS = sorted(ROOT.glob("documents/scenarios/**/*.xml"))
FAS = sorted(ROOT.glob("documents/fa/*.xml"))
EAS = sorted(ROOT.glob("documents/ea/*ml"))
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="en">'
FA = (
    '<form id="sleep"><on event="touch"><goto next="#yes"/></on></form>'
    '<form id="yes"><block><speak>Yes?</speak><goto next="#sleep"/></block></form>'
)


def write(folder: Path, name: str, body: str, kind: str = "ea") -> str:
    path = folder / f"{name}.xml"
    path.write_text(HEAD.format(kind, name) + body + "</prima>")
    return str(path)


def priced(folder: Path, body: str) -> list[Price]:
    path = write(folder, "app", body)
    document, problems = read_application(path, read_file(path))
    assert [one for one in problems if one.severity == "error"] == []
    return prices(document, PROFILE)


def block(content: str) -> str:
    return f'<form id="f"><block>{content}<exit/></block></form>'


def lasting(text: str) -> int:
    return duration(text, "en", PROFILE.voices)


def test_speech_costs_what_it_lasts(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<speak>Good morning to you.</speak>"))
    assert (price.lasts, price.known) == (lasting("Good morning to you."), True)
    assert price.devices == {"speaker"}


def test_pauses_cost_what_they_last_and_only_those_in_speech_the_speaker(tmp_path: Path) -> None:
    (said,) = priced(tmp_path, block('<speak>Good <break time="2s"/>morning.</speak>'))
    assert (said.lasts, said.known) == (lasting("Good morning.") + 2000, True)
    (unit,) = priced(tmp_path, block('<iu><speak>Good.</speak><pause time="3s"/></iu>'))
    assert (unit.lasts, unit.known) == (lasting("Good.") + 3000, True)
    assert unit.devices == {"speaker"}


def test_what_an_expression_says_is_not_known(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block('<speak>Good <value expr="1"/></speak>'))
    assert not price.known and price.seconds.startswith("at least ")


def test_a_unit_costs_the_sum_of_its_parts_and_branches_their_longest(tmp_path: Path) -> None:
    parts = '<speak>One and two.</speak><gesture name="bow"/>'
    (price,) = priced(tmp_path, block(f"<iu>{parts}</iu>"))
    assert price.what == "unit" and price.lasts == lasting("One and two.") + 1500
    (price,) = priced(tmp_path, block(f"<iu><par>{parts}</par></iu>"))
    assert price.lasts == max(lasting("One and two."), 1500)


def test_a_unit_costs_its_longest_duration_and_what_runs_then(tmp_path: Path) -> None:
    words = "a long word " * 20
    said = f"<speak>{words}</speak>"
    (price,) = priced(tmp_path, block(f'<iu longest="2s">{said * 2}</iu>'))
    assert price.lasts == 2000 + lasting(words)
    (price,) = priced(tmp_path, block(f'<iu longest="2s">{said}</iu>'))
    assert price.lasts == lasting(words)


def test_a_question_costs_its_prompt_and_its_timeout(tmp_path: Path) -> None:
    field = '<form id="f"><field name="a" type="boolean"><prompt timeout="4s">Well?</prompt></field></form>'
    (price,) = priced(tmp_path, field)
    assert price.what == "question" and price.lasts == lasting("Well?") + 4000
    assert price.listens and price.engages
    (price,) = priced(tmp_path, field.replace(' timeout="4s"', ""))
    assert price.lasts == lasting("Well?") + 5000


def test_a_question_in_a_unit_costs_the_units_longest(tmp_path: Path) -> None:
    body = (
        '<form id="f"><iu longest="20s"><field name="a" type="boolean"><prompt>Well?</prompt>'
        "</field></iu></form>"
    )
    (price,) = priced(tmp_path, body)
    assert (price.what, price.lasts) == ("unit", 20_000 + lasting("Well?") + 5000)


def test_a_loop_costs_one_loop(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<tracking-human/>"))
    assert price.loops and price.lasts == PROFILE.loop


def test_reactions_are_what_follows_events_from_outside(tmp_path: Path) -> None:
    body = FA.replace("</on>", '</on><on event="end.speak"><speak>Late.</speak></on>')
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + body + "</prima>").encode())
    (reaction,) = outline(document, PROFILE).reactions
    assert reaction.events == ("touch",)
    assert [price.devices for price in reaction.firsts] == [{"speaker"}]


def certified(folder: Path, body: str, own: str = FA) -> Certificate:
    fa, ea = write(folder, "mine", own, "fa"), write(folder, "theirs", body)
    (found,) = certificates([fa], [ea])
    return found


def test_the_longest_wait_is_for_the_longest_part_on_the_same_devices(tmp_path: Path) -> None:
    body = block('<speak>Short.</speak><gesture name="bow"/><iu><speak>A longer one.</speak></iu>')
    (delay,) = certified(tmp_path, body).delays
    assert (delay.event, delay.what, delay.lasts) == ("touch", "unit", lasting("A longer one."))
    assert delay.devices == ("speaker",)


def test_what_leaves_loops_and_holds_is_told(tmp_path: Path) -> None:
    body = (
        '<form id="f" stream="hold" hold-for="9s"><block><topological-move to="door"/>'
        '<tracking-human/></block><on event="touch"><exit/></on></form>'
    )
    own = FA.replace("<speak>Yes?</speak>", "<turn angle='20'/>")
    found = certified(tmp_path, body, own)
    assert [price.what for price in found.leaves] == ["topological-move"]
    (starved,) = found.starves
    assert (starved.rule, starved.devices) == ("E4", ("locomotion",))
    assert [lasts for _, lasts in found.holds] == [9000]
    text = format_certificate(found)
    assert "a hold, for 9 s, with x3" in text and "It waits while mine is in a conversation" in text
    assert "tracking-human goes on until its goal is reached\n    waiting: equal ones on" in text


def test_robots_that_lack_something_are_told(tmp_path: Path) -> None:
    found = certified(tmp_path, block('<point-by-hand angle="30"/>'))
    assert found.lacks == {"papero": [], "papero-plus": [], "pointer": ["point-by-hand"]}


def test_the_data_are_json(tmp_path: Path) -> None:
    found = certified(tmp_path, block("<iu><speak>Hi.</speak></iu>"))
    data = json.loads(json.dumps(certificate_data(found)))
    assert data["longest_unit"]["lasts"] == lasting("Hi.")
    assert data["delays"][0]["place"].startswith(str(tmp_path))


@pytest.mark.parametrize("touched", range(0, 6000, 700))
def test_no_reaction_waits_longer_than_is_certified(tmp_path: Path, touched: int) -> None:
    body = block(
        "<speak>One sentence that is not long.</speak><iu><speak>Here is the first part.</speak>"
        "<speak>And here is the second one of it.</speak></iu><speak>Bye.</speak>"
    )
    fa, ea = write(tmp_path, "mine", FA, "fa"), write(tmp_path, "theirs", body)
    (found,) = certificates([fa], [ea])
    text = (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="20s"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROBOT}"><robot at="middle"/>'
        '<person x="1" y="0"/><application src="theirs.xml"/><application src="mine.xml" kind="fa"/>'
        f'<when at="{touched}ms"><touch sensor="head"/></when></scenario>'
    )
    (tmp_path / "s.xml").write_text(text)
    records = api.rehearse(tmp_path / "s.xml").records
    said = next(r["time"] for r in records if r["phase"] == "start" and r.get("text") == "Yes?")
    assert said - touched / 1000 <= found.delays[0].lasts / 1000


def test_the_command_line_prints_a_certificate(tmp_path: Path) -> None:
    fa, ea = (
        write(tmp_path, "mine", FA, "fa"),
        write(tmp_path, "theirs", block("<speak>A.</speak>")),
    )

    def call(*args: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "prima", "validate", *args],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip

    done = call("--with", fa, ea)
    assert done.returncode == 0 and "What theirs can do to mine, on papero" in done.stdout
    assert json.loads(call("--with", fa, ea, "--format", "json").stdout)[0]["ea"] == "theirs"
    assert call("--with", "none.xml", ea).returncode == 2
    assert call("--robot", str(ROBOT), ea).returncode == 2
    write(tmp_path, "theirs", "<form/>")
    assert call("--with", fa, ea).returncode == 1


# What runs may do --------------------------------------------------------------------------


def run(folder: Path, fa: str, ea: str, whens: str, until: str = "60s") -> list[Record]:
    """The records of a scenario with two applications."""
    text = (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="{until}"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROBOT}"><robot at="middle"/>'
        f'<person x="1" y="0"/><application src="{Path(fa).name}" kind="fa"/>'
        f'<application src="{Path(ea).name}" id="theirs"/>{whens}</scenario>'
    )
    (folder / "s.xml").write_text(text)
    return api.rehearse(folder / "s.xml").records


TOUCH = '<when at="1s"><touch sensor="head"/></when>'
VXML = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
    ' xml:lang="en">'
)


def voiced(folder: Path, body: str, own: str = FA, **more: str) -> tuple[Certificate, str, str]:
    """The certificate of a VoiceXML EA, with further documents; and the paths of both."""
    fa, ea = write(folder, "mine", own, "fa"), folder / "theirs.vxml"
    ea.write_text(f"{VXML}{body}</vxml>")
    for name, text in more.items():
        (folder / f"{name}.vxml").write_text(f"{VXML}{text}</vxml>")
    (found,) = certificates([fa], [str(ea)])
    return found, fa, str(ea)


def waited(records: list[Record]) -> float:
    """How long (s) the FA's answer to the touch has waited."""
    touched = next(r["time"] for r in records if r.get("event") == "touch.head")
    said = next(r["time"] for r in records if r["phase"] == "start" and r.get("text") == "Yes?")
    return float(said - touched)


COMMANDS = {
    "a block": '<form><block><p:gesture name="bow"/></block></form>',
    "a branch": '<form><block><if cond="true"><p:gesture name="bow"/></if></block></form>',
    "a prompt": '<form><block><prompt>So <p:gesture name="bow"/> it is.</prompt></block></form>',
    "a loop": '<form><block><foreach item="x" array="[1]"><p:gesture name="bow"/></foreach></block></form>',
    "filled": '<form><field name="a" type="boolean"><filled><p:gesture name="bow"/></filled></field></form>',
    "a handler": '<form><block/></form><catch event="bell"><p:gesture name="bow"/></catch>',
    "a question": '<form><field name="a" type="boolean"><prompt>Well <p:gesture name="bow"/></prompt></field></form>',
    "a menu": '<menu><prompt>A <p:gesture name="bow"/></prompt><choice next="#x">x</choice></menu>',
}


@pytest.mark.parametrize("body", COMMANDS.values(), ids=COMMANDS)
def test_commands_of_the_robot_in_voicexml_are_seen_everywhere(tmp_path: Path, body: str) -> None:
    found, _, _ = voiced(tmp_path, body)
    assert {"arm", "neck"} <= {*found.both, *found.only_ea}


SPOKEN = "This is a rather long sentence that takes some seconds to say."
ARRANGED = {
    "par": "<par><speak>{}</speak><point-by-hand angle='40'/></par>",
    "seq": "<par><seq><speak>{0}</speak><speak>{0}</speak></seq><gesture name='nod'/></par>",
    "unit": "<iu longest='40s'><gesture name='nod'/><speak>{0}</speak><speak>{0}</speak></iu>",
    "cut": "<iu longest='1s'><speak>{0}</speak><speak>{0}</speak><speak>{0}</speak></iu>",
    "branches": "<iu><par><speak>{}</speak><seq><pause time='9s'/><gesture name='nod'/></seq></par></iu>",
    "inner": "<iu><par><iu><speak>{}</speak></iu><gesture name='bow'/></par></iu>",
}
"""Commands that are arranged, in PRIMA's language; with prefixes, in VoiceXML."""


def prefixed(content: str) -> str:
    return content.replace("</", "<!").replace("<", "<p:").replace("<p:!", "</p:")


def told(price: Price) -> tuple[object, ...]:
    inner = [told(one) for one in price.inner]
    return price.node.tag, price.what, price.devices, price.lasts, price.unknown, inner


@pytest.mark.parametrize("content", ARRANGED.values(), ids=ARRANGED)
@pytest.mark.parametrize("around", ["{}", "<prompt>{}</prompt>", "<prompt><p>{}</p></prompt>"])
def test_arranged_commands_cost_the_same_in_both_languages(
    tmp_path: Path, content: str, around: str
) -> None:
    content = content.format(SPOKEN)
    own = priced(tmp_path, block(content))
    body = f"<form><block>{around.format(prefixed(content))}<exit/></block></form>"
    found, fa, ea = voiced(tmp_path, body)
    document, _ = read_application(ea, read_file(Path(ea)))
    theirs = [one for one in prices(document, PROFILE) if one.node.namespace == PRIMA_NAMESPACE]
    assert list(map(told, own)) == list(map(told, theirs))
    units = [one.place for one in theirs if one.what == "unit"]
    assert (found.longest_unit is None) == (not units)
    assert found.longest_unit is None or [found.longest_unit.place] == units
    assert found.lacks["papero"] == []
    (delay,) = found.delays
    at = TOUCH.replace("1s", "10ms")
    assert 0 < waited(run(tmp_path, fa, ea, at)) * 1000 <= delay.lasts + 10


def test_a_robot_has_to_have_the_commands_in_a_unit_of_voicexml(tmp_path: Path) -> None:
    unit = '<p:iu><p:command type="hum"/><p:speak>So.</p:speak></p:iu>'
    found, _, _ = voiced(tmp_path, f"<form><block>{unit}</block></form>")
    assert found.lacks["papero"] == ["hum"]


def test_a_unit_of_voicexml_ends_after_a_minute_as_in_primas_language(tmp_path: Path) -> None:
    unit = ARRANGED["unit"].replace(" longest='40s'", "").replace("{0}", SPOKEN * 30)
    body = f"<form><block>{prefixed(unit)}</block></form>"
    found, fa, ea = voiced(tmp_path, body)
    assert found.longest_unit is not None
    assert found.longest_unit.lasts == 60_000 + lasting(SPOKEN * 30)
    records = run(tmp_path, fa, ea, TOUCH, "300s")
    assert any(one.get("event") == "error.unit.timeout" for one in records)


def in_unit(inner: str, longest: str = "20s", around: str = "") -> str:
    return f'<form><p:iu longest="{longest}">{inner}</p:iu>{around}</form>'


ASKED = '<field name="a" type="boolean"><prompt>Well?</prompt>{}</field>'


def voice_parts(folder: Path, body: str) -> list[Price]:
    """What a VoiceXML document is said to cost."""
    _, _, ea = voiced(folder, body)
    document, problems = read_application(ea, read_file(Path(ea)))
    assert [str(one) for one in problems] == []
    return prices(document, PROFILE)


def test_a_unit_around_items_of_voicexml_costs_its_longest(tmp_path: Path) -> None:
    inner = "<block>One.</block>" + ASKED.format("<filled>Fine.</filled><noinput>Hm?</noinput>")
    (unit,) = voice_parts(tmp_path, in_unit(inner))
    assert unit.what == "unit" and unit.devices == {"speaker", "speech-recognition"}
    said = lasting("I did not understand.")  # the longest that may be said before it is asked again
    assert unit.lasts == 20_000 + said + 5000 + 1
    assert unit.engages and unit.listens and unit.known
    assert {one.what for one in unit.inner} == {"speak", "question"}


def test_a_unit_around_blocks_of_voicexml_costs_their_sum(tmp_path: Path) -> None:
    inner = '<block>One.</block><block><p:gesture name="bow"/>Two.</block>'
    (unit,) = voice_parts(tmp_path, in_unit(inner))
    assert unit.lasts == lasting("One.") + 1500 + lasting("Two.")
    outer = '<catch event="x">Three.</catch>'
    (three, more) = voice_parts(
        tmp_path, in_unit(f'{inner}<block><throw event="x"/></block>') + outer
    )
    assert (more.what, more.lasts) == ("unit", 20_000 + 1500), "nobody knows how often it is thrown"
    assert (three.what, three.lasts) == ("speak", lasting("Three."))


def test_a_unit_of_voicexml_may_end_long_after_its_time(tmp_path: Path) -> None:
    words = SPOKEN * 10
    inner = ASKED.format("") + "<block>One.</block>"
    (said, unit) = voice_parts(tmp_path, in_unit(inner) + f"<noinput>{words}<exit/></noinput>")
    assert said.lasts == lasting(words)
    assert unit.lasts == 20_000 + lasting(words) + 5001, "that is said before it is asked again"


@pytest.mark.parametrize(
    ("inner", "most"),
    [
        ("<block>One.</block>" + ASKED.format(""), 30),
        (f"<block>{SPOKEN}<prompt>So.</prompt></block>", 10),
        (f"<block>{SPOKEN * 8}</block>", 40),
        ("<block><foreach item='i' array='[1,2,3,4,5,6,7,8]'>One and two.</foreach></block>", 22),
    ],
)
def test_what_a_unit_of_voicexml_costs_is_true(tmp_path: Path, inner: str, most: int) -> None:
    found, fa, ea = voiced(tmp_path, in_unit(inner, around="<error><exit/></error>"))
    (delay,) = found.delays
    at = TOUCH.replace("1s", "10ms")
    needed = waited(run(tmp_path, fa, ea, at, "99s")) * 1000
    assert 1000 < needed <= delay.lasts + 10 <= most * 1000
    assert found.longest_unit is not None and found.longest_unit.node.tag == "iu"


def test_a_reaction_of_voicexml_begins_with_all_branches_of_a_par(tmp_path: Path) -> None:
    par = '<p:par><p:seq><p:speak>Oh.</p:speak><p:gesture name="nod"/></p:seq><p:turn angle="5"/></p:par>'
    body = f'<form><block/></form><catch event="bell">{par}</catch>'
    _, _, ea = voiced(tmp_path, body)
    document, _ = read_application(ea, read_file(Path(ea)))
    (reaction,) = outline(document, PROFILE).reactions
    assert [one.what for one in reaction.firsts] == ["speak", "turn"]


@pytest.mark.parametrize(
    "leading",
    [
        '<block><goto next="more.vxml"/></block>',
        '<block><submit next="more.vxml#f"/></block>',
        '<subdialog name="s" src="more.vxml"/>',
    ],
)
def test_further_documents_of_voicexml_are_read(tmp_path: Path, leading: str) -> None:
    more = '<form id="f"><block><p:move-head pan="20"/></block></form>'
    found, _, _ = voiced(tmp_path, f"<form>{leading}</form>", more=more)
    assert "neck" in found.only_ea and found.gaps == []
    linked = '<link next="more.vxml"><grammar src="builtin:boolean"/></link><form><block/></form>'
    assert "neck" in voiced(tmp_path, linked, more=more)[0].only_ea


def test_what_cannot_be_read_is_told_with_its_place(tmp_path: Path) -> None:
    body = '<form><block><if cond="x"><goto expr="where"/></if><submit next="http://a.example/"/></block></form>'
    found, _, _ = voiced(tmp_path, body)
    assert [gap.reason for gap in found.gaps] == [
        "an expression says where it goes on",
        "the document that http://a.example/ answers is not known",
    ]
    assert all(str(gap.place).startswith(str(tmp_path)) for gap in found.gaps)
    assert not any(delay.known for delay in found.delays)
    assert "not known: an expression says where it goes on, at" in format_certificate(found)


def test_an_expression_that_stays_in_its_document_is_no_gap(tmp_path: Path) -> None:
    body = """<form id="ab"><block><goto expr="'#a' + 'b'"/></block></form>"""
    assert voiced(tmp_path, body.replace("'#a' + 'b'", "'#a' + x"))[0].gaps == []


def test_a_long_prompt_and_its_question_are_one_wait(tmp_path: Path) -> None:
    words = "This goes on and on. " * 40
    prompt = f'<prompt bargein="false" timeout="9s">{words}<break time="3s"/></prompt>'
    found, fa, ea = voiced(
        tmp_path, f'<form><field name="a" type="boolean">{prompt}</field></form>'
    )
    (delay,) = found.delays
    assert delay.known and delay.what == "question"
    took = waited(run(tmp_path, fa, ea, TOUCH, "120s"))
    assert took > 59 and took * 1000 <= delay.lasts < took * 1000 + 1100


def test_a_recording_counts_its_beep_and_its_silence(tmp_path: Path) -> None:
    body = '<form><record name="r" beep="true" maxtime="6s" finalsilence="2s">Go.</record></form>'
    found, fa, ea = voiced(tmp_path, body)
    (delay,) = found.delays
    assert delay.what == "recording" and delay.listens
    assert delay.lasts >= lasting("Go.") + 5000 + 2000 + 500
    assert waited(run(tmp_path, fa, ea, TOUCH)) * 1000 <= delay.lasts


def test_a_call_is_waited_for_as_long_as_it_may_last(tmp_path: Path) -> None:
    body = (
        '<form><transfer name="t" dest="tel:+1-555" type="bridge" connecttimeout="20s"'
        ' maxtime="40s"><grammar src="builtin:boolean"/></transfer></form>'
    )
    found, fa, ea = voiced(tmp_path, body)
    (delay,) = found.delays
    assert (delay.what, delay.lasts) == ("call", 40_000)
    assert waited(run(tmp_path, fa, ea, TOUCH)) * 1000 <= delay.lasts


def test_a_reaction_to_the_same_event_is_waited_for_to_its_end(tmp_path: Path) -> None:
    body = '<form id="f"><on event="touch.head"><speak>Oh!</speak><speak>That was me.</speak></on></form>'
    (delay,) = certified(tmp_path, body).delays
    assert len(delay.after) == 1 and delay.known
    assert delay.lasts == lasting("That was me.") + lasting("Oh!") + lasting("That was me.")
    assert "about the same event at" in format_certificate(certified(tmp_path, body))
    more = "s more for each other event that theirs reacts to meanwhile, or has not done with"
    assert more in format_certificate(certified(tmp_path, body))


def test_a_reaction_to_the_same_event_may_have_no_end(tmp_path: Path) -> None:
    field = '<form id="q"><field name="a" type="boolean"><prompt>Well?</prompt></field></form>'
    body = f'<form id="f"><on event="touch"><goto next="#q"/></on></form>{field}'
    found = certified(tmp_path, body)
    (delay,) = found.delays
    assert not delay.known
    assert [gap.reason for gap in delay.endless] == [
        "the question is asked again until the user answers"
    ]
    assert "touch: without a bound" in format_certificate(found)
    assert certificate_data(found)["delays"][0]["lasts"] is None


def test_a_question_that_gives_up_has_an_end(tmp_path: Path) -> None:
    leave = '<noinput count="2"><goto next="#f"/></noinput><nomatch><goto next="#f"/></nomatch>'
    field = (
        f'<form id="q"><field name="a" type="boolean"><prompt>Well?</prompt>{leave}</field></form>'
    )
    body = f'<form id="f"><on event="touch"><goto next="#q"/></on></form>{field}'
    (delay,) = certified(tmp_path, body).delays
    assert delay.known
    assert delay.lasts == 3 * (lasting("Well?") + 5000)


def test_what_a_subdialog_comes_back_to_is_waited_for(tmp_path: Path) -> None:
    body = (
        '<form id="f"><subdialog name="s" src="#g"/><block><speak>And then this.</speak></block></form>'
        '<form id="g"><on event="touch"><speak>Oh!</speak><return/></on></form>'
    )
    (delay,) = certified(tmp_path, body).delays
    parts = [lasting("Oh!"), lasting("And then this.")]
    assert delay.known and delay.lasts >= max(parts) + sum(parts)


def test_links_with_no_word_in_common_hear_different_things(tmp_path: Path) -> None:
    link = '<form id="{}"><link event="x"><grammar>{}</grammar></link><on event="x"><speak>A.</speak></on></form>'
    (delay,) = certified(tmp_path, link.format("f", "stop it"), link.format("f", "go on")).delays
    assert delay.after == []
    (delay,) = certified(tmp_path, link.format("f", "stop it"), link.format("f", "stop")).delays
    assert len(delay.after) == 1


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
    assert delay.known, "what is no reaction gives way, and a nod needs no speaker"


def test_own_events_are_nobody_elses(tmp_path: Path) -> None:
    own = '<form id="s"><on event="end.gesture" reactive="true"><speak>Yes?</speak></on></form>'
    body = '<form id="f"><on event="end.gesture" reactive="true"><gesture name="nod"/></on></form>'
    assert [one.after for one in certified(tmp_path, body, own).delays] == []


LATE = FA.replace("<speak>", '<move-head tilt="10"/><speak>')
"""An FA whose first Command is no response."""
ASKS = (
    '<form id="s"><field name="q" type="boolean"><prompt timeout="55s">Tell me?</prompt>'
    "<noinput><exit/></noinput><filled><exit/></filled></field></form>"
)


def test_the_first_word_may_come_long_after_the_first_command(tmp_path: Path) -> None:
    found = certified(tmp_path, ASKS, LATE)
    (delay,) = found.delays
    assert (delay.lasts, delay.known, delay.place) == (0, True, None)
    assert delay.response is not None and delay.response.known
    assert delay.response.lasts == lasting("Tell me?") + 55_000
    text = format_certificate(found)
    assert "touch: not at all\n    first word or movement towards the user: up to 55." in text
    assert "never" not in text
    data = certificate_data(found)["delays"][0]
    assert (data["lasts"], data["response"]["lasts"]) == (0, delay.response.lasts)
    records = run(
        tmp_path, "mine.xml", "theirs.xml", '<when at="200ms"><touch sensor="head"/></when>'
    )
    assert 55 < waited(records) <= delay.response.lasts / 1000
    assert faults(found, records, PROFILE.voices) == []
    delay.response = replace(delay, response=None)
    assert "the response to touch.head" in faults(found, records, PROFILE.voices)[0]


def test_where_response_and_first_command_are_one_they_are_told_once(tmp_path: Path) -> None:
    found = certified(tmp_path, ASKS)
    (delay,) = found.delays
    assert delay.response == replace(delay, response=None)
    assert "first word" not in format_certificate(found)
    data = certificate_data(found)["delays"][0]
    assert data["response"]["lasts"] == data["lasts"]
    nods = FA.replace("<speak>Yes?</speak>", '<gesture name="nod"/>')
    (delay,) = certified(tmp_path, block('<gesture name="bow"/>'), nods).delays
    assert delay.response is None


@pytest.mark.parametrize(
    ("content", "most"),
    [
        ("<par><gesture name='bow'/><speak>Yes?</speak></par>", 1),
        ('<iu><gesture name="bow"/><speak>Yes?</speak></iu>', 1),
        ('<move-head pan="3"/><if cond="a"><gesture name="nod"/></if><speak>Yes?</speak>', 2),
        ('<move-head pan="3"/><goto next="#g"/>', 2),
        ('<move-head pan="3"><on event="end"><speak>Yes?</speak></on></move-head>', 1),
        ('<move-head pan="3"/><face-human/><speak>Yes?</speak>', 2),
    ],
)
def test_a_response_is_found_on_all_ways(tmp_path: Path, content: str, most: int) -> None:
    own = (
        f'<var name="a" expr="true"/><form id="s"><on event="touch">{content}</on></form>'
        '<form id="g"><block><gesture name="nod"/><speak>Yes?</speak></block></form>'
    )
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + own + "</prima>").encode())
    (reaction,) = outline(document, PROFILE).reactions
    assert reaction.responds
    others = [one for one in reaction.responds if "speaker" not in one.devices]
    assert len(others) <= most


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


def test_what_drives_waits_for_whole_conversations(tmp_path: Path) -> None:
    own = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')
    field = '<form id="q"><field name="a" type="boolean"><prompt>Well?</prompt></field></form>'
    (delay,) = certified(tmp_path, field, own).delays
    assert not delay.known and delay.endless and delay.devices == ()


@pytest.mark.parametrize("text, known", [("list[at].said", True), ("list[at].said + 1", False)])
def test_texts_of_constants_are_known(tmp_path: Path, text: str, known: bool) -> None:
    script = "<script>const list = [{ said: 'Hello there, you.' }, { said: 'Hi.' }];</script>"
    body = '<var name="at" expr="0"/>' + script + block(f'<speak><value expr="{text}"/></speak>')
    (price,) = priced(tmp_path, body)
    assert price.known is known
    if known:
        assert price.lasts == lasting("Hello there, you.")


@pytest.mark.parametrize("change", ["list.push('a longer one')", "list[0] = 'a longer one'"])
def test_texts_of_constants_that_change_are_not_known(tmp_path: Path, change: str) -> None:
    script = f"<script>const list = ['Hi.']; {change};</script>"
    (price,) = priced(tmp_path, script + block('<speak><value expr="list[0]"/></speak>'))
    assert not price.known


LOOP = '<form id="f"><block><speak>On and on.</speak><goto next="#f"/></block></form>'
LATER = '<form id="g"><block><gesture name="bow"/><speak>My turn.</speak></block></form>'


def test_states_that_follow_one_another_keep_the_speaker_for_ever(tmp_path: Path) -> None:
    found = certified(tmp_path, LOOP, LATER)
    (starved,) = found.starves
    assert (starved.rule, starved.devices) == ("S2c", ("speaker",))
    records = run(tmp_path, "mine.xml", "theirs.xml", "")
    assert "My turn." not in [r.get("text") for r in records if r["phase"] == "start"]
    assert faults(found, records, PROFILE.voices) == []
    found.starves.clear()
    assert faults(found, records, PROFILE.voices) != []


def test_where_nothing_starves_the_longest_wait_is_told(tmp_path: Path) -> None:
    found = certified(tmp_path, block("<speak>Once.</speak>"), LATER)
    assert found.starves == []
    text = format_certificate(found)
    assert "nothing: others than reactions wait up to 0.6 s each time theirs is busy" in text


# Properties ---------------------------------------------------------------------------------


@given(st.integers(0, 10**6))
@settings(
    max_examples=int(os.environ.get("PRIMA_EXAMPLES", "300")) * 17 // 100,
    derandomize=os.environ.get("CI") == "true",
    deadline=None,
    database=None,
)
def test_no_run_exceeds_what_its_certificate_says(seed: int) -> None:
    with TemporaryDirectory() as folder:
        fa, ea, scenario = pair(seed).write(Path(folder))
        (found,) = certificates([str(fa)], [str(ea)])
        records = api.rehearse(scenario).records
        assert faults(found, records, PROFILE.voices) == []


@pytest.mark.parametrize("seed", (2, 12, 23))
def test_certificates_that_are_too_good_are_found_out(seed: int) -> None:
    """The property can fail: with all waits taken away, runs exceed them."""
    broken = 0
    with TemporaryDirectory() as folder:
        for one in range(seed * 10, seed * 10 + 10):
            fa, ea, scenario = pair(one).write(Path(folder))
            (found,) = certificates([str(fa)], [str(ea)])
            found.delays.clear()
            broken += bool(faults(found, api.rehearse(scenario).records, PROFILE.voices))
    assert broken


def broken_by(change: Callable[[Certificate], None]) -> int:
    """How many of some pairs exceed their certificates once those are changed."""
    broken = 0
    for seed in range(0, 60, 4):
        with TemporaryDirectory() as folder:
            fa, ea, scenario = pair(seed).write(Path(folder))
            (found,) = certificates([str(fa)], [str(ea)])
            change(found)
            broken += bool(faults(found, api.rehearse(scenario).records, PROFILE.voices))
    return broken


def as_it_is(_found: Certificate) -> None:
    """Change nothing."""


def without_more_for_each_event(found: Certificate) -> None:
    for delay in found.delays:
        delay.each = 0


def without_the_time_of_responses(found: Certificate) -> None:
    for delay in found.delays:
        delay.response = replace(delay, response=None)


def test_the_slowest_runs_need_all_that_their_certificates_allow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """None of these can go: what further events add to a wait, the time of responses, and the
    time in which turns slow down."""
    assert not broken_by(as_it_is)
    assert broken_by(without_more_for_each_event)
    assert broken_by(without_the_time_of_responses)
    monkeypatch.setattr(commands, "SETTLING_MS", 0)
    assert broken_by(as_it_is)


@pytest.mark.parametrize("path", SITUATIONS, ids=lambda path: path.stem)
def test_the_situations_keep_to_the_certificates(path: Path) -> None:
    cast = load_scenario(path).cast
    records = api.rehearse(path).records
    for fa in cast.documents:
        for ea in cast.documents:
            if fa is not ea:
                found = certify(fa, ea, cast.robot, [])
                assert faults(found, records, cast.robot.voices) == []


@pytest.mark.parametrize("ea", EAS, ids=lambda path: path.stem)
@pytest.mark.parametrize("fa", FAS, ids=lambda path: path.stem)
def test_the_demos_have_useful_certificates(fa: Path, ea: Path) -> None:
    """Reactions wait for a bounded time, but for texts that only a run tells."""
    (found,) = certificates([str(fa)], [str(ea)])
    assert found.gaps == []
    for delay in found.delays:
        assert not delay.endless and not delay.after
        assert 0 < delay.lasts < 12_000
        assert {gap.reason for gap in delay.unknown} <= {
            "an expression gives its text",
            "an expression gives a part of what it says",
        }


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ('<block><speak>Buy.</speak><goto next="#f"/></block>', "f follows itself"),
        (
            '<block><speak>Buy.</speak></block><on event="end.speak"><speak>More.</speak></on>',
            "what is done about end.speak leads to it again",
        ),
        (
            '<subdialog name="s" src="#sub"><filled><clear/></filled></subdialog></form>'
            '<form id="sub"><block><speak>Buy.</speak><return/></block>',
            "items of the form are visited again",
        ),
        (
            '<subdialog name="s" src="#sub"/><block><goto next="#f"/></block></form>'
            '<form id="sub"><block><speak>Buy.</speak><return/></block>',
            "f follows itself",
        ),
    ],
)
def test_whoever_talks_without_an_end_is_certified_to(tmp_path: Path, body: str, why: str) -> None:
    """As the run shows: an FA's sentence that is no reaction waits as long as that goes on."""
    own = (
        '<form id="s"><block><send event="now" delay="1s"/></block>'
        '<on event="now"><speak>It is three.</speak><exit/></on></form>'
    )
    found = certified(tmp_path, f'<form id="f">{body}</form>', own)
    (starved,) = found.starves
    assert why in starved.what and (starved.rule, starved.devices) == ("S2c", ("speaker",))
    assert "(S2c), each for a run's patience, 60 s by default (E6)" in format_certificate(found)
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), "", "100s")
    told = [(one["app"], one["rule"]) for one in records if one["phase"] == "starve"]
    assert told == [("mine", "E6")]
