"""Behaviour that rules of mediation refuse, delay or repeat."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

NOT_IN_UNIT = Diagnosis(
    "not-in-unit",
    "Command that cannot be part of a unit",
    (
        "A unit is indivisible (rule U4). A Command that works in loops is "
        "many pieces, and one that leaves the user must be able to wait for them. Handlers "
        "that a unit reaches by an event thrown in it, such as noinput, belong to it (rule "
        "U5). An expression that names the event counts as the texts that it, or the variable "
        "that it is, may give; else as any event."
    ),
    rule="U4, U5",
)

NOW_INSIDE = Diagnosis(
    "now-inside",
    "Command wanted now inside a unit",
    (
        "A Command wanted now cancels what the application does on its devices; inside a par, "
        "seq or iu it must come first."
    ),
    rule="O2",
)

LONG_UNIT = Diagnosis(
    "long-unit",
    "Long unit",
    (
        "While a unit runs, no reaction can use its devices. Divide its speech "
        "into pieces at semantic breakpoints (thesis 4.5). A unit whose speech takes longer than "
        "its longest duration never ends by itself (rule U5)."
    ),
    rule="thesis, 4.5",
    severity="warning",
)

UNIT_PRICE = Diagnosis(
    "unit-price",
    "What a unit costs others",
    (
        "While a unit runs, a reaction that needs one of its devices waits for its end. The "
        "note says how long that may take on the robot of the demo: its speech and its "
        "gestures; a question in it may take as long as longest says. prima validate --notes "
        "prints such notes."
    ),
    rule="U4",
    severity="note",
)

SHARED_DEVICE = Diagnosis(
    "shared-device",
    "Branches that share a device",
    (
        "Branches of a par that need one device cannot run at once: they run one after the "
        "other, in document order (rule U3)."
    ),
    rule="U3",
    severity="warning",
)

ENDLESS = Diagnosis(
    "endless",
    "Endless behaviour",
    (
        "The Command never ends, and the state handles no event that could end it, or forms "
        "lead to each other without waiting; equal behaviours of another application may "
        "starve (rule E4). Or the handler of a Command's end is a reaction "
        '(reactive="true") whose own end leads to it again: the latest reaction goes first '
        "(rule S2b), so that others' "
        "reactions are never answered."
    ),
    rule="E4",
    severity="warning",
)

TOLD_TWICE = Diagnosis(
    "told-twice",
    "Said twice",
    (
        "An event may come while a state says or asks something, and its handler leads back "
        "to the beginning of that state, directly or by way of others, of subdialogs that ask "
        "nothing and of further VoiceXML documents, or it goes to an item of that state which "
        "is then visited again: the same is said twice (rule O3). If a question is asked on "
        "the way back, the handler keeps data of the event, or a question is asked anew as its "
        "user has gone (human.lost), that is intended. The target of "
        "an expression is known if the expression is a text or chooses between texts; otherwise "
        "any state whose name begins like the expression may be next, and the warning says that "
        "the same may be said twice."
    ),
    rule="O3",
    severity="warning",
)

UNREACHABLE = Diagnosis(
    "unreachable",
    "Unreachable form or place",
    (
        "No goto, link or subdialog leads to the form, so its content never runs. Or no way "
        "of a world leads to a place: the robot gets there only if it sees it."
    ),
    severity="warning",
)
