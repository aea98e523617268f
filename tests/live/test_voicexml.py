"""VoiceXML applications by drivers: recognisers are told what they listen for."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from prima import api
from prima.live.devices import LiveDevices
from prima.messages import Record
from tests import ROOT
from tests.helpers.voice import vxml
from tests.live.stage import ScenarioDriver, carried_out, live_loop

DOCUMENTS = ROOT / "documents"
CONSOLE = DOCUMENTS / "robots" / "console.xml"


def grammar(*phrases: str, more: str = "") -> str:
    items = "".join(f"<item>{phrase}</item>" for phrase in phrases)
    return f'<grammar version="1.0" root="r" {more}><rule id="r"><one-of>{items}</one-of></rule></grammar>'


LINK = f'<link event="help">{grammar("what is there")}</link>'
DIGITS = grammar("1", "2", more='mode="dtmf"')
MENU = (
    '<menu id="m" scope="document"><prompt>Where?</prompt><choice next="#f">go on</choice></menu>'
)


def heard(tmp_path: Path, body: str, *says: tuple[str, str], root: str = "") -> list[list[str]]:
    """What a driver was told to listen for, one after the other."""
    return [phrases for _, phrases in listened(tmp_path, body, *says, root=root)]


def listened(
    tmp_path: Path, body: str, *says: tuple[str, str], root: str = ""
) -> list[tuple[int, list[str]]]:
    """The same with the time (ms) of each change."""
    application = ""
    if root:
        (tmp_path / "root.vxml").write_text(vxml(root))
        application = ' application="root.vxml"'
    (tmp_path / "app.vxml").write_text(vxml(body).replace("<vxml", f"<vxml{application}", 1))
    answers = "".join(f'<answer to="{asked}">{said}</answer>' for asked, said in says)
    (tmp_path / "scenario.xml").write_text(
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="60s"'
        f' world="{DOCUMENTS}/worlds/room.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        '<robot at="middle"/><person x="1" y="0"/><application src="app.vxml"/>'
        f"{answers}</scenario>"
    )
    loop = live_loop(api.load_scenario(tmp_path / "scenario.xml").cast)
    carried_out(loop)
    assert isinstance(loop.devices, LiveDevices)
    (driver,) = loop.devices.drivers
    assert isinstance(driver, ScenarioDriver)
    return driver.heard


@pytest.mark.parametrize(
    ("field", "takes"),
    [
        (f'<field name="f">ASK{grammar("tea", "green tea")}</field>', ["green tea", "tea"]),
        ('<field name="f">ASK<option>tea</option><option dtmf="1">milk</option></field>', ["milk", "tea"]),
        ('<field name="f" type="boolean">ASK</field>', ["no", "yes"]),
        (f'<field name="f">ASK{DIGITS}<option>tea</option></field>', ["tea"]),
        (
            '<field name="f">ASK<option accept="approximate">green tea</option></field>',
            ["green", "green tea", "tea"],
        ),
        (f'{grammar("coffee")}<field name="f">ASK<option>tea</option></field>', ["coffee", "tea"]),
        (f'{grammar("coffee")}<field name="f" modal="true">ASK<option>tea</option></field>', ["tea"]),
        (f'{LINK}<field name="f">ASK<option>tea</option></field>', ["tea", "what is there"]),
        (
            '<property name="universals" value="help cancel"/>'
            '<field name="f">ASK<option>tea</option></field>',
            ["cancel", "help", "tea"],
        ),
        (
            '<property name="inputmodes" value="dtmf"/>'
            '<field name="f">ASK<option dtmf="1">tea</option></field>',
            [],
        ),
    ],
)  # fmt: skip
def test_a_field_says_what_it_listens_for(tmp_path: Path, field: str, takes: list[str]) -> None:
    asked = field.replace("ASK", '<prompt bargein="false">What?</prompt>')
    found = heard(tmp_path, f'<form id="f">{asked}<block><exit/></block></form>', ("What?", "tea"))
    assert found[0] == takes


def test_what_listens_in_all_of_an_application_does_in_each_document(tmp_path: Path) -> None:
    body = f'<form id="f"><field name="f"><prompt>What?</prompt><option>tea</option></field></form>{MENU}'
    found = heard(tmp_path, body, ("What?", "tea"), root=f"{LINK}<form><block/></form>")
    assert found[0] == ["go on", "tea", "what is there"]


def test_only_the_question_that_is_asked_listens(tmp_path: Path) -> None:
    fields = "".join(
        f'<field name="{name}"><prompt bargein="false">{name.upper()}?</prompt>'
        f"<option>{name}</option></field>"
        for name in ("tea", "milk")
    )
    found = heard(tmp_path, f"<form>{fields}</form>", ("TEA?", "tea"), ("MILK?", "milk"))
    assert [one for one in found if one] == [["tea"], ["milk"]]
    assert found[-1] == []


def test_a_prompt_that_may_be_interrupted_listens_while_it_is_said(tmp_path: Path) -> None:
    asked = '<field name="f"><prompt>What?</prompt><option>tea</option></field>'
    since = {}
    for bargein in ("true", "false"):
        first = f'<block><prompt bargein="{bargein}">Hello, hello, hello.</prompt></block>'
        since[bargein] = listened(tmp_path, f"<form>{first}{asked}</form>", ("What?", "tea"))[0]
    assert since["true"] == (0, ["tea"])
    assert since["false"][0] > 1000 and since["false"][1] == ["tea"]


def test_a_menu_listens_to_its_choices(tmp_path: Path) -> None:
    body = MENU + '<form id="f"><block><exit/></block></form>'
    assert heard(tmp_path, body, ("Where?", "go on"))[0] == ["go on"]


SAME = "the same, byte for byte\n"
ORDER = (
    '<form id="f"><field name="drink"><prompt>Tea or milk?</prompt><option>tea</option>'
    '<option>milk</option></field><field name="sure" type="boolean"><prompt>Sure?</prompt>'
    '</field><block><prompt><value expr="drink"/>, then.</prompt><exit/></block></form>'
)


def live(tmp_path: Path, body: str, typed: str, *words: str) -> subprocess.CompletedProcess[str]:
    """A live run at a terminal; its journal is visit.jsonl."""
    app, journal = tmp_path / "app.vxml", tmp_path / "visit.jsonl"
    app.write_text(vxml(body))
    given = ["live", "--robot", str(CONSOLE), "--ea", str(app), "--speed", "5", "-o", str(journal)]
    return prima(*given, *words, typed=typed)


def prima(*words: str, typed: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "prima", *words],
        input=typed,
        capture_output=True,
        text=True,
        timeout=60,
        cwd=ROOT,
        check=False,
    )


def records(tmp_path: Path) -> list[Record]:
    return [json.loads(line) for line in (tmp_path / "visit.jsonl").read_text().splitlines()]


def replayed(tmp_path: Path) -> str:
    return prima("replay", str(tmp_path / "visit.jsonl")).stderr


def test_a_form_is_filled_at_a_terminal(tmp_path: Path) -> None:
    done = live(tmp_path, ORDER, "/wait\nwater\n/wait\nMilk.\n/wait\nYes.\n")
    assert done.returncode == 0, done.stderr
    assert "robot: milk, then." in done.stderr
    assert replayed(tmp_path) == SAME


STORY = """<form><block><prompt>Once upon a time there was a robot. <mark name="two"/> It went to
the market and bought a large red apple, and then it went home.</prompt><exit/></block></form>"""


TEXT = (
    "Once upon a time there was a robot. It went to the market and bought a large red apple, "
    "and then it went home."
)


def test_x2_a_text_that_was_interrupted_goes_on_at_its_mark(tmp_path: Path) -> None:
    typed = "/wait 5s\n/touch head\n/wait\nNever mind.\n"
    follow = str(DOCUMENTS / "fa" / "follow.xml")
    words = ("--fa", follow, "--policy", "prima+x2", "--until", "25s")
    done = live(tmp_path, STORY, typed, *words)
    said = [line for line in done.stderr.splitlines() if line.startswith("robot:")]
    assert said[:2] == [f"robot: {TEXT}", "robot: (breaks off)"], done.stderr
    assert "robot: " + TEXT.partition("robot. ")[2] in said[2:]
    halted = next(one for one in records(tmp_path) if one["phase"] == "halted")["data"]
    assert halted["mark"] == "two" and TEXT.startswith(halted["heard"])
    assert replayed(tmp_path) == SAME


def driven(
    tmp_path: Path, source: str, kind: str, body: str, *words: str
) -> subprocess.CompletedProcess[str]:
    """A live run by a driver of the test's own, with a simulated body."""
    (tmp_path / "driver.py").write_text(source)
    robot = CONSOLE.read_text().replace('kind="console"', f'kind="{kind}"')
    (tmp_path / "robot.xml").write_text(robot)
    (tmp_path / "app.vxml").write_text(vxml(body))
    given = ("--robot", str(tmp_path / "robot.xml"), "--ea", str(tmp_path / "app.vxml"))
    journal = ("-o", str(tmp_path / "visit.jsonl"), "--driver", str(tmp_path / "driver.py"))
    return prima("live", *given, *journal, *words)


def logs(tmp_path: Path) -> list[str]:
    return [one["message"] for one in records(tmp_path) if one["phase"] == "log"]


TALKER = """
import asyncio
from prima.devices.goals import LISTEN, SAY, Speaks
from prima.live.driver import TaskDriver
from prima.messages import Heard

class Talker(TaskDriver):
    kind = "talker"
    mapped = True
    own = frozenset({SAY, LISTEN})
    asked = 0

    async def perform(self, goal):
        if goal.kind == LISTEN:
            self.asked += 1
            await asyncio.sleep(0.1)
            self.tell(Speaks(True))
            await asyncio.sleep(0.8 if self.asked == 1 else 0.1)
            self.tell(Heard("tea"))
            await asyncio.sleep(60)
        return {}

    def cancel(self, key):
        if self.asked > 1:
            super().cancel(key)
        else:
            asyncio.get_running_loop().call_later(0.9, super().cancel, key)

DRIVER = Talker
"""


def test_who_speaks_for_too_long_is_cut_off(tmp_path: Path) -> None:
    field = '<field name="f"><prompt>What?</prompt><option>tea</option>'
    caught = '<catch event="maxspeechtimeout"><log>too long</log><reprompt/></catch></field>'
    longest = '<property name="maxspeechtimeout" value="400ms"/>'
    block = '<block><log expr="f"/><exit/></block>'
    done = driven(tmp_path, TALKER, "talker", f"{longest}<form>{field}{caught}{block}</form>")
    assert done.returncode == 0, done.stderr
    assert logs(tmp_path) == ["too long", "tea"]
    said = [one for one in records(tmp_path) if one.get("event") == "speech"]
    assert [one["text"] for one in said] == ["", "tea"]
    assert replayed(tmp_path) == SAME


# Recordings ---------------------------------------------------------------------------------

NOTE = """<form><record name="note" beep="true" maxtime="8s" finalsilence="2s">
<prompt>Leave a note.</prompt></record><block>
<log expr="[note, note$.duration, note$.size, note$.maxtime].join()"/>
<prompt>I have <audio expr="note"/> now.</prompt><exit/></block>
<catch event="error.noresource"><prompt>I cannot record.</prompt><exit/></catch></form>"""
RECORDER = """
from prima.devices.goals import LISTEN, RECORD, SAY, Speaks
from prima.live.driver import TaskDriver
import asyncio, sys

class Recorder(TaskDriver):
    kind = "recorder"
    mapped = True
    own = frozenset({SAY, LISTEN, RECORD})

    async def perform(self, goal):
        if goal.kind == SAY:
            cues = [cue for cue in goal.command.cues if cue.kind == "sound"]
            print("robot:", goal.command.text, [cue.value for cue in cues],
                  [len(self.recordings.samples(cue.value) or b"") for cue in cues],
                  file=sys.stderr)
            return {}
        if goal.kind == RECORD:
            await asyncio.sleep(0.2)
            self.tell(Speaks(True))
            print("bounds:", goal.bounds.longest, goal.bounds.silence, file=sys.stderr)
            self.tell(self.recordings.keep(bytes(16000), 8000))
        await asyncio.sleep(60)

DRIVER = Recorder
"""


def test_a_recording_is_a_file_beside_the_journal(tmp_path: Path) -> None:
    done = driven(tmp_path, RECORDER, "recorder", NOTE)
    assert done.returncode == 0, done.stderr
    size = (tmp_path / "visit-1.wav").stat().st_size
    assert logs(tmp_path) == [f"visit-1.wav,1000,{size},false"]
    assert "robot: Leave a note. [beep] ['[beep]'] [0]" in done.stderr
    assert "bounds: 8000 2000" in done.stderr
    assert "robot: I have visit-1.wav now. ['visit-1.wav'] [16000]" in done.stderr
    (heard,) = (one for one in records(tmp_path) if one.get("event") == "speech")
    facts = {"duration": 1000, "size": size, "type": "audio/x-wav", "maxtime": False}
    assert (heard["text"], heard["data"]) == ("visit-1.wav", facts)
    assert replayed(tmp_path) == SAME


def test_a_recording_is_not_kept_where_what_users_say_is_left_out(tmp_path: Path) -> None:
    done = driven(tmp_path, RECORDER, "recorder", NOTE, "--redact")
    assert done.returncode == 0, done.stderr
    assert "robot: I have recording-1.wav now. ['recording-1.wav'] [16000]" in done.stderr
    assert list(tmp_path.glob("*.wav")) == []


def test_a_robot_that_cannot_record_says_so_to_the_application(tmp_path: Path) -> None:
    deaf = RECORDER.replace("{SAY, LISTEN, RECORD}", "{SAY, LISTEN}")
    done = driven(tmp_path, deaf, "recorder", NOTE)
    assert done.returncode == 0, done.stderr
    assert "robot: I cannot record." in done.stderr
    end = next(one for one in records(tmp_path) if one["phase"] == "end")
    assert end["data"] == {"outcome": "error.noresource", "message": "no driver records"}
    assert replayed(tmp_path) == SAME


def test_at_a_terminal_a_recording_is_what_is_typed(tmp_path: Path) -> None:
    done = live(tmp_path, NOTE, "/wait\nCall me.\n")
    assert done.returncode == 0, done.stderr
    assert logs(tmp_path) == ["Call me.,800,8,false"]
    assert "robot: I have Call me. now." in done.stderr


@pytest.mark.parametrize("typed", ["Call me.", "Call Ermintrude at six."])
def test_a_typed_recording_is_left_out_where_what_users_say_is(tmp_path: Path, typed: str) -> None:
    done = live(tmp_path, NOTE, f"/wait\n{typed}\n", "--redact")
    assert done.returncode == 0 and f"robot: I have {typed} now." in done.stderr
    assert typed.rstrip(".") not in (tmp_path / "visit.jsonl").read_text()
    assert logs(tmp_path)[0].startswith("[redacted].,")
