import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.poses import resting
from kinesic.expressivity.keyframes import Hand
from kinesic.planning.hover import HOVER, NEAR_ENOUGH, clear_hands, touched
from kinesic.sim.distances import CapsuleDistances

ROBOT = Robot.load()
DISTANCES = CapsuleDistances(ROBOT)
REST = resting(ROBOT)


@pytest.mark.parametrize(
    ("touch", "segment"),
    [
        ("hand", "r_wrist"),
        ("forearm", "r_elbow"),
        ("upper_arm", "r_shoulder"),
        ("head", "skullbase"),
        ("chest", "vl5"),
        ("lap", "humanoid_root"),
    ],
)
def test_words_name_segments(touch, segment):
    pair = touched("l", touch, ROBOT)
    assert set(ROBOT.counted_pairs[pair]) == {"l_wrist", segment}


def test_a_hand_far_from_what_it_touches_stays():
    angles = ROBOT.skeleton.rest
    assert DISTANCES.gaps(angles[None])[0][touched("l", "hand", ROBOT)] > NEAR_ENOUGH
    hands = {side: Hand(REST[side], touch="hand") for side in ("l", "r")}
    assert np.array_equal(clear_hands(angles, hands, ROBOT, DISTANCES), angles)


def test_a_hand_in_the_way_moves_and_the_other_does_not():
    angles = ROBOT.skeleton.rest.copy()
    angles[ROBOT.skeleton.joint("l_shoulder_abduct")] = np.radians(-10)
    clear = clear_hands(angles, {"l": Hand(REST["l"])}, ROBOT, DISTANCES)
    assert DISTANCES.clearance(angles[None]).distances[0] < HOVER <= DISTANCES.clearance(clear[None]).distances[0]
    right = list(ROBOT.joints("r_arm"))
    assert np.array_equal(clear[right], angles[right])


def test_arms_that_hang_are_left_alone():
    angles = np.zeros(22)
    assert np.array_equal(clear_hands(angles, {"l": Hand(), "r": Hand()}, ROBOT, DISTANCES), angles)
