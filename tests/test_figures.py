"""The behaviour tables of the thesis (chapter 5) come out of the demo documents.

Quoted texts, Commands, owners, events and their order are compared. Left free are
rows that narrate, the resumption of a starred row, and Stop Moving, which has no
row of its own in the thesis.
"""

from __future__ import annotations

import pytest

from prima import api
from prima.transcript.table import Row

FA, EA = "follow", "navigate"
Told = tuple[str, ...]

FIGURE_5_1: list[Told] = [
    ("touch",),
    ("says", FA, "What's the matter with you?"),
    ("user", "Come on, follow me."),
    ("active-sensing-human", FA, "Where are you?"),
    ("goal", FA),
    ("says", FA, "I found you, I'll start following you."),
    ("tracking-human", FA),
    ("touch",),
    ("says", FA, "May I stop following you?"),
    ("user", "Yes."),
    ("says", FA, "O.K. I'll stop following you."),
]

FIGURE_5_2: list[Told] = [
    ("says", EA, "Where are you going?"),
    ("user", "Prof. Kidode's room."),
    ("says", EA, "Come on, let's go."),
    ("topological-move", EA),
    ("message",),
    ("says", EA, "I've just got a message."),
    ("says", EA, "I'm Kidode, I'll be about 5 minutes late because of a meeting now."),
    ("says", EA, "Do you have a reply?"),
    ("user", "Yes. I see. I'll wait in your room."),
    ("says", EA, "O.K. I'll send your message."),
    ("corner",),
    ("point-by-hand", EA),
    ("turn-and-speak", EA, "The room of Prof. Kidode is over there."),
    ("goal", EA),
    ("says", EA, "I've just reached the goal."),
]

FIGURE_5_3: list[Told] = [
    ("says", EA, "Where are you going?"),
    ("user", "Prof. Kidode's room."),
    ("says", EA, "Come on, let's go."),
    ("topological-move", EA),
    ("touch",),
    ("says", FA, "What's the matter with you?"),
    ("user", "Come on, follow me."),
    ("active-sensing-human", FA, "Where are you?"),
    ("message",),
    ("says", EA, "I've just got a message."),
    (
        "says",
        EA,
        "I'm Kidode, I'll be about five minutes late for my appointment because I'm still in a"
        " meeting.",
    ),
    ("says", EA, "Do you have a reply?"),
    ("user", "Yes. I see. I'll wait in your room."),
    ("says", EA, "O.K. I'll send your message."),
    ("goal", FA),
    ("says", FA, "I found you, I'll start following you."),
    ("tracking-human", FA),
    ("touch",),
    ("says", FA, "May I stop following you?"),
    ("user", "Yes."),
    ("says", FA, "O.K. I'll stop following you."),
    ("goal", EA),
    ("says", EA, "I've just reached the goal."),
]


def told(rows: list[Row]) -> list[Told]:
    """Rows as the figures tell them, without what is free."""
    made: list[Told] = []
    started: set[tuple[str, str]] = set()
    for row in rows:
        if row.kind in ("note", "load", "unload") or row.resumed:
            continue
        if row.kind in ("speak", "q-and-a"):
            made.append(("says", row.app, row.what.strip('"')))
        elif row.kind == "speech":
            made.append(("user", row.what.strip('"')))
        elif row.kind.startswith("goal "):
            made.append(("goal", row.app))
        elif row.event:
            made.append((row.kind.partition(".")[0],))
        elif row.star and (row.app, row.kind) in started:
            continue  # the move is asked for anew after the message: a resumption to the reader
        else:
            started.add((row.app, row.kind))
            _, saying, text = row.what.partition(', saying "')
            made.append((row.kind, row.app, text.strip('"')) if saying else (row.kind, row.app))
    return made


@pytest.mark.parametrize(
    ("scenario", "figure"),
    [
        ("follow-alone", FIGURE_5_1),
        ("navigate-alone", FIGURE_5_2),
        ("follow-during-navigation", FIGURE_5_3),
    ],
)
def test_the_run_gives_the_figure(scenario: str, figure: list[Told]) -> None:
    transcript = api.rehearse(api.documents_folder() / "scenarios" / f"{scenario}.xml")
    assert told(transcript.rows()) == figure
    assert transcript.failures == []


def test_figure_5_3_resumes_the_search_and_then_the_move() -> None:
    """Rows 16 and 27: the search goes before the move, which comes last of all."""
    path = api.documents_folder() / "scenarios" / "follow-during-navigation.xml"
    rows = api.rehearse(path).rows()
    order = [row.what for row in rows]
    sent = order.index('"O.K. I\'ll send your message."')
    search = next(index for index, row in enumerate(rows) if row.resumed and row.app == FA)
    move = max(index for index, row in enumerate(rows) if row.kind == "topological-move")
    finished = order.index('"O.K. I\'ll stop following you."')
    assert sent < search < finished < move
    assert rows[search].rule == "F2"


def test_without_mediation_figure_5_3_does_not_come_out() -> None:
    """The figure is the mediator's doing, not the documents'.

    ``fair`` is left out: taking turns happens to give this order of rows here.
    """
    path = api.documents_folder() / "scenarios" / "follow-during-navigation.xml"
    for policy in ("fifo", "fixed", "fixed:navigate", "none"):
        assert told(api.rehearse(path, policy).rows()) != FIGURE_5_3, policy
