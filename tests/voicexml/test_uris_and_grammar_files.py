"""Invalid URIs, and grammars in files with a language or a scope."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.loading import validate
from tests.helpers.dialogs import GRAMMAR, ask
from tests.helpers.old_documents import run
from tests.helpers.validating import told
from tests.helpers.voice import Call


@pytest.mark.parametrize("uri", ["http://[x", "http://[x#y", "http://[x]:a/b?c=d#e", "//\u2100/x"])
@pytest.mark.parametrize(
    "body",
    [
        '<form><block><goto next="{}"/></block></form>',
        "<form><block><submit expr=\"'{}'\"/></block></form>",
        '<form><subdialog src="{}"/></form>',
        '<form><block><data name="d" src="{}"/></block></form>',
        '<form><block><script src="{}"/></block></form>',
        '<form xml:base="{0}"><block><audio src="{0}"/><goto next="x.vxml"/></block></form>',
        '<form><field name="f"><grammar src="{}"/></field></form>',
    ],
)
def test_a_uri_that_is_none(tmp_path: Path, body: str, uri: str) -> None:
    """It cannot be fetched, whoever names it."""
    transcript = run(tmp_path, body.format(uri))
    [failure] = transcript.failures
    assert "app: error." in failure and "app.vxml:1" in failure


@pytest.mark.parametrize("written", ['src=""', 'src=" "', "srcexpr=\"''\"", "srcexpr=\"' '\""])
def test_a_grammar_of_an_empty_uri_is_told_to_lack_it(written: str) -> None:
    failed = '<catch event="error.badfetch"><log><value expr="_message"/></log><exit/></catch>'
    [told] = Call(failed + ask(f"<grammar {written}/>")).logs()
    assert told.endswith("the URI is missing")


def test_an_audio_of_null_plays_its_content() -> None:
    call = Call(
        '<form><block><audio expr="null">A</audio><audio expr="undefined">B</audio></block></form>'
    )
    assert call.play() == ["A"]


def test_an_external_grammar_without_a_language_has_the_documents(tmp_path: Path) -> None:
    grammar = (
        '<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
        '<rule id="r">tea</rule></grammar>'
    )
    field = '<form><field name="a"><prompt>What?</prompt><grammar src="g.grxml"/></field></form>'
    call = Call(field, **{"g.grxml": grammar})
    call.answer("tea")
    assert call.ended == "exit"
    (tmp_path / "g.grxml").write_text(grammar)
    (one,) = told(tmp_path, field)
    assert one.startswith("g.grxml missing-attribute A grammar for voice says its language.")


def test_a_grammar_in_a_file_may_have_a_scope() -> None:
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><grammar src="g.grxml"/>
        <filled><log expr="f"/></filled></field></form>""",
        **{
            "g.grxml": '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
            ' xml:lang="en" root="r" scope="document"><rule id="r">tea</rule></grammar>'
        },
    )
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_rule_may_be_named_with_percent_signs() -> None:
    text = ask('<grammar src="g.grxml#r%31"/>')
    held = f'<grammar {GRAMMAR} xml:lang="en"><rule id="r1" scope="public">tea</rule></grammar>'
    call = Call(text, **{"g.grxml": held})
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_scope_in_a_grammar_s_file_is_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "g.grxml"
    path.write_text(
        '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"'
        ' root="r" scope="document"><rule id="r">tea</rule></grammar>'
    )
    [told] = validate([path])
    assert str(told) == (
        f"{path}:1:96: warning: scope has no effect in a grammar's file. Write it where VoiceXML"
        " names the file. [unknown-attribute]"
    )
