"""The grammar engine: matches, languages, encodings, elements inside a document."""

from __future__ import annotations

import pytest

from prima.errors import Place
from prima.grammar import (
    GrammarError,
    UnsupportedBuiltIn,
    UnsupportedFormat,
    UnsupportedLanguage,
    load,
    supports,
)
from prima.markup.reader import parse
from tests.helpers.grammars import ABNF, SCRIPT, inside, xml


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


@pytest.mark.parametrize(
    ("rules", "said", "weight", "confidence"),
    [
        ("$r = (/0.5/ $r | a) | $GARBAGE;", "a", 1, 1),
        ("$r = $s | $GARBAGE; $s = $r | $t; $t = $s $NULL | a;", "a", 1, 1),
        ("$r = a | (/0.5/ a | $r);", "a", 1, 1),
        ("$r = /0.5/ $r | (/2/ a | /0.5/ a);", "a", 1, 1),
        ("$r = a $t $GARBAGE; $t = ($t | /2/ b $t) | /0.1/ c | $s; $s = [$t] c;", "a b c", 1, 1),
        ("$r = [$r] $GARBAGE [$r] tea;", "some green tea", 1, 0.667),
    ],
)
def test_the_best_way_is_found_where_rules_contain_themselves(
    rules: str, said: str, weight: float, confidence: float
) -> None:
    (one,) = load(ABNF + rules).match(said)
    assert (one.weight, one.confidence) == (weight, confidence)


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


@pytest.mark.parametrize("blank", [" ", "\n"])
def test_places_count_the_declared_encoding_of_a_text(blank: str) -> None:
    declared = f'<?xml version="1.0"{blank}encoding="ISO-8859-1"?>'
    text = declared + xml('<rule id="r">x</rule>').replace('root="r"', 'root="q"')
    for source in (text, text.encode()):
        with pytest.raises(GrammarError) as caught:
            load(source, base="g")
        lines = text.splitlines()
        column = lines[-1].index('root="q"') + len('root="') + 1
        assert str(caught.value.problems[0].place) == f"g:{len(lines)}:{column}"


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


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("#ABNF 1.0;\nlanguage en;\nroot $r;\ntag-format <foo/1.0>;\n$r = a {x};\n", (4, 12)),
        (xml("<rule id='r'>a<tag>x</tag></rule>", '\n tag-format="foo/1.0"'), (2, 14)),
    ],
    ids=["ABNF", "XML"],
)
def test_an_unknown_tag_format_is_told_where_it_is_declared(
    text: str, place: tuple[int, int]
) -> None:
    with pytest.raises(UnsupportedFormat) as error:
        load(text)
    (one,) = error.value.problems
    assert (one.place.line, one.place.column) == place


def test_problems_of_an_element_have_the_places_of_its_document() -> None:
    with pytest.raises(GrammarError) as error:
        load(
            inside(
                '<grammar root="a">\n <rule id="a">\n  <item repeat="x">y</item></rule></grammar>'
            )
        )
    (problem,) = error.value.problems
    assert problem.place == Place("page.vxml", 4, 17)


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
    answer = load("builtin:dtmf/boolean?y=*")
    assert [answer.accepts_prefix(keys, mode="dtmf") for keys in ("", "*", "2")] == [
        True,
        False,
        False,
    ]


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


@pytest.mark.parametrize("header", ["#ABNF 1.0 klingon;", "#ABNF\t 1.0 klingon ;"])
def test_an_encoding_that_is_not_accepted_is_told_where_it_is_named(header: str) -> None:
    with pytest.raises(GrammarError) as caught:  # SRGS 4.4
        load(f"{header}\nlanguage en;\n$r = caf\xe9;\n".encode("latin-1"), base="a.gram")
    (problem,) = caught.value.problems
    assert str(problem.place) == f"a.gram:1:{header.index('klingon') + 1}"


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
