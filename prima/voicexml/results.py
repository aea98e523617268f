"""Results of recognition as documents see them (VoiceXML 2.0, 2.3.1 and 5.1.5)."""

from __future__ import annotations

from prima.messages import Json
from prima.voicexml.state import Heard

RESULTS = """(function (all) {
  const best = all[0];
  for (const name of Object.keys(best)) all[name] = best[name];
  return all;
})($results)"""
"""Makes ``lastresult$`` of ``$results``: an array that has the best result's properties itself."""


def shadow(heard: Heard) -> dict[str, Json]:
    """The shadow variables of an utterance."""
    found: dict[str, Json] = {
        "utterance": heard.utterance,
        "confidence": heard.confidence,
        "inputmode": heard.mode,
        "interpretation": heard.interpretation,
    }
    if heard.mark is not None:  # when it was passed is not known (VoiceXML 2.1, 3)
        found["markname"] = heard.mark
    return found
