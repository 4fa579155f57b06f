import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton

QUARTER_TURN = np.pi / 2


@pytest.fixture(scope="module")
def skeleton() -> Skeleton:
    return Robot.load().skeleton


def origin(skeleton: Skeleton, segment: str, **angles: float) -> np.ndarray:
    """Return a segment's origin (3,) [m], with unnamed hinges at zero."""
    posture = np.zeros(len(skeleton.hinges))
    for name, angle in angles.items():
        posture[skeleton.joint(name)] = angle
    return skeleton.frames(posture).origins[skeleton.segment(segment)]


# root 0.60, +0.07 vl5, +0.29 vt1, -0.035 collar bone, +-(0.040 + 0.115) shoulders, -0.22 elbow, -0.20 wrist
@pytest.mark.parametrize(
    ("segment", "expected"),
    [
        ("humanoid_root", (0, 0, 0.60)),
        ("vl5", (0, 0, 0.67)),
        ("vt1", (0, 0, 0.96)),
        ("skullbase", (0, 0, 1.03)),
        ("l_sternoclavicular", (0, 0.040, 0.925)),
        ("l_shoulder", (0, 0.155, 0.925)),
        ("l_elbow", (0, 0.155, 0.705)),
        ("l_wrist", (0, 0.155, 0.505)),
        ("r_wrist", (0, -0.155, 0.505)),
    ],
)
def test_segment_origins_at_zero_joint_angles_match_the_specification(
    skeleton: Skeleton, segment: str, expected: tuple[float, float, float]
):
    np.testing.assert_allclose(origin(skeleton, segment), expected, atol=1e-12)


def test_shoulder_flexion_lifts_the_arm_forward(skeleton: Skeleton):
    np.testing.assert_allclose(
        origin(skeleton, "l_wrist", l_shoulder_flexion=QUARTER_TURN), (0.42, 0.155, 0.925), atol=1e-12
    )


def test_elbow_flexion_lifts_the_forearm_forward(skeleton: Skeleton):
    np.testing.assert_allclose(
        origin(skeleton, "r_wrist", r_elbow_flexion=QUARTER_TURN), (0.20, -0.155, 0.705), atol=1e-12
    )


@pytest.mark.parametrize(("side", "y"), [("l", 0.575), ("r", -0.575)])
def test_shoulder_abduct_lifts_the_arm_sideways(skeleton: Skeleton, side: str, y: float):
    np.testing.assert_allclose(
        origin(skeleton, f"{side}_wrist", **{f"{side}_shoulder_abduct": QUARTER_TURN}), (0, y, 0.925), atol=1e-12
    )


def test_shoulder_twisting_turns_the_bent_forearm_outward(skeleton: Skeleton):
    wrist = origin(skeleton, "l_wrist", l_elbow_flexion=QUARTER_TURN, l_shoulder_twisting=QUARTER_TURN)
    np.testing.assert_allclose(wrist, (0, 0.355, 0.705), atol=1e-12)


def test_first_hinge_of_a_segment_is_nearest_to_the_root(skeleton: Skeleton):
    """Expect abduction inside the plane that flexion has already rotated."""
    wrist = origin(skeleton, "l_wrist", l_shoulder_flexion=QUARTER_TURN, l_shoulder_abduct=np.deg2rad(60))
    np.testing.assert_allclose(wrist, (0.21, 0.155 + 0.42 * np.sin(np.deg2rad(60)), 0.925), atol=1e-12)


def test_positive_torso_angles_lean_forward_and_right_and_turn_left(skeleton: Skeleton):
    assert origin(skeleton, "skullbase", vl5_tilt=0.3)[0] == pytest.approx(0.36 * np.sin(0.3))
    assert origin(skeleton, "skullbase", vl5_roll=0.3)[1] == pytest.approx(-0.36 * np.sin(0.3))
    np.testing.assert_allclose(origin(skeleton, "l_shoulder", vl5_torsion=QUARTER_TURN), (-0.155, 0, 0.925), atol=1e-12)


def test_frames_of_rest_and_zero_posture_are_cached(skeleton: Skeleton):
    assert np.array_equal(skeleton.rest_frames.origins, skeleton.frames(skeleton.rest).origins)
    assert np.array_equal(skeleton.zero_frames.rotations, skeleton.frames(np.zeros(len(skeleton.hinges))).rotations)
    assert skeleton.rest_frames is skeleton.rest_frames
    assert skeleton.zero_frames is skeleton.zero_frames


def test_clamped_joint_angles_are_the_nearest_within_the_limits(skeleton: Skeleton):
    np.testing.assert_array_equal(skeleton.clamp(np.full(22, 10.0)), skeleton.upper)
    np.testing.assert_array_equal(skeleton.clamp(np.full(22, -10.0)), skeleton.lower)
    np.testing.assert_array_equal(skeleton.clamp(skeleton.rest), skeleton.rest)


def test_joint_and_segment_indices_match_their_names(skeleton: Skeleton):
    assert [skeleton.joint(name) for name in skeleton.names] == list(range(22))
    assert [skeleton.segment(segment.name) for segment in skeleton.segments] == list(range(len(skeleton.segments)))
    assert skeleton.joints_of(("skullbase",)) == (3, 4, 5)


def test_parent_segments_precede_their_children(skeleton: Skeleton):
    names = [segment.name for segment in skeleton.segments]
    assert all(s.parent is None or s.parent in names[:k] for k, s in enumerate(skeleton.segments))


def test_hinges_are_ordered_from_root_to_tip(skeleton: Skeleton):
    order = [skeleton.segment(hinge.segment) for hinge in skeleton.hinges]
    assert order == sorted(order)


def test_skeleton_arrays_are_read_only(skeleton: Skeleton):
    frames = skeleton.frames(skeleton.rest)
    for array in (skeleton.lower, skeleton.upper, skeleton.rest, frames.origins, frames.rotations):
        assert not array.flags.writeable
    assert all(not hinge.axis.flags.writeable for hinge in skeleton.hinges)


def test_forward_kinematics_can_skip_segments_off_the_path(skeleton: Skeleton):
    hand, head = (skeleton.segment(name) for name in ("l_wrist", "skullbase"))
    others = skeleton.segments_off_path(frozenset({hand}))
    assert head in others
    assert hand not in others
    angles = 0.5 * (skeleton.lower + skeleton.upper)
    whole, part = skeleton.frames(angles), skeleton.frames(angles, without=others)
    np.testing.assert_array_equal(part.origins[hand], whole.origins[hand])
    assert skeleton.segments_off_path(frozenset({hand, head})) < others
