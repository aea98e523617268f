"""The meaning of names: which attributes define them, refer to them, or name files."""

from __future__ import annotations

from dataclasses import dataclass

from prima.sim.vocabulary.scenario import NAMING_APPLICATIONS
from prima.voicexml.arranging import UNIT
from prima.voicexml.checks import NAMING
from prima.voicexml.reads import LISTING


@dataclass(frozen=True, slots=True)
class ReferenceUse:
    """The reference in an attribute's value: the kinds of names, and the notation.

    ``how`` is empty, ``#`` (behind a ``#``), ``fixed:`` (behind that word), ``list`` (several with
    spaces), ``uri`` (a file, a ``#`` and a name) or ``code``. Variables of a list are code, too: ``document.x``.
    """

    kinds: tuple[str, ...]
    how: str = ""


_FORM, _POINT = ReferenceUse(("form",), "#"), ReferenceUse(("place", "thing"))
_DIALOG, _RULE = ReferenceUse(("form",), "uri"), ReferenceUse(("rule",), "uri")
_VARIABLES = ReferenceUse(("variable",), "list")
_EXPECTED = {
    "state": ReferenceUse(("form",)),
    "sends": ReferenceUse(("service",)),
    **dict.fromkeys(("does", "finishes", "doing", "done"), ReferenceUse(("command",))),
    **dict.fromkeys(("event", "on"), ReferenceUse(("event",))),
}
_DONE_BY_USERS = {
    ("walk", "to"): _POINT,
    ("look", "at"): _POINT,
    ("touch", "sensor"): ReferenceUse(("sensor",)),
    ("when", "doing"): ReferenceUse(("command",)),
    ("when", "done"): ReferenceUse(("command",)),
    ("when", "on"): ReferenceUse(("event",)),
}

DEFINES: dict[tuple[str, str, str], str] = {
    ("dialogue", "prima", "id"): "application",
    ("dialogue", "form", "id"): "form",
    ("dialogue", "rule", "id"): "rule",
    **{
        ("dialogue", key, "name"): "variable"
        for key in ("var", "field", "block", "subdialog", "iu-items")
    },
    ("dialogue", "foreach", "item"): "variable",
    ("dialogue", "watch", "name"): "event",
    **{("dialogue", key, "event"): "event" for key in ("throw", "send", "link", "return")},
    ("world", "place", "id"): "place",
    ("world", "thing", "id"): "thing",
    ("world", "corner", "event"): "event",
    ("robot", "touch", "sensor"): "sensor",
    ("robot", "device", "name"): "device",
    ("robot", "gesture", "name"): "gesture",
    ("robot", "adds", "command"): "command",
    ("scenario", "application", "id"): "application",
    ("scenario", "person", "id"): "person",
    ("scenario", "service", "name"): "service",
    ("scenario", "event", "name"): "event",
    ("scenario", "sensor", "name"): "reading",
    ("voicexml", "form", "id"): "form",
    ("voicexml", "menu", "id"): "form",
    **{("voicexml", *one): "variable" for one in NAMING.items() if one[0] != UNIT},
    **{("voicexml", key, "event"): "event" for key in ("throw", "link", "return", "choice")},
    ("srgs", "rule", "id"): "rule",
}
"""Attributes that define a name, by vocabulary and key of the element."""

REFERS: dict[tuple[str, str, str], ReferenceUse] = {
    ("dialogue", "goto", "next"): _FORM,
    ("dialogue", "link", "next"): _FORM,
    ("dialogue", "subdialog", "src"): _FORM,
    ("dialogue", "goto", "nextitem"): ReferenceUse(("variable",)),
    ("dialogue", "assign", "name"): ReferenceUse(("variable",), "code"),
    **{("dialogue", key, "namelist"): _VARIABLES for key in ("clear", "return", "filled")},
    ("dialogue", "ruleref", "uri"): ReferenceUse(("rule",), "#"),
    ("dialogue", "grammar", "root"): ReferenceUse(("rule",)),
    ("dialogue", "grammar", "src"): _RULE,
    ("dialogue", "on", "event"): ReferenceUse(("event",), "list"),
    ("dialogue", "topological-move", "to"): ReferenceUse(("place",)),
    **{
        ("dialogue", key, "toward"): _POINT
        for key in ("turn-and-speak", "set-direction", "point-by-hand")
    },
    ("dialogue", "gesture", "name"): ReferenceUse(("gesture",)),
    ("dialogue", "command", "type"): ReferenceUse(("command",)),
    ("dialogue", "send", "to"): ReferenceUse(("service",)),
    ("world", "way", "from"): ReferenceUse(("place",)),
    ("world", "way", "to"): ReferenceUse(("place",)),
    ("robot", "adds", "devices"): ReferenceUse(("device",), "list"),
    ("robot", "allows", "command"): ReferenceUse(("command",)),
    ("robot", "substitute", "command"): ReferenceUse(("command",)),
    ("robot", "substitute", "by"): ReferenceUse(("command",)),
    ("robot", "place", "name"): ReferenceUse(("place",)),
    ("robot", "does", "gesture"): ReferenceUse(("gesture",)),
    ("robot", "driver", "devices"): ReferenceUse(("device",), "list"),
    ("scenario", "robot", "at"): ReferenceUse(("place",)),
    ("scenario", "person", "at"): _POINT,
    **{(where, *one): use for where in ("scenario", "user") for one, use in _DONE_BY_USERS.items()},
    **{
        ("scenario", tag, one): use for tag in ("expect", "never") for one, use in _EXPECTED.items()
    },
    ("scenario", "fail", "device"): ReferenceUse(("device",)),
    ("scenario", "repair", "device"): ReferenceUse(("device",)),
    **{("scenario", *one): ReferenceUse(("application",)) for one in NAMING_APPLICATIONS},
    ("scenario", "scenario", "policy"): ReferenceUse(("application",), "fixed:"),
    ("scenario", "when", "person"): ReferenceUse(("person",)),
    ("scenario", "answer", "person"): ReferenceUse(("person",)),
    **{("voicexml", key, "next"): _DIALOG for key in ("goto", "link", "choice", "submit")},
    ("voicexml", "subdialog", "src"): _DIALOG,
    ("voicexml", "goto", "nextitem"): ReferenceUse(("variable",)),
    ("voicexml", "assign", "name"): ReferenceUse(("variable",), "code"),
    **{("voicexml", key, "namelist"): _VARIABLES for key in (*LISTING, "filled")},
    ("voicexml", "catch", "event"): ReferenceUse(("event",), "list"),
    ("srgs", "ruleref", "uri"): _RULE,
    ("voicexml", "grammar", "root"): ReferenceUse(("rule",)),
    ("voicexml", "grammar", "src"): _RULE,
    ("srgs", "grammar", "root"): ReferenceUse(("rule",)),
}
"""Attributes that refer to a name, by vocabulary and key of the element."""

FILES: dict[tuple[str, str, str], tuple[str, ...]] = {
    ("scenario", "scenario", "world"): ("world",),
    ("scenario", "scenario", "robot"): ("robot",),
    ("scenario", "application", "src"): ("dialogue", "voicexml"),
    ("scenario", "person", "user"): ("user",),
    ("scenario", "reply", "src"): (),
    ("world", "area", "application"): ("dialogue", "voicexml"),
    ("voicexml", "vxml", "application"): ("voicexml",),
    **{("voicexml", key, "next"): ("voicexml",) for key in ("goto", "submit", "link", "choice")},
    ("voicexml", "subdialog", "src"): ("voicexml",),
    ("voicexml", "grammar", "src"): ("srgs",),
    ("dialogue", "grammar", "src"): ("srgs",),
    ("srgs", "ruleref", "uri"): ("srgs",),
    **{("voicexml", key, "src"): () for key in ("script", "audio", "data")},
}
"""Attributes that name a file, with the vocabularies of documents that fit."""

EVENTS_OF = {
    "touch": "sensor",
    "reply": "service",
    "error.service": "service",
    "error.device": "device",
}
"""Kinds of the names that follow the beginnings of events."""

SHARED = frozenset(
    [
        *("place", "thing", "sensor", "device", "gesture", "command", "service"),
        *("application", "event", "reading"),
    ]
)
"""Kinds of names that documents of one scenario share."""
