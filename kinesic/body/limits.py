"""What a trajectory may not exceed, per hinge."""

from dataclasses import dataclass

from kinesic.body.arrays import Floats


@dataclass(frozen=True, eq=False)
class Limits:
    """Boxes on angle, speed and acceleration, in joint order."""

    lower: Floats  # (n,) [rad]
    upper: Floats  # (n,) [rad]
    speed: Floats  # (n,) [rad/s]
    acceleration: Floats  # (n,) [rad/s^2]
