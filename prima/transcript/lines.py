"""Transcripts as JSON lines: writing, and reading with checks."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, NotRequired

from prima.errors import UsageError
from prima.errors.visible import escaped
from prima.language.values import moment
from prima.messages import Json, Record
from prima.transcript.record import FIELDS, LONGEST, LONGEST_DAYS, lacking, model

if TYPE_CHECKING:
    from pydantic import BaseModel

MAX_LINE = 20_000_000
"""Maximum length of a line of a transcript: more than the longest answer of a service takes."""
INCOMPLETE = "the transcript is incomplete."
"""The end of the message of a transcript whose last line is cut off."""
MAX_LINES, MAX_CHARACTERS, MAX_VALUES = 1_000_000, 400_000_000, 20_000_000
"""Maximum number of lines, characters and (roughly) values of a transcript that is read: more than
any run writes."""


_encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
_places = {name: place for place, name in enumerate(FIELDS)}
"""The place of each field in a line."""


def line(record: Record) -> str:
    """A record of a run as a line of JSON; its time goes from ms to seconds."""
    return escaped(_encode(_shown(record))) + "\n"


def finished(record: Record) -> Record:
    """A record of a run as it is read back from a line."""
    return {name: _read_back(value) for name, value in _shown(record).items()}


def _shown(record: Record) -> Record:
    """A record's fields in order, without those that do not apply; its time in seconds."""
    names = sorted(record, key=_places.__getitem__)
    shown = {name: value for name in names if (value := record[name]) is not None}
    shown["time"] = record["time"] / 1000
    return shown


_SCALARS = frozenset({str, int, float, bool, type(None)})


def _read_back(value: Json) -> Json:
    """A value as JSON would return it: a copy of lists and dicts with strings as keys."""
    kind = type(value)
    if kind in _SCALARS:
        return value
    if kind is list or kind is tuple:
        return [_read_back(one) for one in value]
    if kind is dict and all(type(key) is str for key in value):
        return {key: _read_back(one) for key, one in value.items()}
    return json.loads(_encode(value))


def read_lines(name: str, lines: Iterable[str], cut: list[str] | None = None) -> Iterator[Record]:
    """Read a transcript's records, checked against the model.

    If ``cut`` is a list, complete records before an invalid line are still yielded,
    and the line's error is appended to it.

    Raises:
        UsageError: the text is not a transcript; the line is named.
    """
    from pydantic import ValidationError

    quick = quick_reader()
    count, latest = 0, 0.0
    size = _Size()
    for number, text in enumerate(lines, 1):
        if not text.strip():
            continue
        if len(text) > MAX_LINE:
            raise UsageError(f"{name}:{number}: the line is too long for a transcript.")
        try:
            size.add(text)
            record = _read(text, quick)
            if missing := lacking(record):
                raise ValueError(f'{record["phase"]} needs "{missing}"')
            if record["time"] < latest:
                raise _Backward(f"the time goes back from {latest:g} s to {record['time']:g} s")
        except (ValueError, RecursionError) as error:
            message = f"{name}:{number}: {_why(error, text, ValidationError)}"
            if cut is None or count == 0:
                raise UsageError(message) from None
            cut.append(message)
            return
        count, latest = count + 1, record["time"]
        yield record
    if count == 0:
        raise UsageError(f"{name}: not a transcript: it has no records.")


def _read(text: str, quick: Callable[[str], Record]) -> Record:
    from pydantic import ValidationError

    if "NaN" in text or "Infinity" in text:
        return _closely(text)
    try:
        return quick(text)
    except ValidationError:
        return _closely(text)


@cache
def quick_reader() -> Callable[[str], Record]:
    """Parses and checks a line in one step, which is several times as fast as two.

    It raises pydantic's ``ValidationError`` for lines that it does not accept. Of the lines that
    :func:`model` accepts it rejects only escaped halves of letters and very deep values; it also
    accepts ``NaN`` and ``Infinity``, which are not JSON. Times are floats.
    """
    from pydantic import TypeAdapter
    from typing_extensions import TypedDict

    fields: dict[str, Any] = {}
    for name, field in model().model_fields.items():
        kind: Any = field.annotation
        for bound in field.metadata:
            kind = Annotated[kind, bound]
        fields[name] = kind if field.is_required() else NotRequired[kind]
    made = TypedDict("Quick", fields)  # type: ignore[misc]
    setattr(made, "__pydantic_config__", model().model_config)  # noqa: B010
    read: Callable[[str], Record] = TypeAdapter(made).validator.validate_json
    return read


def _closely(text: str) -> Record:
    """The record of a line that the fast parser rejects.

    Raises:
        ValueError: it is not a record.
        RecursionError: its values are nested too deeply.
    """
    text.encode()  # what was not UTF-8 has been read as halves of letters
    record: Record = json.loads(text, parse_constant=_no_number, parse_int=_integer)
    model().model_validate(record)
    if "\\ud" in text.lower():
        json.dumps(record, ensure_ascii=False).encode()  # half a letter is invalid
    return record


def _no_number(word: str) -> None:
    raise ValueError(f"{word} is not a JSON number")


def _integer(digits: str) -> int:
    try:
        return int(digits)
    except ValueError:
        raise _TooMuch("a number is too large") from None


def _not_utf8(error: UnicodeEncodeError, text: str) -> str:
    if text.endswith("\n") or error.end < len(text):
        return "not a transcript's record: it is not UTF-8."
    return f"the record is cut off within a character; {INCOMPLETE}"


class _Backward(ValueError):
    """A record is earlier than the one above it."""


class _TooMuch(ValueError):
    """A transcript exceeds the limits."""


class _Size:
    """How much of a transcript has been read."""

    def __init__(self) -> None:
        self.lines = self.characters = self.values = 0

    def add(self, text: str) -> None:
        """Count a line before it is processed.

        Raises:
            _TooMuch: the total exceeds a limit.
        """
        self.lines += 1
        self.characters += len(text)
        # An object takes as much memory as a few other values.
        self.values += text.count(",") + text.count("[") + 4 * text.count("{")
        for held, most, what in (
            (self.lines, MAX_LINES, "lines"),
            (self.characters, MAX_CHARACTERS, "characters"),
            (self.values, MAX_VALUES, "values"),
        ):
            if held > most:
                raise _TooMuch(f"it has more than {most:,} {what}; no run writes so many")


def _why(error: Exception, text: str, invalid: type[Exception]) -> str:
    if isinstance(error, _TooMuch):
        return f"{error}."
    if isinstance(error, _Backward):
        return f"{error}; lines have been moved, or are of two transcripts."
    if isinstance(error, UnicodeEncodeError):
        return _not_utf8(error, text)
    if isinstance(error, invalid):
        first = error.errors()[0]  # type: ignore[attr-defined]
        if first["type"] == "less_than_equal":
            return f"the time is after more than {LONGEST_DAYS} days; a run does not last so long."
        if not first["loc"]:
            return 'not a transcript\'s record: write an object such as {"time":0, ...}.'
        where = ".".join(str(part) for part in first["loc"])
        return f"not a transcript's record: {where}: {first['msg']}."
    if "needs" in str(error):
        return f"not a transcript's record: {error}."
    if text.lstrip().startswith("{") and not text.endswith("\n"):
        return f"the record is cut off; {INCOMPLETE}"
    if text.lstrip().startswith("<"):
        return "this is not a line of JSON but of XML. Transcripts are written by prima run -o."
    return "this is not a line of JSON. Transcripts are written by prima run -o."


@cache
def head_model() -> type[BaseModel]:
    """The model against which the data of a run's record are checked."""
    from pydantic import AfterValidator, BaseModel, ConfigDict, Field

    File = Annotated[str, AfterValidator(_file)]

    class Live(BaseModel):
        model_config = ConfigDict(strict=True)
        robot: File = ""
        scenario: File = ""
        world: File = ""
        services: File = ""
        document: str = ""
        fa: list[File] = []
        ea: list[File] = []
        maps: list[str] = []

    class Head(BaseModel):
        model_config = ConfigDict(strict=True)
        policy: str
        bound: int | None = Field(None, ge=1)
        patience: float = Field(0, ge=0, le=LONGEST)
        absence: float = Field(0, ge=0, le=LONGEST)
        seed: int = Field(1, ge=0)
        date: Annotated[str, AfterValidator(_date)] = ""
        files: dict[str, str] = {}
        redacted: bool = False
        live: Live | None = None

    return Head


def check_head(head: Record, name: str) -> None:
    """Check that a transcript's first record says how to run it again.

    Raises:
        UsageError: it does not.
    """
    from pydantic import ValidationError

    if head["phase"] != "run":
        raise UsageError(f"{name}:1: the transcript does not begin with its run record.")
    try:
        head_model().model_validate(head["data"])
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise UsageError(f"{name}:1: the run record is damaged: {where}: {first['msg']}.") from None


def _file(text: str) -> str:
    if "\0" in text:
        raise ValueError(f"{text!r} is not a file's name")
    return text


def _date(text: str) -> str:
    moment(text)
    return text
