"""Checks of several VoiceXML documents together, and of the files that they name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from prima import api, loading
from prima.errors import DocumentError
from prima.loading import validation, voicedocuments
from prima.voicexml import pages
from prima.voicexml.pages import Pages
from tests import ROOT
from tests.helpers.grammars import xml
from tests.helpers.here import prima
from tests.helpers.validating import VXML, told

PAGE = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">
<form id="f"><field name="a"><prompt>A?</prompt>
<grammar src="g/towns.gram" type="application/srgs"/>
<grammar src="g/towns.gram#r" type="application/srgs+xml"/>
<grammar src="g/tags.gram" type="application/abnf"/>
</field></form></vxml>
"""
TAGS = """#ABNF 1.0;
language en;
root $r;
tag-format <semantics/1.0>;
public $r = a
  {out = nope};
"""


def test_grammars_in_files_that_a_page_names_are_checked(tmp_path: Path) -> None:
    (tmp_path / "g").mkdir()
    (tmp_path / "page.vxml").write_text(PAGE)
    (tmp_path / "g" / "tags.gram").write_text(TAGS)
    towns = tmp_path / "g" / "towns.gram"
    towns.write_text("#ABNF 1.0;\nlanguage en;\npublic $r = Rome;\n")
    done = prima("validate", "page.vxml", "--format", "short", cwd=tmp_path)
    assert [line.partition(" W")[0] for line in done.stdout.splitlines()] == [
        'g/tags.gram:6:3: warning: The tag uses "nope", which nothing in the grammar declares:'
        " answers that need it do not match. For the text itself write 'nope' in quotes."
        " [undeclared-variable]",
        'page.vxml:3:15: warning: The grammar "g/towns.gram" names no root rule.'
        " Name a rule: #name.",
        'page.vxml:4:15: warning: The type "application/srgs+xml" contradicts "g/towns.gram",'
        " which is in the ABNF form.",
        'page.vxml:5:15: warning: The type "application/abnf" is not one of SRGS;'
        " it is read as application/srgs.",
    ]
    towns.write_text("language en;\npublic $r = Rome;\n")  # an error of the file is told once
    done = prima("validate", "page.vxml", "g", "--format", "short", cwd=tmp_path)
    told = [line for line in done.stdout.splitlines() if "towns.gram:" in line]
    assert told == [
        "g/towns.gram:1:1: error: The header of the ABNF form is missing."
        ' Begin with "#ABNF 1.0 UTF-8;" in the first line. [not-abnf]'
    ]


@pytest.mark.parametrize("lang", ["x-elvish", "i-klingon", "english", "en-x-pirate", "en_GB"])
def test_a_grammar_that_no_run_loads_for_its_language_is_told(tmp_path: Path, lang: str) -> None:
    rules = f'<grammar version="1.0" xml:lang="{lang}" root="r"><rule id="r">tea</rule></grammar>'
    file = rules.replace(" ", ' xmlns="http://www.w3.org/2001/06/grammar" ', 1)
    (tmp_path / "g.grxml").write_text(file)
    says = {"en_GB": ["bad-value"], "en-x-pirate": []}.get(lang, ["language"])
    for written in (rules, '<grammar src="g.grxml"/>'):
        body = f'<form><field name="f"><prompt>Q?</prompt>{written}</field></form>'
        assert [one.split()[1] for one in told(tmp_path, body)] == says
        main = tmp_path / "main.vxml"
        done = prima("run", "--ea", main, "--say", "tea", cwd=tmp_path)
        assert (done.returncode == 3) == bool(says)


LEADS = [
    '<link next="{}"><grammar version="1.0" root="r"><rule id="r">home</rule></grammar></link>',
    '<catch event="nomatch"><goto next="{}"/></catch>',
]
"""What a leaf inherits, and takes when the user says "home"."""
ASKS = '<form id="ask"><field name="f" type="boolean"><prompt>Q?</prompt></field></form>'
GOAL = '<form id="g"><block>There.</block></form>'


@pytest.mark.parametrize("leads", LEADS)
@pytest.mark.parametrize(
    ("target", "leaf", "root", "files", "says"),
    [
        ("#g", GOAL, "", {}, []),
        ("#g", "", GOAL, {}, ['There is no dialog "g" in main.vxml']),
        ("#g", "", "", {}, ['There is no dialog "g" in main.vxml']),
        ("b.vxml", "", "", {"b": GOAL}, []),
        ("b.vxml#h", "", "", {"b": GOAL, "sub/b": GOAL.replace('"g"', '"h"')}, ['no dialog "h"']),
        ("b.vxml", "", "", {"sub/b": GOAL}, ['There is no file "b.vxml"']),
        ("/sub/b.vxml", "", "", {"sub/b": GOAL}, []),
    ],
)
def test_what_a_root_document_leads_to_is_found_as_in_its_leaves(
    tmp_path: Path,
    leads: str,
    target: str,
    leaf: str,
    root: str,
    files: dict[str, str],
    says: list[str],
) -> None:  # 1.5.2, 5.2
    (tmp_path / "sub").mkdir()
    files = {"sub/root": leads.format(target) + root, "d": GOAL} | files
    written = {name: VXML.format("", text) for name, text in files.items()}
    written["d"] = VXML.format(' application="sub/root.vxml"', ASKS + leaf)
    body = ASKS.replace("Q?</prompt>", 'Q?</prompt><help><goto next="d.vxml"/></help>')
    found = told(tmp_path, body + leaf, ' application="sub/root.vxml"', **written)
    here = [one for one in found if "d.vxml" not in one]
    assert len(here) == len(says) and all(map(str.__contains__, here, says))
    done = prima("run", "--ea", tmp_path / "main.vxml", "--say", "home")
    assert (done.returncode, "There." in done.stdout) == ((3, False) if says else (0, True))


def test_a_root_document_alone_leads_to_dialogs_of_unknown_leaves(tmp_path: Path) -> None:
    assert told(tmp_path, LEADS[1].format("#g")) == []
    [found] = told(tmp_path, LEADS[1].format("b.vxml"))
    assert 'There is no file "b.vxml" here' in found


def test_a_name_that_leads_out_by_a_link_or_to_a_folder_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "site"
    (folder / "sub").mkdir(parents=True)
    for name in (tmp_path / "out.vxml", folder / "sub" / "in.vxml"):
        name.write_text(VXML.format("", GOAL))
    (folder / "far.vxml").symlink_to(tmp_path / "out.vxml")
    (folder / "near.vxml").symlink_to(folder / "sub" / "in.vxml")
    says = {"near.vxml": "", "far.vxml": "outside of the folder", "sub": "There is no file"}
    for target, words in says.items():
        body = f'<form><block><goto next="{target}"/></block></form>'
        assert [words in one for one in told(folder, body)] == [True] * bool(words)
        done = prima("run", "--ea", folder / "main.vxml")
        assert ("error.badfetch" in done.stdout) == bool(words)


def test_handlers_of_a_root_document_read_variables_of_its_leaves(tmp_path: Path) -> None:
    handler = '<catch event="nomatch"><log expr="topic"/></catch>'
    leads = '<form><block><log expr="wrong"/><goto next="leaf.vxml"/></block></form>'
    leaf = '<var name="topic"/><form><field name="f"><option>yes</option></field></form>'
    page = VXML.format(' application="main.vxml"', leaf)
    (one,) = told(tmp_path, handler + leads, leaf=page)
    assert 'The variable "wrong" is not declared' in one
    (one,) = told(tmp_path, f"{handler}<form/>")
    assert 'The variable "topic" is not declared' in one, "nothing names it as its root"


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("g.txt", "root $r;\n$r = a;", 'Begin with "#ABNF 1.0 UTF-8;" in the first line.'),
        ("g.gram", "towns: Rome", "Begin with <grammar ...> for the XML form, or with #ABNF"),
        ("g.txt", "towns: Rome", "Begin with a root element, such as <prima> or <vxml>."),
    ],
)
def test_a_grammar_without_its_beginning_is_told_how_grammars_begin(
    tmp_path: Path, name: str, text: str, told: str
) -> None:
    (tmp_path / name).write_text(text)
    done = prima("validate", name, "--format", "short", cwd=tmp_path)
    assert done.returncode == 1 and told in done.stdout


@pytest.mark.parametrize(
    ("content", "warned"),
    [
        ('<script src="a.js"/><form><block/></form>', False),
        ('<script src="b.js"/><form><block/></form>', True),
        ('<form><block><goto next="#x"/></block></form><form id="x"><block/></form>', False),
        ('<form><block><goto next="a%20b.vxml#x"/></block></form>', False),
        ('<form><block><goto next="c.vxml?y=1#x"/></block></form>', True),
        ('<form><block><goto next="../d/a.js"/></block></form>', True),
        ('<form><block><submit next="http://h.example/c"/></block></form>', False),
        ('<form><block><submit next="service:shop"/></block></form>', False),
        ('<form><block><audio src="none.wav">Hello.</audio></block></form>', False),
        ('<form xml:base="e/"><subdialog name="s" src="f.vxml"/></form>', True),
    ],
)
def test_files_of_a_voicexml_document_that_are_not_there_are_warned_of(
    content: str, warned: bool, tmp_path: Path
) -> None:
    (tmp_path / "d").mkdir()
    for name in ("a.js", "a b.vxml"):
        (tmp_path / "d" / name).write_text(
            '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form id="x"/></vxml>'
        )
    (tmp_path / "d" / "m.vxml").write_text(
        f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">{content}</vxml>'
    )
    done = prima("validate", "d/m.vxml", cwd=tmp_path)
    assert ("[no-such-file]" in done.stdout) == warned, done.stdout
    assert "error:" not in done.stdout


@pytest.mark.parametrize(
    "content",
    [
        '<form><block><goto next=" end "/></block></form>',
        '<form><subdialog src="end"/></form>',
        '<menu><choice next="end">bye</choice></menu>',
    ],
)
def test_a_dialog_without_its_sign_is_told_to_be_one(tmp_path: Path, content: str) -> None:
    end = '<form id="end"><block><script src="end"/></block></form>'
    first, second = told(tmp_path, content + end)
    assert 'no-such-file There is no file "end" here' in first
    assert first.endswith('It is a dialog: write "#end".') and "dialog" not in second


def test_a_file_above_the_folder_is_told_to_need_a_mapping(tmp_path: Path) -> None:
    folder = tmp_path / "voice"
    folder.mkdir()
    (tmp_path / "root.vxml").write_text(VXML.format("", '<var name="v"/>'))
    form = '<form><block><value expr="v"/></block></form>'
    (one,) = told(folder, form, ' application="../root.vxml"')
    assert one.startswith('main.vxml no-such-file "../root.vxml" is outside of the folder')
    assert "--map https://example.org/=FOLDER" in one
    maps = [f"https://example.org/={tmp_path}"]
    assert loading.validate([folder / "main.vxml"], maps) == []
    (one,) = told(folder, form, ' application="../rood.vxml"')
    assert 'There is no file "../rood.vxml" here' in one


def test_pages_below_an_application_may_name_files_of_its_folder(tmp_path: Path) -> None:
    below = tmp_path / "sub" / "deep"
    below.mkdir(parents=True)
    grammar = '<form><field name="f"><grammar src="sub/deep/g.grxml"/></field>'
    leads = '<block><goto next="sub/deep/leaf.vxml"/></block></form>'
    (tmp_path / "main.vxml").write_text(VXML.format("", f'<var name="v"/>{grammar}{leads}'))
    (tmp_path / "towns.grxml").write_text(xml('<rule id="r" scope="public">Rome</rule>'))
    (below / "g.grxml").write_text(xml('<rule id="r"><ruleref uri="../../towns.grxml"/></rule>'))
    leaf = '<form><block><value expr="v"/><goto next="../../main.vxml#x"/></block></form>'
    (below / "leaf.vxml").write_text(VXML.format(' application="../../main.vxml"', leaf))
    named = ["main.vxml", "sub/deep/leaf.vxml", "sub/deep/g.grxml"]
    for files, folder in (["."], tmp_path), (["../.."], below), (named[::-1], tmp_path):
        done = prima("validate", *files, "--format", "short", cwd=folder)
        (line,) = done.stdout.splitlines()
        assert "leaf.vxml:1" in line and 'There is no dialog "x" in main.vxml' in line
        assert done.returncode == 0, "only the application's own files are named"
    alone = prima("validate", "deep", "--format", "short", cwd=tmp_path / "sub").stdout
    assert alone.count("is outside of the folder") == 2, "of the root and of the goto"
    assert "deep/g.grxml:" in alone and "it is outside the application's folder" in alone


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The documents at which the checks begin."""
    found: list[str] = []

    def pages_from(path: str, *given: Any) -> Pages:
        found.append(Path(path).name)
        return voicedocuments.pages_from(path, *given)

    monkeypatch.setattr(validation, "pages_from", pages_from)
    return found


def in_a_row(folder: Path, count: int, last: str) -> list[Path]:
    """Documents that lead to the next one, and the last to another."""
    for number in range(count):
        target = f"p{number + 1}.vxml" if number < count - 1 else last
        body = f'<form><block><goto next="{target}"/><prompt>Never.</prompt></block></form>'
        (folder / f"p{number}.vxml").write_text(VXML.format("", body))
    return sorted(folder.iterdir())


def test_each_document_of_an_application_is_checked_once(tmp_path: Path, begun: list[str]) -> None:
    """Each was checked with all that it leads to: a hundred of them took 7 s."""
    (tmp_path / "broken.vxml").write_text("<vxml>")
    found = loading.validate(in_a_row(tmp_path, 4, "broken.vxml"))
    assert begun == ["broken.vxml", "p0.vxml"], "what cannot be read is not part of it"
    assert [one.code for one in found] == ["not-xml"] + ["dead-content"] * 4


def test_a_large_application_is_checked_in_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, begun: list[str]
) -> None:
    """Those whose successors were read, too, are done: three hundred documents took 17 s."""
    monkeypatch.setattr(pages, "MOST_PAGES", 4)
    found = loading.validate(in_a_row(tmp_path, 9, "none.vxml"))
    assert begun == ["p0.vxml", "p3.vxml", "p6.vxml"]
    assert sorted(one.code for one in found) == ["dead-content"] * 9 + ["no-such-file"]


def test_a_file_that_is_too_large_to_be_read_is_told_where_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "large.vxml").write_text(VXML.format("", f"<form/><!--{'x' * 2000}-->"))
    (tmp_path / "large.grxml").write_text(f"<!--{'x' * 2000}-->{xml('<item>x</item>')}")
    text = '<form><field name="f"><grammar src="large.grxml"/></field><block><goto next="large.vxml"/></block></form>'
    (tmp_path / "main.vxml").write_text(VXML.format("", text))
    done = prima(
        "validate", "main.vxml", "--limit", "bytes=1000", "--format", "short", cwd=tmp_path
    )
    told = [line for line in done.stdout.splitlines() if "[no-such-file]" in line]
    for line, name in zip(told, ("large.grxml", "large.vxml"), strict=True):
        size = (tmp_path / name).stat().st_size
        assert line.endswith(
            f'"{name}" has {size} bytes; at most 1000 are read: this will be error.badfetch.'
            f" Divide it, or raise the limit: --limit bytes={size}. [no-such-file]"
        )
    assert done.returncode == 0


CALLED = VXML.format(
    "", '<form id="call"><var name="order"/><block><return namelist="order"/></block></form>'
)


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        *(("nogr.grxml", ""), ("cro.grxml", "cor.grxml"), ("c.xml", "")),
        *(("tea-menus.grxml", "tea-menu.grxml"), ("sor.grxml", ""), ("cor.vxml", "cor.xml")),
    ],
)
def test_a_file_is_guessed_only_where_it_is_near(tmp_path: Path, name: str, meant: str) -> None:
    for there in ("cor.xml", "cor.grxml", "tea-menu.grxml", "other.xml"):
        (tmp_path / there).write_text("")
    field = f'<form><field name="a"><grammar src="{name}"/></field></form>'
    (one,) = [one for one in told(tmp_path, field) if "no-such-file" in one]
    assert one.rpartition("badfetch.")[2].strip() == (f'Did you mean "{meant}"?' if meant else "")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ('<subdialog name="s" src="second.vxml#call"><param name="size" expr="1"/></subdialog>',
         'undeclared-variable The form "call" has no <var name="size"/>'),
        ('<subdialog name="s" src="second.vxml"><param name="oder" expr="1"/></subdialog>',
         'Did you mean "order"?'),
        ('<block><goto next="second.vxml#cal"/></block>',
         'no-such-form There is no dialog "cal" in second.vxml: this will be error.badfetch.'
         ' Did you mean "call"?'),
        ('<subdialog name="s" src="second.vxml"><param name="" expr="1"/></subdialog>',
         "Write the name of a variable of that form."),
        ('<block><goto next="empty.vxml"/></block>',
         "no-such-form empty.vxml has no dialog: this will be error.badfetch."),
    ],
)  # fmt: skip
def test_what_another_document_lacks_is_told(tmp_path: Path, content: str, says: str) -> None:
    empty = VXML.format("", "")
    (one,) = told(tmp_path, f"<form>{content}</form>", second=CALLED, empty=empty)
    assert one.startswith("main.vxml") and says in one


def test_what_another_document_takes_is_fine(tmp_path: Path) -> None:
    call = '<subdialog name="s" src="second.vxml#call"><param name="order" expr="1"/></subdialog>'
    content = f'<form>{call}<block><goto next="second.vxml#call"/></block></form>'
    assert told(tmp_path, content, second=CALLED) == []


INLINE = '<grammar version="1.0" root="r"><rule id="r"><ruleref uri="{}"/></rule></grammar>'
INLINE_ABNF = "<grammar><![CDATA[#ABNF 1.0;\nlanguage en; root $r; $r = $<{}>;]]></grammar>"
SECOND = VXML.format(
    "", '<form><field name="x"><grammar src="gone.grxml"/><prompt>Hm?</prompt></field></form>'
)


@pytest.mark.parametrize(
    "content",
    [
        '<form><block><goto next="second.vxml"/></block></form>',
        '<menu><choice next="second.vxml">two</choice></menu>',
        '<form><subdialog name="s" src="second.vxml"/></form>',
        '<form><block><submit next="second.vxml"/></block></form>',
    ],
)
def test_further_documents_of_an_application_are_looked_into(tmp_path: Path, content: str) -> None:
    (one,) = told(tmp_path, content, second=SECOND)
    assert one.startswith("second.vxml no-such-file") and "gone.grxml" in one
    beside = ROOT / "tests" / "mistakes" / "beside"
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        '<application src="main.vxml"/></scenario>'
    )
    (problem,) = loading.validate([tmp_path / "visit.xml"])
    assert problem.code == "no-such-file" and problem.place.file.endswith("second.vxml")


def test_further_documents_are_no_business_of_a_run(tmp_path: Path) -> None:
    broken = SECOND.replace("</vxml>", "")
    content = '<form><block><goto next="second.vxml"/></block></form>'
    (one,) = told(tmp_path, content, second=broken)
    assert one.startswith("second.vxml not-xml")
    assert loading.stage([], [str(tmp_path / "main.vxml")]).problems == []


def test_a_program_that_answers_a_submit_need_not_be_voicexml(tmp_path: Path) -> None:
    """In simulation its file in the folder answers, so one that is VoiceXML is checked."""
    content = '<form><block><{} next="answer.php"/></block></form>'
    (tmp_path / "answer.php").write_text("<?php echo 'hm';")
    assert told(tmp_path, content.format("submit")) == []
    (one,) = told(tmp_path, content.format("goto"))
    assert one.startswith("answer.php not-xml")
    (tmp_path / "answer.php").write_text(SECOND)
    (one,) = told(tmp_path, content.format("submit"))
    assert one.startswith("answer.php no-such-file") and "gone.grxml" in one


def test_documents_that_lead_to_each_other_are_read_once(tmp_path: Path) -> None:
    second = VXML.format("", '<form><block><goto next="main.vxml"/></block></form>')
    content = '<form><block><goto next="second.vxml"/></block></form>'
    assert told(tmp_path, content, second=second) == []


def test_a_handler_may_take_what_another_document_throws(tmp_path: Path) -> None:
    content = '<form><subdialog name="s" src="second.vxml"><catch event="tuch"/></subdialog></form>'
    thrown = '<form><block><return event="{}"/></block></form>'
    assert told(tmp_path, content, second=VXML.format("", thrown.format("tuch"))) == []
    (one,) = told(tmp_path, content, second=VXML.format("", thrown.format("other")))
    assert one.startswith("main.vxml unknown-event")


def test_a_grammar_in_the_place_of_a_document_is_told_to_be_one(tmp_path: Path) -> None:
    (tmp_path / "g.gram").write_text("#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = yes;\n")
    told = r"This is a grammar, not XML\. Name it in a VoiceXML"
    with pytest.raises(DocumentError, match=told):
        api.stage([], [str(tmp_path / "g.gram")])
    with pytest.raises(DocumentError, match=told):
        api.load_scenario(tmp_path / "g.gram")


@pytest.mark.parametrize(
    ("grammar", "says"),
    [
        ('<grammar src="builtin:grammar/dat"/>', 'no-such-name There is no built-in type "builtin'),
        ('<grammar src="builtin:dtmf/digits?length=2;minlength=1"/>', "exclusive length excludes"),
        ('<grammar src="http://[/a"/>', 'bad-value "http://[/a" is not a URI'),
        ('<grammar src="http://x.org/a" type="a/b"/>', 'format Grammars of type "a/b" are not'),
        (INLINE.format("gone.grxml"), 'no-such-file The grammar "gone.grxml" cannot be'),
        (INLINE.format("menu.grxml#tee"), 'no-such-rule There is no rule "tee" there.'),
        (INLINE_ABNF.format("gone.gram"), 'no-such-file The grammar "gone.gram" cannot be'),
        ('<grammar src="builtin:dtmf/digits?length=2"/>', ""),
        ('<grammar src="http://x.org/a"/>', ""),
        (INLINE.format("menu.grxml#tea"), ""),
        (INLINE.format("http://x.org/a"), ""),
        (INLINE.format("builtin:grammar/date"), ""),
        (INLINE_ABNF.format("menu.grxml"), ""),
    ],
)  # fmt: skip
def test_what_a_grammar_lacks_beyond_its_element_is_told(
    tmp_path: Path, grammar: str, says: str
) -> None:
    (tmp_path / "menu.grxml").write_text(
        xml('<rule id="r">x</rule><rule id="tea" scope="public">tea</rule>')
    )
    found = told(tmp_path, f'<form><field name="a"><prompt>Hm?</prompt>{grammar}</field></form>')
    assert [one.startswith(f"main.vxml {says}") for one in found] == [True] * bool(says), found


@pytest.mark.parametrize(
    ("uri", "says"),
    [
        (
            "localhost:8080/a/b?c=1",
            '"localhost:" is not fetched: this will be error.badfetch. '
            'Write "http://localhost:8080/a/b?c=1".',
        ),
        (
            "ftp://x.example/a",
            '"ftp:" is not fetched: this will be error.badfetch. '
            "Write http:, https: or service:, or the name of a file in the folder.",
        ),
        ("file:///a.vxml", '"file:" is not fetched'),
        ("HTTP://x.example/a", ""),
        ("service:a", ""),
        ("//x.example/a", ""),
    ],
)
@pytest.mark.parametrize(
    "body",
    [
        '<form><block><goto next="{}"/></block></form>',
        '<form><block><submit next="{}"/></block></form>',
        '<form><block><data src="{}"/></block></form>',
        '<form><subdialog src="{}"/></form>',
    ],
)
def test_a_uri_that_nothing_fetches_is_told(
    tmp_path: Path, body: str, uri: str, says: str
) -> None:  # 6.1
    found = told(tmp_path, body.format(uri))
    assert len(found) == bool(says) and says in "".join(found)
    done = prima("run", "--ea", tmp_path / "main.vxml")
    assert done.returncode == 3
    assert ("only http:, https: and service: are" in done.stderr) == bool(says)


def test_a_built_in_grammar_is_fetched_from_nowhere(tmp_path: Path) -> None:
    grammar = '<grammar src="builtin:grammar/boolean"/>'
    assert told(tmp_path, f'<form><field name="f">{grammar}</field></form>') == []
