"""What callers of the package give wrongly is told as what they gave."""

from __future__ import annotations

import io
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from math import nan
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import pytest
from numpy import float32, int64

import prima
from prima import api, graph, report
from tests import ROOT

DOCUMENTS = ROOT / "documents"
SCENARIO = DOCUMENTS / "scenarios" / "touched-on-the-way.xml"
MADE = prima.Transcript([{"time": 0.0, "phase": "run", "actor": "mediator", "data": {}}])
FOLLOW, MUSEUM = DOCUMENTS / "fa" / "follow.xml", DOCUMENTS / "ea" / "museum.xml"


@pytest.mark.parametrize("call", [prima.rehearse, prima.run_live])
@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"bound": 0}, "bound=0: write a whole number from 1."),
        ({"patience": -1}, "patience=-1: write a whole number from 0 to 86400000."),
        ({"patience": 86_400_001}, "patience=86400001: write a whole number from 0 to 86400000."),
        ({"policy": ["prima"]}, "policy=['prima']: write the name of one policy."),
        ({"isolate": "some"}, 'isolate="some": write all, ea or none.'),
        ({"hosts": "http://a"}, '"http://a" is not a host name'),
    ],
)
def test_a_wrong_value_is_told_before_anything_runs(
    call: Callable[..., object], given: dict[str, Any], told: str
) -> None:
    with pytest.raises(prima.UsageError) as caught:
        call(SCENARIO, **given)
    assert told in str(caught.value)


def test_a_sweep_is_made_of_no_wrong_word() -> None:
    with pytest.raises(prima.UsageError, match='isolate="some"'):
        prima.sweep(SCENARIO, isolate="some", workers=1)


@pytest.mark.parametrize("seed", [-1, 1_000_000_000])
def test_a_seed_is_one_that_a_scenario_can_have(seed: int) -> None:
    with pytest.raises(prima.UsageError, match=f"seed={seed}: write a whole number from 0 to 999"):
        prima.rehearse(SCENARIO, seed=seed)


@pytest.mark.parametrize(
    "use",
    [
        lambda made: made.rows(),
        lambda made: made.run(),
        lambda made: made.dumps(),
        lambda made: prima.replay(made, SCENARIO),
        lambda made: prima.diff(made, made),
        lambda made: prima.export(made, "csv", io.BytesIO()),
    ],
)
def test_records_that_were_not_kept_are_missed(use: Callable[[prima.Transcript], object]) -> None:
    made = prima.rehearse(SCENARIO, keep=False, isolate="none")
    with pytest.raises(prima.UsageError, match="its records were not kept: run it with keep=True"):
        use(made)
    assert made.summary().seconds > 30
    assert prima.rehearse(SCENARIO, keep=False, rows=True, isolate="none").rows()


def test_one_path_is_not_its_letters() -> None:
    assert prima.validate(str(MUSEUM)) == prima.validate(MUSEUM) == prima.validate([MUSEUM])
    for fa, ea in ((FOLLOW, MUSEUM), (str(FOLLOW), [MUSEUM])):
        made = prima.stage(fa, ea, robot=DOCUMENTS / "robots" / "papero.xml")
        assert [one.id for one in made.cast.documents] == ["follow", "museum"]


def test_a_name_that_no_file_can_have(tmp_path: Path) -> None:
    with pytest.raises(prima.UsageError, match="is not a file's name"):
        prima.read(f"{tmp_path}/a\0b")


def test_what_one_process_has_made_another_one_reads() -> None:
    made = prima.rehearse(SCENARIO, isolate="none", visits=True, entries=True)
    made.run()
    again = pickle.loads(pickle.dumps(made))
    assert (again.dumps(), len(again.visits)) == (made.dumps(), len(made.visits))
    assert (again.table(), again.summary()) == (made.table(), made.summary())


@pytest.mark.parametrize(
    "wrong", [lambda: prima.load(SCENARIO), lambda: prima.rehearse(SCENARIO, policy="prma")]
)
def test_what_one_process_raises_another_one_reads(wrong: Callable[[], object]) -> None:
    with pytest.raises((prima.DocumentError, prima.UsageError)) as caught:
        wrong()
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is caught.type
    assert str(again) == str(caught.value)
    assert vars(again) == vars(caught.value)


@pytest.mark.parametrize("rows", [False, True])
@pytest.mark.parametrize("kind", [ValueError, KeyError, TypeError, KeyboardInterrupt])
def test_what_a_sink_raises_is_raised(kind: type[BaseException], rows: bool) -> None:
    def sink(_line: str) -> None:
        raise kind("full")

    with pytest.raises(kind, match="full"):
        prima.rehearse(SCENARIO, sink=sink, rows=rows, isolate="none")


@pytest.mark.parametrize(
    "use",
    [
        lambda path: prima.diff(path, path),
        lambda path: prima.replay(path, SCENARIO),
        lambda path: prima.explain_row(path, 1),
        lambda path: report.make([path]),
    ],
)
def test_the_path_of_a_transcript_is_not_one(use: Callable[[str], object]) -> None:
    with pytest.raises(prima.UsageError, match="is not a transcript: read it with"):
        use("a.jsonl")


@pytest.mark.parametrize("given", [None, 1.5, [], b"a"])
@pytest.mark.parametrize(
    "use",
    [
        prima.load,
        prima.load_scenario,
        prima.read,
        api.skim,
        prima.rehearse,
        graph.picture,
        lambda path: prima.export(path, "csv", "a.csv"),
        lambda path: prima.export(prima.Transcript([]), "csv", path),
    ],
)
def test_what_is_no_path_is_told(use: Callable[[Any], object], given: object) -> None:
    with pytest.raises(prima.UsageError, match="is not a file's name"):
        use(given)


@pytest.mark.parametrize(
    "use", [prima.load, prima.load_scenario, prima.read, api.skim, graph.picture]
)
def test_a_number_is_no_file_that_happens_to_be_open(
    use: Callable[[Any], object], tmp_path: Path
) -> None:
    with (tmp_path / "a").open("wb") as stream:
        with pytest.raises(prima.UsageError, match="is not a file's name"):
            use(stream.fileno())
        stream.write(b"still open")


def test_a_loaded_scenario_finds_its_files_from_every_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "tea.gram").write_text("#ABNF 1.0;\nlanguage en;\nroot $t;\n$t = tea;\n")
    (tmp_path / "ask.vxml").write_text(
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"><form>'
        '<field name="f"><grammar src="tea.gram" type="application/srgs"/><prompt>What?</prompt>'
        "</field></form></vxml>"
    )
    monkeypatch.chdir(tmp_path)
    loaded = prima.stage([], "ask.vxml", "Tea.")
    made = prima.rehearse(loaded, isolate="none")
    assert not made.failures
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert prima.rehearse(loaded, isolate="none").dumps() == made.dumps()


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: prima.validate(b"x"), "paths"),  # type: ignore[arg-type]
        (lambda: prima.validate([b"x"]), "paths"),  # type: ignore[list-item]
        (lambda: prima.stage(b"x", []), "fas"),  # type: ignore[arg-type]
        (lambda: prima.stage([], b"x"), "eas"),  # type: ignore[arg-type]
        (lambda: prima.stage(FOLLOW, [], world=b"x"), "world"),  # type: ignore[arg-type]
        (lambda: prima.stage(FOLLOW, [], robot=b"x"), "robot"),  # type: ignore[arg-type]
        (lambda: prima.run_live(b"x"), "scenario"),  # type: ignore[arg-type]
        (lambda: prima.sweep(b"x", workers=1), "scenarios"),  # type: ignore[arg-type]
    ],
)
def test_bytes_are_no_path(call: Callable[[], object], argument: str) -> None:
    with pytest.raises(prima.UsageError) as caught:
        call()
    assert str(caught.value) == f"{argument}=b'x': write a path, as a text or a Path."


def test_no_transcript_is_overwritten_by_what_is_made_from_it(tmp_path: Path) -> None:
    path = tmp_path / "t.jsonl"
    text = prima.rehearse(SCENARIO, isolate="none").dumps()
    path.write_text(text, encoding="utf-8")
    (tmp_path / "same.csv").symlink_to(path)
    for output in (path, tmp_path / "same.csv"):
        with pytest.raises(prima.UsageError, match="this is the transcript itself: name another"):
            prima.export(path, "csv", output)
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("to", ["csv", "eaf", "mcap"])
def test_no_export_is_written_to_a_stream_that_takes_none(to: str, tmp_path: Path) -> None:
    made = prima.rehearse(SCENARIO, isolate="none")
    (tmp_path / "a").write_bytes(b"kept")
    stream = (tmp_path / "a").open("rb")
    with pytest.raises(prima.UsageError, match="output can only be read: open the file with"):
        prima.export(made, to, stream)
    stream.close()
    with pytest.raises(prima.UsageError, match="output is closed: "):
        prima.export(made, to, stream)
    closed = io.BytesIO()
    closed.close()
    with pytest.raises(prima.UsageError, match="output is closed: "):
        prima.export(made, to, closed)
    with NamedTemporaryFile("w") as text, pytest.raises(prima.UsageError, match="takes bytes: "):
        prima.export(made, to, text)  # type: ignore[arg-type]
    assert (tmp_path / "a").read_bytes() == b"kept"


def test_a_console_completes_what_the_package_gives() -> None:
    """Python's console completes by ``dir``, before anything is imported."""
    code = "import prima; print(set(prima.__all__) - set(dir(prima)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_codes_are_explained_and_similar_ones_named() -> None:
    assert "not ECMAScript" in prima.explain("bad-expression")
    with pytest.raises(prima.UsageError, match=r'no code "bad-expresion". Did you mean "bad-exp'):
        prima.explain("bad-expresion")


def test_a_voicexml_document_is_told_from_an_application_in_primas_language() -> None:
    with pytest.raises(prima.DocumentError) as caught:
        prima.load(DOCUMENTS / "ea" / "pizza.vxml")
    told = "This is a VoiceXML document; an application in PRIMA's language is needed here."
    assert caught.value.problems[0].message == told


def test_a_transcript_that_is_read_or_replayed_says_how_its_run_ended(tmp_path: Path) -> None:
    made = prima.rehearse(SCENARIO)
    path = tmp_path / "t.jsonl"
    path.write_text(made.dumps(), encoding="utf-8")
    assert made.outcome == "quiet"
    assert prima.read(path).outcome == prima.replay(made, SCENARIO).outcome == made.outcome
    lines = made.dumps().splitlines(keepends=True)
    path.write_text("".join(lines[:-1]), encoding="utf-8")
    assert prima.read(path).outcome == ""


def test_records_of_a_live_run_that_were_not_kept_are_named() -> None:
    made = prima.run_live(SCENARIO, speed=1000, keep=False)
    with pytest.raises(prima.UsageError) as caught:
        made.summary()
    assert str(caught.value) == f"{SCENARIO}: its records were not kept: run it with keep=True."


@pytest.mark.parametrize(
    ("call", "given", "told"),
    [
        (prima.explain, {"code": 5}, "code=5: write a text."),
        (MADE.table, {"columns": "80"}, "columns='80': write a whole number from 0."),
        (MADE.table, {"columns": None}, "columns=None: write a whole number from 0."),
        (MADE.table, {"columns": 80.5}, "columns=80.5: write a whole number from 0."),
        (graph.picture, {"path": FOLLOW, "to": None}, "to=None: write a text."),
        (graph.picture, {"path": FOLLOW, "what": 5}, "what=5: write a text."),
        (prima.export, {"to": b"csv", "output": "a.csv"}, "to=b'csv': write a text."),
        (
            prima.export,
            {"to": "eaf", "output": "a.eaf", "languages": 5},
            "languages=5: write a dict.",
        ),
        (prima.export, {"to": "csv", "output": io.StringIO()}, "output takes bytes: open the"),
        (prima.validate, {"paths": MUSEUM, "maps": b"x"}, "maps=b'x': write a text."),
        (prima.validate, {"paths": MUSEUM, "maps": 5}, "maps=5: write a text."),
        (prima.stage, {"fas": FOLLOW, "eas": [], "maps": [b"x"]}, "maps=b'x': write a text."),
        (prima.stage, {"fas": FOLLOW, "eas": [], "says": [5]}, "says=5: write a text."),
        (prima.rehearse, {"scenario": SCENARIO, "hosts": [5]}, "hosts=5: write a text."),
        (prima.rehearse, {"scenario": SCENARIO, "sink": 5}, "sink=5: write a function."),
        (prima.load_scenario, {"path": SCENARIO, "robot": 0}, "robot=0: write a path,"),
        (prima.load_scenario, {"path": SCENARIO, "robot": b""}, "robot=b'': write a path,"),
        (prima.run_live, {"scenario": SCENARIO, "warn": "x"}, "warn='x': write a function."),
        (prima.run_live, {"scenario": SCENARIO, "maps": 5}, "maps=5: write a text."),
        (prima.run_live, {"scenario": SCENARIO, "output": 5}, "output=5: write a path,"),
        (prima.run_live, {"scenario": SCENARIO, "speed": "9"}, "The speed is '9': write a number"),
        (prima.sweep, {"scenarios": SCENARIO, "vary": 5}, "vary=5: write a dict."),
        (prima.sweep, {"scenarios": SCENARIO, "vary": {5: "a"}}, "vary=5: write a text."),
        (prima.sweep, {"scenarios": SCENARIO, "vary": {"answer": []}}, "answer: there are no"),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": range(0)}},
            "answer: there are no",
        ),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": None}},
            "answer: None cannot be a level.",
        ),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": ["a", None]}},
            "answer: None cannot",
        ),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": [nan]}},
            "answer: nan cannot be a level.",
        ),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": [b"x"]}},
            "answer: b'x' cannot be a level.",
        ),
        (
            prima.sweep,
            {"scenarios": SCENARIO, "vary": {"answer": {"a"}}},
            "answer: {'a'} cannot be a level.",
        ),
        (prima.sweep, {"scenarios": SCENARIO, "policies": [5]}, "policies=5: write a text."),
        (prima.sweep, {"scenarios": SCENARIO, "output": b"x"}, "output=b'x': write a path,"),
        (prima.sweep, {"scenarios": SCENARIO, "output": 0}, "output=0: write a path,"),
        (prima.sweep, {"scenarios": "a\0b"}, "'a\\x00b' is not a file's name."),
        (prima.sweep, {"scenarios": "\ud800"}, "'\\ud800' is not a file's name."),
        (prima.stage, {"fas": FOLLOW, "eas": [], "world": 0}, "world=0: write a path,"),
        (prima.stage, {"fas": FOLLOW, "eas": [], "robot": []}, "robot=[]: write a path,"),
        (prima.explore, {"scenario": 5}, "scenario=5: write a path,"),
        (prima.explore, {"scenario": SCENARIO, "moves": [5]}, "moves=5: write a text."),
        (prima.explore, {"scenario": SCENARIO, "within": None}, "within=None: write a whole"),
        (prima.explore, {"scenario": SCENARIO, "output": b"x"}, "output=b'x': write a path,"),
        (prima.explore, {"scenario": SCENARIO, "output": []}, "output=[]: write a path,"),
        (prima.export, {"to": "csv", "output": "a" * 300}, f"{'a' * 300}: cannot be written:"),
        (
            prima.export,
            {"transcript": "a" * 300, "to": "csv", "output": "a.csv"},
            f"{'a' * 300}: cannot be read:",
        ),
    ],
)
def test_a_value_of_another_type_is_told_with_its_argument(
    call: Callable[..., object], given: dict[str, Any], told: str
) -> None:
    if call is prima.export:
        given = {"transcript": MADE, **given}
    with pytest.raises(prima.UsageError) as caught:
        call(**given)
    assert str(caught.value).startswith(told)


@dataclass
class Named:
    """A path of another kind, such as an entry of a folder."""

    name: str | bytes

    def __fspath__(self) -> str | bytes:
        return self.name


def test_a_path_of_any_kind_is_one(tmp_path: Path) -> None:
    scenario: Any = Named(str(SCENARIO))
    journal: Any = Named(str(tmp_path / "t.jsonl"))
    table: Any = Named(str(tmp_path / "t.csv"))
    app: Any = Named(str(FOLLOW))
    made = prima.rehearse(scenario, isolate="none")
    assert made.dumps() == prima.rehearse(SCENARIO, isolate="none").dumps()
    (tmp_path / "t.jsonl").write_text(made.dumps(), encoding="utf-8")
    assert prima.read(journal).name == journal.name
    prima.export(journal, "csv", table)
    assert prima.load(app).file == str(FOLLOW)
    assert prima.validate(app) == prima.validate(FOLLOW)
    robot: Any = Named(str(DOCUMENTS / "robots" / "papero.xml"))
    for other in (robot, Path(robot.name), None):
        assert prima.load_scenario(SCENARIO, robot=other).cast.robot.id == "papero"
    assert prima.stage(app, []).files == prima.stage(FOLLOW, []).files
    prima.run_live(scenario, output=Named(str(tmp_path / "live.jsonl")), speed=1000)  # type: ignore[arg-type]
    assert {one.name for one in tmp_path.iterdir()} == {"t.jsonl", "t.csv", "live.jsonl"}


@pytest.mark.parametrize(
    "use", [prima.load, prima.rehearse, prima.read, prima.validate, prima.run_live, prima.explore]
)
def test_a_path_of_bytes_is_none(use: Callable[[Any], object]) -> None:
    with pytest.raises(prima.UsageError, match=r"write a path|is not a file's name"):
        use(Named(b"x"))


def test_a_large_value_is_not_told_whole() -> None:
    for name in ("scenario", "policy", "bound"):
        given: dict[str, Any] = {"scenario": SCENARIO, name: ["x"] * 1000}
        with pytest.raises(prima.UsageError) as caught:
            prima.rehearse(**given)
        assert len(str(caught.value)) < 200


@pytest.mark.parametrize("number", ["3", 1.5, None, b"3"])
def test_a_row_has_a_whole_number(number: Any) -> None:
    made = prima.rehearse(SCENARIO, isolate="none")
    with pytest.raises(prima.UsageError) as caught:
        prima.explain_row(made, number)
    assert str(caught.value) == f"number={number!r}: write the number of a row."
    with pytest.raises(prima.UsageError) as again:
        made.row(number)
    assert str(again.value) == str(caught.value)


def test_numbers_of_numpy_are_numbers(tmp_path: Path) -> None:
    one: Any = int64(1)
    two: Any = int64(2)
    many: Any = int64(1000)
    fast: Any = float32(1000)
    made = prima.rehearse(SCENARIO, bound=two, patience=one, seed=one, isolate="none")
    same = prima.rehearse(SCENARIO, bound=2, patience=1, seed=1, isolate="none")
    assert made.dumps() == same.dumps()
    assert made.row(two) == made.row(2)
    journal = tmp_path / "t.jsonl"
    live = prima.run_live(SCENARIO, speed=many, until=many, output=journal)
    assert live.outcome == "until"
    assert prima.run_live(SCENARIO, speed=fast, until=500).outcome == "until"
    assert prima.sweep(SCENARIO, seeds=two, workers=one, isolate="none").num_rows == 2
    assert prima.explore(SCENARIO, within=one, depth=one, runs=two, workers=one, isolate="none")
    with pytest.raises(prima.UsageError, match="write a whole number from 0 to 999"):
        prima.rehearse(SCENARIO, seed=-one)
