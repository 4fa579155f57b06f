import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.passive_shoulder import carry_shoulder
from kinesic.ik.arm.swivel import swivel_of
from kinesic.ik.scalar3 import cross, distance, minus, norm, unit, vector
from kinesic.ik.solve import solve

from ...reference.ik import shoulder_elbow
from ...reference.ik.hinges import extract
from ...reference.ik.shoulder_elbow import MAX_STRETCH_RATIO, TAUT_RATIO, bend_elbow, gap, place_of, place_shoulder

DEFAULT_ROBOT = Robot.load()
ARM_CHAIN = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(ARM_CHAIN)  # linkage of the left arm
REST_ANGLES = ARM_CHAIN.rest.tolist()  # [rad]
# [m] shoulder centre at rest, in the frame of the arm's base
SHOULDER_POSITION = ARM_LINKAGE.walk(REST_ANGLES, 1)[1][-1]
HIGH_TARGET = np.array([0.25, 0.2, 0.2])  # [m] target above the shoulder
LOW_TARGET = np.array([0.25, 0.2, -0.2])  # [m] target below the shoulder


def test_shoulder_stays_at_rest_for_targets_within_easy_reach() -> None:
    place = place_shoulder(ARM_LINKAGE, (0.3, 0.2, -0.1), near=REST_ANGLES, rest=REST_ANGLES)
    assert place.shoulder == SHOULDER_POSITION
    assert place.target == (0.3, 0.2, -0.1)
    assert place.iterations == 0


def test_shoulder_rises_more_the_farther_the_target_beyond_easy_reach() -> None:
    lifts = []
    for share in (TAUT_RATIO, TAUT_RATIO + 0.01, 1.0, 1.02, 1.05):
        place = place_shoulder(
            ARM_LINKAGE,
            (SHOULDER_POSITION[0], SHOULDER_POSITION[1], SHOULDER_POSITION[2] + share * ARM_LINKAGE.farthest),
            near=REST_ANGLES,
            rest=REST_ANGLES,
        )
        lifts.append(place.shoulder[2] - SHOULDER_POSITION[2])
    assert lifts == sorted(lifts)
    assert lifts[0] == 0.0
    assert lifts[1] < 0.01
    assert lifts[-1] > 0.02


def test_unreachable_target_is_moved_towards_the_shoulder_into_reach() -> None:
    target = (0.3, 2.0, 1.5)
    place = place_shoulder(ARM_LINKAGE, target, near=REST_ANGLES, rest=REST_ANGLES)
    assert distance(place.shoulder, place.target) == pytest.approx(MAX_STRETCH_RATIO * ARM_LINKAGE.farthest)
    assert norm(cross(unit(minus(place.target, place.shoulder)), unit(minus(target, place.shoulder)))) < 1e-12
    assert gap(ARM_LINKAGE, target) == pytest.approx(distance(place.shoulder, target))


def test_shoulder_target_gap_equals_the_least_distance_of_a_dense_search() -> None:
    random, collar = default_rng(11), ARM_LINKAGE.pivots[0]
    for _ in range(20):
        target = tuple(random.uniform(-0.8, 0.8, 3).tolist())
        turns = [collar.lower + k * (collar.upper - collar.lower) / 100 for k in range(101)]
        nearest = min(distance(ARM_LINKAGE.walk([turn], 1)[1][-1], target) for turn in turns)
        assert gap(ARM_LINKAGE, target) == pytest.approx(nearest, abs=1e-5)
        assert gap(ARM_LINKAGE, target) <= nearest + 1e-12


def test_elbow_bend_meets_a_requested_swivel_within_the_joint_ranges() -> None:
    place = place_shoulder(ARM_LINKAGE, (0.25, 0.15, -0.05), near=REST_ANGLES, rest=REST_ANGLES)
    for wished in (0.0, 0.4, 0.9):
        bend = bend_elbow(ARM_LINKAGE, place, near=REST_ANGLES, swivel=wished)
        assert bend.exact
        assert swivel_of(ARM_LINKAGE, ARM_LINKAGE.walk(bend.angles, 3)[1][-3:]) == pytest.approx(wished)


def test_infeasible_swivel_request_stops_at_a_joint_limit() -> None:
    place = place_shoulder(ARM_LINKAGE, (0.25, 0.15, -0.05), near=REST_ANGLES, rest=REST_ANGLES)
    bend = bend_elbow(ARM_LINKAGE, place, near=REST_ANGLES, swivel=2.5)
    swivel_angle = swivel_of(ARM_LINKAGE, ARM_LINKAGE.walk(bend.angles, 3)[1][-3:])
    assert bend.exact
    assert swivel_angle is not None
    assert 1.2 < swivel_angle < 2.5
    stops = [min(a - p.lower, p.upper - a) for p, a in zip(ARM_LINKAGE.pivots, bend.angles, strict=False)]
    assert min(stops[1:]) < 0.02


def test_shoulder_position_and_target_of_a_posture_are_recovered() -> None:
    hand = vector(ARM_CHAIN.hand(ARM_CHAIN.rest))
    place = place_of(ARM_LINKAGE, REST_ANGLES, hand)
    assert place.shoulder == SHOULDER_POSITION
    assert place.target == hand


def test_passive_shoulder_keeps_the_rest_posture_at_zero_effort():
    assert carry_shoulder(ARM_CHAIN, HIGH_TARGET, 0.0) is ARM_CHAIN.rest


@pytest.mark.parametrize(("target", "sign"), [(HIGH_TARGET, 1.0), (LOW_TARGET, -1.0)])
def test_shoulder_effort_moves_the_shoulder_towards_the_hand(target, sign):
    followed = [
        sign * (carry_shoulder(ARM_CHAIN, target, effort)[0] - ARM_CHAIN.rest[0]) for effort in (0.0, 0.3, 0.6, 1.0)
    ]
    assert followed == sorted(followed)
    assert followed[-1] > np.radians(5)
    np.testing.assert_array_equal(carry_shoulder(ARM_CHAIN, target, 1.0)[1:], ARM_CHAIN.rest[1:])


def test_shoulder_moves_more_for_a_distant_target_than_for_a_near_one():
    shoulder = ARM_CHAIN.frames(ARM_CHAIN.rest)[1][1]
    near, far = (carry_shoulder(ARM_CHAIN, shoulder + share * (HIGH_TARGET - shoulder), 0.5)[0] for share in (0.5, 0.9))
    assert far > near > 0.0


def test_shoulder_raised_by_effort_stays_in_range_and_keeps_the_hand_position():
    for target in (HIGH_TARGET, LOW_TARGET, np.array([0.0, 0.9, 2.0])):
        rest = carry_shoulder(ARM_CHAIN, target, 1.0)
        assert np.all((ARM_CHAIN.lower <= rest) & (rest <= ARM_CHAIN.upper))
    pulled = solve(
        ARM_CHAIN, Reach(HIGH_TARGET), start=ARM_CHAIN.rest, rest=carry_shoulder(ARM_CHAIN, HIGH_TARGET, 1.0)
    )
    assert pulled.residual < 1e-6
    assert pulled.angles[0] == pytest.approx(carry_shoulder(ARM_CHAIN, HIGH_TARGET, 1.0)[0])


def test_shoulder_solution_of_the_right_arm_mirrors_that_of_the_left_arm():
    flip = np.array([1.0, -1.0, 1.0])
    np.testing.assert_array_equal(
        carry_shoulder(DEFAULT_ROBOT.arms["r"], HIGH_TARGET * flip, 0.7), carry_shoulder(ARM_CHAIN, HIGH_TARGET, 0.7)
    )


def test_ik_tries_one_swivel_angle_for_a_target_closer_than_the_elbow_can_bend(monkeypatch) -> None:
    looked, down = [], np.array(unit((0.3, 0.3, -0.9)))
    near = vector(np.add(SHOULDER_POSITION, 0.9 * ARM_LINKAGE.closest * down))
    place = place_shoulder(ARM_LINKAGE, near, near=REST_ANGLES, rest=REST_ANGLES)
    monkeypatch.setattr(shoulder_elbow, "extract", lambda *asked: looked.append(asked) or extract(*asked))
    bend = bend_elbow(ARM_LINKAGE, place, near=REST_ANGLES, swivel=0.4)
    assert not bend.exact
    assert len(looked) == 1
    assert distance(ARM_LINKAGE.hand(bend.angles), near) < 0.11 * ARM_LINKAGE.closest
    points = ARM_LINKAGE.walk(bend.angles, 3)[1]
    assert swivel_of(ARM_LINKAGE, points[-3:]) == pytest.approx(0.4, abs=0.005)


def test_ik_tries_one_swivel_angle_without_iterations_for_a_target_beyond_the_arm_length(monkeypatch) -> None:
    looked, line = [], np.array(unit((0.3, 0.3, -0.9)))
    lengths = ARM_LINKAGE.links[-3].length, ARM_LINKAGE.links[-2].length
    far = vector(np.add(SHOULDER_POSITION, 1.02 * sum(lengths) * line))
    place = place_of(ARM_LINKAGE, REST_ANGLES, far)
    monkeypatch.setattr(shoulder_elbow, "extract", lambda *asked: looked.append(asked) or extract(*asked))
    bends = [bend_elbow(ARM_LINKAGE, place, near=REST_ANGLES, swivel=swivel) for swivel in (None, 0.4, 2.5)]
    assert [bend.iterations for bend in bends] == [0, 0, 0]
    assert len(looked) == 3
    np.testing.assert_allclose([bend.angles for bend in bends], [bends[0].angles] * 3, atol=1e-12)
    assert distance(ARM_LINKAGE.hand(bends[0].angles), far) == pytest.approx(0.02 * sum(lengths), rel=1e-6)
