"""Answers among very many, and the difference of long transcripts.

Functions for :mod:`bench.run`; each checks what it measures, and gives one figure:

- :func:`answer`: milliseconds in which one of PRIMA's own fields takes an answer, the slowest of
  several that match and that do not, each the median of some tries. ``how`` is a key of
  :data:`WAYS`. The target is 10 ms for 10,000 entries.
- :func:`spoken`: the same for a grammar of :mod:`prima.grammar`.
- :func:`loading`: milliseconds from the bytes of such a grammar to one that can be matched.
- :func:`difference`: seconds of processor time of ``prima diff`` as a whole process, for two
  transcripts of so many rows of the table (four records each). ``change`` is one of
  :data:`CHANGES`. The target is 10 s for 100,000 rows.
- :func:`difference_memory`: MB that this process takes at most. The target is that it grows no
  more than the rows do: compare 25,000, 50,000 and 100,000.
"""

from __future__ import annotations

import json
import os
import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any, NamedTuple

from bench.fresh import ROOT, check

TRIES = 5
SYLLABLES = ("ka", "mi", "to", "ran", "sel", "vo", "den", "li", "pur", "ash", "om", "ten")

# Grammars ------------------------------------------------------------------------------------


def names(count: int) -> list[str]:
    """So many different names of two or three words; many begin with the same word."""
    chance = random.Random(1)

    def word() -> str:
        return "".join(chance.choices(SYLLABLES, k=chance.randint(2, 4)))

    first = [word() for _ in range(max(count // 30, 2))]
    found: dict[str, None] = {}
    while len(found) < count:
        more = " " + word() if chance.random() < 0.3 else ""
        found[f"{chance.choice(first)} {word()}{more}"] = None
    return list(found)


class Way(NamedTuple):
    """A way to write a grammar of very many alternatives."""

    rules: str
    """Its rules, with {} in place of the alternatives."""
    before: str = ""
    """The beginning of each alternative, before its words."""
    said: str = "{}"
    """An utterance that chooses one or several."""


WAYS = {
    "options": Way(""),
    "one-of": Way('<rule id="r">{}</rule>'),
    "ruleref": Way(
        '<rule id="r"><item repeat="0-1">please</item> call <ruleref uri="#n"/>'
        ' <item repeat="0-1">now</item></rule><rule id="n">{}</rule>',
        said="please call {} now",
    ),
    "repeat": Way(
        '<rule id="r"><item repeat="1-"><ruleref uri="#n"/></item></rule><rule id="n">{}</rule>',
        said="{0} {0} {0} {0}",
    ),
    "optional": Way('<rule id="r">{}</rule>', '<item repeat="0-1">the</item> ', "the {}"),
    "reference": Way(
        '<rule id="r">{}</rule><rule id="v"><one-of><item>ring up</item><item>call</item>'
        "</one-of></rule>",
        '<ruleref uri="#v"/> ',
        "ring up {}",
    ),
    "garbage": Way(
        '<rule id="r"><ruleref special="GARBAGE"/><ruleref uri="#n"/></rule><rule id="n">{}</rule>',
        said="well I would like to see {}",
    ),
}
"""``options`` are for a field alone, and ``garbage`` for SRGS alone."""


def rules(way: Way, held: list[str]) -> str:
    """The rules of a grammar of such names, each with its number as a tag."""
    items = (f"<item>{way.before}{name}<tag>{i}</tag></item>" for i, name in enumerate(held))
    return way.rules.format(f"<one-of>{''.join(items)}</one-of>")


def srgs_text(how: str, held: list[str]) -> bytes:
    """A whole grammar in the XML form of SRGS."""
    head = (
        '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r"'
        ' tag-format="semantics/1.0-literals">'
    )
    return f"{head}{rules(WAYS[how], held)}</grammar>".encode()


def document_text(how: str, held: list[str]) -> bytes:
    """One of PRIMA's own documents with a field that takes such answers."""
    if how == "options":
        taken = "".join(f'<option value="{i}">{name}</option>' for i, name in enumerate(held))
    else:
        taken = f'<grammar root="r">{rules(WAYS[how], held)}</grammar>'
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="g" xml:lang="en">'
        f'<form id="f"><field name="a"><prompt>Who?</prompt>{taken}'
        "<noinput><exit/></noinput><filled><exit/></filled></field></form></prima>"
    ).encode()


def answer(how: str, entries: int) -> float:
    """Milliseconds in which a field takes an answer, or sees that it does not."""
    from prima.interpreter.reader import read_document

    held = names(entries)
    document, problems = read_document("bench.xml", document_text(how, held))
    check(not problems, f"the document has problems: {problems[:1]}")
    (form,) = document.forms.values()
    answers: Any = form.items[0]
    return _slowest(held, WAYS[how].said, answers.answers.match)


def spoken(how: str, entries: int) -> float:
    """Milliseconds in which an SRGS grammar takes an utterance, or sees that it does not."""
    from prima.grammar import load

    held = names(entries)
    grammar = load(srgs_text(how, held))

    def match(text: str) -> object:
        found = grammar.match(text)
        return found[0].interpretation if found else None

    return _slowest(held, WAYS[how].said, match)


def loading(how: str, entries: int) -> float:
    """Milliseconds from the bytes of an SRGS grammar to one that can be matched."""
    from prima.grammar import load

    held = names(entries)
    data = srgs_text(how, held)
    taken = []
    for _ in range(3):
        began = process_time()
        grammar = load(data)
        taken.append(process_time() - began)
        found = grammar.match(WAYS[how].said.format(held[-1]))
        check(bool(found), "the last entry is not taken")
    return median(taken) * 1000


def _slowest(held: list[str], said: str, match: Callable[[str], object]) -> float:
    """Milliseconds of the slowest of several answers, the median of some tries each."""
    last = len(held) - 1
    wanted: list[tuple[str, str | None]] = [
        (said.format(held[number]), str(number)) for number in (0, last // 2, last)
    ]
    wanted += [(said.format(held[last] + " xx"), None), ("nothing of it", None)]
    found = []
    for text, value in wanted:
        taken = []
        for _ in range(TRIES):
            began = process_time()
            got = match(text)
            taken.append(process_time() - began)
            right = got is None if value is None else str(got) == value
            check(right, f'"{text}" gives {got!r} and not {value!r}')
        found.append(median(taken))
    return max(found) * 1000


# Transcripts ---------------------------------------------------------------------------------

CHANGES = ("same", "few", "later", "other", "reversed", "alike")
"""How the second transcript differs from the first: not at all; one row in a hundred is gone, new,
elsewhere or says something else (of a multiple of 400 rows); all comes later from the middle on;
nothing is said that was said before; it comes in reverse order; both say one and the same thing,
in half as many rows."""


LASTS, BETWEEN = 0.4, 0.5
"""How long (s) something takes to say, and after how long something else may be said."""


def said(change: str, rows: int, second: bool) -> list[tuple[float, str]]:
    """The sentences and their times (s), in the first or the second of two transcripts."""
    told = [(float(i), f"This is sentence number {i}.") for i in range(rows)]
    if change == "alike":
        told = [(time, "Hello.") for time, _ in told]
    if not second or change == "same":
        return told
    if change == "few":
        return _few(told)
    if change == "later":
        return [(time + 2.0 * (time > rows / 2), text) for time, text in told]
    if change == "other":
        return [(time, text.replace("sentence", "remark")) for time, text in told]
    if change == "alike":
        return told[: rows // 2]
    return [(time, text) for (time, _), (_, text) in zip(told, reversed(told), strict=True)]


def _few(told: list[tuple[float, str]]) -> list[tuple[float, str]]:
    """One in a hundred is gone, twice there, elsewhere or changed."""
    made: list[tuple[float, str]] = []
    later: list[str] = []
    for number, (time, text) in enumerate(told):
        if number % 400 == 50:
            continue
        made.append((time, text + " Indeed." if number % 400 == 150 else text))
        if number % 400 == 250:
            made.append((time + BETWEEN, "Something new."))
        if number % 400 == 350:
            later.append(made.pop()[1])
        if number % 400 == 390 and later:
            made.append((time + BETWEEN, later.pop()))
    return made


def lines(told: list[tuple[float, str]]) -> Iterator[str]:
    """A transcript's lines; four records for each thing that is said."""
    head = {"data": {"version": "1.0.0", "scenario": "bench", "policy": "prima", "files": {}}}
    yield _line(0.0, "run", "mediator", **head)
    yield _line(0.0, "load", "mediator", app="guide", data={"kind": "ea"})
    for number, (time, text) in enumerate(told, 1):
        name = f"guide#{number}"
        what = {"behavior": name, "tree": "guide:1", "command": "speak", "text": text}
        asked = {"priority": "high", "reactive": False, "state": number, "source": "guide.xml:7"}
        yield _line(time, "request", "robot", app="guide", **what, devices=["speaker"], **asked)
        chosen = {"rule": "S1", "winner": name, "losers": [], "losers_count": 0}
        yield _line(time, "decision", "mediator", app="guide", **chosen)
        yield _line(time, "start", "robot", app="guide", **what, devices=["speaker"], rule="S1")
        yield _line(time + LASTS, "end", "robot", app="guide", **what, outcome="done", inbound=True)
    yield _line(told[-1][0] + 1, "over", "mediator")


def _line(time: float, phase: str, actor: str, **fields: object) -> str:
    record = {"time": round(time, 3), "phase": phase, "actor": actor, **fields}
    return json.dumps(record, separators=(",", ":")) + "\n"


def difference(change: str, rows: int, form: str = "text") -> float:
    """Seconds of processor time of ``prima diff``, read and printed."""
    return _diff(change, rows, form)[0]


def difference_memory(change: str, rows: int, form: str = "text") -> float:
    """MB that ``prima diff`` takes at most."""
    return _diff(change, rows, form)[1]


def _diff(change: str, rows: int, form: str) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as folder:
        for name, second in (("a", False), ("b", True)):
            with open(f"{folder}/{name}.jsonl", "w", encoding="utf-8") as stream:
                stream.writelines(lines(said(change, rows, second)))
        command = [sys.executable, "-m", "prima", "diff", "a.jsonl", "b.jsonl", "--format", form]
        with open(f"{folder}/out", "wb") as out:
            actions = [(os.POSIX_SPAWN_DUP2, out.fileno(), 1)]
            paths = {"PYTHONPATH": str(ROOT)}
            before = os.getcwd()
            os.chdir(folder)
            try:
                environment = {**os.environ, **paths}
                child = os.posix_spawn(command[0], command, environment, file_actions=actions)
            finally:
                os.chdir(before)
            _, status, used = os.wait4(child, 0)
        code = os.waitstatus_to_exitcode(status)
        check(code == (change != "same"), f"prima diff {change} ends with {code}")
        told = Path(folder, "out").read_text(encoding="utf-8")
    _check_told(change, rows, form, told)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def _check_told(change: str, rows: int, form: str, told: str) -> None:
    """Whether the difference is that which was made."""
    if form == "json":
        counts = json.loads(told)["counts"]
    else:
        last = told.splitlines()[-1].partition(";")[0].removeprefix("rows: ")
        pairs = [] if last == "all the same" else [one.split() for one in last.split(", ")]
        counts = {kind: int(number) for number, kind in pairs}
    wanted = {
        "same": {},
        "few": {"moved": rows // 400, "changed": 2 * (rows // 400)},  # what is new is in the place
        "reversed": {"moved": rows - 1, "delayed": 1},
        "later": {"delayed": 1},
        "other": {"changed": rows},
        "alike": {"lost": rows - rows // 2},
    }[change]
    got = {kind: number for kind, number in counts.items() if number}
    check(got == wanted, f"{change}: {got} in place of {wanted}")
