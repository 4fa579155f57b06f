"""Measures how far palm or finger tips are from the place on the body where a gesture needs them.

Places are found from the robot's own shape: those of the face as shares of its head, from the height of the eyes.
"""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import OTHER_SIDE, Robot, Side
from kinesic.body.skeleton import Frames, Segment
from kinesic.expressivity.lexicon.legibility_table import PlaceTable

TIPS = 1.8  # times as far from the wrist as the middle of the palm
AHEAD = 0.9  # [arm lengths] before the shoulders
HIP = 0.2  # [arm lengths] from the midline
FACE: Mapping[str, tuple[float, float, float]] = {  # shares: forward, aside, up to the crown or down to the chin
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


def place_distance(robot: Robot, angles: Floats, side: Side, asked: PlaceTable) -> float:
    """Measures how far a hand is from its place [m].

    Args:
        robot: whose posture it is.
        angles: (n,) [rad].
        side: of the hand.
        asked: which part of it, and where.
    """
    frames, palm = robot.skeleton.frames(angles), robot.arm(side).palm
    reach = palm.position * (TIPS if asked.part == "tips" else 1.0)
    hand = _point(frames, robot.skeleton.segment(palm.segment), reach)
    if asked.at == "between chin and other palm":
        return _line_distance(hand, _place(robot, frames, side, "chin"), _place(robot, frames, side, "other palm"))
    return float(np.linalg.norm(hand - _place(robot, frames, side, asked.at)))


def _line_distance(point: Floats, start: Floats, end: Floats) -> float:
    """From (3,) [m] to the nearest point of a line between two others [m]."""
    way = end - start
    share = np.clip((point - start) @ way / (way @ way), 0.0, 1.0)
    return float(np.linalg.norm(point - start - share * way))


def _place(robot: Robot, frames: Frames, side: Side, place: str) -> Floats:
    """(3,) [m] in the world."""
    other, out = robot.arm(OTHER_SIDE[side]), 1.0 if side == "l" else -1.0
    if place in FACE:
        name = robot.chains["neck"][-1]
        at = _face_point(_segment(robot, name), robot.sites["eyes"].position[2], FACE[place]) * [1.0, out, 1.0]
        return _point(frames, robot.skeleton.segment(name), at)
    torso = robot.chains["torso"]
    match place:
        case "chest" | "belly":
            front = max if place == "chest" else min
            capsule = front(_segment(robot, torso[-1]).capsules, key=lambda capsule: capsule.start[2])
            at = (capsule.start + capsule.end) / 2 + [capsule.radius, 0.0, 0.0]
            return _point(frames, robot.skeleton.segment(torso[-1]), at)
        case "hip":
            root = _segment(robot, torso[0]).parent or torso[0]
            return _point(frames, robot.skeleton.segment(root), np.array([0.0, out * HIP * robot.arm_length, 0.0]))
        case "ahead":
            chest = frames.rotations[robot.skeleton.segment(torso[-1])]
            middle = (frames.origins[other.shoulder] + frames.origins[robot.arm(side).shoulder]) / 2
            before: Floats = middle + AHEAD * robot.arm_length * chest[:, 0]
            return before
        case "other shoulder":
            shoulder: Floats = frames.origins[other.shoulder]
            return shoulder
        case "other forearm":
            half_way: Floats = (frames.origins[other.elbow] + frames.origins[other.wrist]) / 2
            return half_way
        case "other wrist":
            wrist: Floats = frames.origins[other.wrist]
            return wrist
    return _point(frames, other.wrist, other.palm.position)


def _face_point(head: Segment, eyes: float, shares: tuple[float, float, float]) -> Floats:
    """(3,) [m] in the head's segment, on the left; `eyes` is their height [m] in it."""
    ends = np.array([[capsule.start, capsule.end] for capsule in head.capsules])
    thick = np.array([capsule.radius for capsule in head.capsules])[:, None, None]
    low, high = (ends - thick).min(axis=(0, 1)), (ends + thick).max(axis=(0, 1))
    forward, aside, up = shares
    middle, half = (low + high) / 2, (high - low) / 2
    height = eyes + up * ((high[2] - eyes) if up > 0 else (eyes - low[2]))
    return np.array([middle[0] + forward * half[0], aside * half[1], height])


def _segment(robot: Robot, name: str) -> Segment:
    return robot.skeleton.segments[robot.skeleton.segment(name)]


def _point(frames: Frames, k: int, at: Floats) -> Floats:
    """(3,) [m] in the world of a point (3,) [m] in a segment."""
    point: Floats = frames.origins[k] + frames.rotations[k] @ at
    return point
