"""A session is saved as a scenario that repeats it."""

from __future__ import annotations

import os
import random
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima import api
from prima.loading import load_scenario
from prima.talk import Conversation
from prima.talk.game import Game
from prima.talk.scene import comment
from prima.transcript.lines import line as as_line
from tests.helpers.talking import DOCUMENTS, start, type_in

EXAMPLES = int(os.environ.get("PRIMA_EXAMPLES", "25"))


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
    assert [row.key for row in again.game.rows] == [row.key for row in talk.game.rows]
    again.line("Never mind.")
    assert again.game.rows[-1].what == "Topological Move" or '"Never mind."' in [
        row.what for row in again.game.rows
    ]


def test_a_saved_session_says_which_row_each_line_follows(tmp_path: Path) -> None:
    talk, _ = start()
    type_in(talk, "/back 5s", "/touch head")
    text = talk.game.saved(str(tmp_path / "my visit.xml"))
    assert "<!-- after row 3, 1.16 s: guide Topological Move (to kidode-room) -->" in text
    assert '<when at="5s"><touch sensor="head"/></when>' in text
    assert 'id="touched-on-the-way"' in text  # "my visit" is not an id
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
    talk.line(f'/save "{tmp_path}/a name.xml"')
    (tmp_path / "a name.xml").unlink()  # it must be there: a shell takes it without its quotes
    talk.line(f"/save {tmp_path}/nowhere/new.xml")
    assert "there is no folder" in paper.told[-1]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new.xml", "thesis.xml"]


def test_who_plays_behaves_as_they_like(tmp_path: Path) -> None:
    """A user's document says nothing of the author's play, unless the script is played on."""
    users = DOCUMENTS / "users"
    path = tmp_path / "visit.xml"
    text = (DOCUMENTS / "scenarios" / "touched-on-the-way.xml").read_text("utf-8")
    text = text.replace('"../', f'"{DOCUMENTS}/').replace(
        "<person", f'<person user="{users}/chatty.xml"'
    )
    text = text.replace("<answer", '<when at="1s"><one-of><say>a</say></one-of></when><answer', 1)
    path.write_text(text)
    loaded = load_scenario(path)
    played = Game(loaded, str(tmp_path))
    assert played.cast.scenario.whens == []
    assert "chatty" not in played.scene.text([]) and "one-of" not in played.scene.text([])
    scripted = Game(loaded, str(tmp_path), scripted=True)
    assert len(scripted.cast.scenario.whens) == len(loaded.cast.scenario.whens) > 3
    assert "chatty" in scripted.scene.text([])
