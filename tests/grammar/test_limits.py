"""Hostile grammars, tags and utterances come to an end, and long ones are quick."""

from __future__ import annotations

import subprocess
import sys
from time import perf_counter, process_time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.errors import Place
from prima.grammar import (
    GrammarError,
    load,
)
from prima.grammar.model import Tag
from prima.script.shared import IsolatedTagEngine
from tests.helpers.grammars import ABNF, SCRIPT, xml
from tests.helpers.work import steps

# What is hostile ---------------------------------------------------------------
XS = " ".join("x" * 400)


@pytest.mark.parametrize(
    "body",
    [
        "$r = $r x | x;",
        "$r = $r $r | $r $r $r | x | ();",
        "$r = $a | y; $a = $b | $r; $b = $a | $r x;",
        "$r = ((([x]<0->)<0->)<0->)<0-> y;",
        "$r = (x<0-1000000> y<0-1000000>)<0-1000000> z;",
        "$r = [x]<1000000> z<5000000>;",
        "$r = ($GARBAGE x $GARBAGE)<0-> z;",
        "$r = $r0;"
        + "".join(f"$r{i} = $r{i + 1} $r{i + 1};" for i in range(60))
        + "$r60 = x | ();",
        "$r = $r0;" + "".join(f"$r{i} = $r{i + 1};" for i in range(3000)) + "$r3000 = x;",
        "$r = " + "(x|x x|x x x)" * 100 + " z;",
    ],
)
def test_hostile_rules_end(body: str) -> None:
    grammar = load(ABNF + body)
    for said in ("x", "x x x y", XS):
        began = perf_counter()
        grammar.match(said, most=5)
        assert perf_counter() - began < 20


@pytest.mark.parametrize(
    "body",
    [
        "$r = $r $r | x {out = 1} | x {out = 2};",
        "$r = $r $r | x {!{for (var i = 0; i < 30000; i++) out = i;}!} | x {out = 2};",
    ],
)
def test_many_meanings_of_what_is_ambiguous(body: str) -> None:
    grammar = load(SCRIPT + body)
    began = perf_counter()
    assert grammar.match(" ".join("x" * 40), most=20)
    assert perf_counter() - began < 20


@pytest.mark.parametrize("name", ["currency", "date", "digits", "number", "phone", "time"])
def test_built_in_types_read_anything_in_time(name: str) -> None:
    grammar = load(name)
    for unit in ("9", "*", "five ", "a ", "and ", "hundred ", "past ", "1,111,", ".", "年", "p m "):
        said = unit * (9_900 // len(unit))
        began = perf_counter()
        grammar.match(said)
        grammar.match(said, mode="dtmf")
        assert perf_counter() - began < 5


@pytest.mark.parametrize(
    "source",
    [
        b" " * 50_000_000,
        ABNF + "$r = " + "(" * 10_000 + "x" + ")" * 10_000 + ";",
        ABNF + "$r = " + "[" * 10_000,
        xml('<rule id="r">' + "<item>" * 10_000 + "x" + "</item>" * 10_000 + "</rule>"),
        xml('<rule id="r">&a;</rule>').replace(
            "<grammar", '<!DOCTYPE g [<!ENTITY a "b">]><grammar', 1
        ),
        b"\x00\xff\x00",
        b"",
        "#ABNF 1.0;" + "\n" * 1000 + "{",
        ABNF + "$r = \ud800;",
        ABNF + "$r = " + "$q " * 200_000 + ";",
        "".join([ABNF, *(f"$q{number} = $p{number};" for number in range(40_000))]),
        ABNF + "$r = " + "{!{" * 600_000,
        ABNF + "$r = " + "/*" * 900_000,
        ABNF + "$r = a; //" + "x" * 5_000_000,
    ],
)
def test_hostile_files_are_refused(source: str | bytes) -> None:
    with pytest.raises(GrammarError):
        load(source)


@pytest.mark.parametrize(
    "tag",
    [
        "while (true) {}",
        "var s = 'x'; while (true) s += s",
        "out = 'x'.repeat(200000)",
        "out.self = out",
        "for (let o = out, i = 0; i < 5000; i++) o = o.o = {}",
        "function f() { return f() + 1 } f()",
        "for (let i = 0; i < 60; i++) out = [out, out]",
        "out = {toJSON: function () { throw 1 }}",
        "throw null",
        "out = Symbol()" + "; out.x.y",
    ],
)
def test_hostile_tags_fail(tag: str) -> None:
    began = perf_counter()
    (one,) = load(f"{SCRIPT}$r = x {{!{{{tag}}}!}};").match("x")
    assert one.error is not None and one.interpretation is None
    assert perf_counter() - began < 10


def test_null_that_a_tag_throws_is_told() -> None:
    error = load(f"{SCRIPT}$r = x {{throw null}};").match("x")[0].error
    assert error is not None
    assert error.message == 'The tag "throw null" failed: it threw null, or used too much memory.'


def test_the_time_limit_is_of_the_whole_utterance() -> None:
    grammar = load(SCRIPT + "$r = $b<0->; $b = x {!{var i = 0; while (i < 200000) i++}!};")
    began = perf_counter()
    assert grammar.match(XS)[0].error is not None
    assert perf_counter() - began < 10


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.text(alphabet='$rab=;|()[]<>{}!/0-12" \n#é東*~.', max_size=60))
def test_any_text_is_a_grammar_or_refused(text: str) -> None:
    try:
        grammar = load(ABNF + "$r = " + text)
    except GrammarError as error:
        assert error.problems
        return
    grammar.match("a b")


@st.composite
def expansions(draw: st.DrawFn, depth: int = 3) -> str:
    kind = draw(st.integers(0, 6 if depth else 1))
    if kind <= 1:
        return draw(st.sampled_from(["a", "b", "$r", "$s", "()", "$NULL"]))
    inner = [draw(expansions(depth - 1)) for _ in range(draw(st.integers(1, 3)))]
    if kind == 2:
        return f"({' | '.join(inner)})"
    if kind == 3:
        return f"[{inner[0]}]"
    if kind == 4:
        return f"({inner[0]})<{draw(st.sampled_from(['0-', '1-', '2', '0-2']))}>"
    return f"({' '.join(inner)})"


LETTERS = ["", "a", "b", "a a", "a b", "b a", "b b", "a b a", "b b b"]


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(expansions(), expansions())
def test_the_chart_takes_what_the_rules_derive(one: str, two: str) -> None:
    """Against sets of all short utterances that the rules derive, made by growing them."""
    grammar = load(f"{ABNF}$r = {one};\n$s = {two};")
    derived = derive(
        {"r": grammar._document.rules["r"].body, "s": grammar._document.rules["s"].body}
    )
    for said in LETTERS:
        assert bool(grammar.match(said)) == (tuple(said.split()) in derived), (said, one, two)


LONGEST = 3
Said = set[tuple[str, ...]]


def derive(rules: dict[str, object]) -> Said:
    known: dict[str, Said] = {name: set() for name in rules}
    while True:
        grown = {name: language(body, known) for name, body in rules.items()}
        if grown == known:
            return known["r"]
        known = grown


def joined(left: Said, right: Said) -> Said:
    return {a + b for a in left for b in right if len(a + b) <= LONGEST}


def language(part: object, known: dict[str, Said]) -> Said:
    from prima.grammar import model

    match part:
        case model.Words(tokens=tokens):
            return {tokens} if len(tokens) <= LONGEST else set()
        case model.Reference(rule=rule):
            return known[rule.name] if rule else set()
        case model.Alternatives(parts=parts):
            return {one for inner in parts for one in language(inner, known)}
        case model.Sequence(parts=parts):
            found: Said = {()}
            for inner in parts:
                found = joined(found, language(inner, known))
            return found
        case model.Repeat(part=inner, low=low, high=high):
            once = language(inner, known)
            here: Said = {()}
            found = {()} if low == 0 else set()
            for times in range(1, (LONGEST + low + 1) if high is None else high + 1):
                here = joined(here, once)
                found |= here if times >= low else set()
            return found
        case _:
            return {()}


# How fast it is ----------------------------------------------------------------
@pytest.mark.parametrize("form", ["xml", "abnf"])
def test_an_answer_is_no_more_work_among_thousands(form: str) -> None:
    def work(numbers: int) -> int:
        items = [f"the {word} of {n}" for n in range(numbers) for word in ("lord", "lady", "house")]
        if form == "xml":
            listed = "".join(f"<item>{item}<tag>{item}</tag></item>" for item in items)
            grammar = load(
                xml(
                    '<rule id="r">find <ruleref uri="#w"/> now</rule>'
                    f'<rule id="w"><one-of>{listed}</one-of></rule>'
                )
            )
        else:
            listed = "|".join(f"{item} {{{item}}}" for item in items)
            grammar = load(f"{ABNF}$r = find $w now;\n$w = {listed};")
        grammar.match("find the lady of 3 now")  # the first time, beginnings are gathered

        def match() -> None:
            (found,) = grammar.match("find the lady of 7 now")
            assert found.interpretation == "the lady of 7"

        return steps(match)

    assert work(2500) < 1.5 * work(25)


@pytest.mark.parametrize(
    ("one", "said"),
    [
        ("[the] w{0} now", "the w5 now"),
        ("(a | the) w{0}", "the w5"),
        ("{{{0}}} [go] to w{0}<1->", "to w5 w5"),
        ("$x{0}", "please w5"),
        ("$GARBAGE w{0}", "w5"),
        ("駅{0}番 [まで]", "駅5番まで"),
    ],
)
def test_however_ten_thousand_alternatives_begin(one: str, said: str) -> None:
    count = 10_000 if "GARBAGE" not in one else 100  # what begins with any words is tried
    rules = "".join(f"$x{number} = [please] w{number};" for number in range(count))
    alternatives = "|".join(one.format(number) for number in range(count))
    grammar = load(f"{ABNF}{rules if '$x' in one else ''}$r = {alternatives};")
    assert grammar.match(said)
    assert not grammar.match(f"{said} w5 z")
    assert steps(lambda: grammar.match(said)) < (20_000 if count > 100 else 200_000)


@pytest.mark.parametrize(
    "body",
    [
        "$r = " + "a {b} " * 50_000 + "| c;",
        "$r = " + "[a] " * 20_000 + "| c;",
        "$r = "
        + "(" * 90
        + "a | c"
        + ")" * 90
        + " | " * 1
        + "|".join("[a] [b] c" for _ in range(9))
        + ";",
        "$r = $r0 | c;"
        + "".join(f"$r{i} = $r{i + 1} a | $r{i + 1};" for i in range(2000))
        + "$r2000 = b;",
        "$r = $r | $r a | [$r] [$r] c;",
    ],
)
def test_beginnings_are_looked_for_in_bounded_time(body: str) -> None:
    began = process_time()
    assert load(ABNF + body).match("c")
    assert process_time() - began < 10


def test_the_work_of_loading_grows_with_the_length() -> None:
    short, long = (
        xml('<rule id="r"><one-of>' + "<item>a b</item>" * count + "</one-of></rule>")
        for count in (200, 2000)
    )
    assert steps(lambda: load(long)) < 11 * steps(lambda: load(short))


def test_tags_are_checked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    checked: list[str] = []
    call = IsolatedTagEngine._call

    def noted(engine: IsolatedTagEngine, method: str, *arguments: object) -> object:
        if method == "fault":
            checked.append(str(*arguments))
        return call(engine, method, *arguments)

    monkeypatch.setattr(IsolatedTagEngine, "_call", noted)
    grammar = load(f"{SCRIPT}$r = x {{out=1}} y {{if (1)}} | z {{out=2}};")
    for said in ("x y", "x y", "z", "z"):
        grammar.match(said)
    assert checked == ["out=1", "if (1)", "out=2"]


def test_a_tag_that_is_no_script_by_itself_is_told_at_its_place() -> None:
    error = load(f"{SCRIPT}$r = x {{out=1}}\n  {{if (0)}} {{out=2}};").match("x")[0].error
    assert error is not None and error.place == Place("grammar", 6, 3)
    assert error.message.startswith('The tag "if (0)" failed: SyntaxError')


@pytest.mark.parametrize("last", ["{out=2}", "{out=gone}"])
def test_the_tags_of_a_rule_are_not_compared_with_each_other(
    last: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    compared: list[Tag] = []

    def equal(one: Tag, other: object) -> bool:
        compared.append(one)
        return one is other

    monkeypatch.setattr(Tag, "__eq__", equal)
    (found,) = load(f"{SCRIPT}$r = x {'{out=1}' * 500} {last};").match("x")
    assert (found.interpretation, found.error is None) in [(2, True), (None, False)]
    assert not compared


RULE = '<rule id="r">x<tag>y</tag></rule>'


def test_the_parser_of_abnf_and_the_engine_are_loaded_when_needed() -> None:
    code = (
        "import sys\nfrom prima.grammar import load\n"
        f"load({xml(RULE)!r}).match('x')\n"
        "assert not {'prima.grammar.abnf', '_quickjs'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_tags_are_told_the_time_that_is_given() -> None:
    grammar = load(
        f"{SCRIPT}$r = today {{!{{out = new Date().toISOString()}}!}}"
        " | years since 1969 {!{out = new Date().getUTCFullYear() - 1969}!};"
    )
    (today,) = grammar.match("today", now=1_109_671_200_000)
    assert today.interpretation == "2005-03-01T10:00:00.000Z"
    assert grammar.match("years since 1969")[0].interpretation == 1


def test_a_token_of_many_digits_is_read_in_one_pass() -> None:
    digits = "1" * 20_000
    began = process_time()
    assert not load(xml(f'<rule id="r">{digits} !</rule>')).match("1")
    assert process_time() - began < 2, "10 ms on a quiet machine"


def test_a_slot_inside_very_many_objects_is_text() -> None:
    tag = "a." * 20_000 + "b=1"
    began = process_time()
    (match,) = load(f"{ABNF}$r = go {{{tag}}};").match("go")
    assert match.interpretation == tag
    assert process_time() - began < 2, "50 ms on a quiet machine"
    (match,) = load(f"{ABNF}$r = go {{{'a.' * 15}b=1}};").match("go")
    assert str(match.interpretation).count("a") == 15


def test_a_tag_that_begins_like_slots_is_soon_known() -> None:
    began = process_time()
    (match,) = load(xml(f'<rule id="r">go<tag>&lt;a{" " * 3_000}</tag></rule>')).match("go")
    assert match.interpretation == "<a"
    assert process_time() - began < 2, "20 ms on a quiet machine"


@pytest.mark.parametrize("deep", [399, 400, 990, 995, 1000, 3000])
@pytest.mark.parametrize("around", ["[o]", "{o: o}"])
def test_values_that_are_nested_deep(deep: int, around: str) -> None:
    """Just below the depth at which the engine gives up, the reply was lost with its process."""
    nested = f"var o = []; for (var i = 1; i < {deep}; i++) o = {around}; out = o;"
    (match,) = load(f"{SCRIPT}$r = x {{!{{{nested}}}!}};").match("x", most=5)
    assert (match.error is None) == (deep <= 400)
    if match.error is not None:
        assert match.error.message.startswith("The value cannot be given")
    assert load(f"{SCRIPT}$r = x {{out = 1}};").match("x")[0].interpretation == 1


@pytest.mark.parametrize(
    ("head", "code"),
    [
        (SCRIPT, "out = rules" + ".a" * 30_000),
        (ABNF, "+".join(["xout"] * 25_000)),
        (ABNF, "out = rules" + ".a" * 30_000),
    ],
)
def test_long_chains_in_tags_are_checked_in_time(head: str, code: str) -> None:
    """Each part asked the parser for its parent, which is looked for from the top of the chain."""
    began = process_time()
    load(f"{head}$r = x {{{code}}};").warnings()
    assert process_time() - began < 5
