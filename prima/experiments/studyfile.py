"""Study files: a sweep written down in TOML (docs/experiments.md).

scenarios = ["visit.xml"]
policies = ["prima", "fifo"]
seeds = 20

[vary]
touch = "0s..20s/200ms"
answer = ["Yes.", "No.", ""]
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from prima.errors import UsageError, did_you_mean
from prima.experiments.sweep import Question
from prima.language.values import read_value
from prima.markup.toml import parse_toml

MOST_BYTES = 10_000_000
"""Size of a study file."""
Level = str | int | float | bool


class Study(BaseModel):
    """What a study file may say."""

    model_config = ConfigDict(extra="forbid", strict=True)

    scenarios: Annotated[list[str], Field(min_length=1)]
    policies: list[str] = []
    seeds: Annotated[int, Field(ge=1)] = 1
    design: Literal["full", "random", "lhs"] = "full"
    runs: Annotated[int, Field(ge=1)] | None = None
    bound: Annotated[int, Field(ge=1)] | None = None
    patience: str | None = None
    isolate: Literal["ea", "all", "none"] = "ea"
    vary: dict[str, str | list[Level]] = {}


def question_of(scenarios: Sequence[str], vary: Mapping[str, str], **options: Any) -> Question:
    """What is asked by scenarios, or by a study file and what comes before what it says.

    Args:
        scenarios: scenarios, or one study file (``.toml``).
        vary: levels by paths.
        options: fields of a question; None where nothing is given.

    Raises:
        UsageError: neither is named, or the file is wrong.
    """
    if not scenarios:
        raise UsageError("Name a scenario, or a study file (.toml).")
    asked = Question(tuple(scenarios), vary)
    if any(one.endswith(".toml") for one in scenarios):
        if len(scenarios) > 1:
            raise UsageError("A study file names its scenarios itself: name it alone.")
        study = read_study(scenarios[0])
        asked = replace(study, vary={**study.vary, **vary})
    return replace(asked, **{name: one for name, one in options.items() if one is not None})


def read_study(path: str) -> Question:
    """Read a study file; paths in it begin at its folder.

    Raises:
        UsageError: it cannot be read, or is wrong; the line is named where it is known.
    """
    text = _read(path)
    try:
        study = Study.model_validate(_parsed(path, text))
        patience = None if study.patience is None else int(read_value("duration", study.patience))
    except ValidationError as error:
        raise _wrong(path, text, error) from None
    except ValueError as error:
        raise UsageError(f"{_place(path, text, 'patience')}: patience {error}") from None
    folder = os.path.dirname(path)
    return Question(
        tuple(os.path.normpath(os.path.join(folder, one)) for one in study.scenarios),
        {name: levels_text(levels) for name, levels in study.vary.items()},
        tuple(study.policies),
        study.seeds,
        study.design,
        study.runs,
        study.bound,
        patience,
        study.isolate,
        folder,
    )


def _read(path: str) -> str:
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise UsageError(f"{path}: larger than {MOST_BYTES:,} bytes.")
        return data.decode("utf-8-sig")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path}: not TOML: it is not UTF-8.") from None


def _parsed(path: str, text: str) -> dict[str, Any]:
    try:
        return parse_toml(text)
    except ValueError as error:
        match = re.fullmatch(r"(.*) \(at line (\d+), column (\d+)\)", str(error), re.DOTALL)
        where = f":{match[2]}:{match[3]}" if match else ""
        raise UsageError(f"{path}{where}: not TOML: {match[1] if match else error}.") from None


def levels_text(given: str | Sequence[Level]) -> str:
    """Levels of a list as on the command line."""
    if isinstance(given, str):
        return given
    texts = [str(one).lower() if isinstance(one, bool) else str(one) for one in given]
    return "|".join(one.replace("|", "\\|") for one in texts)


def _wrong(path: str, text: str, error: ValidationError) -> UsageError:
    """The first mistake of a study file."""
    first = error.errors()[0]
    names = [str(one) for one in first["loc"]]
    key = names[1] if names[0] == "vary" and len(names) > 1 else names[0]
    if first["type"] == "extra_forbidden":
        hint = did_you_mean(key, Study.model_fields) or "What is varied is written below [vary]."
        why = f'There is no "{key}" in a study. {hint}'
    elif first["type"] == "missing":
        return UsageError(f'{path}: a study needs {key}: write {key} = ["visit.xml"].')
    else:
        why = f"{key}: {first['msg'][0].lower()}{first['msg'][1:]}."
    return UsageError(f"{_place(path, text, key)}: {why}")


def _place(path: str, text: str, key: str) -> str:
    """Where a key is written."""
    match = re.search(rf"^[ \t]*\"?{re.escape(key)}\"?[ \t]*=", text, re.MULTILINE)
    return f"{path}:{text.count(chr(10), 0, match.start()) + 1}" if match else path
