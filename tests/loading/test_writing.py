"""Files are written whole or not at all; leftovers of killed processes are removed."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from prima.errors import UsageError
from prima.loading.writing import clean_up, make_folder, parts_folder, whole, write_whole
from tests import ROOT

HOLDS = """
import sys, time
from prima.loading.writing import parts_folder, whole
opened = {"file": whole, "folder": parts_folder}[sys.argv[1]](sys.argv[2])
with opened as made:
    if sys.argv[1] == "file":
        made.write(b"half")
        made.flush()
    print("ready", flush=True)
    time.sleep(60)
"""


def holding(kind: str, path: Path) -> subprocess.Popen[str]:
    """A process that is in the middle of writing."""
    made = subprocess.Popen(
        [sys.executable, "-c", HOLDS, kind, str(path)], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert made.stdout is not None and made.stdout.readline() == "ready\n"
    return made


def left(folder: Path) -> list[Path]:
    return list(folder.glob(".prima-*"))


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_what_a_killed_process_was_writing_is_removed_at_the_next_start(
    kind: str, tmp_path: Path
) -> None:
    page = tmp_path / "page.html"
    page.write_text("old")
    killed = holding(kind, page if kind == "file" else tmp_path)
    lives = holding(kind, page if kind == "file" else tmp_path)
    killed.kill()
    killed.wait()
    assert (len(left(tmp_path)), page.read_text()) == (2, "old")
    clean_up(str(tmp_path))
    assert len(left(tmp_path)) == 1, "the one that lives goes on"
    lives.kill()
    lives.wait()
    write_whole(page, "new")
    assert (left(tmp_path), page.read_text()) == ([], "new")


def test_what_others_have_called_alike_stays(tmp_path: Path) -> None:
    (tmp_path / ".prima-notes").mkdir()
    (tmp_path / ".prima-link").symlink_to(tmp_path)
    clean_up(str(tmp_path))
    assert len(left(tmp_path)) == 2


def test_what_fails_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_text("old")
    with pytest.raises(KeyError), whole(path) as stream:
        stream.write(b"half")
        raise KeyError
    assert (path.read_text(), left(tmp_path)) == ("old", [])


def test_a_file_keeps_its_rights_and_a_link_leads_where_it_did(tmp_path: Path) -> None:
    path, link = tmp_path / "a", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to("a")
    write_whole(link, "new")
    assert (link.is_symlink(), path.read_text()) == (True, "new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    umask = os.umask(0o027)
    try:
        write_whole(tmp_path / "b", "")
    finally:
        os.umask(umask)
    assert stat.S_IMODE((tmp_path / "b").stat().st_mode) == 0o640


def test_what_is_no_file_is_written_to_as_it_is(tmp_path: Path) -> None:
    write_whole(os.devnull, "x")
    assert not Path(os.devnull).is_file()


@pytest.mark.parametrize("name", ["", "no/such", "a\0b", "/dev/full", "x" * 300])
def test_what_cannot_be_written_is_told(name: str, tmp_path: Path) -> None:
    path = name if name.startswith("/") else f"{tmp_path}/{name}"
    with pytest.raises(UsageError, match="cannot be written: "):
        write_whole(path, "x" * 100_000)
    assert left(tmp_path) == []


def test_folders_for_parts_are_gone_afterwards(tmp_path: Path) -> None:
    with parts_folder(str(tmp_path / "new")) as one, parts_folder(str(tmp_path / "new")) as other:
        assert one != other and Path(one).is_dir()
    assert list((tmp_path / "new").iterdir()) == []


WRITERS = [
    "report {t} -o out.html",
    "graph {app} -o out.svg",
    "export {t} --to eaf -o out.eaf",
    "diff {t} {t} --format html -o out.html",
    "replay {t} {s} -o out.jsonl",
    "test {s} --junit out.xml",
]


@pytest.mark.parametrize("words", WRITERS)
def test_a_kill_leaves_no_half_a_file(words: str, tmp_path: Path) -> None:
    demo = ROOT / "documents"
    names = {
        "t": tmp_path / "t.jsonl",
        "s": demo / "scenarios" / "follow-alone.xml",
        "app": demo / "fa" / "follow.xml",
    }
    prima = [sys.executable, "-m", "prima"]
    subprocess.run([*prima, "run", names["s"], "-o", names["t"]], check=True, capture_output=True)
    given = words.format(**names).split()
    out = tmp_path / next(one for one in given if one.startswith("out"))
    # Stopped in the writing itself: an audit hook sees the file being renamed.
    code = (
        "import sys, os, signal\n"
        "sys.addaudithook(lambda name, args: name == 'os.rename' and '.prima-' in str(args[0])"
        " and os.kill(os.getpid(), signal.SIGKILL))\n"
        f"sys.argv = ['prima', *{given!r}]\n"
        "from prima.__main__ import main\nmain()"
    )
    out.write_text("old")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert (done.returncode, out.read_text()) == (-signal.SIGKILL, "old")
    assert len(left(tmp_path)) == 1
    done = subprocess.run([*prima, *given], cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0 and out.stat().st_size > 10 and left(tmp_path) == []


def test_a_killed_batch_is_cleaned_up_by_the_next(tmp_path: Path) -> None:
    scenarios = str(ROOT / "documents" / "scenarios")
    batch = [sys.executable, "-m", "prima", "run", scenarios, "-o", "runs/", "--workers", "1"]
    killed = subprocess.Popen(
        batch, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    until = time.monotonic() + 30
    while not [*tmp_path.glob("runs/.prima-*/lock")] and time.monotonic() < until:
        time.sleep(0.01)
    killed.kill()
    killed.wait()
    assert len(left(tmp_path / "runs")) == 1
    one = str(ROOT / "documents" / "scenarios" / "follow-alone.xml")
    subprocess.run([*batch[:4], one, *batch[5:]], cwd=tmp_path, check=True, capture_output=True)
    assert left(tmp_path / "runs") == []


def test_a_long_name_of_other_letters_can_be_written(tmp_path: Path) -> None:
    name = "\u3042" * 80 + ".jsonl"  # 246 bytes, of the 255 that a name may have
    write_whole(tmp_path / name, "new")
    assert os.listdir(tmp_path) == [name]


def test_a_folder_is_made_unless_it_is_there_and_never_where_a_file_is(tmp_path: Path) -> None:
    make_folder(tmp_path / "a" / "b")
    make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").touch()
    with pytest.raises(
        UsageError, match=r"file: a file is where a folder is needed\. Name another\.$"
    ):
        make_folder(tmp_path / "file")
    with pytest.raises(UsageError, match="cannot be written: Not a directory"):
        make_folder(tmp_path / "file" / "c")
    with pytest.raises(UsageError, match="cannot be written: it is not a file name"):
        make_folder("a\0b")


@pytest.mark.parametrize("name", ["", "a\0b", "a\ud800b"])
def test_what_cannot_name_a_file_is_refused(name: str) -> None:
    with pytest.raises(UsageError, match="cannot be written: it is not a file name"):
        write_whole(name, b"")
