"""Distance of the palm or finger tips from a gesture's required position.

Positions follow from the robot's own shape; those on the face are relative to the head, from the height of the eyes.
"""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import OTHER_SIDE, Robot, Side
from kinesic.body.skeleton import Frames, Segment
from kinesic.expressivity.lexicon.legibility_table import PlaceTable

TIP_RATIO = 1.8  # wrist-to-finger-tip distance / wrist-to-palm distance
AHEAD_DISTANCE = 0.9  # [arm lengths] distance of the position "ahead" from the shoulders
HIP_OFFSET = 0.2  # [arm lengths] distance of a hip position from the midline
FACE_POINTS: Mapping[
    str, tuple[float, float, float]
] = {  # position -> fractions of the head: forward, sideways, from the eyes up to the crown or down to the chin
    "mouth": (0.9, 0.0, -0.63),
    "nose": (1.0, 0.0, -0.47),
    "chin": (0.57, 0.0, -0.9),
    "cheek": (0.71, 0.64, -0.53),
    "ear": (0.0, 1.0, -0.2),
    "temple": (0.5, 0.86, 0.05),
    "eye": (0.9, 0.43, 0.0),
    "forehead": (0.71, 0.0, 0.47),
    "hair": (0.0, 0.71, 0.7),
    "throat": (0.3, 0.0, -1.3),
}


def measure_place_distance(robot: Robot, angles: Floats, side: Side, requirement: PlaceTable) -> float:
    """Return the distance of a hand from its required position [m].

    Args:
        robot: robot in this posture.
        angles: joint angles (n,) [rad].
        side: side of the hand.
        requirement: part of the hand, and required position.
    """
    frames, palm = robot.skeleton.frames(angles), robot.arm(side).palm
    reach = palm.position * (TIP_RATIO if requirement.part == "tips" else 1.0)
    hand = _locate_point(frames, robot.skeleton.segment(palm.segment), reach)
    if requirement.at == "between chin and other palm":
        return _measure_line_distance(
            hand, _find_position(robot, frames, side, "chin"), _find_position(robot, frames, side, "other palm")
        )
    return float(np.linalg.norm(hand - _find_position(robot, frames, side, requirement.at)))


def _measure_line_distance(point: Floats, start: Floats, end: Floats) -> float:
    """Return the distance [m] of a point from a line segment."""
    direction = end - start
    fraction = np.clip((point - start) @ direction / (direction @ direction), 0.0, 1.0)
    return float(np.linalg.norm(point - start - fraction * direction))


def _find_position(robot: Robot, frames: Frames, side: Side, position_name: str) -> Floats:
    """Return the world position (3,) [m] of a named body location."""
    other, outward = robot.arm(OTHER_SIDE[side]), 1.0 if side == "l" else -1.0
    if position_name in FACE_POINTS:
        name = robot.chains["neck"][-1]
        at = _find_face_point(_segment(robot, name), robot.sites["eyes"].position[2], FACE_POINTS[position_name]) * [
            1.0,
            outward,
            1.0,
        ]
        return _locate_point(frames, robot.skeleton.segment(name), at)
    torso = robot.chains["torso"]
    match position_name:
        case "chest" | "belly":
            front = max if position_name == "chest" else min
            capsule = front(_segment(robot, torso[-1]).capsules, key=lambda capsule: capsule.start[2])
            at = (capsule.start + capsule.end) / 2 + [capsule.radius, 0.0, 0.0]
            return _locate_point(frames, robot.skeleton.segment(torso[-1]), at)
        case "hip":
            root = _segment(robot, torso[0]).parent or torso[0]
            return _locate_point(
                frames, robot.skeleton.segment(root), np.array([0.0, outward * HIP_OFFSET * robot.arm_length, 0.0])
            )
        case "ahead":
            chest = frames.rotations[robot.skeleton.segment(torso[-1])]
            middle = (frames.origins[other.shoulder] + frames.origins[robot.arm(side).shoulder]) / 2
            in_front: Floats = middle + AHEAD_DISTANCE * robot.arm_length * chest[:, 0]
            return in_front
        case "other shoulder":
            shoulder: Floats = frames.origins[other.shoulder]
            return shoulder
        case "other forearm":
            half_way: Floats = (frames.origins[other.elbow] + frames.origins[other.wrist]) / 2
            return half_way
        case "other wrist":
            wrist: Floats = frames.origins[other.wrist]
            return wrist
    return _locate_point(frames, other.wrist, other.palm.position)


def _find_face_point(head: Segment, eyes: float, fractions: tuple[float, float, float]) -> Floats:
    """Return a point (3,) [m] on the left side of the face.

    `eyes` is the height [m] of the eyes in this segment.
    """
    ends = np.array([[capsule.start, capsule.end] for capsule in head.capsules])
    thick = np.array([capsule.radius for capsule in head.capsules])[:, None, None]
    low, high = (ends - thick).min(axis=(0, 1)), (ends + thick).max(axis=(0, 1))
    forward, sideways, up = fractions
    middle, half = (low + high) / 2, (high - low) / 2
    height = eyes + up * ((high[2] - eyes) if up > 0 else (eyes - low[2]))
    return np.array([middle[0] + forward * half[0], sideways * half[1], height])


def _segment(robot: Robot, name: str) -> Segment:
    return robot.skeleton.segments[robot.skeleton.segment(name)]


def _locate_point(frames: Frames, k: int, at: Floats) -> Floats:
    """Return the world position (3,) [m] of a point in a segment."""
    point: Floats = frames.origins[k] + frames.rotations[k] @ at
    return point
