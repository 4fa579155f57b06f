"""Bounded waiting for the end of a block."""

from asyncio import sleep
from time import monotonic

from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.errors import RefusedError
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_status import describe_state, list_blocks, summarise

POLL_PERIOD = 0.1  # [s] between two status requests while waiting for a block


async def wait_for_end(gate: RobotGate, block: str, timeout: float) -> RobotAnswer:
    """Wait until one or all blocks have ended, or a timeout.

    Args:
        gate: access to the robot.
        block: id of the block; empty for all blocks of all clients.
        timeout: maximum time [s].

    Returns:
        `ended`, with the `outcome` of a block that this connection sent, and the status if it has not ended.

    Raises:
        RefusedError: no such block is known.
        RobotError: there is no answer from the server.
    """
    line, end = await gate.line(), monotonic() + timeout
    was_seen = False
    while True:
        outcome = line.documents.outcome(block)
        if outcome:
            return {"block": block, "ended": True, "outcome": outcome}
        status = await line.status()
        names = [str(row["block"]) for row in list_blocks(status)]
        if block:
            is_active = outcome is not None or block in names
        else:  # a block of this connection may be expected, but not planned yet
            is_active = line.documents.is_playing or bool(names) or bool(status.get("waiting"))
        if block and not is_active and not was_seen:
            blocks = f"; {', '.join(names)} play or wait" if names else "; nothing plays"
            raise RefusedError(f"no block {block!r} was performed here{blocks}")
        if not is_active:
            return {"block": block, "ended": True} if block else {"ended": True, "state": describe_state(status)}
        was_seen = True
        if monotonic() >= end:
            named_block = {"block": block} if block else {}
            return {**named_block, "ended": False, "status": summarise(status, ())}
        await sleep(min(POLL_PERIOD, max(0.0, end - monotonic())))
