"""Events of a scenario that the user does not cause."""

from __future__ import annotations

from prima.devices.senses import sensor_value
from prima.messages import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Emergency,
    Inbound,
    Json,
    Narrated,
    Occurred,
)
from prima.sim.happenings import Doing
from prima.sim.robot import Robot


def happen(doing: Doing, robot: Robot, sensors: dict[str, Json], now: int) -> list[Inbound]:
    """Let something happen at a time (ms); ``sensors`` takes new sensor values."""
    values = doing.values
    match doing.name:
        case "note":
            return [Narrated("environment", doing.text)]
        case "message":
            data = {"from": values["from"] or "", "text": doing.text}
            return [Occurred("message", "environment", data, values["to"])]
        case "event":
            return [Occurred(values["name"], "environment", values["data"])]
        case "sensor":
            sensors[values["name"]] = sensor_value(values["value"])
        case "fail" | "repair":
            return _break(robot, now, doing)
        case "emergency":
            return [Emergency(True)]
        case "release":
            return [Emergency(False, bool(values["resume"]))]
        case "unload":
            return [ApplicationUnloaded(values["application"])]
        case "load":
            return [ApplicationLoaded(values["application"])]
    return []


def _break(robot: Robot, now: int, doing: Doing) -> list[Inbound]:
    """A device fails or hangs (E1), or works again."""
    device = doing.values["device"]
    if doing.name == "repair":
        robot.repair(device)
        return [Narrated("environment", f"the {device} works again")]
    hangs = bool(doing.values["hangs"])
    note = Narrated("environment", f"the {device} {'hangs' if hangs else 'fails'}")
    return [note, *robot.broke(now, device, hangs)]
