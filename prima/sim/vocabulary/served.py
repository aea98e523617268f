"""Parts of a scenario besides its users: services and the telephone, as a table."""

from __future__ import annotations

from prima.markup.vocabulary import Element, attribute
from prima.sim.vocabulary.happenings import AFTER

SERVED = (
    Element(
        "service",
        "A service that applications send to. Its replies are given in order; the last repeats. One"
        " without replies accepts messages and does not answer.",
        (
            attribute("name", "id", "its name", "required"),
            attribute("uri", "text", "an http(s) URI: it answers fetches from there or below"),
            attribute(
                "application", "id", "the only application that may use it; by default all may"
            ),
        ),
        ("reply", "failure"),
    ),
    Element(
        "reply",
        "An answer.",
        (
            AFTER,
            attribute(
                "src",
                "path",
                "the file that answers a fetch of a VoiceXML document; without one,"
                " the answer is XML of its data",
            ),
        ),
        ("data",),
    ),
    Element(
        "failure",
        "An error instead of an answer.",
        (
            AFTER,
            attribute("reason", "text", "why", default="the service does not answer"),
            attribute("status", "integer", "the HTTP status that answers a fetch"),
        ),
    ),
    Element(
        "connection",
        "What VoiceXML applications know of the user's call, as session.connection; without"
        " it, or an attribute of it, that is undefined.",
        (
            attribute("remote", "text", "the URI of the user's telephone"),
            attribute("local", "text", "the URI that they called"),
            attribute("protocol", "text", "the protocol's name, such as sip"),
            attribute("version", "text", "the protocol's version"),
            attribute("aai", "text", "data passed with the call"),
            attribute("originator", "text", "who has called", choices=("local", "remote")),
        ),
        ("redirect",),
    ),
    Element(
        "redirect",
        "A station that redirected the call, the last one first.",
        (
            attribute("uri", "text", "its URI", "required"),
            attribute("pi", "text", "the presentation information"),
            attribute("si", "text", "the screening information"),
            attribute("reason", "text", "why it was redirected"),
        ),
    ),
    Element(
        "transfer",
        "How calls go to a destination to which a VoiceXML application transfers the user."
        " Of several for a destination each is for one call, in order; the last repeats.",
        (
            attribute("to", "text", "the destination's URI, or what it begins with", default=""),
            attribute(
                "outcome",
                "text",
                "how it ends: busy, noanswer or network_busy before anybody answers;"
                " far_end_disconnect, network_disconnect, near_end_disconnect,"
                " maxtime_disconnect or unknown after it; or an event whose name begins with"
                " error",
                default="far_end_disconnect",
            ),
            attribute("after", "delay", "how long until it is answered, or fails", default="0s"),
            attribute("lasts", "delay", "how long it lasts once it is answered", default="10s"),
        ),
    ),
)
