"""Grammars in files that documents of PRIMA's own language name."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from prima import api
from prima.errors import UsageError
from prima.interpreter.reader import read_document
from tests.helpers.robot import document, xml

HEAD = '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"'
SIZES = f"""{HEAD} root="size" tag-format="semantics/1.0">
  <rule id="size" scope="public"><item repeat="0-1">a</item><one-of>
    <item>small<tag>out = {{size: "S", n: 1}};</tag></item>
    <item>large<tag>out = {{size: "L", n: 2}};</tag></item>
    <item>broken<tag>out = rules.nothing.at.all;</tag></item></one-of></rule>
  <rule id="number" scope="public">one<tag>out = 1;</tag></rule>
  <rule id="hidden">x</rule></grammar>"""
FILES = {
    "sizes.grxml": SIZES,
    "word.abnf": "#ABNF 1.0 UTF-8;\nlanguage en;\nroot $w;\npublic $w = well | $<sizes.grxml#size>;\n",
    "keys.abnf": "#ABNF 1.0 UTF-8;\nmode dtmf;\nroot $k;\npublic $k = 1 | 2;\n",
    "wrong.grxml": f'{HEAD} root="sise"><rule id="size">a<ruleref uri="#b"/></rule></grammar>',
    "rootless.grxml": f'{HEAD}><rule id="a">a</rule></grammar>',
    "entity.grxml": f'<!DOCTYPE g [<!ENTITY a "a">]>{HEAD} root="a"><rule id="a">&a;</rule></grammar>',
    "circle.grxml": f'{HEAD} root="a"><rule id="a"><one-of><item>a</item><item>'
    '<ruleref uri="#a"/> b</item></one-of></rule></grammar>',
    "some.txt": "hello",
}
ASK = (
    '<form id="f"><field name="a"><prompt>What?</prompt>{}<nomatch count="2"><exit/></nomatch>'
    '<noinput><exit/></noinput><filled><log expr="JSON.stringify(a)"/><exit/></filled></field></form>'
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of grammars beside a document, and one file outside."""
    inside = tmp_path / "app"
    inside.mkdir()
    (tmp_path / "outside.grxml").write_text(SIZES)
    for name, text in FILES.items():
        (inside / name).write_text(text)
    return inside


def written(folder: Path, grammar: str) -> Path:
    path = folder / "a.xml"
    path.write_bytes(xml(ASK.format(grammar), "ea", "a"))
    return path


def logs(folder: Path, grammar: str, *says: str) -> list[str]:
    """What an application logs that asks with a grammar."""
    loaded = api.stage([], [str(written(folder, grammar))], says)
    return [one["message"] for one in api.rehearse(loaded).records if one["phase"] == "log"]


@pytest.mark.parametrize(
    ("src", "said", "value"),
    [
        ("sizes.grxml", "A LARGE!", '{"size":"L","n":2}'),
        ("sizes.grxml#number", "one", "1"),
        ("word.abnf", "well", '"well"'),
        ("word.abnf", "small", '{"size":"S","n":1}'),
        ("circle.grxml", "a b b", '"a b b"'),
    ],
)
def test_a_file_says_what_an_answer_means(folder: Path, src: str, said: str, value: str) -> None:
    assert logs(folder, f'<grammar src="{src}"/>', said) == [value]


def test_a_tag_that_fails_is_told_and_takes_nothing(folder: Path) -> None:
    (told,) = logs(folder, '<grammar src="sizes.grxml"/>', "broken", "medium")
    assert told.startswith("no match: sizes.grxml:5:") and "failed: TypeError" in told


def test_a_link_listens_by_a_file(folder: Path) -> None:
    path = folder / "a.xml"
    link = '<link event="help"><grammar src="sizes.grxml#number"/></link>'
    body = link + ASK.format("<help><log>helped</log><exit/></help><option>no</option>")
    path.write_bytes(xml(body, "ea", "a"))
    records = api.rehearse(api.stage([], [str(path)], ["one"])).records
    assert "helped" in [one["message"] for one in records if one["phase"] == "log"]


@pytest.mark.parametrize(
    ("grammar", "file", "code", "message"),
    [
        ('src="none.grxml"', "a.xml", "no-such-file", 'The grammar "none.grxml" cannot be fetched'),
        ('src="../outside.grxml"', "a.xml", "no-such-file", "outside the application's folder"),
        ('src="http://x.org/a"', "a.xml", "no-such-file", "no network is used"),
        ('src="sizes.grxml#siz"', "a.xml", "no-such-rule", 'has no rule "siz"'),
        ('src="sizes.grxml#hidden"', "a.xml", "private-rule", "private"),
        ('src="rootless.grxml"', "a.xml", "no-root", "names no root rule"),
        ('src="sizes.grxml" root="size"', "a.xml", "exclusive", "src names a file"),
        ('src="keys.abnf"', "a.xml", "bad-value", "grammar of keys"),
        ('src="builtin:grammar/boolean"', "a.xml", "bad-value", "not a built-in type"),
        ('src=""', "a.xml", "bad-value", "src names no file"),
        ('src="#size"', "a.xml", "bad-value", "src names no file"),
        ('src="some.txt"', "some.txt", "not-xml", "not an SRGS grammar"),
        ('src="a.xml"', "a.xml", "wrong-root", "<prima> is not a grammar"),
        ('src="wrong.grxml"', "wrong.grxml", "no-such-rule", 'root rule "sise" is not there'),
        ('src="entity.grxml"', "entity.grxml", "doctype", "DOCTYPE"),
    ],
)
def test_what_is_wrong_is_told_at_its_place(
    folder: Path, grammar: str, file: str, code: str, message: str
) -> None:
    problems = api.validate([written(folder, f"<grammar {grammar}/>")])
    assert [one.severity for one in problems] == ["error"] * len(problems)
    first = problems[0]
    assert (first.place.file, first.code) == (str(folder / file), code)
    assert message in first.message
    assert ("--allow-host" in first.remedy) == ("http:" in grammar)


def test_src_and_content_exclude_each_other(folder: Path) -> None:
    (one,) = api.validate([written(folder, '<grammar src="sizes.grxml">small</grammar>')])
    assert (one.code, one.message) == ("exclusive", "<grammar> has both src and content.")


def test_a_file_that_has_changed_is_read_again(folder: Path) -> None:
    path = written(folder, '<grammar src="circle.grxml"/>')
    assert api.validate([path]) == []
    (folder / "circle.grxml").write_text("hello")
    assert [one.code for one in api.validate([path])] == ["not-xml"]


def test_without_a_folder_nothing_is_fetched() -> None:
    _, problems = read_document("a.xml", xml(ASK.format('<grammar src="sizes.grxml"/>')))
    assert [one.code for one in problems] == ["not-fetched"]


def test_a_long_chain_of_rules_can_be_pickled() -> None:
    depth = 500
    rules = "".join(f'<rule id="r{i}"><ruleref uri="#r{i + 1}"/></rule>' for i in range(depth))
    made = document(ASK.format(f'<grammar>{rules}<rule id="r{depth}">yes</rule></grammar>'))
    again = pickle.loads(pickle.dumps(made.forms["f"].items[0]))
    assert again.answers.match("Yes") == "Yes"


def test_a_transcript_tells_which_grammars_its_run_was_made_with(folder: Path) -> None:
    path = str(written(folder, '<grammar src="sizes.grxml"/>'))
    made = api.rehearse(api.stage([], [path], ["a small"]))
    named = [name for name in made.records[0]["data"]["files"] if name.endswith("sizes.grxml")]
    assert len(named) == 1
    assert api.replay(made, api.stage([], [path], ["a small"])).records == made.records
    (folder / "sizes.grxml").write_text(SIZES + "<!-- another -->", "utf-8")
    with pytest.raises(UsageError, match=r"sizes\.grxml is not the file"):
        api.replay(made, api.stage([], [path], ["a small"]))


def test_a_rule_without_a_name_is_not_offered(folder: Path) -> None:
    rules = '<rule><ruleref uri="#sweets"/></rule><rule id="drink">tea</rule>'
    problems = api.validate([written(folder, f'<grammar root="drink">{rules}</grammar>')])
    assert [one.remedy for one in problems if one.code == "no-such-rule"] == ["Write drink."]
