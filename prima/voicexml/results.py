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
    found: dict[str, Json] = {
        "utterance": heard.utterance,
        "confidence": heard.confidence,
        "inputmode": heard.mode,
        "interpretation": heard.interpretation,
    }
    if heard.mark is not None:
        found["markname"] = heard.mark
    if heard.marktime is not None:
        found["marktime"] = heard.marktime
    if heard.recorded is not None:
        found["recording"] = heard.utterance
        found["recordingsize"] = len(heard.utterance.encode())
        found["recordingduration"] = heard.recorded
    return found
