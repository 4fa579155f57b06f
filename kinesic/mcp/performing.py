"""Plan the documents of a model, and perform those that can be.

Planning first lets the answer name what a model can mend.
"""

from asyncio import get_running_loop
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from kinesic.bml.parse import UNNAMED
from kinesic.mcp.call_queue import CallQueue
from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.errors import RefusedError
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.teaching import Json
from kinesic.realizer.request import block_id
from kinesic.serve.wire.protocol import END, control

MAX_NOTICES = 12
CALL_DISCARDED = "an emergency stop came and discarded this call: nothing of it moves; resume, then send it again"
STOP_HOLDS = "an emergency stop holds: resume, then send it again"


class Performing:
    """Performs one document after the other."""

    def __init__(self, robot: RobotLine) -> None:
        """Perform by the connections to a robot."""
        self._robot, self._calls = robot, CallQueue()
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="writer")

    async def perform(self, write: Callable[[], str]) -> RobotAnswer:
        """Plan a document and have it performed, after all earlier calls.

        Args:
            write: writes the document, in a thread of its own.

        Returns:
            Its block, its duration, and the behaviours that are not performed as requested.

        Raises:
            RefusedError: it is wrong, too many calls wait, or a stop came; nothing moves.
            RobotError: nobody answers.
        """
        return await self._calls.run(partial(self._perform_in_turn, write))

    def discard(self) -> None:
        """Refuse all pending calls, so that no plan outlives an emergency stop."""
        self._calls.discard(CALL_DISCARDED)

    async def _perform_in_turn(self, write: Callable[[], str]) -> RobotAnswer:
        stops = await self._count_stops()
        async with self._calls.turn():
            document, written_id = await get_running_loop().run_in_executor(self._writer, _checked, write)
            planned = await self._robot.documents.ask("plan", bml=document)
            block = _planned_block(planned)
            if await self._count_stops() != stops:  # by anybody: a person, another client
                raise RefusedError(CALL_DISCARDED)
            if why := await self._robot.documents.perform(document, block, written_id):
                raise RefusedError(why)
        return {"block": block, "seconds": planned["duration"], "not_as_asked": _not_as_asked(planned)}

    async def _count_stops(self) -> Json:
        """Count all emergency stops since the server began.

        Raises:
            RefusedError: one holds.
        """
        status = await self._robot.status()
        if status["state"] == "stopped":
            raise RefusedError(STOP_HOLDS)
        return status.get("stops")


def _checked(write: Callable[[], str]) -> tuple[str, str]:
    """Write a document and find its id in early refusals.

    Returns:
        The document, and the id by which the server refuses it before it is read.

    Raises:
        RefusedError: it is a control message, or no text.
    """
    try:
        document = write()
        message = document.encode()
    except (UnicodeEncodeError, RecursionError) as error:
        raise RefusedError(f"the document cannot be sent as UTF-8: {error}") from None
    if END in message:
        raise RefusedError("the document has a NUL character, which no text has: take it out")
    try:
        request = control(message)
    except ValueError as error:
        raise RefusedError(f"neither BML nor a document in JSON: {error}") from None
    if request is not None:
        raise RefusedError("this is a message to the server, no document: write BML")
    return document, block_id(message)


def _planned_block(planned: RobotAnswer) -> str:
    """Read the id of the block from the answer to a plan.

    Raises:
        RefusedError: the document is wrong, or its block has no id.
    """
    match planned:
        case {"error": {"line": line, "column": column, "text": text}}:
            raise RefusedError(f"line {line}, column {column}: {text}")
        case {"duration": _, "block": str(block)} if block != UNNAMED:
            return block
        case {"duration": _}:
            why = f'the block needs an id of its own, other than "{UNNAMED}"'
            raise RefusedError(f'{why}: "id": "b1" in JSON, or <bml id="b1">')
    raise RefusedError(str(planned.get("why", "another document came in between; send it again")))


def _not_as_asked(planned: RobotAnswer) -> Json:
    notices = planned["notices"]
    assert isinstance(notices, list)  # as docs/serve.md says
    told: list[Json] = [f"{each['id']}: {each['text']}" for each in notices[:MAX_NOTICES]]
    return told if len(notices) <= MAX_NOTICES else [*told, f"and {len(notices) - MAX_NOTICES} more"]
