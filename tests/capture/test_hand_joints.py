"""Recognition of finger joints by name, and hand poses computed from them."""

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.capture.hand_joints import find_fingers, measure_hand_pose
from kinesic.capture.skeleton_motion import NEUTRAL_POSE, CapturedJoint, joint_positions

CHEST = np.eye(3)[None]  # chest frame of the one frame
NAMES = {  # finger -> names of its joints in three conventions
    "Jt": {"thumb": "JtThumb{}Lf", "index": "JtIndex{}Lf", "middle": "JtMiddle{}Lf", "pinky": "JtLittle{}Lf"},
    "Human": {
        "thumb": "LeftHandThumb{}",
        "index": "LeftHandIndex{}",
        "middle": "LeftHandMiddle{}",
        "pinky": "LeftHandPinky{}",
    },
    "Numbers": {"thumb": "LFinger0{}", "index": "LFinger1{}", "middle": "LFinger2{}", "pinky": "LFinger4{}"},
}
KNUCKLES = {"thumb": -4.0, "index": -3.0, "middle": -1.0, "pinky": 3.0}  # [cm] left of the middle of a left hand


def hand(names: dict[str, str], *, bend: float = 0.0, mirror: float = 1.0) -> tuple[CapturedJoint, ...]:
    """Return a palm-down hand that points forward (x forward, y left, z up).

    Args:
        names: names of the finger joints, with a placeholder for the number.
        bend: [rad] flexion of each finger joint.
        mirror: 1 for a left, -1 for a right hand.
    """
    joints = [CapturedJoint("wrist", None, sealed(np.zeros(3)), sealed(np.zeros(3)))]
    for finger, name in names.items():
        offset = np.array([8.0, mirror * KNUCKLES[finger], 0.0])
        for number, parent in zip("123", ("wrist", name.format("1"), name.format("2")), strict=True):
            turn = np.array([0.0, bend, 0.0])
            joints.append(CapturedJoint(name.format(number), parent, sealed(offset), sealed(turn)))
            offset = np.array([3.0, 0.0, 0.0])
    return tuple(joints)


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_finger_joints_are_recognised_in_three_naming_conventions(names):
    fingers = find_fingers(hand(names), "wrist")
    assert fingers.keys() == {"thumb", "index", "middle", "pinky"}
    assert fingers["index"] == tuple(names["index"].format(number) for number in "123")


def test_joints_named_like_a_palm_are_not_fingers():
    assert find_fingers(hand({"thumb": "Palm{}"}), "wrist") == {}


@pytest.mark.parametrize(("side", "mirror"), [("l", 1.0), ("r", -1.0)])
def test_captured_flat_hand_points_forward_with_its_palm_down(side, mirror):
    skeleton = hand(NAMES["Jt"], mirror=mirror)
    pose = measure_hand_pose(
        joint_positions(skeleton, NEUTRAL_POSE), CHEST, "wrist", find_fingers(skeleton, "wrist"), side
    )
    np.testing.assert_allclose(pose.pointing[0], [1.0, 0.0, 0.0], atol=0.1)
    np.testing.assert_allclose(pose.palm[0], [0.0, 0.0, -1.0], atol=1e-9)
    assert pose.straight[0, [1, 2, 4]].min() > 0.8


def test_captured_bent_fingers_count_as_closed():
    skeleton = hand(NAMES["Jt"], bend=1.4)
    pose = measure_hand_pose(
        joint_positions(skeleton, NEUTRAL_POSE), CHEST, "wrist", find_fingers(skeleton, "wrist"), "l"
    )
    assert pose.straight[0, [1, 2, 4]].max() < 0.1
    assert pose.straight[0, 3] == 1.0  # a missing finger counts as straight
