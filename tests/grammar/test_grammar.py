"""The grammar engine: its interface, other documents, what is hostile, and how fast it is."""

from __future__ import annotations

import subprocess
import sys
from time import perf_counter, process_time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.errors import Place
from prima.grammar import (
    Grammar,
    GrammarError,
    UnsupportedBuiltIn,
    UnsupportedFormat,
    UnsupportedLanguage,
    load,
    supports,
)
from prima.grammar.model import Tag
from prima.markup.reader import parse
from prima.markup.tree import Node
from prima.script.isolated import IsolatedSandbox
from tests.helpers.work import steps

SRGS = "http://www.w3.org/2001/06/grammar"
HEAD = f'<grammar xmlns="{SRGS}" version="1.0" xml:lang="en" root="r"'
ABNF = "#ABNF 1.0;\nlanguage en;\nroot $r;\n"
SCRIPT = ABNF + "tag-format <semantics/1.0>;\n"


def xml(rules: str, more: str = "") -> str:
    return f"{HEAD} {more}>{rules}</grammar>"


def inside(grammar: str) -> Node:
    """A <grammar> element of a VoiceXML document."""
    page = f'<vxml xmlns="http://www.w3.org/2001/vxml" version="2.0">\n{grammar}\n</vxml>'
    return parse("page.vxml", page.encode()).nodes[0]


def codes(error: pytest.ExceptionInfo[GrammarError]) -> list[str]:
    return sorted(problem.code for problem in error.value.problems)


# The interface ---------------------------------------------------------------


def test_a_match_tells_what_was_said_and_what_it_means() -> None:
    grammar = load(
        xml(
            '<rule id="r">to "New York" <tag>out.to = "NYC"</tag></rule>',
            'tag-format="semantics/1.0"',
        )
    )
    (one,) = grammar.match("To new york!")
    assert one.utterance == "To new york!"
    assert (one.text, one.tokens) == ("to New York", ("to", "New York"))
    assert one.interpretation == one.slots == {"to": "NYC"}
    assert (one.confidence, one.weight, one.mode, one.error) == (1.0, 1.0, "voice", None)
    assert grammar.mode == "voice" and grammar.lang == "en" and grammar.root == "r"


def test_several_meanings_come_best_first_and_once() -> None:
    grammar = load(
        SCRIPT + "$r = $a | $b | x {out=1} | x {out=3}; $a = x {out=1}; $b = /1/ x {out=2} | /9/ y;"
    )
    assert [one.interpretation for one in grammar.match("x", most=9)] == [1, 3, 2]
    assert [one.interpretation for one in grammar.match("x", most=2)] == [1, 3]
    assert grammar.match("x", most=9)[2].weight == pytest.approx(1 / 9)
    assert grammar.match("x", most=0) == []


def test_what_garbage_takes_lowers_the_confidence() -> None:
    grammar = load(ABNF + "$r = $GARBAGE tea;")
    assert [grammar.match(said)[0].confidence for said in ("tea", "some tea")] == [1.0, 0.75]
    assert grammar.match("some tea")[0].weight == 1.0


def test_a_failing_tag_gives_an_error_with_its_place() -> None:
    grammar = load(SCRIPT + "$r = x {out = 1}\n  {out = gone.x};")
    (one,) = grammar.match("x")
    assert one.interpretation is None and one.error is not None
    assert "gone" in str(one.error) and one.error.place == Place("grammar", 6, 3)


def test_a_grammar_without_root_takes_a_rule_by_name() -> None:
    grammar = load("#ABNF 1.0;\nlanguage en;\npublic $a = x;\n$b = y;\n")
    with pytest.raises(GrammarError, match="no root"):
        grammar.match("x")
    assert grammar.rules == {"a": True, "b": False}
    assert grammar.rule("b").match("y") and not grammar.rule("b").match("x")
    assert load("#ABNF 1.0;\nlanguage en;\n$b = y;\n", rule="b").match("y")
    with pytest.raises(GrammarError, match='no rule "c"'):
        grammar.rule("c")


def test_media_types() -> None:
    assert supports("application/srgs+xml; charset=utf-8") and supports("application/srgs")
    assert not supports("application/x-jsgf")
    for kind in ("application/x-jsgf", "text/gsl", "application/x-nuance-gsl"):
        with pytest.raises(UnsupportedFormat):
            load(xml('<rule id="r">x</rule>'), type=kind)
    with pytest.raises(UnsupportedFormat):
        load(b";GSL2.0;\nX [a b]")
    with pytest.raises(UnsupportedBuiltIn):
        load("builtin:grammar/postcode")


def test_languages_that_are_not_taken() -> None:
    with pytest.raises(UnsupportedLanguage):
        load(xml('<rule id="r">x</rule>'), languages=lambda lang: lang == "ja")
    assert load(
        xml('<rule id="r">1</rule>', 'mode="dtmf"').replace('"r" ', '"r" '),
        languages=lambda lang: False,
    )


def test_encodings() -> None:
    text = '<?xml version="1.0" encoding="ISO-8859-1"?>' + xml('<rule id="r">café</rule>')
    for source in (text, text.encode("latin-1")):
        assert load(source).match("Café")
    abnf = "#ABNF 1.0 ISO-8859-1;\nlanguage fr;\nroot $r;\n$r = café;\n"
    assert load(abnf.encode("latin-1")).match("café")
    assert load(abnf.replace("ISO-8859-1", "ISO8859-1").encode("latin-1")).match("café")
    wide = abnf.replace("ISO-8859-1", "UTF-16")
    for encoding in ("utf-16", "utf-16-le", "utf-16-be"):
        assert load(wide.encode(encoding)).match("café")
    assert load(abnf.replace(" ISO-8859-1", "").encode("utf-8-sig")).match("café")
    with pytest.raises(GrammarError):
        load(abnf.replace("ISO-8859-1", "UTF-8").encode("latin-1"))


# Elements inside a document ---------------------------------------------------


def test_an_element_takes_language_and_mode_from_around_it() -> None:
    node = inside(
        '<grammar><rule id="any"><one-of><item>oui</item><item>si</item></one-of></rule></grammar>'
    )
    grammar = load(node, lang="fr")
    assert grammar.lang == "fr" and grammar.root == "any" and grammar.match("Oui!")
    keys = load(inside('<grammar mode="dtmf" root="k"><rule id="k">1 #</rule></grammar>'))
    assert keys.match("1#", mode="dtmf") and not keys.match("1#")


def test_an_element_of_the_namespace_of_srgs() -> None:
    assert load(
        inside(xml('<rule id="r">x</rule>', 'type="application/srgs+xml" scope="dialog"'))
    ).match("x")


def test_an_element_with_several_rules_and_no_root() -> None:
    two = '<grammar><rule id="a" scope="{}">x</rule><rule id="b">y</rule></grammar>'
    assert load(inside(two.format("public"))).match("x")
    with pytest.raises(GrammarError, match="no root"):
        load(inside(two.format("private"))).match("x")


def test_an_element_with_text_in_abnf() -> None:
    text = "<![CDATA[\n#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = yes<1-2>;\n]]>"
    assert load(inside(f'<grammar type="application/srgs">{text}</grammar>')).match("yes yes")
    assert load(inside(f"<grammar>{text}</grammar>")).match("yes")
    with pytest.raises(UnsupportedFormat):
        load(inside("<grammar><![CDATA[#JSGF V1.0;]]></grammar>"))


def test_problems_of_an_element_have_the_places_of_its_document() -> None:
    with pytest.raises(GrammarError) as error:
        load(
            inside(
                '<grammar root="a">\n <rule id="a">\n  <item repeat="x">y</item></rule></grammar>'
            )
        )
    (problem,) = error.value.problems
    assert problem.place == Place("page.vxml", 4, 17)


# Other documents --------------------------------------------------------------

FILES = {
    "http://x.org/g/cities.grxml": xml(
        '<rule id="r">Rome<tag>out = "FCO"</tag></rule>'
        '<rule id="far" scope="public">Lima<tag>out = {code: "LIM", zone: zone}</tag></rule>'
        '<rule id="own">Oslo</rule>',
        'tag-format="semantics/1.0"',
    ).replace("<rule", "<tag>var zone = 5</tag><rule", 1),
    "http://x.org/g/plain.gram": ABNF + "$r = here {there};\npublic $up = $<cities.grxml#far>;",
    "http://x.org/g/closed.gram": ABNF + "private $r = closed;",
    "http://x.org/g/self.gram": ABNF + "$r = x | $<self.gram#own> | $<self.gram>; $own = y;",
    "http://x.org/keys.gram": "#ABNF 1.0;\nmode dtmf;\nroot $r;\n$r = 1;",
    "http://x.org/g/rootless.gram": "#ABNF 1.0;\nlanguage en;\npublic $a = x;",
    "http://x.org/g/loop.gram": ABNF + "$r = x | $<other.gram> x;",
    "http://x.org/g/other.gram": ABNF + "$r = y | $<loop.gram> y;",
    "http://x.org/g/broken.gram": ABNF + "$r = ;",
    "http://x.org/g/gsl.gram": ";GSL2.0;",
    "http://x.org/g/odd.gram": SCRIPT
    + "public $r = none {out = undefined} | odd {!{out = [undefined, 0/0, -1/0, {n: null, f: isNaN}]}!}"
    " | twice $r {out = rules.r};\npublic $passed = $r;",
    "http://x.org/g/through.gram": ABNF + "public $r = $<odd.gram#passed>;",
}
asked: list[str] = []


def fetch(uri: str) -> bytes:
    asked.append(uri)
    return FILES[uri].encode()


def reaching(body: str, base: str = "http://x.org/g/main.gram") -> Grammar:
    return load(SCRIPT + body, base=base, fetch=fetch)


def test_rules_of_other_documents() -> None:
    grammar = reaching(
        "$r = to $<cities.grxml> {out.root = rules.r} or $<cities.grxml#far> {out.far = rules.far};"
    )
    (one,) = grammar.match("to rome or lima")
    assert one.interpretation == {"root": "FCO", "far": {"code": "LIM", "zone": 5}}


@pytest.mark.parametrize("uri", ["odd.gram", "odd.gram#passed", "through.gram"])
def test_values_of_other_documents_that_json_lacks(uri: str) -> None:
    grammar = reaching(
        f"$r = a $<{uri}> {{out = typeof rules.latest()}}"
        f" | b $<{uri}> {{var v = rules.latest(); out = [typeof v[0], '' + v[1], '' + v[2], v[3].n,"
        " 'f' in v[3], typeof v[3].f, v.length]}"
        f" | c $<{uri}>;"
    )
    expected = ["undefined", "NaN", "-Infinity", None, True, "undefined", 4]
    for twice in ("", "twice "):
        (one,) = grammar.match(f"a {twice}none")
        assert one.interpretation == "undefined"
        (one,) = grammar.match(f"b {twice}odd")
        assert one.interpretation == expected
    (one,) = grammar.match("c odd")
    assert one.interpretation == [None, None, None, {"n": None}]


@pytest.mark.parametrize(
    ("code", "seen"),
    [
        ("Symbol('x')", "undefined"),
        ("{toJSON: function () {}}", "undefined"),
        ("new Number(3)", "3"),
        ("new String('pizza')", '"pizza"'),
        ("{n: new Number(5), b: new Boolean(false)}", '{"n":5,"b":false}'),
        ('JSON.parse(\'{"__proto__":{"a":1},"b":2}\')', '{"__proto__":{"a":1},"b":2}'),
        ("{'\\0': 5}", '{"\\u0000":5}'),
    ],
)
def test_odd_values_of_other_documents(code: str, seen: str) -> None:
    other = f"{SCRIPT}$r = x {{!{{out = {code}}}!}};"
    grammar = load(
        SCRIPT + "$r = $<b> {out = '' + JSON.stringify(rules.latest())};",
        base="http://x.org/a",
        fetch=lambda _: other.encode(),
    )
    (one,) = grammar.match("x")
    assert (one.error, one.interpretation) == (None, seen)


@pytest.mark.parametrize(("greedy", "fits"), [(6, True), (0, False)])
def test_further_documents_have_less_memory_for_their_tags(greedy: int, fits: bool) -> None:
    eats = "var k = []; while (k.length < 3000) k.push('x'.repeat(1000) + k.length);"
    files = {
        f"http://x.org/{n}": f"{SCRIPT}$r = {f'$<{n + 1}>' if n < 6 else 'x'}"
        f" {{!{{{eats if n == greedy else ''} out = {n}}}!}};"
        for n in range(7)
    }
    grammar = load(
        files["http://x.org/0"], base="http://x.org/0", fetch=lambda uri: files[uri].encode()
    )
    (one,) = grammar.match("x")
    assert (one.interpretation, one.error is None) == ((0, True) if fits else (None, False))


def test_documents_of_several_formats_and_through_several() -> None:
    grammar = reaching(
        "$r = $<plain.gram#up> {out = rules.latest().code} | $<plain.gram>~<application/srgs>;"
    )
    assert grammar.match("lima")[0].interpretation == "LIM"
    assert grammar.match("here")[0].interpretation == "there"


def test_a_private_root_is_referred_to_without_its_name() -> None:
    assert reaching("$r = $<closed.gram>;").match("closed")


def test_a_document_that_refers_to_itself_by_its_uri() -> None:
    asked.clear()
    grammar = load(fetch("http://x.org/g/self.gram"), base="http://x.org/g/self.gram", fetch=fetch)
    assert grammar.match("y") and asked == ["http://x.org/g/self.gram"]
    assert reaching("$r = $<self.gram>;").match("y")


def test_every_document_is_fetched_once() -> None:
    asked.clear()
    assert reaching("$r = $<loop.gram> | $<other.gram> | $<loop.gram>;").match("x y x")
    assert sorted(asked) == ["http://x.org/g/loop.gram", "http://x.org/g/other.gram"]


def test_relative_references_keep_to_the_base() -> None:
    text = xml('<rule id="r"><ruleref uri="cities.grxml"/></rule>', 'xml:base="http://x.org/g/"')
    assert load(text, base="file:///home/a.grxml", fetch=fetch).match("rome")
    assert load(
        ABNF.replace("root", "base <g/>;\nroot", 1) + "$r = $<cities.grxml>;",
        base="http://x.org/m",
        fetch=fetch,
    ).match("rome")
    node = inside(
        '<grammar root="r" xml:base="g/"><rule id="r"><ruleref uri="cities.grxml#far"/></rule></grammar>'
    )
    assert load(node, base="http://x.org/page.vxml", fetch=fetch).match("lima")


def test_an_element_that_names_a_file() -> None:
    node = inside('<grammar src="g/cities.grxml"/>')
    assert load(node, base="http://x.org/p.vxml", fetch=fetch).match("rome")
    far = inside('<grammar src="g/cities.grxml#far" type="application/srgs+xml"/>')
    assert load(far, base="http://x.org/p.vxml", fetch=fetch).match("lima")
    for src, code in (
        ("g/cities.grxml#own", "private-rule"),
        ("g/cities.grxml#gone", "no-such-rule"),
        ("g/rootless.gram", "no-root"),
        ("g/missing.gram", "no-such-file"),
    ):
        with pytest.raises(GrammarError) as error:
            load(inside(f'<grammar src="{src}"/>'), base="http://x.org/p.vxml", fetch=fetch)
        assert codes(error) == [code]


@pytest.mark.parametrize(
    ("uri", "code"),
    [
        ("cities.grxml#own", "private-rule"),
        ("closed.gram#r", "private-rule"),
        ("cities.grxml#FAR", "no-such-rule"),
        ("#r2", "no-such-rule"),
        ("cities.grxml#gone", "no-such-rule"),
        ("rootless.gram", "no-root"),
        ("missing.gram", "no-such-file"),
        ("broken.gram", "not-abnf"),
        ("../keys.gram", "mode"),
        ("gsl.gram", "format"),
    ],
)
def test_references_that_lead_to_no_rule(uri: str, code: str) -> None:
    with pytest.raises(GrammarError) as error:
        reaching(f"$r = $<{uri}>;")
    assert codes(error) == [code]


@pytest.mark.parametrize(
    "source",
    [
        ABNF + "$r = $<http://[x>;",
        ABNF + "base <http://[x>; $r = $<a>;",
        xml('<rule id="r"><ruleref uri="a"/></rule>', 'xml:base="http://[x"'),
        inside('<grammar src="http://[x"/>'),
        inside('<grammar xml:base="http://[x"><rule id="r">a</rule></grammar>'),
    ],
)
def test_what_is_no_uri(source: str | Node) -> None:
    with pytest.raises(GrammarError) as error:
        load(source, base="http://x.org/a", fetch=fetch)
    assert codes(error) == ["bad-value"]


def test_a_file_without_a_namespace_is_taken_where_that_is_wanted() -> None:
    text = xml('<rule id="r">a</rule>').replace(f' xmlns="{SRGS}"', "")
    assert load(text, lenient=True).match("a")
    with pytest.raises(GrammarError):
        load(text)


def test_documents_without_end() -> None:
    def endless(uri: str) -> bytes:
        number = int(uri.rpartition("/")[2]) + 1
        return f"{ABNF}$r = x | $<http://x.org/{number}>;".encode()

    with pytest.raises(GrammarError, match="more than 64 documents"):
        load(ABNF + "$r = $<http://x.org/1>;", fetch=endless)


# Whether more may follow -------------------------------------------------------


def test_whether_more_keys_may_follow() -> None:
    grammar = load("#ABNF 1.0;\nmode dtmf;\nroot $r;\n$r = 1 2 3 | 4 [5] | (6|7)<2-3>;")
    more = [
        keys
        for keys in ("", "1", "12", "4", "6", "66")
        if grammar.accepts_prefix(keys, mode="dtmf")
    ]
    none = [
        keys
        for keys in ("123", "45", "666", "9", "13")
        if grammar.accepts_prefix(keys, mode="dtmf")
    ]
    assert more == ["", "1", "12", "4", "6", "66"] and none == []
    digits = load("builtin:dtmf/digits?maxlength=3")
    assert digits.accepts_prefix("12", mode="dtmf") and not digits.accepts_prefix(
        "123", mode="dtmf"
    )


def test_whether_more_words_may_follow() -> None:
    grammar = load(
        xml('<rule id="r">go to <one-of><item>New York</item><item>Rome</item></one-of></rule>')
    )
    assert [grammar.accepts_prefix(said) for said in ("go", "go to new", "go to rome", "stop")] == [
        True,
        True,
        False,
        False,
    ]


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
        case model.Choice(parts=parts):
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
    check = IsolatedSandbox.fault

    def noted(sandbox: IsolatedSandbox, code: str) -> str:
        checked.append(code)
        return check(sandbox, code)

    monkeypatch.setattr(IsolatedSandbox, "fault", noted)
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


# Media types --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "kind", "form"),
    [("g.gram", "application/srgs+xml", "ABNF"), ("g.grxml", "application/srgs", "XML")],
)
def test_a_type_that_contradicts_the_form_is_refused_where_it_stands(
    file: str, kind: str, form: str
) -> None:  # SRGS 2.2.2
    files = {"g.gram": f"{ABNF}public $r = x;", "g.grxml": xml('<rule id="r">x</rule>')}
    right = {"ABNF": "application/srgs", "XML": "application/srgs+xml"}[form]

    def fetch(uri: str) -> bytes:
        return files[uri].encode()

    def problem(*given: object, **options: object) -> str:
        with pytest.raises(GrammarError) as caught:
            load(*given, fetch=fetch, **options)  # type: ignore[arg-type]
        (one,) = caught.value.problems
        return str(one)

    told = (
        f'error: The type "{kind}" contradicts "{file}", which is in the {form} form.'
        f" Write {right}, or leave the type out. [format]"
    )
    assert problem(files[file], base=file, type=kind).endswith(told)
    assert problem(f"{ABNF}$r = a\n| $<{file}>~<{kind}>;", base="a.gram") == f"a.gram:5:3: {told}"
    both = f"{ABNF}$r = $<{file}>~<{right}> $<{file}>~<{kind}>;"  # fetched once, checked twice
    assert problem(both, base="a.gram").endswith(told)
    node = inside(f'<grammar src="{file}" type="{kind}"/>')
    assert problem(node) == f"{node.attribute_place('src')}: {told}"
    inline = files[file] if form == "XML" else f"<grammar><![CDATA[{files[file]}]]></grammar>"
    node = inside(inline.replace("<grammar", f'<grammar type="{kind}"', 1))
    assert "contradicts this grammar, which is in the" in problem(node)


def test_a_type_in_use_that_is_none_of_srgs_is_taken_with_a_warning() -> None:
    def fetch(uri: str) -> bytes:
        return f"{ABNF}public $r = x;".encode()

    kind = "application/abnf"
    for grammar in (
        load(f"{ABNF}$r = x;", type=kind),
        load(f"{ABNF}$r = $<b.gram>~<{kind}>;", base="a.gram", fetch=fetch),
        load(inside(f'<grammar src="b.gram" type="{kind}"/>'), fetch=fetch),
        load(inside(f'<grammar type="{kind}"><![CDATA[{ABNF}$r = x;]]></grammar>')),
    ):
        (warning,) = grammar.warnings()
        assert (warning.severity, warning.code) == ("warning", "format")
        assert "read as application/srgs. Write application/srgs." in str(warning)
        assert grammar.match("x")
    assert not load(f"{ABNF}$r = x;", type="application/srgs").warnings()


# Names in tags ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        ("$r = a {out = nothing};", ["nothing"]),
        ("$r = a {out = nope(1)};", ["nope"]),
        ("$r = a {out = session.id};", ["session"]),
        ("$r = $s {out = rules.t}; $s = a;", ["rule t"]),
        ("$r = $s {out = meta.t.text}; $s = a;", ["rule t"]),
        ("$r = $s {out = rules.s + meta.s.text + rules.latest()}; $s = a;", []),
        ("$r = $s {out = other}; $s = a {other = 1};", []),
        ("$r = a {var n = 1} {out = n; out.text = 'nothing'; /* nope */};", []),
        ("$r = a {out = Math.max(1, 2) + meta.current().text};", []),
        ("$r = a {out = typeof nothing};", []),
        ("$r = a {!{let f = function (x) { return x; }; out = f(2)}!};", []),
        ("$r = $<builtin:grammar/boolean> {out = rules.boolean};", []),
    ],
)
def test_names_that_no_tag_knows_are_told(rules: str, told: list[str]) -> None:
    warnings = load(SCRIPT + rules, base="g.gram").warnings()
    assert [
        one.message.split('"')[1]
        if "which nothing" in one.message
        else f"rule {one.message.split(chr(34))[1]}"
        for one in warnings
    ] == told
    codes = {"rule t": "no-such-rule"}
    assert [one.code for one in warnings] == [codes.get(one, "undeclared-variable") for one in told]
    assert all(one.place.file == "g.gram" and one.place.column > 1 for one in warnings)


def test_tags_of_the_header_give_names_to_those_of_rules() -> None:
    text = SCRIPT + "{!{function twice(x) { return 2 * x; }}!};\n$r = a {out = twice(2)};"
    assert not load(text).warnings()
    assert [one.code for one in load(text.replace("= twice", "= twcie")).warnings()] == [
        "undeclared-variable"
    ]


def test_tags_of_other_formats_have_no_names() -> None:
    assert not load(f"{ABNF}$r = a {{nothing}};").warnings()
    assert not load(f"{ABNF}$r = a {{city='Rome'; n=Rome}};").warnings()
    (warning,) = load(f"{ABNF}$r = $s {{$.x = $t}}; $s = a;").warnings()
    assert warning.code == "no-such-rule"


# What an audit found ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rules", "said", "value"),
    [
        ("$r = a {out=0} ([b] {out++})<3>;", "a", 3),
        ("$r = a {out=0} ([b] {out++})<3>;", "a b", 3),
        ("$r = a {out=0} ([b] {out++})<3>;", "a b b b", 3),
        ("$r = a {out=0} {out++}<3>;", "a", 3),
        ("$r = a {out=0} ([b] {out++})<2->;", "a", 2),
        ("$r = a {out=0} ([b] {out++})<0-3>;", "a", 0),
        ("$r = a {out=[]} ($e {out.push(rules.e)})<2>; $e = [x] {out=1};", "a x", [1, 1]),
        ("$r = {out=0} ([b] {out++})<1000000>;", "", 1),  # so many are one
    ],
)
def test_repeats_of_nothing_run_their_tags_as_often_as_is_needed(
    rules: str, said: str, value: object
) -> None:  # SRGS 2.5
    assert load(SCRIPT + rules).match(said)[0].interpretation == value


def test_a_reference_out_of_the_folder_is_not_one_into_it() -> None:  # RFC 2396, 5.2
    asked = []

    def fetch(uri: str) -> bytes:
        asked.append(uri)
        raise LookupError("it is not here")

    for uri in ("../b.gram", "../../b.gram#r", "c/../../b.gram"):
        with pytest.raises(GrammarError):
            load(f"{ABNF}$r = $<{uri}>;", base="a/a.gram", fetch=fetch)
    assert asked == ["b.gram", "../b.gram", "b.gram"]
    with pytest.raises(GrammarError):
        load(f"{ABNF}$r = $<b.gram>;", base="d/page.vxml?path=/a/b", fetch=fetch)
    assert asked[-1] == "d/b.gram"


@pytest.mark.parametrize("encoding", ["ISO-8859-1", "windows-1252", "UTF-16", "Shift_JIS", "utf-8"])
def test_a_text_has_no_encoding_whatever_its_header_says(encoding: str) -> None:
    text = f"#ABNF 1.0 {encoding};\nlanguage en;\nroot $r;\n$r = café;"
    assert load(text).match("café")


@pytest.mark.parametrize(
    ("data", "place"),
    [
        (b"#ABNF 1.0 UTF-8;\rlanguage en;\rroot $r;\r$r = caf\xe9;", "4:9"),
        ("#ABNF 1.0;\r\n$r = été ".encode() + b"\xe9;", "2:10"),
        (b"\xef\xbb\xbf" + "#ABNF 1.0; // é".encode() + b"\xff", "1:16"),
        (b'<grammar root="r">\r<rule id="caf\xc3\xa9\xe9"/></grammar>', "2:15"),
    ],
)
def test_a_byte_that_is_none_is_told_with_its_place_and_a_remedy(data: bytes, place: str) -> None:
    with pytest.raises(GrammarError) as caught:
        load(data, base="a.gram")
    (problem,) = caught.value.problems
    assert (str(problem.place), bool(problem.remedy)) == (f"a.gram:{place}", True)
    assert problem.message == "A byte here is not UTF-8."


def test_what_stands_inside_of_words_does_not_cut_them() -> None:
    grammar = load(ABNF + "$r = cooperate;")
    assert grammar.match("co\u00adoperate") and grammar.match("co\u200doperate")
    assert load(ABNF + "$r = turn left;").match("turn\u200bleft")  # a space without width


def test_places_of_inline_abnf_are_those_of_the_document() -> None:  # which begins in line 1
    node = inside(
        '<grammar type="application/srgs"><![CDATA[\n#ABNF 1.0;\n\nlanguage en;\n'
        "tag-format <semantics/1.0>;\nroot $r;\n$r = a {nope()} | $b;\n]]></grammar>"
    )
    with pytest.raises(GrammarError) as caught:
        load(node)
    assert [str(one.place) for one in caught.value.problems] == ["page.vxml:8:19"]
    source = node.source.text.replace(" | $b", "")
    grammar = load(parse("page.vxml", source.encode()).nodes[0])
    error = grammar.match("a")[0].error
    assert error is not None and str(error.place) == "page.vxml:8:8"


@pytest.mark.parametrize(
    ("content", "code", "place"),
    [
        ("one\n two\n  &#34;three", "bad-token", "g:2:1"),  # a reference cannot be found again
        ('one\n two\n  "three', "bad-token", "g:4:3"),
        ("<one-of>\n  <item>a</item> stray</one-of>", "stray-text", "g:3:18"),
    ],
)
def test_what_is_wrong_with_a_text_is_told_where_it_stands(
    content: str, code: str, place: str
) -> None:
    with pytest.raises(GrammarError) as caught:
        load(xml(f'\n<rule id="r">{content}</rule>'), base="g")
    (problem,) = caught.value.problems
    assert problem.code == code
    assert str(problem.place) == place


@pytest.mark.parametrize(
    ("tag", "warned"),
    [("out = = 1", True), ("out = 1", False), ("$.a = {", True), ("$.a = 'b'", False)],
)
def test_tags_that_are_no_script_are_warned_of(tag: str, warned: bool) -> None:
    for head in (SCRIPT, ABNF):
        found = load(f"{head}$r = x {{!{{{tag}}}!}};").warnings()
        assert [one.code for one in found] == ["bad-expression"] * warned


def test_tags_are_told_the_time_that_is_given() -> None:
    grammar = load(
        f"{SCRIPT}$r = today {{!{{out = new Date().toISOString()}}!}}"
        " | years since 1969 {!{out = new Date().getUTCFullYear() - 1969}!};"
    )
    (today,) = grammar.match("today", now=1_109_671_200_000)
    assert today.interpretation == "2005-03-01T10:00:00.000Z"
    assert grammar.match("years since 1969")[0].interpretation == 1
