"""Names in a scenario's expectations, in users and robots, and in the tags of grammars."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from prima.lsp import naming
from prima.lsp.complete import complete
from prima.lsp.workspace import Workspace
from tests.helpers.editor import BEGIN, VOICE, plain

WORLD = (
    '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="door" x="0" y="0"/></world>'
)
ROBOT = (
    '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><gesture name="bow"/>'
    '<driver kind="sim"><does gesture="bow" by="b"/><place name="door" x="1" y="1"/></driver></robot>'
)
USER = '<user xmlns="urn:prima:user:1" version="1.0" id="u"><when at="1s"><walk to="door"/></when></user>'
SCENE = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml" robot="r.xml">
<person x="0" y="0" user="u.xml"/><application src="one.xml"/><application src="two.xml" id="b"/>
<expect state="start" by="one"/><expect state="start" by="b"/><never state="start" at="3s"/>
<expect does="topological-move"><data name="to" value="door"/></expect>
<expect does="gesture"><data name="name" value="bow"/></expect>
</scenario>
"""
GRAMMAR = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" root="a" tag-format="%s">
<rule id="a"><ruleref uri="#size"/><ruleref uri="more.grxml#kind"/>
<tag>out.size = rules.size; out.kind = meta.kind.text;</tag></rule><rule id="size"><item>big</item></rule>
</grammar>"""
MORE = (
    '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"><rule id="kind"/></grammar>'
)


@pytest.fixture(name="space")
def fixture_space(tmp_path: Path) -> Workspace:
    form = '<form id="start"><block><exit/></block></form></prima>'
    files = {
        "w.xml": WORLD,
        "r.xml": ROBOT,
        "u.xml": USER,
        "s.xml": SCENE,
        "more.grxml": MORE,
        "one.xml": BEGIN.replace('id="x"', 'id="one"') + form,
        "two.xml": BEGIN.replace('id="x"', 'id="two"') + form,
        "size.grxml": GRAMMAR % "semantics/1.0",
        "literal.grxml": GRAMMAR % "semantics/1.0-literals",
    }
    made = Workspace()
    made.folders = [tmp_path.resolve()]
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return made


def renamed(space: Workspace, file: str, words: str) -> dict[str, int]:
    """How often a name, which begins at the end of some words, is renamed in each file."""
    path = space.folders[0] / file
    offset = path.read_text(encoding="utf-8").index(words) + len(words)
    edits, _ = naming.rename(space, path, offset, "other")
    names = [edit.path.name for edit in edits]
    return {name: names.count(name) for name in sorted(set(names))}


@pytest.mark.parametrize(
    ("file", "words", "made"),
    [
        ("one.xml", 'form id="', {"one.xml": 1, "s.xml": 2}),
        ("two.xml", 'form id="', {"s.xml": 1, "two.xml": 1}),
        ("s.xml", 'b"/><never state="', {"one.xml": 1, "s.xml": 2}),
        ("s.xml", 'by="one"/><expect state="', {"s.xml": 1, "two.xml": 1}),
        ("w.xml", 'place id="', {"r.xml": 1, "s.xml": 1, "u.xml": 1, "w.xml": 1}),
        ("r.xml", 'gesture name="', {"r.xml": 2, "s.xml": 1}),
        ("size.grxml", '</rule><rule id="', {"size.grxml": 3}),
        ("size.grxml", "rules.", {"size.grxml": 3}),
        ("more.grxml", 'rule id="', {"literal.grxml": 1, "more.grxml": 1, "size.grxml": 2}),
        ("literal.grxml", '</rule><rule id="', {"literal.grxml": 2}),
    ],
)
def test_a_name_is_renamed_wherever_it_is_used(
    space: Workspace, file: str, words: str, made: dict[str, int]
) -> None:
    assert renamed(space, file, words) == made


def test_the_pages_of_a_voicexml_application_belong_to_its_scenarios(space: Workspace) -> None:
    folder = space.folders[0]
    first = VOICE + '<form id="start"><block><goto next="more.vxml#more"/></block></form></vxml>'
    more = VOICE + '<form id="more"><block><p:topological-move to="door"/><goto next="first.vxml"/>'
    scene = SCENE.replace('src="two.xml" id="b"', 'src="first.vxml"').replace(
        'state="start" by="b"', 'state="more" by="first"'
    )
    for name, text in (("first.vxml", first), ("more.vxml", more), ("s.xml", scene)):
        (folder / name).write_text(text, encoding="utf-8")
    form = {"first.vxml": 1, "more.vxml": 1, "s.xml": 1}
    assert renamed(space, "more.vxml", 'form id="') == form
    assert renamed(space, "s.xml", 'state="start" by="one"/><expect state="') == form
    places = {"more.vxml": 1, "r.xml": 1, "s.xml": 1, "u.xml": 1, "w.xml": 1}
    assert renamed(space, "w.xml", 'place id="') == places
    assert renamed(space, "more.vxml", 'move to="') == places
    text, offset = plain(scene.replace('"more" by', '"|" by'))
    space.put((folder / "s.xml").as_uri(), text)
    assert {one.label for one in complete(space, folder / "s.xml", offset)} == {"start", "more"}


def test_a_page_whose_file_is_renamed_renames_no_application(space: Workspace) -> None:
    folder = space.folders[0]
    (folder / "in").mkdir()
    first = VOICE + '<form id="start"><block><goto next="in/two.vxml"/></block></form></vxml>'
    scene = SCENE.replace('src="one.xml"', 'src="first.vxml"').replace(
        'src="two.xml" id="b"', 'src="two.vxml"'
    )
    texts = {
        "first.vxml": first,
        "two.vxml": VOICE + "<form/></vxml>",
        "in/two.vxml": VOICE + "<form/></vxml>",
        "s.xml": scene.replace('by="b"', 'by="two"'),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    edits = naming.moved(space, {folder / "in" / "two.vxml": folder / "in" / "three.vxml"})
    assert [(edit.path.name, edit.text) for edit in edits] == [("first.vxml", "in/three.vxml")]


def test_states_are_proposed_of_the_application_that_is_named(space: Workspace) -> None:
    path = space.folders[0] / "s.xml"
    for by, names in (("one", {"start"}), ("b", {"start"}), ("two", set()), ("", {"start"})):
        text, offset = plain(SCENE.replace('state="start" by="one"', f'state="|" by="{by}"'))
        space.put(path.as_uri(), text)
        assert {one.label for one in complete(space, path, offset)} == names, by


def test_only_what_a_scenarios_own_robot_adds_is_proposed(space: Workspace) -> None:
    path = space.folders[0] / "s.xml"
    (space.folders[0] / "other.xml").write_text(
        ROBOT.replace('<gesture name="bow"/>', '<adds command="hop" devices="arm"/>')
        .replace('<does gesture="bow" by="b"/>', "")
        .replace('id="r"', 'id="other"'),
        encoding="utf-8",
    )
    for robot, offered in (("other.xml", True), ("r.xml", False)):
        scene = SCENE.replace("r.xml", robot)
        text, offset = plain(scene.replace("<never", '<when doing="|"/><never'))
        space.put(path.as_uri(), text)
        proposed = {one.label for one in complete(space, path, offset)}
        assert "speak" in proposed and ("hop" in proposed) == offered, robot


def test_a_tag_of_a_voicexml_document_s_own_grammar_reads_its_rules(space: Workspace) -> None:
    path = space.folders[0] / "v.vxml"
    path.write_text(
        f'{VOICE}<form id="a"><field name="f">{GRAMMAR % "semantics/1.0"}</field></form></vxml>'
    )
    assert renamed(space, "v.vxml", '</rule><rule id="') == {"v.vxml": 3}


def test_many_tags_take_no_long_time(tmp_path: Path) -> None:
    rules = "".join(
        f'<rule id="r{n}"><ruleref uri="#r{n + 1}"/><tag>out = rules.r{n + 1};</tag></rule>'
        for n in range(4000)
    )
    text = (GRAMMAR % "semantics/1.0").replace("</grammar>", rules + "</grammar>")
    space = Workspace()
    path = space.put((tmp_path / "x.grxml").as_uri(), text)
    assert path is not None
    began = time.process_time()
    assert len(naming.references(space, path, text.index('"r5"') + 1)) == 3
    assert time.process_time() - began < 5


def test_an_application_is_renamed_in_the_policy_that_prefers_it(space: Workspace) -> None:
    path = space.folders[0] / "s.xml"
    for policy, made in (("fixed:one", 2), ("fixed:b", 1), ("fixed", 1), ("one", 1)):
        path.write_text(SCENE.replace("<scenario", f'<scenario policy="{policy}"'), "utf-8")
        fresh = Workspace()
        fresh.folders = space.folders
        assert renamed(fresh, "one.xml", 'id="') == {"one.xml": 1, "s.xml": made}, policy


def test_applications_are_proposed_for_a_policy(space: Workspace) -> None:
    path = space.folders[0] / "s.xml"
    text, offset = plain(SCENE.replace("<scenario", '<scenario policy="|"'))
    space.put(path.as_uri(), text)
    proposed = {one.insert for one in complete(space, path, offset)}
    assert {"prima", "fifo", "fixed:one", "fixed:b"} <= proposed


def test_the_devices_of_every_robot_are_proposed_where_no_robot_lists_its_own(
    space: Workspace,
) -> None:
    path = space.folders[0] / "r.xml"
    for own, offered in (("", True), ('<device name="tail"/>', False)):
        text, offset = plain(
            ROBOT.replace("<gesture", f'{own}<adds command="hop" devices="|"/><gesture')
        )
        space.put(path.as_uri(), text)
        proposed = {one.label for one in complete(space, path, offset)}
        assert ("arm" in proposed, "tail" in proposed) == (offered, not offered)
