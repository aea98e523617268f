"""The meaning of names: which attributes define them, refer to them, or name files."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Use:
    """The reference in an attribute's value: the kinds of names, and the notation.

    ``how`` is empty, ``#`` (behind a ``#``), ``list`` (several with spaces) or ``uri``
    (a file, a ``#`` and a name).
    """

    kinds: tuple[str, ...]
    how: str = ""


_FORM, _POINT = Use(("form",), "#"), Use(("place", "thing"))
_VARIABLES = Use(("variable",), "list")

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
    **{
        ("voicexml", key, "name"): "variable"
        for key in (
            *("var", "field", "block", "initial", "record", "object", "subdialog"),
            *("transfer", "data"),
        )
    },
    **{("voicexml", key, "item"): "variable" for key in ("foreach", "said-foreach")},
    **{("voicexml", key, "event"): "event" for key in ("throw", "link", "return", "choice")},
    ("srgs", "rule", "id"): "rule",
}
"""Attributes that define a name, by vocabulary and key of the element."""

REFERS: dict[tuple[str, str, str], Use] = {
    ("dialogue", "goto", "next"): _FORM,
    ("dialogue", "link", "next"): _FORM,
    ("dialogue", "subdialog", "src"): _FORM,
    ("dialogue", "goto", "nextitem"): Use(("variable",)),
    ("dialogue", "assign", "name"): Use(("variable",), "code"),
    **{("dialogue", key, "namelist"): _VARIABLES for key in ("clear", "return", "filled")},
    ("dialogue", "ruleref", "uri"): Use(("rule",), "#"),
    ("dialogue", "grammar", "root"): Use(("rule",)),
    ("dialogue", "on", "event"): Use(("event",), "list"),
    ("dialogue", "topological-move", "to"): Use(("place",)),
    **{
        ("dialogue", key, "toward"): _POINT
        for key in ("turn-and-speak", "set-direction", "point-by-hand")
    },
    ("dialogue", "gesture", "name"): Use(("gesture",)),
    ("dialogue", "command", "type"): Use(("command",)),
    ("dialogue", "send", "to"): Use(("service",)),
    ("world", "way", "from"): Use(("place",)),
    ("world", "way", "to"): Use(("place",)),
    ("robot", "adds", "devices"): Use(("device",), "list"),
    ("robot", "allows", "command"): Use(("command",)),
    ("robot", "substitute", "command"): Use(("command",)),
    ("robot", "substitute", "by"): Use(("command",)),
    ("scenario", "robot", "at"): Use(("place",)),
    ("scenario", "person", "at"): _POINT,
    ("scenario", "walk", "to"): _POINT,
    ("scenario", "look", "at"): _POINT,
    ("scenario", "touch", "sensor"): Use(("sensor",)),
    ("scenario", "fail", "device"): Use(("device",)),
    ("scenario", "repair", "device"): Use(("device",)),
    ("scenario", "when", "doing"): Use(("command",)),
    ("scenario", "when", "done"): Use(("command",)),
    ("scenario", "when", "on"): Use(("event",)),
    ("scenario", "unload", "application"): Use(("application",)),
    ("scenario", "service", "application"): Use(("application",)),
    ("scenario", "message", "to"): Use(("application",)),
    ("scenario", "when", "person"): Use(("person",)),
    ("scenario", "answer", "person"): Use(("person",)),
    ("voicexml", "goto", "next"): Use(("form",), "uri"),
    ("voicexml", "link", "next"): Use(("form",), "uri"),
    ("voicexml", "choice", "next"): Use(("form",), "uri"),
    ("voicexml", "submit", "next"): Use(("form",), "uri"),
    ("voicexml", "subdialog", "src"): Use(("form",), "uri"),
    ("voicexml", "goto", "nextitem"): Use(("variable",)),
    ("voicexml", "assign", "name"): Use(("variable",), "code"),
    **{
        ("voicexml", key, "namelist"): _VARIABLES
        for key in (
            "clear",
            "return",
            "filled",
            "submit",
            "subdialog",
            "exit",
            "disconnect",
            "data",
        )
    },
    ("voicexml", "catch", "event"): Use(("event",), "list"),
    ("srgs", "ruleref", "uri"): Use(("rule",), "uri"),
    ("voicexml", "grammar", "root"): Use(("rule",)),
    ("srgs", "grammar", "root"): Use(("rule",)),
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

SHARED = frozenset(
    [
        *("place", "thing", "sensor", "device", "gesture", "command", "service"),
        *("application", "event", "reading"),
    ]
)
"""Kinds of names that documents of one scenario share."""
