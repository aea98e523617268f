"""Resumes a run that was cut off: on its robot, or as a scenario."""

from __future__ import annotations

from dataclasses import replace

from prima.devices.loop import Loop
from prima.errors import UsageError
from prima.journal import replay_instants
from prima.language.commands import PATIENCE_MS
from prima.live.chosen import Chosen, chosen_then, reloaded
from prima.live.clock import Clock
from prima.live.devices import LiveDevices
from prima.live.journal import CutJournal, Journal, going_on, known, lacking
from prima.live.services import LiveServices
from prima.live.visit import LiveSettings, Visit, in_simulation, on_robot, record_beside
from prima.loading import Loaded
from prima.loading.heads import chosen_policy
from prima.messages import Record
from prima.scheduler.policy import Policy
from prima.script.sandbox import START

PATIENCE_S = PATIENCE_MS / 1000


def go_on(broken: CutJournal, settings: LiveSettings) -> Visit:
    """Prepare to resume a run that was cut off.

    Raises:
        DocumentError: documents are wrong.
        UsageError: a file has changed since, or hosts were asked that cannot be asked again.
    """
    head = broken.records[0]
    chosen, loaded = chosen_then(head, broken.path), reloaded(head, broken.path)
    data = head["data"]
    settings = replace(
        settings,
        policy=data["policy"],
        bound=data.get("bound"),
        patience=round(data.get("patience", PATIENCE_S) * 1000),
    )
    policy = chosen_policy(data["policy"], loaded)
    if chosen.scenario:
        loop, missed = _scenario(broken, loaded, policy, settings)
    else:
        loaded.cast.scenario.date = data.get("date", START)
        loop, missed = _robot(broken, chosen, loaded, policy, settings)
    if settings.until is not None:
        loop.until = settings.until
    journal = Journal(broken.path, settings.sync, broken.kept)
    record_beside(loop, journal, settings)
    clock = Clock(settings.speed, broken.time)
    return Visit(loop, clock, settings, head, loaded, journal, missed, before=broken.records)


def _scenario(
    broken: CutJournal, loaded: Loaded, policy: Policy, settings: LiveSettings
) -> tuple[Loop, list[Record]]:
    """Run a scenario again up to the cut, in no time, with its world and its user.

    Returns:
        The loop at the cut, and the records that the journal's last instant lacks.

    Raises:
        UsageError: a host has answered, which cannot be simulated again.
    """
    for number, record in enumerate(broken.records, 1):
        if record["phase"] == "fetched" and record["data"].get("host"):
            message = "a host has answered this scenario's run, so it cannot be run again to here."
            raise UsageError(f"{broken.path}:{number}: {message} Begin the run anew.")
    loop, made = in_simulation(loaded, policy, settings), []
    try:
        while (records := loop.advance(broken.time)) is not None:
            made += records
        return loop, lacking(broken, made)
    except BaseException:
        loop.session.close()
        raise


def _robot(
    broken: CutJournal, chosen: Chosen, loaded: Loaded, policy: Policy, settings: LiveSettings
) -> tuple[Loop, list[Record]]:
    """Feed the session its inbound values again; what ran then was interrupted.

    Returns:
        The loop at the cut, and the records that the journal's last instant lacks.
    """
    start = broken.time
    services: LiveServices = chosen.answering(settings.web)
    loop = on_robot(loaded, policy, settings, services, start)
    try:
        missed = lacking(broken, replay_instants(loop.session, broken.records, broken.path))
    except BaseException:
        loop.session.close()
        raise
    loop.go_on(start)
    state, apps = known([*broken.records, *missed]), loop.session.apps
    asked = [order for order in state.asked.values() if not apps[order.app].over]
    never = {f"{one['app']}!{one['serial']}" for one in missed if one["phase"] == "send"}
    services.go_on(asked, never)
    assert isinstance(loop.devices, LiveDevices)
    loop.devices.go_on(state, list(going_on(state)))
    return loop, missed
