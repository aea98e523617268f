"""The benchmarks do the work that they time, and give no figure for a wrong answer.

Nothing here looks at how long anything takes.
"""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("resource")

from bench import fresh, long, matching, mediation, peers, processes, run, simulation, workloads
from bench.fresh import Figure, WrongAnswer
from bench.machines import Prima
from bench.rows import SECTIONS, Call, Row

ROWS = [row for rows in SECTIONS.values() for row in rows()]
SECONDS = 0.01


@pytest.mark.parametrize("states", [2, 5])
@pytest.mark.parametrize("guards", [False, True])
def test_the_ring_counts_every_event(states: int, guards: bool) -> None:
    assert workloads.rate("prima", states, SECONDS, guards) > 0


def test_the_other_workloads_check_their_results() -> None:
    assert workloads.load("prima", 2_000) > 0
    assert workloads.second_load(10) > 0
    assert workloads.many("prima", 2, 10.0) > 0
    assert workloads.many_memory("prima", 2, 10.0) >= 0
    assert workloads.voicexml("prima", 2) > 0
    assert mediation.decisions(5, SECONDS) > 0
    assert simulation.situation(1, SECONDS) > 0
    assert simulation.visits_memory(1) < 1_000
    assert simulation.quiet(2) == 0


def test_a_long_run_counts_only_where_the_user_came_and_was_answered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tenth, end, visits = long.memory(0.2)
    assert tenth > 0 and end > 0
    assert visits == 4
    monkeypatch.setattr(long, "SCENARIO", long.SCENARIO.replace('{every}s"', '400s"'))
    with pytest.raises(WrongAnswer, match="the user came only 2 times"):
        long.memory(0.2)
    monkeypatch.undo()
    silent = re.sub("<reply.*</reply>", "", long.SCENARIO)
    monkeypatch.setattr(long, "SCENARIO", silent)
    with pytest.raises(WrongAnswer, match="was told to the office 0"):
        long.memory(0.2)


@pytest.mark.parametrize("system", ["sismic", "transitions"])
def test_the_peers_do_the_same_work(system: str) -> None:
    pytest.importorskip(system)
    assert workloads.rate(system, 3, SECONDS, True) > 0
    assert workloads.load(system, 400) > 0
    assert processes.peer(system) > 0


@pytest.mark.parametrize("system", peers.PEERS)
@pytest.mark.parametrize("guards", [False, True])
def test_peers_in_other_languages_do_the_same_work(system: str, guards: bool) -> None:
    if not peers.installed(system):
        pytest.skip(f"{system} is not installed: python -m bench.peers")
    assert workloads.rate(system, 3, SECONDS, guards) > 0


@pytest.mark.parametrize("change", matching.CHANGES)
def test_a_difference_is_that_which_was_made(change: str) -> None:
    assert matching.difference(change, 400) > 0


def test_processes_end_well() -> None:
    assert min(processes.help_(), processes.validate(), processes.run()) > 0
    assert processes.validate_many("prima", 3) > 0
    assert processes.validate_many("lxml", 3) > 0


@pytest.mark.parametrize(
    ("floor", "command"),
    [
        ("click", ["--help"]),
        ("validate", ["validate", processes.SMALL]),
        ("run", ["run", processes.DEMO]),
    ],
)
def test_a_floor_has_only_what_the_command_imports(floor: str, command: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "prima", *command],
        capture_output=True,
        text=True,
        cwd=fresh.ROOT,
        check=True,
    )
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert set(processes.FLOORS[floor]) <= imported
    assert processes.floor(floor) > 0


# A bench that cannot fail is none ---------------------------------------------


def test_a_driver_that_drops_an_event_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Prima.tick
    monkeypatch.setattr(Prima, "tick", lambda self, times: whole(self, times - 1))
    with pytest.raises(WrongAnswer, match="events are missing"):
        workloads.rate("prima", 2, SECONDS)
    with pytest.raises(WrongAnswer, match="events are missing"):
        workloads.load("prima", 2_000)
    with pytest.raises(WrongAnswer, match="events are missing"):
        workloads.many("prima", 2, 10.0)


def test_a_trace_that_is_not_kept_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prima.session.Session.drain", lambda self: [])
    with pytest.raises(AssertionError, match="records are missing"):
        workloads.rate("prima", 2, SECONDS)


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ('{"sent": 7, "timed": 5, "lasted": 1, "count": 6, "state": 1}', "1 events are missing"),
        ('{"sent": 7, "timed": 5, "lasted": 1, "count": 7, "state": 0}', "another state"),
    ],
)
def test_a_peer_that_drops_an_event_is_caught(told: str, message: str) -> None:
    with pytest.raises(WrongAnswer, match=message):
        peers.checked(2, told)


def test_a_load_that_checks_nothing_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    from prima.interpreter import reader

    whole = reader.read_document
    monkeypatch.setattr(reader, "read_document", lambda *given: (whole(*given)[0], []))
    with pytest.raises(WrongAnswer, match="unknown attribute"):
        workloads.load("prima", 2_000)


def test_a_cache_that_looks_at_the_name_alone_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, kept = Prima.__init__, dict[str, str]()

    def from_cache(self: Prima, text: str) -> None:
        whole(self, kept.setdefault("ring.xml", text))

    monkeypatch.setattr(Prima, "__init__", from_cache)
    with pytest.raises(WrongAnswer, match=r"other bytes|events are missing"):
        workloads.second_load(2)


def test_a_mediator_that_gives_another_its_turn_is_caught() -> None:
    with pytest.raises(WrongAnswer):
        mediation.decisions(5, SECONDS, "fair")


def test_a_visit_that_nobody_answered_is_caught() -> None:
    run = simulation.Quiet()
    run.come(1)
    run.until(3_000)
    with pytest.raises(WrongAnswer, match=r"That feels good.: 0 times, not 1"):
        run.check(1)


def test_a_process_that_ends_badly_is_caught() -> None:
    with pytest.raises(WrongAnswer, match="KeyError: 'nothing'"):
        fresh.fresh(processes.floor, "nothing")
    with pytest.raises(WrongAnswer, match="not one of the pages"):
        processes._timed([sys.executable, "-c", "raise SystemExit('not one of the pages')"])


# The table --------------------------------------------------------------------


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.what}, {row.beside}")
def test_every_row_can_be_measured(row: Row) -> None:
    for call in filter(None, (row.ours, row.peer)):
        assert getattr(import_module(call.function.__module__), call.function.__name__)
    assert not (row.least is not None and row.most is not None)
    assert bool(row.beside) == (row.peer is not None)


def row(**given: Any) -> Row:
    made: dict[str, Any] = {"what": "this", "unit": "s", "ours": Call(workloads.load), **given}
    return Row(**made)


def measured(given: Row, ours: list[float], others: list[float]) -> run.Measured:
    return run.Measured(given, [Figure(one) for one in ours], [Figure(one) for one in others])


def test_the_ratio_is_that_of_the_pairs() -> None:
    """A machine that became three times slower meanwhile changes no ratio."""
    pair = row(beside="that", peer=Call(workloads.load), most=2.0)
    found = measured(pair, [0.001, 0.002, 0.006], [0.001, 0.001, 0.003])
    assert found.results == [1, 2, 2]
    text = "| this | 2 ms | that: 1 ms | 2 (1.5 to 2) | ≤ 2 | met |"
    assert run.line(found) == text
    missed = measured(row(beside="that", peer=Call(workloads.load), most=1.9), [0.004], [0.002])
    assert run.line(missed) == "| this | 4 ms | that: 2 ms | 2 | ≤ 1.9 | **not met** |"


def test_a_figure_without_a_peer_has_its_spread_and_its_note() -> None:
    alone = row(unit="events/s", least=2_000)
    found = run.Measured(alone, [Figure(one, "some") for one in (1999.5, 2000.0, 2500.0)])
    text = "| this | 2,000 events/s (some) (2,000 to 2,250) |  |  | ≥ 2,000 events/s | met |"
    assert run.line(found) == text
    seconds = measured(row(), [0.9, 1.1, 1.3], [])
    assert run.line(seconds) == "| this | 1.1 s (1 s to 1.2 s) |  |  |  |  |"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.609, "s", "1.61 s"),
        (0.1234, "s", "123 ms"),
        (0.0000051, "s", "5.1 µs"),
        (0.0, "s", "0 µs"),
        (123456.7, "events/s", "123,457 events/s"),
        (0.0, "", "0"),
    ],
)
def test_figures_as_people_read_them(value: float, unit: str, text: str) -> None:
    assert run.shown(value, unit) == text


def test_some_rows_are_printed_and_nothing_is_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(run, "PAGE", tmp_path / "page.md")
    run.main(["--quick", "--only", "100 waiting"])
    out = capsys.readouterr().out
    assert "### Mediator" in out and "### Start" not in out
    assert "| A decision, 100 waiting |" in out
    assert not run.PAGE.exists()


def test_what_is_not_installed_is_left_out(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The page keeps what stands around its tables."""
    page = tmp_path / "page.md"
    page.write_text(f"before\n{run.BEGIN}\nold\n{run.END}\nafter\n", encoding="utf-8")
    floor = Call(processes.floor, ("bare",))
    rows = [row(ours=floor), row(what="more", ours=floor, needs="no-such-peer")]
    monkeypatch.setattr(run, "PAGE", page)
    monkeypatch.setattr(run, "SECTIONS", {"Some": lambda: rows})
    run.main(["--rounds", "1"])
    assert "this" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    assert text.startswith(f"before\n{run.BEGIN}\n") and text.endswith(f"\n{run.END}\nafter\n")
    assert "| this |" in text and "| more |" not in text and "old" not in text
    assert "Left out, because it is not installed here: no-such-peer." in text


def test_a_wrong_answer_stands_in_the_table_and_writes_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    wrong = row(ours=Call(processes.floor, ("nothing",)))
    right = row(what="more", ours=Call(processes.floor, ("bare",)))
    monkeypatch.setattr(run, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(run, "SECTIONS", {"Some": lambda: [wrong, right]})
    with pytest.raises(SystemExit, match=r"(?s)this: .*KeyError: 'nothing'"):
        run.main(["--rounds", "2"])
    out = capsys.readouterr().out
    assert "| this | **wrong answer** |" in out and "| more |" in out
    assert not run.PAGE.exists()
