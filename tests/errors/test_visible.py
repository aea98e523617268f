"""Text from documents and transcripts reaches terminals, pages and other tools' files as text only."""

from __future__ import annotations

import json
import os
import pty
import re
from concurrent.futures import ThreadPoolExecutor
from io import FileIO
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Message

from prima import api
from prima.cli import COMMANDS
from prima.errors.visible import HARMFUL, escaped, visible
from prima.transcript.lines import finished, line
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.swept import runs, write
from tests.helpers.voice import vxml

IN_XML = "&#x9b;31m&#x7f;&#x202e;&#x2066;&#x200f;&#x2028;&#13;x"
IN_SCRIPT = "\\x1b]0;title\\x07\\x1b[31m\\r\\u202e\\u2066\\u200f\\x9b2J\\ufeff"
RAW = "\x1b]0;title\x07\x1b[31m\u202e\u2066\u200f\x9b2J"
OWN = re.compile(r"\x1b\[[0-9;]*m|\r *\r|\r+(?=[ 0-9\r\n])")
"""What commands themselves write to a terminal: colours, how far they are, and ends of lines."""

APP = f"""<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk"><form id="f">
<block><speak>{IN_XML}</speak><speak><value expr="'{IN_SCRIPT}'"/></speak>
<log expr="'{IN_SCRIPT}'"/><send to="shop"><param name="a" expr="'{IN_SCRIPT}'"/></send></block>
<field name="q"><prompt>Which? {IN_XML}</prompt><option>a</option><option>{IN_XML}</option>
<nomatch><speak>No.</speak></nomatch></field>
<on event="reply.shop"><log expr="JSON.stringify(_event)"/></on>
<block><throw event="foo" message-expr="'{IN_SCRIPT}'"/></block></form></prima>"""
VOICE = vxml(
    f"""<form><block>{IN_XML}<value expr="'{IN_SCRIPT}'"/><data name="d" src="service:w"/>
    <log expr="'{IN_SCRIPT}'"/><log expr="d.documentElement.textContent"/>
    <prompt><value expr="d.documentElement.textContent"/></prompt></block>
    <field name="q"><prompt>Well? {IN_XML}</prompt><grammar src="g.grxml"/></field>
    <block><goto expr="'{IN_SCRIPT}'"/></block></form>"""
)
GRAMMAR = f"""<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"
root="r"><rule id="r">yes<tag>out='{IN_SCRIPT}'; throw '{IN_SCRIPT}'</tag></rule></grammar>"""
WRONG = f"""<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="wrong"><form id="f">
<block><turn angle="{IN_XML}"/><nix a="{IN_XML}"/><goto next="#{IN_XML}"/><speak {IN_XML[-1]}="">
{IN_XML}</speak><log expr="{IN_XML}"/></block></form></prima>"""
SCENARIO = f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" title="{IN_XML}"
world="w.xml" robot="r.xml" until="60s"><robot at="middle"/><person x="1" y="0"/>
<application src="{{}}"/><application src="{{}}"/><when at="5s"><say>{IN_XML}</say></when>
<when at="6s"><note>{IN_XML}</note></when><answer to="Which">b {IN_XML}</answer><answer to="Well">yes</answer>
<service name="shop"><reply after="1s"><data name="x" value="{IN_XML}"/></reply></service>
<service name="w"><reply after="1s"><data name="x" value="{IN_XML}"/></reply></service>
<expect says="never {IN_XML}"/></scenario>"""
FOREIGN = [
    {"time": 0.0, "phase": "run", "actor": "mediator",
     "data": {"version": RAW, "scenario": RAW, "policy": RAW, "applications": [RAW], "files": {RAW: RAW}}},
    {"time": 0.0, "phase": "load", "actor": "environment", "app": RAW, "data": {"place": RAW}},
    {"time": 0.1, "phase": "event", "actor": "user", "event": RAW, "serial": 1, "data": {RAW: RAW}},
    {"time": 0.2, "phase": "request", "actor": "robot", "app": RAW, "behavior": f"{RAW}#1", "command": RAW,
     "text": RAW, "tree": RAW, "devices": [RAW], "args": {RAW: RAW}, "source": RAW, "priority": "high"},
    {"time": 0.2, "phase": "start", "actor": "robot", "app": RAW, "behavior": f"{RAW}#1", "command": RAW,
     "text": RAW, "tree": RAW, "devices": [RAW], "args": {RAW: RAW}, "source": RAW},
    {"time": 0.3, "phase": "decision", "actor": "mediator", "winner": RAW, "rule": RAW, "losers": [RAW],
     "losers_count": 2, "message": RAW},
    {"time": 0.3, "phase": "suspend", "actor": "mediator", "app": RAW, "tree": RAW, "by": RAW, "rule": RAW},
    {"time": 0.4, "phase": "floor", "actor": "mediator", "floor": [RAW]},
    {"time": 0.5, "phase": "fail", "actor": "robot", "behavior": f"{RAW}#1", "app": RAW, "device": RAW,
     "message": RAW},
    {"time": 0.5, "phase": "send", "actor": "robot", "app": RAW, "serial": 3, "data": {"to": RAW}},
    {"time": 0.5, "phase": "log", "actor": "robot", "app": RAW, "message": RAW, "source": RAW},
    {"time": 0.6, "phase": "error", "actor": "robot", "app": RAW, "message": RAW, "source": RAW},
    {"time": 0.7, "phase": "unload", "actor": "mediator", "app": RAW, "outcome": RAW},
    {"time": 0.8, "phase": "over", "actor": "mediator", "outcome": RAW},
]  # fmt: skip
STRANGE = f"n{RAW}.xml".replace("/", "")


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder full of what strangers write."""
    folder = tmp_path_factory.mktemp("strangers")
    world = (ROOT / "documents/worlds/room.xml").read_text()
    (folder / "w.xml").write_text(
        world.replace("An empty room", IN_XML).replace("The door", IN_XML)
    )
    (folder / "r.xml").write_bytes((ROOT / "documents/robots/papero.xml").read_bytes())
    for name, text in {
        "app.xml": APP, STRANGE: APP.replace('"desk"', '"other"'), "v.vxml": VOICE, "g.grxml": GRAMMAR,
        "wrong.xml": WRONG, "s.xml": SCENARIO.format("app.xml", "v.vxml"),
        "bad.grxml": GRAMMAR.replace("yes", f'<ruleref uri="#{IN_XML}"/>'),
        "bad.vxml": vxml(f'<form><block><goto next="#{IN_XML}"/><x{IN_XML[-1]}/></block></form>'),
        "nix.xml": SCENARIO.format(f"nix{IN_XML}", "nix"),
    }.items():  # fmt: skip
        (folder / name).write_text(text, encoding="utf-8")
    strange = [
        row | {"answer": f"{RAW}{row['answer']}", "failures": RAW, "order": RAW} for row in runs()
    ]
    write(folder, strange, "swept.csv")
    (folder / "bad.csv").write_text(f"run,{RAW}\r\n", encoding="utf-8")
    with (folder / "f.jsonl").open("w", encoding="utf-8") as stream:
        stream.writelines(json.dumps(one, ensure_ascii=False) + "\n" for one in FOREIGN)
    api.rehearse(folder / "s.xml", sink=(folder / "t.jsonl").open("a", encoding="utf-8").write)
    return folder


DRAWN = [
    f"graph {what} --to {form}"
    for what in ("app.xml", "v.vxml", "w.xml", "f.jsonl --what tree", "f.jsonl --what streams")
    for form in ("svg", "dot", "mermaid")
]
EXPORTED = [
    f"export {name}.jsonl --to {form} -o made.{form}"
    for name, form in zip(
        "tffffft", ("eaf", "eaf", "textgrid", "vtt", "csv", "mcap", "vtt"), strict=True
    )
]
VERBS = [
    *("validate app.xml wrong.xml v.vxml g.grxml bad.grxml bad.vxml nix.xml s.xml", "validate {strange}"),
    *("validate wrong.xml --format json", "validate wrong.xml {strange} --format sarif"),
    *("validate --with app.xml v.vxml", "validate --with {strange} app.xml --format json"),
    *("run s.xml --why", "run s.xml --format json", "run s.xml -o -", "run {raw}", "run nix.xml"),
    *("run --ea {strange} --say {raw}", "run s.xml --policy {raw}", "run s.xml --policy fixed:{raw}"),
    *("run s.xml --policy prima --policy fifo -o runs/", "run s.xml --limit {raw}=1", "run s.xml --map {raw}"),
    *("run s.xml --allow-host {raw}", "run s.xml -o {raw}/x", "{raw}"),
    *("test s.xml --coverage", "test s.xml --format json", "test nix.xml --junit made.xml"),
    *("test s.xml --junit made.xml --coverage-xml made.cover", "test s.xml --update --yes", "test s.xml"),
    *("show t.jsonl --why", "show f.jsonl --why", "show t.jsonl --format json", "show f.jsonl --format json"),
    *("show {raw}", "show wrong.xml", "diff t.jsonl f.jsonl", "diff f.jsonl t.jsonl", "diff f.jsonl f.jsonl"),
    *("diff t.jsonl f.jsonl --format json", "diff t.jsonl f.jsonl --format html -o made.html"),
    *("diff s.xml --policy prima --policy fifo", "report t.jsonl -o made.html", "report f.jsonl -o made.html"),
    *("report t.jsonl f.jsonl -o made.html", "report s.xml -o made.html"),
    *("report swept.csv -o made.html", "report swept.csv --to svg --figure orders -o made.svg", "report {raw}.csv", "report bad.csv"),
    *("report swept.csv --by {raw} -o made.html", "report swept.csv --to svg --figure {raw}", "report ."),
    *("replay t.jsonl s.xml", "replay f.jsonl s.xml", "replay t.jsonl s.xml -o -"),
    *("explain t.jsonl 3", "explain f.jsonl 1", "explain f.jsonl 3 --format json", "explain {raw}"),
    *("talk s.xml", "talk s.xml --format json", "new ea {raw}", "new scenario x{raw}", "new {raw} x"),
    *("study s.xml", "study s.xml --format csv", "documents {raw}/x", "graph app.xml --to json"),
    *("live s.xml --speed 1000", "live {raw}", "live --resume {raw}", "live --ea {strange} --robot {raw}"),
    *("sweep s.xml --vary {raw}=1", "sweep s.xml --policy prima", "sweep {raw}", "sweep s.xml -o {raw}/x.csv"),
    *("explore s.xml --move {raw}", "explore s.xml --runs 5 -j 1", "explore {raw}", "explore s.xml --on {raw}"),
    *("schemas {raw}/x", "demo -o {raw}/x", "lsp {raw}"),
    *DRAWN,
    *EXPORTED,
]  # fmt: skip


def test_every_verb_is_tried() -> None:
    assert {one.split()[0] for one in VERBS} - {"{raw}"} == set(COMMANDS)


END = "\0that is all\0"


def shown(folder: Path, words: list[str]) -> str:
    """What a command writes to a terminal."""
    ours, theirs = pty.openpty()
    typed = f"Hello {RAW}\n/wait 2s\n/nix {RAW}\n/why 3\n/quit\n"
    env = {**os.environ, "COLUMNS": "120"}
    with (
        ThreadPoolExecutor(1) as pool,
        open(ours, "rb", 0) as read,
        open(theirs, "w", encoding="utf-8") as terminal,
    ):
        text = pool.submit(until_the_end, read)
        try:
            prima(*words, cwd=folder, input=typed, env=env, terminal=terminal)
        finally:  # an engine's process may keep the terminal open for longer
            print(end=END, file=terminal, flush=True)
        return text.result()


def until_the_end(terminal: FileIO) -> str:
    data = b""
    while not data.endswith(END.encode()):
        data += terminal.read(65_536) or b""
    return data.decode().removesuffix(END)


@pytest.mark.parametrize("words", VERBS)
def test_what_strangers_write_does_nothing(words: str, place: Path) -> None:
    given = [one.format(strange=STRANGE, raw=RAW) for one in words.split()]
    before = set(place.rglob("made.*"))
    text = shown(place, given)
    assert "Traceback" not in text and "defect" not in text
    assert text or "-o" in given or given[0] == "lsp"
    left = OWN.sub("", text).replace("\n", "").replace("\t", "")
    assert HARMFUL.findall(left) == [], left
    for path in set(place.rglob("made.*")) - before:
        held = [one.data.decode() for one in messages(path)] or [path.read_bytes().decode()]
        path.unlink()
        assert HARMFUL.findall(re.sub(r"\r?\n|\t", "", "".join(held))) == []


def messages(path: Path) -> list[Message]:
    """What a file for Foxglove holds, in chunks that are compressed; nothing of other files."""
    if path.suffix != ".mcap":
        return []
    with path.open("rb") as stream:
        return [message for _, _, message in make_reader(stream).iter_messages()]


def test_what_transcripts_hold_stays_what_it_was(place: Path) -> None:
    text = (place / "t.jsonl").read_text(encoding="utf-8")
    assert HARMFUL.findall(text.replace("\n", "")) == []
    records = api.read(place / "t.jsonl").records
    assert any("\u202e" in str(one.get("text")) for one in records)
    record = {"time": 0, "phase": "log", "actor": "robot", "message": f"{RAW}\U000e0041\x7f"}
    assert json.loads(line(record)) == finished(record)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("plain", "plain"),
        ("a\u202eb\x1b[1m\u2066", "a\ufffdb\ufffd[1m\ufffd"),
        ("a\tb\r\nc\u2028d", "a b  c d"),
        ("日本\u3000語 bon\u00a0! می\u200cروم 👨\u200d👩 so\u00adft", "日本\u3000語 bon\u00a0! می\u200cروم 👨\u200d👩 so\u00adft"),
        ("\ud800\ufeff\uffff", "\ufffd\ufffd\ufffd"),
    ],
)  # fmt: skip
def test_text_that_says_something_and_does_nothing(text: str, told: str) -> None:
    assert visible(text) == told
    assert visible(visible(text)) == told
    assert visible("a\nb", "\n") == "a\nb"


def test_json_means_the_same() -> None:
    text = '{"a":"\u202e\x7f\U000e0041\u9999"}\n'
    assert escaped(text) == '{"a":"\\u202e\\u007f\\udb40\\udc41\u9999"}\n'
    assert json.loads(escaped(text)) == json.loads(text)


def test_no_text_in_the_data_of_a_page_turns_others() -> None:
    """Wherever in it: the reasons that a record gives as well."""
    from prima.report.parts import json_text

    data = {"runs": [["a", {"by\u2066": "x\u202ey\x1b"}, 1.5, None, True]]}
    assert json_text(data) == '{"runs":[["a",{"by\ufffd":"x\ufffdy\ufffd"},1.5,null,true]]}'


def test_no_name_or_message_begins_a_line_of_its_own(tmp_path: Path) -> None:
    """A program that reads a line for each problem finds no problem that PRIMA has not told."""
    fake = "evil.xml:1:1: error: fake"
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="x"><form id="a"><block>'
    end = "</block></form></prima>"
    wrong, thrown = tmp_path / "wrong.xml", tmp_path / f"a\n{fake}.xml"
    wrong.write_text(f'{head}<goto next="#b&#10;{fake}"/>{end}', encoding="utf-8")
    thrown.write_text(f'{head}<throw event="x" message="b&#10;{fake}"/>{end}', encoding="utf-8")
    told = [
        prima("validate", wrong, "--format", "short"),
        prima("validate", wrong, thrown, tmp_path / f"gone\n{fake}.xml"),
        prima("run", "--ea", wrong),
        prima("show", thrown),
        prima("run", thrown, thrown, "-o", tmp_path / "runs"),
    ]
    thrown.rename(tmp_path / "thrown.xml")
    told.append(prima("run", "--ea", tmp_path / "thrown.xml"))
    for done in told:
        assert fake in done.stdout + done.stderr
        assert not [one for one in (done.stdout + done.stderr).splitlines() if one.startswith(fake)]
