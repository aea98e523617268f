"""The messages that applications, mediator and devices exchange; there are no others.

Applications make requests (:class:`Request`, :class:`OpenUnit`, :class:`CloseUnit`,
:class:`LeaveState`, :class:`Send`, ...), the mediator gives devices orders
(:class:`Order`), and events come in as one of the :data:`Inbound` values.
All of them are plain data: the receiver decides what they mean.
"""

from __future__ import annotations

from prima.messages.actions import (
    Action,
    CloseUnit,
    GoOn,
    LeaveState,
    OpenUnit,
    Promote,
    Quit,
    Raise,
    Request,
    Say,
    Send,
)
from prima.messages.commands import (
    BEEP,
    NO_DEVICES,
    PROMOTED,
    SERVICE,
    STOPS,
    Command,
    Cue,
    Data,
    Fate,
    Group,
    Json,
    Record,
    Step,
    Verb,
    line_of,
)
from prima.messages.inbound import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Delayed,
    Emergency,
    Ended,
    Failed,
    Fetched,
    Halted,
    Heard,
    Hypothesis,
    Inbound,
    Listening,
    Narrated,
    Occurred,
    Presence,
    Sensed,
    Transferred,
    Understood,
)
from prima.messages.orders import Event, Notice, Order

__all__ = [
    "BEEP", "NO_DEVICES", "PROMOTED", "SERVICE", "STOPS", "Action", "ApplicationLoaded",
    "ApplicationUnloaded", "CloseUnit", "Command", "Cue", "Data", "Delayed", "Emergency", "Ended",
    "Event", "Failed", "Fate", "Fetched", "GoOn", "Group", "Halted", "Heard", "Hypothesis",
    "Inbound", "Json", "LeaveState", "Listening", "Narrated", "Notice", "Occurred", "OpenUnit",
    "Order", "Presence", "Promote", "Quit", "Raise", "Record", "Request", "Say", "Send", "Sensed",
    "Step", "Transferred", "Understood", "Verb", "line_of",
]  # fmt: skip
