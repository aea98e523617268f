"""VoiceXML applications run by a scenario, and what was said when."""

from __future__ import annotations

import wave
from collections.abc import Callable
from pathlib import Path

from prima import api
from prima.devices.voice import duration
from prima.messages import Record
from tests import ROOT

DEMO = ROOT / "documents"
Played = Callable[..., api.Transcript]


def of(transcript: api.Transcript, phase: str) -> list[Record]:
    return [record for record in transcript.records if record["phase"] == phase]


def takes(transcript: api.Transcript) -> list[int]:
    """How long each speak took, in ms."""
    begun = [r for r in of(transcript, "start") if r["command"] == "speak"]
    ends = {r["behavior"]: r["time"] for r in of(transcript, "end")}
    return [round(1000 * (ends[r["behavior"]] - r["time"])) for r in begun]


def texts(transcript: api.Transcript) -> list[str]:
    return [record["text"] for record in of(transcript, "start") if record.get("text")]


def logs(transcript: api.Transcript) -> list[str]:
    return [record["message"] for record in of(transcript, "log")]


def prompt(markup: str) -> str:
    return f"<form><block><prompt>{markup}</prompt></block></form>"


def plain(text: str) -> int:
    return duration(text, "en", {})


# Recordings -----------------------------------------------------------------------------------
def recording(path: Path, seconds: float, rate: int = 8000) -> None:
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(1)
        sound.setframerate(rate)
        sound.writeframes(b"\x80" * round(seconds * rate))


# Marks ----------------------------------------------------------------------------------------
SECOND = "aaaaaaaaaaaaaa"
"""A word that takes a second."""
