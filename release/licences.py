"""The licences of what PRIMA needs, as docs/licences.md lists them.

``python -m release.licences`` writes the page, with ``--check`` it says whether it is up to date.
"""

from __future__ import annotations

import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from release.locked import locked

PAGE = Path(__file__).parent.parent / "docs" / "licences.md"
HEAD = """# Licences

PRIMA is under the Apache License 2.0 ([`LICENSE`](../LICENSE)). `pip install prima` also
installs these packages; the licences are those that their own metadata name:

| package | licence |
| --- | --- |
"""
TAIL = """
`python -m release.licences` writes this page from the installed packages; `make check` checks
it. The bill of materials of a release ([development.md](development.md#releases)) has the versions
as well. Packages that only developers need are not part of a release.
"""
CLASSIFIER = "License :: OSI Approved :: "
IDS = {
    "Apache Software License": "Apache-2.0",
    "BSD License": "BSD-3-Clause",
    "MIT License": "MIT",
}
"""What older packages say, as SPDX has it."""


def licence(name: str) -> str:
    """The licence that an installed package says it is under; nothing where it is not installed."""
    try:
        package = distribution(name)
    except PackageNotFoundError:
        return ""
    told = package.metadata
    if expression := told.get_all("License-Expression"):
        return str(expression[0])
    classifiers = [str(one) for one in told.get_all("Classifier") or ()]
    named = [one.removeprefix(CLASSIFIER) for one in classifiers if one.startswith(CLASSIFIER)]
    texts = named or [str(one) for one in told.get_all("License") or ()]
    texts = texts or [
        package.read_text(f"licenses/{one}") or "" for one in told.get_all("License-File") or ()
    ]
    return " AND ".join(IDS.get(first, first) for one in texts if (first := one.partition("\n")[0]))


def page() -> str:
    """The page."""
    rows = (f"| [{one.name}](https://pypi.org/project/{one.name}/) | {licence(one.name)} |\n"
            for one in {one.name: one for one in locked("runtime")}.values())  # fmt: skip
    return HEAD + "".join(rows) + TAIL


def main(arguments: list[str]) -> int:
    """Write the page, or check it; gives the exit code."""
    made = page()
    if arguments == ["--check"]:
        same = PAGE.read_text(encoding="utf-8") == made
        if not same:
            print(f"{PAGE.name} is out of date; run python -m release.licences", file=sys.stderr)
        return int(not same)
    PAGE.write_text(made, encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
