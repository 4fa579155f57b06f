"""Motion from the measured position to the start of a performance."""

import math
import time
from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.hardware.ros.joints import JOINT_STATE_TYPE
from kinesic.hardware.ros.rosbridge import Rosbridge

STATE_TOPIC = "/joint_states"  # topic on which ROS robots report their joint positions
STATE_TIMEOUT = 3.0  # [s] longest wait for the positions of all joints
APPROACH_VELOCITY = 0.5  # [rad/s] highest joint velocity of the approach
MIN_APPROACH_DURATION = 1.0  # [s] shortest approach
PEAK_RATIO = 1.875  # highest / mean velocity of a quintic between two rests


def read_positions(
    bridge: Rosbridge, names: Sequence[str], *, topic: str = STATE_TOPIC, timeout: float = STATE_TIMEOUT
) -> Floats:
    """Return the measured positions (j,) [rad] of joints.

    Several messages may each report some of the joints.

    Raises:
        ConfigError: not all joints are reported in time, or the connection has ended.
    """
    bridge.send("subscribe", topic=topic, type=JOINT_STATE_TYPE)
    positions: dict[str, float] = {}
    deadline = time.monotonic() + timeout
    while missing := [name for name in names if name not in positions]:
        operation = bridge.receive(deadline - time.monotonic())
        if operation is None:
            reported = ", ".join(sorted(positions)) or "no joint"
            raise ConfigError(f"{topic}: reports {reported} within {timeout:g} s; {missing[0]!r} is missing")
        if operation.get("op") == "publish" and operation.get("topic") == topic:
            positions |= _positions_of(operation.get("msg"))
    bridge.send("unsubscribe", topic=topic)
    return sealed([positions[name] for name in names])


def approach_duration(start: Floats, end: Floats) -> float:
    """Return the duration [s] of a quintic motion within `APPROACH_VELOCITY`."""
    distance = float(np.max(np.abs(np.asarray(end) - start)))
    return max(MIN_APPROACH_DURATION, PEAK_RATIO * distance / APPROACH_VELOCITY)


def sample_approach(start: Floats, end: Floats, period: float) -> Sequence[tuple[float, Floats, Floats]]:
    """Return times [s], positions and velocities of a quintic motion between rests.

    Args:
        start: (j,) [rad] first positions.
        end: (j,) [rad] last positions.
        period: [s] between two samples.
    """
    whole = approach_duration(start, end)
    way = np.asarray(end) - start
    ratios = np.linspace(0.0, 1.0, math.ceil(whole / period) + 1)
    return [(ratio * whole, start + way * _quintic(ratio), way * _quintic_rate(ratio) / whole) for ratio in ratios]


def _quintic(ratio: float) -> float:
    return ratio**3 * (10.0 - 15.0 * ratio + 6.0 * ratio**2)


def _quintic_rate(ratio: float) -> float:
    return 30.0 * ratio**2 * (1.0 - ratio) ** 2


def _positions_of(message: object) -> dict[str, float]:
    """Return the finite positions of a joint state by joint name."""
    if not isinstance(message, dict):
        return {}
    names, positions = message.get("name"), message.get("position")
    if not isinstance(names, list) or not isinstance(positions, list):
        return {}
    return {
        str(name): float(position)
        for name, position in zip(names, positions, strict=False)
        if isinstance(position, int | float) and not isinstance(position, bool) and math.isfinite(position)
    }
