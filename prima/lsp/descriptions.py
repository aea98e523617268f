"""Descriptions of VoiceXML's attributes, events, rules and variables for hover and completion."""

from __future__ import annotations

VOICEXML_ATTRIBUTES = {
    "accept": "exact: all of the words; approximate: some of them",
    "application": "the application's root document",
    "array": "an expression that gives the array",
    "bargein": "whether the user may answer before it ends",
    "bargeintype": "whether any speech ends it, or only what a grammar takes (hotword)",
    "beep": "whether a tone announces the recording",
    "bridge": "whether the user comes back after the call",
    "charset": "the file's encoding",
    "cond": "a condition; it counts only while this is true",
    "connecttimeout": "how long to wait for an answer to the call",
    "count": "used from this occurrence on",
    "dest": "the URI to connect to",
    "destexpr": "an expression that gives the URI to connect to",
    "dtmf": "keys that mean the same",
    "dtmfterm": "whether a key ends the recording",
    "enctype": "how the values are written",
    "event": "the event's name",
    "eventexpr": "an expression that gives the event's name",
    "expr": "an ECMAScript expression",
    "expritem": "an expression that gives the name of the form item",
    "fetchaudio": "what is played while the document is fetched",
    "fetchhint": "when the document may be fetched",
    "fetchtimeout": "how long to wait for the document",
    "finalsilence": "how much silence ends the recording",
    "id": "its name",
    "item": "the variable of the element",
    "maxage": "how old a cached copy may be",
    "maxstale": "how long past its time a cached copy may be used",
    "maxtime": "how long at most",
    "message": "more about the event",
    "messageexpr": "an expression that gives more about the event",
    "method": "how values are sent: get or post",
    "modal": "whether only its own grammars are active",
    "mode": "when all or any are filled; or what the grammar takes: voice or dtmf",
    "name": "the name",
    "namelist": "names of variables, separated by spaces",
    "next": "where to go: #DIALOG, FILE or FILE#DIALOG",
    "nextitem": "the form item to go on with",
    "repeat": "how often: 2, 0-1, 1-",
    "root": "the rule to begin with",
    "scope": "where it is active: in its dialog or in the document",
    "slot": "the part of the meaning that fills it",
    "special": "NULL, VOID or GARBAGE",
    "src": "a URI",
    "srcexpr": "an expression that gives a URI",
    "tag-format": "what language the tags are in",
    "timeout": "how long to wait for an answer",
    "type": "its type",
    "uri": "a URI; # and the name of a rule of this grammar",
    "value": "the value, as text",
    "version": "the language's version",
    "weight": "how likely it is, beside others",
    "xml:base": "what relative URIs are relative to",
    "xml:lang": "the language, as in en or ja",
}
"""VoiceXML's and SRGS's attributes, in a phrase each."""

EVENTS = {
    "touch": "The user touches a sensor of the robot.",
    "message": "A message arrives from the network; event.data has from and text.",
    "human.found": "The camera comes to see the human.",
    "human.lost": "The human is out of sight for a second.",
    "corner": "The robot comes near a corner of the world.",
    "reply": "A service answers what this application has sent.",
    "noinput": "A question has not been answered in time.",
    "nomatch": "A question does not take what was said.",
    "help": "The user asks for help, by a link or throw.",
    "end": "A Command of this application has ended.",
    "cancel": "A Command of this application has been cancelled.",
    "interrupted": "A restartable Command gave way to a reaction (extension x2).",
    "expired": "A reaction of this application was given up, as it came too late (extension x8).",
    "late": "The user answers a question after its time is over (extension x10); event.data.text.",
    "suspended": "Another application keeps the application's suspended stream waiting.",
    "resumed": "The application's stream, which had to wait suspended, has resumed.",
    "emergency.stop": "The emergency stop is pressed.",
    "emergency.release": "The emergency stop is released.",
    "error": "Every error.",
    "error.semantic": "An expression fails, or a Command is asked for in a wrong way.",
    "error.badfetch": "A form, item or document to go to is not there.",
    "error.unsupported": "The robot lacks a Command or one of its devices.",
    "error.device": "A device fails, hangs, or cannot do what it is asked.",
    "error.unit.timeout": "A unit has taken longer than its longest duration.",
    "error.service": "A service fails, or does not exist.",
}
"""Events that every application may handle."""

VOICEXML_EVENTS = {
    "cancel": "The user wants to end what is being said.",
    "exit": "The user wants to end the application.",
    "help": "The user asks for help.",
    "noinput": "Nobody answered in time.",
    "nomatch": "No grammar takes what was said.",
    "maxspeechtimeout": "The user has spoken for too long.",
    "connection.disconnect.hangup": "The user has hung up.",
    "connection.disconnect.transfer": "The user has been transferred for good.",
    "error": "Every error.",
    "error.badfetch": "A document cannot be fetched.",
    "error.semantic": "Something wrong shows only when it is reached.",
    "error.noauthorization": "The request is not allowed.",
    "error.unsupported": "The platform lacks something.",
    "error.unsupported.format": "A format that is not supported.",
}
"""Events that a VoiceXML document may catch."""

RULES = {
    "C6": "An application may define an event by a condition on sensor values. It is raised when"
    " the condition turns true, and again once it has turned false.",
    "O3": "Leaving a state deletes its Commands that have not started and ends its feedback"
    " Commands after the loop that runs; a running Atomic Behavior finishes.",
    "O4": "Content runs in document order. Consecutive Commands are one sequence; other"
    " content after them runs at their end.",
    "U3": "Commands that are sent at once are one tree, each the child of the one before; branches"
    " that need one device run one after the other.",
    "U4": "Commands that are grouped as one unit are one Atomic Behavior, which has all their"
    " devices from its first to its last.",
    "U5": "A unit may span questions and states. It starts when all its devices are free and keeps"
    " them until it is left.",
    "V1": "An event goes to every application. What the user says goes first to the question that"
    " listens, then to what applications listen for all the time.",
}
"""Short versions of the rules of docs/mediation.md that elements refer to."""

SESSION = {
    "event": "the event that is being handled: name, data, message",
    "_event": "the name of the event that is being handled",
    "_message": "the message of the error that is being handled",
    "sensor": "the values of the robot's sensors",
    "session": "what is known of the session",
    "application": "the variables of the application",
    "document": "the variables of the document",
    "dialog": "the variables of the form",
}
"""Predefined variables."""
