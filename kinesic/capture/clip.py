"""Captured motion: arm paths, hands, head and trunk, or named joint angles."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side

MEAN_HALF_WIDTH = 0.37  # [arm lengths] half the distance between the shoulders of an average adult
MEAN_UPPER_ARM = 0.52  # [arm lengths] length of the upper arm of an average adult


@dataclass(frozen=True, eq=False)
class ArmPath:
    """Elbow and wrist paths relative to the shoulder, in the chest frame.

    Axes: x forward, y left, z up.
    """

    elbow: Floats  # (m, 3) [arm lengths] elbow positions
    wrist: Floats  # (m, 3) [arm lengths] wrist positions


@dataclass(frozen=True, eq=False)
class HandTrack:
    """Orientation and finger extension of one hand, in the chest frame."""

    pointing: Floats  # (m, 3) unit directions from the wrist to the knuckles
    palm: Floats  # (m, 3) unit normals of the palm
    straight: Floats  # (m, 5) extension of thumb .. little finger, 0 closed .. 1 straight


@dataclass(frozen=True, eq=False)
class BodyClip:
    """Upper-body motion of a human, independent of size and heading."""

    times: Floats  # (m,) [s] times of the samples, from 0
    arms: Mapping[Side, ArmPath]
    head: Floats  # (m, 3) [rad] rotation vector of the head in the chest frame, zero when upright
    syncs: Mapping[str, float] = field(default_factory=dict)  # BML sync point in the file -> time [s]
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences
    hands: Mapping[Side, HandTrack] = field(default_factory=dict)  # hands with fingers; empty if the file has none
    trunk: Floats | None = None  # (m, 3) [rad] rotation vector of the chest from its mean orientation
    half_width: float = MEAN_HALF_WIDTH  # [arm lengths] half the distance between the shoulders
    upper_arm: float = MEAN_UPPER_ARM  # [arm lengths] length of the upper arm


@dataclass(frozen=True, eq=False)
class JointClip:
    """Motion of one robot as named joint angles."""

    times: Floats  # (m,) [s] times of the samples, from 0
    names: tuple[str, ...]  # names of the joints in the file
    angles: Floats  # (m, n) [rad] joint angles
    guesses: tuple[str, ...] = ()  # properties that the file does not state, as sentences


Clip = BodyClip | JointClip
