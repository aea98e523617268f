"""What a robot's document says of times."""

from __future__ import annotations

import pytest

from prima.devices.profile import read_robot

HEAD = '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="arm"/>'


@pytest.mark.parametrize(("duration", "gesture"), [('"0s"', 0), ('"1ms"', 1), ('"2s"', 2000)])
def test_a_duration_is_what_is_written(duration: str, gesture: int) -> None:
    text = (
        f'{HEAD}<gesture name="nod" duration={duration}/>'
        f'<adds command="wave" devices="arm" duration={duration}/></robot>'
    )
    profile = read_robot("r.xml", text.encode())
    assert profile.gestures["nod"] == gesture
    assert profile.lasts("wave") == max(gesture, 1), "an AB takes an instant"
