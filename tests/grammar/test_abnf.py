"""Errors in grammars in the ABNF form: place, message and remedy of each."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from prima.grammar import GrammarError, load

HEAD = "#ABNF 1.0;\nlanguage en;\nroot $r;\n"
TOKEN = "Expected a token, or () for nothing."
DECLARATION = "Expected a declaration such as root $name; or a rule such as $name = ...;."


def problems(text: str) -> list[tuple[int, int, str, str]]:
    with pytest.raises(GrammarError) as caught:
        load(text)
    return [
        (one.place.line, one.place.column, one.message, one.remedy) for one in caught.value.problems
    ]


@pytest.mark.parametrize(
    ("text", "line", "column", "found", "remedy"),
    [
        (HEAD + "$r = a | ;", 4, 10, ";", TOKEN),
        (HEAD + "$r = a\n   |\n /* b */ | c;", 6, 10, "| c;", TOKEN),
        (HEAD + "$r = (a | [b);", 4, 13, ");", 'Expected "]".'),
        (HEAD + "$r = (a;", 4, 8, ";", 'Expected ")".'),
        (HEAD + "$r = a<2><3>;", 4, 10, "<3>;", 'Expected ";".'),
        (HEAD + "$r a;", 4, 4, "a;", 'Expected "=".'),
        (HEAD + "$r = a; b = c;", 4, 9, "b = c;", "Expected a rule, $name = ...;."),
        (
            HEAD + "$r = a; mode voice;",
            4,
            9,
            "mode voice;",
            "Expected a rule, $name = ...;. Declarations come before all rules.",
        ),
        (HEAD + "import <a>; $r = a;", 4, 1, "import <a>; $r = a;", DECLARATION),
        (HEAD + "languages en; $r = a;", 4, 1, "languages en; $r = a", DECLARATION),
        (
            HEAD + "meta a is b; $r = a;",
            4,
            6,
            "a is b; $r = a;",
            "Expected a text in quotes.",
        ),
        (HEAD + "meta 'a' 'b'; $r = a;", 4, 10, "'b'; $r = a;", "Expected the word is."),
        (
            HEAD + "tag-format x; $r = a;",
            4,
            12,
            "x; $r = a;",
            "Expected a URI in angle brackets, <uri>.",
        ),
        (
            HEAD + "$r = a + b;",
            4,
            8,
            "+ b;",
            'Write <1-> for once or more; a sign that is said, in quotes: "+".',
        ),
        (
            HEAD + "$r = a {x}y};",
            4,
            12,
            "};",
            "A tag that holds a } itself is written {!{ ... }!}.",
        ),
        (
            HEAD + "$r = $s<2>!en; $s = a;",
            4,
            11,
            "!en; $s = a;",
            "A language is allowed only after a token, a rule or a bracket, before its repeat:"
            " oui!fr<2>.",
        ),
        (
            HEAD + '$r = "a b;',
            4,
            6,
            '"a b;',
            'A quote is opened and not closed: write the other ".',
        ),
        (
            HEAD + "$r = a /* b;",
            4,
            8,
            "/* b;",
            "A comment or a weight is not closed: /* ... */, /0.5/.",
        ),
    ],
)
def test_what_cannot_stand_where_it_stands(
    text: str, line: int, column: int, found: str, remedy: str
) -> None:
    assert problems(text) == [(line, column, f'"{found}" is not allowed here.', remedy)]


@pytest.mark.parametrize("end", ["", "  \n", " | // b"])
def test_a_text_that_ends_too_early(end: str) -> None:
    text = HEAD + "$r = a" + end
    column = len(f"$r = a{end}".rstrip()) + 1
    remedy = TOKEN if "|" in end else 'Expected ";".'
    assert problems(text) == [(4, column, "The grammar ends too early.", remedy)]


def test_what_is_wrong_comes_in_order_with_what_ends_the_reading() -> None:
    told = problems(HEAD + "$r = /x/ a<2-1>!en;\n$s = b;")
    assert [(line, column) for line, column, _, _ in told] == [(4, 6), (4, 11), (4, 16)]


def test_brackets_are_nested_up_to_their_limit() -> None:
    assert load(f"{HEAD}$r = {'(' * 100}a{')' * 100};").match("a")
    ((line, column, message, _),) = problems(f"{HEAD}$r = {'[' * 101}a{']' * 101};")
    assert (line, column, message) == (4, 106, "Brackets are nested more than 100 deep.")


def test_grammars_are_read_in_several_threads_at_once() -> None:
    def read(number: int) -> object:
        words = " | ".join(f"w{number}x{one}" for one in range(300))
        return load(f"{HEAD}$r = {words};").match(f"w{number}x299")[0].interpretation

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(read, range(12))) == [f"w{number}x299" for number in range(12)]


def test_the_parser_is_made_for_abnf_alone() -> None:
    xml = '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r">'
    xml += '<rule id="r">a</rule></grammar>'
    code = f"import sys\nfrom prima.grammar import load\nload({xml!r})\nassert 'lark' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_line_that_goes_on_after_the_header_is_told_where_it_does() -> None:  # SRGS 4.1
    told = (1, 11, "The line goes on after the header.", 'Put a line end after "#ABNF 1.0;".')
    assert problems("#ABNF 1.0; language en;\nroot $r;\n$r = a;") == [told]


@pytest.mark.parametrize("header", ["#ABNF 1.0", "#ABNF 1.0 ISO-8859-1"])
def test_a_header_without_its_semicolon_is_told_with_it(header: str) -> None:  # SRGS 4.1
    why = "The header of the ABNF form does not end with a semicolon."
    assert problems(f"{header} \nroot $r;\n$r = a;") == [(1, 1, why, f'Write "{header};".')]


@pytest.mark.parametrize(
    "text",
    [
        "language en;\nroot $r;\n$r = a;",
        "// towns\n/* all */ root $r;\n$r = a;",
        "$r = a;",
        "public $r = a;",
        "ABNF 1.0;\n$r = a;",
        "#abnf",
    ],
)
@pytest.mark.parametrize("kind", ["", "application/srgs"])
def test_abnf_without_its_header_is_told_which_to_write(text: str, kind: str) -> None:
    if text == "#abnf" and not kind:
        return
    with pytest.raises(GrammarError) as caught:
        load(text, base="g/towns.gram", type=kind)
    assert [str(one) for one in caught.value.problems] == [
        "g/towns.gram:1:1: error: The header of the ABNF form is missing."
        ' Begin with "#ABNF 1.0 UTF-8;" in the first line. [not-abnf]'
    ]


@pytest.mark.parametrize(
    ("text", "why", "remedy"),
    [
        ("$r = a?;", '"a?" has a question mark, which is reserved after an expansion.', "<0-1>"),
        ("$r = $s?; $s = a;", '"$s?" has a question mark', "<0-1>"),
        ("$r = a*;", '"*;" is not allowed here.', "<0->"),
        ("$r = a+;", '"+;" is not allowed here.', "<1->"),
    ],
)
def test_signs_of_other_languages_are_told_with_what_to_write(
    text: str, why: str, remedy: str
) -> None:
    (_, _, message, wanted), *_ = problems(HEAD + text)
    assert message.startswith(why) and remedy in wanted
