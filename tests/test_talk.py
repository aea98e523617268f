"""Playing the user: what is typed happens, is told, and is saved as a scenario that repeats it."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima import api
from prima.errors import UsageError
from prima.grammar.answers import Answers
from prima.messages import Record
from prima.talk import Conversation, Game
from prima.talk.phrases import phrases
from prima.talk.scene import comment
from prima.talk.typed import COMMANDS, LONGEST_LINE, Names, complete, read_line
from prima.transcript.lines import line as as_line
from prima.transcript.row import Row
from prima.transcript.rows import GrowingTable
from tests.robot import document

ROOT = Path(__file__).parent.parent
DOCUMENTS = ROOT / "documents"
TOUCHED = DOCUMENTS / "scenarios" / "touched-on-the-way.xml"
EXAMPLES = int(os.environ.get("PRIMA_EXAMPLES", "25"))


class Paper:
    """A screen that keeps what it shows."""

    interactive = True

    def __init__(self) -> None:
        self.made: list[Row] = []
        self.shown: list[str] = []
        self.told: list[str] = []

    def rows(self, rows: list[Row]) -> None:
        self.made += rows

    def show(self, text: str) -> None:
        self.shown.append(text)

    def tell(self, text: str) -> None:
        self.told.append(text)

    @property
    def what(self) -> list[str]:
        return [row.what for row in self.made]


def start(
    scenario: Path = TOUCHED, real: bool = False, **more: object
) -> tuple[Conversation, Paper]:
    game = Game(api.load_scenario(scenario), str(scenario.parent), **more)  # type: ignore[arg-type]
    paper = Paper()
    talk = Conversation(game, paper, real)
    if not real:
        talk.begin()
    return talk, paper


def type_in(talk: Conversation, *lines: str) -> None:
    for text in lines:
        talk.line(text)


def room(tmp_path: Path, ea: str, more: str = "") -> Path:
    """A scenario with one application in an empty room."""
    (tmp_path / "ea.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea" xml:lang="en">'
        f"{ea}</prima>",
        encoding="utf-8",
    )
    path = tmp_path / "scene.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="scene"'
        f' world="{DOCUMENTS}/worlds/room.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        f'<robot at="middle"/><person x="1" y="0"/><application src="ea.xml"/>{more}</scenario>',
        encoding="utf-8",
    )
    return path


ASKS = """<form id="f"><field name="a" type="boolean"><prompt>Well?</prompt>
<noinput><speak>Nothing heard.</speak><exit/></noinput>
<filled><speak>Thanks.</speak><exit/></filled></field></form>"""


# Time ------------------------------------------------------------------------------


def test_time_stops_where_a_question_listens_and_goes_on_with_the_answer(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, ASKS))
    assert paper.what[-1] == '"Well?"'
    assert talk.game.asks is not None
    listens = talk.game.clock
    assert talk.prompt == f"{listens / 1000:g}s ea listens> "
    talk.line("Yes.")
    said = next(row for row in paper.made if row.what == '"Yes."')
    assert talk.game.lines[0].at == listens + 1000  # he thinks for a second
    assert said.time * 1000 > listens + 1000
    assert '"Thanks."' in paper.what
    assert talk.game.over


def test_an_empty_line_lets_a_question_pass(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, ASKS))
    talk.line("")
    assert '"Nothing heard."' in paper.what


def test_a_question_that_waits_for_less_than_a_second_can_be_answered(tmp_path: Path) -> None:
    short = ASKS.replace("<prompt>", '<prompt timeout="300ms">')
    talk, paper = start(room(tmp_path, short))
    talk.line("Yes.")
    assert '"Thanks."' in paper.what


def test_what_is_no_answer_leaves_the_question_open(tmp_path: Path) -> None:
    talk, paper = start(
        room(tmp_path, ASKS.replace("<filled>", "<nomatch><reprompt/></nomatch><filled>"))
    )
    type_in(talk, "Maybe.", "Yes.")
    assert paper.what.count('"Well?"') == 2
    assert '"Thanks."' in paper.what


def test_going_back_in_time_lets_the_user_come_between(tmp_path: Path) -> None:
    talk, paper = start()
    assert '"Here we are."' in paper.what
    type_in(talk, "/back 5s", "/touch head", "Never mind.")
    rows = [(row.time, row.what) for row in talk.game.table.rows]
    assert (5.0, "touches the robot's head") in rows
    assert "resumes Topological Move (to kidode-room)" in [what for _, what in rows]


def test_what_is_played_is_what_a_scenario_would_play() -> None:
    talk, _ = start()
    type_in(talk, "/back 5s", "/touch head", "Never mind.")
    written = api.rehearse(TOUCHED)
    assert talk.game.records == written.records[1:-1]


def test_undo_takes_the_last_line_back_and_nothing_else() -> None:
    talk, paper = start()
    type_in(talk, "/back 5s", "/touch head")
    before = list(talk.game.records)
    type_in(talk, "Never mind.", "/undo")
    assert talk.game.records == before
    assert len(talk.game.lines) == 1
    type_in(talk, "/undo", "/undo")
    assert talk.game.lines == []
    assert paper.told[-1] == "There is nothing to undo."


def test_a_step_is_a_row(tmp_path: Path) -> None:
    talk, _ = start()
    talk.line("/back 0s")
    before = len(talk.game.table.rows)
    talk.line("/step")
    assert talk.game.table.rows[before].what == "Topological Move (to kidode-room)"
    assert len(talk.game.table.rows) == before + 1


def test_waiting_stops_time_exactly(tmp_path: Path) -> None:
    talk, _ = start()
    now = talk.game.clock
    type_in(talk, "/wait 2.5s", "/touch head")
    assert talk.game.lines[0].at == now + 2500


def test_what_never_ends_stops_after_a_minute_without_a_row(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><block><tracking-human/></block></form>')
    talk, paper = start(path)
    assert 60_000 <= talk.game.clock <= 61_000
    before = talk.game.clock
    talk.line("/go")
    assert talk.game.clock == before + 60_000
    assert not paper.told


def test_several_doings_on_a_line_happen_in_sequence() -> None:
    talk, paper = start()
    type_in(talk, "/back 3s", "/touch head /wait 4s Never mind.")
    assert talk.game.lines == []
    assert "no time" in paper.told[-1] or paper.told  # what follows a time is a command
    type_in(talk, "/touch head /wait 4s /say Never mind. /wait 1s")
    assert [one.name for one in talk.game.lines[0].doings] == ["touch", "wait", "say"]
    said = next(row for row in talk.game.table.rows if row.kind == "speech")
    assert talk.game.clock == round(said.time * 1000) + 1000


def test_an_application_that_fails_is_told_and_the_session_goes_on(tmp_path: Path) -> None:
    path = room(
        tmp_path,
        '<form id="f"><on event="touch"><throw event="oh.dear"/></on></form>',
    )
    talk, paper = start(path)
    talk.line("/touch head")
    assert paper.told[-2].startswith("prima: ea: oh.dear")
    assert paper.told[-2].endswith("The session goes on.")
    talk.line("/touch head")
    assert "Every application has ended" in paper.told[-1]
    before = len(paper.made)
    talk.line("/load ea")
    assert paper.made[before].what == "starts ea"
    talk.line("/load ea")
    assert paper.told[-1] == '"ea" is already loaded. Remove it with /unload.'
    type_in(talk, "/unload ea", "/unload ea")
    assert paper.told[-1] in ('"ea" is not loaded. Load it with /load.',) or talk.game.over


def test_the_scenarios_user_is_left_out_unless_he_is_wanted() -> None:
    talk, paper = start()
    assert talk.game.scene.left_out == 2
    assert "touches the robot's head" not in paper.what
    _, paper = start(scripted=True)
    assert paper.what == [row.what for row in api.rehearse(TOUCHED).rows()]


def test_the_surroundings_of_a_scenario_are_kept() -> None:
    _, paper = start(DOCUMENTS / "scenarios" / "schedule-alone.xml")
    assert paper.what


# Rows ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "scenario", sorted((DOCUMENTS / "scenarios").glob("*.xml")), ids=lambda path: path.stem
)
def test_rows_that_come_one_by_one_are_those_of_the_table(scenario: Path) -> None:
    made = api.rehearse(scenario)
    growing = GrowingTable()
    instants: dict[float, list[Record]] = {}
    for record in made.records:
        instants.setdefault(record["time"], []).append(record)
    for records in instants.values():
        growing.add(records)
    assert [row.key for row in growing.rows] == [row.key for row in made.rows()]
    assert [row.number for row in growing.rows] == list(range(len(growing.rows)))


def test_what_the_camera_saw_has_its_row_when_somebody_minds() -> None:
    seen: Record = {
        "time": 1.0, "phase": "event", "actor": "robot", "event": "human.found", "serial": 3,
    }  # fmt: skip
    growing = GrowingTable()
    assert growing.add([seen]) == []
    minded: Record = {
        "time": 2.0, "phase": "request", "actor": "robot", "behavior": "a#1", "cause": 3,
        "command": "speak", "app": "a", "priority": "high",
    }  # fmt: skip
    assert [row.what for row in growing.add([minded])] == ["sees the user"]


# Saving ----------------------------------------------------------------------------

PLAYED = [
    "navigate-alone", "touched-on-the-way", "follow-during-navigation", "pizza-and-follow",
    "library-alone", "museum-alone", "emotions-alone", "leaving-the-museum", "picture-alone",
]  # fmt: skip
LINES = [
    "Yes.", "No.", "Prof. Kidode's room.", "Come on, follow me.", "Never mind.", "", "/go",
    "a large pizza with cheese", "small", "The C Primer", "<&\"'> -- & ]]>", "/touch head",
    "/touch back", "/step", "/wait 0.5s", "/wait 3s", "/wait 1234ms", "/walk 3 0.5", "/walk 0 0",
    "/walk poster", "/look at robot", "/follow", "/follow 0.8", "/stay", "/leave", "/hang-up",
    "/message from Prof. Kidode: I'm -- late", "/message Hello", "/note a remark --",
    "/sensor light=3", "/fail speaker", "/fail locomotion hangs", "/repair speaker",
    "/emergency", "/release", "/release false", "/unload follow", "/load follow", "/undo",
    "/back 4s", "/back 0s", "/touch head /wait 2s /say Never mind.", "/event corner",
    "/touch head /wait 1500ms", "/wait 1s", "/who", "/why", "/nonsense", "/unload guide",
    "/load guide", "/unload navigate", "/load navigate",
]  # fmt: skip


def replayed(talk: Conversation, folder: Path) -> tuple[list[str], list[str], Path]:
    """The records of a session and of the scenario that it is saved as, as lines."""
    path = folder / "saved" / "visit.xml"
    path.parent.mkdir(exist_ok=True)
    talk.save(str(path))
    talk.close()
    again: list[str] = []
    api.rehearse(path, sink=again.append, keep=False)
    mine = [as_line({**record, "time": record["time"] * 1000}) for record in talk.game.records]
    return mine, again[1:], path


@settings(
    max_examples=EXAMPLES,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    name=st.sampled_from(PLAYED),
    lines=st.lists(st.sampled_from(LINES), max_size=12),
    scripted=st.booleans(),
    data=st.data(),
)
def test_a_saved_session_runs_to_the_same_transcript(
    name: str, lines: list[str], scripted: bool, data: st.DataObject, tmp_path: Path
) -> None:
    scenario = DOCUMENTS / "scenarios" / f"{name}.xml"
    talk, paper = start(scenario, scripted=scripted)
    type_in(talk, *lines)
    mine, again, path = replayed(talk, tmp_path)
    assert mine == again, path.read_text(encoding="utf-8")
    problems = [one for one in api.validate([path]) if one.severity != "note"]
    later = {"out-of-range"} if scripted else set()  # what the script had still to come
    assert not [one for one in problems if one.code not in later], paper.told


@settings(
    max_examples=EXAMPLES,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(seed=st.integers(0, 10_000), name=st.sampled_from(PLAYED))
def test_a_session_in_real_time_is_saved_as_well(seed: int, name: str, tmp_path: Path) -> None:
    chance = random.Random(seed)
    talk, _ = start(DOCUMENTS / "scenarios" / f"{name}.xml", real=True)
    now = 0
    for _ in range(8):
        now = talk.game.clock + chance.choice([0, 1, 17, 400, 3000, 20_000])
        talk.pass_time(now)
        talk.line(chance.choice(LINES))
    mine, again, path = replayed(talk, tmp_path)
    assert mine == again, path.read_text(encoding="utf-8")


def test_a_saved_session_can_be_taken_up_again(tmp_path: Path) -> None:
    talk, _ = start()
    type_in(talk, "/back 5s", "/touch head")
    path = tmp_path / "visit.xml"
    talk.save(str(path))
    again, _ = start(path, scripted=True)
    assert [row.key for row in again.game.table.rows] == [row.key for row in talk.game.table.rows]
    again.line("Never mind.")
    assert again.game.table.rows[-1].what == "Topological Move" or '"Never mind."' in [
        row.what for row in again.game.table.rows
    ]


def test_a_saved_session_says_which_row_each_line_follows(tmp_path: Path) -> None:
    talk, _ = start()
    type_in(talk, "/back 5s", "/touch head")
    text = talk.game.saved(str(tmp_path / "my visit.xml"))
    assert "<!-- after row 3, 1.16 s: guide Topological Move (to kidode-room) -->" in text
    assert '<when at="5s"><touch sensor="head"/></when>' in text
    assert 'id="touched-on-the-way"' in text  # "my visit" is no id
    assert os.path.relpath(DOCUMENTS, tmp_path) in text


@given(st.text(alphabet="a-> ", max_size=12))
def test_a_comment_never_ends_before_its_end(text: str) -> None:
    assert "--" not in f"{comment(text)} "[:-1] + " "
    assert not comment(text).endswith("-")


def test_no_file_is_written_over_that_is_no_saved_session(tmp_path: Path) -> None:
    talk, paper = start()
    other = tmp_path / "thesis.xml"
    other.write_text("precious", encoding="utf-8")
    talk.line(f"/save {other}")
    assert "is not a saved session" in paper.told[-1]
    assert other.read_text(encoding="utf-8") == "precious"
    talk.line(f"/save {tmp_path}/new.xml")
    talk.line(f"/save {tmp_path}/new.xml")
    assert paper.told[-1] == f"Saved {tmp_path}/new.xml."
    talk.line(f"/save {tmp_path}/nowhere/new.xml")
    assert "there is no folder" in paper.told[-1]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new.xml", "thesis.xml"]


# Lines -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("/tuch head", 'Unknown command "/tuch". Did you mean "/touch"?'),
        ("/touch", 'Write "/touch SENSOR".'),
        ("/touch hed", 'There is no touch sensor "hed". Did you mean "head"?'),
        ("/touch nose", 'There is no touch sensor "nose". There is back and head.'),
        ("/walk postr", 'There is no place or thing "postr". Did you mean "poster"?'),
        ("/walk 1", None),
        ("/walk 1 x", '"x" is not a number. Write digits, as in "1.5".'),
        ("/walk 5000 0", None),
        ("/walk", 'Write "/walk PLACE, /walk X Y".'),
        ("/look at nothing-here", None),
        ("/follow far", None),
        ("/message from Ann I'm late", 'Write "/message from NAME: TEXT".'),
        ("/message", 'Write "/message from NAME: TEXT".'),
        ("/message from", 'Write "/message from NAME: TEXT".'),
        ("/event", 'Write "/event NAME KEY=VALUE ...".'),
        ('/event corner a="b', "A quotation mark is not closed."),
        ("/event nothing.of.this.kind", None),
        ("/fail nose", None),
        ("/fail speaker often", 'Write "/fail DEVICE, /fail DEVICE hangs".'),
        ("/sensor light", 'Write "/sensor NAME=VALUE".'),
        ("/release maybe", None),
        ("/unload flow", 'There is no application "flow". Did you mean "follow"?'),
        ("/stay here", 'Nothing follows "/stay".'),
        ("/wait", 'Write "/wait TIME", as in "/wait 3s".'),
        ("/wait 3", '"3" is not a time. Write a number with its unit: "500ms" or "2.5s".'),
        ("/wait 3s /touch head", 'A line begins with an action: "/touch head /wait 3s /say Stop."'),
        ("/touch head /go", '"/go" must be alone on its line.'),
        ("/go on", 'Nothing follows "/go".'),
        ("/back", 'Write "/back TIME", as in "/back 5s".'),
        ("/back 900s", None),
        ("/why 99", 'There is no row "99"; the rows are 0 to 7.'),
        ("/why -1", None),
        ("/why \u00b2", None),
        ("/help tuch", 'Unknown command "/tuch". Did you mean "/touch"?'),
        ("/save", 'Write "/save FILE", as in "/save visit.xml".'),
        ("/save a\0b", "The line contains an invalid character: U+0000."),
        ("a\x1b[31mb", "The line contains an invalid character: U+001B."),
        ("x" * (LONGEST_LINE + 1), f"The line is longer than {LONGEST_LINE} characters."),
        ("\udcff", "The line contains an invalid character: U+DCFF."),
        ("/say", 'Write "/say TEXT".'),
    ],
)  # fmt: skip
def test_nonsense_is_answered_with_what_to_write(text: str, message: str | None) -> None:
    talk, paper = start()
    before = list(talk.game.records)
    talk.line(text)
    assert talk.wrong == 1, paper.told
    assert message is None or paper.told[-1] == message
    assert talk.game.records == before
    assert talk.game.lines == []


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=60), st.sampled_from(sorted(COMMANDS)).flatmap(
    lambda name: st.text(max_size=20).map(lambda rest: f"/{name} {rest}"))))  # fmt: skip
def test_whatever_is_typed_is_read_or_refused(text: str) -> None:
    try:
        line = read_line(text)
    except UsageError:
        return
    assert line.xml or line.control


def test_somebody_who_is_gone_does_not_walk() -> None:
    talk, paper = start()
    type_in(talk, "/leave", "/walk 0 0")
    assert paper.told[-1] == 'Nobody is there to do "/walk".'


def test_who_tells_what_runs_and_what_is_asked() -> None:
    talk, paper = start(DOCUMENTS / "scenarios" / "navigate-alone.xml")
    talk.line("/who")
    assert "navigate listens" in paper.shown[-1]
    assert "running: navigate#1" in paper.shown[-1]
    assert "Prof. Kidode" not in paper.told


def test_why_gives_the_rule() -> None:
    talk, paper = start()
    type_in(talk, "/back 5s", "/touch head", "/why", "/why 4")
    assert "selected by rule" in paper.shown[-2]
    assert "It came from outside" in paper.shown[-1]


def test_a_session_has_a_limit() -> None:
    talk, paper = start()
    talk.line("/wait 86000s")
    talk.line("/wait 86000s")
    assert talk.done
    assert "no longer than a day" in paper.told[-1]


# Completion ------------------------------------------------------------------------

NAMES = Names(frozenset({"head", "back"}), frozenset({"poster"}), applications=frozenset({"a"}))


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("/t", ["/touch "]),
        ("/touch ", ["/touch back", "/touch head"]),
        ("/touch h", ["/touch head"]),
        ("/look at r", ["/look at robot"]),
        ("/touch head /wa", ["/touch head /walk ", "/touch head /wait "]),
        ("y", ["yes"]),
        ("", ["yes", "no"]),
        ("/nothing x", []),
    ],
)
def test_completion(text: str, lines: list[str]) -> None:
    assert complete(text, NAMES, ["yes", "no"]) == lines


def test_some_answers_to_a_question_are_known() -> None:
    answers = taken(
        '<option value="1">none</option><grammar><rule id="r"><ruleref uri="#f"/><tag>x</tag></rule>'
        '<rule id="f"><one-of><item>an apple</item><item>a <one-of><item>pear</item>'
        "<item>fig</item></one-of></item></one-of></rule></grammar>",
        "boolean",
    )
    assert phrases(answers) == ["none", "yes", "no", "an apple", "a pear", "a fig"]


def test_a_grammar_without_end_does_not_keep_anybody_waiting() -> None:
    again = '<ruleref uri="#r"/>' * 8
    grammar = f'<rule id="r"><one-of><item>{again}</item><item>a</item></one-of></rule>'
    began = time.monotonic()
    phrases(taken(f"<grammar>{grammar}</grammar>"))
    assert time.monotonic() - began < 2


def taken(inside: str, type: str = "text") -> Answers:
    """What a field takes that holds something."""
    named = "" if type == "text" else f' type="{type}"'
    made = document(
        f'<form id="f"><field name="a"{named}><prompt>?</prompt>{inside}</field></form>'
    )
    return made.forms["f"].items[0].answers  # type: ignore[attr-defined, no-any-return]


def test_the_options_of_the_question_are_offered(tmp_path: Path) -> None:
    talk, _ = start(room(tmp_path, ASKS))
    assert talk.options == ["yes", "no"]


# The command -----------------------------------------------------------------------


def prima(
    folder: Path, given: bytes, *words: str, timeout: float = 60
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "prima", "talk", *words],
        cwd=folder,
        input=given,
        capture_output=True,
        timeout=timeout,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )


def test_a_pipe_plays_the_user(tmp_path: Path) -> None:
    done = prima(tmp_path, b"/back 5s\n/touch head\nNever mind.", str(TOUCHED), "--save", "v.xml")
    assert done.returncode == 0, done.stderr
    text = done.stdout.decode()
    assert "touches the robot's head" in text
    assert "\x1b" not in text
    assert "> " not in text
    assert (tmp_path / "v.xml").read_text(encoding="utf-8").count("<when") == 2
    assert "Saved v.xml." in done.stderr.decode()


def test_json_is_a_transcript_that_the_saved_session_repeats(tmp_path: Path) -> None:
    done = prima(
        tmp_path, b"/touch head\nNever mind.\n/undo\n", str(TOUCHED), "--format", "json",
        "--save", "v.xml",
    )  # fmt: skip
    assert done.returncode == 1
    assert b"cannot be undone" in done.stderr
    (tmp_path / "t.jsonl").write_bytes(done.stdout)
    played = api.read(tmp_path / "t.jsonl")
    again = api.rehearse(tmp_path / "v.xml")
    assert played.records[1:] == again.records[1:]
    assert api.replay(played, tmp_path / "v.xml").records == played.records
    assert json.loads(done.stdout.splitlines()[0])["phase"] == "run"


def test_applications_alone_are_played_in_a_room(tmp_path: Path) -> None:
    (tmp_path / "ea.xml").write_text(
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea">{ASKS}</prima>',
        encoding="utf-8",
    )
    done = prima(tmp_path, b"Yes.\n", "--ea", "ea.xml", "--save", "v.xml")
    assert done.returncode == 0, done.stderr
    assert b'"Thanks."' in done.stdout
    assert 'src="ea.xml"' in (tmp_path / "v.xml").read_text(encoding="utf-8")
    assert [row.what for row in api.rehearse(tmp_path / "v.xml").rows()][-1] == "ends ea: exit"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "Name a scenario, or applications with --fa and --ea."),
        ([str(TOUCHED), "--step", "--real-time"], "Write --step or --real-time, not both."),
        ([str(TOUCHED), "--policy", "prma"], "prma"),
        ([str(TOUCHED), "--save", str(TOUCHED)], "one of the run's own documents"),
        ([str(TOUCHED), "--save", "nowhere/x.xml"], "there is no folder nowhere"),
        (["nothing.xml"], "nothing.xml: cannot be read"),
    ],
)
def test_wrong_usage_is_refused(tmp_path: Path, words: list[str], message: str) -> None:
    done = prima(tmp_path, b"", *words)
    assert done.returncode == 2
    assert message in done.stderr.decode()


def test_what_is_piped_may_be_anything(tmp_path: Path) -> None:
    done = prima(tmp_path, b"\xff\xfe\n" + b"x" * 3_000_000 + b"\n\0\n/who\n", str(TOUCHED))
    assert done.returncode == 1
    errors = done.stderr.decode()
    assert "not UTF-8" in errors
    assert "2000 characters" in errors
    assert "U+0000" in errors
    assert b"working memory" in done.stdout


def test_an_application_that_failed_gives_exit_code_3(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><on event="touch"><throw event="oh.dear"/></on></form>')
    done = prima(tmp_path, b"/touch head\n/who\n", str(path))
    assert done.returncode == 3
    assert b"The session goes on." in done.stderr


def test_real_time_takes_its_time(tmp_path: Path) -> None:
    path = room(tmp_path, ASKS.replace("<prompt>", '<prompt timeout="700ms">'))
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "talk", str(path), "--real-time"],
        cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert process.stdin and process.stdout
    process.stdout.readline()
    began, seen = time.monotonic(), b""
    while b"Nothing heard" not in seen:
        seen = process.stdout.readline()
        assert seen
    assert time.monotonic() - began > 0.8
    process.stdin.close()
    assert process.wait(30) == 0
    process.stdout.close()


# A terminal ------------------------------------------------------------------------

pty = pytest.importorskip("pty")


class Terminal:
    """The command in a terminal of its own."""

    def __init__(self, *words: str, folder: Path, **variables: str) -> None:
        self.pid, self.fd = pty.fork()
        if self.pid == 0:  # pragma: no cover
            os.chdir(folder)
            os.environ.update({"PYTHONPATH": str(ROOT), "TERM": "xterm", **variables})
            os.environ.setdefault("COLUMNS", "120")
            os.execv(sys.executable, [sys.executable, "-m", "prima", "talk", *words])
        self.seen = ""

    def type(self, text: str) -> None:
        os.write(self.fd, text.encode())

    def until(self, text: str, seconds: float = 30) -> str:
        """Wait until a text has come, and give all since the last time."""
        import select

        end, got = time.monotonic() + seconds, self.seen
        while text not in got:
            assert time.monotonic() < end, (text, got)
            if select.select([self.fd], [], [], 0.2)[0]:
                try:
                    got += os.read(self.fd, 65536).decode("utf-8", "replace")
                except OSError:
                    break
        assert text in got, got
        at = got.index(text) + len(text)
        self.seen, got = got[at:], got[:at]
        return got

    def end(self) -> int:
        import select

        end = time.monotonic() + 30
        while time.monotonic() < end:
            if select.select([self.fd], [], [], 0.1)[0]:
                try:
                    self.seen += os.read(self.fd, 65536).decode("utf-8", "replace")
                except OSError:
                    pass
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                os.close(self.fd)
                return os.waitstatus_to_exitcode(status)
        raise AssertionError(self.seen)


def test_a_terminal_step_by_step(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, ASKS)), "--step", folder=tmp_path)
    terminal.until("ea listens> ")
    terminal.type("/wh\t\t")
    terminal.until("/who")
    terminal.type("\x15y\t\r")  # the answer is completed
    terminal.until("\x1b[36m")
    terminal.until('"yes"')
    terminal.until("Every application has ended")
    terminal.type("/save visit.xml\r")
    terminal.until("Saved visit.xml.")
    terminal.until("> ")  # before, the key would be nobody's
    terminal.type("\x04")
    assert terminal.end() == 0
    assert (tmp_path / "visit.xml").exists()


def test_no_colour_where_none_is_wanted(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, ASKS)), "--step", folder=tmp_path, NO_COLOR="1")
    terminal.until("ea listens> ")
    terminal.type("Yes.\r")
    assert "\x1b[3" not in terminal.until("ends ea: exit")
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_ctrl_c_ends_with_130_and_what_was_saved_is_intact(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><on event="touch"><speak>Ouch.</speak></on></form>')
    for mode in ("--step", "--real-time"):
        target = tmp_path / f"at-end{mode}.xml"
        terminal = Terminal(str(path), mode, "--save", str(target), folder=tmp_path)
        terminal.until("> ")
        terminal.type("/touch head\r")
        terminal.until("Ouch.")
        terminal.type("/save first.xml\r")
        terminal.until("Saved first.xml.")
        terminal.until("> ")  # before, the key would be nobody's
        terminal.type("half a li")
        terminal.until("half a li")
        time.sleep(0.5)  # readline notices a signal only while it waits for a key
        terminal.type("\x03")
        assert terminal.end() == 130
        assert "interrupted" in terminal.seen
        for saved in (tmp_path / "first.xml", target):
            assert "Ouch." not in saved.read_text(encoding="utf-8").partition("<when")[0]
            assert any("Ouch" in row.what for row in api.rehearse(saved).rows())


TICKS = (
    '<form id="f"><block><send event="tick" delay="2s"/></block>'
    '<on event="tick"><speak>Tick.</speak></on></form>'
)


def test_time_stands_still_while_a_line_is_typed(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, NO_COLOR="1")
    terminal.until("> ")
    terminal.type("/hel")
    terminal.until("/hel")
    with pytest.raises(AssertionError):
        terminal.until('"Tick."', seconds=4)
    terminal.type("p walk\r")
    terminal.until("walks to a place or thing")
    terminal.until('"Tick."')  # it goes on
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_a_question_waits_for_who_types_the_answer(tmp_path: Path) -> None:
    path = room(tmp_path, ASKS.replace("<prompt>", '<prompt timeout="2s">'))
    terminal = Terminal(str(path), folder=tmp_path, NO_COLOR="1")
    terminal.until('"Well?"')
    terminal.type("y")
    terminal.until("y")
    time.sleep(5)
    terminal.type("es\r")
    assert "Nothing heard" not in terminal.until('"Thanks."')
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_rows_come_above_the_line_that_is_typed(tmp_path: Path) -> None:
    from prima.cli.terminal import Keyboard

    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, NO_COLOR="1")
    terminal.until("> ")
    terminal.type("/note a\r/hel")  # the note's row comes while the next line is typed
    terminal.until("> /hel")
    terminal.type("p walk\r")
    terminal.until("walks to a place or thing")
    terminal.type("/quit\r")
    assert terminal.end() == 0
    assert Keyboard("> ").begun() is False


@pytest.mark.parametrize("begun", [(), (1, 2, 3)])
def test_a_clock_leaves_out_what_was_typed(
    begun: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    from prima.cli import terminal

    moment = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: moment[0])

    class Hand(terminal.Piped):
        """Types at some of the clock's looks, and is done at the sixth."""

        looks = 0

        def begun(self) -> bool:
            return self.looks in begun

        def line(self, wait: float | None) -> str | None:
            self.looks += 1
            moment[0] += wait or 0
            if self.looks == 6:
                return "yes"
            raise TimeoutError

    clock, hand = terminal.Clock(), Hand()
    assert clock.line(hand, 10_000) == "yes"
    assert clock.now == 600 - 100 * len(begun)


def test_what_nobody_listens_to_is_told(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, TICKS))
    talk.line("Hello?")
    assert 'Nobody listens: "Hello?" is lost.' in paper.told
    talk.line("/undo")
    talk.line("/wait 1s")
    assert sum("Nobody listens" in told for told in paper.told) == 1, "it is not told again"
    long = ASKS.replace("<prompt>Well?", '<prompt bargein="false">How are you all today, friends?')
    asks, paper = start(room(tmp_path, long), real=True)
    asks.pass_time(100)
    asks.line("Now")
    asks.pass_time(2000)
    assert "ea is still asking; it listens when it has finished." in paper.told[-1]
    answered, paper = start(room(tmp_path, ASKS))
    answered.line("Yes.")
    assert not any("Nobody listens" in told for told in paper.told)


def test_applications_are_talked_to_in_another_world_and_on_another_robot(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        (DOCUMENTS / "robots" / "papero.xml")
        .read_text(encoding="utf-8")
        .replace('id="papero"', 'id="arm"'),
        encoding="utf-8",
    )
    path = room(tmp_path, '<form id="f"><block><topological-move to="lab"/><exit/></block></form>')
    world = DOCUMENTS / "worlds" / "office.xml"
    words = ["--ea", "ea.xml", "--world", str(world), "--robot", "arm.xml"]
    saved = tmp_path / "visit.xml"
    done = prima(tmp_path, b"/wait 60s\n", *words, "--save", "visit.xml")
    assert b"reaches lab" in done.stdout, done.stderr
    text = saved.read_text(encoding="utf-8")
    assert "office.xml" in text and "arm.xml" in text
    assert any(row.what == "reaches lab" for row in api.rehearse(saved).rows())
    (tmp_path / "void.xml").write_text(
        '<world xmlns="urn:prima:world:1" version="1.0" id="void"/>', encoding="utf-8"
    )
    for more, told in (
        (["--world", "nowhere.xml"], "No such file"),
        (["--world", "ea.xml"], "ea.xml"),
        (["--world", "void.xml"], "has no place for the robot"),
        (["--robot", str(world)], "office.xml"),
    ):
        refused = prima(tmp_path, b"", "--ea", "ea.xml", *more)
        assert refused.returncode in (1, 2) and told in refused.stderr.decode(), refused.stderr
    refused = prima(tmp_path, b"", str(path), "--world", str(world))
    assert refused.returncode == 2 and b"a scenario names its own" in refused.stderr
