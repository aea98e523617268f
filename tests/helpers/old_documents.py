"""VoiceXML documents as they are found, run as applications."""

from __future__ import annotations

from pathlib import Path

import prima

DEMO = prima.documents_folder()
HEAD = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'


def scenario(folder: Path, application: str, attributes: str = "") -> Path:
    """A scenario that runs one application."""
    path = folder / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{DEMO / "worlds" / "room.xml"}" robot="{DEMO / "robots" / "papero.xml"}"'
        f' {attributes}><robot at="middle"/><person x="1" y="0"/>'
        f'<application src="{application}"/></scenario>',
        encoding="utf-8",
    )
    return path


def run(
    folder: Path, body: str | bytes, attributes: str = "", head: str = HEAD
) -> prima.Transcript:
    """Run a document, or the content of one."""
    text = f"{head}{body}</vxml>" if isinstance(body, str) else body
    data = text.encode() if isinstance(text, str) else text
    (folder / "app.vxml").write_bytes(data)
    return prima.rehearse(scenario(folder, "app.vxml", attributes))


def said(transcript: prima.Transcript) -> list[str]:
    """What the robot has said, and how the application ended if not well."""
    assert transcript.failures == []
    return [row.what for row in transcript.rows() if row.what.startswith('"')]


def problems(folder: Path, text: str | bytes, name: str = "app.vxml") -> list[prima.Problem]:
    """What is wrong with a document."""
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return prima.validate([folder / name])
