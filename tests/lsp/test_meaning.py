"""Hover, symbols, links and quick fixes in an editor."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types as lsp

from prima.lsp.descriptions import RULES, VOICEXML_ATTRIBUTES
from prima.lsp.problems import check
from prima.lsp.tables import VOCABULARIES
from prima.lsp.workspace import Workspace
from tests.helpers.editor import BEGIN, SCENE, VOICE, Editor, cut, edited, plain


# Meaning -----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("fa/x.xml", BEGIN + '<form id="a"><bl|ock/></form>', ["Content that runs once", "O4"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block></bl|ock></form>', ["Content that runs once"]),
        ("fa/x.xml", BEGIN + '<form id="a"><i|u><block/></iu></form>', ["Information Unit", "**U5**"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block><turn an|gle="2"/>', ["counter-clockwise", "-360"]),
        ("fa/x.xml", BEGIN + '<form id="a"><block><turn angle-ex|pr="2"/>', ["expression that gives angle"]),
        ("fa/x.xml", BEGIN + '<form id="a"><var name="n" expr="7"/><block cond="|n"/>', ["of the form `a`", 'expr="7"']),
        ("ea/guide.xml", BEGIN + '<form id="a"><block><topological-move to="kido|de-room"/>', ["place `kidode-room`", "office.xml"]),
        ("scenarios/x.xml", SCENE + '<when doing="sp|eak"/>', ["Says its text", "speaker"]),
        ("fa/x.xml", BEGIN + '<form id="a"><on event="human.l|ost"/>', ["out of sight"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><go|to next="#a"/>', ["VoiceXML 5.3.7"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><prompt barge|in="true"/>', ["before it ends"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><p:turn an|gle="1"/>', ["counter-clockwise"]),
        ("ea/x.vxml", VOICE + '<form id="a"><p:i|u>', ["around form items", "rule U5"]),
        ("ea/x.vxml", VOICE + '<form id="a"><block><p:i|u>', ["around Commands", "rule U4"]),
    ],
)  # fmt: skip
def test_hover(editor: Editor, name: str, text: str, words: list[str]) -> None:
    where = editor.at(name, text)
    found = editor.do(editor.client.text_document_hover_async(lsp.HoverParams(*where)))
    editor.close(name)
    assert found is not None and isinstance(found.contents, lsp.MarkupContent)
    for word in words:
        assert word in found.contents.value


def test_symbols_links_and_pairs_of_tags(editor: Editor) -> None:
    editor.open("fa/follow.xml")
    file = lsp.TextDocumentIdentifier(editor.uri("fa/follow.xml"))
    found = editor.do(
        editor.client.text_document_document_symbol_async(lsp.DocumentSymbolParams(file))
    )
    assert found is not None
    (root,) = found
    assert isinstance(root, lsp.DocumentSymbol) and root.name == "follow"
    forms = [one for one in root.children or () if one.detail == "form"]
    assert len(forms) > 1 and forms[0].children
    editor.close("fa/follow.xml")

    editor.open("scenarios/touched-on-the-way.xml")
    scene = lsp.TextDocumentIdentifier(editor.uri("scenarios/touched-on-the-way.xml"))
    targets = editor.do(
        editor.client.text_document_document_link_async(lsp.DocumentLinkParams(scene))
    )
    assert {Path(str(one.target)).name for one in targets or ()} >= {"office.xml", "follow.xml"}
    editor.close("scenarios/touched-on-the-way.xml")

    text = BEGIN + '<form id="a"><bl|ock><exit/></block></form></prima>'
    where = editor.at("fa/x.xml", text)
    pair = editor.do(
        editor.client.text_document_linked_editing_range_async(lsp.LinkedEditingRangeParams(*where))
    )
    assert pair is not None
    assert [cut(plain(text)[0], one) for one in pair.ranges] == ["block", "block"]
    editor.close("fa/x.xml")


def test_what_has_no_meaning_and_no_pair_has_no_answer(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><bl|ock><exit/><speak>Hi.</speak></form></prima>'
    for marked in (text, text.replace("|", "").replace("Hi", "H|i")):
        where, client = editor.at("fa/x.xml", marked), editor.client
        linked = lsp.LinkedEditingRangeParams(*where)
        assert editor.do(client.text_document_linked_editing_range_async(linked)) is None
    assert editor.do(client.text_document_hover_async(lsp.HoverParams(*where))) is None
    name = lsp.PrepareRenameParams(*where)
    assert editor.do(client.text_document_prepare_rename_async(name)) is None
    editor.close("fa/x.xml")


FIXED = {
    "element": (BEGIN + '<form id="a"><block><speek>x</speek><exit/></block></form></prima>', "<speak>x</speak>"),
    "hint": (BEGIN + '<form id="a"><block><say>x</say><exit/></block></form></prima>', "<speak>x</speak>"),
    "attribute": (BEGIN + '<form id="a"><on evnt="touch"><exit/></on></form></prima>', '<on event="touch">'),
    "value": (BEGIN + '<form id="a"><block><speak order="nwo">x</speak><exit/></block></form></prima>', 'order="now"'),
    "time": (BEGIN + '<form id="a"><block><send event="x" delay="5"/></block><on event="x"><exit/></on></form></prima>', 'delay="5s"'),
    "range": (BEGIN + '<form id="a"><block><turn angle="450"/><exit/></block></form></prima>', 'angle="360"'),
    "form": (BEGIN + '<form id="main"><block><goto next="#mian"/></block></form></prima>', 'next="#main"'),
    "target": (BEGIN + '<form id="main"><block><goto next="main"/></block></form></prima>', 'next="#main"'),
    "variable": (BEGIN + '<form id="a"><var name="count"/><block cond="cuont"><exit/></block></form></prima>', 'cond="count"'),
    "declare": (BEGIN + '<form id="a"><block cond="q"><exit/></block></form></prima>', '<form id="a">\n  <var name="q"/>'),
    "missing": (BEGIN + '<form id="a"><block><turn/><exit/></block></form></prima>', '<turn angle="0"/>'),
    "end tag": (BEGIN + '<form id="a"><block><exit/></form></prima>', "<exit/></block></form>"),
    "misspelt end tag": (BEGIN + '<form id="a"><block><speak>Hi.</Speak><exit/></block></form></prima>', "<speak>Hi.</speak><exit/>"),
    "empty element": (BEGIN + '<form id="a"><block><if cond="1 &gt; 2"><exit/><else></if><exit/></block></form></prima>', "<exit/><else/></if>"),
    "end": (BEGIN + '<form id="a"><block><exit/></block></form>\n', "</form></prima>\n"),
    "namespace": (BEGIN.replace("dialogue", "dialoge") + '<form id="a"/></prima>', "urn:prima:dialogue:1"),
    "place": (SCENE + '<robot at="entrace"/><application src="../fa/follow.xml" kind="fa"/></scenario>', 'at="entrance"'),
}  # fmt: skip


@pytest.mark.parametrize("case", FIXED)
def test_quick_fixes(editor: Editor, case: str) -> None:
    text, wanted = FIXED[case]
    name = "scenarios/x.xml" if "<scenario" in text else "fa/x.xml"
    problems = editor.open(name, text)
    assert problems
    made = []
    for problem in problems:
        actions = editor.do(
            editor.client.text_document_code_action_async(
                lsp.CodeActionParams(
                    lsp.TextDocumentIdentifier(editor.uri(name)),
                    problem.range,
                    lsp.CodeActionContext([problem]),
                )
            )
        )
        for action in actions or ():
            assert isinstance(action, lsp.CodeAction) and action.edit and action.edit.changes
            made.append(edited(text, list(action.edit.changes[editor.uri(name)])))
    editor.close(name)
    assert any(wanted in one for one in made), made


def test_a_quick_fix_is_of_the_text_as_it_is_now(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><speek>Hi.</speek><exit/></block></form></prima>'
    editor.open("fa/x.xml", text)
    text = text.replace("<block>", "<block><!-- A word of welcome. -->")
    change = lsp.TextDocumentContentChangeWholeDocument(text=text)
    document = lsp.VersionedTextDocumentIdentifier(uri=editor.uri("fa/x.xml"), version=2)
    editor.client.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [change]))
    (action,) = (
        editor.do(
            editor.client.text_document_code_action_async(
                lsp.CodeActionParams(
                    lsp.TextDocumentIdentifier(document.uri),
                    lsp.Range(lsp.Position(0, 0), lsp.Position(2, 0)),
                    lsp.CodeActionContext([]),
                )
            )
        )
        or ()
    )
    editor.close("fa/x.xml")
    assert isinstance(action, lsp.CodeAction) and action.edit and action.edit.changes
    made = edited(text, list(action.edit.changes[document.uri]))
    assert made == text.replace("speek", "speak")


def test_nothing_is_done_about_a_name_that_is_cut() -> None:
    text = BEGIN + f'<form id="a"><block cond="{"q" * 1_000}"><exit/></block></form></prima>'
    workspace = Workspace()
    workspace.put("file:///x.xml", text)
    path = next(iter(workspace.open))
    (found,) = check(workspace, path)[path]
    assert found.code == "undeclared-variable" and "[...]" in found.remedy
    assert not found.fixes


# Words and the command line --------------------------------------------------------------
def test_every_element_attribute_and_rule_is_described() -> None:
    for vocabulary in VOCABULARIES:
        for element in vocabulary.elements.values():
            assert element.doc, element.tag
            for word in element.source.replace(";", " ").replace(",", " ").split():
                if len(word) == 2 and word[0] in "UOSCFKVEX" and word[1].isdigit():
                    assert word in RULES, (element.tag, word)
    plain_ones = {"name", "expr", "cond", "next", "event", "count", "timeout", "namelist", "src"}
    assert plain_ones <= VOICEXML_ATTRIBUTES.keys()
