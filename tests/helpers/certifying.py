"""Pairs of small applications, their certificates and their runs."""

from __future__ import annotations

from pathlib import Path

from prima import api
from prima.certificate import (
    Certificate,
    certificates,
)
from prima.checks.prices import Price, outline
from prima.devices.profile import read_robot
from prima.devices.voice import duration
from prima.loading import read_application
from prima.loading.files import read_file
from prima.messages import Record
from tests import ROOT

ROBOT = ROOT / "documents" / "robots" / "papero.xml"
PROFILE = read_robot(str(ROBOT), read_file(ROBOT))
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="en">'
FA = (
    '<form id="sleep"><on event="touch"><goto next="#yes"/></on></form>'
    '<form id="yes"><block><speak>Yes?</speak><goto next="#sleep"/></block></form>'
)


def write(folder: Path, name: str, body: str, kind: str = "ea") -> str:
    path = folder / f"{name}.xml"
    path.write_text(HEAD.format(kind, name) + body + "</prima>")
    return str(path)


def priced(folder: Path, body: str) -> list[Price]:
    path = write(folder, "app", body)
    document, problems = read_application(path, read_file(path))
    assert [one for one in problems if one.severity == "error"] == []
    return outline(document, PROFILE).parts


def block(content: str) -> str:
    return f'<form id="f"><block>{content}<exit/></block></form>'


def lasting(text: str) -> int:
    return duration(text, "en", PROFILE.voices)


def certified(folder: Path, body: str, own: str = FA) -> Certificate:
    fa, ea = write(folder, "mine", own, "fa"), write(folder, "theirs", body)
    (found,) = certificates([fa], [ea])
    return found


def run(folder: Path, fa: str, ea: str, whens: str, until: str = "60s") -> list[Record]:
    """The records of a scenario with two applications."""
    text = (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="{until}"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROBOT}"><robot at="middle"/>'
        f'<person x="1" y="0"/><application src="{Path(fa).name}" kind="fa"/>'
        f'<application src="{Path(ea).name}" id="theirs"/>{whens}</scenario>'
    )
    (folder / "s.xml").write_text(text)
    return api.rehearse(folder / "s.xml").records


TOUCH = '<when at="1s"><touch sensor="head"/></when>'
VXML = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
    ' xml:lang="en">'
)


def voiced(folder: Path, body: str, own: str = FA, **more: str) -> tuple[Certificate, str, str]:
    """The certificate of a VoiceXML EA, with further documents; and the paths of both."""
    fa, ea = write(folder, "mine", own, "fa"), folder / "theirs.vxml"
    ea.write_text(f"{VXML}{body}</vxml>")
    for name, text in more.items():
        (folder / f"{name}.vxml").write_text(f"{VXML}{text}</vxml>")
    (found,) = certificates([fa], [str(ea)])
    return found, fa, str(ea)


def waited(records: list[Record]) -> float:
    """How long (s) the FA's answer to the touch has waited."""
    touched = next(r["time"] for r in records if r.get("event") == "touch.head")
    said = next(r["time"] for r in records if r["phase"] == "start" and r.get("text") == "Yes?")
    return float(said - touched)


def told(price: Price) -> tuple[object, ...]:
    inner = [told(one) for one in price.inner]
    return price.node.tag, price.what, price.devices, price.lasts, price.unknown, inner


ASKS = (
    '<form id="s"><field name="q" type="boolean"><prompt timeout="55s">Tell me?</prompt>'
    "<noinput><exit/></noinput><filled><exit/></filled></field></form>"
)


def without_more_for_each_event(found: Certificate) -> None:
    for delay in found.delays:
        delay.each = 0
