"""Durations of prompts in simulated time: pauses, rates, durations."""

from __future__ import annotations

from random import Random

import pytest

from prima.devices.voice import PAUSE_MS, SENTENCE_MS, duration, timeline
from prima.messages import Cue
from prima.voicexml.cues import MAX_CUES, fold, rate_of
from prima.voicexml.reading import read_page
from tests.helpers.spoken import Played, of, plain, prompt, takes, texts
from tests.helpers.voice import Call, vxml


# How long it takes --------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("markup", "text", "more"),
    [
        ('One <break time="2s"/> two', "One two", 2000),
        ('One <break time="+1.5s"/> two', "One two", 1500),
        ('One <break time="250ms" strength="x-strong"/> two', "One two", 250),
        ("One <break/> two", "One two", 500),
        ('One <break strength="none"/> two', "One two", 0),
        ('One <break strength="x-weak"/> two', "One two", 100),
        ('One <break strength="weak"/> two', "One two", 250),
        ('One <break strength="medium"/> two', "One two", 500),
        ('One <break strength="strong"/> two', "One two", 750),
        ('One <break strength="x-strong"/> two', "One two", 1000),
        ('One <break size="small"/> two', "One two", 250),
        ('One <break size="large"/> two', "One two", 1000),
        ('<break time="2s"/>One two', "One two", 2000),
        ('One two<break time="2s"/>', "One two", 2000),
        ('One<break time="2s"/>two', "One two", 2000),
        ('One <break time="2s"/><break time="1s"/> two', "One two", 3000),
        ("<s>One</s> <s>two</s>", "One two", SENTENCE_MS),
        ("<p><s>One</s></p><p><s>two</s></p>", "One two", SENTENCE_MS),
        ("<p>One</p> two", "One two", SENTENCE_MS),
        ("One <p>two</p>", "One two", SENTENCE_MS),
        ("<s>One.</s><s>Two.</s>", "One. Two.", 0),
        ("<s>One</s>", "One", 0),
        ("<emphasis level='strong'>One</emphasis> two", "One two", 0),
        ('<voice gender="female">One</voice> two', "One two", 0),
        ('<prosody rate="default" pitch="high" volume="loud">One two</prosody>', "One two", 0),
        ('<prosody rate="medium">One two</prosody>', "One two", 0),
    ],
)
def test_pauses_are_added_to_what_the_words_take(  # SSML 1.0, 3.2.3
    played: Played, markup: str, text: str, more: int
) -> None:
    made = played(prompt(markup))
    assert (texts(made), takes(made)) == ([text], [plain(text) + more])


@pytest.mark.parametrize(
    ("rate", "factor"),
    [
        ("x-slow", 0.5),
        ("slow", 0.8),
        ("fast", 1.25),
        ("x-fast", 2.0),
        ("0.5", 0.5),
        ("2", 2.0),
        ("+10%", 1.1),
        ("-50%", 0.5),
        ("150%", 1.5),
        ("+0.5", 1.5),
    ],
)
def test_a_rate_counts_for_the_letters(played: Played, rate: str, factor: float) -> None:
    text = "A rather long sentence to be said at a rate"
    made = played(prompt(f'<prosody rate="{rate}">{text}</prosody>'))
    assert texts(made) == [text]
    expected = (plain(text) - PAUSE_MS) / factor + PAUSE_MS
    assert takes(made)[0] == pytest.approx(expected, abs=2)


@pytest.mark.parametrize(
    ("outer", "inner", "factor"),
    [
        ("-50%", "-50%", 0.25),
        ("50%", "+50%", 0.75),
        ("fast", "+100%", 2.5),
        ("2", "default", 1.0),
        ("2", "0.5", 0.5),
        ("slow", "fast", 1.25),
        ("10", "+1000%", 10.0),
        ("0", "-100%", 0.1),
        ("0.5", "no rate at all", 0.5),
    ],
)
def test_relative_rates_multiply_and_others_do_not(outer: str, inner: str, factor: float) -> None:
    assert rate_of(inner, rate_of(outer, 1.0)) == pytest.approx(factor)


def test_a_rate_ends_with_its_element_whatever_is_in_it(played: Played) -> None:
    made = played(
        prompt(
            '<prosody rate="0.5">aaaaaaaaaaaaaa <voice xml:lang="en-GB">bbbbbbbbbbbbbb</voice>'
            " cccccccccccccc</prosody> dddddddddddddd"
        )
    )
    assert texts(made) == ["aaaaaaaaaaaaaa", "bbbbbbbbbbbbbb", "cccccccccccccc dddddddddddddd"]
    assert takes(made) == [2300, 2300, 3300]


def test_a_set_duration_goes_before_rates_and_pauses(played: Played) -> None:  # SSML 1.0, 3.2.4
    made = played(
        prompt('<prosody duration="3s" rate="slow">One <break time="9s"/> two.</prosody>').replace(
            "</block>", '<prompt>One <prosody duration="3s">two</prosody></prompt></block>'
        )
    )
    assert takes(made) == [3000, 3000 + plain("One")]


def test_a_set_duration_within_another_is_a_part_of_it(played: Played) -> None:
    made = played(
        prompt(
            '<prosody duration="2s"><prosody duration="3s">One</prosody>'
            '<mark name="m"/><prosody duration="1s">two</prosody></prosody>'
        )
    )
    assert takes(made) == [2000]
    cues = tuple(
        Cue(at, kind, value)  # type: ignore[arg-type]
        for at, kind, value in (
            (0, "lasts", 2000),
            (0, "lasts", 3000),
            (3, "end", None),
            (3, "mark", "m"),
            (3, "lasts", 1000),
            (6, "end", None),
            (6, "end", None),
        )
    )
    assert timeline("Onetwo", "en", {}, cues).marks == ((1500, "m"),)


def test_a_set_duration_that_is_split_has_no_effect(played: Played) -> None:
    made = played(prompt('<prosody duration="9s">One <voice xml:lang="fr">deux</voice></prosody>'))
    assert takes(made) == [plain("One"), duration("deux", "fr", {})]


def test_a_pause_alone_goes_with_what_is_said_around_it(played: Played) -> None:
    made = played(
        """<form><block><prompt><break time="1s"/></prompt><prompt>One.</prompt>
        <prompt><break time="2s"/></prompt></block></form>"""
    )
    assert takes(made) == [plain("One.") + 3000]


def test_a_question_of_a_pause_alone_listens_after_it(played: Played) -> None:
    made = played(
        """<form><field name="f"><prompt timeout="1s"><break time="2s"/></prompt>
        <option>yes</option><noinput><exit/></noinput></field></form>"""
    )
    assert [record["time"] for record in of(made, "listening")] == [2.0]


def test_pauses_count_between_the_choices_of_an_enumerate(played: Played) -> None:
    made = played(
        """<menu><property name="timeout" value="1s"/><prompt><enumerate>Say <value expr="_prompt"/>
        <break time="1s"/></enumerate></prompt><choice event="a">red</choice><choice event="b">blue
        </choice><noinput><exit/></noinput></menu>"""
    )
    assert texts(made) == ["Say red Say blue"]
    heard = plain("Say red Say blue") + 2000
    assert [record["time"] for record in of(made, "listening")] == [heard / 1000]


def test_pauses_count_in_what_a_command_says(played: Played) -> None:
    made = played(
        '<form xmlns:p="urn:prima:dialogue:1"><block><p:turn-and-speak angle="1">One'
        ' <break time="3s"/> two</p:turn-and-speak></block></form>'
    )
    start, end = of(made, "start")[0], of(made, "end")[0]
    assert end["time"] - start["time"] == pytest.approx((plain("One two") + 3000) / 1000)


def test_a_pause_before_a_command_goes_ahead_of_what_it_says(played: Played) -> None:
    made = played(
        """<form xmlns:p="urn:prima:dialogue:1"><block><prompt><break time="2s"/><p:speak>One <mark
        name="a"/> two</p:speak></prompt><prompt>three</prompt></block></form>""",
        policy="prima+x2",
    )
    assert takes(made) == [plain("One two") + 2000, plain("three")]
    asked = of(made, "request")
    assert [one.get("restartable") for one in asked] == [True, None]
    assert asked[0]["cues"] == [{"at": 0, "pause": 2000}, {"at": 3, "mark": "a"}]


def test_a_long_pause_is_no_failure_of_the_speaker(played: Played) -> None:  # E1
    made = played(prompt('One <break time="300s"/> two'))
    assert (takes(made), of(made, "fail")) == ([plain("One two") + 300_000], [])


def test_a_slow_voice_is_no_failure_of_the_speaker() -> None:
    text = "a" * 4000
    assert timeline(text, "en", {}, (Cue(0, "rate", 0.1),)).total < 500 * 4000 * 10


def test_what_has_no_cues_is_recorded_as_before(played: Played) -> None:
    made = played(prompt("<p>One.</p> <emphasis>two</emphasis> <voice name='x'>three</voice>"))
    assert all("cues" not in record for record in made.records)


def test_cues_without_number_are_bounded() -> None:
    parts: list[str | Cue] = []
    for index in range(5000):
        parts += [Cue(0, "lasts", 5), f"w{index} ", Cue(0, "mark", "m"), Cue(0, "end")]
    cues = fold(parts)[1]
    assert len(cues) <= 2 * MAX_CUES
    kinds = [cue.kind for cue in cues]
    assert kinds.count("lasts") == kinds.count("end")


def test_pauses_with_nothing_to_say_are_bounded(played: Played) -> None:
    pauses = '<break time="1ms"/>' * 10
    prompts = f"<prompt>{pauses}</prompt>" * 300
    made = played(f"<form><block>{prompts}<prompt>One</prompt>{prompts}</block></form>")
    assert takes(made)[0] <= plain("One") + 3 * MAX_CUES


@pytest.mark.parametrize(
    "parts", [["a", "b"], [" a", "b "], ["a ", " b"], ["", "\n", "a"], ["a\tb", "", " c", "d"], []]
)
def test_text_is_folded_as_one_piece(parts: list[str]) -> None:
    assert fold(parts) == (" ".join("".join(parts).split()), ())


def pieces(chance: Random, deep: int) -> list[str | Cue]:
    """Random words and cues, set times inside each other."""
    made: list[str | Cue] = []
    for _ in range(chance.randint(0, 5)):
        match chance.randint(0, 6):
            case 0 if deep:
                inner = pieces(chance, deep - 1)
                made += [Cue(0, "lasts", chance.choice([0, 1, 900])), *inner, Cue(0, "end")]
            case 1:
                made.append(Cue(0, "rate", chance.choice([0.1, 1.0, 10.0])))
            case 2:
                made.append(Cue(0, "pause", chance.choice([1, 5000])))
            case 3:
                made.append(Cue(0, "mark", f"m{len(made)}"))
            case 4:
                made.append(Cue(0, "sentence"))
            case _:
                made.append(chance.choice(["One. ", "two", " ", "...", "日本 "]))
    return made


@pytest.mark.parametrize("seed", range(200))
def test_time_never_goes_back(seed: int) -> None:
    made = pieces(Random(seed), 3)
    text, cues = fold(made)
    laid = timeline(text, "en", {}, cues)
    assert text == " ".join("".join(one for one in made if isinstance(one, str)).split())
    assert len(laid.ends) == len(text) and laid.heard(laid.total) == text
    assert list(laid.ends) == sorted(laid.ends)
    times = [time for time, _ in laid.marks]
    assert times == sorted(times) and all(0 <= time <= laid.total for time in times)
    named = [one.value for one in made if isinstance(one, Cue) and one.kind == "mark"]
    assert [name for _, name in laid.marks] == named


# Values that are none -------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("markup", "column"),
    [
        ('<break time="2"/>', 14),
        ('<break time="soon"/>', 14),
        ('<break time="-1s"/>', 14),
        ('<break time="1e3s"/>', 14),
        ('<break strength="huge"/>', 18),
        ('<break size="tiny"/>', 14),
        ('<prosody rate="quick">x</prosody>', 16),
        ('<prosody rate="">x</prosody>', 16),
        ('<prosody rate="10 %">x</prosody>', 16),
        ('<prosody rate="+-1">x</prosody>', 16),
        ('<prosody rate="1e3">x</prosody>', 16),
        ('<prosody rate="-">x</prosody>', 16),
        ('<prosody duration="long">x</prosody>', 20),
        ('<emphasis level="much">x</emphasis>', 18),
        ('<voice gender="robot">x</voice>', 16),
    ],
)
def test_a_value_that_is_none_is_told_with_its_place(markup: str, column: int) -> None:
    lines = f"<form><block><prompt>\n{markup}\n</prompt></block></form>"
    page = read_page("a.vxml", "a.vxml", vxml(lines).encode())
    [problem] = page.problems
    assert (problem.severity, problem.code, problem.place.line) == ("error", "bad-value", 2)
    assert (problem.place.column, bool(problem.remedy)) == (column, True)


@pytest.mark.parametrize(
    "markup",
    [
        '<break time=".5s"/><break time="5.s"/><break time="0ms"/>',
        '<prosody rate=".5"><prosody rate="5."><prosody rate="-15.9%">x</prosody></prosody></prosody>',
        '<prosody rate="999999999">x</prosody><prosody rate="0">y</prosody>',
        '<prosody duration="0s">x</prosody>',
    ],
)
def test_values_at_the_edge_are_fine(played: Played, markup: str) -> None:
    made = played(prompt(f"{markup} z"))
    assert made.outcome == "over" and takes(made)[0] > 0


def test_a_text_with_half_a_letter_comes_out_of_a_grammar() -> None:
    call = Call(
        """<form><field name="x"><prompt>Well?</prompt>
        <grammar version="1.0" root="r" tag-format="semantics/1.0">
          <rule id="r">go<tag>out = "a\\ud800b"</tag></rule></grammar>
        <filled><log expr="x"/><log expr="x.length"/></filled></field></form>"""
    )
    call.answer("go")
    assert call.logs() == ["a\ufffdb", "3"]
