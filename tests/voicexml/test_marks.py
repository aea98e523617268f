"""Marks as places to be told (VoiceXML 2.1, 4) and to go on from (X2)."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from tests.helpers.spoken import DEMO, SECOND, Played, logs, of, recording
from tests.helpers.telephone import STOP
from tests.helpers.voice import Call

ASKED = f"""<field name="f"><prompt>{SECOND} <mark name="one"/> {SECOND} <mark name="two"/> {SECOND}</prompt>
<option>yes</option><nomatch><log expr="'no ' + application.lastresult$.markname
+ ' ' + application.lastresult$.marktime"/><exit/></nomatch>
<filled><log expr="f$.markname + ' ' + f$.marktime"/><log
expr="application.lastresult$.markname + ' ' + application.lastresult$.marktime"/></filled></field>"""


@pytest.mark.parametrize(
    ("at", "told"),
    [
        (500, "undefined undefined"),
        (1000, "one 0"),
        (1700, "one 700"),
        (2250, "two 250"),
        (3300, "two 1300"),
        (5300, "two 1300"),  # the prompt was over after 3.3 s
    ],
)
def test_the_last_mark_is_that_passed_at_bargein(played: Played, at: int, told: str) -> None:
    made = played(f"<form>{ASKED}</form>", (at, "yes"))
    assert logs(made) == [told, told]


def test_without_bargein_all_marks_are_passed_before_an_answer(played: Played) -> None:
    asked = ASKED.replace("<prompt>", '<prompt bargein="false">')
    made = played(f"<form>{asked}</form>", (500, "yes"), (3250, "yes"))
    assert logs(made) == ["two 1300", "two 1300"]


def test_a_nomatch_tells_the_mark_as_well(played: Played) -> None:
    made = played(f"<form>{ASKED}</form>", (1700, "what"))
    assert logs(made) == ["no one 700"]


@pytest.mark.parametrize(("at", "told"), [(3500, "zero 1500"), (4700, "one 400")])
def test_a_mark_of_an_earlier_prompt_counts(played: Played, at: int, told: str) -> None:
    before = f'<prompt>{SECOND} {SECOND} <mark name="zero"/> {SECOND}</prompt>'
    made = played(f"<form><block>{before}</block>{ASKED}</form>", (at, "yes"))
    assert logs(made) == [told, told]


def test_a_mark_of_what_was_answered_before_does_not_count(played: Played) -> None:
    second = ASKED.replace('"f"', '"g"').replace("f$", "g$").replace("<mark", "<break")
    second = second.replace('<break name="one"/>', "").replace('<break name="two"/>', "")
    made = played(f"<form>{ASKED}{second}</form>", (1700, "yes"), (6000, "yes"))
    assert logs(made)[-1] == "undefined undefined"


def test_a_mark_in_a_recordings_text_is_not_passed(played: Played, tmp_path: Path) -> None:
    recording(tmp_path / "bell.wav", 2)
    body = ASKED.replace(SECOND, '<audio src="bell.wav">a <mark name="x"/> bell</audio>', 1)
    assert logs(played(f"<form>{body}</form>", (1900, "yes")))[0] == "undefined undefined"
    assert logs(played(f"<form>{body}</form>", (2100, "yes")))[0] == "one 100"


STOPPED = f"""<prompt>{SECOND} <mark name="one"/> {SECOND}</prompt>{STOP}
<filled><log expr="[f$.markname, f$.marktime, application.lastresult$.markname,
application.lastresult$.marktime].join(' ')"/></filled>"""


def test_a_transfer_tells_the_mark_at_which_it_was_stopped(played: Played) -> None:
    item = f'<transfer name="f" dest="tel:+1-555-1234" bridge="true">{STOPPED}</transfer>'
    made = played(f"<form>{item}</form>", (1400, "stop it"))
    assert logs(made) == ["one 400 one 400"]
    before = f'<block><prompt>{SECOND} <mark name="zero"/> {SECOND}</prompt></block>'
    made = played(f"<form>{before}{item}</form>", (2400, "stop it"))
    assert logs(made) == ["zero 1400 zero 1400"]


@pytest.mark.parametrize("said", ["stop it", "hello#"])
def test_what_ends_a_recording_tells_the_mark(played: Played, said: str) -> None:
    made = played(f'<form><record name="f">{STOPPED}</record></form>', (1400, said))
    assert logs(made) == ["one 400 one 400"]


def test_a_recording_that_nothing_ends_tells_the_mark_as_well(played: Played) -> None:  # 2.1, 4
    prompt = f'<prompt>{SECOND} <mark name="one"/> {SECOND}</prompt>'
    filled = '<filled><log expr="[f$.markname, f$.marktime, typeof lastresult$].join()"/></filled>'
    made = played(f'<form><record name="f">{prompt}{filled}</record></form>', (1400, "hello"))
    assert logs(made) == ["one,400,undefined"]


def test_by_a_device_that_tells_of_no_marks_the_last_one_counts() -> None:
    call = Call(f"<form>{ASKED}</form>")
    call.answer("yes")
    assert call.logs()[0] == "two undefined"


STORY = f"""<form><block><prompt>{SECOND} <mark name="one"/> {SECOND} {SECOND} <mark name="two"/> {SECOND}
</prompt></block></form>"""
TOUCH = f"""<application src="{DEMO}/fa/follow.xml" kind="fa"/><answer to="What's the matter">Nothing.</answer>
<when at="AT"><touch sensor="head"/></when>"""


def story(played: Played, at: str, body: str = STORY, policy: str = "prima+x2") -> api.Transcript:
    return played(body, policy=policy, more=TOUCH.replace("AT", at))


@pytest.mark.parametrize(
    ("at", "mark", "left"),
    [("500ms", None, 4300), ("1700ms", "one", 3300), ("3500ms", "two", 1300)],
)
def test_x2_an_utterance_goes_on_from_the_last_mark_passed(
    played: Played, at: str, mark: str | None, left: int
) -> None:
    made = story(played, at)
    resumed = of(made, "start")[-1]
    assert (resumed["resumed"], resumed.get("data", {}).get("mark")) == (True, mark)
    end = of(made, "end")[-1]
    assert end["time"] - resumed["time"] == pytest.approx(left / 1000)
    row = made.rows()[-2].what
    assert row.startswith("resumes ") and row.endswith(f"from the mark {mark}") == bool(mark)


def test_x2_an_utterance_may_be_broken_off_again_before_its_next_mark(played: Played) -> None:
    more = TOUCH.replace("AT", "1500ms") + (
        '<when asked="What\'s the matter" count="1" after="2500ms"><touch sensor="head"/></when>'
    )
    made = played(STORY, policy="prima+x2", more=more)
    told = [record["data"] for record in of(made, "halted")]
    assert [one["mark"] for one in told] == ["one", "one"]
    assert told[1]["heard"].startswith(SECOND)
    end, start = of(made, "end")[-1], of(made, "start")[-1]
    assert end["time"] - start["time"] == pytest.approx(3.3)


@pytest.mark.parametrize("policy", ["prima", "prima+x1"])
def test_without_x2_marks_do_not_let_an_utterance_be_broken(played: Played, policy: str) -> None:
    made = story(played, "1700ms", policy=policy)
    assert of(made, "interrupt") == []


def test_x2_a_prompt_without_marks_is_not_broken(played: Played) -> None:
    made = story(
        played, "1700ms", STORY.replace('<mark name="one"/>', "").replace('<mark name="two"/>', "")
    )
    assert of(made, "interrupt") == []


MARKED = f"""<form><block><prompt>{SECOND}<mark name="one"/></prompt>
<prompt>{SECOND}<mark name="two"/> {SECOND}</prompt></block><field name="f">
<prompt>Which?<mark name="three"/> Now?</prompt><option>red</option>
<filled><log expr="f$.markname"/></filled></field></form>"""


@pytest.mark.parametrize(("at", "mark"), [(300, "undefined"), (1500, "one"), (2600, "two")])
def test_the_last_mark_is_that_passed_when_an_answer_comes_before_the_question(  # 2.1, 4
    played: Played, at: int, mark: str
) -> None:
    assert logs(played(MARKED, (at, "red"))) == [mark]


LONG = f"""<form><block><prompt>{SECOND} <mark name="one"/></prompt>
<prompt><mark name="two"/>{SECOND} <break time="1500ms"/><mark name="three"/></prompt></block>
<field name="f"><prompt>{SECOND} <mark name="four"/></prompt><option>yes</option>
<filled><log expr="f$.markname + ' ' + f$.marktime"/></filled></field></form>"""


@pytest.mark.parametrize(
    ("at", "told"), [(1100, "one 100"), (3700, "two 2400"), (3900, "three 100")]
)
def test_the_last_mark_is_that_passed_when_an_answer_begins_before_what_it_ends_in(  # 2.1, 4
    played: Played, at: int, told: str
) -> None:
    assert logs(played(LONG, (at, "yes"))) == [told]
