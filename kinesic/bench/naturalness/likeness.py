"""Visual similarity of gestures from the front, by hands, elbows and head.

Fingers do not count: most robots have none that could distinguish two gestures.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot

DEPTH_WEIGHT = 0.5  # weight of distances along the line of sight relative to distances across
TIP_RATIO = 1.8  # wrist-to-finger-tip distance / wrist-to-palm distance
PALM_OFFSET = 0.1  # [arm lengths] offset of the compared point in front of the palm
HEAD_OFFSET = 0.2  # [arm lengths] offset of the compared point above the eyes
STROKE_SAMPLES = 60  # samples of a stroke, at equal time intervals


@dataclass(frozen=True)
class Pair:
    """Two gestures and their visual distance."""

    distance: float  # [m] visual distance
    a: str
    b: str


def measure_appearance(robot: Robot, angles: Floats) -> Floats:
    """Return hand, elbow and head points (m, p, 3) for gesture comparison.

    Each arm gives its elbow, wrist, finger tips and a point in front of the palm; the head gives the eyes and a point
    above them. All are in metres; depths are multiplied by `DEPTH_WEIGHT`.

    Args:
        robot: robot that performs the motion.
        angles: joint angles (m, n) [rad], evenly sampled through the stroke.
    """
    frames = robot.skeleton.frames(angles)

    def track(k: int, at: Floats) -> Floats:
        points: Floats = frames.origins[:, k] + frames.rotations[:, k] @ at
        return points

    points = []
    for side in SIDES:
        arm = robot.arm(side)
        ahead, facing = arm.palm.position, PALM_OFFSET * robot.arm_length * arm.palm.facing
        points.append(frames.origins[:, arm.elbow])
        points += [track(arm.wrist, at) for at in (np.zeros(3), TIP_RATIO * ahead, ahead + facing)]
    eyes = robot.sites["eyes"]
    head, above = robot.skeleton.segment(eyes.segment), np.array([0.0, 0.0, HEAD_OFFSET * robot.arm_length])
    points += [track(head, at) for at in (eyes.position, eyes.position + above)]
    return sealed(np.stack(points, axis=1) * [DEPTH_WEIGHT, 1.0, 1.0])


def nearest_pairs(seen: Mapping[str, Floats], max_distance: float) -> list[Pair]:
    """List pairs of gestures that look alike, the most similar first.

    The distance of two gestures is that of their most different point, as an RMS over the stroke.

    Args:
        seen: compared points (m, p, 3) [m] by gesture, all with the same number of samples.
        max_distance: largest distance of a listed pair [m].
    """
    names, pairs = list(seen), []
    list_tasks = np.stack(list(seen.values())) if names else np.empty((0, 1, 1, 3))
    for k, name in enumerate(names):
        squares = ((list_tasks[k + 1 :] - list_tasks[k]) ** 2).sum(axis=-1).mean(axis=1)
        distances = np.sqrt(squares).max(axis=-1)
        pairs += [Pair(float(distances[j]), name, names[k + 1 + j]) for j in np.flatnonzero(distances <= max_distance)]
    return sorted(pairs, key=lambda pair: pair.distance)
