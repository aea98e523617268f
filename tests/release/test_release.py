"""Releases: locked versions, a bill of materials, licences, and the promises of SECURITY.md."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.metadata import requires, version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from release import licences, sbom
from release.locked import locked
from tests import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LOCKED = ("dev", "export", "editor", "bench", "reachy")
"""The extras that developers install; those of robots and of speech have environments of their own (tests/parties)."""


def needed(extras: bool) -> list[Requirement]:
    named = list(PROJECT["dependencies"])
    if extras:
        named += [one for extra in LOCKED for one in PROJECT["optional-dependencies"][extra]]
    return [Requirement(one) for one in named]


@pytest.mark.parametrize("name", ["runtime", "dev"])
def test_every_package_is_locked_with_hashes_in_a_version_that_is_wanted(name: str) -> None:
    packages = {canonicalize_name(one.name): one for one in locked(name)}
    assert all(one.hashes for one in packages.values())
    for requirement in needed(name == "dev"):
        assert packages[canonicalize_name(requirement.name)].version in requirement.specifier, (
            requirement
        )


def test_type_checkers_of_users_read_the_annotations() -> None:
    assert (ROOT / "prima" / "py.typed").is_file()


def test_developers_have_what_users_get() -> None:
    dev = {one.name: one.version for one in locked("dev")}
    assert {one.name: dev[one.name] for one in locked("runtime")} == {
        one.name: one.version for one in locked("runtime")
    }


@pytest.mark.parametrize("name", ["lxml", "quickjs-ng"])
def test_what_is_confined_by_names_is_bounded_from_above(name: str) -> None:
    (requirement,) = [one for one in needed(False) if one.name == name]
    assert any(one.operator == "<" for one in requirement.specifier)
    assert version(name) in requirement.specifier


def test_a_bill_of_materials_names_all_that_is_needed(tmp_path: Path) -> None:
    assert sbom.main([str(tmp_path)]) == 0
    (path,) = tmp_path.iterdir()
    assert re.fullmatch(r"prima-[0-9.]+\.cdx\.json", path.name)
    made = json.loads(path.read_text(encoding="utf-8"))
    assert (made["bomFormat"], made["specVersion"]) == ("CycloneDX", "1.6")
    assert re.fullmatch(r"urn:uuid:[0-9a-f-]{36}", made["serialNumber"])
    components = {one["name"]: one for one in made["components"]}
    assert {name: one["version"] for name, one in components.items()} == {
        one.name: one.version for one in locked("runtime")
    }
    for one in components.values():
        assert one["licenses"] and one["externalReferences"][0]["hashes"]
    refs = {one["ref"]: one["dependsOn"] for one in made["dependencies"]}
    assert refs.keys() == {one["bom-ref"] for one in components.values()} | {
        made["metadata"]["component"]["bom-ref"]
    }
    direct = {ref.rpartition("/")[2].partition("@")[0] for ref in next(iter(refs.values()))}
    assert direct == {canonicalize_name(one.name) for one in needed(False)}
    assert path.read_bytes() == (sbom.main([str(tmp_path)]), path.read_bytes())[1]


def test_licences_are_listed_as_packages_say_them() -> None:
    assert licences.PAGE.read_text(encoding="utf-8") == licences.page()
    rows = re.findall(r"^\| \[([^\]]+)\]\([^)]*\) \| ([^|]+) \|$", licences.page(), re.MULTILINE)
    listed = dict(rows)
    assert len(rows) == len(listed)  # also what has a version for each Python
    assert listed.keys() == {one.name for one in locked("runtime")}
    assert all(text.strip() for text in listed.values())
    for one in requires("prima") or ():
        requirement = Requirement(one)
        if requirement.marker is None:
            assert listed[requirement.name] == licences.licence(requirement.name)


def test_continuous_integration_installs_what_is_locked() -> None:
    made = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "--require-hashes -r release/dev.txt" in made
    assert "--no-deps --no-build-isolation -e ." in made
    run = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert {"test", "check", "test-live"} <= set(re.findall(r"\bmake ([a-z-]+)", run))
    installs = re.findall(r"\$\((?:PIP|UV)\) .*", made)
    assert len(installs) >= 6
    assert all("--require-hashes" in one or "--no-deps" in one for one in installs)


def test_the_installer_is_one_of_what_it_installs() -> None:
    there = {one.name: (one.version, one.hashes) for one in locked("dev")}
    installer = locked("uv")
    assert installer != []
    assert [one for one in installer if there[one.name] != (one.version, one.hashes)] == []


def test_what_security_md_points_to_is_there() -> None:
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        assert (ROOT / target).exists(), target


def test_the_citation_names_this_version_and_the_thesis() -> None:
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {PROJECT['version']}" in lines
    assert f"license: {PROJECT['license']}" in lines
    assert {"cff-version: 1.2.0", "authors:", "references:", "  - type: thesis"} <= set(lines)
