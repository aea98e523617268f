"""A live run as requested on the command line or from Python."""

from __future__ import annotations

from prima.errors import UsageError
from prima.live.chosen import Chosen
from prima.live.journal import read_broken
from prima.live.resumed import go_on
from prima.live.visit import LiveSettings, Visit, begin


def check_usage(
    chosen: Chosen, output: str | None, resume: str | None, checks: bool = False
) -> None:
    """Reject options that cannot be combined.

    Args:
        chosen: the parts of the run.
        output: the path of a new journal.
        resume: the path of a journal whose run is resumed.
        checks: whether to check the robot instead.

    Raises:
        UsageError: there are such options.
    """
    if checks:
        if not chosen.robot:
            raise UsageError("Name the robot to be checked with --robot.")
        return
    own = [chosen.fas, chosen.eas, chosen.world, chosen.maps]
    if resume is not None:
        if any((chosen.scenario, *own, chosen.robot, chosen.services, output)):
            raise UsageError("--resume goes on with what the journal names; leave out the rest.")
        return
    if chosen.scenario and any(own):
        message = "A scenario names its own applications and world;"
        raise UsageError(f"{message} leave out --fa, --ea, --world and --map.")
    if chosen.scenario and chosen.services:
        raise UsageError("A scenario has its own services; leave out --services.")
    if not any((chosen.scenario, chosen.fas, chosen.eas, chosen.world)):
        raise UsageError("Name applications with --fa and --ea, or a scenario.")
    if not (chosen.scenario or chosen.robot):
        hint = "documents/robots/simulated.xml is one without hardware."
        raise UsageError(f"Name the robot with --robot; {hint}")


def prepared(
    chosen: Chosen, settings: LiveSettings, output: str | None, resume: str | None
) -> Visit:
    """A run that is ready to go: a new or a resumed one.

    Raises:
        DocumentError: documents are wrong.
        UsageError: something cannot be combined, is missing, or has changed since.
    """
    check_usage(chosen, output, resume)
    if chosen.scenario and settings.drivers:
        raise UsageError("A scenario's robot is simulated; leave out --driver.")
    if resume is not None:
        if settings.redact:
            message = "--redact is for a new journal: this one has what users have said."
            raise UsageError(f"{resume}: {message}")
        if {settings.policy, settings.bound, settings.patience} != {None}:
            message = "--resume goes on with the policy of the journal;"
            raise UsageError(f"{message} leave out --policy, --bound and --patience.")
        return go_on(read_broken(resume), settings)
    return begin(chosen, settings, output)
