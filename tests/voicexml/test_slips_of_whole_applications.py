"""Slips in an application of several documents: each is told once, in its place, with what mends it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.here import prima

BEGIN = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
    ' xml:lang="en"'
)
FILES = {
    "main.vxml": f"""{BEGIN} application="root.vxml">
  <form id="hello">
    <block><p:par><p:gesture name="nod"/><p:speak>Welcome.</p:speak></p:par></block>
    <subdialog name="card" src="card.vxml#card"><param name="lang" expr="'en'"/></subdialog>
    <field name="book"><prompt>Which book?</prompt><grammar src="grammars/books.gram"/></field>
    <block><submit next="service:shelves#wait" namelist="book"/></block>
  </form>
  <form id="wait">
    <transfer name="phone" dest="tel:+1-555-0112"><prompt>One moment.</prompt></transfer>
    <record name="note" type="audio/x-wav"><prompt>Leave a note.</prompt></record>
  </form>
</vxml>
""",
    "root.vxml": f"""{BEGIN}>
  <catch event="touch.head"><p:gesture name="nod"/><reprompt/></catch>
  <catch event="reply.shelves"><value expr="session.event.data.shelf"/><exit/></catch>
</vxml>
""",
    "card.vxml": f"""{BEGIN} application="root.vxml">
  <form id="card">
    <var name="lang"/>
    <p:iu longest="40s"><field name="n" type="digits?length=4"><prompt>Card?</prompt></field></p:iu>
    <block><p:topological-move to="entrance"/><return/></block>
  </form>
</vxml>
""",
    "grammars/books.gram": """#ABNF 1.0;
language en;
root $book;
$book = Emma | $german;
$german = Faust;
""",
    "visit.xml": """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"
 world="{documents}/worlds/office.xml" robot="{documents}/robots/papero.xml">
  <application src="main.vxml"/>
  <service name="shelves"><reply><data name="shelf" value="B 12"/></reply></service>
</scenario>
""",
}
SLIPS = {
    "a number without its scheme": (
        *("main.vxml", 'dest="tel:+1-555-0112"', 'dest="+1-555-0112"'),
        'main.vxml:9:34: warning: <transfer> always fails: "+1-555-0112" is not a telephone number;',
    ),
    "a type of recordings": (
        *("main.vxml", "audio/x-wav", "audio/mp3"),
        "main.vxml:10:31: warning: <record> always fails: nothing is recorded as",
    ),
    "the dialog after a service": (
        *("main.vxml", "shelves#wait", "shelves#wiat"),
        'main.vxml:6:26: warning: There is no dialog "wiat" here: this will be error.badfetch. '
        'Did you mean "wait"?',
    ),
    "a folder in capitals": (
        *("main.vxml", "grammars/books", "Grammar/books"),
        'There is no file "Grammar/books.gram" here: this will be error.badfetch. '
        'Did you mean "grammars/books.gram"?',
    ),
    "a Command in a par": (
        *("main.vxml", "<p:gesture", "<p:gestur"),
        'main.vxml:3:19: error: PRIMA has no Command <gestur>. Did you mean "gesture"?',
    ),
    "a Command without its prefix": (
        *("main.vxml", "<p:gesture", "<gesture"),
        "main.vxml:3:19: error: <gesture> is not allowed in <p:par>. Write <p:gesture>.",
    ),
    "an argument": (
        *("main.vxml", "<p:gesture name", "<p:gesture nam"),
        'main.vxml:3:30: error: <gesture> has no attribute "nam". Did you mean "name"?',
    ),
    "text in a par": (
        *("main.vxml", '<p:gesture name="nod"/><p:speak>Welcome.</p:speak>', "Welcome."),
        'main.vxml:3:12: error: Text is not allowed in <p:par>: "Welcome."',
    ),
    "no prefix": (
        *("card.vxml", ' xmlns:p="urn:prima:dialogue:1"', ""),
        'PRIMA\'s Commands in VoiceXML need xmlns:p="urn:prima:dialogue:1".',
    ),
    "a time without its unit": (
        *("card.vxml", '"40s"', '"40"'),
        'card.vxml:4:20: error: longest "40" is not a time. Write "40s".',
    ),
    "a parameter of a type": (
        *("card.vxml", "?length", "?lenght"),
        'digits has no parameter "lenght". Did you mean "length"?',
    ),
    "the value of a parameter": (
        *("card.vxml", "length=4", "length=four"),
        'length is a number of digits, not "four". Write a whole number up to 9999, such as length=4.',
    ),
    "a root that has a root": (
        *("card.vxml", "root.vxml", "main.vxml"),
        "card.vxml:1:115: warning: main.vxml has an application root itself: this will be error.semantic.",
    ),
    "a place in a further document": (
        *("card.vxml", "entrance", "entrence"),
        'card.vxml:5:36: warning: The world has no place "entrence". Did you mean "entrance"?',
    ),
    "a gesture in a root": (
        *("root.vxml", '"nod"', '"nodd"'),
        'root.vxml:2:46: warning: The robot knows no gesture "nodd". Did you mean "nod"?',
    ),
    "a sensor in a root": (
        *("root.vxml", "touch.head", "touch.hed"),
        'root.vxml:2:17: warning: The robot has no touch sensor "hed". Did you mean "head"?',
    ),
    "data of a reply in a root": (
        *("root.vxml", "data.shelf", "data.shelv"),
        'No reply of "shelves" in the scenario has "shelv". Did you mean "shelf"?',
    ),
    "no semicolon": (
        *("grammars/books.gram", "$german;", "$german"),
        'grammars/books.gram:5:9: warning: "= Faust;" is not allowed here. '
        'If $german is a new rule, end the one before it with ";".',
    ),
}


@pytest.fixture
def folder(tmp_path: Path, demo: Path) -> Path:
    (tmp_path / "grammars").mkdir()
    for name, text in FILES.items():
        (tmp_path / name).write_text(text.replace("{documents}", str(demo)), encoding="utf-8")
    return tmp_path


@pytest.fixture
def demo() -> Path:
    from prima import documents_folder

    return documents_folder()


def told(folder: Path) -> list[str]:
    done = prima("validate", "visit.xml", "--format", "short", cwd=folder)
    return done.stdout.splitlines()


def test_nothing_right_is_complained_about(folder: Path) -> None:
    assert told(folder) == []


@pytest.mark.parametrize("what", SLIPS)
def test_a_slip_is_told_once_with_what_mends_it(folder: Path, what: str) -> None:
    name, right, wrong, says = SLIPS[what]
    path = folder / name
    text = path.read_text(encoding="utf-8")
    assert right in text
    path.write_text(text.replace(right, wrong, 1), encoding="utf-8")
    (line,) = told(folder)
    assert says in line


def test_a_misspelt_namespace_of_commands_is_guessed(folder: Path) -> None:
    path = folder / "root.vxml"
    path.write_text(path.read_text().replace("urn:prima:dialogue:1", "urn:prima:dialog:1"))
    (line,) = told(folder)
    assert 'It is ignored. Did you mean "urn:prima:dialogue:1"?' in line


def test_a_name_of_a_variable_that_is_misspelt_is_not_missing_as_well(folder: Path) -> None:
    path = folder / "card.vxml"
    path.write_text(path.read_text().replace('<var name="lang"/>', '<var nam="lang"/>'))
    lines = [one for one in told(folder) if one.startswith("card.vxml:3:")]
    assert len(lines) == 1 and 'Did you mean "name"?' in lines[0]


def test_a_robot_that_lacks_a_command_of_a_root_is_told(folder: Path) -> None:
    path = folder / "visit.xml"
    path.write_text(path.read_text().replace("papero.xml", "pointer.xml"))
    lines = told(folder)
    assert any("root.vxml:2:29: warning: This robot cannot do gesture" in one for one in lines)
    root = folder / "root.vxml"
    root.write_text(
        root.read_text().replace(
            "</vxml>", '<catch event="error.unsupported"><exit/></catch></vxml>'
        )
    )
    assert not any("Handle it" in one for one in told(folder))


def test_the_language_of_a_part_of_a_grammar_is_guessed(tmp_path: Path) -> None:
    (tmp_path / "g.grxml").write_text(
        '<grammar version="1.0" xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en" root="r">'
        '\n<rule id="r"><item lang="ja">tea</item></rule></grammar>'
    )
    done = prima("validate", "g.grxml", "--format", "short", cwd=tmp_path)
    assert (
        'g.grxml:2:20: error: <item> has no attribute "lang". Did you mean "xml:lang"?'
        in done.stdout
    )
