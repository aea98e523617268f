"""Bundles: a sweep with everything it was made from, in one archive (RO-Crate 1.1).

The archive has the table, the folder beside it, every file that the runs have read, a study file
and ``ro-crate-metadata.json``, which says what each of them is. Unpacked, the study gives the same
table again, byte for byte.
"""

from __future__ import annotations

import json
import mimetypes
import os
import platform
import re
import zipfile
from pathlib import Path
from urllib.parse import quote

from prima.errors import UsageError
from prima.experiments.kept import Kept
from prima.experiments.sweep import Output, SweepQuestion
from prima.loading.writing import whole
from prima.messages import Json
from prima.version import __version__

STUDY, METADATA = "study.toml", "ro-crate-metadata.json"
"""Names in a bundle."""
FIRST_DAY = (1980, 1, 1, 0, 0, 0)
"""The time of every file, so that equal bundles are equal byte for byte."""
EMPIRICAL = re.compile(r"(empirical\(\s*)([^):]+)")
"""A distribution's file of values."""
PROFILE = "https://w3id.org/ro/crate/1.1"
TYPES = {
    ".jsonl": "application/jsonl",
    ".parquet": "application/vnd.apache.parquet",
    ".toml": "application/toml",
    ".vxml": "application/voicexml+xml",
    ".xml": "application/xml",
}
"""Media types that :mod:`mimetypes` does not have everywhere."""


def write_bundle(path: str, out: Output) -> int:
    """Write the archive of a finished table; returns the number of files in it.

    Raises:
        UsageError: it cannot be written, or a file that was read is not below this folder.
    """
    files = dict(sorted(_files(out).items()))
    files[STUDY] = study_text(out.sweep.question).encode()
    files[METADATA] = _metadata(files, out).encode()
    with whole(path) as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, FIRST_DAY), data, zipfile.ZIP_DEFLATED)
    return len(files)


def check_bundle(path: str, out: Output) -> None:
    """Check before the first run whether a bundle can be made.

    Raises:
        UsageError: the archive cannot be there, or something that is read is not below this
            folder.
    """
    there = Path(path)
    if os.path.realpath(there) in map(os.path.realpath, (out.path, out.folder)):
        raise UsageError(f"{path}: the table is written there; name another file for the archive.")
    if there.is_dir():
        raise UsageError(f"{path}: it is a folder; name a file for the archive.")
    if not there.parent.is_dir():
        raise UsageError(f"{path}: there is no folder {there.parent}; make it first.")
    for name in _read(out):
        if Path(name).is_absolute() or ".." in Path(name).parts:
            message = f"{name}: a bundle has files of this folder and below it alone."
            raise UsageError(f"{message} Call prima from a folder that holds all of them.")
        if "\\" in name:
            raise UsageError(f'{name}: other systems take "\\" for a folder; rename the file.')


def study_text(question: SweepQuestion) -> str:
    """A question as a study file (:mod:`prima.experiments.studyfile`)."""
    said: dict[str, Json] = {
        "scenarios": list(question.scenarios),
        "policies": list(question.policies),
        "seeds": question.seeds,
        "design": question.design,
        "runs": question.runs,
        "bound": question.bound,
        "patience": None if question.patience is None else f"{question.patience}ms",
        "isolate": question.isolate,
    }
    lines = [f"{name} = {_toml(value)}" for name, value in said.items() if value is not None]
    vary = {name: _from_here(levels, question.folder) for name, levels in question.vary.items()}
    varied = [f"{_toml(name)} = {_toml(value)}" for name, value in vary.items()]
    return "\n".join([*lines, *(["", "[vary]"] if varied else []), *varied, ""])


def _from_here(levels: str, folder: str) -> str:
    """Levels whose files are named from this folder, and not from a study's."""
    return EMPIRICAL.sub(lambda match: match[1] + _below_study(folder, match[2]), levels)


def _below_study(folder: str, name: str) -> str:
    return os.path.normpath(os.path.join(folder, name.strip()))


def _toml(value: Json) -> str:
    """A text, number or list in TOML: its JSON, with DEL escaped, which TOML does not allow."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _read(out: Output) -> dict[str, bytes]:
    """Every file that the runs have read, by its path from this folder."""
    stage = out.sweep.stage
    stage.pack()
    assert isinstance(stage.files, Kept)
    here = Path(stage.files.folder)
    found = dict(stage.scenarios)
    for path in {*stage.files.texts, *stage.files.heads}:
        if path.is_file():
            found[_relative(path, here)] = path.read_bytes()
    question = out.sweep.question
    for levels in question.vary.values():
        for _, name in EMPIRICAL.findall(levels):
            file = _below_study(question.folder, name)
            found[file] = Path(file).read_bytes()
    return found


def _relative(path: Path, here: Path) -> str:
    return path.relative_to(here).as_posix() if path.is_relative_to(here) else str(path)


def _files(out: Output) -> dict[str, bytes]:
    """The contents of an archive other than its study and its metadata."""
    found = _read(out)
    for path in (out.path, *sorted(out.folder.rglob("*"))):
        if path.is_file() and not path.is_symlink():  # a sweep makes no links
            found[_name(path, out)] = path.read_bytes()
    return found


def _name(path: Path, out: Output) -> str:
    """The name in an archive of the table or of a file beside it.

    It is the path from this folder, as that of the documents is: the scenarios of orders name
    these by relative paths. Of a table elsewhere only the names from its own folder are known.
    """
    here, table = Path.cwd(), Path(os.path.abspath(out.path))
    from_here = table.is_relative_to(here)
    return Path(os.path.abspath(path)).relative_to(here if from_here else table.parent).as_posix()


def _metadata(files: dict[str, bytes], out: Output) -> str:
    """The description of the archive according to RO-Crate 1.1."""
    table, folder = _name(out.path, out), _name(out.folder, out)
    others = [name for name in files if name != table and not name.startswith(f"{folder}/")]
    graph: list[dict[str, Json]] = [
        {
            "@id": METADATA,
            "@type": "CreativeWork",
            "conformsTo": {"@id": PROFILE},
            "about": {"@id": "./"},
        },
        {
            "@id": "./",
            "@type": "Dataset",
            "name": f"A sweep of {', '.join(out.sweep.question.scenarios)}",
            "description": f"{len(out.sweep)} runs. Unpack it, and in its folder call:"
            f" prima sweep {STUDY} -o {table}",
            "hasPart": [{"@id": quote(name)} for name in files],
            "mainEntity": {"@id": quote(table)},
            "mentions": {"@id": "#sweep"},
        },
        {
            "@id": "#sweep",
            "@type": "CreateAction",
            "name": "The sweep",
            "instrument": {"@id": "#prima"},
            "object": [{"@id": quote(name)} for name in others],
            "result": [{"@id": quote(table)}],
        },
        {
            "@id": "#prima",
            "@type": "SoftwareApplication",
            "name": "PRIMA",
            "softwareVersion": __version__,
            "runtimePlatform": f"Python {platform.python_version()}",
        },
    ]
    for name, data in files.items():
        kind = TYPES.get(Path(name).suffix) or mimetypes.guess_type(name)[0]
        entry: dict[str, Json] = {"@id": quote(name), "@type": "File"}
        entry["contentSize"] = len(data)
        entry |= {"encodingFormat": kind} if kind else {}
        entry |= (
            {"description": "The transcript of an order"}
            if name.startswith(f"{folder}/orders/")
            else {}
        )
        graph.append(entry)
    context = f"{PROFILE}/context"
    return json.dumps({"@context": context, "@graph": graph}, indent=1, ensure_ascii=False) + "\n"
