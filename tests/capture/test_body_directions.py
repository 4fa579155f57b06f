import numpy as np
import pytest

from kinesic.body.rotation import rotation_to_vector
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.text import CaptureError

from .clips import bvh, reach

OTHER_NAMES = {"Hips": "pelvis0", "Neck": "n", "Head": "skull", "Spine": "trunk"}


def read(data):
    return clip_of_skeleton(*read_bvh(data, "a.bvh"), "a.bvh")


def test_captured_arms_are_measured_from_the_shoulder_in_arm_lengths():
    clip = read(bvh())
    upper = 29 / (29 + 26)
    assert clip.arms["l"].wrist[0] == pytest.approx([0, 1, 0], abs=1e-9)
    assert clip.arms["r"].wrist[0] == pytest.approx([0, -1, 0], abs=1e-9)
    assert clip.arms["r"].elbow[0] == pytest.approx([0, -upper, 0], abs=1e-9)
    assert clip.head == pytest.approx(np.zeros((40, 3)), abs=1e-9)


def test_arm_paths_are_independent_of_heading_and_position_of_the_actor():
    rotations = reach(40)
    turned = rotations | {"Hips": np.tile([0.0, 0.0, 130.0], (40, 1))}
    here, there = read(bvh(rotations)), read(bvh(turned, place=(300, 80, -50)))
    for side in "lr":
        assert there.arms[side].wrist == pytest.approx(here.arms[side].wrist, abs=1e-7)
        assert there.arms[side].elbow == pytest.approx(here.arms[side].elbow, abs=1e-7)


def test_raised_right_arm_is_in_front_of_the_right_shoulder():
    clip = read(bvh(reach(41, height=90)))
    wrist = clip.arms["r"].wrist
    assert wrist[0, 2] < -0.9
    assert wrist[20, 0] > 0.1
    assert clip.arms["l"].wrist[20] == pytest.approx(clip.arms["l"].wrist[0])


def test_captured_head_rotation_is_expressed_in_the_chest_frame():
    turn = np.zeros((40, 3))
    turn[20] = [0.0, 0.0, 30.0]  # about y, which is upwards: to the left
    clip = read(bvh({"Head": turn, "Hips": np.tile([0.0, 0.0, 75.0], (40, 1))}))
    assert np.degrees(clip.head[20]) == pytest.approx([0, 0, 30], abs=1e-6)
    assert clip.head[10] == pytest.approx(np.zeros(3), abs=1e-9)


@pytest.mark.parametrize("prefix", ["mixamorig:", "a:b:"])
def test_prefixes_of_captured_joint_names_are_ignored(prefix):
    clip = read(bvh(rename=lambda name: prefix + name))
    assert clip.guesses == ()
    assert clip.arms["l"].wrist[0] == pytest.approx([0, 1, 0], abs=1e-9)


def test_joints_with_unknown_names_are_identified_by_bone_lengths():
    rename = lambda name: OTHER_NAMES.get(name, name.replace("Left", "l_").replace("Right", "r_").replace("Arm", "X"))  # noqa: E731
    rotations = reach(40)
    expected, clip = read(bvh(rotations)), read(bvh(rotations, rename=rename))
    assert "bone lengths" in clip.guesses[0]
    for side in "lr":
        assert clip.arms[side].wrist == pytest.approx(expected.arms[side].wrist, abs=1e-6)


def test_arms_whose_joint_names_state_no_side_are_rejected():
    names = {"Left": "first", "Right": "second", "Arm": "X"}

    def rename(name):
        for old, new in names.items():
            name = name.replace(old, new)
        return OTHER_NAMES.get(name, name)

    with pytest.raises(CaptureError, match="left from right"):
        read(bvh(rename=rename))


def test_body_whose_joint_names_state_only_the_left_side_is_rejected():
    data = bvh(rename=lambda name: OTHER_NAMES.get(name, name.replace("Arm", "X").replace("Right", "Q")))
    with pytest.raises(CaptureError, match="left from right"):
        read(data)


def test_calibration_pose_at_the_beginning_of_a_clip_is_dropped():
    rotations = {name: rows.copy() for name, rows in reach(60).items()}
    for rows in rotations.values():
        rows[:10] = 0.0  # arms to the sides
    clip = read(bvh(rotations, frames=60))
    assert clip.arms["l"].wrist[0, 2] < -0.9
    assert "T-pose" in clip.guesses[0]
    assert clip.times[0] == 0.0
    assert len(clip.times) == 50


def test_captured_arm_of_zero_length_is_rejected():
    data = bvh().replace(b"OFFSET 29 0 0", b"OFFSET 0 0 0").replace(b"OFFSET 26 0 0", b"OFFSET 0 0 0")
    with pytest.raises(CaptureError, match="no length"):
        read(data)


def test_mean_head_orientation_of_a_clip_is_neutral_if_its_zero_pose_is_not_upright():
    lying = bvh().replace(b"JOINT Head\n{ OFFSET 0 10 0", b"JOINT Head\n{ OFFSET 10 0 0")
    clip = read(lying)
    assert "mean" in clip.guesses[0]
    assert rotation_to_vector(np.eye(3)[None])[0] == pytest.approx(clip.head[0], abs=1e-6)
