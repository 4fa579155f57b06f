import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton

TURN = np.pi / 2


@pytest.fixture(scope="module")
def skeleton() -> Skeleton:
    return Robot.load().skeleton


def origin(skeleton: Skeleton, segment: str, **angles: float) -> np.ndarray:
    """(3,) [m] of a segment; all hinges but the named ones at 0."""
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
def test_upright_with_hanging_arms(skeleton: Skeleton, segment: str, expected: tuple[float, float, float]):
    np.testing.assert_allclose(origin(skeleton, segment), expected, atol=1e-12)


def test_shoulder_flexion_lifts_the_arm_forward(skeleton: Skeleton):
    np.testing.assert_allclose(origin(skeleton, "l_wrist", l_shoulder_flexion=TURN), (0.42, 0.155, 0.925), atol=1e-12)


def test_elbow_flexion_lifts_the_forearm_forward(skeleton: Skeleton):
    np.testing.assert_allclose(origin(skeleton, "r_wrist", r_elbow_flexion=TURN), (0.20, -0.155, 0.705), atol=1e-12)


@pytest.mark.parametrize(("side", "y"), [("l", 0.575), ("r", -0.575)])
def test_shoulder_abduct_lifts_the_arm_sideways(skeleton: Skeleton, side: str, y: float):
    np.testing.assert_allclose(
        origin(skeleton, f"{side}_wrist", **{f"{side}_shoulder_abduct": TURN}), (0, y, 0.925), atol=1e-12
    )


def test_twisting_turns_the_bent_forearm_outward(skeleton: Skeleton):
    wrist = origin(skeleton, "l_wrist", l_elbow_flexion=TURN, l_shoulder_twisting=TURN)
    np.testing.assert_allclose(wrist, (0, 0.355, 0.705), atol=1e-12)


def test_the_first_hinge_of_a_segment_is_nearest_the_root(skeleton: Skeleton):
    """Flexion swings the whole plane of abduct: forward first, then sideways ends straight to the side."""
    wrist = origin(skeleton, "l_wrist", l_shoulder_flexion=TURN, l_shoulder_abduct=np.deg2rad(60))
    np.testing.assert_allclose(wrist, (0.21, 0.155 + 0.42 * np.sin(np.deg2rad(60)), 0.925), atol=1e-12)


def test_the_torso_leans_forward_right_and_turns_left(skeleton: Skeleton):
    assert origin(skeleton, "skullbase", vl5_tilt=0.3)[0] == pytest.approx(0.36 * np.sin(0.3))
    assert origin(skeleton, "skullbase", vl5_roll=0.3)[1] == pytest.approx(-0.36 * np.sin(0.3))
    np.testing.assert_allclose(origin(skeleton, "l_shoulder", vl5_torsion=TURN), (-0.155, 0, 0.925), atol=1e-12)


def test_frames_at_rest_and_straight_are_computed_once(skeleton: Skeleton):
    assert np.array_equal(skeleton.resting.origins, skeleton.frames(skeleton.rest).origins)
    assert np.array_equal(skeleton.straight.rotations, skeleton.frames(np.zeros(len(skeleton.hinges))).rotations)
    assert skeleton.resting is skeleton.resting
    assert skeleton.straight is skeleton.straight


def test_clamp_gives_the_nearest_angles_inside(skeleton: Skeleton):
    np.testing.assert_array_equal(skeleton.clamp(np.full(22, 10.0)), skeleton.upper)
    np.testing.assert_array_equal(skeleton.clamp(np.full(22, -10.0)), skeleton.lower)
    np.testing.assert_array_equal(skeleton.clamp(skeleton.rest), skeleton.rest)


def test_names_find_their_index(skeleton: Skeleton):
    assert [skeleton.joint(name) for name in skeleton.names] == list(range(22))
    assert [skeleton.segment(segment.name) for segment in skeleton.segments] == list(range(len(skeleton.segments)))
    assert skeleton.joints_of(("skullbase",)) == (3, 4, 5)


def test_parents_stand_before_their_children(skeleton: Skeleton):
    names = [segment.name for segment in skeleton.segments]
    assert all(s.parent is None or s.parent in names[:k] for k, s in enumerate(skeleton.segments))


def test_hinges_run_from_root_to_tip(skeleton: Skeleton):
    order = [skeleton.segment(hinge.segment) for hinge in skeleton.hinges]
    assert order == sorted(order)


def test_arrays_are_sealed(skeleton: Skeleton):
    frames = skeleton.frames(skeleton.rest)
    for array in (skeleton.lower, skeleton.upper, skeleton.rest, frames.origins, frames.rotations):
        assert not array.flags.writeable
    assert all(not hinge.axis.flags.writeable for hinge in skeleton.hinges)


def test_what_carries_no_hand_is_beside_it_and_is_not_solved(skeleton: Skeleton):
    hand, head = (skeleton.segment(name) for name in ("l_wrist", "skullbase"))
    others = skeleton.beside(frozenset({hand}))
    assert head in others
    assert hand not in others
    angles = 0.5 * (skeleton.lower + skeleton.upper)
    whole, part = skeleton.frames(angles), skeleton.frames(angles, without=others)
    np.testing.assert_array_equal(part.origins[hand], whole.origins[hand])
    assert skeleton.beside(frozenset({hand, head})) < others
