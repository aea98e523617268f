"""Names of variables that no expression can read, or that hide the platform's own (5.1)."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Place, Problem
from prima.errors.diagnoses.values import BAD_VALUE
from prima.markup.tree import Node
from prima.script.names import script_names
from prima.script.walk import OBJECTS
from prima.script.wrapping import PLACE
from prima.voicexml.arranging import UNIT
from prima.voicexml.elements import ITEMS
from prima.voicexml.variablenames import wrong_name

HIDING = {
    "session": "the session variables, which are read-only",
    **{name: f"the variables of the {name}" for name in sorted(OBJECTS)},
}
"""Names that variables should not have, each with what it hides (5.1.2)."""
NAMING = {
    **dict.fromkeys([*ITEMS, UNIT, "var", "data"], "name"),
    **dict.fromkeys(["foreach", "said-foreach"], "item"),
}
"""Elements that declare a variable, with the attribute that names it."""
NEEDING = ("var", "foreach", "said-foreach")
"""Those of them that have no hidden variable in place of an empty name."""

HIDES = BAD_VALUE.says('The variable "{name}" hides {what}.', "Write another name.", "warning")
NOT_A_NAME = BAD_VALUE.says(
    '"{name}" is not a name in ECMAScript: a run throws error.semantic.',
    "Write letters, digits and _, and no word that ECMAScript has for itself.",
    "warning",
)
RESERVED_NAME = BAD_VALUE.says(
    '"{name}" is reserved, as names that begin with _ or end with $: a run throws error.semantic.',
    "Write another name.",
    "warning",
)
SCOPED_NAME = BAD_VALUE.says(
    '"{name}" names a scope, which a declaration cannot: a run throws error.semantic.',
    "Declare it without the scope, in an element of that scope.",
    "warning",
)
WRONG = {"not a name": NOT_A_NAME, "reserved": RESERVED_NAME, "scope": SCOPED_NAME}

READ_ONLY = BAD_VALUE.says(
    '"{name}" cannot be assigned, as the session is read-only: a run throws error.semantic.',
    "Assign a variable of your own.",
    "warning",
)

NO_VARIABLE = BAD_VALUE.says(
    '"{name}" names no variable: a run throws error.semantic.',
    "Write the name of a variable, or of a part of its value.",
    "warning",
)


def check_script_names(script: Node) -> Iterator[Problem]:
    """Variables of a script that hide the platform's scopes (5.1.2)."""
    reported: set[str] = set()
    for use in script_names(script.own_text).uses:
        if use.declares and not use.holder and use.name in HIDING.keys() - reported:
            reported.add(use.name)
            yield _hides(script.source.inside(script.index, "", use.start), use.name)


def _hides(place: Place, name: str) -> Problem:
    return HIDES.at(place, name=name, what=HIDING[name])


def check_name(node: Node) -> Iterator[Problem]:
    """A variable that no expression can name, or whose name is the platform's (5.1.1)."""
    attribute = NAMING.get(node.key, "")
    name = node.get(attribute)
    if attribute not in node.attributes or (not name and node.key not in NEEDING):
        return
    place = node.attribute_place(attribute)
    if name in HIDING:
        yield _hides(place, name)
    elif wrong := wrong_name(name):
        yield WRONG[wrong].at(place, name=name)


def check_assigned(node: Node) -> Iterator[Problem]:
    """An assignment to a variable of the session, which is read-only (5.1.2), or to none."""
    name = node.get("name")
    if name.startswith("session."):
        yield READ_ONLY.at(node.attribute_place("name"), name=name)
    elif "name" in node.attributes and PLACE.fullmatch(name) is None:
        yield NO_VARIABLE.at(node.attribute_place("name"), name=name)


def check_listed(node: Node) -> Iterator[Problem]:
    """Names in a list of variables that none can have."""
    for name in node.get("namelist").split():
        if PLACE.fullmatch(name) is None:
            yield NO_VARIABLE.at(node.attribute_place("namelist"), name=name)
