"""Finger positions for any arm posture and finger bending."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.sim.fingers import FingerPlaces
from kinesic.sim.kinematics import body_frames
from kinesic.sim.worst_postures import random_postures

ROBOT = Robot.load("upper36")


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("still", [True, False])
def test_finger_positions_equal_full_forward_kinematics(side, still):
    postures = random_postures(ROBOT.skeleton, 7, seed=3)
    if still:
        postures[:, list(ROBOT.arm(side).fingers)] = postures[0, list(ROBOT.arm(side).fingers)]
    places, frames = FingerPlaces(ROBOT, side), ROBOT.skeleton.frames(postures)
    for _ in range(2):  # the second result comes from the cache
        starts, ends = places.ends(postures, body_frames(ROBOT, postures))
        for k, (owner, capsule) in enumerate(places.capsules):
            for result, point in ((starts[k], capsule.start), (ends[k], capsule.end)):
                true = frames.origins[:, owner] + frames.rotations[:, owner] @ point
                np.testing.assert_allclose(result.T, true, atol=1e-12)


def test_cached_finger_positions_depend_on_the_finger_posture():
    places = FingerPlaces(ROBOT, "l")
    one, other = random_postures(ROBOT.skeleton, 2, seed=4)[:, None]
    first, _ = places.ends(one, body_frames(ROBOT, one))
    second, _ = places.ends(other, body_frames(ROBOT, other))
    again, _ = places.ends(one, body_frames(ROBOT, one))
    assert not np.allclose(first, second)
    np.testing.assert_array_equal(first, again)
