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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from prima.errors import UsageError, did_you_mean
from prima.experiments.sweep import SweepQuestion
from prima.language.values import read_value
from prima.loading.files import read_bytes
from prima.markup.toml import NotToml, parse_toml

MOST_BYTES = 1_000_000
"""Maximum size of a study file; more values go into a separate file (``empirical``)."""
MOST = 10**12
"""The greatest number in a study file: runs, bounds and numbers among levels."""
Level = str | int | float | bool


def _levels(given: Any) -> Any:
    """Check that there are levels; of several wrong ones only the first is reported."""
    several = given if isinstance(given, list) else [given]
    if not several or not all(isinstance(one, Level) for one in several):
        raise ValueError("no levels")
    if any(isinstance(one, int) and abs(one) > MOST for one in several):
        raise ValueError("too large a number")
    return given


def _texts(given: list[Any]) -> list[Any]:
    if not all(isinstance(one, str) for one in given):
        raise ValueError("no texts")
    return given


Texts = Annotated[list[Any], AfterValidator(_texts)]
Count = Annotated[int, Field(ge=1, le=MOST)]
_NUMBER = f"write a whole number from 1 to {MOST:,}"
HOW = {
    "scenarios": 'write a list of files, as ["visit.xml"]',
    "policies": 'write a list of policies, as ["prima", "fifo"]',
    "seeds": _NUMBER,
    "runs": _NUMBER,
    "bound": _NUMBER,
    "design": 'write "full", "random" or "lhs"',
    "patience": 'write a time, as "30s"',
    "isolate": 'write "ea", "all" or "none"',
    "vary": 'write what is varied below [vary], as touch = "0s..20s/1s"',
}
"""The remedy for a wrong value, by key."""
LEVELS = 'write its levels, as "0s..20s/1s" or ["Yes.", "No."]; a path with a dot in quotes'


class Study(BaseModel):
    """The contents of a study file."""

    model_config = ConfigDict(extra="forbid", strict=True)

    scenarios: Annotated[Texts, Field(min_length=1)]
    policies: Texts = []
    seeds: Count = 1
    design: Literal["full", "random", "lhs"] = "full"
    runs: Count | None = None
    bound: Count | None = None
    patience: str | None = None
    isolate: Literal["ea", "all", "none"] = "ea"
    vary: dict[str, Annotated[Any, AfterValidator(_levels)]] = {}


def question_of(scenarios: Sequence[str], vary: Mapping[str, str], **options: Any) -> SweepQuestion:
    """The question posed by scenarios, or by a study file with overriding options.

    Args:
        scenarios: scenarios, or one study file (``.toml``).
        vary: levels by paths.
        options: fields of a question; None where not given.

    Raises:
        UsageError: neither is named, or the file is invalid.
    """
    if not scenarios:
        raise UsageError("Name a scenario, or a study file (.toml).")
    asked = SweepQuestion(tuple(scenarios), vary)
    if any(one.endswith(".toml") for one in scenarios):
        if len(scenarios) > 1:
            raise UsageError("A study file names its scenarios itself: name it alone.")
        study = read_study(scenarios[0])
        asked = replace(study, vary={**study.vary, **vary})
    given = {name: one for name, one in options.items() if one is not None}
    overridden = {*vary, *(f"--{name}" for name in given)}
    places = {name: one for name, one in asked.places.items() if name not in overridden}
    return replace(asked, **given, places=places)


def read_study(path: str) -> SweepQuestion:
    """Read a study file; paths in it begin at its folder.

    Raises:
        UsageError: it cannot be read, or is invalid; the line is named if known.
    """
    text, tree = _read(path)
    try:
        study = Study.model_validate(tree)
        patience = None if study.patience is None else int(read_value("duration", study.patience))
    except ValidationError as error:
        raise _wrong(path, text, error) from None
    except ValueError:
        raise UsageError(
            f"{_place(path, text, 'patience')}: patience: {HOW['patience']}."
        ) from None
    folder = os.path.dirname(path)
    scenarios = tuple(os.path.normpath(os.path.join(folder, one)) for one in study.scenarios)
    return SweepQuestion(
        scenarios,
        {name: levels_text(levels) for name, levels in study.vary.items()},
        tuple(study.policies),
        study.seeds,
        study.design,
        study.runs,
        study.bound,
        patience,
        study.isolate,
        folder,
        _places(path, text, study, scenarios),
    )


def _places(path: str, text: str, study: Study, scenarios: Iterable[str]) -> dict[str, str]:
    """Where options, paths, policies and scenarios are written."""
    lines = {one: f"{path}:{line}" for one, line in _lines(text).items()}
    places = {one: line for one, line in lines.items() if one in study.vary}
    places |= {f"--{one}": lines[one] for one in ("design", "runs", "seeds") if one in lines}
    names = [name for one in study.policies for name in (one, *one.split("+"))]
    places |= dict.fromkeys(names, _place(path, text, "policies"))
    return places | dict.fromkeys(scenarios, _place(path, text, "scenarios"))


def _read(path: str) -> tuple[str, dict[str, Any]]:
    data = read_bytes(path, MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise UsageError(f"{path}: larger than {MOST_BYTES:,} bytes.")
    try:
        return parse_toml(path, data)
    except NotToml as error:
        raise UsageError(str(error)) from None


def levels_text(given: Level | Sequence[Level]) -> str:
    """A list's levels in the form of the command line."""
    if isinstance(given, str):
        return given
    if isinstance(given, int | float):
        given = [given]
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
        why = f"{key}: {HOW[key] if names == [key] or names[0] != 'vary' else LEVELS}."
    return UsageError(f"{_place(path, text, key)}: {why}")


def _place(path: str, text: str, key: str) -> str:
    """The place where a key is written."""
    line = _lines(text).get(key)
    return f"{path}:{line}" if line else path


def _lines(text: str) -> dict[str, int]:
    """The lines of keys, where these are first written."""
    found: dict[str, int] = {}
    for number, line in enumerate(text.split("\n"), 1):
        key, is_key, _ = line.partition("=")
        if is_key:
            found.setdefault(key.strip(" \t").strip('"'), number)
    return found
