"""Hand paths of gesture forms in the world."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.form import HandPose, StrokeKey
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.lexicon.space import (
    EASY_REACH,
    direction_in_world,
    extend_position,
    pull_within_reach,
    to_world,
    widen_position,
)

_EXTENT_FRACTIONS = (1.0, 0.75, 0.5, 0.25, 0.0)  # fractions of spatial extent, tried until a path is within easy reach
_PATH_PARAMETERS = np.linspace(0.0, 1.0, 101)  # path parameters at which the reach of a path is checked


def shoulder(robot: Robot, side: Side) -> Floats:
    """Return the centre of a resting shoulder in the world (3,) [m]."""
    return sealed(robot.skeleton.rest_frames.origins[robot.arm(side).shoulder])


def paths_in_world(
    keys: Sequence[StrokeKey], row: Sequence[Hand], side: Side, robot: Robot, spatial: float
) -> tuple[HandPath | None, ...]:
    """Return the paths of one hand to its keys, in the world.

    Amplitudes and points are scaled by spatial extent, less if a path would leave the easy reach of the arm.
    """
    centre, easy_reach = shoulder(robot, side), EASY_REACH * robot.arm_length
    paths_to_keys: list[HandPath | None] = []
    for k, key in enumerate(keys):
        pose = key.hands.get(side)
        start, end = row[k - 1].reach, row[k].reach
        if pose is None or pose.path is None or start is None or end is None:
            paths_to_keys.append(None)
            continue
        if pose.captured:  # every point is within reach at any extent
            paths_to_keys.append(_spread_path(pose, pose.path, side, robot, spatial))
            continue
        scaled = [_spread_path(pose, pose.path, side, robot, fraction * spatial) for fraction in _EXTENT_FRACTIONS]
        reaches_far = [
            float(np.linalg.norm(p.at(start.position, end.position, _PATH_PARAMETERS) - centre, axis=1).max())
            for p in scaled
        ]
        paths_to_keys.append(
            next((p for p, far in zip(scaled, reaches_far, strict=True) if far <= easy_reach), scaled[-1])
        )
    return tuple(paths_to_keys)


def _spread_path(pose: HandPose, path: HandPath, side: Side, robot: Robot, spatial: float) -> HandPath:
    """Scale a path by spatial extent, and convert to world coordinates."""
    amplitude = robot.arm_length * direction_in_world(side, extend_position(path.amplitude, spatial, pose.fixed))

    def move(point: Floats) -> Floats:
        if pose.captured:
            return to_world(robot, side, pull_within_reach(widen_position(point, spatial, pose.fixed, robot), robot))
        return to_world(robot, side, extend_position(point, spatial, pose.fixed))

    return path.mapped(amplitude, move, lambda direction: direction_in_world(side, direction))
