"""The media types of grammars."""

from __future__ import annotations

import pytest

from prima.grammar import (
    GrammarError,
    UnsupportedFormat,
    load,
)
from tests.helpers.grammars import ABNF, inside, xml


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


def test_a_type_that_is_not_supported_is_told_at_each_reference_that_gives_it() -> None:
    def fetch(uri: str) -> bytes:
        return f"{ABNF}public $r = x;".encode()

    told = 'error: Grammars of type "a/b" are not supported.'
    for rule in ("$r = $<b.gram>~<a/b>;", "$r = $<b.gram> | $<b.gram>~<a/b>;"):
        with pytest.raises(UnsupportedFormat) as caught:
            load(ABNF + rule, base="a.gram", fetch=fetch)
        (one,) = caught.value.problems
        assert str(one).startswith(f"a.gram:4:{rule.rindex('$') + 1}: {told}")
