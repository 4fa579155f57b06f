from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.assets.rig import FRAME_INDICES
from kinesic.face.assets.skinning import Skin
from kinesic.face.display import DisplayError

DRESSED_FIGURE = load_figure()
HUMAN_SKELETON = Robot.load("human").skeleton
BIND_POSITIONS = DRESSED_FIGURE.mesh.positions
LINEAR_SKIN, DUAL_SKIN = (Skin(DRESSED_FIGURE, HUMAN_SKELETON, blending=blending) for blending in ("linear", "dual"))
SINGLE_FRAME_VERTICES = DRESSED_FIGURE.weights.max(axis=1).toarray().ravel() == 1.0  # vertices of a single frame


def posture(**degrees: float) -> np.ndarray:
    actual = HUMAN_SKELETON.rest.copy()
    for name, angle in degrees.items():
        actual[HUMAN_SKELETON.joint(name)] = np.radians(angle)
    return actual


BIND_ANGLES = np.array([DRESSED_FIGURE.angles.get(name, 0.0) for name in HUMAN_SKELETON.names])
FINGER_FRAMES = [
    place for name, place in FRAME_INDICES.items() if name.endswith(("1", "2", "3")) and "_" not in name[2:]
]
STIFF_VERTICES = np.flatnonzero(
    DRESSED_FIGURE.weights[:, FINGER_FRAMES].sum(axis=1) == 0.0
)  # vertices without finger weights
RANGE_ENDS_DEG = {
    "shoulder_flexion": (-50, 170),
    "shoulder_abduct": (-40, 120),
    "shoulder_twisting": (-90, 90),
    "elbow_flexion": (0, 135),
    "elbow_twisting": (-85, 85),
    "wrist_flexion": (-60, 60),
}  # [deg]
WIDE_POSTURE = posture(
    l_shoulder_flexion=150, l_shoulder_twisting=80, l_elbow_flexion=120, l_elbow_twisting=85, vl5_tilt=30
)


@pytest.mark.parametrize("skin", [LINEAR_SKIN, DUAL_SKIN], ids=["linear", "dual"])
def test_skin_vertices_that_move_with_one_segment_have_their_mesh_shape_in_the_bind_pose(skin: Skin):
    moved = (skin.move_skin(BIND_POSITIONS, BIND_ANGLES) - BIND_POSITIONS)[STIFF_VERTICES]
    np.testing.assert_allclose(moved, np.broadcast_to(moved[0], moved.shape), atol=0.001)


def test_vertices_of_one_skinning_frame_move_equally_with_both_skinning_methods():
    np.testing.assert_allclose(
        LINEAR_SKIN.move_skin(BIND_POSITIONS, WIDE_POSTURE)[SINGLE_FRAME_VERTICES],
        DUAL_SKIN.move_skin(BIND_POSITIONS, WIDE_POSTURE)[SINGLE_FRAME_VERTICES],
        atol=1e-9,
    )


@pytest.mark.parametrize("skin", [LINEAR_SKIN, DUAL_SKIN], ids=["linear", "dual"])
def test_skin_of_the_hand_moves_rigidly_with_the_wrist_segment(skin: Skin):
    hand = np.flatnonzero(DRESSED_FIGURE.weights[:, [FRAME_INDICES["l_wrist"]]].toarray().ravel() == 1.0)
    frames, wrist = HUMAN_SKELETON.frames(WIDE_POSTURE), HUMAN_SKELETON.segment("l_wrist")
    there = (skin.move_skin(BIND_POSITIONS, WIDE_POSTURE)[hand] - frames.origins[wrist]) @ frames.rotations[wrist]
    bound = HUMAN_SKELETON.frames(BIND_ANGLES)
    here = (BIND_POSITIONS[hand] - DRESSED_FIGURE.centres["l_wrist"]) @ bound.rotations[wrist]
    np.testing.assert_allclose(there, here, atol=1e-9)


def test_halfway_skinning_frames_rotate_by_half_the_angle_without_twist():
    turns, _ = LINEAR_SKIN.compute_frame_motions(
        posture(l_shoulder_flexion=80, l_shoulder_abduct=0, l_shoulder_twisting=60)
    )
    without, _ = LINEAR_SKIN.compute_frame_motions(posture(l_shoulder_flexion=40, l_shoulder_abduct=0))
    bent = LINEAR_SKIN.inverse_bind_rotations  # half frames are half-way in the bind pose, too
    half, none = FRAME_INDICES["l_shoulder_half"], FRAME_INDICES["l_shoulder_0"]
    np.testing.assert_allclose(turns[half] @ bent[half].T, without[none] @ bent[none].T, atol=1e-9)


def test_skinning_frame_of_the_shoulder_does_not_flip_while_the_arm_is_raised_above_the_head():
    raised = [posture(l_shoulder_flexion=flexion, l_shoulder_abduct=-40) for flexion in (160, 165, 170)]
    halves = [LINEAR_SKIN.compute_frame_motions(angles)[0][FRAME_INDICES["l_shoulder_half"]] for angles in raised]
    for one, other in pairwise(halves):
        assert np.trace(one.T @ other) > 1 + 2 * np.cos(np.radians(5))


def test_linear_blending_keeps_the_forearm_round_when_twisted():
    """Expect no constriction, since several frames distribute the twist along the bone."""
    parts = [FRAME_INDICES[f"l_elbow_{k}"] for k in range(4)]
    of_bone = np.flatnonzero(DRESSED_FIGURE.weights[:, parts].sum(axis=1) > 0.98)
    elbow, wrist = (HUMAN_SKELETON.segment(f"l_{name}") for name in ("elbow", "wrist"))

    def radii(twist: float) -> np.ndarray:
        angles = posture(l_elbow_flexion=90, l_elbow_twisting=twist)
        frames = HUMAN_SKELETON.frames(angles)
        bone = frames.origins[wrist] - frames.origins[elbow]
        away = LINEAR_SKIN.move_skin(BIND_POSITIONS, angles)[of_bone] - frames.origins[elbow]
        return np.linalg.norm(np.cross(away, bone / np.linalg.norm(bone)), axis=1)

    assert (radii(85.0) / radii(0.0)).min() > 0.9


def test_upper_arm_stays_round_when_twisted_by_90_degrees():
    parts = [FRAME_INDICES[f"l_shoulder_{k}"] for k in range(3)]
    of_bone = np.flatnonzero(DRESSED_FIGURE.weights[:, parts].sum(axis=1) > 0.98)
    shoulder, elbow = (HUMAN_SKELETON.segment(f"l_{name}") for name in ("shoulder", "elbow"))

    def radii(twist: float) -> np.ndarray:
        angles = posture(l_shoulder_twisting=twist)
        frames = HUMAN_SKELETON.frames(angles)
        bone = frames.origins[elbow] - frames.origins[shoulder]
        away = LINEAR_SKIN.move_skin(BIND_POSITIONS, angles)[of_bone] - frames.origins[shoulder]
        return np.linalg.norm(np.cross(away, bone / np.linalg.norm(bone)), axis=1)

    straight = radii(0.0)
    assert min((radii(twist) / straight).min() for twist in (-90.0, 90.0)) > 0.85


def test_skin_mesh_edges_grow_by_less_than_30_mm_at_joint_limits_of_the_arms():
    """Limit the growth of mesh edges to 30 mm."""
    mesh = DRESSED_FIGURE.mesh
    sides = np.concatenate([mesh.faces[:, [k, (k + 1) % 4]] for k in range(4)])
    cut_away = (mesh.parts == MESH_PARTS.index("cloth")) & (mesh.tips > 0.0)
    sides = np.unique(np.sort(sides[~cut_away[sides].all(axis=1)], axis=1), axis=0)
    hinges = [f"{side}_{name}" for side in "lr" for name in RANGE_ENDS_DEG]

    def lengths(points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points[sides[:, 0]] - points[sides[:, 1]], axis=1)

    bound, most, rare = lengths(BIND_POSITIONS), 0.0, 0.0
    for ends in product(*RANGE_ENDS_DEG.values()):
        actual = lengths(LINEAR_SKIN.move_skin(BIND_POSITIONS, posture(**dict(zip(hinges, ends * 2, strict=True)))))
        most, rare = max(most, (actual - bound).max()), max(rare, np.percentile(actual / bound, 99.9))
    assert most < 0.03
    assert rare < 2.3


def test_skinning_a_skeleton_with_unknown_segment_names_is_rejected():
    elbow = HUMAN_SKELETON.segment("l_elbow")
    segments = [replace(each, name="arm") if k == elbow else each for k, each in enumerate(HUMAN_SKELETON.segments)]
    with pytest.raises(DisplayError, match="no skin without l_elbow: bodies and hinges must have the names"):
        Skin(DRESSED_FIGURE, replace(HUMAN_SKELETON, segments=tuple(segments)))


def test_skinned_fingers_move_with_the_finger_segments():
    """Compare the rotations of skin and segment of each fingertip."""
    bent = posture(l_index_flexion1=80, l_pinky_flexion1=40, r_thumb_abduct=70)
    frames, points = HUMAN_SKELETON.frames(bent), LINEAR_SKIN.move_skin(BIND_POSITIONS, bent)
    for name in ("l_index3", "l_pinky2", "r_thumb3", "r_middle1"):
        selected = np.flatnonzero(DRESSED_FIGURE.weights[:, [FRAME_INDICES[name]]].toarray().ravel() > 0.9)
        k = HUMAN_SKELETON.segment(name)
        there = (points[selected] - frames.origins[k]) @ frames.rotations[k]
        (capsule,) = HUMAN_SKELETON.segments[k].capsules
        bone = capsule.end - capsule.start
        along = np.clip(there @ bone / (bone @ bone), 0.0, 1.0)[:, None] * bone
        assert abs(np.median(np.linalg.norm(there - along, axis=1)) - capsule.radius) < 0.004, name


def test_skeleton_without_fingers_moves_the_hand_rigidly():
    fingers = set(Robot.load("human").chains["l_fingers"]) | set(Robot.load("human").chains["r_fingers"])
    upper = tuple(segment for segment in HUMAN_SKELETON.segments if segment.name not in fingers)
    names = {segment.name for segment in upper}
    hinges = tuple(hinge for hinge in HUMAN_SKELETON.hinges if hinge.segment in names)
    stiff = replace(HUMAN_SKELETON, segments=upper, hinges=hinges, couplings=())
    turns, ways = Skin(DRESSED_FIGURE, stiff).compute_frame_motions(stiff.rest)
    np.testing.assert_allclose(turns[FRAME_INDICES["l_index2"]], turns[FRAME_INDICES["l_wrist"]])
    np.testing.assert_allclose(ways[FRAME_INDICES["l_index2"]], ways[FRAME_INDICES["l_wrist"]])
