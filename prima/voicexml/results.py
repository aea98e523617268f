"""Recognition results as documents see them (VoiceXML 2.0, 2.3.1 and 5.1.5)."""

from __future__ import annotations

from prima.messages import Json
from prima.voicexml.state import TakenUtterance

RESULTS = """(function (all) {
  const best = all[0];
  for (const name in best) all[name] = best[name];  // without globals, which documents may change
  return all;
})($results)"""
"""Makes ``lastresult$`` from ``$results``: an array with the best result's properties."""


def shadow(heard: TakenUtterance) -> dict[str, Json]:
    """The shadow variables of an utterance."""
    return {
        "utterance": heard.utterance,
        "confidence": heard.confidence,
        "inputmode": heard.mode,
        "interpretation": heard.interpretation,
        **marked_and_recorded(heard),
    }


def marked_and_recorded(heard: TakenUtterance) -> dict[str, Json]:
    """Those that every item shares with the last result (VoiceXML 2.1, 4 and 7)."""
    found: dict[str, Json] = {}
    if heard.mark is not None:
        found["markname"] = heard.mark
    if heard.marktime is not None:
        found["marktime"] = heard.marktime
    if heard.recorded is not None:
        found["recording"] = heard.utterance
        found["recordingsize"] = len(heard.utterance.encode())
        found["recordingduration"] = heard.recorded
    return found
