"""The behaviour tables of the thesis (chapter 5) come out of the demo documents.

Quoted texts, Commands, owners, events and their order are compared. Left free are
rows that narrate, the resumption of a starred row, and Stop Moving, which has no
row of its own in the thesis. Figures 5.9 and 5.12 come from the documents of
Figures 5.7, 5.8, 5.10 and 5.11: only the scenario is another.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.transcript.row import Row

FA, EA = "follow", "navigate"
TIMER, LIBRARY, PICTURE, MUSEUM = "video-timer", "library", "picture", "museum"
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

TIMER_TALK: list[Told] = [
    ("says", TIMER, "What's the matter with you?"),
    ("user", "Video timer."),
    ("says", TIMER, "Please select a TV channel."),
    ("user", "12."),
    ("says", TIMER, "Please tell me a time to start."),
    ("user", "18."),
    ("says", TIMER, "Please tell me a time to end."),
    ("user", "19."),
    (
        "says",
        TIMER,
        "May I set the video timer to record the 12th channel from 18 o'clock to 19 o'clock?",
    ),
    ("user", "Yes."),
    ("says", TIMER, "Connecting the video server."),
]

BOOK_FOUND: list[Told] = [
    ("reply", LIBRARY),
    ("says", LIBRARY, "Are you searching 'The C Primer' published by ASCII software science?"),
    ("user", "Yes."),
    ("says", LIBRARY, "O.K. Come on."),
    ("topological-move", LIBRARY),
    ("goal", LIBRARY),
    ("says", LIBRARY, "Here is the book you searched for."),
]

FIGURE_5_7: list[Told] = [
    ("touch",),
    *TIMER_TALK,
    ("reply", TIMER),
    ("says", TIMER, "The video setting succeeds."),
]

FIGURE_5_8: list[Told] = [
    ("says", LIBRARY, "Please tell me a title or an author of a book."),
    ("user", "The C Primer."),
    ("says", LIBRARY, "Wait a minute."),
    *BOOK_FOUND,
]

FIGURE_5_9: list[Told] = [
    ("says", LIBRARY, "Please tell me a title or an author of a book."),
    ("touch",),
    *TIMER_TALK,
    ("says", LIBRARY, "Please tell me a title or an author of a book."),
    ("reply", TIMER),
    ("user", "The C Primer."),
    ("says", TIMER, "The video setting succeeds."),
    ("says", LIBRARY, "Wait a minute."),
    *BOOK_FOUND,
]

PICTURE_TALK: list[Told] = [
    ("says", PICTURE, "What's the matter with you?"),
    ("user", "Take a picture."),
    ("says", PICTURE, "Which direction should I turn?"),
    ("user", "Turn to your right."),
    ("turn", PICTURE),
    ("says", PICTURE, "May I take a picture?"),
    ("user", "Yes."),
    ("take-picture", PICTURE),
    ("says", PICTURE, "I just sent a picture."),
    ("says", PICTURE, "May I take another picture?"),
    ("user", "No."),
    ("says", PICTURE, "O.K. Bye-bye."),
]

TOUR_TO_EXPLANATION_1_1: list[Told] = [
    ("says", MUSEUM, "I'm going to start the tour of the museum."),
    ("topological-move", MUSEUM),
    ("goal", MUSEUM),
    ("active-sensing-human", MUSEUM),
    ("goal", MUSEUM),
    (
        "face-human-and-speak",
        MUSEUM,
        "This panel shows research points of our laboratory.",
    ),
]

TOUR_FROM_EXPLANATION_1_2: list[Told] = [
    (
        "turn-and-speak",
        MUSEUM,
        "Take attention to this upper figure. Our laboratory has a project about wearable"
        " computers.",
    ),
    ("active-sensing-human", MUSEUM),
    ("goal", MUSEUM),
    (
        "face-human-and-speak",
        MUSEUM,
        "In addition, we are studying various techniques processing multi-media information in"
        " the real world.",
    ),
    ("says", MUSEUM, "May I repeat the explanation?"),
    ("user", "No."),
    ("says", MUSEUM, "May I go to the next panel?"),
    ("user", "Yes."),
    ("says", MUSEUM, "O.K."),
    ("topological-move", MUSEUM),
]

FIGURE_5_10: list[Told] = [("touch",), *PICTURE_TALK]

FIGURE_5_11: list[Told] = [*TOUR_TO_EXPLANATION_1_1, *TOUR_FROM_EXPLANATION_1_2]

FIGURE_5_12: list[Told] = [
    *TOUR_TO_EXPLANATION_1_1,
    ("touch",),
    *PICTURE_TALK,
    *TOUR_FROM_EXPLANATION_1_2,
]


def path_of(scenario: str) -> Path:
    return api.documents_folder() / "scenarios" / f"{scenario}.xml"


def told(rows: list[Row]) -> list[Told]:
    """Rows as the figures tell them, without what is free."""
    made: list[Told] = []
    started: set[tuple[str, str]] = set()
    for row in rows:
        if row.kind in ("note", "load", "unload", "enters", "leaves") or row.resumed:
            continue
        if row.kind in ("speak", "q-and-a"):
            made.append(("says", row.app, row.what.strip('"')))
        elif row.kind == "speech":
            made.append(("user", row.what.strip('"')))
        elif row.kind.startswith("goal "):
            made.append(("goal", row.app))
            started.discard((row.app, row.kind.removeprefix("goal ")))
        elif row.event:
            kind = row.kind.partition(".")[0]
            made.append((kind, row.app) if row.app else (kind,))
        elif row.star and (row.app, row.kind) in started:
            continue  # asked for anew before its goal was reached: a resumption to the reader
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
        ("video-timer-alone", FIGURE_5_7),
        ("library-alone", FIGURE_5_8),
        ("situations/s05", FIGURE_5_9),
        ("picture-alone", FIGURE_5_10),
        ("situations/s10", FIGURE_5_12),
    ],
)
def test_the_run_gives_the_figure(scenario: str, figure: list[Told]) -> None:
    transcript = api.rehearse(path_of(scenario))
    assert told(transcript.rows()) == figure
    assert transcript.failures == []


def test_the_tour_of_three_panels_begins_with_figure_5_11() -> None:
    transcript = api.rehearse(path_of("museum-alone"))
    rows = told(transcript.rows())
    assert rows[: len(FIGURE_5_11)] == FIGURE_5_11
    assert rows.count(("says", MUSEUM, "May I go to the next panel?")) == 2
    assert transcript.failures == []


def test_figure_5_3_resumes_the_search_and_then_the_move() -> None:
    """Rows 16 and 27: the search goes before the move, which comes last of all."""
    rows = api.rehearse(path_of("follow-during-navigation")).rows()
    order = [row.what for row in rows]
    sent = order.index('"O.K. I\'ll send your message."')
    search = next(index for index, row in enumerate(rows) if row.resumed and row.app == FA)
    move = max(index for index, row in enumerate(rows) if row.kind == "topological-move")
    finished = order.index('"O.K. I\'ll stop following you."')
    assert sent < search < finished < move
    assert rows[search].rule == "F2"


def test_figure_5_9_waits_for_the_question_and_repeats_it() -> None:
    """Rows 3 and 15: the question runs out before the reaction, and is asked again after it."""
    rows = api.rehearse(path_of("situations/s05")).rows()
    asked = [row for row in rows if row.what == '"Please tell me a title or an author of a book."']
    touched = next(row for row in rows if row.kind == "touch.head")
    reaction = next(row for row in rows if row.app == TIMER and row.kind == "q-and-a")
    assert asked[0].time < touched.time < reaction.time - 2 < asked[1].time
    assert reaction.rule == "S2b"


@pytest.mark.parametrize("scenario", ["picture-alone", "situations/s10"])
def test_taking_a_picture_is_one_unit_to_the_last_answer(scenario: str) -> None:
    """Rows 3 to 11 of Figure 5.10, 11 to 19 of Figure 5.12.

    The event of row 8 (16) is the end of the Command, which has no row of its own.
    """
    transcript = api.rehearse(path_of(scenario))
    unit = [row.what for row in transcript.rows() if row.bracket]
    assert unit[0] == '"Which direction should I turn?"'
    assert unit[-1] == '"No."', "the last answer belongs to it"
    assert {row.app for row in transcript.rows() if row.bracket} == {PICTURE, ""}

    def at(phase: str, key: str, value: str) -> int:
        return next(
            index
            for index, record in enumerate(transcript.records)
            if record["phase"] == phase and record.get(key) == value
        )

    assert at("end", "command", "take-picture") < at("start", "text", "I just sent a picture.")
    begun, ended = at("start", "command", "iu"), at("end", "command", "iu")
    assert at("event", "text", "No.") < ended < at("start", "text", "O.K. Bye-bye.")
    others = [
        record
        for record in transcript.records[begun:ended]
        if record["phase"] == "start" and record.get("app") != PICTURE
    ]
    assert others == []


@pytest.mark.parametrize(
    ("scenario", "figure", "policies"),
    [
        ("follow-during-navigation", FIGURE_5_3, ("fifo", "fixed", "fixed:navigate", "none")),
        ("situations/s05", FIGURE_5_9, ("fifo", "fair", "fixed:library", "none")),
        ("situations/s10", FIGURE_5_12, ("fifo", "fair", "fixed:museum", "none")),
    ],
)
def test_without_mediation_the_figure_does_not_come_out(
    scenario: str, figure: list[Told], policies: tuple[str, ...]
) -> None:
    """The figure is the mediator's doing, not the documents'.

    Left out are the policies that happen to give the order: taking turns gives that of
    Figure 5.3, and the FA always first that of Figures 5.9 and 5.12, where the EA reacts
    to nothing while the FA talks.
    """
    for policy in policies:
        assert told(api.rehearse(path_of(scenario), policy).rows()) != figure, policy
