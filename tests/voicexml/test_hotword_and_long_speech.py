"""Hotword bargein (4.1.5), timeouts, and users who speak for too long (6.3.2)."""

from __future__ import annotations

import pytest

from tests.helpers.spoken import SECOND, Played, logs, of, plain, texts

# Hotword bargein ----------------------------------------------------------------------------
HOT = f"""<form><field name="f"><prompt bargeintype="hotword">{SECOND} {SECOND} {SECOND}</prompt>
<option>yes</option><nomatch><log>no</log></nomatch><noinput><log>silence</log><exit/></noinput>
<filled><log expr="f"/></filled></field></form>"""


def test_with_hotword_bargein_what_is_not_understood_does_not_count(  # 4.1.5.1
    played: Played,
) -> None:
    made = played(HOT, (500, "what"), (4500, "who"))
    assert logs(made) == ["silence"]
    assert [record["time"] for record in of(made, "listening")] == [3.3]


def test_with_hotword_bargein_an_answer_ends_the_prompt(played: Played) -> None:
    made = played(HOT, (500, "what"), (1500, "yes"))
    assert (logs(made), of(made, "listening")) == (["yes"], [])
    assert of(made, "end")[-1]["time"] == pytest.approx(1.5 + plain("yes") / 1000, abs=0.1)


def test_without_bargein_there_is_no_hotword(played: Played) -> None:
    hot = HOT.replace("<prompt", '<prompt bargein="false"').replace(
        "<log>no</log>", "<log>no</log><exit/>"
    )
    assert logs(played(hot, (500, "yes"), (4000, "what"))) == ["no"]


def test_hotword_may_be_a_property(played: Played) -> None:  # 6.3.2
    hot = HOT.replace(' bargeintype="hotword"', "")
    with_property = hot.replace("<form>", '<property name="bargeintype" value="hotword"/><form>')
    assert logs(played(with_property, (500, "what"))) == ["silence"]
    assert logs(played(hot, (500, "what")))[0] == "no"


LONG_ANSWER = "the one that stands at the very end of the long corridor"


# The timeout and the user's speech (4.1.7) ---------------------------------------------------
@pytest.mark.parametrize("bargein", ["true", "false"])
@pytest.mark.parametrize("at", [0, 2000, 2900])
def test_the_timeout_does_not_run_while_the_user_speaks(
    played: Played, at: int, bargein: str
) -> None:
    asking = f"""<form><field name="f"><prompt bargein="{bargein}" timeout="500ms">Which one?</prompt>
    <option>{LONG_ANSWER}</option><noinput><log>silence</log></noinput>
    <filled><log expr="f"/></filled></field></form>"""
    hello = asking.replace("<form>", "<form><block>Hello, and good morning.</block>")
    assert logs(played(hello, (at, LONG_ANSWER))) == [LONG_ANSWER]


# Speech that is too long (6.3.2) --------------------------------------------------------------
LIMITED = f"""<form><property name="maxspeechtimeout" value="1s"/><field name="f"><prompt>Which?</prompt>
<option dtmf="1">{LONG_ANSWER}</option><option dtmf="2">this</option>
<catch event="maxspeechtimeout"><log>too long</log><exit/></catch>
<filled><log expr="f"/></filled></field></form>"""


def test_who_speaks_for_too_long_is_not_listened_to(played: Played) -> None:
    assert plain(LONG_ANSWER) > 1000
    made = played(LIMITED, (1500, LONG_ANSWER))
    assert logs(made) == ["too long"]
    assert of(made, "end")[-1]["time"] == 2.5, "no longer than the property says"
    (heard,) = [one for one in of(made, "event") if one["event"] == "speech"]
    assert heard["data"]["toolong"] is True


@pytest.mark.parametrize(
    ("said", "value"), [("this", "1s"), ("1", "1ms"), (LONG_ANSWER, "0s"), (LONG_ANSWER, "1min")]
)
def test_what_is_short_enough_is_an_answer(played: Played, said: str, value: str) -> None:
    made = played(LIMITED.replace('value="1s"', f'value="{value}"'), (1500, said))
    assert logs(made) == [LONG_ANSWER if said == "1" else said]


def test_without_a_catch_the_platform_asks_again(played: Played) -> None:  # 5.2.5
    text = LIMITED.replace("<catch", '<catch cond="false"')
    made = played(text, (1500, LONG_ANSWER), (6000, "this"))
    assert texts(made) == ["Which?", "That was too long.", "Which?"]
    assert logs(made) == ["this"]


def test_a_recording_has_its_own_longest_time(played: Played) -> None:
    made = played(
        """<form><property name="maxspeechtimeout" value="1s"/><record name="r"><prompt>Speak.</prompt>
        <filled><log expr="r$.duration > 1000"/></filled></record></form>""",
        (1500, LONG_ANSWER),
    )
    assert logs(made) == ["true"]


def test_speech_that_is_too_long_before_the_question_ends_it_as_well(played: Played) -> None:
    text = LIMITED.replace("<field", f"<block><prompt>{SECOND} {SECOND}</prompt></block><field")
    made = played(text, (500, LONG_ANSWER))
    assert logs(made) == ["too long"]
    assert texts(made) == [f"{SECOND} {SECOND}"]


def test_keys_alone_as_input_have_no_limit(played: Played) -> None:  # 6.3.6
    text = LIMITED.replace("<field", '<property name="inputmodes" value="dtmf"/><field')
    noinput = "<noinput><log>silence</log><exit/></noinput>"
    made = played(text.replace("<filled", f"{noinput}<filled"), (1500, LONG_ANSWER))
    assert logs(made) == ["silence"]


@pytest.mark.parametrize(
    ("said", "logged"),
    [
        ([(500, "yes")], ["nothing"]),
        ([(500, "yes"), (3000, "1")], ["true"]),
        ([(1000, "1")], ["true"]),
        ([(1000, "7"), (3500, "1")], ["no match", "true"]),
    ],
)
def test_what_inputmodes_leave_out_breaks_off_nothing(
    played: Played, said: list[tuple[int, str]], logged: list[str]
) -> None:  # 6.3.6, 4.1.5
    made = played(
        f"""<property name="inputmodes" value="dtmf"/><form><field name="f" type="boolean">
        <prompt>{SECOND} {SECOND} {SECOND}</prompt><filled><log expr="f"/></filled>
        <nomatch><log>no match</log></nomatch><noinput><log>nothing</log><exit/></noinput>
        </field></form>""",
        *said,
    )
    assert logs(made) == logged
    if said[0][1] == "yes":
        assert texts(made)[0] == f"{SECOND} {SECOND} {SECOND}"


@pytest.mark.parametrize("at", [500, 4000, 7000])
@pytest.mark.parametrize(("modes", "later"), [("dtmf", False), ("dtmf voice", True)])
def test_words_do_not_lengthen_the_time_for_keys(
    played: Played, at: int, modes: str, later: bool
) -> None:  # 6.3.6
    made = played(
        f"""<property name="inputmodes" value="{modes}"/><form><field name="f" type="boolean">
        <prompt bargeintype="{"speech" if modes == "dtmf" else "hotword"}">{SECOND} {SECOND} {SECOND}</prompt>
        <noinput><log>nothing</log><exit/></noinput></field></form>""",
        (at, "hello"),
    )
    assert logs(made) == ["nothing"]
    ended = of(made, "end")[-1]["time"]
    assert ended > 8.4 if later and at > 3300 else ended == pytest.approx(8.3, abs=0.02)


def test_another_question_than_was_asked_does_not_limit_what_was_said(played: Played) -> None:
    text = LIMITED.replace(
        "</field></form>",
        f"""<catch event="touch"><goto next="#two"/></catch></field></form>
        <form id="two"><field name="g"><prompt>And?</prompt><option>{LONG_ANSWER}</option>
        <filled><log expr="g"/></filled></field></form>""",
    )
    made = played(text, (1500, LONG_ANSWER), more='<when at="1800ms"><touch sensor="head"/></when>')
    assert logs(made) == [LONG_ANSWER]


def test_who_hangs_up_while_he_speaks_for_too_long_has_recorded_nothing(played: Played) -> None:
    made = played(LIMITED, (1500, LONG_ANSWER), more='<when at="2s"><hang-up/></when>')
    (gone,) = [one for one in of(made, "event") if one["event"].endswith("hangup")]
    assert gone.get("data") is None
