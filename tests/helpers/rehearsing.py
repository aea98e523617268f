"""Small scenarios, rehearsed."""

from __future__ import annotations

from pathlib import Path

from prima import api
from prima.devices.profile import Profile
from tests import ROOT

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="{}">'


def rehearse(
    folder: Path,
    body: str,
    script: str = "",
    policy: str | None = None,
    lang: str = "en",
    other: str = "",
    until: str = "120s",
) -> api.Transcript:
    """Run one application (and perhaps another) in the office."""
    (folder / "app.xml").write_text(HEAD.format("fa", "app", lang) + body + "</prima>", "utf-8")
    applications = '<application src="app.xml" kind="fa"/>'
    if other:
        (folder / "other.xml").write_text(HEAD.format("ea", "other", "en") + other + "</prima>")
        applications += '<application src="other.xml"/>'
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml"'
        f' until="{until}"><robot at="entrance"/>{applications}{script}</scenario>',
        "utf-8",
    )
    return api.rehearse(path, policy)


def told(transcript: api.Transcript) -> list[str]:
    return [row.what for row in transcript.rows() if row.kind != "load"]


def when(transcript: api.Transcript, what: str) -> float:
    return next(row.time for row in transcript.rows() if what in row.what)


PROFILE = Profile("r", camera_angle=60, camera_range=4)
