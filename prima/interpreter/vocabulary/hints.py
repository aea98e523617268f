"""Remedies for elements of other languages."""

from __future__ import annotations

from prima.markup.vocabulary import Instead

HINTS: dict[str, str | Instead] = {
    "catch": Instead("on", 'event="..."'),
    "vxml": "Begin with <prima>.",
    "say": Instead("speak"),
    "ask": "Write <field> with a <prompt>.",
    "q-and-a": "Q&A is written as a <field> with a <prompt>.",
    "audio": Instead("speak"),
    "choice": "Write <option> in a <field>.",
    "menu": "Write a <form> with a <field>.",
    **dict.fromkeys(
        (
            *("a", "b", "br", "center", "div", "em", "emphasis", "font", "h1", "h2", "h3", "i"),
            *("li", "p", "phoneme", "prosody", "s", "say-as", "span", "strong", "sub", "u", "ul"),
        ),
        "Speech is plain text: leave the mark out.",
    ),
    "else-if": Instead("elseif"),
    "img": 'Point to a thing: <point-by-hand toward="..."/>.',
    "input": "Write a <field> with a <prompt>.",
    "select": "Write a <field> with an <option> for each answer.",
    "button": 'Write <option> in a <field>, or <on event="touch">.',
    "title": 'Write <meta name="title" content="..."/>.',
    "head": "Leave it out: facts about the document belong in <meta>.",
    "body": "Leave it out: forms belong in <prima>.",
    "html": "Begin with <prima>.",
    **dict.fromkeys(
        ("delay", "silence", "sleep", "wait"),
        'Write <pause time="1s"/>; or, for an event afterwards, <send event="..." delay="1s"/>.',
    ),
    "submit": Instead("send", 'to="..."'),
    "disconnect": Instead("exit", "/"),
    "transfer": Instead("send", 'to="..."'),
    "record": 'Write a <field type="text">.',
    "initial": "Write a <field>, or a <block>.",
    "object": Instead("command", 'type="..."'),
    **dict.fromkeys(("end", "finish", "quit"), Instead("exit", "/")),
    **dict.fromkeys(("repeat", "retry"), Instead("reprompt", "/")),
    **dict.fromkeys(
        ("for", "loop", "while"),
        "Write <foreach>; or go to the form again, with what counts in a variable of the document.",
    ),
    "stop": Instead("stop-moving"),
    "move": Instead("topological-move"),
}
