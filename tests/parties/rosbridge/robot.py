"""A robot behind a rosbridge (protocol 2) in a process of its own: it says what it does.

``robot.py PORT [threads]``. Without ``threads`` it is like a bridge that is started without
send_action_goals_in_new_thread: while a goal goes on, it reads nothing of that connection.
"""

from __future__ import annotations

import asyncio
import json
import sys
import time
from typing import Any

from websockets.asyncio.server import ServerConnection, serve

SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
STEP_S = 0.05


def tell(what: str, **more: object) -> None:
    sys.stdout.write(json.dumps({"what": what, "at": time.monotonic(), **more}) + "\n")
    sys.stdout.flush()


class Robot:
    def __init__(self, threads: bool) -> None:
        self.threads = threads
        self.silent = asyncio.Event()
        self.moves = False
        self.subscribed: set[tuple[ServerConnection, str]] = set()
        self.tasks: set[asyncio.Task[None]] = set()

    async def serve(self, connection: ServerConnection) -> None:
        goals: dict[str, asyncio.Event] = {}
        async for text in connection:
            message = json.loads(text)
            operation = message["op"]
            if operation == "send_action_goal":
                goals[message["id"]] = asyncio.Event()
                goal = self.act(connection, message, goals[message["id"]])
                await self.go_on(goal, self.threads)
            elif operation == "cancel_action_goal":
                if message["id"] in goals:
                    goals[message["id"]].set()
            elif operation == "call_service":
                await self.go_on(self.answer(connection, message), True)
            elif operation == "publish":
                self.take(message["topic"], message["msg"])
            elif operation == "subscribe":
                self.subscribed.add((connection, message["topic"]))

    async def go_on(self, work: Any, beside: bool) -> None:
        if not beside:
            await work
            return
        task = asyncio.ensure_future(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def act(
        self, connection: ServerConnection, message: dict[str, Any], cancelled: asyncio.Event
    ) -> None:
        args = message["args"]
        about = {"id": message["id"], "action": message["action"]}
        tell("goes", action=message["action"], **args)
        until = time.monotonic() + args.get("seconds", 0)
        while time.monotonic() < until and not cancelled.is_set():
            told = {"op": "action_feedback", "values": {"left": until - time.monotonic()}}
            await connection.send(json.dumps({**told, **about}))
            await asyncio.sleep(STEP_S)
        status = CANCELED if cancelled.is_set() else SUCCEEDED
        result: dict[str, Any] = {"values": {}, "result": True}
        if args.get("x", 0) < 0:
            status = ABORTED
            result["values"] = {"error_msg": "there is a wall"}
        if args.get("order", 0) > 100:
            status = 0
            result = {"values": "Action goal was rejected", "result": False}
        tell("go over", status=status)
        told = {"op": "action_result", "status": status, **result}
        await connection.send(json.dumps({**told, **about}))

    async def answer(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        name, args, result = message["service"], message.get("args") or {}, True
        values: Any = {}
        if name == "/rosapi/action_servers":
            values = {"action_servers": ["/go", "/count"]}
        elif name == "/rosapi/services":
            values = {"services": ["/say", "/be_silent"]}
        elif name == "/say":
            values = await self.say(args["text"])
        elif name == "/be_silent":
            self.silent.set()
            values = {"success": True, "message": ""}
        else:
            values, result = f"Service {name} does not exist", False
        told = {"op": "service_response", "service": name, "values": values, "result": result}
        await connection.send(json.dumps({**told, "id": message["id"]}))

    async def say(self, text: str) -> dict[str, Any]:
        tell("says", text=text)
        self.silent.clear()
        try:
            async with asyncio.timeout(0.05 * len(text)):
                await self.silent.wait()
        except TimeoutError:
            pass
        tell("says no more", cut=self.silent.is_set())
        return {"success": True, "message": ""}

    def take(self, topic: str, message: dict[str, Any]) -> None:
        turns = message.get("angular", {}).get("z", 0)
        if (turns != 0) != self.moves:
            self.moves = turns != 0
            tell("turns" if self.moves else "stands", topic=topic, speed=turns)

    async def publish(self, topic: str, message: object) -> None:
        told = json.dumps({"op": "publish", "topic": topic, "msg": message})
        for connection, wanted in self.subscribed:
            if wanted == topic:
                await connection.send(told)


async def main() -> None:
    robot = Robot("threads" in sys.argv[2:])
    lines = asyncio.StreamReader()
    loop = asyncio.get_running_loop()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
    async with serve(robot.serve, "127.0.0.1", int(sys.argv[1])):
        tell("ready")
        while line := await lines.readline():
            topic, _, message = line.decode().strip().partition(" ")
            await robot.publish(topic, json.loads(message))


if __name__ == "__main__":
    asyncio.run(main())
