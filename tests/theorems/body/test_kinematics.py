"""What holds for every posture of the default robot."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.body.rotation import about

ROBOT = Robot.load()
SKELETON = ROBOT.skeleton
MIRROR = np.diag([1.0, -1.0, 1.0])
POSTURES = st.lists(st.floats(0.0, 1.0), min_size=22, max_size=22).map(
    lambda shares: SKELETON.lower + np.array(shares) * (SKELETON.upper - SKELETON.lower)
)
AXES = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)


def mirrored(angles: Floats) -> Floats:
    """(22,) [rad]: left and right exchanged, turns and rolls of the midline reversed."""
    image = angles.copy()
    for k, name in enumerate(SKELETON.names):
        if name.startswith("l_"):
            image[[k, SKELETON.joint("r_" + name[2:])]] = image[[SKELETON.joint("r_" + name[2:]), k]]
        elif name.endswith(("torsion", "roll")):
            image[k] = -image[k]
    return image


def other_side(name: str) -> str:
    return {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]


@given(POSTURES)
def test_equal_angles_are_mirror_postures(angles: Floats):
    frames, image = SKELETON.frames(angles), SKELETON.frames(mirrored(angles))
    for k, segment in enumerate(SKELETON.segments):
        j = SKELETON.segment(other_side(segment.name))
        np.testing.assert_allclose(image.origins[j], MIRROR @ frames.origins[k], atol=1e-12)
        np.testing.assert_allclose(image.rotations[j], MIRROR @ frames.rotations[k] @ MIRROR, atol=1e-12)


@given(POSTURES)
def test_bones_keep_their_length(angles: Floats):
    origins = SKELETON.frames(angles).origins
    for k, segment in enumerate(SKELETON.segments):
        if segment.parent is not None:
            length = np.linalg.norm(origins[k] - origins[SKELETON.segment(segment.parent)])
            assert length == pytest.approx(np.linalg.norm(segment.origin_in_parent), abs=1e-12)


@given(POSTURES)
def test_a_chain_is_where_the_skeleton_is(angles: Floats):
    frames = SKELETON.frames(angles)
    for side in SIDES:
        arm, palm = ROBOT.arms[side], ROBOT.sites[f"{side}_palm"]
        base = SKELETON.segment(arm.base)
        rotations, centres = arm.frames(angles[list(arm.indices)])
        in_world = centres @ frames.rotations[base].T + frames.origins[base]
        for j, joint in enumerate(arm.joints):
            k = SKELETON.segment(joint.name)
            np.testing.assert_allclose(in_world[j], frames.origins[k], atol=1e-12)
            np.testing.assert_allclose(frames.rotations[base] @ rotations[j], frames.rotations[k], atol=1e-12)
        wrist = SKELETON.segment(palm.segment)
        np.testing.assert_allclose(
            in_world[-1], frames.origins[wrist] + frames.rotations[wrist] @ palm.position, atol=1e-12
        )


@given(POSTURES)
def test_every_segment_has_a_rotation(angles: Floats):
    for rotation in SKELETON.frames(angles).rotations:
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) == pytest.approx(1.0)


@given(st.lists(st.floats(-10.0, 10.0), min_size=22, max_size=22).map(np.array))
def test_clamped_angles_are_inside_and_stay(angles: Floats):
    inside = SKELETON.clamp(angles)
    assert (inside >= SKELETON.lower).all()
    assert (inside <= SKELETON.upper).all()
    np.testing.assert_array_equal(SKELETON.clamp(inside), inside)


@given(AXES, st.floats(-7.0, 7.0), st.floats(-7.0, 7.0))
def test_turns_about_one_axis_add_up(axis: Floats, first: float, second: float):
    axis = axis / np.linalg.norm(axis)
    np.testing.assert_allclose(about(axis, first) @ about(axis, second), about(axis, first + second), atol=1e-12)
    np.testing.assert_allclose(about(axis, first) @ axis, axis, atol=1e-12)
    assert np.trace(about(axis, first)) == pytest.approx(1 + 2 * np.cos(first), abs=1e-12)
