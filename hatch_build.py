"""Builds wheels with a compiled core, where that is asked for.

``HATCH_BUILD_HOOK_ENABLE_CUSTOM=1 pip install .`` compiles the mediator by mypyc; it takes a C
compiler and a minute. Its Python files are installed as well, and mean the same: a compiled
module stands before its source when it is imported. Nothing is left in the checkout.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

CORE = ("prima/messages.py", "prima/scheduler/[a-z]*.py")
"""What every decision goes through."""


class CompiledCore(BuildHookInterface[Any]):
    """Adds compiled modules to a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile in a folder of its own, in which setuptools finds no other project's settings."""
        if version == "editable":
            self.app.display_warning("An editable installation has its core in Python.")
            return
        from setuptools.errors import CompileError

        self.folder = tempfile.TemporaryDirectory()
        shutil.copytree(Path(self.root, "prima"), Path(self.folder.name, "prima"))
        made = Path(self.folder.name, "made")
        try:
            files = compiled(Path(self.folder.name), made)
        except CompileError as error:
            self.app.abort(
                f"The core cannot be compiled: {error}. It takes a C compiler and the headers of "
                "Python; without HATCH_BUILD_HOOK_ENABLE_CUSTOM the core in Python is installed."
            )
        for path in files:
            build_data["force_include"][str(path)] = str(path.relative_to(made))
        build_data["pure_python"] = False
        build_data["infer_tag"] = True

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Take the folder away: the wheel is made."""
        if version != "editable":
            self.folder.cleanup()


def compiled(folder: Path, made: Path) -> list[Path]:
    """Compile the core of a copy of the package into another folder; gives what has been made."""
    from mypyc.build import mypycify
    from setuptools import Distribution

    before = Path.cwd()
    os.chdir(folder)
    try:
        files = sorted(str(path) for pattern in CORE for path in Path().glob(pattern))
        modules = mypycify(["--ignore-missing-imports", *files], group_name="prima.core")
        if sys.platform == "linux":  # where functions are not inlined that others might replace
            for module in modules:
                module.extra_compile_args.append("-fno-semantic-interposition")
        package = Distribution({"name": "prima", "ext_modules": modules})
        command = package.get_command_obj("build_ext")
        command.ensure_finalized()
        command.build_lib = str(made)
        command.run()
    finally:
        os.chdir(before)
    return [path for path in made.rglob("*") if path.suffix in (".so", ".pyd")]
