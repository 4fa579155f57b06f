"""Action goals that a ROS controller performs."""

import time
from collections.abc import Mapping
from contextlib import suppress

from kinesic.body.config import ConfigError
from kinesic.hardware.ros.rosbridge import Message, Rosbridge, is_error

ACTION_TYPE = "control_msgs/action/FollowJointTrajectory"  # ROS type of the action
GOAL_ID = "kinesic"  # id of the goal in operations of rosbridge
GOAL_ERRORS: Mapping[int, str] = {  # error code of the action -> meaning
    -1: "invalid goal",
    -2: "invalid joints",
    -3: "old time stamp",
    -4: "path tolerance exceeded",
    -5: "goal tolerance exceeded",
}


def perform_goal(bridge: Rosbridge, action: str, trajectory: Message, *, timeout: float) -> None:
    """Send a trajectory as a goal and wait for its completion.

    The goal is cancelled if the wait ends early, also by Ctrl-C.

    Args:
        bridge: connection to ROS.
        action: name of the action, such as /arm_controller/follow_joint_trajectory.
        trajectory: joint trajectory.
        timeout: longest wait [s].

    Raises:
        ConfigError: the goal is refused or fails, takes too long, or the connection has ended.
    """
    is_over = False
    bridge.send("send_action_goal", id=GOAL_ID, action=action, action_type=ACTION_TYPE, args={"trajectory": trajectory})
    try:
        failure = _wait(bridge, timeout)
        is_over = True
    finally:
        if not is_over:
            with suppress(ConfigError):  # The connection may have ended.
                bridge.send("cancel_action_goal", id=GOAL_ID, action=action)
    if failure:
        raise ConfigError(f"{action}: the goal failed: {failure}")


def _wait(bridge: Rosbridge, timeout: float) -> str:
    """Return why the goal failed, or an empty text."""
    deadline = time.monotonic() + timeout
    while True:
        operation = bridge.receive(deadline - time.monotonic())
        if operation is None:
            raise ConfigError(f"{bridge.address}: the goal had no result within {timeout:.0f} s; it is cancelled")
        if operation.get("op") == "action_result" and operation.get("id") == GOAL_ID:
            return _failure(operation)
        if is_error(operation):
            return bridge.errors[-1]


def _failure(result: Message) -> str:
    """Return why a result is a failure, or an empty text."""
    values = result.get("values")
    if not isinstance(values, dict):
        return "" if result.get("result") is True else str(values)
    code, reason = values.get("error_code", 0), str(values.get("error_string", ""))
    if result.get("result") is True and code == 0:
        return ""
    meaning = GOAL_ERRORS.get(code, f"error {code}, status {result.get('status')}")
    return f"{meaning}: {reason}" if reason else meaning
