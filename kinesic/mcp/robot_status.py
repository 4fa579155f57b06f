"""Compact robot status for a language model: playing blocks, remaining seconds."""

from collections.abc import Iterable, Mapping, Sequence
from typing import cast

from kinesic.mcp.document_line import NO_CONVERSATION, RobotAnswer
from kinesic.mcp.document_schema import Json

STARTING_STATE = "starting"  # state reported while no block plays and one waits or is planned
SETTLING_STATE = "settling"  # state reported after the last block, until the robot is at rest
TORQUE_NOTE = "the servos hold their posture with torque on, until a person at the robot resumes or disarms them"
TIME_DIGITS = 1  # decimal places of the times [s] in a robot status


def summarise(
    status: RobotAnswer, warnings: Sequence[str], accepted: Iterable[str] = (), *, conversation: str = NO_CONVERSATION
) -> RobotAnswer:
    """Return a compact robot status for a language model.

    Args:
        status: the server's answer to `status`.
        warnings: last warnings about documents of this connection.
        accepted: blocks of this connection that have not ended.
        conversation: state of the conversation of this connection.
    """
    blocks = list_blocks(status)
    answer: dict[str, Json] = {
        "robot": status.get("robot"),
        "state": describe_state(status),
        "playing": [_playing(block) for block in blocks if not block["starts_in"]],
    }
    unplanned = _count_unplanned(status)
    waiting: list[Json] = [
        {**_playing(block), "starts_in": _rounded(block["starts_in"])} for block in blocks if block["starts_in"]
    ]
    if unplanned:  # otherwise an accepted block that is not listed has just ended
        listed = {block["block"] for block in blocks}
        waiting += [{"block": block} for block in sorted(accepted) if block not in listed]
        answer["documents_not_planned_yet"] = unplanned
    if conversation != NO_CONVERSATION:
        answer["conversation"] = conversation
    if waiting:
        answer["next"] = waiting
    if status.get("servos") is not None:
        answer["servos"] = status["servos"]
        if status["state"] == "stopped" and status["servos"] == "armed":
            answer["note"] = TORQUE_NOTE
    if warnings:
        answer["last_warnings"] = list(warnings)
    return answer


def describe_state(status: RobotAnswer) -> Json:
    """Return the robot state: resting, starting, playing, settling or stopped.

    A server's state is playing as long as the robot moves, also after the end of the last block.
    """
    state, blocks = status["state"], list_blocks(status)
    if state == "stopped" or (state == "playing" and blocks):
        return state
    if blocks or _count_unplanned(status):
        return STARTING_STATE
    return SETTLING_STATE if state == "playing" else state


def _count_unplanned(status: RobotAnswer) -> int:
    """Return the number of documents that wait for their plan."""
    return cast(int, status.get("waiting", 0)) + bool(status.get("planning"))


def list_blocks(status: RobotAnswer) -> list[Mapping[str, Json]]:
    """Return the unfinished blocks that a server status lists."""
    return cast(list[Mapping[str, Json]], status.get("blocks", []))


def _playing(block: Mapping[str, Json]) -> dict[str, Json]:
    return {"block": block["block"], "seconds_left": _rounded(block["ends_in"])}


def _rounded(seconds: Json) -> float:
    return round(cast(float, seconds), TIME_DIGITS)
