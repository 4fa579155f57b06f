from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.blocks import write_overlapping_block, write_passage
from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.keyframes import Hand
from kinesic.ik.arm.swivel import swivel
from kinesic.planning import arm_postures
from kinesic.planning import plan as planning
from kinesic.planning.arm_postures import OPEN_SWIVEL, ArmKey, solve_keys, with_arms
from kinesic.planning.postures import solve_postures
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

DEFAULT_ROBOT = Robot.load()
REST_ANGLES = DEFAULT_ROBOT.skeleton.rest  # (n,) [rad] rest posture
HAND_POSITIONS = [
    (0.25, 0.12, 0.75),
    (0.2, 0.2, 0.9),
    (0.22, 0.05, 0.85),
]  # forward, outward, up [m], all within 80 % of the reach


def solved(place, *, side="l", palm=None, **manner):
    forward, outward, up = place
    position = sealed([forward, outward if side == "l" else -outward, up])
    hand = Hand(Reach(position, palm=palm), **manner)
    return with_arms(REST_ANGLES, {side: hand}, {side: hand.reach}, DEFAULT_ROBOT)


def elbow(angles, side="l"):
    origins = DEFAULT_ROBOT.skeleton.frames(angles).origins
    return abs(float(origins[DEFAULT_ROBOT.skeleton.segment(f"{side}_elbow")][1])) / DEFAULT_ROBOT.arm_length


@pytest.mark.parametrize("place", HAND_POSITIONS)
def test_growing_elbow_openness_moves_the_elbow_outwards_without_a_jump(place):
    offsets = [elbow(solved(place, openness=share)) for share in np.linspace(0.0, 1.0, 21)]
    steps = np.diff(offsets)
    assert np.all(steps > 0.0)
    assert steps.max() < 0.05
    assert offsets[-1] - offsets[0] >= 0.15


@pytest.mark.parametrize("palm", [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
def test_elbow_openness_has_priority_over_the_palm_direction(palm):
    arm = list(DEFAULT_ROBOT.joints("l_arm"))
    swivel_angle = swivel(DEFAULT_ROBOT.arms["l"], solved(HAND_POSITIONS[0], palm=sealed(palm), openness=1.0)[arm])
    assert swivel_angle == pytest.approx(OPEN_SWIVEL, abs=1e-6)


@pytest.mark.parametrize("manner", [{}, {"openness": 0.6}, {"effort": 1.0}, {"openness": 1.0, "effort": 1.0}])
def test_elbow_openness_and_effort_keep_the_hand_position_on_both_sides(manner):
    angles = [solved(HAND_POSITIONS[1], side=side, **manner) for side in SIDES]
    for side, found in zip(SIDES, angles, strict=True):
        wrist = DEFAULT_ROBOT.skeleton.frames(found).origins[DEFAULT_ROBOT.skeleton.segment(f"{side}_wrist")]
        np.testing.assert_allclose(np.abs(wrist), HAND_POSITIONS[1], atol=1e-6)
    left, right = (found[list(DEFAULT_ROBOT.joints(f"{side}_arm"))] for side, found in zip(SIDES, angles, strict=True))
    np.testing.assert_allclose(left, right, atol=1e-9)


def test_collar_bone_rotation_increases_with_shoulder_effort():
    collar = DEFAULT_ROBOT.joints("l_arm")[0]
    turned = [abs(solved(HAND_POSITIONS[1], effort=share)[collar]) for share in (0.0, 0.5, 1.0)]
    assert turned[0] == 0.0
    assert np.radians(2) < turned[1] < turned[2]


def test_arm_without_a_hand_target_takes_the_rest_posture():
    angles = solved(HAND_POSITIONS[0])
    np.testing.assert_array_equal(with_arms(angles, {"l": Hand()}, {"l": None}, DEFAULT_ROBOT), REST_ANGLES)


@pytest.mark.parametrize("place", [(2.0, 0.5, 1.2), (0.6, 1.5, 2.0), (1.0, -0.3, 0.5)])
def test_arm_points_at_distant_target(place):
    origins = DEFAULT_ROBOT.skeleton.frames(solved(place)).origins
    shoulder, _, wrist = (origins[DEFAULT_ROBOT.skeleton.segment(name)] for name in DEFAULT_ROBOT.chains["l_arm"][-3:])
    line, wanted = wrist - shoulder, np.array(place) - shoulder
    cosine = line @ wanted / np.linalg.norm(line) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(min(1.0, cosine))) < 1.0
    assert np.linalg.norm(line) > 0.99 * DEFAULT_ROBOT.arm_length


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("place", HAND_POSITIONS)
def test_shoulder_lift_raises_the_shoulder_and_keeps_the_hand(place, side):
    low, high = (solved(place, side=side, lift=lift) for lift in (0.0, 0.2))
    arm = DEFAULT_ROBOT.arm(side)
    (collar,) = arm.shoulder_lift_joints
    assert high[collar] - low[collar] == pytest.approx(0.2)
    below, above = (DEFAULT_ROBOT.skeleton.frames(angles).origins for angles in (low, high))
    assert above[arm.shoulder][2] > below[arm.shoulder][2] + 0.01
    np.testing.assert_allclose(above[arm.wrist], below[arm.wrist], atol=1e-6)
    most = solved(place, side=side, lift=2.0)
    assert most[collar] == pytest.approx(DEFAULT_ROBOT.skeleton.upper[collar])


def test_changed_palm_direction_turns_each_arm_hinge_by_less_than_110_degrees():
    angles, arm = np.array(REST_ANGLES), list(DEFAULT_ROBOT.arm("l").joints)
    angles[list(DEFAULT_ROBOT.joints("torso"))] = np.radians([0.0, -2.6, 0.0])
    angles[arm] = np.radians([14, 99, 39, -50, 89, 31, -21, 30])  # forward and up, elbow out
    reach = Reach(sealed([0.235, 0.374, 0.937]), sealed([0.999, 0.0, 0.045]), sealed([0.032, -0.707, -0.706]))
    result = with_arms(angles, {"l": Hand(reach, openness=0.68, effort=0.635, lift=0.063)}, {"l": reach}, DEFAULT_ROBOT)
    assert np.abs(result - angles)[arm].max() < np.radians(110)
    wrist = DEFAULT_ROBOT.skeleton.frames(result).origins[DEFAULT_ROBOT.arm("l").wrist]
    assert np.linalg.norm(wrist - reach.position) < 0.12, "and the hand is there"


DEFAULT_SETUP = set_up()  # setup with default options


class _EnoughError(Exception):
    """Signal that the key frames are complete."""


@pytest.fixture
def frames_of(monkeypatch):
    """Return the key frames of a document."""
    asked = []

    def stop(frames, robot, distances):
        asked.append(frames)
        raise _EnoughError

    def frames_of(text):
        monkeypatch.setattr(planning, "solve_postures", stop)
        with pytest.raises(_EnoughError):
            plan(text, DEFAULT_SETUP)
        return asked[-1]

    return frames_of


@pytest.fixture
def calls(monkeypatch):
    """Record the number of keys in each kernel call."""
    counted, real = [], arm_postures.pose_keys

    def count(chain, keys, *rest, **named):
        counted.append(len(keys))
        return real(chain, keys, *rest, **named)

    monkeypatch.setattr(arm_postures, "pose_keys", count)
    return counted


def _texts():
    lexemes = [form.id for form in DEFAULT_SETUP.lexicon.forms]
    return [write_passage(1), write_overlapping_block(3, lexemes), write_overlapping_block(17, lexemes)]


@pytest.mark.parametrize("text", _texts(), ids=["passage", "crowd 3", "crowd 17"])
def test_arm_keys_solved_together_equal_keys_solved_singly(text, frames_of, monkeypatch):
    frames = frames_of(text)
    together = solve_postures(frames, DEFAULT_SETUP.robot, DEFAULT_SETUP.distances)
    monkeypatch.setattr(arm_postures, "MAX_KEYS_PER_CALL", 1)
    alone = solve_postures(frames, DEFAULT_SETUP.robot, DEFAULT_SETUP.distances)
    for one, other in zip(together.postures, alone.postures, strict=True):
        assert np.array_equal(one.angles, other.angles)
    assert together.misses == alone.misses


def test_ik_of_a_text_passage_needs_one_kernel_call_per_arm(frames_of, calls):
    frames = frames_of(write_passage(1))
    solve_postures(frames, DEFAULT_SETUP.robot, DEFAULT_SETUP.distances)
    assert len(calls) == 2
    assert sum(calls) > 10


def test_ik_solves_at_most_two_keys_per_arm_and_frame_plus_one_batch_if_hands_collide(frames_of, calls):
    """Rely on batches that double in size until a collision occurs."""
    frames = frames_of(_texts()[2])
    solve_postures(frames, DEFAULT_SETUP.robot, DEFAULT_SETUP.distances)
    asked = sum(side in frame.given for frame in frames.frames for side in ("l_hand", "r_hand"))
    assert asked <= sum(calls) <= 4 * len(frames.frames) + arm_postures.MAX_KEYS_PER_CALL


def with_offset_axes(robot):
    hinges = tuple(replace(hinge, at=sealed([0.004, 0.003, -0.005])) for hinge in robot.skeleton.hinges)
    return replace(robot, skeleton=replace(robot.skeleton, hinges=hinges))


@pytest.mark.parametrize(
    "robot", [DEFAULT_ROBOT, with_offset_axes(DEFAULT_ROBOT)], ids=["intersecting axes", "offset axes"]
)
@pytest.mark.parametrize("passing", [True, False])
def test_start_of_a_hand_path_is_kept_only_by_keys_on_the_path(robot, passing):
    reach = Reach(sealed(HAND_POSITIONS[1]))
    hand = Hand(reach, passing=passing)
    key = ArmKey.of(robot, "l", hand, reach, robot.body_frames(REST_ANGLES))
    path_start = with_arms(REST_ANGLES, {"l": hand}, {"l": Reach(sealed(HAND_POSITIONS[0]))}, robot)[
        list(robot.arms["l"].indices)
    ]
    angles, beginnings = solve_keys(robot, "l", [key], REST_ANGLES[None], path_start=path_start)
    solved_arm = angles[0, list(robot.arms["l"].indices)]
    np.testing.assert_array_equal(beginnings[0], path_start if passing else solved_arm)
    assert np.abs(solved_arm - path_start).max() > 0.05


@pytest.mark.parametrize(
    "robot", [DEFAULT_ROBOT, with_offset_axes(DEFAULT_ROBOT)], ids=["intersecting axes", "offset axes"]
)
def test_first_key_on_a_hand_path_becomes_its_start(robot):
    reach = Reach(sealed(HAND_POSITIONS[1]))
    key = ArmKey.of(robot, "l", Hand(reach, passing=True), reach, robot.body_frames(REST_ANGLES))
    angles, beginnings = solve_keys(robot, "l", [key], REST_ANGLES[None], path_start=None)
    np.testing.assert_array_equal(beginnings[0], angles[0, list(robot.arms["l"].indices)])


def test_arms_with_offset_joint_axes_are_solved_key_by_key(frames_of, calls):
    foreign = with_offset_axes(DEFAULT_SETUP.robot)
    frames = frames_of(write_passage(2))
    postures = solve_postures(frames, foreign, DEFAULT_SETUP.distances)
    assert set(calls) == {1}
    assert max(postures.misses.values()) < 5e-3
