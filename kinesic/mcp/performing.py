"""Performs the documents of a model: tried first, so that the answer says what a model can mend."""

import json
import re
from threading import Lock

from kinesic.mcp.robot_line import RobotAnswer, RobotLine
from kinesic.mcp.teaching import Json
from kinesic.serve.wire.protocol import END, control

MOST_NOTICES = 12
# The id of the first <bml>, with any prefix and in either kind of quotes.
_BML_ID = re.compile(r"<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*([\"'])(.+?)\1")


class RefusedError(ValueError):
    """A document is not performed; says why, and what would have worked."""


class Performing:
    """Performs one document after the other."""

    def __init__(self, robot: RobotLine) -> None:
        """Performs by a connection."""
        self._robot = robot
        self._planning = Lock()  # of two documents that are planned at once the server answers the later one alone

    def perform(self, document: str) -> RobotAnswer:
        """Plans a document, and has it performed where it can be.

        Returns:
            Its block, how long it lasts, and what is not as asked.

        Raises:
            RefusedError: it is no document, or wrong; nothing moves.
            RobotError: nobody answers.
        """
        block = _block_id(document)
        with self._planning:
            return self._perform(document, block)

    def _perform(self, document: str, block: str) -> RobotAnswer:
        planned = self._robot.ask("plan", bml=document)
        if "duration" not in planned and "error" not in planned:
            raise RefusedError(str(planned.get("why", "another document came in between; send it again")))
        error = planned.get("error")
        if isinstance(error, dict):
            raise RefusedError(f"line {error['line']}, column {error['column']}: {error['text']}")
        if why := self._robot.perform(document, block):
            raise RefusedError(why)
        return {"block": block, "seconds": planned["duration"], "not_as_asked": _not_as_asked(planned)}


def _block_id(document: str) -> str:
    """Finds the id of a document's block.

    Raises:
        RefusedError: it has none, or is a control message.
    """
    if END.decode() in document:
        raise RefusedError("the document has a NUL character, which no text has: take it out")
    try:
        if control(document.encode()) is not None:
            raise RefusedError("this is a message to the server, no document: write BML")
    except ValueError as error:
        raise RefusedError(f"neither BML nor a document in JSON: {error}") from None
    text = document.lstrip()
    if not text.startswith(("{", "[")):
        found = _BML_ID.search(text)
        if found is None:
            raise RefusedError('no <bml id="...">: give the block an id of its own')
        return found[2]
    try:
        block = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise RefusedError(f"no JSON: {error}") from None
    name = block.get("id") if isinstance(block, dict) else None
    if not isinstance(name, str) or not name:
        raise RefusedError('the object needs an "id" of its own, such as "b1", and "behaviours"')
    return name


def _not_as_asked(planned: RobotAnswer) -> Json:
    notices = planned["notices"]
    assert isinstance(notices, list)  # as docs/serve.md says
    told: list[Json] = [f"{each['id']}: {each['text']}" for each in notices[:MOST_NOTICES]]
    return told if len(notices) <= MOST_NOTICES else [*told, f"and {len(notices) - MOST_NOTICES} more"]
