"""Elements of Commands, and those that arrange them."""

from __future__ import annotations

from prima.interpreter.vocabulary.names import SPEAKING
from prima.language.commands import TABLE_4_2, CommandType
from prima.markup.vocabulary import Attribute, Element, attribute

LONGEST = """longest: duration 1.. = 60s | its longest duration; then error.unit.timeout is thrown and it
    ends"""
_ORDER = """order: text(after now) = after | after what the application asked for last, or now, cancelling
    what wants the same devices"""
_RESTARTABLE = """restartable: boolean = false | whether it gives way to a reaction at once and starts again from
    its beginning afterwards (extension x2)"""


def _command(row: CommandType) -> Element:
    arguments = tuple(
        Attribute(
            name,
            argument.kind,
            argument.doc,
            argument.required,
            "" if argument.default is None else _shown(argument.kind, argument.default),
            dynamic=True,
            low=argument.low,
            high=argument.high,
        )
        for name, argument in row.arguments.items()
    )
    order = () if row.now else (attribute(_ORDER),)
    restart = () if row.feedback or row.now else (attribute(_RESTARTABLE),)
    says = row.text != "none"
    marks = [
        "devices " + ", ".join(sorted(row.devices)) if row.devices else "no devices",
        *(["one Atomic Behavior for each loop"] if row.feedback else []),
        *(["leaves the user"] if row.leaves else []),
        *(["engages the user"] if row.engages else []),
    ]
    return Element(
        row.name,
        f"{row.title}. {row.doc} [{'; '.join(marks)}]",
        (*arguments, *order, *restart),
        ("param", "on", *(("value", "break") if says else ())),
        says,
        source="" if row.name == "pause" else "thesis Table 4.2",
    )


def _shown(kind: str, value: object) -> str:
    if kind == "duration" and isinstance(value, int):
        return f"{value / 1000:g}s"
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


ARRANGING = f"""
iu > {SPEAKING} command par seq | An Information Unit around Commands: they are one Atomic Behavior
    that nothing breaks. | thesis 4.1 (2); rule U4
  {LONGEST}
  {_RESTARTABLE}
par > {SPEAKING} command seq iu | Branches that run in parallel; what follows waits for all of them.
    | SMIL; thesis Figure 4.1
seq > {SPEAKING} command par iu | Commands one after another, inside a par or a unit. | SMIL; rule
    U3
command > param on value #text | A Command that the robot's profile adds. A param with the name of
    one of its motion arguments gives that argument; others are additional arguments. | thesis 5.3
    (6)
  type*: id | the Command's name in the profile
  {_ORDER}
  {_RESTARTABLE}
"""
COMMANDS = tuple(_command(row) for row in TABLE_4_2.values() if row.name != "q-and-a")
