import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.capture.arm_smoothing import smooth_arms
from kinesic.capture.arm_tracking import bridge_leaps, find_leaps, find_swivels
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.clip import ArmPath, BodyClip, JointClip
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.resampling import low_pass, resample_times
from kinesic.capture.retarget import MAX_DURATION, retarget
from kinesic.capture.robot_motion import arm_path, arm_paths
from kinesic.ik.arm.swivel import swivel
from kinesic.session.setup import set_up

from .clips import bvh, reach

TIMES = np.arange(0.0, 2.0, 1 / 30)


@pytest.fixture(scope="module")
def robot(known) -> Robot:
    return known.robot


def clip_of(rotations, **options) -> BodyClip:
    return clip_of_skeleton(*read_bvh(bvh(rotations, **options), "a.bvh"), "a.bvh")


def test_wrists_and_elbows_of_the_robot_follow_those_of_the_actor(robot, known):
    motion = retarget(clip_of(reach(60)), known, "a.bvh")
    reached = arm_paths(robot, motion.angles)
    for side, arm in motion.arms.items():
        assert np.linalg.norm(reached[side].wrist - arm.wrist, axis=1).max() < 0.05
        cosines = np.sum(reached[side].elbow * arm.elbow, axis=1)
        cosines /= np.linalg.norm(reached[side].elbow, axis=1) * np.linalg.norm(arm.elbow, axis=1)
        assert np.degrees(np.arccos(cosines)).max() < 15.0


def test_head_turn_of_the_actor_turns_the_neck_by_the_same_angle(robot, known):
    turn = np.zeros((60, 3))
    turn[:, 2] = 30.0 * np.sin(np.linspace(0, 3, 60))  # to the left
    motion = retarget(clip_of({"Head": turn}), known, "a.bvh")
    torsion = robot.skeleton.names.index("skullbase_torsion")
    assert np.degrees(motion.angles[:, torsion].max()) == pytest.approx(30.0, abs=1.0)


def test_raised_elbow_of_the_actor_gives_the_swivel_of_the_robot_arm(robot, known):
    """Compare postures for one wrist path with lowered and raised elbows."""
    count, wrist = 60, np.tile([0.7, 0.0, 0.0], (60, 1))
    angles = []
    for elbow in ([0.35, 0.0, -0.36], [0.35, -0.36, 0.0]):
        path = ArmPath(sealed(np.tile(elbow, (count, 1))), sealed(wrist))
        clip = BodyClip(sealed(np.arange(count) / 30), {"r": path}, sealed(np.zeros((count, 3))))
        motion = retarget(clip, known, "a")
        reached = arm_paths(robot, motion.angles)["r"]
        assert np.linalg.norm(reached.wrist[30] - wrist[30]) < 0.02
        angles.append(swivel(robot.arms["r"], motion.angles[30, list(robot.arms["r"].indices)]))
    assert np.degrees(angles[1] - angles[0]) == pytest.approx(90.0, abs=10.0)


def test_swivel_of_a_straight_captured_arm_is_that_of_neighbouring_frames(robot, known):
    elbow = np.tile([0.35, 0.0, -0.36], (30, 1))
    wrist = np.tile([0.7, 0.0, 0.0], (30, 1))
    elbow[10:20], wrist[10:20] = [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]
    swivels = find_swivels(robot.arms["l"], ArmPath(sealed(elbow), sealed(wrist)))
    assert swivels == pytest.approx(np.zeros(30), abs=1e-6)


def test_jump_of_a_captured_joint_angle_is_replaced_by_a_continuous_transition():
    angles = np.zeros((100, 2))
    angles[50:, 1] = 2.0
    bridged, leaps = bridge_leaps(angles)
    assert leaps == 1
    assert not find_leaps(bridged).any()
    assert bridged[[0, 99], 1].tolist() == [0.0, 2.0]
    assert bridge_leaps(bridged)[1] == 0


def test_joint_columns_are_matched_by_name_and_unknown_columns_are_noted(robot, known):
    name = robot.skeleton.names[3]
    wave = 0.1 * np.sin(2 * TIMES)
    clip = JointClip(sealed(TIMES), (name, "tail"), sealed(np.stack([wave, wave], axis=1)))
    motion = retarget(clip, known, "a.csv")
    column = robot.skeleton.names.index(name)
    assert motion.requested[100, column] == pytest.approx(0.1 * np.sin(2.0), abs=1e-4)
    assert motion.notes == ("unknown joints: tail",)
    with pytest.raises(CaptureError, match="no joint of upper22"):
        retarget(JointClip(sealed(TIMES), ("tail",), sealed(wave[:, None])), known, "a.csv")


def test_joint_columns_of_the_imported_file_are_converted_to_hinge_angles(robot, tmp_path):
    lines = 'name = "l_elbow_flexion"\nsource = { joint = "left_elbow", sign = -1, zero_deg = 90 }'
    path = tmp_path / "mine.toml"
    path.write_text(f'[robot]\nname = "mine"\nextends = "upper22"\n[[hinge]]\n{lines}\n', encoding="utf-8")
    setup = set_up(Robot.load(path))
    elbow, bent = robot.skeleton.names.index("l_elbow_flexion"), 0.5 + 0.1 * np.sin(2 * TIMES)
    for name, column in (("left_elbow", np.pi / 2 - bent), ("l_elbow_flexion", bent)):
        motion = retarget(JointClip(sealed(TIMES), (name,), sealed(column[:, None])), setup, "a.csv")
        assert motion.notes == ()
        assert motion.requested[100, elbow] == pytest.approx(0.5 + 0.1 * np.sin(2.0), abs=1e-4)


def test_captured_angles_beyond_a_joint_range_are_reported_as_requested_and_clipped_for_planning(robot, known):
    upper = robot.skeleton.upper[0]
    clip = JointClip(sealed(TIMES), robot.skeleton.names[:1], sealed(np.full((len(TIMES), 1), upper + 0.5)))
    motion = retarget(clip, known, "a.csv")
    assert motion.requested[:, 0] == pytest.approx(upper + 0.5)
    assert (motion.angles[:, 0] < upper).all()


def test_captured_clip_above_the_maximum_duration_is_rejected(robot, known):
    times = np.array([0.0, MAX_DURATION + 1.0])
    clip = JointClip(sealed(times), robot.skeleton.names[:1], sealed(np.zeros((2, 1))))
    with pytest.raises(CaptureError, match="at most 300 s"):
        retarget(clip, known, "a.csv")


def test_smoothing_of_captured_arms_reduces_angle_noise_and_keeps_the_wrist_path(robot, known):
    motion = retarget(clip_of(reach(60)), known, "a")
    noise = np.random.default_rng(2).normal(scale=0.02, size=motion.angles.shape)
    rough = np.clip(motion.angles + noise, robot.skeleton.lower, robot.skeleton.upper)
    smoothed = smooth_arms(rough, motion.arms, known)
    for side, arm in motion.arms.items():
        hinges = list(robot.arms[side].indices)
        before, after = (np.abs(np.diff(angles[:, hinges], 2, axis=0)).max() for angles in (rough, smoothed))
        assert after < 0.2 * before
        assert np.linalg.norm(arm_paths(robot, smoothed)[side].wrist - arm.wrist, axis=1).max() < 0.03
    others = [k for k in range(len(robot.skeleton.names)) if k not in set(list_arm_hinges(robot))]
    np.testing.assert_array_equal(smoothed[:, others], rough[:, others])


def list_arm_hinges(robot: Robot) -> list[int]:
    """Return the hinges of both arms."""
    return [k for chain in robot.arms.values() for k in chain.indices]


def test_low_pass_filter_of_clips_keeps_1_hz_motion_and_removes_25_hz_noise():
    times = resample_times(np.array([0.0, 3.0]))
    slow, fast = np.sin(2 * np.pi * times)[:, None], np.sin(2 * np.pi * 25 * times)[:, None]
    assert low_pass(slow + 0.1 * fast)[50:250] == pytest.approx(slow[50:250], abs=0.01)


@pytest.mark.parametrize("side", ["l", "r"])
def test_path_of_one_arm_equals_the_forward_kinematics_of_the_whole_robot(robot, side):
    angles = np.random.default_rng(3).uniform(robot.skeleton.lower, robot.skeleton.upper, (5, len(robot.skeleton.rest)))
    frames, arm = robot.body_frames(angles), robot.arm(side)
    base = robot.skeleton.segment(robot.skeleton.segments[robot.skeleton.segment(arm.segments[0])].parent)
    path = arm_path(robot, side, angles)
    for reached, segment in ((path.elbow, arm.elbow), (path.wrist, arm.wrist)):
        offsets = frames.origins[:, segment] - frames.origins[:, arm.shoulder]
        expected = np.einsum("tji,tj->ti", frames.rotations[:, base], offsets) / robot.arm_length
        np.testing.assert_allclose(reached, expected, atol=1e-12)
