"""Common form of captured motion: directions of a body, or joint angles by name."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side


@dataclass(frozen=True, eq=False)
class ArmPath:
    """Path of one arm from its shoulder, in the chest frame (x forward, y left, z up)."""

    elbow: Floats  # (m, 3) [arm lengths]
    wrist: Floats  # (m, 3) [arm lengths]


@dataclass(frozen=True, eq=False)
class BodyClip:
    """Motion of a human body, independent of its size, place and heading."""

    times: Floats  # (m,) [s] from 0
    arms: Mapping[Side, ArmPath]
    head: Floats  # (m, 3) [rad] rotation vector of the head in the chest frame, zero when upright
    syncs: Mapping[str, float] = field(default_factory=dict)  # [s] BML sync points in the file
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences


@dataclass(frozen=True, eq=False)
class JointClip:
    """Motion as joint angles by name, of one robot."""

    times: Floats  # (m,) [s] from 0
    names: tuple[str, ...]  # names of the joints in the file
    angles: Floats  # (m, n) [rad]
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences


Clip = BodyClip | JointClip
