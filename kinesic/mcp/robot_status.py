"""Compact robot status for a language model: playing blocks, remaining seconds."""

from collections.abc import Mapping, Sequence
from typing import cast

from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.document_schema import Json

TIME_DIGITS = 1  # decimal places of the times [s] in a robot status


def summarise(status: RobotAnswer, warnings: Sequence[str]) -> RobotAnswer:
    """Return a compact robot status for a language model.

    Args:
        status: the server's answer to `status`.
        warnings: last warnings about documents of this connection.
    """
    blocks = list_blocks(status)
    answer: dict[str, Json] = {
        "robot": status.get("robot"),
        "state": status["state"],
        "playing": [_playing(block) for block in blocks if not block["starts_in"]],
    }
    if waiting := [block for block in blocks if block["starts_in"]]:
        answer["next"] = [{**_playing(block), "starts_in": _rounded(block["starts_in"])} for block in waiting]
    if unplanned := cast(int, status.get("waiting", 0)) + bool(status.get("planning")):
        answer["documents_not_planned_yet"] = unplanned
    if status.get("servos") is not None:
        answer["servos"] = status["servos"]
    if warnings:
        answer["last_warnings"] = list(warnings)
    return answer


def list_blocks(status: RobotAnswer) -> list[Mapping[str, Json]]:
    """Return the blocks of the server's status that have not ended."""
    return cast(list[Mapping[str, Json]], status.get("blocks", []))


def _playing(block: Mapping[str, Json]) -> dict[str, Json]:
    return {"block": block["block"], "seconds_left": _rounded(block["ends_in"])}


def _rounded(seconds: Json) -> float:
    return round(cast(float, seconds), TIME_DIGITS)
