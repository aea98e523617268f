"""The situations that show each rule: a scenario, and what to look at in its run."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RuleExample:
    """A run that shows a rule.

    ``scenario`` is a path in the documents that come with PRIMA; ``look`` says what to see.
    ``row`` is a part of the important row; by default the first row that the rule selected.
    """

    scenario: str
    look: str
    row: str = ""
    policy: str = ""


DEMO, WAY = "scenarios/follow-during-navigation.xml", "scenarios/touched-on-the-way.xml"
TOUR, TEA = "tutorial/interleaved.xml", "tutorial/channel.xml"
TREES, ORDER = "tutorial/trees.xml", "rules/order.xml"
EXAMPLES: dict[str, RuleExample] = {
    "U1": RuleExample(TOUR, "Each Command of tour is one AB, with a row of its own.", "Welcome"),
    "U2": RuleExample(
        WAY,
        "The move is a chain of loops: the reaction comes between two of them, and the move starts"
        " afresh after it.",
        "resumes Topological Move",
    ),
    "U3": RuleExample(
        TOUR,
        "Pointing and speaking are branches and start together; the last sentence waits for both.",
        "Point by Hand",
    ),
    "U4": RuleExample(
        "scenarios/emotions-alone.xml",
        "A gesture and its words are one AB; no reaction divides it.",
    ),
    "U5": RuleExample(
        "scenarios/picture-alone.xml",
        "From the question to the picture nothing else gets speaker or camera.",
    ),
    "U6": RuleExample(
        TOUR, "The touch comes within a sentence, and the sentence is finished.", "touches"
    ),
    "O1": RuleExample(
        TOUR, "tour's Commands follow one another; the reaction of hello is a new tree.", "very new"
    ),
    "O2": RuleExample(
        DEMO,
        "Stop Moving is wanted now: the tracking of its own application is cancelled.",
        "May I stop",
    ),
    "O3": RuleExample(
        DEMO,
        "The user is found, the application goes to another state, and its search ends.",
        "I found you",
    ),
    "O4": RuleExample(
        TREES, "The sentence follows the move in the document, so it comes after it.", "Here we"
    ),
    "S1": RuleExample(
        TOUR, "hello waits until the sentence that runs frees the speaker.", '"Yes, friend?"'
    ),
    "S2": RuleExample(
        TOUR,
        "hello and tour want the speaker in one instant; hello is a reaction.",
        '"Yes, friend?"',
    ),
    "S2a": RuleExample(
        DEMO, "The reaction speaks, which has high priority; the move's next loop has low priority."
    ),
    "S2b": RuleExample(TOUR, "hello reacts to the touch, so it goes before the rest of tour."),
    "S2c": RuleExample(ORDER, "The conversation goes on with its next question; tour waits."),
    "S2d": RuleExample(
        "rules/unwound.xml", "The topic of tour was broken, and trains has not begun: tour goes on."
    ),
    "S2e": RuleExample(ORDER, "tour asked for the speaker at 0.00 s, trains at 0.60 s."),
    "S2f": RuleExample(ORDER, "tea and tour ask at once; the scenario names tea first."),
    "S3": RuleExample(
        "rules/held.xml",
        "The reaction needs neck and speaker. The neck is free at 0.50 s, and is kept for it.",
        '"Hello."',
    ),
    "S4": RuleExample(TOUR, "The arm points while the speaker speaks.", "Point by Hand"),
    "S5": RuleExample(
        "rules/topic.xml", "Run it twice: the transcripts are the same, byte for byte.", "forty two"
    ),
    "C1": RuleExample(
        TOUR, "The stream of hello ends with its last AB; the floor is given back.", "Point by Hand"
    ),
    "C2": RuleExample(
        TOUR, "tour goes on with what it had not started, and says nothing twice.", "Point by Hand"
    ),
    "C3": RuleExample(
        TREES,
        "What walk asks for in the window of the answer belongs to the same stream.",
        '"Yes."',
    ),
    "C4": RuleExample(
        ORDER, 'The answer "No." ends the question, and opens a window.', "With milk"
    ),
    "C5": RuleExample(
        TOUR,
        "A touch comes from the user, so what answers it is a reaction; goto does not change that.",
        "touches",
    ),
    "C6": RuleExample(
        "scenarios/emotions-alone.xml",
        "The application watches its sensors: its condition raises an event of its own.",
        "battery.low",
    ),
    "F1": RuleExample(
        TOUR, "hello takes the floor; all of tour waits, arm and speaker.", "Yes, friend"
    ),
    "F2": RuleExample(
        "rules/unwound.xml",
        "lights reacts to another event than hello, so it may break into the topic of hello.",
        "It is dark",
    ),
    "F3": RuleExample(
        "rules/unwound.xml",
        "When the stream of lights ends, the floor falls back to that of hello.",
        "Gesture",
    ),
    "F4": RuleExample(
        ORDER, "No reaction began, so nobody has the floor: S2 alone decides.", "Welcome, visitor"
    ),
    "F5": RuleExample(
        WAY, "The next loop of the move is held back, so the robot is stopped.", "What's the matter"
    ),
    "F6": RuleExample(
        "rules/topic.xml",
        "trains wants to speak at 0.60 s. It is not a reaction, so it waits for both halves of the"
        " sentence.",
        "forty two",
    ),
    "K1": RuleExample(
        "rules/leaving.xml",
        "errand wants to drive away at 0.60 s; it waits until the conversation of tea is over.",
    ),
    "K2": RuleExample(
        TEA, "Driving has low priority, so the question of tea goes before it.", "With milk"
    ),
    "K3": RuleExample(
        DEMO,
        "The message is read out though the user is elsewhere; under prima+x4 the robot turns to"
        " them first.",
        "I've just got a message",
    ),
    "V1": RuleExample(DEMO, "The question that listens takes the answer.", "Prof. Kidode's room"),
    "V2": RuleExample(
        TEA, "The touch comes within a question; the reaction waits for the answer.", "One moment"
    ),
    "V3": RuleExample(
        ORDER,
        "The answer ends the question; only then is it selected who speaks next.",
        "With milk",
    ),
    "V4": RuleExample(DEMO, "The search has found the user, and raises human.found once.", "finds"),
    "E1": RuleExample("rules/device.xml", "tour's arm fails; trains goes on.", "fails: the device"),
    "E2": RuleExample("rules/device.xml", "tour ends, and trains gets the speaker.", "ends tour"),
    "E3": RuleExample(
        "rules/refused.xml", "The Command is refused, and its application gets an event."
    ),
    "E4": RuleExample(
        "scenarios/leaving-the-museum.xml",
        "Tracking Human goes on for ever; whoever waits for it is reported.",
    ),
    "E5": RuleExample(
        "rules/stopped.xml", "Everything ends at 2.00 s, and goes on at 4.00 s.", "pressed"
    ),
    "E6": RuleExample(
        "rules/patience.xml",
        "trains wants to speak at 0.60 s. barker goes on by S2c, for 5 s; then it is trains' turn"
        " at the next end of a sentence, and barker goes on afterwards.",
        '"I like trains',
    ),
    "X1": RuleExample(
        "scenarios/situations/s07.xml",
        "The robot goes back to where it was before the topic is resumed.",
        "[inserted, X1]",
        "prima+x1",
    ),
    "X2": RuleExample(
        "scenarios/situations/s10.xml",
        "What is marked restartable is broken off, and starts again afterwards.",
        "breaks off",
        "prima+x2",
    ),
    "X3": RuleExample(
        "scenarios/situations/s05.xml",
        "The application waits for its server, and nobody else changes the topic meanwhile.",
        policy="prima+x3",
    ),
    "X4": RuleExample(
        DEMO, "The robot turns to the user before it speaks.", "[inserted, X4]", "prima+x4"
    ),
    "X5": RuleExample("scenarios/dance-while-guiding.xml", "The robot dances on its way."),
    "X6": RuleExample(
        "scenarios/navigate-by-laser.xml", "A robot without arms points with its laser.", "aser"
    ),
    "X7": RuleExample(
        "scenarios/politeness/third-turn.xml",
        "The library says its word to the answer before the robot reacts to the touch.",
    ),
    "X8": RuleExample(
        "scenarios/politeness/fresh-reaction.xml",
        "The words are given up after three seconds, and the robot nods at once.",
        "Gesture",
    ),
    "X9": RuleExample(
        "scenarios/politeness/in-words.xml",
        "The explanation says that it goes on.",
        "[inserted, X9]",
    ),
    "X10": RuleExample(
        "scenarios/politeness/late-answer.xml",
        "The answer goes to the library, which has asked, and not to the dancer, which is asking.",
        '"Yes."',
    ),
    "fifo": RuleExample(
        TOUR, "The reaction waits for all that was asked for earlier.", "Yes, friend", "fifo"
    ),
    "fair": RuleExample(
        TOUR, "The applications take turns, sentence by sentence.", "Yes, fr", "fair"
    ),
    "fixed": RuleExample(
        TOUR, "hello was declared first, and always goes first.", "Yes, fr", "fixed"
    ),
    "none": RuleExample(TOUR, "The two speak at once.", "loses", "none"),
}
"""The example of each rule."""
