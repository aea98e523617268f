"""Bundles: a table with all that it was made from, which gives the same table again."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from urllib.parse import unquote

import pytest

from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.sweeps import VISIT, write_visit

SWEEP = ["sweep", "visit.xml", "--vary", "touch=empirical(delays.csv)", "--seeds", "3"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "one"
    made.mkdir()
    write_visit(made, VISIT.replace(f"{ROOT}/documents/", ""))
    for name in ("worlds/room.xml", "robots/papero.xml"):
        (made / name).parent.mkdir()
        shutil.copy(ROOT / "documents" / name, made / name)
    (made / "delays.csv").write_text("1\n2\n3.5\n")
    monkeypatch.chdir(made)
    return made


def unpacked(bundle: Path, into: Path) -> dict[str, bytes]:
    into.mkdir()
    with zipfile.ZipFile(bundle) as archive:
        archive.extractall(into)
        return {name: archive.read(name) for name in archive.namelist()}


def test_a_bundle_gives_the_same_table_byte_for_byte(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    policies = ["--policy", "prima", "--policy", "fifo"]
    done = prima(*SWEEP, *policies, "-o", "out/table.csv", "--bundle", "table.zip")
    assert done.returncode == 0, done.stderr
    files = unpacked(folder / "table.zip", tmp_path / "two")
    monkeypatch.chdir(tmp_path / "two")
    again = prima("sweep", "study.toml", "-o", "again/table.csv")
    assert again.returncode == 0, again.stderr
    assert Path("again/table.csv").read_bytes() == files["out/table.csv"]
    for name, data in files.items():
        if name.startswith("out/table/"):
            assert Path("again", name.removeprefix("out/")).read_bytes() == data, name
    orders = [name for name in files if name.startswith("out/table/orders/")]
    assert any(name.endswith(".jsonl") for name in orders)


@pytest.mark.parametrize("table", ["table.csv", "out/table.csv", "./out/deep/table.csv"])
def test_an_order_of_a_bundle_runs_as_it_did(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str
) -> None:
    done = prima(*SWEEP, "-o", table, "--bundle", "table.zip")
    assert done.returncode == 0, done.stderr
    files = unpacked(folder / "table.zip", tmp_path / "two")
    monkeypatch.chdir(tmp_path / "two")
    [order, *_] = [one for one in files if "/orders/" in one and one.endswith(".xml")]
    again = prima("run", order, "-o", "again.jsonl")
    assert again.returncode == 0, again.stderr
    assert Path("again.jsonl").read_bytes() == files[order.removesuffix("xml") + "jsonl"]


def test_a_table_elsewhere_is_at_the_top_of_its_bundle(folder: Path, tmp_path: Path) -> None:
    done = prima(*SWEEP, "-o", str(tmp_path / "table.csv"), "--bundle", "table.zip")
    assert done.returncode == 0, done.stderr
    assert {"table.csv", "table/dictionary.json"} <= unpacked(
        Path("table.zip"), tmp_path / "two"
    ).keys()


def test_equal_sweeps_give_equal_bundles(folder: Path) -> None:
    for name in ("a.zip", "b.zip"):
        prima(*SWEEP, "-o", "table.csv", "--bundle", name)
    assert Path("a.zip").read_bytes() == Path("b.zip").read_bytes()


def test_its_metadata_name_every_file_as_ro_crate_does(folder: Path) -> None:
    prima(*SWEEP, "-o", "table.csv", "--bundle", "table.zip")
    with zipfile.ZipFile("table.zip") as archive:
        names = set(archive.namelist())
        crate = json.loads(archive.read("ro-crate-metadata.json"))
    assert crate["@context"] == "https://w3id.org/ro/crate/1.1/context"
    graph = {one["@id"]: one for one in crate["@graph"]}
    assert graph["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    parts = {one["@id"] for one in graph["./"]["hasPart"]}
    assert parts | {"ro-crate-metadata.json"} == names <= set(graph)
    made_of = {one["@id"] for one in graph["#sweep"]["object"]}
    assert {"visit.xml", "delays.csv", "study.toml"} <= made_of
    assert graph["#sweep"]["result"] == [{"@id": "table.csv"}]


def test_its_metadata_name_files_by_uris(folder: Path) -> None:
    Path("delays.csv").rename("dé lays 100%.csv")
    words = ["sweep", "visit.xml", "--vary", "touch=empirical(dé lays 100%.csv)", "--seeds", "2"]
    done = prima(*words, "-o", "out 1/table.csv", "--bundle", "table.zip")
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile("table.zip") as archive:
        names = set(archive.namelist())
        crate = json.loads(archive.read("ro-crate-metadata.json"))
    graph = {one["@id"]: one for one in crate["@graph"]}
    assert graph["d%C3%A9%20lays%20100%25.csv"]["@type"] == "File"
    assert graph["./"]["mainEntity"] == {"@id": "out%201/table.csv"}
    parts = {unquote(one["@id"]) for one in graph["./"]["hasPart"]}
    assert parts | {"ro-crate-metadata.json"} == names
    made_of = {unquote(one["@id"]) for one in graph["#sweep"]["object"]}
    assert not any(name.startswith("out 1/") for name in made_of) and "visit.xml" in made_of


@pytest.mark.parametrize(
    ("words", "code", "why"),
    [
        (["--bundle", "t.zip"], 2, "--bundle needs the table"),
        (["-o", "t.csv", "--bundle", "nowhere/t.zip"], 2, "there is no folder nowhere"),
        (["-o", "t.csv", "--bundle", "t.csv"], 2, "the table is written there"),
        (["-o", "t.csv", "--bundle", "worlds"], 2, "it is a folder"),
        (["-o", "t.csv", "--bundle", "visit.xml"], 2, "visit.xml"),
    ],
)
def test_bundles_that_cannot_be_written(
    folder: Path, words: list[str], code: int, why: str
) -> None:
    before = Path("visit.xml").read_bytes()
    done = prima(*SWEEP, *words)
    assert done.returncode == code
    assert why in done.stderr
    assert not Path("t.csv").exists(), "no run is made in vain"
    assert Path("visit.xml").read_bytes() == before


def test_files_above_the_folder_cannot_be_bundled(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "inner").mkdir()
    monkeypatch.chdir(folder / "inner")
    done = prima("sweep", "../visit.xml", "-o", "t.csv", "--bundle", "t.zip")
    assert done.returncode == 2
    assert "Call prima from a folder that holds all of them." in done.stderr
    assert not Path("t.csv").exists()


VOICE = """<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1"><form><block>Hello.</block></form></vxml>"""


def test_a_link_brings_no_strange_file_into_a_bundle(folder: Path, tmp_path: Path) -> None:
    """An archive is published, and whoever wrote the application may have left links in it."""
    (tmp_path / "secret").write_text("never published")
    (folder / "app").mkdir()
    (folder / "app" / "hello.vxml").write_text(VOICE)
    (folder / "app" / "beside.txt").write_text("published")
    (folder / "app" / "words.txt").symlink_to(tmp_path / "secret")
    (folder / "app" / "more").symlink_to(tmp_path, target_is_directory=True)
    text = (folder / "visit.xml").read_text()
    application = '<application src="app/hello.vxml"/>'
    (folder / "visit.xml").write_text(text.replace("<person", f"{application}<person", 1))
    (folder / "out" / "table").mkdir(parents=True)
    (folder / "out" / "table" / "old.txt").symlink_to(tmp_path / "secret")
    done = prima(*SWEEP, "-o", "out/table.csv", "--bundle", "table.zip")
    assert done.returncode == 0, done.stderr
    files = unpacked(folder / "table.zip", tmp_path / "two")
    assert files["app/beside.txt"] == b"published" and "app/hello.vxml" in files
    assert not [name for name, data in files.items() if b"never" in data or "secret" in name]


def test_a_name_that_leads_elsewhere_on_other_systems_is_told(folder: Path) -> None:
    (folder / "up\\b.csv").write_text("1\n")
    words = [one.replace("delays.csv", "up\\b.csv") for one in SWEEP]
    done = prima(*words, "-o", "table.csv", "--bundle", "table.zip")
    assert done.returncode == 2 and "rename the file" in done.stderr
