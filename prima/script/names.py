"""The names that ECMAScript code declares, reads and assigns, by scope.

Code is not run: the effects of ``with`` and ``eval`` are unknown (:attr:`Names.opaque`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from prima.script.globals import GLOBALS, HANDLED
from prima.script.parse import Code, Node, parse_expression, parse_script
from prima.script.walk import OBJECTS, CodeScope, Walk

LONG_CODE = 500
"""Maximum length of code whose names are cached; of longer code, only the last is kept."""


@dataclass(slots=True)
class Use:
    """A variable's name in code."""

    name: str
    start: int
    """Its offset in the code."""
    holder: str = ""
    """The scope it is a member of: ``document`` in ``document.x``; empty if none is written."""
    declares: bool = False
    """Whether it is declared there; a scope's member is declared by assignment."""
    parted: bool = False
    """Whether it is a scope's member whose own member is read, an error if undefined."""
    part: tuple[int, str] | None = None
    """The offset and name of its member that is used and not called, if any."""
    short: bool = False
    """Whether it is a property's name as well: ``{x}`` for ``{x: x}``."""
    around: CodeScope | None = field(default=None, compare=False, repr=False)
    """The scope in which a variable is used."""

    def would_be_local(self, name: str) -> bool:
        """Whether a function or block around it declares another name, which would hide it."""
        home = self.around.home(name, True) if self.around else None
        return home is not None and home.outer is not None


@dataclass(slots=True)
class Names:
    """The names in a piece of code that matter outside of it, or at its top level."""

    declared: set[str] = field(default_factory=set)
    """Names declared at the top level, outside of functions and blocks."""
    read: dict[str, int] = field(default_factory=dict)
    """Undeclared names that must be variables, with the first offset: those that are read, in an
    expression also those that are assigned; ``typeof x`` reads nothing."""
    written: set[str] = field(default_factory=set)
    """Undeclared names that are assigned: new variables of a script's scope."""
    changed: set[str] = field(default_factory=set)
    """Undeclared names that are updated: ``x++``, ``x += 1``."""
    now: dict[str, int] = field(default_factory=dict)
    """Undeclared names that are read outside of functions and whose type the code does not test."""
    asked: set[str] = field(default_factory=set)
    """Names whose type the code tests, by ``typeof``: it may do without them."""
    called: set[int] = field(default_factory=set)
    """The offsets of names that are called."""
    uses: list[Use] = field(default_factory=list)
    """Occurrences of all these names, in the order of the text."""
    opaque: bool = False
    """Whether there may be more names: the code has ``eval``, or is too long to be parsed."""
    sound: bool = True
    """Whether the code has no faults that the parser sees."""

    @property
    def free(self) -> Mapping[str, int]:
        """Undeclared names that are read, other than the engine's or the language's."""
        return {name: start for name, start in self.read.items() if name not in GLOBALS}

    @property
    def handled(self) -> dict[str, int]:
        """Variables of an event's handler that are read, with the first offset."""
        return {name: start for name, start in self.read.items() if name in HANDLED}


def expression_names(code: str) -> Names:
    """The names in an expression."""
    return _last(code, False) if len(code) > LONG_CODE else _kept(code, False)


def script_names(code: str) -> Names:
    """The names in a script."""
    return _last(code, True) if len(code) > LONG_CODE else _kept(code, True)


@lru_cache(maxsize=10_000)
def _kept(code: str, script: bool) -> Names:
    return _names(code, script)


@lru_cache(maxsize=2)
def _last(code: str, script: bool) -> Names:
    return _names(code, script)


def whole_scopes(uses: Sequence[Use]) -> Iterator[str]:
    """Scopes that code uses as a whole, so that any of their members may be meant."""
    for scope in OBJECTS:
        written = sum(use.name == scope and not use.holder for use in uses)
        if written > sum(use.holder == scope for use in uses):
            yield scope


def bound_names(code: Code, target: Node) -> list[str]:
    """The names that a declaration or a pattern declares, in the order of the text."""
    walk = Walk(code)
    if target.type.endswith("_declaration"):
        walk.declaration(target, walk.top)
    else:
        walk.bind(target, walk.top)
    found = sorted((start, name) for start, name, how, _ in walk.found if how == "declare")
    return [name for _, name in found]


def _names(code: str, script: bool) -> Names:
    parsed = (parse_script if script else parse_expression)(code)
    return Names(opaque=True) if parsed is None else _of_walk(Walk(parsed).go(), script)


def _of_walk(walk: Walk, script: bool) -> Names:
    made = Names(set(walk.top.names), called=walk.called, opaque=walk.opaque, sound=walk.code.sound)
    for start, name, how, scope in sorted(walk.found, key=lambda one: one[0]):
        if how in OBJECTS:
            made.uses.append(Use(name, start, how, start in walk.given, start in walk.parted))
        else:
            _add(made, walk, start, name, how, scope, script)
    for _, name, how, _ in walk.found:
        if how == "ask":
            made.asked.add(name)
            made.now.pop(name, None)
    return made


def _add(
    made: Names, walk: Walk, start: int, name: str, how: str, scope: CodeScope, script: bool
) -> None:
    home = scope.home(name, script and how == "write")
    if home not in (None, walk.top):
        return
    if how != "change":  # also read there
        part = walk.parts.get(start)
        declares, short = how == "declare", start in walk.short
        made.uses.append(Use(name, start, declares=declares, part=part, short=short, around=scope))
    if home is not None:
        return
    if how == "read" or (how == "write" and not script):
        made.read.setdefault(name, start)
        if scope.function is walk.top:
            made.now.setdefault(name, start)
    if how in ("write", "change"):
        (made.written if how == "write" else made.changed).add(name)
