"""Sweeps and explorations of VoiceXML are not resumed with other grammars, scripts or sounds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.here import prima
from tests.helpers.spoken import recording
from tests.helpers.sweeps import write_visit

PAGE = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">
  <script src="names.js"/>
  <form><field name="town"><prompt>Where to? <audio src="tune.wav"/></prompt>
  <grammar src="towns.grxml"/></field></form>
</vxml>
"""
GRAMMAR = """<grammar version="1.0" xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en" root="r">
<rule id="r" scope="public"><ruleref uri="more.grxml#r"/></rule></grammar>
"""
SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"
 world="{documents}/worlds/office.xml" robot="{documents}/robots/papero.xml">
  <application src="main.vxml"/>
  <when at="3s"><say>Rome.</say></when>
</scenario>
"""
SWEEP = ("sweep", "visit.xml", "--vary", "when.at=3s|4s", "--workers", "1", "-o", "t.csv")
EXPLORE = ("explore", "visit.xml", "--within", "100ms", "--workers", "1", "-o", "found")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    from prima import documents_folder

    (tmp_path / "main.vxml").write_text(PAGE)
    (tmp_path / "names.js").write_text("var n = 1;")
    (tmp_path / "towns.grxml").write_text(GRAMMAR)
    (tmp_path / "more.grxml").write_text(GRAMMAR.replace('<ruleref uri="more.grxml#r"/>', "Rome"))
    recording(tmp_path / "tune.wav", 1)
    scenario = SCENARIO.replace("{documents}", str(documents_folder()))
    (tmp_path / "visit.xml").write_text(scenario)
    return tmp_path


@pytest.mark.parametrize("name", ["names.js", "towns.grxml", "more.grxml", "tune.wav", "main.vxml"])
def test_what_has_changed_is_noticed(folder: Path, name: str) -> None:
    assert prima(*SWEEP, cwd=folder).returncode == 0
    again = prima(*SWEEP, "--resume", cwd=folder)
    assert (again.returncode, again.stderr) == (0, "2 of 2 runs had been made before\n")
    path = folder / name
    if name == "tune.wav":
        recording(path, 2)
    else:
        path.write_bytes(path.read_bytes() + b"\n")
    refused = prima(*SWEEP, "--resume", cwd=folder)
    assert refused.returncode == 2 and "it was made with other documents" in refused.stderr


def test_files_that_were_exchanged(tmp_path: Path) -> None:
    visit = write_visit(tmp_path)
    visit.write_text(visit.read_text().replace('speed="1"', 'user="one.xml"'))
    user = '<user xmlns="urn:prima:user:1" version="1.0" id="{}"><answers after="{}"/></user>'
    one, two = user.format("one", "1s"), user.format("two", "4s")
    made = ("--vary", "person.user=one.xml|two.xml", "--workers", "1", "-o", "t.csv")
    (tmp_path / "one.xml").write_text(one)
    (tmp_path / "two.xml").write_text(two)
    assert prima("sweep", "visit.xml", *made, cwd=tmp_path).returncode == 0
    again = prima("sweep", "visit.xml", *made, "--resume", cwd=tmp_path)
    assert (again.returncode, again.stderr) == (0, "2 of 2 runs had been made before\n")
    (tmp_path / "one.xml").write_text(two)
    (tmp_path / "two.xml").write_text(one)
    refused = prima("sweep", "visit.xml", *made, "--resume", cwd=tmp_path)
    assert refused.returncode == 2 and "it was made with other documents" in refused.stderr


def test_measured_values_that_have_changed(tmp_path: Path) -> None:
    write_visit(tmp_path)
    made = ("--vary", "touch=empirical(touches.csv)", "--seeds", "2", "--workers", "1")
    (tmp_path / "touches.csv").write_text("1\n2\n")
    assert prima("sweep", "visit.xml", *made, "-o", "t.csv", cwd=tmp_path).returncode == 0
    again = prima("sweep", "visit.xml", *made, "-o", "t.csv", "--resume", cwd=tmp_path)
    assert (again.returncode, again.stderr) == (0, "2 of 2 runs had been made before\n")
    (tmp_path / "touches.csv").write_text("1\n3\n")
    refused = prima("sweep", "visit.xml", *made, "-o", "t.csv", "--resume", cwd=tmp_path)
    assert refused.returncode == 2 and "it was made with other documents" in refused.stderr


def test_an_archive_makes_no_difference(folder: Path) -> None:
    from prima import documents_folder

    for kind, name in (("worlds", "office.xml"), ("robots", "papero.xml")):
        (folder / name).write_bytes((documents_folder() / kind / name).read_bytes())
    path = folder / "visit.xml"
    text = path.read_text().replace(f"{documents_folder()}/", "")
    path.write_text(text.replace("worlds/", "").replace("robots/", ""))
    for first, then in (((), ("--bundle", "t.zip")), (("--bundle", "t.zip"), ())):
        assert prima(*SWEEP, *first, cwd=folder).returncode == 0
        again = prima(*SWEEP, *then, "--resume", cwd=folder)
        assert again.returncode == 0 and "2 of 2 runs had been made before" in again.stderr


def test_the_folder_from_which_a_command_is_given_makes_no_difference(folder: Path) -> None:
    from prima import documents_folder

    for kind, name in (("worlds", "office.xml"), ("robots", "papero.xml")):
        (folder / kind).mkdir()
        (folder / kind / name).write_bytes((documents_folder() / kind / name).read_bytes())
    text = (folder / "visit.xml").read_text().replace(f"{documents_folder()}/", "")
    (folder / "visit.xml").write_text(text)
    for command, scenario, *words in (SWEEP, EXPLORE):
        made = (command, folder / scenario, *words[:-1], folder / words[-1])
        assert prima(*made, cwd=folder).returncode == 0
        again = prima(*made, "--resume", cwd=folder / "robots")
        assert again.returncode == 0 and "had been made before" in again.stderr


def test_an_exploration_is_not_resumed_with_another_grammar(folder: Path) -> None:
    assert prima(*EXPLORE, cwd=folder).returncode == 0
    assert "had been made before" in prima(*EXPLORE, "--resume", cwd=folder).stderr
    path = folder / "more.grxml"
    path.write_text(path.read_text().replace("Rome", "Oslo"))
    again = prima(*EXPLORE, "--resume", cwd=folder)
    assert again.returncode == 2 and "Begin anew without --resume" in again.stderr
