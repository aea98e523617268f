"""The nine invariants, over generated applications and the scenarios of the package.

``PRIMA_EXAMPLES`` says how many runs are generated in all (300 unless it is
set); under ``CI=true`` they are the same runs every time.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.invariants import callers, check
from prima.messages import Record
from prima.session import Session
from tests import ROOT
from tests.helpers.generated.plays import Play, perform, plays, without_hints
from tests.helpers.generated.scripts import Ask, Open, Script, drive, scripts
from tests.helpers.generated.world import APPS, Run, World, baselines, extended
from tests.helpers.violations import numbers, unfinished, wrong_additions

EXAMPLES = int(os.environ.get("PRIMA_EXAMPLES", "300"))
SCENARIOS = sorted(ROOT.glob("documents/scenarios/**/*.xml"))


def examples(percent: int) -> settings:
    """A part of the generated runs."""
    return settings(
        max_examples=max(EXAMPLES * percent // 100, 1),
        derandomize=os.environ.get("CI") == "true",
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
    )


def violations(run: Run, policy: str = "prima") -> list[str]:
    """What a run violates."""
    found = check(run.records, policy, APPS, calling=run.calling)
    return found + wrong_additions(run.records) + run.problems


@given(plays())
@examples(17)
def test_documents_keep_the_invariants(play: Play) -> None:
    run = perform(play)
    assert violations(run) == []


@given(scripts())
@examples(17)
def test_requests_keep_the_invariants(script: Script) -> None:
    run = drive(script)
    assert violations(run) == []


@given(plays(), extended)
@examples(10)
def test_records_tell_what_was_when_they_were_made_however_late_they_are_drained(
    play: Play, policy: str
) -> None:
    records = perform(play, policy).records
    sessions: list[Session] = []

    def undrained(session: Session) -> list[Record]:
        sessions.append(session)
        return []

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Session, "drain", undrained)
        perform(play, policy)
    assert sessions[0].recorder.drain() == records


@given(plays(), scripts(), st.sampled_from([0, 5, 30, 200]), st.one_of(st.just("prima"), extended))
@examples(12)
def test_whoever_is_kept_from_the_speaker_has_a_turn(
    play: Play, script: Script, patience: int, policy: str
) -> None:
    for run in (perform(play, policy, patience=patience), drive(script, policy, patience)):
        assert check(run.records, policy, APPS, patience, run.calling) + run.problems == []


@given(plays(), extended)
@examples(20)
def test_documents_keep_the_invariants_with_extensions(play: Play, policy: str) -> None:
    run = perform(play, policy)
    assert violations(run, policy) == []


@given(scripts(), extended)
@examples(20)
def test_requests_keep_the_invariants_with_extensions(script: Script, policy: str) -> None:
    run = drive(script, policy)
    assert violations(run, policy) == []


@given(plays(lively=True), st.one_of(st.just("prima"), extended))
@examples(16)
def test_everything_ends_when_users_answer_and_devices_end(play: Play, policy: str) -> None:
    """Invariant 9, with the others."""
    run = perform(play, policy)
    assert run.complete, "the run does not come to rest"
    assert violations(run, policy) == []
    assert unfinished(run.records, policy) == []


@given(plays(), scripts(), baselines)
@examples(8)
def test_the_baselines_keep_what_applies_to_them(play: Play, script: Script, policy: str) -> None:
    for run in (perform(play, policy), drive(script, policy)):
        found = violations(run, policy)
        if policy == "none":
            # Nothing keeps devices apart there, and nothing else may be wrong.
            found = [text for text in found if numbers([text]) != {1}]
        assert found == []


@given(plays(), scripts(), st.one_of(st.just("prima"), extended))
@examples(6)
def test_the_same_inputs_give_the_same_transcript(play: Play, script: Script, policy: str) -> None:
    """Invariant 8, within one process."""
    assert perform(play, policy).lines() == perform(play, policy).lines()
    assert drive(script, policy).lines() == drive(script, policy).lines()


@given(plays(), st.one_of(st.just("prima"), baselines))
@examples(6)
def test_hints_change_nothing_where_no_extension_is_on(play: Play, policy: str) -> None:
    assert perform(play, policy).lines() == perform(without_hints(play), policy).lines()


CHILD = """
import sys
from pathlib import Path
from prima import load_scenario, rehearse
from tests.helpers.generated.plays import *
from tests.helpers.generated.scripts import *
from tests.helpers.generated.world import *
from prima.messages import *

for path in sys.argv[1:]:
    print("".join(f"{record}\\n" for record in rehearse(path).records))
for text in sys.stdin:
    made, policy = eval(text)
    print((perform if isinstance(made, Play) else drive)(made, policy).lines())
"""


def _some() -> list[tuple[Play | Script, str]]:
    """A few generated runs and their policies, always the same ones."""
    found: list[tuple[Play | Script, str]] = []

    @given(plays(), scripts(), extended)
    @settings(max_examples=12, derandomize=True, deadline=None, database=None)
    def gather(play: Play, script: Script, policy: str) -> None:
        found.extend(((play, policy), (script, policy), (play, "prima"), (script, "prima")))

    gather()
    return found[-24:]


@pytest.mark.parametrize("first, second", [("0", "1"), ("2", "random")])
def test_no_hash_seed_decides_anything(first: str, second: str) -> None:
    """Invariant 8, across processes: the scenarios and some generated runs."""
    text = "".join(f"{made!r}\n" for made in _some())
    command = [sys.executable, "-c", CHILD, *map(str, SCENARIOS)]
    outputs = []
    for seed in (first, second):
        done = subprocess.run(
            command,
            input=text.encode(),
            stdout=subprocess.PIPE,
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
            check=True,
        )
        outputs.append(done.stdout)
    assert len(outputs[0]) > 10_000
    assert outputs[0] == outputs[1]


@pytest.mark.parametrize("policy", ["prima", "prima+all", "fifo", "fair", "fixed", "none"])
@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_the_scenarios_keep_the_invariants(path: Path, policy: str) -> None:
    """What the package shows keeps the rules too."""
    from prima import load_scenario, rehearse

    loaded = load_scenario(path)
    records = rehearse(loaded, policy).records
    found = check(records, policy, calling=callers(loaded.cast.documents))
    found += wrong_additions(records)
    expected = {1} if policy == "none" else set()
    assert numbers(found) <= expected, found


STEPS = int(os.environ.get("PRIMA_STEPS", "1"))
"""At how many steps of a scenario each device fails, in one way; 0 for all steps and ways."""


HOW = ("fails", "hangs", "works again")


@pytest.mark.parametrize("how", HOW)
@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_a_device_may_fail_at_every_step_of_a_scenario(path: Path, how: str) -> None:
    """The run ends as it would have, nothing of it is a defect, and the rules are kept."""
    from prima import load_scenario, rehearse
    from prima.loading.files import GivenFiles, in_place_of_files

    text, hangs = path.read_text(encoding="utf-8"), str(how == "hangs").lower()
    whole = rehearse(load_scenario(path), "prima").records
    times = sorted({round(one["time"] * 1000) for one in whole})
    devices = sorted({device for one in whole for device in one.get("devices", ())})
    for device in devices[HOW.index(how) :: len(HOW)] if STEPS else devices:
        for time in Random(f"{path.stem} {how} {device}").sample(times, STEPS or len(times)):
            happens = f'<when at="{time}ms"><fail device="{device}" hangs="{hangs}"/></when>'
            if how == "works again":
                happens += f'<when at="{time + 2500}ms"><repair device="{device}"/></when>'
            failing = text.replace("</scenario>", f"{happens}</scenario>")
            with in_place_of_files(GivenFiles({path: failing.encode()})):
                loaded = load_scenario(path)
                made = rehearse(loaded, "prima")
            found = check(made.records, calling=callers(loaded.cast.documents))
            assert not found and not made.defects, (device, time, found, made.defects)
            assert made.records[-1]["phase"] == "over", (device, time)


def test_an_ab_that_starves_is_reported_once_wherever_it_waits() -> None:
    # E4 reports the direction behind the other's tracking; then a way back comes before it (X1),
    # and the other's speech keeps it waiting for longer than anybody has patience.
    direction, tracking = Ask(("set-direction",), ((),)), Ask(("tracking-human",), ((),))
    away = Ask(("set-position", "active-sensing-human"), ((), ()))
    speech = Open(frozenset({"speaker"}), None)
    events = ((0, ((tracking,),)), (1900, ((), (away,))), (1900, ((), (speech,))))
    script = Script((((direction,), (speech,)), ()), events, (), World(seed=1632))
    run = drive(script, "prima+x1", 30)
    assert check(run.records, "prima+x1", APPS, 30) + run.problems == []
    starved = [record["behavior"] for record in run.records if record["phase"] == "starve"]
    assert len(starved) == len(set(starved)) > 0


def test_a_unit_out_of_time_ends_the_loops_of_its_tree() -> None:
    # U5, E1: the second unit lasts too long while a loop beside it runs, which is the last one then.
    alone = ((),)
    question = Ask(("q-and-a",), alone)
    asked = (question, question, Ask((("speak", "turn"),), alone))
    sensing = Ask((("speak", "speak"), "active-sensing-human"), ((), ()))
    first = (Ask(("move-head", "speak"), ((), (0,))), sensing)
    loops = Ask(("active-sensing-human", "active-sensing-human"), ((), ()))
    second = (Ask(("face-human",), alone), loops, question)
    script = Script(((), (), ((), first, second)), ((0, ((), (), asked)),), (), World())
    run = drive(script)
    assert violations(run) == []
    assert [record["rule"] for record in run.records if record["phase"] == "fail"] == ["U5"]
    cut = [
        record
        for record in run.records
        if record["phase"] == "end" and not record.get("goal", True)
    ]
    assert cut[-1]["outcome"] == "done"
