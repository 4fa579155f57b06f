"""Which way of a hinge is the positive one, in words for somebody who stands before the robot."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot

WORDS = (("forward", "backward"), ("to its left", "to its right"), ("up", "down"))  # x, y, z of the robot
CLEAR = 0.5  # share of the lever that must move for the words to be about the part itself
FRONT, TOP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def positive_way(robot: Robot, joint: int) -> str:
    """What moves, and where to, when a hinge of the zero posture turns the positive way."""
    skeleton = robot.skeleton
    hinge = skeleton.hinges[joint]
    straight = skeleton.straight
    segment = skeleton.segment(hinge.segment)
    axis = straight.rotations[segment] @ hinge.axis
    lever = _tip(robot, hinge.segment) - straight.origins[segment]
    moved = np.cross(axis, lever)
    if np.linalg.norm(moved) > CLEAR * np.linalg.norm(lever):
        return f"{hinge.segment} goes {_word(moved)}"
    if abs(axis @ FRONT) > CLEAR:
        return f"the top of {hinge.segment} turns {_word(np.cross(axis, TOP))}"
    return f"the front of {hinge.segment} turns {_word(np.cross(axis, FRONT))}"


def _tip(robot: Robot, name: str) -> Floats:
    """(3,) [m] the middle of a segment's own capsules, in the world."""
    skeleton, frames = robot.skeleton, robot.skeleton.straight
    k = skeleton.segment(name)
    ends = [end for capsule in skeleton.segments[k].capsules for end in (capsule.start, capsule.end)]
    middle = np.mean(ends, axis=0) if ends else np.zeros(3)
    return np.asarray(frames.origins[k] + frames.rotations[k] @ middle)


def _word(direction: Floats) -> str:
    k = int(np.abs(direction).argmax())
    return WORDS[k][int(direction[k] < 0)]
