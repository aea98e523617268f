"""The robot that the tests of this folder drive."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.parties.bench import Process
from tests.parties.ros2.nodes import made_robot


@pytest.fixture
def robot() -> Iterator[Process]:
    process = made_robot()
    yield process
    process.kill()
