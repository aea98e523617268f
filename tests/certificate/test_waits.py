"""How long a certified reaction may wait."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.certificate import (
    certificate_data,
    format_certificate,
)
from prima.checks.prices import outline
from prima.loading import read_application
from tests.helpers.certified import faults
from tests.helpers.certifying import (
    FA,
    PROFILE,
    TOUCH,
    block,
    certified,
    lasting,
    run,
    voiced,
    waited,
)


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


def test_a_question_waits_as_long_as_where_its_prompt_is_queued(tmp_path: Path) -> None:
    body = """<form><property name="timeout" value="30s"/><block>Well?</block>
        <field name="a" type="boolean"><property name="timeout" value="1s"/></field></form>"""
    found, fa, ea = voiced(tmp_path, body)
    (delay,) = found.delays
    took = waited(run(tmp_path, fa, ea, TOUCH, "120s"))
    assert took > 29 and took * 1000 <= delay.lasts


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


def test_a_reaction_may_wait_for_what_its_application_does_without_reacting(tmp_path: Path) -> None:
    """The EA's words about the touch keep its own reaction to the bell, for which the FA waits."""
    words = "This sentence goes on and on until everybody who stands in the room is tired of it."
    own = '<form id="s"><on event="bell"><move-head pan="10"/></on></form>'
    body = (
        f'<form id="f"><on event="touch" reactive="false"><speak>{words}</speak></on>'
        '<on event="bell"><gesture name="bow"/><speak>Hi.</speak></on></form>'
    )
    found = certified(tmp_path, body, own)
    (delay,) = found.delays
    assert delay.each is not None and delay.each >= lasting(words)
    assert found.others.lasts >= lasting(words)
    whens = '<when at="1100ms"><event name="bell"/></when>'
    records = run(tmp_path, "mine.xml", "theirs.xml", TOUCH + whens)
    (began,) = [r["time"] for r in records if r["phase"] == "start" and r["app"] == "mine"]
    assert delay.lasts / 1000 < began - 1.1 <= (delay.lasts + delay.each) / 1000


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
    (tmp_path / "stop.abnf").write_text("#ABNF 1.0 UTF-8;\nroot $r;\n$r = stop it;\n")
    other = link.format("f", "").replace("<grammar>", '<grammar src="stop.abnf">')
    (delay,) = certified(tmp_path, link.format("f", "stop it"), other).delays
    assert len(delay.after) == 1, "what a file hears is not followed"


def test_what_drives_waits_for_whole_conversations(tmp_path: Path) -> None:
    own = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')
    field = '<form id="q"><field name="a" type="boolean"><prompt>Well?</prompt></field></form>'
    (delay,) = certified(tmp_path, field, own).delays
    assert not delay.known and delay.endless and delay.devices == ()


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


def test_two_texts_of_one_element_are_said_one_after_the_other(tmp_path: Path) -> None:
    """Both texts belong to the block: VoiceXML puts them into no element of their own."""

    def told(body: str) -> str:
        found, _, _ = voiced(tmp_path, f"<form><block>{body}</block></form>", LATER)
        return format_certificate(found).partition("others than reactions ")[2]

    one, two = "<prompt>Eins zwei drei.</prompt>", "<prompt>Vier sechs.</prompt>"
    text = told("Eins zwei drei. <log/> Vier sechs.")
    assert text.startswith("wait up to ") and text == told(f"{one}<log/>{two}")


def test_a_question_in_a_unit_is_asked_until_the_unit_ends(tmp_path: Path) -> None:
    field = '<field name="q" type="boolean"><prompt timeout="2s">Well?</prompt></field>'
    body = f'<form id="f"><iu longest="6s">{field}</iu></form>'
    own = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')
    found = certified(tmp_path, body, own)
    (delay,) = found.delays
    assert delay.known and delay.lasts == 6000 + lasting("Well?") + 2000
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), TOUCH)
    assert faults(found, records, PROFILE.voices) == []
    assert found.starves == []


AGAIN = "<noinput><speak>Again.</speak></noinput>"
UP = "<noinput><exit/></noinput><nomatch><exit/></nomatch>"


@pytest.mark.parametrize(
    ("inner", "outer", "most"),
    [
        ("", UP, 1),
        (AGAIN, UP, 0),
        (AGAIN + '<noinput count="3"><exit/></noinput>', UP, 3),
        ('<on event="noinput" cond="a"><speak>Again.</speak></on>', UP, 0),
        ('<on event="noinput" cond="a"><exit/></on>', UP, 1),
        ('<on event="noinput" cond="a"><exit/></on>', "<nomatch><exit/></nomatch>", 0),
        (
            AGAIN + '<noinput count="2"><exit/></noinput>' + AGAIN.replace(">", ' count="2">', 1),
            UP,
            2,
        ),
    ],
)
def test_the_handler_that_takes_it_decides_how_often_a_question_is_asked(
    tmp_path: Path, inner: str, outer: str, most: int
) -> None:
    """Of equal counts the innermost handler is selected (5.2.4), whatever the others do."""
    field = f'<field name="q" type="boolean"><prompt timeout="2s">Well?</prompt>{inner}</field>'
    body = f'<var name="a" expr="true"/>{outer}<form id="f">{field}</form>'
    own = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')
    (delay,) = certified(tmp_path, body, own).delays
    assert bool(delay.endless) == (most == 0)
    document = read_application("a", (tmp_path / "theirs.xml").read_bytes())[0]
    assert outline(document, PROFILE).states["f"].times == max(most, 1)
