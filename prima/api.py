"""The package's interface: load, validate, rehearse, read, replay, diff, explain.

The command line does nothing that is not here. These functions open files;
everything below them works on text and values.
"""

from __future__ import annotations

import hashlib
import posixpath
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from prima.codes import CODES
from prima.errors import DocumentError, Place, Problem, RunError, UsageError, did_you_mean, one_of
from prima.interpreter.checks import check_commands
from prima.interpreter.elements import Document
from prima.interpreter.reader import read_document
from prima.interpreter.vocabulary import DIALOGUE
from prima.markup.check import check_root
from prima.markup.reader import MAX_BYTES, parse, too_large
from prima.messages import Record
from prima.values import LONGEST_MS

if TYPE_CHECKING:
    from prima.sim.rehearsal import Cast
    from prima.transcript.diff import Difference
    from prima.transcript.measures import Measure, Summary
    from prima.transcript.table import Row

# What one use needs and another does not is imported where it is used: most commands are short.

VERSION = "1.0.0"


def read_file(path: str | Path) -> bytes:
    """Read a document's bytes, up to the limit.

    Raises:
        DocumentError: the file is larger than any document may be.
        UsageError: it cannot be read.
    """
    try:
        if Path(path).exists() and not Path(path).is_file():
            raise UsageError(f"{path}: cannot be read: it is not a file.")
        with Path(path).open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
            if len(data) > MAX_BYTES:
                size = Path(path).stat().st_size
                raise too_large(str(path), max(size, len(data)))
            return data
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}.") from None
    except ValueError:
        raise UsageError(f"{path!r} is not a file's name.") from None


def load(path: str | Path) -> Document:
    """Load an application.

    Raises:
        DocumentError: with all problems, if any is an error.
        UsageError: the file cannot be read.
    """
    document, problems = read_document(str(path), read_file(path))
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return document


@dataclass(slots=True)
class Loaded:
    """A scenario with everything it names; ``files`` are paths with digests of their bytes."""

    cast: Cast
    files: dict[str, str]
    problems: list[Problem] = field(default_factory=list)


def validate(paths: Iterable[str | Path]) -> list[Problem]:
    """Give all problems of documents of any kind; a scenario's also those of what it names.

    Raises:
        UsageError: a file cannot be read.
    """
    problems: list[Problem] = []
    for path in paths:
        problems += _validate_one(str(path))
    return sorted(set(problems))


def _validate_one(path: str) -> list[Problem]:
    try:
        data = read_file(path)
        root = parse(path, data)
        if root.namespace == DIALOGUE.namespace:
            return read_document(path, data)[1]
        from prima.sim.scenario import read_robot, read_world
        from prima.sim.vocabulary import ROBOT, SCENARIO, WORLD

        vocabulary = check_root(root, (DIALOGUE, WORLD, ROBOT, SCENARIO))
        if vocabulary is WORLD:
            read_world(path, data)
        elif vocabulary is ROBOT:
            read_robot(path, data)
        else:
            return load_scenario(path).problems
    except DocumentError as error:
        return error.problems
    return []


def load_scenario(path: str | Path) -> Loaded:
    """Load a scenario with its world, robot and applications.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
        UsageError: the scenario's file cannot be read.
    """
    from prima.scheduler.selection import policy_named
    from prima.sim.rehearsal import Cast, check_cast
    from prima.sim.scenario import read_robot, read_scenario, read_world

    path = Path(path)
    data = read_file(path)
    scenario = read_scenario(str(path), data)
    files = {path.name: _digest(data)}
    problems: list[Problem] = []

    def related(name: str, place: Place) -> tuple[str, bytes] | None:
        target = path.parent / name
        try:
            content = read_file(target)
        except UsageError as error:
            message = str(error).removeprefix(f"{target}: ")
            problems.append(Problem(place, "error", "no-such-file", f'"{name}" {message}'))
        except DocumentError as error:
            problems.extend(error.problems)
        else:
            files[name] = _digest(content)
            return str(target), content
        return None

    documents = []
    for src, _, node in scenario.applications:
        found = related(src, node.attribute_place("src"))
        try:
            if found is not None:
                document, noted = read_document(*found)
                problems += noted
                documents.append(document)
        except DocumentError as error:
            problems += error.problems
    world = robot = None
    try:
        found = related(scenario.world, scenario.node.attribute_place("world"))
        world = read_world(*found) if found else None
    except DocumentError as error:
        problems += error.problems
    try:
        found = related(scenario.robot, scenario.node.attribute_place("robot"))
        robot = read_robot(*found) if found else None
    except DocumentError as error:
        problems += error.problems
    offers = []
    beside = {posixpath.normpath(src) for src, _, _ in scenario.applications}
    for area in world.areas if world is not None and scenario.entrances else []:
        name = posixpath.normpath(posixpath.join(posixpath.dirname(scenario.world), area.src))
        if name in beside:
            continue  # the scenario itself says when it runs
        try:
            found = related(name, area.node.attribute_place("application"))
            if found is not None:
                document, noted = read_document(*found)
                problems += noted
                documents.append(document)
                offers.append((area, document.id))
        except DocumentError as error:
            problems += error.problems
    place = scenario.node.attribute_place("policy")
    if world is not None and scenario.entrances and not world.areas:
        place = scenario.node.attribute_place("entrances")
        message = f'The world "{world.id}" has no <area> that offers an application.'
        problems.append(Problem(place, "error", "no-such-name", message))
    try:
        policy_named(scenario.policy)
    except UsageError as error:
        message = f"{error} {FAVOURITE}"
        problems.append(Problem(place, "error", "bad-value", message))
    if robot is not None:
        for document in documents:
            problems += check_commands(document, robot.commands, robot.devices)
    complete = len(documents) == len(scenario.applications) + len(offers)
    if world is None or robot is None or not complete:
        raise DocumentError(problems)
    if problem := _favourite_problem(scenario.policy, documents):
        problems.append(Problem(place, "error", "no-such-name", *problem))
    cast = Cast(scenario, documents, world, robot, offers)
    problems += check_cast(cast, str(path))
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(set(problems))
    return Loaded(cast, files, sorted(set(problems)))


FAVOURITE = "fixed:APP prefers the application APP."


def _favourite_problem(policy: str, documents: list[Document]) -> tuple[str, str] | None:
    """What is wrong with the application that ``fixed:APP`` names, and what was meant."""
    kind, _, first = policy.partition(":")
    names = [document.id for document in documents]
    if kind != "fixed" or not first or first in names:
        return None
    hint = did_you_mean(first, names) or f"Write {one_of(names)}."
    return f'The policy "{policy}" names an application that is not in the scenario.', hint


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@dataclass(slots=True)
class Transcript:
    """Records of a run, times in seconds, with the views that people want of them."""

    records: list[Record]
    """Empty where a run was told not to keep them."""
    name: str = ""
    failures: list[str] = field(default_factory=list)
    """Applications that ended by an error, as ``NAME: what``."""
    outcome: str = ""
    """How the run ended: ``over``, ``quiet``, ``until`` or ``limit``."""
    cut: str = ""
    """What is wrong with the line at which a partial transcript ends."""
    measure: Measure | None = None
    """What was counted while the run went on."""

    def rows(self) -> list[Row]:
        """The rows of the table."""
        from prima.transcript.table import make_rows

        try:
            return make_rows(self.records)
        except (KeyError, TypeError, ValueError, AttributeError):
            raise UsageError(f"{self.name}: a record lacks what its phase has.") from None

    def table(self, why: bool = False) -> str:
        """The table as text; with ``why``, each row with the rule that put it there."""
        from prima.transcript.table import format_rows

        return format_rows(self.rows(), why)

    def summary(self) -> Summary:
        """What can be counted in it."""
        from prima.transcript.measures import summarize

        return self.measure.summary() if self.measure else summarize(self.records)

    def dumps(self) -> str:
        """The transcript as JSON lines."""
        from prima.transcript.lines import line

        made = ({**record, "time": record["time"] * 1000} for record in self.records)
        return "".join(line(record) for record in made)


Sink = Callable[[str], object]


def rehearse(
    scenario: str | Path | Loaded,
    policy: str | None = None,
    bound: int | None = None,
    sink: Sink | None = None,
    keep: bool = True,
) -> Transcript:
    """Run a scenario in simulation.

    Args:
        scenario: its path, or what :func:`load_scenario` gave.
        policy: ``prima``, ``fifo``, ``fair``, ``fixed``, ``fixed:APP`` or ``none``;
            by default the scenario's own.
        bound: rule E4's bound on loops of a feedback Command.
        sink: is given each line of the transcript as soon as it is made.
        keep: whether the records are kept in memory; without, only the sink has them.

    Raises:
        DocumentError: documents are wrong.
        UsageError: no such policy or file.
    """
    from prima.scheduler.selection import policy_named
    from prima.sim.rehearsal import Rehearsal
    from prima.transcript.lines import finished, line
    from prima.transcript.measures import Measure

    loaded = scenario if isinstance(scenario, Loaded) else load_scenario(scenario)
    cast = loaded.cast
    name = cast.scenario.policy if policy is None else policy
    try:
        chosen = policy_named(name)
    except UsageError as error:
        raise UsageError(f"{error} {FAVOURITE}") from None
    if problem := _favourite_problem(name, cast.documents):
        raise UsageError(" ".join(problem))
    rehearsal = Rehearsal(cast, chosen, bound)
    head: Record = {
        "time": 0,
        "phase": "run",
        "actor": "mediator",
        "data": {
            "version": VERSION,
            "scenario": cast.scenario.id,
            "policy": name,
            "bound": bound,
            "applications": [doc.id for doc in cast.documents],
            "files": loaded.files,
        },
    }
    measure = Measure()
    made = Transcript([], cast.scenario.id, measure=measure)
    for records in chain([[head]], rehearsal.run()):
        for record in records:
            measure.add(record, record["time"] / 1000)
            if keep:
                made.records.append(finished(record))
            if sink is not None:
                sink(line(record))
    made.failures = list(rehearsal.session.failures)
    made.outcome = rehearsal.outcome
    return made


def read(path: str | Path, partial: bool = False) -> Transcript:
    """Read a transcript; with ``partial``, one that was cut off as far as it goes.

    Raises:
        UsageError: it cannot be read, or is none; the line is named.
    """
    from prima.transcript.lines import MAX_LINE, read_lines

    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            lines = iter(lambda: stream.readline(MAX_LINE + 2), "")
            cut: list[str] | None = [] if partial else None
            records = list(read_lines(str(path), lines, cut))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path}: this is no transcript: it is not UTF-8.") from None
    return Transcript(records, str(path), cut=" ".join(cut or ()))


def replay(transcript: Transcript, scenario: str | Path | Loaded) -> Transcript:
    """Run a transcript's inbound records again, without a world: the result is the same.

    Raises:
        UsageError: the scenario's files are not those of the transcript.
        DocumentError: documents are wrong.
    """
    from prima.replay import replay_records
    from prima.transcript.lines import finished

    loaded = scenario if isinstance(scenario, Loaded) else load_scenario(scenario)
    cast = loaded.cast
    head = transcript.records[0]
    if head["phase"] != "run":
        raise UsageError(f"{transcript.name}: the transcript does not begin with its run record.")
    files = head["data"].get("files", {})
    if not isinstance(files, dict):
        raise UsageError(f"{transcript.name}: the run record's files are none.")
    for name, digest in files.items():
        if name in loaded.files and loaded.files[name] != digest:
            raise UsageError(f"{name} is not the file that the transcript was made with.")
        if name not in loaded.files and digest not in loaded.files.values():
            message = f'it was made with "{name}", which is no file of this scenario.'
            raise UsageError(f"{transcript.name}: {message}")
    if transcript.records[-1]["time"] > LONGEST_MS / 1000:
        raise UsageError(f"{transcript.name}: the transcript ends after more than a day.")
    try:
        again = list(replay_records(transcript.records, cast.documents, cast.robot.commands))
    except (KeyError, TypeError, ValueError, AttributeError):
        raise UsageError(f"{transcript.name}: a record lacks what its phase has.") from None
    return Transcript([finished(record) for record in again], transcript.name)


def diff(before: Transcript, after: Transcript) -> Difference:
    """Compare two transcripts by behaviour."""
    from prima.transcript.diff import compare

    difference = compare(before.rows(), after.rows())
    difference.before, difference.after = before.summary(), after.summary()
    return difference


def explain(code: str) -> str:
    """Say what a problem's code means.

    Raises:
        UsageError: there is no such code.
    """
    if code not in CODES:
        raise UsageError(f'There is no code "{code}". {did_you_mean(code, CODES)}'.rstrip())
    return CODES[code]


def explain_row(transcript: Transcript, number: int) -> str:
    """Say why a row of a transcript's table came where it did.

    Raises:
        UsageError: there is no such row.
    """
    rows = transcript.rows()
    if not rows:
        raise UsageError(f"{transcript.name}: the transcript has no rows.")
    if not 0 <= number < len(rows):
        raise UsageError(f"There is no row {number}; the rows are 0 to {len(rows) - 1}.")
    row = rows[number]
    lines = [f"Row {number}, {row.time:.3f} s: " + " ".join(filter(None, (row.app, row.what)))]
    if row.source:
        lines.append(f"Requested at {row.source}.")
    if row.actor != "R":
        lines.append("It came from outside; no rule decided when.")
    for record in transcript.records:
        if record["time"] > row.time:
            break
        line = _reason(record, row)
        if line:
            lines.append(f"{record['time']:.3f} s: {line}")
    return "\n".join(lines)


def _reason(record: Record, row: Row) -> str:
    """What a record has to do with when a row came, if it has; or with the unit around it."""
    phase = record["phase"]
    base = row.behavior.partition(".")[0]
    if not base:
        return ""
    if phase == "decision" and record.get("winner") in (row.behavior, row.unit):
        unit = f"the unit {row.unit} is " if record["winner"] == row.unit else ""
        lost, count = ", ".join(record["losers"]), record["losers_count"]
        before = f"before {lost} ({count} in all)" if lost else "; nothing competed with it"
        return f"{unit}selected by rule {record['rule']} {before}.".replace(" ;", ";")
    about = (record.get("behavior") or "").partition(".")[0]
    if about not in (base, row.unit) or not about:
        return ""
    it = f"the unit {about} is " if about == row.unit else ""
    match phase:
        case "request":
            flag = ", reactive" if record.get("reactive") else ""
            asked = f"{it}requested" if it else f"requested as {base}"
            return f"{asked} ({record['priority']} priority{flag})."
        case "hold":
            return f"{it}held back by {record['by']} (rule {record['rule']})."
        case "resume":
            stream = f"the stream of {about}" if it else f"its stream {record['tree']}"
            return f"{stream} resumes (rule C2)."
        case "start" if not it and record.get("unit"):
            return f"started inside the unit {record['unit']} (rule {record.get('rule')})."
    return ""


def documents_folder() -> Path:
    """The folder of the demo documents that come with the package."""
    inside = Path(__file__).parent / "documents"
    return inside if inside.is_dir() else Path(__file__).parent.parent / "documents"


__all__ = [
    "Difference", "Document", "DocumentError", "Loaded", "Problem", "RunError", "Transcript",
    "UsageError", "diff", "documents_folder", "explain", "explain_row", "load", "load_scenario",
    "read", "rehearse", "replay", "validate",
]  # fmt: skip
