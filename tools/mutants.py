"""Mutation testing of the scheduler: each small change to it must make a test of the rules fail.

``python -m tools.mutants`` tries all of ``prima/scheduler``, ``python -m tools.mutants rules.py``
one file. Each mutant runs in a process of its own, forked from this one, at low priority. Killed
mutants of a file that has not changed are not tried again, so a run goes on where it was stopped,
and one after a change tries that file alone; ``--all`` starts anew. Exit code 1 if a mutant
survives that is not on the list of judged ones, or one on the list does not survive.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

import pytest

from tools.mutation import Mutant, mutants, mutated

ROOT = Path(__file__).resolve().parent.parent
SCHEDULER = ROOT / "prima" / "scheduler"
RULES = ROOT / "tests" / "scheduler"
TESTS = (
    *sorted(RULES.glob("test_*.py")),
    ROOT / "tests" / "cases" / "test_figures.py",
    ROOT / "tests" / "cases" / "test_cases.py",
    ROOT / "tests" / "invariants" / "test_properties.py",
)
"""The tests that hold the rules, the quickest first."""
NOT_TRIED = "not test_a_test_named_after_the_rule and not replaying"
"""Without tests of tests, and without the second run of each case."""
JUDGED = RULES / "survivors.txt"
DONE = ROOT / "build" / "mutants.json"
TEST_SECONDS = 10
"""How much of the processor's time one test may take: an endless loop is a failure."""
MUTANT_SECONDS = 300
MEMORY = 2 << 30


class Limit:
    """A plugin of pytest: the time of each test."""

    def pytest_runtest_setup(self) -> None:
        """The process ends by the signal of this timer."""
        signal.setitimer(signal.ITIMER_PROF, TEST_SECONDS)


def put(file: str, code: CodeType) -> None:
    """Let a module be loaded with other code than its file's."""
    name = file.removesuffix(".py").replace("/", ".")
    load = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, fullname: str) -> CodeType | None:
        return code if fullname == name else load(self, fullname)

    SourceFileLoader.get_code = get_code  # type: ignore[assignment,method-assign]


def test(mutant: Mutant | None) -> int:
    """Run the tests on a mutant, or on the code as it is, in a process of its own.

    Returns:
        The process's number.
    """
    pid = os.fork()
    if pid:
        return pid
    os.setsid()
    quiet = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2) if mutant else (0,):
        os.dup2(quiet, stream)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    code: int = 1
    # A plugin's package is one that pytest loads in its own way, without get_code.
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    os.environ["CI"] = "true"  # the same generated runs each time
    try:
        if mutant is not None:
            tree = mutated((ROOT / mutant.file).read_text(encoding="utf-8"), mutant.position)
            put(mutant.file, compile(tree, mutant.file, "exec"))
        options = ["-q", "-x", "-p", "no:cacheprovider", "-k", NOT_TRIED]
        code = pytest.main([*options, *map(str, TESTS)], plugins=[Limit()])
    finally:
        os._exit(code)


def preload() -> None:
    """Import what the package needs of others once, for all processes."""
    import_module("prima.api")
    for name in [one for one in sys.modules if one.partition(".")[0] in ("prima", "tests")]:
        del sys.modules[name]


def survives(found: list[Mutant], jobs: int) -> Iterator[tuple[Mutant, bool]]:
    """Try mutants, some at a time; gives each as soon as it is known whether it survives."""
    left, running = iter(found), dict[int, tuple[Mutant, float]]()
    try:
        while True:
            while len(running) < jobs and (mutant := next(left, None)) is not None:
                running[test(mutant)] = (mutant, time.monotonic())
            if not running:
                return
            for pid, code in ended(running):
                yield running.pop(pid)[0], code == 0
    finally:
        for pid in running:
            os.killpg(pid, signal.SIGKILL)


def ended(running: dict[int, tuple[Mutant, float]]) -> Iterator[tuple[int, int]]:
    """The processes that have ended, with their codes; those that take too long are ended."""
    time.sleep(0.02)
    for pid, (_, begun) in list(running.items()):
        if time.monotonic() - begun > MUTANT_SECONDS:
            os.killpg(pid, signal.SIGKILL)
        gone, code = os.waitpid(pid, os.WNOHANG)
        if gone:
            yield pid, code


def digest(*files: Path) -> str:
    """A short name of the contents of files."""
    whole = hashlib.sha256()
    for file in files:
        whole.update(file.read_bytes())
    return whole.hexdigest()[:16]


class Results:
    """The results of earlier runs. A killed mutant's holds while its file stays as it is, a
    survivor's while the scheduler and its tests do."""

    def __init__(self, anew: bool) -> None:
        self.whole = digest(*sorted(SCHEDULER.glob("*.py")), *TESTS)
        known = DONE.exists() and not anew
        self.found: dict[str, str] = json.loads(DONE.read_text()) if known else {}

    def mark(self, mutant: Mutant, survived: bool) -> str:
        """The part of a result that is kept."""
        return f"survived {self.whole}" if survived else f"killed {digest(ROOT / mutant.file)}"

    def survived(self, mutant: Mutant) -> bool | None:
        """Whether it survives, if that is known."""
        kept = self.found.get(mutant.name)
        return next((what for what in (True, False) if kept == self.mark(mutant, what)), None)

    def keep(self, mutant: Mutant, survived: bool) -> None:
        """Keep a result for runs to come."""
        self.found[mutant.name] = self.mark(mutant, survived)
        DONE.parent.mkdir(exist_ok=True)
        DONE.write_text(json.dumps(self.found, indent=0, ensure_ascii=False))


def judged() -> dict[str, str]:
    """The mutants on the list with their reasons: a comment holds for the lines under it."""
    reason, found = "", dict[str, str]()
    for line in JUDGED.read_text(encoding="utf-8").splitlines() if JUDGED.exists() else ():
        if line.startswith("#"):
            reason = line[1:].strip()
        elif line.strip():
            found[line.strip()] = reason
    return found


def chosen(names: list[str]) -> list[Mutant]:
    """The mutants of the files named, or of all."""
    files = sorted(SCHEDULER.glob("*.py"))
    unknown = set(names) - {file.name for file in files}
    if unknown:
        known = ", ".join(file.name for file in files)
        raise SystemExit(f"No file {', '.join(sorted(unknown))} in prima/scheduler: {known}.")
    return [
        mutant
        for file in files
        if not names or file.name in names
        for mutant in mutants(str(file.relative_to(ROOT)), file.read_text(encoding="utf-8"))
    ]


def run(found: list[Mutant], results: Results, jobs: int) -> list[Mutant]:
    """Try the mutants of which nothing is known; gives all that survive."""
    known = {mutant.name: results.survived(mutant) for mutant in found}
    new = [mutant for mutant in found if known[mutant.name] is None]
    print(f"{len(found)} mutants, {len(new)} to try", file=sys.stderr)
    preload()
    if new and os.waitpid(test(None), 0)[1]:
        raise SystemExit("The tests fail without any change: mend that first.")
    for mutant, survived in survives(new, jobs):
        results.keep(mutant, survived)
        known[mutant.name] = survived
        if survived:
            print(f"survives: {mutant.file}:{mutant.line}: {mutant.name}", file=sys.stderr)
    return [mutant for mutant in found if known[mutant.name]]


def main() -> int:
    """Try mutants, and compare those that survive with the list."""
    parser = argparse.ArgumentParser(description="Mutation testing of the scheduler.")
    parser.add_argument("files", nargs="*", help="files of prima/scheduler, such as rules.py")
    parser.add_argument("--all", action="store_true", help="try also what is known")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="how many at once")
    given = parser.parse_args()
    os.nice(19)
    found = chosen(given.files)
    survivors = run(found, Results(given.all), given.jobs)
    names, listed = {mutant.name for mutant in survivors}, judged()
    files = {mutant.name.partition(" ")[0] for mutant in found}
    news = [mutant for mutant in survivors if mutant.name not in listed]
    stale = [one for one in listed if one.partition(" ")[0] in files and one not in names]
    for mutant in news:
        print(f"{mutant.file}:{mutant.line}: {mutant.name}")
    for name in stale:
        print(f"on the list, but does not survive: {name}")
    print(
        f"{len(found)} mutants, {len(found) - len(survivors)} killed, "
        f"{len(survivors) - len(news)} survive as judged, {len(news)} survive unjudged",
        file=sys.stderr,
    )
    return 1 if news or stale else 0


if __name__ == "__main__":
    sys.exit(main())
