"""Grammars in both forms, as the tests of the engine write them."""

from __future__ import annotations

import pytest

from prima.grammar import (
    GrammarError,
)
from prima.markup.reader import parse
from prima.markup.tree import Node

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
