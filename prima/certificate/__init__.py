"""Certificates: how an EA can affect an FA."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from prima.certificate.finding import delays, starving
from prima.certificate.model import Certificate, Delay, Starving
from prima.certificate.summary import certificate_data, format_certificate
from prima.checks.prices import Outline, outline
from prima.checks.prices.bounds import busy_at_all
from prima.devices.profile import Profile, read_robot
from prima.errors import DocumentError, UsageError, has_errors
from prima.interpreter.checks import check_commands
from prima.interpreter.elements import Document
from prima.language.commands import PATIENCE_MS
from prima.loading import documents_folder, read_application
from prima.loading.files import read_file
from prima.session import AnyDocument

__all__ = [
    "Certificate", "Delay", "Starving", "certificate_data", "certificates", "certify",
    "format_certificate",
]  # fmt: skip


def certify(
    fa: AnyDocument, ea: AnyDocument, profile: Profile, others: Iterable[Profile]
) -> Certificate:
    """Compare two applications on a robot, and the EA with other robots."""
    own, theirs = outline(fa, profile), outline(ea, profile)
    units = [price for price in theirs.parts if price.what == "unit"]
    return Certificate(
        fa.id,
        ea.id,
        profile.id,
        sorted(own.devices & theirs.devices),
        sorted(own.devices - theirs.devices),
        sorted(theirs.devices - own.devices),
        max(units, key=lambda price: price.lasts, default=None),
        delays(own, theirs),
        [price for price in theirs.parts if price.leaves],
        busy_at_all(theirs),
        theirs.holds,
        starving(own, theirs),
        theirs.gaps,
        [one for one in theirs.parts if "speaker" in one.devices and one.lasts > PATIENCE_MS],
        {one.id: _lacks(ea, theirs, one) for one in (profile, *others)},
    )


def _lacks(document: AnyDocument, theirs: Outline, profile: Profile) -> list[str]:
    """Commands of an application for which a robot lacks the devices."""
    if not isinstance(document, Document):
        rows = profile.commands
        asked = set().union(*(part.names for part in theirs.parts)) - NO_COMMANDS
        return sorted(
            name for name in asked if name not in rows or not rows[name].devices <= profile.devices
        )
    problems = check_commands(document, profile.commands, profile.devices)
    named = (one.get("command") for one in problems if one.code == "unsupported-command")
    return sorted({name for name in named if name}) or sorted(
        {problem.message for problem in problems}
    )


NO_COMMANDS = {"unit", "question", "recording", "call"}
"""Kinds of parts of applications that are not Commands."""


def certificates(fas: Iterable[str], eas: Iterable[str], robot: str = "") -> list[Certificate]:
    """Certificates of all pairs of files, on a robot's profile or the demo's.

    Raises:
        DocumentError: a document is wrong.
        UsageError: a file cannot be read.
    """
    folder = documents_folder() / "robots"
    chosen = Path(robot) if robot else folder / "papero.xml"
    profile = read_robot(str(chosen), read_file(chosen))
    others = [
        read_robot(str(path), read_file(path))
        for path in sorted(folder.glob("*.xml"))
        if path != chosen
    ]
    fas, eas = list(fas), list(eas)
    read = {name: _read(name) for name in {*fas, *eas}}
    for names, kind, other in ((fas, "fa", "an EA"), (eas, "ea", "an FA")):
        for name in names:
            document = read[name]
            if isinstance(document, Document) and document.kind != kind:
                raise UsageError(
                    f"{name}: this is {other}; --with FA EA compares an FA with an EA."
                )
    return [certify(read[fa], read[ea], profile, others) for ea in eas for fa in fas]


def _read(path: str) -> AnyDocument:
    document, problems = read_application(path, read_file(path))
    if has_errors(problems):
        raise DocumentError(problems)
    return document
