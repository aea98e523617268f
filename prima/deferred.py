"""Dataclasses whose methods, and patterns whose matchers, are made when they are first used.

The standard library writes and compiles all methods of a dataclass where the class stands. That
takes longer than all else in the import of most modules, and a command uses few of the classes
and few of their methods. :func:`dataclass` and :func:`field` mean what they mean there, and type
checkers take them for the standard library's; only the moment is another one: ``__init__`` is made
when there are some objects, and the rest, by the standard library itself, when it is first asked for.
:func:`pattern` means :func:`re.compile` in the same way: most commands use few of the patterns of
the modules that they import.
"""

from __future__ import annotations

import re

# Not from typing: the command line's start goes through here.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from dataclasses import dataclass, field
    from re import compile as pattern
    from typing import Any

__all__ = ["dataclass", "field", "field_names", "pattern"]

NONE = object()
"""Stands for a default that is not there."""
FEW = 15
"""Objects of a class that are filled field by field, before its ``__init__`` is compiled."""


class _Field:
    """What :func:`dataclasses.field` will be given."""

    __slots__ = ("default", "factory", "given")

    def __init__(self, **given: Any) -> None:
        self.given = given
        self.default = given.get("default", NONE)
        self.factory = given.get("default_factory")


class _Fields:
    """Stands for ``__dataclass_fields__``."""

    __slots__ = ("finish",)

    def __init__(self, finish: Callable[[], None]) -> None:
        self.finish = finish

    def __get__(self, _object: object, asked: type) -> Any:
        self.finish()
        return asked.__dataclass_fields__  # type: ignore[attr-defined]


def _dataclass(
    *, slots: bool, frozen: bool = False, eq: bool = True, order: bool = False
) -> Callable[[type], type]:
    """As :func:`dataclasses.dataclass`; all classes have slots, all fields stand in ``__init__``."""
    assert slots
    made_later = ["__repr__"]
    if eq:
        made_later += ["__eq__", "__hash__"] if frozen else ["__eq__"]
    if order:
        made_later += ["__lt__", "__le__", "__gt__", "__ge__"]
    if frozen:
        made_later += ["__setattr__", "__delattr__", "__getstate__", "__setstate__"]

    def wrap(written: type) -> type:
        if hasattr(written, "__mypyc_attrs__"):
            return _compiled(written, frozen=frozen, eq=eq, order=order)
        own = {
            name: value
            for name, value in vars(written).items()
            if name not in ("__dict__", "__weakref__")
        }
        names = tuple(written.__annotations__)
        fields: dict[str, Any] = {}
        for base in reversed(written.__mro__[1:]):
            fields |= vars(base).get("__deferred__", {})
        slots = tuple(name for name in names if name not in fields)
        fields |= {name: own.get(name, NONE) for name in names}

        def make(body: dict[str, Any]) -> type:
            return type(written)(written.__name__, written.__bases__, body)

        def finish() -> None:
            """Give the class what the standard library makes for one that is written alike."""
            from dataclasses import dataclass, field

            twin = make(
                {
                    name: field(**value.given) if isinstance(value, _Field) else value
                    for name, value in own.items()
                }
            )
            full: type = dataclass(slots=True, frozen=frozen, eq=eq, order=order)(twin)
            for name, value in vars(full).items():
                if name not in own and name not in names and name not in KEPT:
                    setattr(made, name, value)

        made_until_now = 0

        def first(self: Any, *args: Any, **named: Any) -> None:
            nonlocal made_until_now
            made_until_now += 1
            if made_until_now <= FEW and _fill(self, fields, args, named):
                return
            init = _init(made, fields, frozen)
            setattr(made, "__init__", init)  # noqa: B010
            init(self, *args, **named)

        def later(name: str) -> Any:
            def method(self: Any, *args: Any) -> Any:
                finish()
                return getattr(made, name)(self, *args)

            return method

        body = {name: value for name, value in own.items() if name not in names}
        made = make(
            {
                **({"__hash__": None} if eq and not frozen else {}),
                **{name: later(name) for name in made_later},
                **body,
                "__slots__": slots,
                "__match_args__": tuple(fields),
                "__deferred__": fields,
                "__dataclass_fields__": _Fields(finish),
                "__init__": first,
            }
        )
        return made

    return wrap


def _compiled(written: type, **how: bool) -> type:
    """What the standard library makes of a class whose attributes are compiled: it needs no slots."""
    from dataclasses import dataclass, field

    for name, value in [*vars(written).items()]:
        if isinstance(value, _Field):
            setattr(written, name, field(**value.given))
    return dataclass(**how)(written)


KEPT = ("__slots__", "__init__", "__match_args__")
"""What the class has already when the standard library's methods are made."""


def _fill(self: Any, fields: dict[str, Any], args: tuple[Any, ...], named: dict[str, Any]) -> bool:
    """Do what the ``__init__`` of a class with such fields does; False if the arguments are wrong.

    It takes longer than a function of its own, and less long than to compile one.
    """
    given = dict(zip(fields, args, strict=False))
    if len(args) > len(fields) or given.keys() & named.keys() or named.keys() - fields.keys():
        return False
    given |= named
    for name, default in fields.items():
        if name not in given:
            if isinstance(default, _Field):
                default = default.factory() if default.factory is not None else default.default
            if default is NONE:
                return False
            given[name] = default
    for name, value in given.items():
        object.__setattr__(self, name, value)
    if hasattr(self, "__post_init__"):
        self.__post_init__()
    return True


def _init(made: type, fields: dict[str, Any], frozen: bool) -> Any:
    """The ``__init__`` of a class with such fields: name to default."""
    names: dict[str, Any] = {"NONE": NONE, "put": object.__setattr__}
    head, body = ["self"], ["pass"]
    for name, default in fields.items():
        value = name
        factory = default.factory if isinstance(default, _Field) else None
        if factory is not None:
            names[f"make_{name}"] = factory
            value = f"make_{name}() if {name} is NONE else {name}"
            head.append(f"{name}=NONE")
        else:
            default = default.default if isinstance(default, _Field) else default
            names[f"default_{name}"] = default
            head.append(name if default is NONE else f"{name}=default_{name}")
        body.append(f"put(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(made, "__post_init__"):
        body.append("self.__post_init__()")
    exec(f"def __init__({', '.join(head)}):\n " + "\n ".join(body), names)
    names["__init__"].__qualname__ = f"{made.__qualname__}.__init__"
    return names["__init__"]


def field_names(kind: type) -> tuple[str, ...]:
    """The names of the fields of a dataclass of this module; none of any other class."""
    return tuple(getattr(kind, "__deferred__", ()))


class _Pattern:
    """What :func:`re.compile` gives, but its functions (``match``, ...) come when they are asked for."""

    def __init__(self, pattern: Any, flags: int = 0) -> None:
        self.pattern, self._flags = pattern, flags

    def __getattr__(self, name: str) -> Any:
        found = getattr(re.compile(self.pattern, self._flags), name)
        setattr(self, name, found)  # from now on it costs what it does there
        return found


if not TYPE_CHECKING:
    dataclass, field, pattern = _dataclass, _Field, _Pattern
