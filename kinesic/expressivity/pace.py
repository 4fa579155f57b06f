"""How long a movement takes when nobody says how long: at ease for hands and for servos."""

from math import log2, sqrt

from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import AXES, axes

COMFORT = 1.3  # natural time over the shortest that the servos can do
FLOOR = 0.25  # [s] of a preparation or retraction
_WIDTH = 0.05  # [m] of a target in Fitts' law
_ACCELERATIONS = {"neck": 60.0, "torso": 30.0}  # [rad/s^2] that the default servos give at ease of duty
_PEAK_SPEED = 1.875  # of a minimum-jerk move, in amplitude over duration
_PEAK_ACCELERATION = 5.77  # of a minimum-jerk move, in amplitude over duration squared


def quickness(temporal: float) -> float:
    """Factor on speed of a temporal extent from -1 slow to 1 fast."""
    return float(2.0 ** (0.6 * temporal))


def hand_time(distance: float, temporal: float = 0.0) -> float:
    """Natural time of a hand's way [s]: Fitts' law, or the servos' ease where that is slower.

    Fitts' constants are a = 0.1 s, b = 0.15 s, W = 5 cm; servos of the default robot do 0.40 m in 0.45 s at best,
    and in proportion to the root of the way.

    Args:
        distance: [m].
        temporal: extent, -1 slow .. 1 fast.
    """
    fitts = 0.1 + 0.15 * log2(distance / _WIDTH + 1)
    servos = COMFORT * 0.45 * sqrt(distance / 0.40)
    return max(fitts, servos) / quickness(temporal)


def turn_time(robot: Robot, chain: str, turn: Turn, temporal: float = 0.0) -> float:
    """Natural time of a rotation from upright [s], from the speed limits of the chain's hinges.

    Args:
        robot: whose hinges move.
        chain: `neck` or `torso`.
        turn: where it goes.
        temporal: extent, -1 slow .. 1 fast.
    """
    times = [0.0]
    for axis, angle in zip(AXES, axes(turn), strict=True):
        for k in robot.joints(chain):
            if robot.skeleton.names[k].endswith(axis):
                times.append(_PEAK_SPEED * abs(angle) / robot.speed_limits[k])
                times.append(sqrt(_PEAK_ACCELERATION * abs(angle) / _ACCELERATIONS[chain]))
    return float(COMFORT * max(times) / quickness(temporal))
