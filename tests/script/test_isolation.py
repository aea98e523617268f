"""Code of documents in processes of their own: code that never ends costs only its application."""

from __future__ import annotations

import gc
import os
import signal
import time
from contextlib import suppress

import pytest

from prima.errors import UsageError
from prima.script import host, shared, wire, worker
from prima.script.evaluation import SCOPES, EngineLost, ScriptError
from prima.script.isolated import Engines, IsolatedEngine
from prima.script.remote import Remote
from prima.script.shared import IsolatedTagEngine, syntax
from tests.helpers.robot import Bench, document

ENDLESS = "var a = []; for (var i = 0; i < 45; i++) a = [a, a]; a.flat(Infinity)"
"""Takes no memory and looks at no limit of the engine."""
ENDS_AS_XML = ENDLESS.replace("<", "&lt;")
ASKS = '<form id="f"><on event="ask"><speak><value expr="Math.max(1, 2)"/></speak></on></form>'


def engine_of(engines: Engines, name: str = "a", kind: str = "ea") -> IsolatedEngine:
    made = engines.engine(name, kind)
    assert isinstance(made, IsolatedEngine)
    return made


def scopes_of(engine: IsolatedEngine) -> tuple[object, ...]:
    return tuple(engine.named(name) for name in SCOPES)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes that are ended sooner."""
    monkeypatch.setattr(worker, "_idle", [])
    monkeypatch.setattr(shared, "_common", [])


def test_what_does_not_come_back_costs_its_application_alone() -> None:
    bad = f"<form id='b'><on event='now'><script>{ENDS_AS_XML}</script></on></form>"
    bench = Bench(
        document(ASKS, "fa", "good"), document(bad, "ea", "bad"), document(ASKS, "ea", "x")
    )
    bench.event("now")
    bench.event("ask")
    assert bench.saying() == ["2"]
    (over,) = bench.phases("unload")
    assert over["app"] == "bad"
    assert over["rule"] == "E2"
    assert "bad.xml:1:" in over["outcome"]
    assert "took more than 2 s of processor time and did not stop" in over["outcome"]
    assert bench.session.defects == []


def test_time_is_the_processors_not_the_clocks() -> None:
    """A process that is stopped for longer than the limit is not ended by it."""
    engine = engine_of(Engines())
    scopes = scopes_of(engine)
    pid = engine.host.pid
    os.kill(pid, signal.SIGSTOP)
    try:
        import threading

        threading.Timer(host.KILL_SECONDS + 0.5, os.kill, (pid, signal.SIGCONT)).start()
        began = time.monotonic()
        assert engine.value("1 + 1", scopes) == 2
        assert time.monotonic() - began > host.KILL_SECONDS
    finally:
        os.kill(pid, signal.SIGCONT)
    assert engine.spent < 0.1


def test_a_run_that_nobody_closed_gives_its_process_back(
    quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    gc.collect()  # what other tests have left comes back before
    monkeypatch.setattr(worker, "_idle", [])
    engines = Engines()
    engines.__dict__["itself"] = engines  # so that only the collector finds it
    pid = engine_of(engines).host.pid
    del engines
    gc.collect()
    assert pid in [one.pid for one in worker._idle]


def test_eas_are_apart_and_fas_together() -> None:
    for how, apart in {"ea": [1, 1, 2, 3], "all": [1, 2, 3, 4]}.items():
        engines = Engines(how)
        kinds = [("a", "fa"), ("b", "fa"), ("c", "ea"), ("d", "ea")]
        pids = [engine_of(engines, *one).host.pid for one in kinds]
        assert [sorted(set(pids), key=pids.index).index(one) + 1 for one in pids] == apart


def test_nobody_has_a_process_where_all_is_trusted() -> None:
    assert not isinstance(Engines("none").engine("a", "ea"), IsolatedEngine)


def test_an_unknown_isolation_is_refused() -> None:
    with pytest.raises(UsageError, match='isolate="some": write'):
        Engines("some")


def test_a_lost_engine_stays_lost_and_the_next_one_works() -> None:
    engines = Engines()
    engine = engine_of(engines)
    scopes = scopes_of(engine)
    os.kill(engine.host.pid, signal.SIGKILL)
    for _ in range(2):
        with pytest.raises(EngineLost, match="its engine crashed, or was ended from outside"):
            engine.value("1", scopes)
    again = engine_of(engines)
    assert again.value("1", scopes_of(again)) == 1


def test_processes_are_used_again_when_a_run_is_over() -> None:
    engines = Engines()
    engine = engine_of(engines)
    scopes, pid = scopes_of(engine), engine.host.pid
    engines.close()
    with pytest.raises(EngineLost, match="its run has ended"):
        engine.value("1", scopes)
    assert pid in [one.pid for one in worker._idle]


def test_a_process_of_engines_can_write_no_file_and_hold_so_much() -> None:
    engine = engine_of(Engines())
    with open(f"/proc/{engine.host.pid}/limits", encoding="ascii") as stream:
        limits = dict(line.split("  ", 1) for line in stream)
    assert limits["Max address space"].split()[0] == str(host.MEMORY_BYTES)
    assert limits["Max file size"].split()[0] == "0"
    assert limits["Max open files"].split()[0] == str(host.FILES)


def test_values_that_nobody_has_are_dropped_there() -> None:
    engine = engine_of(Engines())
    scopes = scopes_of(engine)
    with pytest.raises(ScriptError, match="too much memory"):
        kept = [engine.raw("new Array(50000).fill(1.5)", scopes) for _ in range(200)]
    kept = []
    for _ in range(200):
        kept[:] = [engine.raw("new Array(50000).fill(1.5)", scopes)]


def test_an_array_of_one_long_text_stays_where_it_is() -> None:
    engine = engine_of(Engines())
    scopes = scopes_of(engine)
    engine.script("var t = 'x'.repeat(4000000), a = Array(10000).fill(t)", scopes[0], scopes)
    elements = engine.elements("a", scopes, 10_000)
    for element in elements:
        engine.put(scopes[3], "v", element)
    assert engine.value("v.length", scopes) == 4_000_000
    with pytest.raises(ScriptError, match="it gives more than 100,000 characters"):
        engine.value("v", scopes)


def test_a_reply_that_is_too_long_is_an_error() -> None:
    engine = engine_of(Engines())
    scopes = scopes_of(engine)
    with pytest.raises(ScriptError, match="it gives more than 100,000 characters"):
        engine.value("Array(10000).fill('x'.repeat(1000))", scopes)
    assert engine.value("1", scopes) == 1


@pytest.mark.parametrize(
    "value", [float("inf"), {"a": [None, True, "\ud800", 2**60]}, [[]] * 3, "\0"]
)
def test_values_from_outside_arrive_as_in_the_process_itself(value: object) -> None:
    found = []
    for how in ("none", "ea"):
        engine = Engines(how).engine("a", "ea")
        scopes = tuple(engine.named(name) for name in SCOPES)
        engine.set(scopes[0], "v", value)
        found.append((engine.value("v", scopes), engine.text("v", scopes)))
    assert found[0] == found[1]


@pytest.mark.usefixtures("quick")
def test_code_that_is_only_compiled_and_tags_have_a_process_that_begins_anew() -> None:
    from prima.script.budget import Budget

    engine = IsolatedTagEngine(Budget())
    with pytest.raises(EngineLost, match="did not stop"):
        engine.run(ENDLESS)
    syntax().expression("a + b")
    with pytest.raises(ScriptError, match="it ends too early"):
        syntax().expression("a +")
    again = IsolatedTagEngine(Budget())
    assert again.json(again.box(1)) == 1


def test_a_process_ends_with_the_one_that_needs_it() -> None:
    import subprocess
    import sys

    code = (
        "from prima.script.isolated import Engines\n"
        "import os, signal\n"
        "engine = Engines().engine('a', 'ea')\n"
        "print(engine.host.pid, flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    pid = int(done.stdout)
    for _ in range(100):
        if not os.path.exists(f"/proc/{pid}"):
            break
        time.sleep(0.05)
    assert not os.path.exists(f"/proc/{pid}")


def test_processes_that_were_ended_while_nobody_used_them_are_passed_over() -> None:
    engines = Engines()
    pids = [engine_of(engines, name).host.pid for name in "ab"]
    engines.close()
    for pid in pids:
        os.kill(pid, signal.SIGKILL)
    engine = engine_of(Engines())
    assert engine.host.pid not in pids
    assert engine.value("1", scopes_of(engine)) == 1


def test_an_application_without_an_engine_ends_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that cannot be started, or ends while its application is made (E2)."""

    def nobody() -> worker.Worker:
        raise EngineLost("its engine cannot be started: Too many open files")

    monkeypatch.setattr(worker, "hire", nobody)
    plain = '<form id="f"><on event="ask"><speak>Yes?</speak></on></form>'
    bench = Bench(document(ASKS, "ea", "bad"), document(plain, "fa", "good"))
    bench.event("ask")
    assert bench.saying() == ["Yes?"]
    (over,) = bench.phases("unload")
    assert over["app"] == "bad"
    assert over["rule"] == "E2"
    assert "Too many open files" in over["outcome"]
    assert bench.session.defects == []


def test_an_engine_that_ends_while_its_application_is_made_is_replaced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    call = Remote._call
    ended: list[int] = []

    def once(engine: Remote, method: str, *arguments: object) -> object:
        if method == "named" and not ended:
            ended.append(engine.host.pid)
            os.kill(engine.host.pid, signal.SIGKILL)
        return call(engine, method, *arguments)

    monkeypatch.setattr(Remote, "_call", once)
    bench = Bench(document(ASKS, "ea", "good"))
    bench.event("ask")
    assert bench.saying() == ["2"]


def test_tags_run_in_the_process_of_their_application() -> None:
    """What ends a tag's process costs no run beside it in another thread."""
    from prima.script.budget import Budget

    engine, other = engine_of(Engines(), "a"), engine_of(Engines(), "b")
    with pytest.raises(EngineLost, match="did not stop"):
        IsolatedTagEngine(Budget(host=engine.host)).run(ENDLESS)
    assert engine.lost
    assert other.value("1", scopes_of(other)) == 1
    assert IsolatedTagEngine(Budget(host=other.host)).fault("x = 1") == ""


def test_code_of_somebody_else_that_ends_the_common_process_is_no_fault_of_this() -> None:
    syntax().expression("a")
    os.kill(shared._common[0].pid, signal.SIGKILL)
    syntax().expression("a + b")


@pytest.mark.parametrize("deep", [400, 401, 985, 990, 995, 1000])
def test_values_that_are_nested_deep_are_told(deep: int) -> None:
    """Python cannot read all that the engine can write."""
    engine = engine_of(Engines())
    scopes = scopes_of(engine)
    engine.script(f"var o = []; for (var i = 1; i < {deep}; i++) o = [o];", scopes[1], scopes)
    if deep <= 400:
        assert engine.value("o", scopes) is not None
    else:
        with pytest.raises(ScriptError, match=r"nested too deep|call stack"):
            engine.value("o", scopes)
    assert engine.value("1 + 1", scopes) == 2


def test_a_reply_that_cannot_be_read_on_a_long_stack_is_not_the_end() -> None:
    reader, writer = os.pipe()

    def deeper(left: int) -> object:
        return deeper(left - 1) if left else wire.receive(reader, wire.LONGEST_REPLY)

    try:
        wire.send(writer, _nested(800), wire.LONGEST_REPLY)
        with suppress(wire.TooMuch):  # where Python's own stack is too short for both
            deeper(400)
        wire.send(writer, "after", wire.LONGEST_REPLY)
        assert wire.receive(reader, wire.LONGEST_REPLY) == "after"
    finally:
        os.close(reader)
        os.close(writer)


def _nested(deep: int) -> list[object]:
    made: list[object] = []
    for _ in range(deep):
        made = [made]
    return made
