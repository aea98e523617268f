"""The services of a NAO in a process of their own: it says on its standard output what it does."""

from __future__ import annotations

import json
import sys
import threading
import time

import qi


def tell(what: str, **more: object) -> None:
    sys.stdout.write(json.dumps({"what": what, "at": time.monotonic(), **more}) + "\n")
    sys.stdout.flush()


@qi.multiThreaded()
class Speech:
    def __init__(self) -> None:
        self._silent = threading.Event()

    def say(self, text: str, language: str) -> None:
        self._silent.clear()
        tell("says", text=text, language=language)
        tell("says no more", cut=self._silent.wait(0.05 * len(text)))

    def stopAll(self) -> None:
        self._silent.set()


@qi.multiThreaded()
class Motion:
    def __init__(self) -> None:
        self._still = threading.Event()

    def moveTo(self, x: float, y: float, theta: float) -> bool:
        self._still.clear()
        tell("goes", x=x, y=y, theta=theta)
        if x < 0:
            raise RuntimeError("ALMotion::moveTo there is a wall behind me")
        cut = self._still.wait(3 * abs(x) / 4 + abs(theta) / 2)
        tell("go over", cut=cut)
        return not cut

    def move(self, x: float, y: float, theta: float) -> None:
        tell("drives", x=x, y=y, theta=theta)

    def angleInterpolation(
        self, names: object, angles: object, times: object, absolute: bool
    ) -> None:
        tell("head", names=names, angles=angles, times=times, absolute=absolute)

    def stopMove(self) -> None:
        tell("stop")
        self._still.set()


@qi.multiThreaded()
class Memory:
    def __init__(self, session: qi.Session) -> None:
        self._session = session
        self._made: dict[str, Subscriber] = {}

    def subscriber(self, name: str) -> Subscriber:
        return self._made.setdefault(name, Subscriber())

    def raiseEvent(self, name: str, value: object) -> None:
        self.subscriber(name).signal(value)


class Subscriber:
    def __init__(self) -> None:
        self.signal = qi.Signal("(m)")


def main() -> None:
    session = qi.Session()
    session.listenStandalone(f"tcp://127.0.0.1:{sys.argv[1]}")
    memory = Memory(session)
    session.registerService("ALTextToSpeech", Speech())
    session.registerService("ALMotion", Motion())
    session.registerService("ALMemory", memory)
    tell("ready")
    for line in sys.stdin:
        name, _, value = line.strip().partition(" ")
        memory.raiseEvent(name, json.loads(value))
    session.close()


if __name__ == "__main__":
    main()
