import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.keyframes import Hand
from kinesic.planning.collision import (
    GAP_TOLERANCE,
    HOVER_DISTANCE,
    MAX_HINGE_STEP,
    MAX_TOUCH_DISTANCE,
    TOUCH_TOLERANCE,
    Spacing,
    _smallest,
    clear_hands,
    separate,
    touched_pair,
)
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.worst_postures import random_postures

DEFAULT_ROBOT = Robot.load()
CAPSULE_DISTANCES = CapsuleDistances(DEFAULT_ROBOT)  # self-distances of the robot
ARM_JOINTS = [*DEFAULT_ROBOT.joints("l_arm"), *DEFAULT_ROBOT.joints("r_arm")]  # hinge indices of both arms
MIN_CLEARANCE = 0.015  # [m] required clearance
REST_GAPS = CAPSULE_DISTANCES.gaps(DEFAULT_ROBOT.skeleton.rest[None])[0]  # [m] of all counted pairs at rest


def near_ones(count):
    """Return random postures with slight collisions."""
    postures = random_postures(DEFAULT_ROBOT.skeleton, 40 * count, seed=5)
    least = CAPSULE_DISTANCES.clearance(postures).distances
    return postures[(least < MIN_CLEARANCE - 0.002) & (least > -0.02)][:count]


def gaps(posture):
    return CAPSULE_DISTANCES.gaps(posture[None])[0]


def test_at_least_23_of_25_slightly_colliding_postures_become_collision_free():
    results = [
        separate(posture, ARM_JOINTS, DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE))
        for posture in near_ones(25)
    ]
    clear = [posture for posture in results if posture is not None]
    assert len(clear) >= 23
    for posture in clear:
        assert gaps(posture).min() >= MIN_CLEARANCE - 1e-9
        assert np.all(posture >= DEFAULT_ROBOT.skeleton.lower)
        assert np.all(posture <= DEFAULT_ROBOT.skeleton.upper)


def test_corrected_posture_has_just_the_required_clearance():
    for posture in near_ones(10):
        clear = separate(posture, ARM_JOINTS, DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE))
        if clear is not None:
            assert gaps(clear).min() <= MIN_CLEARANCE + 5 * GAP_TOLERANCE
            assert np.array_equal(np.delete(clear, ARM_JOINTS), np.delete(posture, ARM_JOINTS))


def test_collision_correction_leaves_a_collision_free_posture_unchanged():
    rest = DEFAULT_ROBOT.skeleton.rest
    assert np.array_equal(separate(rest, ARM_JOINTS, DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE)), rest)


def test_collision_correction_of_an_upper_arm_moves_the_elbow_more_than_the_hand():
    """Expect a hand displacement below half of the elbow displacement."""
    wrist = DEFAULT_ROBOT.skeleton.segment("r_wrist")
    elbow = DEFAULT_ROBOT.skeleton.segment("r_elbow")
    posture = DEFAULT_ROBOT.skeleton.rest.copy()
    posture[list(DEFAULT_ROBOT.joints("r_arm"))] = np.radians([0, 50, -22, -45, 120, 0, 0, 0])
    clear = separate(
        posture, DEFAULT_ROBOT.joints("r_arm"), DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE + 0.01)
    )
    before, after = (DEFAULT_ROBOT.skeleton.frames(angles).origins for angles in (posture, clear))
    ways = np.linalg.norm(after - before, axis=1)
    assert 0 < ways[wrist] < 0.5 * ways[elbow]


def test_segments_that_should_touch_approach_to_the_minimum_clearance():
    posture = DEFAULT_ROBOT.skeleton.rest.copy()
    bent = np.radians([0, 20, 0, -15, 80, 0, -20, 0])
    for side in ("l", "r"):
        posture[list(DEFAULT_ROBOT.joints(f"{side}_arm"))] = bent
    pair = next(k for k, pair in enumerate(DEFAULT_ROBOT.counted_pairs) if set(pair) == {"l_wrist", "r_wrist"})
    assert gaps(posture)[pair] > 0.05
    laid = separate(posture, ARM_JOINTS, DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE, touching=(pair,)))
    assert MIN_CLEARANCE <= gaps(laid)[pair] <= MIN_CLEARANCE + TOUCH_TOLERANCE
    left, right = (laid[list(DEFAULT_ROBOT.joints(f"{side}_arm"))] for side in ("l", "r"))
    np.testing.assert_allclose(left, right, atol=1e-9)


def test_collision_of_segments_that_the_given_joints_do_not_move_is_ignored():
    posture = DEFAULT_ROBOT.skeleton.rest.copy()
    posture[DEFAULT_ROBOT.skeleton.joint("l_shoulder_abduct")] = np.radians(-13)
    assert gaps(posture).min() < MIN_CLEARANCE
    assert np.array_equal(
        separate(posture, DEFAULT_ROBOT.joints("r_arm"), DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE)),
        posture,
    )


@pytest.mark.parametrize("room", [0.02, 0.03])
def test_collision_correction_separates_colliding_pairs_by_the_target_distance(room):
    for posture in near_ones(6):
        clear = separate(posture, ARM_JOINTS, DEFAULT_ROBOT, CAPSULE_DISTANCES, Spacing(MIN_CLEARANCE, room))
        if clear is not None:
            short = gaps(posture) < MIN_CLEARANCE
            assert gaps(clear)[short].min() >= room - 1e-9
            assert np.all(gaps(clear)[~short] >= np.minimum(gaps(posture)[~short], room) - 1e-9)


REST_HANDS = resting_hands(DEFAULT_ROBOT)  # rest poses of both hands


@pytest.mark.parametrize(
    ("touch", "segment"),
    [
        ("hand", "r_wrist"),
        ("forearm", "r_elbow"),
        ("upper_arm", "r_shoulder"),
        ("head", "skullbase"),
        ("chest", "vl5"),
        ("lap", "humanoid_root"),
    ],
)
def test_touched_body_parts_correspond_to_robot_segments(touch, segment):
    pair = touched_pair("l", touch, DEFAULT_ROBOT, REST_GAPS)
    assert set(DEFAULT_ROBOT.counted_pairs[pair]) == {"l_wrist", segment}


def test_hand_far_from_the_touched_body_part_is_not_moved():
    angles = DEFAULT_ROBOT.skeleton.rest
    assert (
        CAPSULE_DISTANCES.gaps(angles[None])[0][touched_pair("l", "hand", DEFAULT_ROBOT, REST_GAPS)]
        > MAX_TOUCH_DISTANCE
    )
    hands = {side: Hand(REST_HANDS[side], touch="hand") for side in ("l", "r")}
    assert np.array_equal(clear_hands(angles, hands, DEFAULT_ROBOT, CAPSULE_DISTANCES), angles)


def test_collision_correction_of_one_hand_leaves_the_other_arm_unchanged():
    angles = DEFAULT_ROBOT.skeleton.rest.copy()
    angles[DEFAULT_ROBOT.skeleton.joint("l_shoulder_abduct")] = np.radians(-13)
    clear = clear_hands(angles, {"l": Hand(REST_HANDS["l"])}, DEFAULT_ROBOT, CAPSULE_DISTANCES)
    assert (
        CAPSULE_DISTANCES.clearance(angles[None]).distances[0]
        < HOVER_DISTANCE
        <= CAPSULE_DISTANCES.clearance(clear[None]).distances[0]
    )
    right = list(DEFAULT_ROBOT.joints("r_arm"))
    assert np.array_equal(clear[right], angles[right])


def test_collision_correction_leaves_hanging_arms_unchanged():
    angles = np.zeros(22)
    assert np.array_equal(clear_hands(angles, {"l": Hand(), "r": Hand()}, DEFAULT_ROBOT, CAPSULE_DISTANCES), angles)


@pytest.mark.parametrize("touch", ["hand", "forearm", "chest", "head"])
@pytest.mark.parametrize("seed", range(3))
def test_touched_pair_is_the_nearest_pair_of_a_hand_segment_and_the_touched_part(touch, seed):
    robot = Robot.load("upper36")
    gaps = np.random.default_rng(seed).uniform(0.0, 0.1, len(robot.counted_pairs))
    pair = touched_pair("l", touch, robot, gaps)
    hand = {robot.arm("l").segments[-1], "l_fingers"}
    (part,) = set(robot.counted_pairs[pair]) - hand
    others = {part, "r_fingers", robot.arm("r").segments[-1]} if touch == "hand" else {part}
    counted = [k for k, names in enumerate(robot.counted_pairs) if set(names) & hand and set(names) & others]
    assert len(counted) > 1
    assert gaps[pair] == gaps[counted].min()


def test_cheapest_joint_step_satisfies_its_distance_constraints():
    step = _smallest(np.array([[1.0, 1.0]]), np.array([0.2]), np.eye(2))
    np.testing.assert_allclose(step, [0.1, 0.1], atol=1e-9)
    dear = _smallest(np.array([[1.0, 1.0]]), np.array([0.2]), np.diag([4.0, 1.0]))
    np.testing.assert_allclose(dear, [0.04, 0.16], atol=1e-9)
    np.testing.assert_allclose(_smallest(np.array([[1.0]]), np.array([-0.2]), np.eye(1)), [0.0], atol=1e-9)


@pytest.mark.parametrize(("most", "share"), [(0.6, 0.5), (0.3, 0.25), (0.15, 0.125)])
def test_contradictory_distance_constraints_are_violated_equally(most: float, share: float):
    """Require a step of at least 1 rad that stays below 1 rad."""
    rows, needed = np.array([[1.0], [-1.0]]), np.array([1.0, -most])
    np.testing.assert_allclose(_smallest(rows, needed, np.eye(1)), [share], atol=1e-6)


def test_infeasible_distance_constraints_have_no_joint_step():
    assert _smallest(np.array([[1.0], [-1.0]]), np.array([1.0, -0.1]), np.eye(1)) is None


def test_joint_step_of_a_collision_correction_is_limited_per_hinge():
    """Expect long steps to be scaled down as a whole."""
    seen = []

    class Watched:
        def gaps(self, postures):
            seen.append(postures[0].copy())
            return CAPSULE_DISTANCES.gaps(postures)

    deep = random_postures(DEFAULT_ROBOT.skeleton, 2000, seed=5)
    deep = deep[CAPSULE_DISTANCES.clearance(deep).distances < -0.03][:5]
    longest = 0.0
    for posture in deep:
        seen.clear()
        separate(posture, ARM_JOINTS, DEFAULT_ROBOT, Watched(), Spacing(MIN_CLEARANCE))
        steps = np.abs(np.diff(seen, axis=0)).max(axis=1)
        longest = max(longest, float(steps.max()))
    assert longest == pytest.approx(MAX_HINGE_STEP)
