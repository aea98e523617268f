"""Completion in an editor."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types as lsp

from prima.grammar import load
from tests.helpers.editor import BEGIN, SCENE, SRGS, VOICE, Editor, edited, plain

PROPOSED = {
    "document": ("fa/x.xml", "|", {"prima", "vxml", "scenario", "world", "robot"}, {"form"}),
    "root": ("fa/x.xml", "<|", {"prima", "vxml", "grammar"}, {"form"}),
    "form": ("fa/x.xml", BEGIN + "<|", {"form", "on", "/prima"}, {"block", "speak"}),
    "in a name": ("fa/x.xml", BEGIN + '<form id="a"><block><spe|</block>', {"speak"}, {"field"}),
    "between": ("fa/x.xml", BEGIN + '<form id="a"><block>|</block>', {"speak", "goto"}, {"field"}),
    "end tag": ("fa/x.xml", BEGIN + '<form id="a"><block><exit/></|', {"/block"}, {"/form"}),
    "attribute": ("fa/x.xml", BEGIN + '<form id="a"><block><goto |', {"next", "nextitem"}, {"id"}),
    "given": ("fa/x.xml", BEGIN + '<form id="a" |></form></prima>', {"stream"}, {"id"}),
    "instead": ("fa/x.xml", BEGIN + '<form id="a"><block><turn angle="1" |/>', {"order"}, {"angle-expr"}),
    "choices": ("fa/x.xml", BEGIN + '<form id="a"><field name="n" type="|"/>', {"number"}, {"a"}),
    "truth": ("fa/x.xml", BEGIN + '<form id="a"><field name="n"><prompt bargein="|"', {"true"}, set()),
    "forms": ("fa/x.xml", BEGIN + '<form id="a"><block><goto next="|"/></block></form><form id="b"/>', {"#a", "#b"}, set()),
    "open quote": ("fa/x.xml", BEGIN + '<form id="a"><block><goto next="#|</block></form>', {"#a"}, set()),
    "rules": ("fa/x.xml", BEGIN + '<form id="a"><field name="n"><grammar root="|"><rule id="r"/></grammar>', {"r"}, {"a"}),
    "variables": (
        "fa/x.xml",
        BEGIN + '<var name="all"/><form id="a"><var name="own"/><block cond="own &lt; |"/></form>'
        '<form id="b"><var name="other"/></form>',
        {"all", "own", "session"},
        {"other", "event", "_message", "sensor"},
    ),
    "variables of a handler": ("fa/x.xml", BEGIN + '<form id="a"><on event="touch" cond="|"/>', {"event", "_event", "session"}, {"sensor"}),
    "variables of a watch": ("fa/x.xml", BEGIN + '<form id="a"><watch name="w" when="|"/>', {"sensor"}, {"event"}),
    "variables of content": (
        "fa/x.xml",
        BEGIN + '<form id="a"><block><var name="gone"/><speak>A<on event="end"><var name="in"/></on></speak></block>'
        '<block><var name="here"/><if cond="here"><var name="deep"/></if><log expr="|"/></block></form>',
        {"here", "deep"},
        {"gone", "in"},
    ),
    "content in a condition": ("fa/x.xml", BEGIN + '<form id="a"><block cond="|"><var name="in"/></block>', {"session"}, {"in"}),
    "voice content": (
        "ea/x.vxml",
        VOICE + '<form id="a"><block><var name="gone"/></block><catch event="e"><foreach item="here" array="[]"><log expr="|"/>',
        {"here", "_event"},
        {"gone", "sensor", "event"},
    ),
    "events of a Command": ("fa/x.xml", BEGIN + '<form id="a"><block><speak>A<on event="|"/>', {"end", "end.speak", "error"}, {"help", "touch"}),
    "events of a Command in a unit": ("fa/x.xml", BEGIN + '<form id="a"><block><iu><speak>A<on event="|"/>', {"error"}, {"end", "end.speak", "touch"}),
    "items": (
        "fa/x.xml",
        BEGIN + '<var name="all"/><form id="a"><var name="own"/><field name="q"/><block name="b"><goto nextitem="|"/>',
        {"q", "b"},
        {"own", "all"},
    ),
    "filled": (
        "fa/x.xml",
        BEGIN + '<form id="a"><var name="own"/><field name="q"/><subdialog name="s"/><block name="b"/><filled namelist="|"/>',
        {"q", "s"},
        {"own", "b"},
    ),
    "namelist": ("fa/x.xml", BEGIN + '<form id="a"><var name="n"/><block><clear namelist="x |"/>', {"n"}, {"event"}),
    "members": ("fa/x.xml", BEGIN + '<form id="a"><block cond="event.|"/>', {"data", "name"}, {"event"}),
    "members of a session": ("fa/x.xml", BEGIN + '<form id="a"><block cond="session.|"/>', {"time"}, {"connection"}),
    "members of an answer": ("fa/x.xml", BEGIN + '<form id="a"><field name="q"/><block cond="q$.|"/>', {"utterance", "confidence"}, {"inputmode", "interpretation"}),
    "members of a result": ("ea/x.vxml", VOICE + '<form id="a"><block cond="application.lastresult$.|"/>', {"utterance", "inputmode"}, {"data"}),
    "members of the dialog": (
        "ea/x.vxml",
        VOICE + '<var name="all"/><form id="a"><var name="own"/><block><var name="in"/><log expr="dialog.|"/>',
        {"own"},
        {"all", "in", "session"},
    ),
    "members of the document": ("fa/x.xml", BEGIN + '<var name="all"/><form id="a"><var name="own"/><block cond="document.|"/>', {"all"}, {"own"}),
    "members of a dialog outside": ("fa/x.xml", BEGIN + '<var name="all"/><on event="touch" cond="dialog.|"/>', set(), {"all"}),
    "sensors' values": ("fa/emotions.xml", BEGIN + '<form id="a"><watch name="w" when="sensor.|"/>', {"battery.level"}, {"session"}),
    "param of a subdialog": ("fa/x.xml", BEGIN + '<form id="g"><var name="n"/><field name="f"/></form><form id="a"><subdialog src="#g"><param name="|"/>', {"n"}, {"f"}),
    "param of a Command": ("fa/dance.xml", BEGIN + '<form id="a"><block><command type="dance"><param name="|"/>', {"tune"}, {"dance"}),
    "languages": ("fa/x.xml", BEGIN.replace("id=", 'xml:lang="|" id='), {"en", "ja"}, set()),
    "script": ("fa/x.xml", BEGIN + "<script>var total = 1; |</script>", {"total"}, {"form"}),
    "events": (
        "ea/guide.xml",
        BEGIN + '<form id="a"><on event="message |"/></form>',
        {"touch.head", "human.lost", "error.device.arm", "corner"},
        set(),
    ),
    "places": ("ea/guide.xml", BEGIN + '<form id="a"><block><topological-move to="|"/>', {"kidode-room"}, {"head"}),
    "gestures": ("ea/guide.xml", BEGIN + '<form id="a"><block><gesture name="|"/>', {"nod"}, set()),
    "commands": ("fa/dance.xml", BEGIN + '<form id="a"><block><command type="|"/>', {"dance"}, {"speak"}),
    "handled": ("fa/x.xml", BEGIN + '<form id="a"><on event="done"/><block><throw event="|"/>', {"done"}, set()),
    "worlds": ("scenarios/x.xml", SCENE.replace("../worlds/office.xml", "|"), {"../worlds/home.xml"}, {"../robots/papero.xml"}),
    "applications": ("scenarios/x.xml", SCENE + '<application src="|"/>', {"../fa/follow.xml", "../ea/pizza.vxml"}, {"../worlds/home.xml"}),
    "scene places": ("scenarios/x.xml", SCENE + '<robot at="|"/>', {"entrance"}, {"charger"}),
    "sensors": ("scenarios/x.xml", SCENE + '<when at="1s"><touch sensor="|"/>', {"head"}, set()),
    "doing": ("scenarios/x.xml", SCENE + '<when doing="|"/>', {"speak", "dance"}, set()),
    "policy": (
        "scenarios/x.xml",
        SCENE.replace('id="s"', 'id="s" policy="|"'),
        {"fifo", "prima"},
        set(),
    ),
    "voice elements": ("ea/x.vxml", VOICE + '<form id="a"><block><|', {"prompt", "p:speak"}, {"field"}),
    "voice arranging": ("ea/x.vxml", VOICE + '<form id="a"><block><p:|', {"p:par", "p:seq", "p:iu"}, set()),
    "voice arranged": ("ea/x.vxml", VOICE + '<form id="a"><block><p:par><|', {"p:speak", "p:iu"}, {"prompt"}),
    "voice grouped": ("ea/x.vxml", VOICE + '<form id="a"><block><p:iu |', {"longest", "restartable"}, {"cond"}),
    "voice form": ("ea/x.vxml", VOICE + '<form id="a"><|', {"p:iu", "field"}, {"p:par", "p:speak"}),
    "voice unit": ("ea/x.vxml", VOICE + '<form id="a"><p:iu><|', {"block", "record", "noinput"}, {"p:speak", "on", "subdialog"}),
    "voice unit attributes": ("ea/x.vxml", VOICE + '<form id="a"><p:iu |', {"longest", "cond", "name"}, {"restartable"}),
    "voice unit content": ("ea/x.vxml", VOICE + '<form id="a"><p:iu><block><|', {"prompt", "p:speak"}, {"field"}),
    "voice unit items": ("ea/x.vxml", VOICE + '<form id="a"><p:iu name="u"><field name="f"/></p:iu><block><goto nextitem="|"/>', {"u", "f"}, set()),
    "voice goto": ("ea/x.vxml", VOICE + '<form id="a"><block><goto next="|"/>', {"#a", "pizza.vxml"}, set()),
    "voice grammar": ("ea/x.vxml", VOICE + '<form id="a"><field name="f"><grammar><|', {"rule", "meta"}, {"prompt", "one-of"}),
    "grammar file": ("ea/x.grxml", SRGS + "<|", {"rule", "lexicon"}, {"item", "prompt"}),
    "grammar attributes": ("ea/x.grxml", SRGS.replace('root="r"', "|"), {"mode", "tag-format"}, {"src", "scope"}),
    "voice events": ("ea/x.vxml", VOICE + '<form id="a"><catch event="|"', {"nomatch", "error.badfetch"}, set()),
    "voice properties": ("ea/x.vxml", VOICE + '<property name="|"', {"maxspeechtimeout", "recordutterance", "universals", "grammarmaxage"}, set()),
    "voice values": ("ea/x.vxml", VOICE + '<form id="a" scope="|"', {"dialog", "document"}, set()),
    "namespaces": ("fa/x.xml", '<prima xmlns="|"', {"urn:prima:dialogue:1"}, set()),
    "root without name": ("fa/x.xml", BEGIN.replace("prima", "|", 1) + '<form id="a"/></prima>', {"prima"}, {"form"}),
    "beside the root": ("fa/x.xml", BEGIN + '<form id="a"/></prima><|', set(), {"prima", "form"}),
    "value without name": ("scenarios/x.xml", SCENE + '<answer |="Is it time to start?" id="a">', {"to"}, {"id"}),
    "comment": ("fa/x.xml", BEGIN + "<!-- <| -->", set(), {"form"}),
}  # fmt: skip


@pytest.mark.parametrize("case", PROPOSED)
def test_completion(editor: Editor, case: str) -> None:
    name, text, wanted, unwanted = PROPOSED[case]
    found = editor.proposals(name, text).keys()
    assert wanted <= found
    assert not unwanted & found


def test_a_new_grammar_has_what_a_grammar_needs(editor: Editor) -> None:
    item = editor.proposals("ea/x.grxml", "<|")["grammar"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    made = item.text_edit.new_text.replace("$1", "size").replace("$0", "small")
    grammar = load(made if made[0] == "<" else f"<{made}")
    assert grammar.match("small")
    assert not grammar.match("large")


def test_proposals_bring_what_an_element_needs(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><got|</block></form></prima>'
    item = editor.proposals("fa/x.xml", text)["goto"]
    assert item.insert_text_format == lsp.InsertTextFormat.Snippet
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert edited(plain(text)[0], [item.text_edit]) == (
        BEGIN + '<form id="a"><block><goto next="$1"/>$0</block></form></prima>'
    )
    text = BEGIN + '<form id="a"><block><|got next="#a"/></block></form></prima>'
    item = editor.proposals("fa/x.xml", text)["goto"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert item.text_edit.new_text == "goto"  # the rest is there already


@pytest.mark.parametrize(
    ("written", "made"),
    [
        ('<goto |="#a"/>', '<goto next="#a"/>'),
        ('<goto ne| = "#a"/>', '<goto next = "#a"/>'),
        ("<goto ne|=/>", "<goto next=/>"),
        ("<goto ne|/>", '<goto next="$1"$0/>'),
        ('<goto | cond="x"/>', '<goto next="$1"$0 cond="x"/>'),
    ],
)
def test_an_attribute_has_one_value(editor: Editor, written: str, made: str) -> None:
    text = BEGIN + f'<form id="a"><block>{written}</block></form></prima>'
    item = editor.proposals("fa/x.xml", text)["next"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert f"<block>{made}</block>" in edited(plain(text)[0], [item.text_edit])


@pytest.mark.parametrize("end", ["</|block>", "</bl|ock>", "</block|>", "</bl|", "</|"])
def test_an_end_tag_is_completed_anywhere_in_its_name(editor: Editor, end: str) -> None:
    text = BEGIN + f'<form id="a"><block><exit/>{end}</form></prima>'
    item = editor.proposals("fa/x.xml", text)["/block"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    assert edited(plain(text)[0], [item.text_edit]) == (
        BEGIN + '<form id="a"><block><exit/></block></form></prima>'
    )
    assert editor.proposals("fa/x.xml", text.replace("|", "").replace("</", "<|/", 1)) == {}


def test_an_editor_without_snippets_gets_none(tmp_path: Path) -> None:
    editor = Editor(tmp_path, lsp.ClientCapabilities())
    for item in editor.proposals("x.xml", BEGIN + "<form |").values():
        assert isinstance(item.text_edit, lsp.TextEdit)
        assert "$" not in item.text_edit.new_text
    assert editor.end() == (0, "")


def test_a_space_in_a_sentence_proposes_nothing(editor: Editor) -> None:
    text = BEGIN + '<form id="a"><block><speak>Hello |</speak></block></form></prima>'
    assert editor.proposals("fa/x.xml", text, " ") == {}
    assert "value" in editor.proposals("fa/x.xml", text)


def test_a_proposal_of_a_new_document_is_a_good_beginning(editor: Editor) -> None:
    item = editor.proposals("fa/x.xml", "|")["prima"]
    assert isinstance(item.text_edit, lsp.TextEdit)
    text = item.text_edit.new_text.replace("${1|ea,fa|}", "fa").replace("$0", "<speak>x</speak>")
    assert editor.open("fa/x.xml", text.replace("$2", "x").replace("$3", "main")) == []
    editor.close("fa/x.xml")


def test_the_file_before_a_dialog_stays_as_it_is_written(editor: Editor) -> None:
    text = VOICE + '<form id="a"><block><goto next="R&amp;D.vxml#|"/></block></form></vxml>'
    (editor.folder / "ea" / "R&D.vxml").write_text(VOICE + '<form id="order"/></vxml>')
    found = editor.proposals("ea/x.vxml", text)["R&amp;D.vxml#order"].text_edit
    (editor.folder / "ea" / "R&D.vxml").unlink()
    assert found is not None and found.new_text == "R&amp;D.vxml#order"


def test_a_voicexml_application_is_offered_by_the_name_of_its_file(editor: Editor) -> None:
    text = SCENE + '<application src="../ea/pizza.vxml"{}/><expect ends="|"/></scenario>'
    assert "pizza" in editor.proposals("scenarios/x.xml", text.format(""))
    given = editor.proposals("scenarios/x.xml", text.format(' id="cook"'))
    assert "cook" in given and "pizza" not in given
    editor.close("scenarios/x.xml")
