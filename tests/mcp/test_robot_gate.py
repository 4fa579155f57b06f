"""Access to a robot whose server is still starting."""

import asyncio
from concurrent.futures import Future
from typing import cast

import pytest

from kinesic.body.config import ConfigError
from kinesic.mcp.errors import RobotError
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.planning.setup import Setup

LINE = cast(RobotLine, "line")  # placeholder for the connections to the robot
SETUP = cast(Setup, "setup")  # placeholder for the planning setup


def test_stop_call_waits_for_connections_and_motion_call_also_for_the_setup():
    async def act() -> None:
        opened: Future[RobotLine] = Future()
        loaded: Future[Setup] = Future()
        gate = RobotGate(opened, loaded)
        stop, move = asyncio.create_task(gate.line()), asyncio.create_task(gate.ready_line())
        await asyncio.sleep(0)
        assert not stop.done()
        opened.set_result(LINE)
        assert await stop == LINE
        await asyncio.sleep(0.01)
        assert not move.done()
        loaded.set_result(SETUP)
        assert await move == LINE

    asyncio.run(act())


def test_server_that_does_not_start_is_reported_by_each_call():
    async def act() -> None:
        opened: Future[RobotLine] = Future()
        gate = RobotGate(opened, Future())
        opened.set_exception(RobotError("no such port"))
        for call in (gate.line, gate.ready_line, gate.line):
            with pytest.raises(RobotError, match="no such port"):
                await call()

    asyncio.run(act())


def test_cancelled_tool_call_does_not_cancel_the_connection_to_the_server():
    async def act() -> None:
        opened: Future[RobotLine] = Future()
        gate = RobotGate(opened, Future())
        call = asyncio.create_task(gate.line())
        await asyncio.sleep(0)
        call.cancel()
        await asyncio.sleep(0)
        opened.set_result(LINE)
        assert await gate.line() == LINE

    asyncio.run(act())


def test_invalid_planning_setup_is_reported_to_a_call_that_moves_the_robot():
    async def act() -> None:
        loaded: Future[Setup] = Future()
        loaded.set_exception(ConfigError("no style odd"))
        opened: Future[RobotLine] = Future()
        opened.set_result(LINE)
        with pytest.raises(RobotError, match="no style odd"):
            await RobotGate(opened, loaded).ready_line()

    asyncio.run(act())
