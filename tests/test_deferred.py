"""Classes of :mod:`prima.deferred` are the standard library's dataclasses in all but the moment."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import pkgutil
import re
import subprocess
import sys
from importlib import import_module
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import prima
from prima import deferred

TEXT = '''
from __future__ import annotations

class Base:
    """No dataclass."""

@dataclass(slots=True)
class Point(Base):
    """Two numbers."""
    x: int
    y: int = 2

    @property
    def sum(self) -> int:
        return self.x + self.y

@dataclass(slots=True)
class Named(Point):
    """A point with a name and a list; the default of y is another one."""
    name: str = field(default="p", compare=False)
    held: list[int] = field(default_factory=list, repr=False)
    y: int = 3

@dataclass(frozen=True, slots=True)
class Fixed:
    """Cannot be changed."""
    x: int
    data: dict[str, int] = field(default_factory=dict, compare=False)

@dataclass(frozen=True, slots=True)
class More(Fixed):
    """Another field."""
    z: tuple[int, ...] = ()

@dataclass(slots=True, eq=False)
class Alone:
    """Equal to itself alone."""
    x: int
    seen: bool = False

@dataclass(slots=True, order=True)
class Ordered:
    """Comes before others."""
    x: int
    label: str = field(default="", compare=False)

@dataclass(slots=True)
class Ready:
    """Does more when it is made, and says itself what it is."""
    x: int
    twice: int = 0

    def __post_init__(self) -> None:
        self.twice = 2 * self.x

    def __repr__(self) -> str:
        return f"ready {self.x}"
'''


def classes(module: Any) -> Any:
    """The classes above, made by a module's decorator."""
    made = ModuleType(f"made_by_{module.__name__.replace('.', '_')}")
    made.__dict__.update(dataclass=module.dataclass, field=module.field)
    sys.modules[made.__name__] = made
    exec(TEXT, made.__dict__)
    return made


@pytest.fixture(params=[dataclasses, deferred], ids=["standard", "deferred"])
def made(request: pytest.FixtureRequest) -> Any:
    """Every test holds for the standard library's classes, too."""
    return classes(request.param)


def test_fields_and_defaults(made: Any) -> None:
    point, named = made.Point(1), made.Named(1, held=[4])
    assert (point.x, point.y, point.sum) == (1, 2, 3)
    assert (named.x, named.y, named.name, named.held) == (1, 3, "p", [4])
    assert made.Named(1).held == [] and made.Named(1).held is not made.Named(2).held
    named.held, named.x = [5], 7
    assert (named.held, named.sum) == ([5], 10)
    with pytest.raises(TypeError, match=r"Point\.__init__\(\) missing 1 required"):
        made.Point()
    with pytest.raises(TypeError, match="unexpected keyword argument 'z'"):
        made.Point(1, z=2)


def test_slots(made: Any) -> None:
    assert made.Point.__slots__ == ("x", "y")
    assert set(made.Named.__slots__) == {"name", "held"}
    assert made.Alone.__slots__ == ("x", "seen")
    for one in (made.Alone(1), made.Ordered(1)):
        assert not hasattr(one, "__dict__")
        with pytest.raises(AttributeError):
            one.other = 1


def test_shown(made: Any) -> None:
    assert repr(made.Named(1, held=[2])) == "Named(x=1, y=3, name='p')"
    assert repr(made.More(1, z=(2,))) == "More(x=1, data={}, z=(2,))"
    assert repr(made.Ready(2)) == "ready 2" and made.Ready(2).twice == 4


def test_equal_and_hashed(made: Any) -> None:
    assert made.Point(1) == made.Point(1, 2) != made.Point(2)
    assert made.Named(1, name="a") == made.Named(1, name="b") != made.Point(1, 3)
    assert made.Alone(1) != made.Alone(1) and len({made.Alone(1), made.Alone(1)}) == 2
    assert len({made.Fixed(1), made.Fixed(1, {"a": 1}), made.Fixed(2)}) == 2
    assert made.More(1) != made.Fixed(1) and hash(made.More(1)) == hash(made.More(1))
    with pytest.raises(TypeError, match="unhashable type: 'Point'"):
        hash(made.Point(1))


def test_order(made: Any) -> None:
    one, two = made.Ordered(1, "b"), made.Ordered(2, "a")
    assert one < two and one <= two and two > one and two >= one
    assert not one < made.Ordered(1, "c")


def test_frozen(made: Any) -> None:
    for one in (made.Fixed(1), made.More(1)):
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.x = 2
        with pytest.raises(dataclasses.FrozenInstanceError):
            del one.x
        assert one.x == 1


def test_what_the_standard_library_does_with_them(made: Any) -> None:
    assert [one.name for one in dataclasses.fields(made.Named)] == ["x", "y", "name", "held"]
    assert dataclasses.is_dataclass(made.Fixed) and not dataclasses.is_dataclass(made.Base)
    assert dataclasses.replace(made.More(1, z=(1,)), x=3) == made.More(3, z=(1,))
    assert dataclasses.asdict(made.Named(1)) == {"x": 1, "y": 3, "name": "p", "held": []}


def test_copies(made: Any) -> None:
    for one in (made.Named(1, held=[2]), made.More(1, {"a": 1}, (2,)), made.Ordered(1)):
        for twin in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
            assert twin == one and repr(twin) == repr(one) and twin is not one


def test_match(made: Any) -> None:
    match made.Named(5):
        case made.Point(x, y):
            assert (x, y) == (5, 3)
        case _:
            raise AssertionError
    assert made.Named.__match_args__ == ("x", "y", "name", "held")


def test_names_of_fields() -> None:
    made = classes(deferred)
    assert deferred.field_names(made.Named) == ("x", "y", "name", "held")
    assert deferred.field_names(int) == ()


def test_defaults_that_are_values_with_a_meaning() -> None:
    """None, and what equals everything, are defaults as others are."""
    made = SimpleNamespace()
    body = {"__annotations__": {"a": "Any", "b": "Any"}, "a": None, "b": deferred.field(default=0)}
    made.One = deferred.dataclass(slots=True)(type("One", (), body))
    assert (made.One().a, made.One().b, made.One(1, None).b) == (None, 0, None)


def test_nothing_is_written_before_it_is_needed() -> None:
    code = "import sys, prima.commands; print('dataclasses' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_a_pattern_is_what_the_standard_library_compiles() -> None:
    for given in ((r"(?P<a>x)+", re.DOTALL), (rb"a|b",)):
        pattern, real = deferred.pattern(*given), re.compile(*given)
        assert (pattern.pattern, pattern.flags) == (real.pattern, real.flags)
        text = real.pattern[:0] + (b"ab" if isinstance(real.pattern, bytes) else "axx")
        for one in (pattern, pattern):
            assert one.findall(text) == real.findall(text)
            assert str(one.search(text)) == str(real.search(text))


def test_every_pattern_can_be_compiled() -> None:
    """What nobody has used yet may be wrong: here all are used."""
    found = 0
    for module in list(pkgutil.walk_packages(prima.__path__, "prima.")):
        if module.name.endswith("__main__"):
            continue
        for one in vars(import_module(module.name)).values():
            if isinstance(one, deferred.pattern):  # type: ignore[arg-type]
                assert one.groups >= 0
                found += 1
    assert found > 10
