"""The drivers: one package for each kind. Third-party drivers come by entry points."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

from prima.errors import UsageError, did_you_mean, one_of
from prima.live.driver import Driver, TaskDriver

GROUP = "prima.drivers"
"""The entry points by which other packages offer drivers: the kind, and the class."""


def kinds() -> list[str]:
    """The kinds of drivers that are available."""
    own = {path.parent.name for path in Path(__file__).parent.glob("*/__init__.py")}
    return sorted(own | {point.name for point in entry_points(group=GROUP)})


def driver_class(kind: str, defined: Sequence[type[Driver]] = ()) -> type[Driver]:
    """The driver of a kind.

    Args:
        kind: as a robot's document names it.
        defined: drivers of Python files, which come first.

    Raises:
        UsageError: there is none.
    """
    if own := next((one for one in defined if one.kind == kind), None):
        return own
    points = {point.name: point for point in entry_points(group=GROUP)}
    if kind in points:
        found = points[kind].load()
        if not (inspect.isclass(found) and issubclass(found, Driver)):
            raise UsageError(f'The entry point "{kind}" in {GROUP} is not a Driver class.')
        return found
    if kind not in kinds():
        known = {*kinds(), *(one.kind for one in defined)}
        listed = f"The kinds are {one_of(known)}; --driver names the file of one of your own."
        hint = did_you_mean(kind, known) or listed
        raise UsageError(f'There is no driver of the kind "{kind}". {hint}')
    made: type[Driver] = importlib.import_module(f"{__name__}.{kind}").DRIVER
    return made


def drivers_in(file: str) -> list[type[Driver]]:
    """The drivers that a Python file defines; the file is run, and may import its neighbours.

    Raises:
        UsageError: there are none, or it cannot be run.
    """
    path = Path(file)
    if not path.is_file():
        why = "it is not a file" if path.exists() else "there is no such file"
        raise UsageError(f"{file}: cannot be read: {why}.")
    named = [one for _, one in inspect.getmembers(_imported(path, file), inspect.isclass)]
    drivers = [one for one in named if issubclass(one, Driver)]
    found = [one for one in drivers if isinstance(one.kind, str) and one.kind]
    if not found:
        raise UsageError(f"{file}: it defines no Driver with a kind.")
    for one in found:
        if name := _unawaited(one):
            raise UsageError(
                f"{file}: nobody awaits {one.__name__}.{name}: write def {name}, without async."
            )
    return found


def _unawaited(driver: type[Driver]) -> str:
    """The name of a coroutine in the place of a plain method of all drivers, if there is one."""
    plain = [name for name, _ in inspect.getmembers(TaskDriver, inspect.isfunction)]
    plain = [one for one in plain if not inspect.iscoroutinefunction(getattr(TaskDriver, one))]
    wrong = (one for one in plain if inspect.iscoroutinefunction(getattr(driver, one, None)))
    return next(wrong, "")


def _imported(path: Path, file: str) -> ModuleType:
    """A Python file as a module.

    Raises:
        UsageError: it cannot be run.
    """
    if (folder := str(path.resolve().parent)) not in sys.path:
        sys.path.append(folder)
    spec = importlib.util.spec_from_file_location(f"prima_driver_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise UsageError(f"{file}: this is not a Python file.")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SystemExit as error:
        remedy = 'Put what is for running it alone below: if __name__ == "__main__":'
        raise UsageError(f"{file}: it ends the program when it is imported. {remedy}") from error
    except Exception as error:
        raise UsageError(f"{file}: {type(error).__name__}: {error}.") from error
    return module
