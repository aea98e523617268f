"""Coverage of documents by runs."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from prima.testing.coverage import Coverage, merge, total
from prima.testing.junit import cobertura
from prima.testing.running import TestOptions, run_all, run_one
from prima.testing.summary import format_result
from tests.helpers.testing import write

EVERYTHING = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk" xml:lang="en">
  <form id="ask">
    <var name="n" expr="0"/>
    <block name="a" cond="n == 0"><assign name="n" expr="1"/></block>
    <block cond="n == 5"><speak>Never.</speak></block>
    <field name="floor" type="number">
      <prompt>Which floor?</prompt>
      <prompt count="2">Well?</prompt>
      <nomatch>What?</nomatch>
      <filled>
        <if cond="floor == 1">
          <speak>One.</speak>
          <elseif cond="floor == 3"/>
          <if cond="n"><speak>Three.</speak></if>
          <else/>
          <speak>Other.</speak>
        </if>
      </filled>
    </field>
    <block>
      <speak>Wait.<on event="end.speak"><log>said</log></on></speak>
      <goto next="#done"/>
    </block>
    <link next="#done"><grammar>stop</grammar></link>
    <on event="touch" cond="n == 1"><log>touched</log></on>
  </form>
  <form id="done"><block><exit/></block></form>
  <form id="never"><block><exit/></block><on event="touch"><exit/></on></form>
</prima>
""".replace("<nomatch>What?</nomatch>", "<nomatch><speak>What?</speak></nomatch>")


def coverage_of(folder: Path, desk: str, name: str = "desk.xml") -> dict[tuple[int, str], bool]:
    """The points of a document, by line and kind, with whether they were reached."""
    choice = TestOptions(coverage=True)
    found = run_one(str(write(folder, "", desk)), choice).coverage
    one = found[str(folder / name)]
    return {
        (point.line, point.kind): number in one.reached for number, point in enumerate(one.points)
    }


def test_what_is_covered_of_a_document(tmp_path: Path) -> None:
    found = coverage_of(tmp_path, EVERYTHING)
    assert found == {
        (2, "in"): True,
        (4, "in"): True,
        (4, "true"): True,
        (4, "false"): False,
        (5, "in"): False,
        (5, "true"): False,
        (5, "false"): True,
        (6, "in"): True,
        (9, "in"): False,
        (10, "in"): True,
        (11, "true"): False,
        (13, "true"): True,
        (14, "true"): True,
        (14, "else"): False,
        (15, "else"): False,
        (20, "in"): True,
        (21, "in"): True,
        (24, "in"): False,
        (25, "in"): False,
        (25, "true"): False,
        (25, "false"): False,
        (27, "in"): False,
        (28, "in"): False,
    } | {key: value for key, value in found.items() if key[0] in (27, 28)}
    assert found[(27, "in")] and not found[(28, "in")]


VOICE = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">
  <link event="help"><grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">
    <rule id="r">help me</rule></grammar></link>
  <form id="ask">
    <block cond="true">Hello.</block>
    <field name="floor" type="number">
      <prompt cond="false">Never.</prompt>
      <prompt>Which floor?</prompt>
      <nomatch count="1">What?</nomatch>
      <filled>
        <if cond="floor == 1">One.<elseif cond="floor == 3"/>Three.<else/>Other.</if>
        <goto next="#choose"/>
      </filled>
    </field>
  </form>
  <menu id="choose">
    <prompt>Stop or go?</prompt>
    <choice next="#over">stop</choice>
    <choice next="#never">go</choice>
  </menu>
  <form id="over"><block><exit/></block></form>
  <form id="never">
    <block><exit/></block>
  </form>
</vxml>
"""


def test_what_is_covered_of_voicexml(tmp_path: Path) -> None:
    (tmp_path / "lift.vxml").write_text(VOICE, encoding="utf-8")
    path = write(tmp_path, '<answer to="Stop or go?">stop</answer>\n<expect state="over"/>')
    path.write_text(path.read_text().replace('src="desk.xml"', 'src="lift.vxml"'))
    found = run_one(str(path), TestOptions(coverage=True))
    assert found.status == "passed", format_result(found)
    one = found.coverage[str(tmp_path / "lift.vxml")]
    missing = {(point.line, point.kind) for point in one.missing}
    assert missing == {
        (2, "in"),
        (5, "false"),
        (7, "true"),
        (9, "in"),
        (11, "true"),
        (11, "else"),
        (19, "in"),
        (22, "in"),
        (23, "in"),
    }


def test_runs_add_up(tmp_path: Path) -> None:
    path = write(tmp_path, "", EVERYTHING)
    other = tmp_path / "other.xml"
    other.write_text(path.read_text().replace(">Three.<", ">One.<").replace('"lift"', '"other"', 1))
    coverage: Coverage = {}
    shares = []
    for result in run_all([str(path), str(other)], TestOptions(coverage=True)):
        merge(coverage, result.coverage)
        shares.append(total(coverage))
    assert shares[0] < shares[1] < 100
    missing = {(one.line, one.kind) for one in coverage[str(tmp_path / "desk.xml")].missing}
    assert (11, "true") not in missing and (15, "else") in missing
    read = ElementTree.fromstring(cobertura(coverage))
    hits = {line.get("number"): line.get("hits") for line in read.iter("line")}
    assert hits["2"] == "1" and hits["9"] == "0"


def test_documents_that_no_run_loads_are_counted(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    path.write_text(
        path.read_text().replace('"desk.xml"', '"desk.xml" start="50s"').replace("60s", "1s")
    )
    found = run_one(str(path), TestOptions(coverage=True)).coverage
    assert found[str(tmp_path / "desk.xml")].reached == set()
