"""A fix changes what is wrong and nothing else, however the document is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import ROOT
from tests.helpers.validating import mended_all

BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="tour">'
PREFIXED = (
    '<q:prima xmlns:q="urn:prima:dialogue:1" version="1.0" kind="ea" id="tour">\n'
    '  <q:form id="start">{}</q:form>\n</q:prima>\n'
)
VOICE = '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1">{}</vxml>'


def written(folder: Path, text: str, name: str = "tour.xml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "wrong", "right"),
    [
        (
            f"{BEGIN}<form id='end'><block><goto nextitem='end'/></block></form></prima>",
            "nextitem='end'",
            "next='#end'",
        ),
        (
            VOICE.format("<form id='a'><block><goto nextitem = 'a'/></block></form>"),
            "nextitem = 'a'",
            "next='#a'",
        ),
        (
            PREFIXED.format("<q:block><q:speek>Hi.</q:speak><q:exit/></q:block>"),
            "<q:speek>",
            "<q:speak>",
        ),
        (
            f'{BEGIN}<form id="a"><block><speek>Hi.</speak> <speek>Hello.</speak><exit/></block>',
            "<speek>Hi.",
            "<speak>Hi.",
        ),
    ],
)
def test_a_fix_keeps_quotes_and_prefixes(tmp_path: Path, text: str, wrong: str, right: str) -> None:
    assert mended_all(written(tmp_path, text)) == [text.replace(wrong, right)]


def test_a_variable_is_declared_with_the_prefix_of_its_form(tmp_path: Path) -> None:
    text = PREFIXED.format('<q:block cond="late"><q:exit/></q:block>')
    in_form, in_document = mended_all(written(tmp_path, text))
    assert '<q:form id="start">\n  <q:var name="late"/><q:block' in in_form
    assert 'id="tour">\n  <q:var name="late"/>\n  <q:form' in in_document


@pytest.mark.parametrize(
    ("named", "right"),
    [
        ("sub/my%20dialg.vxml#a", "sub/my dialog.vxml#a"),
        ("sub/my%20dialg.vxml?b=1#a", "sub/my dialog.vxml?b=1#a"),
        ("sub/Tom&apos;s dialg.vxml", "sub/Tom&apos;s dialog.vxml"),
    ],
)
def test_only_the_name_of_a_file_is_changed(tmp_path: Path, named: str, right: str) -> None:
    (tmp_path / "sub").mkdir()
    for name in ("my dialog.vxml", "Tom's dialog.vxml"):
        written(tmp_path / "sub", VOICE.format('<form id="a"/>'), name)
    text = VOICE.format(f"<form><block><goto next='{named}'/></block></form>")
    assert mended_all(written(tmp_path, text)) == [text.replace(named, right)]


WORLD = (
    '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="a" x="0" y="0"/>'
    '<area id="k" x1="0" y1="0" x2="1" y2="1" application="ea/tuor.xml"/></world>'
)
ROBOT = ROOT / "documents" / "robots" / "papero-plus.xml"
SCENE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" world="{}"'
    f' robot="{ROBOT}" entrances="open"><robot at="a"/>{{}}</scenario>'
)


def test_a_file_that_a_world_names_is_mended_in_the_world(tmp_path: Path) -> None:
    (tmp_path / "worlds" / "ea").mkdir(parents=True)
    written(tmp_path / "worlds" / "ea", "")
    world = written(tmp_path / "worlds", WORLD, "w.xml")
    scene = written(tmp_path, SCENE.format("worlds/w.xml", ""), "visit.xml")
    assert mended_all(scene, world) == [WORLD.replace("tuor", "tour")]
    assert mended_all(world) == [WORLD.replace("tuor", "tour")]


@pytest.mark.parametrize("quote", ['"', "'"])
def test_words_are_written_as_a_value_may_have_them(tmp_path: Path, quote: str) -> None:
    said = (
        "<form id='a'><block><speak>Tom's \"fish &amp; chips\" at two</speak><exit/></block></form>"
    )
    written(tmp_path, f"{BEGIN}{said}</prima>")
    world = written(tmp_path, WORLD.replace("ea/tuor", "tour"), "w.xml")
    lines = "<application src='tour.xml'/><never says={0}{1}{0}/>"
    wrong = SCENE.format(world.name, lines.format(quote, "Toms fish &amp; chips at twoo"))
    words = "Tom&apos;s &quot;fish &amp; chips&quot; at two"
    right = SCENE.format(world.name, lines.format(quote, words))
    assert mended_all(written(tmp_path, wrong, "visit.xml")) == [right]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_declared_encoding_on_a_line_of_its_own_is_mended_there(tmp_path: Path, end: str) -> None:
    text = "<?xml version='1.0'\n encoding='{}'?>\n" + VOICE.format(
        "<form><block>Olé.</block></form>"
    )
    path = tmp_path / "tour.vxml"
    path.write_bytes(text.format("ISO-8859-1").replace("\n", end).encode())
    assert mended_all(path) == [text.format("UTF-8")]
