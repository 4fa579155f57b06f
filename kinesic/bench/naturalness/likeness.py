"""Measures how much gestures look alike from the front: hands, elbows and head through the stroke.

Fingers do not count: most robots have none that could tell two gestures apart.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot

DEPTH = 0.5  # that a distance towards the eye counts, of one across
TIPS = 1.8  # times as far from the wrist as the middle of the palm
PALM = 0.1  # [arm lengths] from the middle of the palm, where it faces
HEAD = 0.2  # [arm lengths] from the middle of the eyes, up
SAMPLES = 60  # of a stroke, in its own time


@dataclass(frozen=True)
class Pair:
    """Two gestures."""

    distance: float  # [m]
    a: str
    b: str


def measure_appearance(robot: Robot, angles: Floats) -> Floats:
    """Finds what is seen of a stroke, (m, p, 3) [m], depth made smaller.

    Of each arm elbow, wrist, finger tips and where the palm faces; of the head the eyes and a point above them.

    Args:
        robot: whose motion it is.
        angles: (m, n) [rad], evenly through the stroke.
    """
    frames = robot.skeleton.frames(angles)

    def track(k: int, at: Floats) -> Floats:
        points: Floats = frames.origins[:, k] + frames.rotations[:, k] @ at
        return points

    points = []
    for side in SIDES:
        arm = robot.arm(side)
        ahead, facing = arm.palm.position, PALM * robot.arm_length * arm.palm.facing
        points.append(frames.origins[:, arm.elbow])
        points += [track(arm.wrist, at) for at in (np.zeros(3), TIPS * ahead, ahead + facing)]
    eyes = robot.sites["eyes"]
    head, above = robot.skeleton.segment(eyes.segment), np.array([0.0, 0.0, HEAD * robot.arm_length])
    points += [track(head, at) for at in (eyes.position, eyes.position + above)]
    return sealed(np.stack(points, axis=1) * [DEPTH, 1.0, 1.0])


def nearest_pairs(seen: Mapping[str, Floats], most: float) -> list[Pair]:
    """Lists pairs of gestures that look alike, the nearest first.

    Two gestures are as far apart as the point that differs most, as the root of its mean square over the stroke.

    Args:
        seen: (m, p, 3) [m] by gesture, all with as many samples.
        most: [m] distance up to which a pair is listed.
    """
    names, found = list(seen), []
    every = np.stack(list(seen.values())) if names else np.empty((0, 1, 1, 3))
    for k, name in enumerate(names):
        squares = ((every[k + 1 :] - every[k]) ** 2).sum(axis=-1).mean(axis=1)
        distances = np.sqrt(squares).max(axis=-1)
        found += [Pair(float(distances[j]), name, names[k + 1 + j]) for j in np.flatnonzero(distances <= most)]
    return sorted(found, key=lambda pair: pair.distance)
