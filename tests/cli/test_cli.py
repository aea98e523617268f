"""The command line as a user meets it: output, exit codes, and files."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from prima.cli import COMMANDS, cli
from tests import ROOT
from tests.helpers import command
from tests.helpers.here import prima

DEMO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"


def test_what_the_readme_promises(tmp_path: Path) -> None:
    documents = sorted((ROOT / "documents").glob("*a/*.xml"))
    checked = prima("validate", *documents)
    assert checked.returncode == 0
    assert checked.stdout == ""
    notes = prima("validate", "--notes", "--format", "short", *documents).stdout.splitlines()
    assert notes and all(": note: " in line for line in notes)
    mediated, fifo = tmp_path / "mediated.jsonl", tmp_path / "fifo.jsonl"
    assert prima("run", DEMO, "-o", mediated).returncode == 0
    assert prima("run", DEMO, "--policy", "fifo", "-o", fifo).returncode == 0
    differs = prima("diff", mediated, fifo)
    assert differs.returncode == 1
    assert differs.stdout.splitlines()[-1].startswith("rows: ")
    assert "\x1b" not in differs.stdout
    same = prima("diff", mediated, mediated)
    assert same.returncode == 0
    assert same.stdout.splitlines()[-1].startswith("rows: all the same")
    assert prima("replay", mediated, DEMO).returncode == 0
    assert prima("show", mediated).stdout == prima("run", DEMO).stdout


def test_json_where_a_machine_may_read(tmp_path: Path) -> None:
    bad = tmp_path / "bad.xml"
    bad.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">\n  <from/></prima>'
    )
    result = command.prima("validate", bad, "--format", "json")
    assert result.returncode == 1
    first = json.loads(result.stdout)[0]
    assert (first["line"], first["column"]) in {(1, 1), (2, 3)}
    lines = command.prima("run", DEMO, "--format", "json").stdout.splitlines()
    assert json.loads(lines[0])["phase"] == "run"
    assert json.loads(lines[-1])["phase"] == "over"
    a = tmp_path / "a.jsonl"
    a.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert json.loads(command.prima("diff", a, a, "--format", "json").stdout)["differs"] is False


def test_explain_a_code_and_a_row(tmp_path: Path) -> None:
    assert "declares" in prima("explain", "undeclared-variable").stdout
    wrong = prima("explain", "undeclared-varable")
    assert wrong.returncode == 2
    assert 'Did you mean "undeclared-variable"?' in wrong.stderr
    out = tmp_path / "t.jsonl"
    prima("run", DEMO, "-o", out)
    table = prima("show", out).stdout
    row = next(line.split()[1] for line in table.splitlines() if "resumes Active" in line)
    why = prima("explain", out, row).stdout
    assert "rule F2" in why
    assert "follow.xml:" in why


@pytest.mark.parametrize(
    ("args", "hint"),
    [
        (("vaildate", "x"), "validate"),
        (("run", "--polcy", "x"), "--policy"),
        (("run", str(DEMO), "--policy", "fifa"), "fifo"),
    ],
)
def test_a_misspelt_word_gets_a_suggestion(args: tuple[str, ...], hint: str) -> None:
    result = command.prima(*args)
    assert result.returncode == 2
    assert hint in result.stderr


def test_every_command_has_help_with_an_example() -> None:
    top = prima("--help")
    assert top.returncode == 0
    for name in ("validate", "run", "show", "diff", "replay", "explain"):
        assert name in top.stdout
        assert f"prima {name} " in prima(name, "--help").stdout


UNIT = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="f">
<iu><block><speak>One.</speak></block></iu>
<block><iu><speak>Two.</speak></iu><exit/></block></form></prima>"""


def test_explain_the_unit_around_a_row_and_what_comes_from_outside(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(UNIT)
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<person x="1" y="0"/><application src="a.xml" kind="fa"/>'
        '<when at="0.1s"><say>Hello.</say></when></scenario>'
    )
    prima("run", "s.xml", "-o", "t.jsonl", cwd=tmp_path)
    table = prima("show", "t.jsonl", cwd=tmp_path).stdout
    lines = table.splitlines()[1:]
    number = {
        word: next(str(row) for row, line in enumerate(lines) if word in line)
        for word in ("One.", "Two.", "Hello.")
    }
    for word, rule in (("One.", "U5"), ("Two.", "U4")):
        why = prima("explain", "t.jsonl", number[word], cwd=tmp_path).stdout
        assert "the unit a#" in why and "selected by rule S1" in why
        assert f"(rule {rule})" in why
    heard = prima("explain", "t.jsonl", number["Hello."], cwd=tmp_path).stdout
    assert 's: "Hello."' in heard and "from outside" in heard


def test_a_transcript_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    out = tmp_path / "t.jsonl"
    prima("run", DEMO, "-o", out)
    marked = tmp_path / "marked.jsonl"
    marked.write_bytes(b"\xef\xbb\xbf" + out.read_bytes())
    assert prima("show", marked).stdout == prima("show", out).stdout


def test_ctrl_c_while_python_is_still_importing_ends_quietly() -> None:
    code = (
        "import os, signal, sys\n"
        "from prima.__main__ import main\n"
        "name = sys.argv.pop(1)\n"
        "class Interrupting:\n"
        "    def find_spec(self, wanted, path=None, target=None):\n"
        "        if wanted == name: os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Interrupting())\n"
        "main()\n"
    )
    for module in ("click", "pyexpat"):
        done = subprocess.run(
            [sys.executable, "-c", code, module, "validate", str(DEMO)],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n"), module


def test_ctrl_c_in_a_place_that_lets_no_exception_out_ends_the_run_as_well() -> None:
    """Such as a callback of physics, or the end of an object's life."""
    code = (
        "import sys\n"
        "from prima.__main__ import main\n"
        "from prima.sim import world\n"
        "class Freed:\n"
        "    def __del__(self): raise KeyboardInterrupt\n"
        "step = world.World.advance\n"
        "def advance(self, to):\n"
        "    if to > 5000 and lost: lost.pop()\n"
        "    step(self, to)\n"
        "lost = [Freed()]\n"
        "world.World.advance = advance\n"
        "main()\n"
    )
    busy = ["test", "documents/scenarios", "-j", "1"]
    done = subprocess.run(
        [sys.executable, "-c", code, *busy],
        capture_output=True, text=True, timeout=60, check=False, cwd=ROOT,
    )  # fmt: skip
    assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n")


def test_ctrl_c_leaves_what_was_written_readable(tmp_path: Path) -> None:
    app = tmp_path / "busy.xml"
    app.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="busy"><form id="a">'
        '<block><speak>Still here.</speak><goto next="#a"/></block></form></prima>'
    )
    scenario = tmp_path / "long.xml"
    scenario.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="long" until="86400s"'
        f' world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<application src="busy.xml"/></scenario>'
    )
    out = tmp_path / "out.jsonl"
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "run", str(scenario), "-o", str(out)],
        stderr=subprocess.PIPE,
        text=True,
    )
    for _ in range(200):
        time.sleep(0.05)
        if out.exists() and out.stat().st_size > 10_000:
            break
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    shown = prima("show", out)
    assert shown.returncode == 0, shown.stderr
    assert "Still here." in shown.stdout


def test_the_same_bytes_under_every_hash_seed(tmp_path: Path) -> None:
    made = []
    for seed in ("0", "1", "4242"):
        out = tmp_path / f"{seed}.jsonl"
        subprocess.run(
            [sys.executable, "-m", "prima", "run", str(DEMO), "-o", str(out)],
            check=True,
            capture_output=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        made.append(out.read_bytes())
    assert made[0] == made[1] == made[2]


def test_a_wheel_holds_schemas_and_documents_and_works_from_any_folder(tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--outdir", str(tmp_path), str(ROOT)],
        check=True,
        capture_output=True,
    )
    wheel = next(tmp_path.glob("*.whl"))
    target = tmp_path / "site"
    subprocess.run([sys.executable, "-m", "zipfile", "-e", str(wheel), str(target)], check=True)
    code = (
        f"import sys; sys.path.insert(0, {str(target)!r})\n"
        "import prima, pathlib\n"
        f"assert pathlib.Path(prima.__file__).is_relative_to({str(target)!r})\n"
        "path = prima.documents_folder() / 'scenarios' / 'follow-during-navigation.xml'\n"
        f"assert path.is_relative_to({str(target)!r})\n"
        "assert prima.validate([path]) == []\n"
        "assert len(prima.rehearse(path).rows()) > 20\n"
        "from prima.report import make\n"
        "assert '<script>' in make([prima.rehearse(path)])\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=tmp_path)


def test_the_documents_are_copied_to_a_new_folder_and_run_there(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    assert prima("documents", folder).returncode == 0
    ran = prima("run", folder / "scenarios" / "touched-on-the-way.xml")
    assert ran.returncode == 0
    again = prima("documents", folder)
    assert (again.returncode, "already exists" in again.stderr) == (2, True)


def test_the_price_of_a_held_stream_is_told(tmp_path: Path) -> None:
    checked = prima("validate", "--notes", ROOT / "documents" / "fa" / "video-timer.xml")
    assert checked.returncode == 0
    assert "waits up to 30 s" in checked.stdout


def test_a_hint_that_can_have_no_effect_is_told(tmp_path: Path) -> None:
    document = tmp_path / "a.xml"
    document.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">'
        '<form id="f" hold-for="3s"><block><goto next="#g"/></block></form>'
        '<form id="g" stream="hold"><block><speak>Hm.</speak><exit/></block></form></prima>'
    )
    checked = prima("validate", document)
    assert checked.returncode == 0
    assert checked.stdout.count("[idle-hint]") == 2


@pytest.mark.parametrize(
    ("handler", "told"),
    [
        ('event="touch"', 0),
        ('event="touch" reactive="false"', 1),
        ('event="end.speak"', 1),
        ('event="end.speak" reactive="true"', 0),
        ('event="end touch"', 0),
    ],
)
def test_a_time_for_what_is_no_reaction_is_told(tmp_path: Path, handler: str, told: int) -> None:
    document = tmp_path / "a.xml"
    document.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a"><form id="f">'
        f'<on {handler} fresh-for="2s"><speak>Hm.</speak><exit/></on></form></prima>'
    )
    checked = prima("validate", document)
    assert checked.stdout.count("[idle-hint]") == told


def test_applications_run_without_a_scenario(tmp_path: Path) -> None:
    library = ROOT / "documents" / "ea" / "library.xml"
    ran = prima("run", "--ea", library, "--say", "The C Primer")
    assert ran.returncode == 0
    assert '"The C Primer"' in ran.stdout and '"Wait a minute."' in ran.stdout
    both = prima("run", "--fa", ROOT / "documents" / "fa" / "emotions.xml", "--ea", library)
    assert both.returncode == 0 and "starts emotions" in both.stdout


def test_a_voicexml_document_is_checked_and_run_as_it_is(tmp_path: Path) -> None:
    pizza = ROOT / "documents" / "ea" / "pizza.vxml"
    assert prima("validate", pizza).returncode == 0
    ran = prima("run", "--ea", pizza, "--say", "a small pizza with cheese", "--say", "yes")
    assert ran.returncode == 0
    assert '"A small pizza with cheese.' in ran.stdout
    wrong = tmp_path / "wrong.vxml"
    wrong.write_text(pizza.read_text(encoding="utf-8").replace("<prompt>Which", "<promt>Which"))
    assert prima("validate", wrong).returncode == 1


def test_the_demo_shows_its_table_and_writes_a_report(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "prima", "demo"], cwd=tmp_path, capture_output=True, encoding="utf-8"
    )
    assert done.returncode == 0, done.stderr
    assert '"I\'ve just reached the goal."' in done.stdout
    assert "prima-demo.html: " in done.stderr
    assert (tmp_path / "prima-demo.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    document = tmp_path / "a.xml"
    document.write_text(DEMO.read_text(encoding="utf-8"), encoding="utf-8")
    refused = prima("demo", "-o", document)
    assert refused.returncode == 2 and "write elsewhere" in refused.stderr


@pytest.mark.parametrize(
    ("terminal", "variables", "platform", "opened"),
    [
        (True, {"DISPLAY": ":0"}, "linux", True),
        (True, {"WAYLAND_DISPLAY": "wayland-0"}, "linux", True),
        (True, {}, "linux", False),
        (False, {"DISPLAY": ":0"}, "linux", False),
        (True, {}, "darwin", True),
        (True, {"SSH_CONNECTION": "1"}, "darwin", False),
    ],
)
def test_the_demo_opens_a_browser_only_where_somebody_sees_it(
    terminal: bool,
    variables: dict[str, str],
    platform: str,
    opened: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SSH_CONNECTION"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setattr("prima.cli.demo.is_terminal", lambda: terminal)

    def show(url: str) -> bool:
        asked.append(url)
        return True

    monkeypatch.setattr("webbrowser.open", show)
    page = tmp_path / "a page.html"
    done = CliRunner().invoke(cli, ["demo", "-o", str(page)])
    assert done.exit_code == 0, done.output
    assert asked == ([page.as_uri()] if opened else [])
    asked.clear()
    CliRunner().invoke(cli, ["demo", "--no-open", "-o", str(page)])
    assert not asked


def test_make_demo_tells_how_to_call_prima() -> None:
    lines = (ROOT / "Makefile").read_text(encoding="utf-8").partition("\ndemo:")[2].split("\n\n")[0]
    assert "prima demo" in lines and "$(BIN)/prima --help" in lines and "activate" in lines


@pytest.mark.parametrize(
    "words", [(), ("a.xml", "--ea", "b.xml"), ("a.xml", "--say", "x"), ("--ea", "nowhere.xml")]
)
def test_what_cannot_be_run_is_told(words: tuple[str, ...]) -> None:
    ran = prima("run", *words)
    assert ran.returncode in (1, 2)
    assert ran.stderr and "Traceback" not in ran.stderr


def test_diff_runs_scenarios_itself(tmp_path: Path) -> None:
    alike = prima("diff", DEMO, DEMO)
    assert alike.returncode == 0 and "rows: all the same" in alike.stdout
    differs = prima("diff", DEMO, "--policy", "fifo", "--policy", "prima", "--format", "json")
    assert differs.returncode == 1
    written = [tmp_path / f"{policy}.jsonl" for policy in ("fifo", "prima")]
    for path in written:
        prima("run", DEMO, "--policy", path.stem, "-o", path)
    assert prima("diff", *written, "--format", "json").stdout == differs.stdout
    mixed = prima("diff", written[1], DEMO)
    assert mixed.returncode == 0 and "rows: all the same" in mixed.stdout


@pytest.mark.parametrize(
    "given",
    [[DEMO], [DEMO, "--policy", "fifo"], [DEMO, DEMO, "--policy", "fifo", "--policy", "prima"],
     [DEMO, "--policy", "fif", "--policy", "prima"], ["none.jsonl", DEMO]],
)  # fmt: skip
def test_diff_needs_two_runs(given: list[str]) -> None:
    done = prima("diff", *given)
    assert done.returncode == 2 and done.stderr.startswith("prima: ")


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_has_a_help_with_an_example(name: str) -> None:
    done = prima(name, "--help")
    assert done.returncode == 0 and f"\n  prima {name} " in done.stdout, done.stdout


def test_every_module_of_a_command_is_listed() -> None:
    modules = {path.stem for path in (ROOT / "prima" / "cli").glob("*.py")}
    shared = {
        "__init__",
        "batch",
        "failures",
        "interrupts",
        "options",
        "outputs",
        "printing",
        "progress",
        "runs",
        "screen",
        "terminal",
    }
    assert modules - shared == set(COMMANDS)


def test_prima_alone_shows_its_help_once() -> None:
    done = prima()
    assert done.returncode == 2 and done.stderr.count("Usage:") == 1


def test_a_code_has_no_rows() -> None:
    done = prima("explain", "unknown-element", "3")
    assert done.returncode == 2 and "unknown-element is a code" in done.stderr


@pytest.mark.parametrize("command", ["run", "talk"])
def test_an_application_given_as_of_the_other_kind_is_told(command: str) -> None:
    ea, fa = ROOT / "documents" / "ea" / "library.xml", ROOT / "documents" / "fa" / "follow.xml"
    done = prima(command, "--fa", ea)
    assert f"{ea}:4:57: warning: The document says that it is an EA, but --fa" in done.stderr
    done = prima(command, "--ea", fa)
    told = "but --ea names it: it runs as an EA. Name it with --fa, or write kind"
    assert done.returncode == 0 and told in done.stderr


def test_a_voicexml_document_may_be_of_either_kind() -> None:
    pizza = ROOT / "documents" / "ea" / "pizza.vxml"
    for option in ("--fa", "--ea"):
        assert prima("run", option, pizza, "--say", "yes").returncode == 0


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("prima run --policy f", ["fifo", "fair", "fixed"]),
        ("prima diff --policy pri", ["prima"]),
        ("prima study --policy fi", ["fifo", "fixed"]),
        ("prima export a.jsonl --to te", ["textgrid"]),
        ("prima explain undec", ["undeclared-variable"]),
    ],
)
def test_the_shell_completes_policies_formats_and_codes(line: str, expected: list[str]) -> None:
    told = {
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(line.split()) - 1),
        "_PRIMA_COMPLETE": "bash_complete",
    }
    script = "from prima.__main__ import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.argv[0] = 'prima'; {script}"],
        env={**os.environ, **told},
        capture_output=True,
        encoding="utf-8",
        timeout=60,
    )
    assert [one.partition(",")[2] for one in done.stdout.split()] == expected, done.stderr


def test_a_file_that_ends_too_soon_is_no_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    def cut(_self: object, _context: object) -> None:
        raise EOFError("marshal data too short")

    monkeypatch.setattr("prima.cli.Commands.invoke", cut)
    with pytest.raises(AssertionError, match="defect of prima: EOFError: marshal data too short"):
        prima("explain", "S1")
    with pytest.raises(EOFError):  # with where it was raised
        prima("explain", "S1", env={**os.environ, "PRIMA_DEBUG": "1"})
