"""Correction of captured pointing gestures towards their target.

The stroke is turned about the shoulder by the angle between captured and requested direction. The angle grows from zero
at strokeStart to its full value at the stroke, and returns to zero at strokeEnd, so that the path changes no more than
the displacement of the stroke requires.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.body.rotation import rotation_to_vector, shortest_rotation, vector_to_rotation
from kinesic.expressivity.hands.world_paths import shoulder
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.space import CAPTURED_REACH, to_gesture_space
from kinesic.motion.easing import minimum_jerk

TARGET_FRACTION = 0.8  # fraction of the distance to a near target at which the pointing wrist stops
MIN_DISTANCE = 1e-6  # [arm lengths] smallest distance of target and wrist from the shoulder
FIXED_AXES = (True, True, True)  # axes of an aimed pose that spatial extent does not scale


def is_captured(form: GestureForm) -> bool:
    """Return whether a gesture has a captured motion."""
    return any(pose.captured for key in form.keys for pose in key.hands.values())


def aim_captured(form: GestureForm, side: Side, target: Floats, robot: Robot) -> tuple[GestureForm, float]:
    """Turn a captured gesture's stroke towards a target.

    Args:
        form: captured gesture of one hand.
        side: of the hand.
        target: (3,) [m] in the world.
        robot: with the hand.

    Returns:
        The turned gesture, and the angle of the turn at the stroke [rad].
    """
    stroke = len(form.keys) // 2
    centre, place = to_gesture_space(robot, side, shoulder(robot, side)), to_gesture_space(robot, side, target)
    pose = form.keys[stroke].hands[side]
    arm, line = pose.position - centre, place - centre
    reach, distance = float(np.linalg.norm(arm)), float(np.linalg.norm(line))
    if min(reach, distance) < MIN_DISTANCE:
        return form, 0.0
    line = line / distance
    swing = rotation_to_vector(shortest_rotation(arm / reach, line))
    along = line if pose.pointing is None else vector_to_rotation(swing) @ pose.pointing
    twist = rotation_to_vector(shortest_rotation(along, line))
    radius = min(reach, CAPTURED_REACH, TARGET_FRACTION * distance) / reach

    def move(point: Floats, weight: float) -> Floats:
        scale = 1.0 + weight * (radius - 1.0)
        return sealed(centre + scale * vector_to_rotation(weight * swing) @ (point - centre))

    def turn(direction: Floats, weight: float) -> Floats:
        return sealed(vector_to_rotation(weight * twist) @ vector_to_rotation(weight * swing) @ direction)

    keys = [
        StrokeKey({side: _turn_pose(key.hands[side], move, turn, is_stroke=k == stroke, rises=k <= stroke)})
        for k, key in enumerate(form.keys)
    ]
    aimed = keys[stroke].hands[side]
    keys[stroke] = StrokeKey({side: replace(aimed, pointing=sealed(line), fixed=FIXED_AXES, aim=sealed(target))})
    return replace(form, keys=tuple(keys)), float(np.linalg.norm(swing))


def _turn_pose(
    pose: HandPose,
    move: Callable[[Floats, float], Floats],
    turn: Callable[[Floats, float], Floats],
    *,
    is_stroke: bool,
    rises: bool,
) -> HandPose:
    """Turn a hand pose towards the target, with weights along its path.

    Args:
        pose: of the hand.
        move: turns a position by a weight.
        turn: turns a direction by a weight.
        is_stroke: whether the pose is the stroke, which is turned in full; others stay.
        rises: whether the weight grows along the path; otherwise it falls from the stroke.
    """
    weight = 1.0 if is_stroke else 0.0
    path = pose.path
    if path is not None and path.course is not None:
        grown = minimum_jerk(path.course.parameters)
        weights = grown if rises else 1.0 - grown
        points = np.array([move(point, float(w)) for point, w in zip(path.points, weights, strict=True)]).reshape(-1, 3)
        pointing, palm = (
            None
            if rows is None
            else sealed(np.array([turn(row, float(w)) for row, w in zip(rows, weights, strict=True)]).reshape(-1, 3))
            for rows in (path.course.pointing, path.course.palm)
        )
        path = replace(path, points=sealed(points), course=replace(path.course, pointing=pointing, palm=palm))
    return replace(
        pose,
        position=move(pose.position, weight),
        pointing=None if pose.pointing is None else turn(pose.pointing, weight),
        palm=None if pose.palm is None else turn(pose.palm, weight),
        path=path,
    )
