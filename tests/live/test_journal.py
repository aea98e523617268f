"""The journal: cut off anywhere, a run goes on, and says nothing twice but what was cut."""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from prima import api
from prima.devices.loop import Loop
from prima.errors import RunError, UsageError
from prima.journal import replay_instants
from prima.live.devices import LiveDevices
from prima.live.journal import Journal, going_on, known, lacking, read_broken
from prima.messages import Record
from prima.sim.devices import Cast
from prima.transcript.lines import finished
from tests import ROOT
from tests.live.stage import carried_out, live_loop
from tests.live.test_live import HELLO, ROBOT, prima

SCENARIOS = Path(__file__).parents[2] / "documents" / "scenarios"
HEAD: Record = {
    "time": 0,
    "phase": "run",
    "actor": "mediator",
    "data": {"policy": "prima", "live": {}},
}


def cast_of(name: str) -> Cast:
    cast = api.load_scenario(SCENARIOS / f"{name}.xml").cast
    cast.offers.clear()
    return cast


def written(records: list[Record]) -> str:
    return "".join(json.dumps(record) + "\n" for record in [HEAD, *records])


def gone_on(cast: Cast, path: Path) -> list[Record]:
    """The whole journal of a run that goes on after it was cut off."""
    broken = read_broken(str(path))
    loop = live_loop(cast, start=broken.time)
    again = replay_instants(loop.session, broken.records)
    missed = [finished(record) for record in lacking(broken, again)]
    loop.go_on(broken.time)
    assert isinstance(loop.devices, LiveDevices)
    state = known(broken.records)
    loop.devices.go_on(state, list(going_on(state)))
    return [*broken.records[1:], *missed, *carried_out(loop, broken.time)]


def replayed(cast: Cast, records: list[Record]) -> list[Record]:
    loop: Loop = live_loop(cast)
    try:
        again = [finished(one) for one in replay_instants(loop.session, [HEAD, *records])]
    finally:
        loop.session.close()
    return again


def said(records: list[Record]) -> Counter[str]:
    """How often each behaviour with a text has started, by its name."""
    return Counter(
        record["behavior"]
        for record in records
        if record["phase"] == "start" and record.get("text")
    )


def check_going_on(cast: Cast, records: list[Record], cut: int, path: Path) -> None:
    """Cut a run off after some records, let it go on, and look at what came of it."""
    path.write_text(written(records[:cut]))
    whole = gone_on(cast, path)
    assert whole[:cut] == records[:cut]
    again = replayed(cast, whole)
    assert again == whole[: len(again)]
    assert {record["phase"] for record in whole[len(again) :]} <= {"over"}
    ended = {record["behavior"] for record in records[:cut] if record["phase"] == "end"}
    twice = {name for name, times in said(whole).items() if times > 1}
    halted = {
        record["behavior"]
        for record in whole
        if record["phase"] == "cancel" and record.get("outcome") == "halted"
    }
    already = {name for name, times in said(records).items() if times > 1}
    assert not (twice - already) & ended, "what was said to its end is said again"
    assert twice - already <= halted, "only what was cut starts again"


@pytest.mark.parametrize("name", ["touched-on-the-way", "picture-alone"])
def test_a_run_goes_on_wherever_it_was_cut_off(name: str, tmp_path: Path) -> None:
    cast = cast_of(name)
    cast.robot.speed *= 4  # another loop of the same movement is not another cut
    records = carried_out(live_loop(cast))
    for cut in range(1, len(records)):
        check_going_on(cast, records, cut, tmp_path / "visit.jsonl")


def test_a_run_goes_on_that_was_cut_off_while_it_went_on(tmp_path: Path) -> None:
    """The stop that was pressed because of the first cut is nobody's: it is released after the second."""
    cast, path = cast_of("touched-on-the-way"), tmp_path / "visit.jsonl"
    records = carried_out(live_loop(cast))
    speaks = next(at for at, one in enumerate(records) if one["phase"] == "start" and "text" in one)
    path.write_text(written(records[: speaks + 1]))
    once = gone_on(cast, path)
    pressed = next(at for at, one in enumerate(once) if one["phase"] == "emergency")
    for cut in range(speaks + 2, pressed + 6):
        path.write_text(written(once[:cut]))
        twice = gone_on(cast, path)
        told = [one["outcome"] for one in twice if one["phase"] == "emergency"]
        assert told[-1] == "released" and twice[-1]["phase"] == "over"
        assert said(twice).keys() == said(once).keys(), "it goes on to its end"


def test_a_stop_that_somebody_has_pressed_stays_so(tmp_path: Path) -> None:
    cast, path = cast_of("touched-on-the-way"), tmp_path / "visit.jsonl"
    records = carried_out(live_loop(cast))[:20]
    stop = {"phase": "emergency", "actor": "mediator", "outcome": "pressed", "inbound": True}
    path.write_text(written([*records, {"time": records[-1]["time"], **stop, "serial": 99}]))
    state = known(read_broken(str(path)).records)
    assert state.halted and not state.own
    assert [type(one).__name__ for one in going_on(state)] == ["Narrated"]


# Journals that cannot be gone on with --------------------------------------------------------


def broken_text(tmp_path: Path, text: str) -> str:
    path = tmp_path / "visit.jsonl"
    path.write_text(text, errors="surrogateescape")
    return str(path)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "no records"),
        ("{}\n", "not a transcript's record"),
        (json.dumps({**HEAD, "data": {"policy": "prima"}}) + "\n", "not the journal of a live run"),
        (
            json.dumps({**HEAD, "data": {**HEAD["data"], "redacted": True}}) + "\n",
            "what users said was left out of this journal",
        ),
        ("\udcff\n", "it is not UTF-8"),
        (
            written([{"time": 1, "phase": "over", "actor": "mediator", "outcome": "over"}]),
            "has ended",
        ),
    ],
)
def test_what_is_no_broken_journal_is_refused(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        read_broken(broken_text(tmp_path, text))


def test_a_line_that_was_cut_is_left_out(tmp_path: Path) -> None:
    whole = written([{"time": 0.5, "phase": "note", "actor": "user", "text": "walks"}])
    broken = read_broken(broken_text(tmp_path, whole + '{"time":1.0,"phase":"no'))
    assert broken.time == 500
    assert broken.kept == len(whole.encode())


def test_a_journal_of_other_documents_is_refused(tmp_path: Path) -> None:
    cast = cast_of("picture-alone")
    records = carried_out(live_loop(cast))[:20]
    changed = [
        {**record, "text": "Something else."} if record.get("text") else record
        for record in records
    ]
    path = broken_text(tmp_path, written(changed))
    with pytest.raises(UsageError, match=r"visit\.jsonl:\d+: the documents do not give"):
        gone_on(cast, Path(path))


Change = Callable[[list[Record]], None]
END: Record = {"time": 3.0, "phase": "end", "actor": "robot", "inbound": True}


def told(**more: object) -> Change:
    """A record at the end, whose fields are not those of its phase."""
    return lambda records: records.append({**END, **more})


def headed(name: str, value: object) -> Change:
    return lambda records: records[0]["data"].update({name: value})


def backward(records: list[Record]) -> None:
    records[-1]["time"] = 0.001


def late(records: list[Record]) -> None:
    records[-1]["time"] = 4e7


@pytest.fixture(scope="module")
def journal(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The journal of a live run that was cut off before its end."""
    folder = tmp_path_factory.mktemp("visit")
    (folder / "hello.xml").write_text(HELLO)
    path = folder / "visit.jsonl"
    words = ("--robot", ROBOT, "--ea", str(folder / "hello.xml"), "--speed", "100")
    ran = prima("live", *words, "-o", str(path))
    assert ran.returncode == 0, ran.stderr
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:-1]))
    return path


@pytest.mark.parametrize("verb", ["show", "replay"])
def test_who_reads_a_journal_that_was_cut_off_is_told_how_it_goes_on(
    verb: str, journal: Path
) -> None:
    whole, half = journal.with_name("whole.jsonl"), journal.with_name("half.jsonl")
    whole.write_bytes(journal.read_bytes())
    half.write_bytes(journal.read_bytes()[:-10])
    for path, code in ((whole, 0), (half, 2)):
        ran = prima(verb, str(path))
        assert ran.returncode == code, ran.stderr
        assert f"Go on with: prima live --resume {path}\n" in ran.stderr
    records = [json.loads(line) for line in whole.read_text().splitlines()]
    records[0]["data"]["redacted"] = True
    whole.write_text("".join(json.dumps(record) + "\n" for record in records))
    ran = prima("show", str(whole))
    assert ran.returncode == 0 and "Go on" not in ran.stderr, "a redacted run cannot"


def test_a_journal_is_replayed_as_far_as_it_goes(journal: Path) -> None:
    lines = journal.read_text().splitlines(keepends=True)
    at = next(number for number, line in enumerate(lines) if '"phase":"start"' in line)
    part = journal.with_name("part.jsonl")
    part.write_text("".join(lines[:at]))
    assert "as far as the transcript goes" in prima("replay", str(part)).stderr
    lines[at] = lines[at].replace('"phase":"start"', '"phase":"resume"')
    changed = journal.with_name("differs.jsonl")
    changed.write_text("".join(lines))
    ran = prima("replay", str(changed))
    assert ran.returncode == 1
    assert f"the replay differs from line {at + 1}: the documents do not give" in ran.stderr


def test_a_replay_tells_that_what_was_fetched_may_have_changed(tmp_path: Path) -> None:
    vxml = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'
    page, second = tmp_path / "first.vxml", tmp_path / "second.vxml"
    page.write_text(f'{vxml}<form><block><goto next="second.vxml"/></block></form></vxml>')
    second.write_text(f"{vxml}<form><block>Hello.<exit/></block></form></vxml>")
    visit, made = tmp_path / "visit.xml", str(tmp_path / "visit.jsonl")
    visit.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<robot at="middle"/><person x="1" y="0"/><application src="first.vxml"/></scenario>'
    )
    assert prima("run", str(visit), "-o", made).returncode == 0
    assert prima("replay", made, str(visit)).returncode == 0
    second.write_text(second.read_text().replace("Hello.", "Farewell."))
    ran = prima("replay", made, str(visit))
    assert ran.returncode == 1
    assert "a file that an application fetched has changed" in ran.stderr


def test_a_journal_that_has_lost_a_line_tells_what_is_sound_of_it(journal: Path) -> None:
    lines = journal.read_text().splitlines(keepends=True)
    lost = journal.with_name("lost.jsonl")
    at = next(number for number, line in enumerate(lines) if '"phase":"start"' in line)
    lost.write_text("".join(lines[:at] + lines[at + 1 :]))
    remedy = f"head -n {at} {lost} > sound.jsonl, then prima live --resume sound.jsonl."
    for words, code in (("replay",), 1), (("live", "--resume"), 2):
        ran = prima(*words, str(lost))
        assert ran.returncode == code and remedy in ran.stderr, ran.stderr
        assert "Go on with" not in ran.stderr
    sound = journal.with_name("sound.jsonl")
    sound.write_text("".join(lines[:at]))
    assert prima("live", "--resume", str(sound)).returncode == 0


def test_no_run_goes_on_from_a_journal_with_a_bad_line_in_its_midst(journal: Path) -> None:
    lines = journal.read_text().splitlines(keepends=True)
    spoilt = journal.with_name("spoilt.jsonl")
    spoilt.write_text("".join([*lines[:5], "x\n", *lines[5:]]))
    ran = prima("show", str(spoilt))
    assert ran.returncode == 2 and "spoilt.jsonl:6: " in ran.stderr
    assert "Go on with" not in ran.stderr


@pytest.mark.parametrize("verb", ["live --resume", "replay"])
@pytest.mark.parametrize(
    ("change", "why"),
    [
        (backward, r":\d+: the time goes back from .* s to 0\.001 s"),
        (late, r":\d+: the time is after more than 366 days"),
        (told(phase="fetched", app="hello", data={"x": 1}), r":\d+: a record lacks a field"),
        (told(phase="fail"), r":\d+: a record lacks a field"),
        (told(phase="load", app="other"), r':\d+: it loads an application .*"other"'),
        (headed("policy", 5), ":1: the run record is damaged: policy"),
        (headed("bound", "x"), ":1: the run record is damaged: bound"),
        (headed("date", "someday"), ":1: the run record is damaged: date"),
        (headed("patience", -1), ":1: the run record is damaged: patience"),
        (headed("live", {"robot": 5}), r":1: the run record is damaged: live\.robot"),
        (headed("live", {"robot": "r\0.xml", "document": ""}), "'r.x00.xml' is not a file's name"),
        (headed("live", {"robot": "r.xml", "maps": 7}), r":1: .* damaged: live\.maps"),
        (headed("live", {}), "does not say with which files"),
        (lambda records: records.pop(0), ":1: the transcript does not begin with its run record"),
    ],
)
def test_a_changed_journal_is_refused(change: Change, why: str, verb: str, journal: Path) -> None:
    records = [json.loads(text) for text in journal.read_text().splitlines()]
    change(records)
    path = journal.with_name("changed.jsonl")
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    ran = prima(*verb.split(), str(path))
    assert ran.returncode == 2, ran.stderr
    assert re.search(rf"changed\.jsonl.*{why}", ran.stderr), ran.stderr
    assert "defect" not in ran.stderr


def test_a_journal_is_never_written_over(tmp_path: Path) -> None:
    path = tmp_path / "visit.jsonl"
    path.write_text("kept\n")
    with pytest.raises(UsageError, match="--resume"):
        Journal(str(path))
    assert path.read_text() == "kept\n"


def test_a_journal_that_a_run_still_writes_is_left_to_it(tmp_path: Path) -> None:
    path = tmp_path / "visit.jsonl"
    writing = Journal(str(path))
    for kept in (None, 0):
        with pytest.raises(UsageError, match="another run is still writing it"):
            Journal(str(path), kept=kept)
    writing.write([HEAD])
    writing.close()
    Journal(str(path), kept=path.stat().st_size).close()


def test_a_full_disk_ends_the_run_with_a_clear_error() -> None:
    journal = Journal("/dev/full")
    with pytest.raises(RunError, match="No space left"):
        journal.write([HEAD])
    journal.close()


def test_a_device_or_pipe_has_no_disk_to_flush_to(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    for path in ("/dev/null", str(tmp_path / "pipe")):
        journal = Journal(path, sync=True)
        journal.write([{"time": 0, "phase": "note", "actor": "robot"}])
        journal.close()
    assert b"note" in os.read(reader, 1000)
    os.close(reader)
