"""The bill of materials of a release: all that it needs, in CycloneDX 1.6's JSON.

``python -m release.sbom FOLDER`` writes ``prima-VERSION.cdx.json`` into the folder. The same lock
gives the same file.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from prima.version import __version__
from release.licences import licence
from release.locked import PROJECT, Locked, locked


def bill() -> dict[str, Any]:
    """The bill of materials as data."""
    packages = locked("runtime")
    own = {
        "type": "application",
        "bom-ref": purl(PROJECT, __version__),
        "name": PROJECT,
        "version": __version__,
        "purl": purl(PROJECT, __version__),
        "licenses": [{"expression": "Apache-2.0"}],
    }
    made: dict[str, Any] = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": own},
        "components": [_component(one) for one in packages],
        "dependencies": _dependencies(packages),
    }
    serial = uuid5(NAMESPACE_URL, json.dumps(made, sort_keys=True))
    return {**made, "serialNumber": f"urn:uuid:{serial}"}


def purl(name: str, version: str) -> str:
    """A package's URL (purl-spec)."""
    return f"pkg:pypi/{name.lower().replace('_', '-')}@{version}"


def _component(package: Locked) -> dict[str, Any]:
    told = licence(package.name)
    place = {
        "type": "distribution",
        "url": f"https://pypi.org/project/{package.name}/{package.version}/",
        "hashes": [{"alg": "SHA-256", "content": one} for one in package.hashes],
    }
    return {
        "type": "library",
        "bom-ref": purl(package.name, package.version),
        "name": package.name,
        "version": package.version,
        "purl": purl(package.name, package.version),
        **({"licenses": [{"license": {"name": told}}]} if told else {}),
        "externalReferences": [place],
    }


def _dependencies(packages: list[Locked]) -> list[dict[str, Any]]:
    """Which package needs which, the project first."""
    refs = {PROJECT: purl(PROJECT, __version__)}
    refs |= {one.name: purl(one.name, one.version) for one in packages}
    return [
        {
            "ref": ref,
            "dependsOn": [refs[one.name] for one in packages if name in one.via],
        }
        for name, ref in refs.items()
    ]


def main(arguments: list[str]) -> int:
    """Write the bill into a folder; gives the exit code."""
    if len(arguments) != 1:
        print("usage: python -m release.sbom FOLDER", file=sys.stderr)
        return 2
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(bill(), indent=2, ensure_ascii=False) + "\n"
    (folder / f"{PROJECT}-{__version__}.cdx.json").write_text(text, encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
