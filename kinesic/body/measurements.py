"""What a sink saw while it followed commands."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance


@dataclass(frozen=True, eq=False)
class Measurements:
    """The performed motion, sampled at the times of the commands."""

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]
    torques: Floats  # (m, n) [Nm] of the drives
    duties: Floats  # (m, n) demanded PWM duty, may exceed 1
    hands: Mapping[str, Floats]  # "l", "r" -> (m, 3) [m] the wrist's centre in the world
    clearance: Clearance  # on every physics step, reduced to the smallest of each command's interval
