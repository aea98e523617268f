"""Prices of parts of VoiceXML documents, and runs that keep to them."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.checks.prices import Price, outline
from prima.loading import read_application
from prima.loading.files import read_file
from prima.voicexml.pages import MOST_PAGES
from prima.voicexml.vocabulary import PRIMA_NAMESPACE
from tests.helpers.certified import faults
from tests.helpers.certifying import (
    FA,
    PROFILE,
    TOUCH,
    block,
    lasting,
    priced,
    run,
    told,
    voiced,
    waited,
)
from tests.helpers.spoken import recording

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
    theirs = [
        one for one in outline(document, PROFILE).parts if one.node.namespace == PRIMA_NAMESPACE
    ]
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
    unit = ARRANGED["cut"].replace(" longest='1s'", "").replace("{0}", SPOKEN * 10)
    body = f"<form><block>{prefixed(unit)}</block></form>"
    found, fa, ea = voiced(tmp_path, body)
    assert found.longest_unit is not None
    assert found.longest_unit.lasts == 60_000 + lasting(SPOKEN * 10)
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
    return outline(document, PROFILE).parts


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
    (more, three) = voice_parts(
        tmp_path, in_unit(f'{inner}<block><throw event="x"/></block>') + outer
    )
    assert (more.what, more.lasts) == ("unit", 20_000 + 1500), "nobody knows how often it is thrown"
    assert (three.what, three.lasts) == ("speak", lasting("Three."))


def test_a_unit_of_voicexml_may_end_long_after_its_time(tmp_path: Path) -> None:
    words = SPOKEN * 10
    inner = ASKED.format("") + "<block>One.</block>"
    (unit, said) = voice_parts(tmp_path, in_unit(inner) + f"<noinput>{words}<exit/></noinput>")
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


DRIVES = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')


def test_a_question_of_voicexml_is_asked_as_often_as_its_handlers_let_it(tmp_path: Path) -> None:
    handlers = '<noinput count="4"><exit/></noinput><nomatch count="2"><exit/></nomatch><noinput><reprompt/></noinput>'
    body = f"<form>{ASKED.format(handlers)}</form>"
    found, fa, ea = voiced(tmp_path, body, DRIVES)
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "10ms"))
    asked = [one for one in records if one["phase"] == "start" and one.get("text") == "Well?"]
    assert len(asked) == 4 and faults(found, records, PROFILE.voices) == []


def test_each_text_of_a_block_of_voicexml_is_a_part(tmp_path: Path) -> None:
    log = "<log>So.</log>"
    body = f"<form><block>{SPOKEN}{log}So.<exit/></block></form>"
    assert [one.lasts for one in voice_parts(tmp_path, body)] == [lasting(SPOKEN), lasting("So.")]
    found, fa, ea = voiced(tmp_path, body)
    records = run(tmp_path, fa, ea, TOUCH.replace("1s", "10ms"))
    assert faults(found, records, PROFILE.voices) == []


def test_a_reaction_of_voicexml_that_may_bring_its_own_event_is_told(tmp_path: Path) -> None:
    body = '<form><block/></form><catch event="human.lost"><p:turn angle="180"/></catch>'
    (starved,) = voiced(tmp_path, body)[0].starves
    assert starved.what == "what is done about human.lost may bring it again"


@pytest.mark.parametrize(("value", "again"), [("true", False), ("undefined", True)])
def test_an_item_of_voicexml_that_is_unset_is_visited_again(
    tmp_path: Path, value: str, again: bool
) -> None:
    assign = f'<block>Hm.<assign name="b" expr="{value}"/></block>'
    found, _, _ = voiced(tmp_path, f'<form><block name="b">So.</block>{assign}</form>')
    reasons = [one.what for one in found.starves]
    assert ("an item of the dialog may be visited again" in reasons) == again


def test_what_is_played_during_fetches_of_voicexml_is_priced_with_each(tmp_path: Path) -> None:
    plays = '<property name="fetchaudio" value="tune.wav"/>'
    menu = '<menu id="m"><choice next="more.vxml">x</choice></menu>'
    subdialog = '<subdialog name="s" src="more.vxml"/><subdialog name="t" src="#m"/>'
    goto = '<block><goto next="more.vxml" fetchaudio="a.wav"/></block>'
    _, _, ea = voiced(tmp_path, f"{plays}<form>{subdialog}{goto}</form>{menu}", more="<form/>")
    document, _ = read_application(ea, read_file(Path(ea)))
    found = [(one.node.tag, one.lasts) for one in outline(document, PROFILE).parts]
    tune = lasting("[tune.wav]")
    fetched = [("subdialog", tune), ("goto", lasting("[a.wav]")), ("menu", 6515), ("choice", tune)]
    assert found == fetched


PROMPTS = {
    "another language": '<prompt>Good day. <s xml:lang="ja">おはよう</s> Bye then.</prompt>',
    "a mark": '<prompt>Good<mark name="m"/>morning.</prompt>',
    "a recording": '<prompt>Listen. <audio src="a.wav"/> Nice.</prompt>',
    "its own base": '<prompt xml:base="sub/"><audio src="b.wav"/></prompt>',
    "a recording with a text": '<audio src="a.wav">This is not said.</audio>',
    "none": '<audio src="none.wav"/>',
    "none, with a text": '<audio src="none.wav">This is said instead.</audio>',
    "none of a folder": '<audio src="http://a.example/a.wav"/>',
}


@pytest.mark.parametrize("prompt", PROMPTS.values(), ids=PROMPTS)
def test_a_prompt_of_voicexml_costs_what_it_lasts(tmp_path: Path, prompt: str) -> None:
    (tmp_path / "sub").mkdir()
    recording(tmp_path / "a.wav", 4)
    recording(tmp_path / "sub/b.wav", 7)
    _, fa, ea = voiced(tmp_path, f"<form><block>{prompt}</block></form>")
    document, _ = read_application(ea, read_file(Path(ea)))
    (part,) = outline(document, PROFILE).parts
    ended = [one["time"] for one in run(tmp_path, fa, ea, "") if one["phase"] == "end"]
    assert (part.lasts, part.known) == (round(ended[-1] * 1000), True)


CHOICES = '<choice next="#m">tea</choice><choice next="#m">black coffee</choice>'


@pytest.mark.parametrize(
    "prompt, said, why",
    [
        ("Say <enumerate/>", "Say tea; black coffee", ""),
        (
            "Say <enumerate>this: </enumerate>",
            "Say this:",
            "a part of it is said for each choice",
        ),
        (
            '<foreach item="i" array="[1, 2]">Again. </foreach>',
            "Again.",
            "an expression says how often a part of it is said",
        ),
        ("<audio expr=\"'a.wav'\"/>", "x" * 20, "an expression says what is played"),
    ],
)
def test_a_prompt_that_is_said_piece_by_piece(
    tmp_path: Path, prompt: str, said: str, why: str
) -> None:
    _, _, ea = voiced(tmp_path, f'<menu id="m"><prompt>{prompt}</prompt>{CHOICES}</menu>')
    document, _ = read_application(ea, read_file(Path(ea)))
    (part,) = (one for one in outline(document, PROFILE).parts if one.what == "speak")
    assert (part.lasts, part.unknown) == (lasting(said), why)


def test_documents_of_voicexml_that_are_not_read_are_a_gap(tmp_path: Path) -> None:
    more = {f"m{one}": "<form/>" for one in range(MOST_PAGES)}
    gotos = "".join(f'<goto next="{name}.vxml"/>' for name in more)
    found, _, _ = voiced(tmp_path, f"<form><block>{gotos}</block></form>", **more)
    told = [(gap.reason, gap.place.file) for gap in found.gaps]
    reason = f"only {MOST_PAGES} documents of an application are read"
    assert told == [(reason, str(tmp_path / "theirs.vxml"))]


@pytest.mark.parametrize(
    "kind, listens", [("bridge", True), ("consultation", True), ("blind", False)]
)
@pytest.mark.parametrize("grammar", ["", '<grammar src="builtin:boolean"/>'])
def test_a_call_of_voicexml_listens_for_the_words_of_its_grammars(
    tmp_path: Path, kind: str, listens: bool, grammar: str
) -> None:
    transfer = f'<transfer name="t" dest="tel:+1-555" type="{kind}">{grammar}</transfer>'
    found, _, _ = voiced(tmp_path, f"<form>{transfer}</form>")
    assert ("speech-recognition" in {*found.both, *found.only_ea}) == (listens and bool(grammar))


def test_a_command_of_voicexml_that_is_refused_costs_the_most_that_it_may(tmp_path: Path) -> None:
    def price(angle: int) -> int:
        turn = f'<form><block><p:turn angle="{angle}"/></block></form>'
        _, _, ea = voiced(tmp_path, turn)
        document, _ = read_application(ea, read_file(Path(ea)))
        (part,) = outline(document, PROFILE).parts
        return part.lasts

    assert price(30) < price(360) == price(9999)


@pytest.mark.parametrize(
    "content, first", [("Yes?", ["question"]), ('<if cond="true">Yes?</if>', None)]
)
def test_a_reaction_of_voicexml_may_begin_with_anything(
    tmp_path: Path, content: str, first: list[str] | None
) -> None:
    """What comes first is not followed into branches."""
    body = (
        f'<form><block><p:gesture name="bow"/></block></form><catch event="bell">{content}</catch>'
    )
    _, _, ea = voiced(tmp_path, body)
    document, _ = read_application(ea, read_file(Path(ea)))
    found = outline(document, PROFILE)
    (reaction,) = found.reactions
    firsts = [one.what for one in reaction.firsts]
    assert firsts == (first or [one.what for one in found.parts])
