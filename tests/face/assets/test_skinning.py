from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.mesh import PARTS
from kinesic.face.assets.rig import PLACE
from kinesic.face.assets.skinning import Skin
from kinesic.face.display import DisplayError

FIGURE = load_figure()
SKELETON = Robot.load("human").skeleton
POINTS = FIGURE.mesh.positions
LINEAR, DUAL = (Skin(FIGURE, SKELETON, blending=blending) for blending in ("linear", "dual"))
ALONE = FIGURE.weights.max(axis=1).toarray().ravel() == 1.0  # moved by one frame


def posture(**degrees: float) -> np.ndarray:
    found = SKELETON.rest.copy()
    for name, angle in degrees.items():
        found[SKELETON.joint(name)] = np.radians(angle)
    return found


BIND = np.array([FIGURE.angles.get(name, 0.0) for name in SKELETON.names])
FINGERS = [place for name, place in PLACE.items() if name.endswith(("1", "2", "3")) and "_" not in name[2:]]
STIFF = np.flatnonzero(FIGURE.weights[:, FINGERS].sum(axis=1) == 0.0)  # no finger moves them
ENDS = {
    "shoulder_flexion": (-50, 170),
    "shoulder_abduct": (-40, 120),
    "shoulder_twisting": (-90, 90),
    "elbow_flexion": (0, 135),
    "elbow_twisting": (-85, 85),
    "wrist_flexion": (-60, 60),
}  # [deg]
WILD = posture(l_shoulder_flexion=150, l_shoulder_twisting=80, l_elbow_flexion=120, l_elbow_twisting=85, vl5_tilt=30)


@pytest.mark.parametrize("skin", [LINEAR, DUAL], ids=["linear", "dual"])
def test_at_bind_it_stands_as_it_was_made(skin: Skin):
    moved = (skin.place(POINTS, BIND) - POINTS)[STIFF]
    np.testing.assert_allclose(moved, np.broadcast_to(moved[0], moved.shape), atol=0.001)


def test_what_one_frame_moves_is_moved_alike():
    np.testing.assert_allclose(LINEAR.place(POINTS, WILD)[ALONE], DUAL.place(POINTS, WILD)[ALONE], atol=1e-9)


@pytest.mark.parametrize("skin", [LINEAR, DUAL], ids=["linear", "dual"])
def test_the_hand_is_where_the_skeleton_has_it(skin: Skin):
    hand = np.flatnonzero(FIGURE.weights[:, [PLACE["l_wrist"]]].toarray().ravel() == 1.0)
    frames, wrist = SKELETON.frames(WILD), SKELETON.segment("l_wrist")
    there = (skin.place(POINTS, WILD)[hand] - frames.origins[wrist]) @ frames.rotations[wrist]
    bound = SKELETON.frames(BIND)
    here = (POINTS[hand] - FIGURE.centres["l_wrist"]) @ bound.rotations[wrist]
    np.testing.assert_allclose(there, here, atol=1e-9)


def test_frames_between_turn_half_way_and_without_the_twist():
    turns, _ = LINEAR.matrices(posture(l_shoulder_flexion=80, l_shoulder_abduct=0, l_shoulder_twisting=60))
    without, _ = LINEAR.matrices(posture(l_shoulder_flexion=40, l_shoulder_abduct=0))
    bent = LINEAR.unbound  # half frames stand half-way at bind, too
    half, none = PLACE["l_shoulder_half"], PLACE["l_shoulder_0"]
    np.testing.assert_allclose(turns[half] @ bent[half].T, without[none] @ bent[none].T, atol=1e-9)


def test_a_half_way_frame_does_not_flip_over_the_head():
    raised = [posture(l_shoulder_flexion=flexion, l_shoulder_abduct=-40) for flexion in (160, 165, 170)]
    halves = [LINEAR.matrices(angles)[0][PLACE["l_shoulder_half"]] for angles in raised]
    for one, other in pairwise(halves):
        assert np.trace(one.T @ other) > 1 + 2 * np.cos(np.radians(5))


def test_linear_blending_keeps_the_forearm_round_at_full_twist():
    """Frames along the bone share the twist, so that no candy wrapper forms."""
    parts = [PLACE[f"l_elbow_{k}"] for k in range(4)]
    of_bone = np.flatnonzero(FIGURE.weights[:, parts].sum(axis=1) > 0.98)
    elbow, wrist = (SKELETON.segment(f"l_{name}") for name in ("elbow", "wrist"))

    def radii(twist: float) -> np.ndarray:
        angles = posture(l_elbow_flexion=90, l_elbow_twisting=twist)
        frames = SKELETON.frames(angles)
        bone = frames.origins[wrist] - frames.origins[elbow]
        away = LINEAR.place(POINTS, angles)[of_bone] - frames.origins[elbow]
        return np.linalg.norm(np.cross(away, bone / np.linalg.norm(bone)), axis=1)

    assert (radii(85.0) / radii(0.0)).min() > 0.9


def test_the_upper_arm_stays_round_however_it_is_twisted():
    parts = [PLACE[f"l_shoulder_{k}"] for k in range(3)]
    of_bone = np.flatnonzero(FIGURE.weights[:, parts].sum(axis=1) > 0.98)
    shoulder, elbow = (SKELETON.segment(f"l_{name}") for name in ("shoulder", "elbow"))

    def radii(twist: float) -> np.ndarray:
        angles = posture(l_shoulder_twisting=twist)
        frames = SKELETON.frames(angles)
        bone = frames.origins[elbow] - frames.origins[shoulder]
        away = LINEAR.place(POINTS, angles)[of_bone] - frames.origins[shoulder]
        return np.linalg.norm(np.cross(away, bone / np.linalg.norm(bone)), axis=1)

    straight = radii(0.0)
    assert min((radii(twist) / straight).min() for twist in (-90.0, 90.0)) > 0.85


def test_nothing_tears_where_all_hinges_of_the_arms_are_at_an_end():
    """No side of a face grows by more than a thumb's breadth, and hardly one to more than twice its length."""
    mesh = FIGURE.mesh
    sides = np.concatenate([mesh.faces[:, [k, (k + 1) % 4]] for k in range(4)])
    cut_away = (mesh.parts == PARTS.index("cloth")) & (mesh.tips > 0.0)
    sides = np.unique(np.sort(sides[~cut_away[sides].all(axis=1)], axis=1), axis=0)
    hinges = [f"{side}_{name}" for side in "lr" for name in ENDS]

    def lengths(points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points[sides[:, 0]] - points[sides[:, 1]], axis=1)

    bound, most, rare = lengths(POINTS), 0.0, 0.0
    for ends in product(*ENDS.values()):
        found = lengths(LINEAR.place(POINTS, posture(**dict(zip(hinges, ends * 2, strict=True)))))
        most, rare = max(most, (found - bound).max()), max(rare, np.percentile(found / bound, 99.9))
    assert most < 0.03
    assert rare < 2.3


def test_a_skeleton_with_other_names_teaches():
    elbow = SKELETON.segment("l_elbow")
    segments = [replace(each, name="arm") if k == elbow else each for k, each in enumerate(SKELETON.segments)]
    with pytest.raises(DisplayError, match="no skin without l_elbow: bodies and hinges must have the names"):
        Skin(FIGURE, replace(SKELETON, segments=tuple(segments)))


def test_fingers_are_where_the_skeleton_has_them():
    """The skin of each finger's last part lies about its segment, and turns with it."""
    bent = posture(l_index_flexion1=80, l_pinky_flexion1=40, r_thumb_abduct=70)
    frames, points = SKELETON.frames(bent), LINEAR.place(POINTS, bent)
    for name in ("l_index3", "l_pinky2", "r_thumb3", "r_middle1"):
        own = np.flatnonzero(FIGURE.weights[:, [PLACE[name]]].toarray().ravel() > 0.9)
        k = SKELETON.segment(name)
        there = (points[own] - frames.origins[k]) @ frames.rotations[k]
        (capsule,) = SKELETON.segments[k].capsules
        bone = capsule.end - capsule.start
        along = np.clip(there @ bone / (bone @ bone), 0.0, 1.0)[:, None] * bone
        assert abs(np.median(np.linalg.norm(there - along, axis=1)) - capsule.radius) < 0.004, name


def test_a_skeleton_without_fingers_moves_the_hand_as_a_whole():
    fingers = set(Robot.load("human").chains["l_fingers"]) | set(Robot.load("human").chains["r_fingers"])
    upper = tuple(each for each in SKELETON.segments if each.name not in fingers)
    names = {segment.name for segment in upper}
    hinges = tuple(each for each in SKELETON.hinges if each.segment in names)
    stiff = replace(SKELETON, segments=upper, hinges=hinges, couplings=())
    turns, ways = Skin(FIGURE, stiff).matrices(stiff.rest)
    np.testing.assert_allclose(turns[PLACE["l_index2"]], turns[PLACE["l_wrist"]])
    np.testing.assert_allclose(ways[PLACE["l_index2"]], ways[PLACE["l_wrist"]])
