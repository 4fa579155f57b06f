"""Captured motion: arm paths and head rotations, or named joint angles."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side


@dataclass(frozen=True, eq=False)
class ArmPath:
    """Elbow and wrist paths relative to the shoulder, in the chest frame.

    Axes: x forward, y left, z up.
    """

    elbow: Floats  # (m, 3) [arm lengths] elbow positions
    wrist: Floats  # (m, 3) [arm lengths] wrist positions


@dataclass(frozen=True, eq=False)
class BodyClip:
    """Arm and head motion of a human, independent of size and heading."""

    times: Floats  # (m,) [s] from 0
    arms: Mapping[Side, ArmPath]
    head: Floats  # (m, 3) [rad] rotation vector of the head in the chest frame, zero when upright
    syncs: Mapping[str, float] = field(default_factory=dict)  # BML sync point in the file -> time [s]
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences


@dataclass(frozen=True, eq=False)
class JointClip:
    """Motion of one robot as named joint angles."""

    times: Floats  # (m,) [s] from 0
    names: tuple[str, ...]  # names of the joints in the file
    angles: Floats  # (m, n) [rad] joint angles
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences


Clip = BodyClip | JointClip
