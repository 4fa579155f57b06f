"""What a sink saw while it followed commands."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance


@dataclass(frozen=True, eq=False)
class Power:
    """What the servos took from the supply in the interval that ends at each command, and what it did to them."""

    mean: Floats  # (m,) [A] of all servos together
    peak: Floats  # (m,) [A] largest on any physics step
    energy: float  # [J] in all
    warming: Mapping[str, Floats]  # hinge -> (m,) [K] rise of its windings, where the servo's thermal figures are known


@dataclass(frozen=True, eq=False)
class Measurements:
    """The performed motion, sampled at the times of the commands."""

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]
    torques: Floats  # (m, n) [Nm] of the drives
    duties: Floats  # (m, n) demanded PWM duty, may exceed 1
    goals: Floats  # (m, n) [rad] that each command sent, in ticks; what serves to fit servos
    hands: Mapping[str, Floats]  # "l", "r" -> (m, 3) [m] the wrist's centre in the world
    clearance: Clearance  # of the closest posture since the command before, see `sim.twin`
    latency: float  # [s] from a command's time until its goals reach the servos
    power: Power
