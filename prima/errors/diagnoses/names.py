"""Unknown names of forms, variables, events, Commands and files."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

NO_SUCH_FORM = Diagnosis(
    "no-such-form",
    "Unknown form",
    "A goto, subdialog or link names a form that does not exist.",
    rule="VoiceXML 2.0, 5.3.7",
)

NO_SUCH_ITEM = Diagnosis(
    "no-such-item",
    "Unknown form item",
    "No item of the form has the name.",
    rule="VoiceXML 2.0, 5.3.7",
)

NO_SUCH_NAME = Diagnosis(
    "no-such-name",
    "Unknown name",
    (
        "A scenario, world or application names a place, thing, gesture, sensor, device or "
        "application that the world, robot or scenario does not have."
    ),
)

NO_SUCH_ARGUMENT = Diagnosis(
    "no-such-argument",
    "Unknown argument",
    "A Command is given an argument that the robot's profile does not name.",
    rule="thesis, Table 4.1",
)

RELATIVE = "Its name is read relative to the document that names it."
"""The remedy for a file that is not there, and is like none."""
NO_SUCH_FILE = Diagnosis(
    "no-such-file",
    "Unreadable file",
    (
        "A scenario or a grammar names a file that cannot be read. Paths are relative to the "
        "folder of the document that names them."
    ),
)

UNDECLARED_VARIABLE = Diagnosis(
    "undeclared-variable",
    "Undeclared variable",
    (
        "An expression uses, or an assign changes, a variable that no <var>, form item, "
        "<foreach> or <script> declares. At run time that is error.semantic. In VoiceXML so is "
        "a param of a subdialog that no <var> of the called form declares, a variable of one "
        "<block> in another, a variable declared only later, and an undeclared member of "
        "document or another scope that is assigned to, or whose own member is read. A "
        "grammar's tag uses a name that no tag of the grammar declares: at run time such an "
        "answer does not match. In VoiceXML and in tags, a variable that typeof tests anywhere "
        "may be missing. A misspelt part of event.data is undefined; so is in PRIMA's own language "
        "a member of document, dialog or application that nothing declares. So is a misspelt part "
        "of sensor.human or sensor.position; and a <watch> that reads a part of another sensor "
        "without ?. fails until there is a value."
    ),
    rule="VoiceXML 2.0, 5.1",
)
NO_MEMBER = UNDECLARED_VARIABLE.says(
    'The scope "{scope}" declares no variable "{name}": this will be error.semantic.',
    'Declare it there: <var name="{name}"/>.',
    "warning",
)

BAD_EXPRESSION = Diagnosis(
    "bad-expression",
    "Not ECMAScript",
    (
        "An expression or a script is not ECMAScript. The place is where the compiler stopped. In a "
        "grammar, {a: 1} as a whole tag is a statement with a label, and the value stays as it was, as "
        "does that of n where n++ is assigned to n."
    ),
    rule="ECMAScript",
)

FA_ONLY = Diagnosis(
    "fa-only",
    "Argument for FAs only",
    (
        "Additional arguments (thesis Table 4.1) are for an FA, whose developer knows the "
        "robot. An EA runs on any robot."
    ),
    rule="thesis, Table 4.1",
)

UNSUPPORTED_COMMAND = Diagnosis(
    "unsupported-command",
    "Unsupported Command",
    (
        "The robot's profile lacks the Command or one of its devices. At run time the "
        "application gets error.unsupported.COMMAND, which it may handle. A <command> of a type "
        "that the profile does not add is an error; where a VoiceXML document asks for it, it is "
        "error.semantic. Each Command of a document is reported once, with the number of places. "
        "A scenario waits for it in vain."
    ),
    rule="E1, E3",
    severity="warning",
)

UNKNOWN_EVENT = Diagnosis(
    "unknown-event",
    "Unknown event",
    (
        "A handler names an event that nothing raises, most likely a typo, or one that never "
        "reaches it in a Command; given a scenario, "
        "also an event of a corner that its world does not have. An application's own events "
        "come from throw, send, link, watch, a return, or a scenario."
    ),
    rule="VoiceXML 2.0, 5.2",
    severity="warning",
)

UNHEARD_EVENT = Diagnosis(
    "unheard-event",
    "Event without a handler",
    (
        "An event is raised, and no handler takes it, or a form throws one that only handlers of "
        "other forms take. It is lost; one that is thrown ends the application."
    ),
    rule="VoiceXML 2.0, 5.2",
    severity="warning",
)
