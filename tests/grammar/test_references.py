"""Grammars that refer to rules of other documents (SRGS 2.2)."""

from __future__ import annotations

import pytest

from prima.grammar import (
    Grammar,
    GrammarError,
    load,
)
from prima.markup.tree import Node
from tests.helpers.grammars import ABNF, SCRIPT, SRGS, asked, codes, fetch, inside, xml


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


@pytest.mark.parametrize(("greedy", "fits"), [(0, True), (6, False)])
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
    ("other", "remedy"),
    [
        (ABNF + "$r = a; $p = b;", 'Write "public $p = ...;" there.'),
        (xml('<rule id="r">a</rule><rule id="p">b</rule>'), 'Write scope="public" there.'),
    ],
    ids=["abnf", "xml"],
)
def test_a_rule_is_made_public_as_its_form_has_it(other: str, remedy: str) -> None:
    for text in (ABNF + "$r = $<b#p>;", xml('<rule id="r"><ruleref uri="b#p"/></rule>')):
        with pytest.raises(GrammarError) as error:
            load(text, fetch=lambda _: other.encode())
        assert [problem.remedy for problem in error.value.problems] == [remedy]


@pytest.mark.parametrize(
    ("text", "root"),
    [
        ("#ABNF 1.0;\nlanguage en;\n$a = x;", '"root $name;"'),
        (xml('<rule id="a">x</rule>').replace(' root="r"', ""), 'root="..."'),
    ],
    ids=["abnf", "xml"],
)
def test_a_root_is_written_as_the_form_has_it(text: str, root: str) -> None:
    with pytest.raises(GrammarError) as error:
        load(text).match("x")
    assert [problem.remedy for problem in error.value.problems] == [
        f'Write {root}, or name a rule: grammar.rule("...").'
    ]


@pytest.mark.parametrize(
    ("uri", "remedy"),
    [
        ("cities.grxml#FAR", 'Did you mean "far"?'),
        ("cities.grxml#gone", "Write far."),
        ("#gone", "Write r."),
    ],
)
def test_what_to_write_for_an_unknown_rule(uri: str, remedy: str) -> None:
    """Rules that are private to another document are not named."""
    with pytest.raises(GrammarError) as error:
        reaching(f"$r = $<{uri}>;")
    assert [problem.remedy for problem in error.value.problems] == [remedy]


@pytest.mark.parametrize(
    ("header", "uri"),
    [(ABNF, "builtin:dtmf/digits?length=2"), (ABNF + "mode dtmf; ", "builtin:grammar/digits")],
)
def test_a_built_in_type_of_the_other_mode_is_refused(header: str, uri: str) -> None:  # SRGS 4.6
    with pytest.raises(GrammarError) as error:
        load(f"{header}$r = $<{uri}>;")
    assert codes(error) == ["mode"]
    assert load(f"{header}$r = $<builtin:digits>;")


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


@pytest.mark.parametrize(
    "text",
    [
        ABNF.replace("language en;\n", "") + "$r = a;",
        xml('<rule id="r">a</rule>').replace(' xml:lang="en"', ""),
    ],
    ids=["abnf", "xml"],
)
def test_a_file_without_a_language_has_the_given_one_where_that_is_wanted(text: str) -> None:
    grammar = load(text, lang="fr", lenient=True)
    assert grammar.match("a") and grammar.lang == "fr"
    assert [one.code for one in grammar.warnings()] == ["missing-attribute"]
    with pytest.raises(GrammarError) as error:
        load(text)
    assert codes(error) == ["missing-attribute"]


def test_documents_without_end() -> None:
    def endless(uri: str) -> bytes:
        number = int(uri.rpartition("/")[2]) + 1
        return f"{ABNF}$r = x | $<http://x.org/{number}>;".encode()

    with pytest.raises(GrammarError, match="more than 64 documents"):
        load(ABNF + "$r = $<http://x.org/1>;", fetch=endless)


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
