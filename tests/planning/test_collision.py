import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.keyframes import Hand
from kinesic.planning.collision import (
    EXACT,
    HOVER,
    NEAR_ENOUGH,
    SLACK,
    STRIDE,
    Spacing,
    _smallest,
    clear_hands,
    separate,
    touched_pair,
)
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.worst_postures import random_postures

ROBOT = Robot.load()
DISTANCES = CapsuleDistances(ROBOT)
ARMS = [*ROBOT.joints("l_arm"), *ROBOT.joints("r_arm")]
LEAST = 0.015
GAPS = DISTANCES.gaps(ROBOT.skeleton.rest[None])[0]  # [m] of all counted pairs at rest


def near_ones(count):
    """Random postures that come too near, not deep inside themselves."""
    postures = random_postures(ROBOT.skeleton, 40 * count, seed=5)
    least = DISTANCES.clearance(postures).distances
    return postures[(least < LEAST - 0.002) & (least > -0.02)][:count]


def gaps(posture):
    return DISTANCES.gaps(posture[None])[0]


def test_nearly_every_posture_finds_room_in_its_ranges():
    found = [separate(posture, ARMS, ROBOT, DISTANCES, Spacing(LEAST)) for posture in near_ones(25)]
    clear = [posture for posture in found if posture is not None]
    assert len(clear) >= 23
    for posture in clear:
        assert gaps(posture).min() >= LEAST - 1e-9
        assert np.all(posture >= ROBOT.skeleton.lower)
        assert np.all(posture <= ROBOT.skeleton.upper)


def test_it_goes_no_farther_than_needed():
    for posture in near_ones(10):
        clear = separate(posture, ARMS, ROBOT, DISTANCES, Spacing(LEAST))
        if clear is not None:
            assert gaps(clear).min() <= LEAST + 5 * EXACT
            assert np.array_equal(np.delete(clear, ARMS), np.delete(posture, ARMS))


def test_a_clear_posture_stays_as_it_is():
    rest = ROBOT.skeleton.rest
    assert np.array_equal(separate(rest, ARMS, ROBOT, DISTANCES, Spacing(LEAST)), rest)


def test_elbows_swing_before_hands_move():
    """An upper arm that grazes the shoulder girdle clears it with less than half of the way at the hand."""
    wrist = ROBOT.skeleton.segment("r_wrist")
    elbow = ROBOT.skeleton.segment("r_elbow")
    posture = ROBOT.skeleton.rest.copy()
    posture[list(ROBOT.joints("r_arm"))] = np.radians([0, 50, -22, -45, 120, 0, 0, 0])
    clear = separate(posture, ROBOT.joints("r_arm"), ROBOT, DISTANCES, Spacing(LEAST + 0.01))
    before, after = (ROBOT.skeleton.frames(angles).origins for angles in (posture, clear))
    ways = np.linalg.norm(after - before, axis=1)
    assert 0 < ways[wrist] < 0.5 * ways[elbow]


def test_a_pair_that_touches_comes_near():
    posture = ROBOT.skeleton.rest.copy()
    bent = np.radians([0, 20, 0, -15, 80, 0, -20, 0])
    for side in ("l", "r"):
        posture[list(ROBOT.joints(f"{side}_arm"))] = bent
    pair = next(k for k, pair in enumerate(ROBOT.counted_pairs) if set(pair) == {"l_wrist", "r_wrist"})
    assert gaps(posture)[pair] > 0.05
    laid = separate(posture, ARMS, ROBOT, DISTANCES, Spacing(LEAST, touching=(pair,)))
    assert LEAST <= gaps(laid)[pair] <= LEAST + SLACK
    left, right = (laid[list(ROBOT.joints(f"{side}_arm"))] for side in ("l", "r"))
    np.testing.assert_allclose(left, right, atol=1e-9)


def test_what_no_joint_moves_is_left_alone():
    posture = ROBOT.skeleton.rest.copy()
    posture[ROBOT.skeleton.joint("l_shoulder_abduct")] = np.radians(-13)
    assert gaps(posture).min() < LEAST
    assert np.array_equal(separate(posture, ROBOT.joints("r_arm"), ROBOT, DISTANCES, Spacing(LEAST)), posture)


@pytest.mark.parametrize("room", [0.02, 0.03])
def test_room_is_what_pairs_in_the_way_get(room):
    for posture in near_ones(6):
        clear = separate(posture, ARMS, ROBOT, DISTANCES, Spacing(LEAST, room))
        if clear is not None:
            short = gaps(posture) < LEAST
            assert gaps(clear)[short].min() >= room - 1e-9
            assert np.all(gaps(clear)[~short] >= np.minimum(gaps(posture)[~short], room) - 1e-9)


REST = resting_hands(ROBOT)


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
def test_words_name_segments(touch, segment):
    pair = touched_pair("l", touch, ROBOT, GAPS)
    assert set(ROBOT.counted_pairs[pair]) == {"l_wrist", segment}


def test_a_hand_far_from_what_it_touches_stays():
    angles = ROBOT.skeleton.rest
    assert DISTANCES.gaps(angles[None])[0][touched_pair("l", "hand", ROBOT, GAPS)] > NEAR_ENOUGH
    hands = {side: Hand(REST[side], touch="hand") for side in ("l", "r")}
    assert np.array_equal(clear_hands(angles, hands, ROBOT, DISTANCES), angles)


def test_a_hand_in_the_way_moves_and_the_other_does_not():
    angles = ROBOT.skeleton.rest.copy()
    angles[ROBOT.skeleton.joint("l_shoulder_abduct")] = np.radians(-13)
    clear = clear_hands(angles, {"l": Hand(REST["l"])}, ROBOT, DISTANCES)
    assert DISTANCES.clearance(angles[None]).distances[0] < HOVER <= DISTANCES.clearance(clear[None]).distances[0]
    right = list(ROBOT.joints("r_arm"))
    assert np.array_equal(clear[right], angles[right])


def test_arms_that_hang_are_left_alone():
    angles = np.zeros(22)
    assert np.array_equal(clear_hands(angles, {"l": Hand(), "r": Hand()}, ROBOT, DISTANCES), angles)


@pytest.mark.parametrize("touch", ["hand", "forearm", "chest", "head"])
@pytest.mark.parametrize("seed", range(3))
def test_a_hand_with_fingers_touches_with_what_is_nearer(touch, seed):
    robot = Robot.load("upper36")
    gaps = np.random.default_rng(seed).uniform(0.0, 0.1, len(robot.counted_pairs))
    pair = touched_pair("l", touch, robot, gaps)
    hand = {robot.arm("l").segments[-1], "l_fingers"}
    (part,) = set(robot.counted_pairs[pair]) - hand
    others = {part, "r_fingers", robot.arm("r").segments[-1]} if touch == "hand" else {part}
    counted = [k for k, names in enumerate(robot.counted_pairs) if set(names) & hand and set(names) & others]
    assert len(counted) > 1
    assert gaps[pair] == gaps[counted].min()


def test_smallest_step_meets_its_rows_and_no_more():
    step = _smallest(np.array([[1.0, 1.0]]), np.array([0.2]), np.eye(2))
    np.testing.assert_allclose(step, [0.1, 0.1], atol=1e-9)
    dear = _smallest(np.array([[1.0, 1.0]]), np.array([0.2]), np.diag([4.0, 1.0]))
    np.testing.assert_allclose(dear, [0.04, 0.16], atol=1e-9)
    np.testing.assert_allclose(_smallest(np.array([[1.0]]), np.array([-0.2]), np.eye(1)), [0.0], atol=1e-9)


@pytest.mark.parametrize(("most", "share"), [(0.6, 0.5), (0.3, 0.25), (0.15, 0.125)])
def test_rows_that_contradict_a_bound_are_met_by_halves(most: float, share: float):
    """A hinge has to turn by 1 rad and may turn by less."""
    rows, needed = np.array([[1.0], [-1.0]]), np.array([1.0, -most])
    np.testing.assert_allclose(_smallest(rows, needed, np.eye(1)), [share], atol=1e-6)


def test_rows_that_no_eighth_meets_have_no_step():
    assert _smallest(np.array([[1.0], [-1.0]]), np.array([1.0, -0.1]), np.eye(1)) is None


def test_no_hinge_turns_farther_in_a_round_than_a_stride():
    """A long step is made shorter as a whole, so that it keeps its direction; a short one is made whole."""
    seen = []

    class Watched:
        def gaps(self, postures):
            seen.append(postures[0].copy())
            return DISTANCES.gaps(postures)

    deep = random_postures(ROBOT.skeleton, 2000, seed=5)
    deep = deep[DISTANCES.clearance(deep).distances < -0.03][:5]
    longest = 0.0
    for posture in deep:
        seen.clear()
        separate(posture, ARMS, ROBOT, Watched(), Spacing(LEAST))
        steps = np.abs(np.diff(seen, axis=0)).max(axis=1)
        longest = max(longest, float(steps.max()))
    assert longest == pytest.approx(STRIDE)
