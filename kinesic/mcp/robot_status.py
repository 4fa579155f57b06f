"""Compact robot status for a language model: playing blocks, remaining seconds."""

from collections.abc import Iterable, Mapping, Sequence
from typing import cast

from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.document_schema import Json

STARTING_STATE = "starting"  # state reported for a resting robot with blocks waiting
TORQUE_NOTE = "the servos hold their posture with torque on, until a person at the robot resumes or disarms them"
TIME_DIGITS = 1  # decimal places of the times [s] in a robot status


def summarise(status: RobotAnswer, warnings: Sequence[str], accepted: Iterable[str] = ()) -> RobotAnswer:
    """Return a compact robot status for a language model.

    Args:
        status: the server's answer to `status`.
        warnings: last warnings about documents of this connection.
        accepted: blocks of this connection that have not ended.
    """
    blocks = list_blocks(status)
    answer: dict[str, Json] = {
        "robot": status.get("robot"),
        "state": status["state"],
        "playing": [_playing(block) for block in blocks if not block["starts_in"]],
    }
    unplanned = cast(int, status.get("waiting", 0)) + bool(status.get("planning"))
    waiting: list[Json] = [
        {**_playing(block), "starts_in": _rounded(block["starts_in"])} for block in blocks if block["starts_in"]
    ]
    if unplanned:  # otherwise an accepted block that is not listed has just ended
        listed = {block["block"] for block in blocks}
        waiting += [{"block": block} for block in sorted(accepted) if block not in listed]
        answer["documents_not_planned_yet"] = unplanned
    if waiting:
        answer["next"] = waiting
    if status["state"] == "resting" and (waiting or unplanned):
        answer["state"] = STARTING_STATE
    if status.get("servos") is not None:
        answer["servos"] = status["servos"]
        if status["state"] == "stopped" and status["servos"] == "armed":
            answer["note"] = TORQUE_NOTE
    if warnings:
        answer["last_warnings"] = list(warnings)
    return answer


def list_blocks(status: RobotAnswer) -> list[Mapping[str, Json]]:
    """Return the unfinished blocks that a server status lists."""
    return cast(list[Mapping[str, Json]], status.get("blocks", []))


def _playing(block: Mapping[str, Json]) -> dict[str, Json]:
    return {"block": block["block"], "seconds_left": _rounded(block["ends_in"])}


def _rounded(seconds: Json) -> float:
    return round(cast(float, seconds), TIME_DIGITS)
