"""A driver for speaker and ear: texts take a while, and the user does what its options say."""

from __future__ import annotations

import asyncio

from prima.devices.goals import LISTEN, SAY, Begin
from prima.live.driver import TaskDriver, speaks
from prima.messages import Data, Heard, Occurred

LETTER_S = 0.02


class UserDriver(TaskDriver):
    """Says texts; the user touches the robot when it says ``touches``, and answers ``answers``."""

    kind = "user"
    mapped = True
    own = frozenset({SAY, LISTEN})

    async def perform(self, goal: Begin) -> Data:
        options = self.settings.options
        if goal.kind == LISTEN:
            await asyncio.sleep(0.3)
            self.tell(Heard(options["answers"]))
            await asyncio.Event().wait()
        text = speaks(goal)
        if text == options["touches"]:
            self.tell(Occurred("touch", "user", {"sensor": "head"}))
        await asyncio.sleep(len(text) * LETTER_S)
        return {}
