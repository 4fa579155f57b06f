"""Properties of every posture of the default robot."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.body.rotation import rotation_about

DEFAULT_ROBOT = Robot.load()
ROBOT_SKELETON = DEFAULT_ROBOT.skeleton
MIRROR_MATRIX = np.diag([1.0, -1.0, 1.0])  # reflection in the midline plane
# (22,) [rad] angles within the joint ranges
RANDOM_POSTURES = st.lists(st.floats(0.0, 1.0), min_size=22, max_size=22).map(
    lambda shares: ROBOT_SKELETON.lower + np.array(shares) * (ROBOT_SKELETON.upper - ROBOT_SKELETON.lower)
)
AXIS_VECTORS = (
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)
)


def mirrored(angles: Floats) -> Floats:
    """Return the angles (22,) [rad] of the mirror posture."""
    image = angles.copy()
    for k, name in enumerate(ROBOT_SKELETON.names):
        if name.startswith("l_"):
            image[[k, ROBOT_SKELETON.joint("r_" + name[2:])]] = image[[ROBOT_SKELETON.joint("r_" + name[2:]), k]]
        elif name.endswith(("torsion", "roll")):
            image[k] = -image[k]
    return image


def other_side(name: str) -> str:
    return {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]


@given(RANDOM_POSTURES)
def test_mirrored_joint_angles_give_mirrored_postures(angles: Floats):
    frames, image = ROBOT_SKELETON.frames(angles), ROBOT_SKELETON.frames(mirrored(angles))
    for k, segment in enumerate(ROBOT_SKELETON.segments):
        j = ROBOT_SKELETON.segment(other_side(segment.name))
        np.testing.assert_allclose(image.origins[j], MIRROR_MATRIX @ frames.origins[k], atol=1e-12)
        np.testing.assert_allclose(image.rotations[j], MIRROR_MATRIX @ frames.rotations[k] @ MIRROR_MATRIX, atol=1e-12)


@given(RANDOM_POSTURES)
def test_bone_lengths_are_the_same_in_every_posture(angles: Floats):
    origins = ROBOT_SKELETON.frames(angles).origins
    for k, segment in enumerate(ROBOT_SKELETON.segments):
        if segment.parent is not None:
            length = np.linalg.norm(origins[k] - origins[ROBOT_SKELETON.segment(segment.parent)])
            assert length == pytest.approx(np.linalg.norm(segment.origin_in_parent), abs=1e-12)


@given(RANDOM_POSTURES)
def test_arm_chain_agrees_with_the_skeleton(angles: Floats):
    frames = ROBOT_SKELETON.frames(angles)
    for side in SIDES:
        arm, palm = DEFAULT_ROBOT.arms[side], DEFAULT_ROBOT.sites[f"{side}_palm"]
        base = ROBOT_SKELETON.segment(arm.base)
        rotations, centres = arm.frames(angles[list(arm.indices)])
        in_world = centres @ frames.rotations[base].T + frames.origins[base]
        for j, joint in enumerate(arm.joints):
            k = ROBOT_SKELETON.segment(joint.name)
            np.testing.assert_allclose(in_world[j], frames.origins[k], atol=1e-12)
            np.testing.assert_allclose(frames.rotations[base] @ rotations[j], frames.rotations[k], atol=1e-12)
        wrist = ROBOT_SKELETON.segment(palm.segment)
        np.testing.assert_allclose(
            in_world[-1], frames.origins[wrist] + frames.rotations[wrist] @ palm.position, atol=1e-12
        )


@given(RANDOM_POSTURES)
def test_segment_orientations_in_every_posture_are_rotation_matrices(angles: Floats):
    for rotation in ROBOT_SKELETON.frames(angles).rotations:
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) == pytest.approx(1.0)


@given(st.lists(st.floats(-10.0, 10.0), min_size=22, max_size=22).map(np.array))
def test_clamped_angles_are_in_range_and_clamping_is_idempotent(angles: Floats):
    inside = ROBOT_SKELETON.clamp(angles)
    assert (inside >= ROBOT_SKELETON.lower).all()
    assert (inside <= ROBOT_SKELETON.upper).all()
    np.testing.assert_array_equal(ROBOT_SKELETON.clamp(inside), inside)


@given(AXIS_VECTORS, st.floats(-7.0, 7.0), st.floats(-7.0, 7.0))
def test_two_rotations_about_one_axis_equal_a_rotation_by_the_sum_of_their_angles(
    axis: Floats, first: float, second: float
):
    axis = axis / np.linalg.norm(axis)
    np.testing.assert_allclose(
        rotation_about(axis, first) @ rotation_about(axis, second), rotation_about(axis, first + second), atol=1e-12
    )
    np.testing.assert_allclose(rotation_about(axis, first) @ axis, axis, atol=1e-12)
    assert np.trace(rotation_about(axis, first)) == pytest.approx(1 + 2 * np.cos(first), abs=1e-12)
