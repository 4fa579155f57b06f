"""Planning and performing of documents from a language model.

A document is planned first, so that the answer can name errors that the model can correct.
"""

import json
from asyncio import to_thread
from collections.abc import Callable
from functools import partial

from kinesic.bml.block import DEFAULT_BLOCK_ID
from kinesic.mcp.call_queue import CallQueue
from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.document_schema import Json
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.json_paths import find_json_path
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.serve.wire.protocol import MESSAGE_END, read_control

MAX_NOTICES = 12  # largest number of deviations from the document that one answer lists
CHARACTERS_PER_SECOND = 14.0  # [1/s] assumed speaking rate, for estimated durations of texts
CALL_DISCARDED = "an emergency stop discarded this call, nothing moves: resume, then send it again"
STOP_HOLDS = "an emergency stop holds: resume, then send it again"


class DocumentPerformer:
    """Executor that plans and performs documents in sequence."""

    def __init__(self, gate: RobotGate) -> None:
        """Create an executor for a robot that may still be starting."""
        self._gate, self._calls = gate, CallQueue()

    async def perform(self, write: Callable[[], str]) -> RobotAnswer:
        """Plan a document and perform it after all earlier calls.

        Args:
            write: creates the document, in a separate thread.

        Returns:
            Its block, its duration, and the behaviours that deviate from the request.

        Raises:
            RefusedError: the document is invalid, too many calls are pending, or a stop came; nothing moves.
            RobotError: there is no answer in time.
        """
        return await self._calls.run(partial(self._perform_in_turn, write))

    async def speak(self, text: str, style: str) -> RobotAnswer:
        """Stream a long text after all earlier calls.

        Args:
            text: complete text.
            style: its name; empty: that of the robot.

        Returns:
            Block of its first phrase, and its estimated duration.

        Raises:
            RefusedError: the text is refused, too many calls are pending, or a stop came.
            RobotError: the server is gone.
        """
        return await self._calls.run(partial(self._speak_in_turn, text, style))

    async def _speak_in_turn(self, text: str, style: str) -> RobotAnswer:
        line = await self._gate.ready_line()
        stops = await self._count_stops(line)
        async with self._calls.turn():
            if await self._count_stops(line) != stops:
                raise RefusedError(CALL_DISCARDED)
            block = await line.documents.speak(text, style)
        return {"block": block, "about_seconds": round(len(text) / CHARACTERS_PER_SECOND)}

    def discard(self) -> None:
        """Refuse all pending calls, so that no plan outlives an emergency stop."""
        self._calls.discard(CALL_DISCARDED)

    async def _perform_in_turn(self, write: Callable[[], str]) -> RobotAnswer:
        line = await self._gate.ready_line()
        stops = await self._count_stops(line)
        async with self._calls.turn():
            document, written_id = await to_thread(check_document, write)
            planned = await line.documents.ask("plan", bml=document)
            block = _planned_block(planned, document)
            if await self._count_stops(line) != stops:  # also by a person or another client
                raise RefusedError(CALL_DISCARDED)
            if why := await line.documents.perform(document, block, written_id):
                raise RefusedError(why)
        return {"block": block, "seconds": planned["duration"], "not_as_asked": list_deviations(planned)}

    async def _count_stops(self, line: RobotLine) -> Json:
        """Return the number of emergency stops since the server start.

        Raises:
            RefusedError: an emergency stop is active.
        """
        status = await line.status()
        if status["state"] == "stopped":
            raise RefusedError(STOP_HOLDS)
        return status.get("stops")


def check_document(write: Callable[[], str]) -> tuple[str, str]:
    """Create a document, and check that it can be sent as BML.

    Returns:
        The document, and the id by which the server refuses it before parsing.

    Raises:
        RefusedError: the document is a control message or not valid text.
    """
    from kinesic.realizer.request import block_id  # noqa: PLC0415 - slow to import, and not needed to start

    try:
        document = write()
        message = document.encode()
    except (UnicodeEncodeError, RecursionError) as error:
        raise RefusedError(f"the document cannot be sent as UTF-8: {error}") from None
    if MESSAGE_END in message:
        raise RefusedError("the document contains a NUL character: remove it")
    try:
        request = read_control(message)
    except ValueError as error:
        raise RefusedError(f"neither BML nor a document in JSON: {error}") from None
    if request is not None:
        raise RefusedError("this is a control message, not a document: write BML")
    return document, block_id(message)


def refuse_errors(planned: RobotAnswer, document: str) -> None:
    """Raise an error if the server could not plan a document.

    Raises:
        RefusedError: the document is invalid; the text has the place of the error.
    """
    match planned:
        case {"error": {"line": int(line), "column": int(column), "text": str(text)}}:
            place = _describe_place(document, line, column, text)
            name = text.partition(": ")[0]
            raise RefusedError(f"{place}: {text.removeprefix(f'{name}: ') if place.endswith(f'.{name}') else text}")
        case {"duration": _}:
            return
    raise RefusedError(str(planned.get("why", "another document came in between; send it again")))


def _describe_place(document: str, line: int, column: int, text: str) -> str:
    """Return an error's place as JSON path or as line and column."""
    from kinesic.bml.reading.json_notation import is_json  # noqa: PLC0415 - slow to import, and not needed to start
    from kinesic.bml.reading.wrapping import open_document  # noqa: PLC0415 - as above

    document = str(open_document(document).text)
    if not is_json(document):
        return f"line {line}, column {column}"
    path = find_json_path(document, line, column, problem=text) or "the document"
    return path if "\n" not in document and _is_valid_json(document) else f"{path} (line {line}, column {column})"


def _is_valid_json(document: str) -> bool:
    try:
        json.loads(document)
    except (ValueError, RecursionError):
        return False
    return True


def _planned_block(planned: RobotAnswer, document: str) -> str:
    """Return the block id from the server's answer to a plan request.

    Raises:
        RefusedError: the document is invalid, or its block has no id.
    """
    refuse_errors(planned, document)
    match planned:
        case {"duration": _, "block": str(block)} if block != DEFAULT_BLOCK_ID:
            return block
        case {"duration": _}:
            why = f'the block needs a unique id, other than "{DEFAULT_BLOCK_ID}"'
            raise RefusedError(f'{why}: "id": "b1" in JSON, or <bml id="b1">')
    raise RobotError("the server's plan has no block: it needs the same version of kinesic")


def list_deviations(planned: RobotAnswer) -> Json:
    """List the first deviations from the request, and count the others."""
    notices = planned["notices"]
    assert isinstance(notices, list)  # as docs/reference/wire-protocol.md says
    texts: list[Json] = [f"{notice['id']}: {notice['text']}" for notice in notices[:MAX_NOTICES]]
    return texts if len(notices) <= MAX_NOTICES else [*texts, f"and {len(notices) - MAX_NOTICES} more"]
