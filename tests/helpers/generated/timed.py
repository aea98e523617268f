"""Applications of Commands whose lengths are known, as data, as documents and generated."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from hypothesis import strategies as st

from prima import api

END = 20_000
"""When the runs end (ms): a tracking goes on for ever."""
EVENTS = ("e0", "e1", "e2", "e3")


class Kind(NamedTuple):
    """A Command of the generated robot; it takes no text."""

    devices: frozenset[str]
    lasts: int
    """How long (ms); of an endless one, each loop."""
    leaves: bool = False
    engages: bool = False
    endless: bool = False


def _kind(devices: str, lasts: int, *marks: str) -> Kind:
    return Kind(frozenset(devices.split()), lasts, **dict.fromkeys(marks, True))


KINDS = {
    "look": _kind("neck", 500),
    "wave": _kind("arm neck", 800),
    "roll": _kind("locomotion", 1100),
    "drive": _kind("locomotion localization", 1700, "leaves"),
    "greet": _kind("arm", 900, "engages"),
    "hug": _kind("arm locomotion", 1300, "engages"),
    "beep": _kind("horn", 300),
    "tracking-human": _kind("human-detection locomotion", 500, "engages", "endless"),
}
WORDS = {"One.": 600, "Two three.": 1100, "Four five six seven.": 1900}
"""What is said, and how long it takes (ms): ten letters a second, and 300 ms."""


@dataclass(frozen=True)
class Do:
    """A Command: a kind, or words."""

    what: str
    now: bool = False


@dataclass(frozen=True)
class Unit:
    """Commands that are grouped as one (U4)."""

    parts: tuple[Do, ...]


@dataclass(frozen=True)
class Par:
    """Branches, each a sequence."""

    branches: tuple[tuple[Do, ...], ...]


@dataclass(frozen=True)
class Log:
    """What divides Commands into runs (O4), and is told when it is reached."""

    number: int


@dataclass(frozen=True)
class GoTo:
    """The state is left for another (O3)."""

    form: str


Step = Do | Unit | Par | Log | GoTo
Content = tuple[Step, ...]


@dataclass(frozen=True)
class Handler:
    """What happens because of an event."""

    content: Content
    reactive: bool = True


@dataclass(frozen=True)
class State:
    """A form: its block, and its handlers by event."""

    block: Content
    handlers: Mapping[str, Handler] = field(default_factory=dict)


Application = Mapping[str, State]
"""States by name; it begins in ``f``."""


@dataclass(frozen=True)
class Timed:
    """Applications, and when which event happens (ms)."""

    apps: tuple[Application, ...]
    events: Mapping[int, str]


Happening = tuple[int, str, int, str]
"""When (ms); start, end, cancel or log; the application's number; the Command or the log."""


# As documents -----------------------------------------------------------------------------


def xml(step: Step | Sequence[Step]) -> str:
    """Content, as a document has it."""
    match step:
        case Do(what, now):
            order = ' order="now"' if now else ""
            if what in WORDS:
                return f"<speak{order}>{what}</speak>"
            if KINDS[what].endless:
                return f"<{what}{order}/>"
            return f'<command type="{what}"{order}/>'
        case Unit(parts):
            return f"<iu>{xml(parts)}</iu>"
        case Par(branches):
            return f"<par>{''.join(f'<seq>{xml(one)}</seq>' for one in branches)}</par>"
        case Log(number):
            return f"<log>L{number}</log>"
        case GoTo(form):
            return f'<goto next="#{form}"/>'
    return "".join(map(xml, step))


def _form(name: str, state: State) -> str:
    handlers = "".join(
        f'<on event="{event}" reactive="{str(one.reactive).lower()}">{xml(one.content)}</on>'
        for event, one in state.handlers.items()
    )
    return f'<form id="{name}"><block>{xml(state.block)}</block>{handlers}</form>'


def _document(name: str, app: Application) -> str:
    forms = "".join(_form(form, state) for form, state in sorted(app.items()))
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa"'
        f' id="{name}" xml:lang="en">{forms}</prima>'
    )


def _robot() -> str:
    devices = {"speaker", *(one for kind in KINDS.values() for one in kind.devices)}
    marks = ("leaves", "engages")
    added = "".join(
        f'<adds command="{name}" devices="{" ".join(sorted(kind.devices))}"'
        f' duration="{kind.lasts}ms"'
        + "".join(f' {mark}="true"' for mark in marks if getattr(kind, mark))
        + "/>"
        for name, kind in KINDS.items()
        if not kind.endless
    )
    return (
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="r" absence="600s">'
        + "".join(f'<device name="{one}"/>' for one in sorted(devices))
        + f'<voice lang="en" rate="10"/>{added}</robot>'
    )


WORLD = (
    '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="here" x="0" y="0"/></world>'
)


def _scenario(timed: Timed) -> str:
    apps = "".join(
        f'<application src="a{number}.xml" kind="fa"/>' for number in range(len(timed.apps))
    )
    events = "".join(
        f'<when at="{time}ms"><event name="{name}"/></when>' for time, name in timed.events.items()
    )
    return (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml" robot="r.xml"'
        f' patience="0s" until="{END}ms"><robot at="here"/>{apps}{events}</scenario>'
    )


def happened(timed: Timed) -> list[Happening]:
    """What happens in a run of the documents, before its end; of units, no parts."""
    files = {"w.xml": WORLD, "r.xml": _robot(), "s.xml": _scenario(timed)}
    files |= {
        f"a{number}.xml": _document(f"a{number}", app) for number, app in enumerate(timed.apps)
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        records = api.rehearse(Path(folder, "s.xml")).records
    named: dict[str, str] = {}
    found: list[Happening] = []
    for record in records:
        phase, time = record["phase"], round(record["time"] * 1000)
        if phase not in ("request", "start", "end", "cancel", "log") or record.get("unit"):
            continue
        what = record.get("message", "")
        if phase != "log":
            base = record["behavior"].partition(".")[0]
            named.setdefault(base, record.get("text") or record["command"])
            what = named[base]
        if phase != "request" and time < END:
            found.append((time, phase, int(record["app"][1:]), what))
    return found


# Generated --------------------------------------------------------------------------------

_words = st.sampled_from(tuple(WORDS))
_plain = st.builds(Do, st.one_of(_words, st.sampled_from(tuple(KINDS))))
_parted = st.builds(Do, st.one_of(_words, st.sampled_from(("look", "wave", "roll", "beep"))))
_step = st.one_of(
    _plain,
    _plain,
    st.builds(Do, st.one_of(_words, st.sampled_from(tuple(KINDS))), st.just(True)),
    st.builds(Unit, st.lists(_parted, min_size=2, max_size=3).map(tuple)),
    st.builds(
        Par,
        st.lists(st.lists(_plain, min_size=1, max_size=2).map(tuple), min_size=2, max_size=3).map(
            tuple
        ),
    ),
    st.builds(Log, st.integers(0, 9)),
)
_content = st.lists(_step, min_size=1, max_size=4).map(tuple)
_leaving = st.tuples(_content, st.sampled_from("fg")).map(lambda one: (*one[0], GoTo(one[1])))
_handler = st.builds(
    Handler, st.one_of(_content, _content, _leaving), st.sampled_from((True, True, True, False))
)
_state = st.builds(State, _content, st.dictionaries(st.sampled_from(EVENTS), _handler, max_size=3))
_app = st.fixed_dictionaries({"f": _state, "g": _state})
timed: st.SearchStrategy[Timed] = st.builds(
    Timed,
    st.lists(_app, min_size=1, max_size=3).map(tuple),
    st.dictionaries(st.integers(1, 9000), st.sampled_from(EVENTS), max_size=6),
)
