import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import distance, vector

from ...reference.ik.polish import MAX_ITERATIONS, polish

CHAIN = Robot.load().arms["l"]
ARM = linkage_of(CHAIN)
HOME = CHAIN.rest.tolist()
EASE = [0.1, *[1.0] * 7]


def test_numerical_ik_correction_brings_a_near_hand_onto_its_target() -> None:
    random = default_rng(6)
    middle, half = 0.5 * (CHAIN.lower + CHAIN.upper), 0.5 * (CHAIN.upper - CHAIN.lower)
    for _ in range(50):
        angles = middle + 0.7 * half * random.uniform(-1, 1, 8)
        target = vector(CHAIN.hand(angles + random.uniform(-0.1, 0.1, 8)))
        polished = polish(ARM, target, angles.tolist(), posture=HOME, mobility=EASE)
        assert polished.miss < 1e-6
        assert polished.miss == pytest.approx(distance(ARM.hand(polished.angles), target), abs=1e-15)
        assert polished.rounds <= MAX_ITERATIONS


def test_numerical_correction_of_random_postures_does_not_increase_errors_or_leave_ranges() -> None:
    random = default_rng(7)
    for _ in range(50):
        angles = random.uniform(CHAIN.lower, CHAIN.upper)
        target = tuple(random.uniform(-0.8, 0.8, 3).tolist())
        polished = polish(ARM, target, angles.tolist(), posture=HOME, mobility=EASE)
        assert polished.miss <= distance(ARM.hand(angles.tolist()), target) + 1e-15
        assert np.all(CHAIN.lower[:5] <= polished.angles)
        assert np.all(polished.angles <= CHAIN.upper[:5])


def test_joint_without_mobility_is_unchanged_by_numerical_ik_correction() -> None:
    target = vector(CHAIN.hand(CHAIN.rest + 0.1))
    polished = polish(ARM, target, HOME, posture=HOME, mobility=[0.0, *EASE[1:]])
    assert polished.angles[0] == HOME[0]
    assert polished.miss < 1e-6


def test_posture_with_the_hand_on_target_is_not_corrected() -> None:
    polished = polish(ARM, ARM.hand(HOME), HOME, posture=HOME, mobility=EASE)
    assert polished.rounds == 0
    assert polished.angles == tuple(HOME[:5])


def test_numerical_ik_correction_compensates_for_a_joint_limit_with_other_joints() -> None:
    angles = [0.0, 0.5, 0.2, CHAIN.upper[3], 1.2, 0.0, 0.0, 0.0]
    outside = [0.0, 0.5, 0.2, CHAIN.upper[3] + 0.15, 1.2, 0.0, 0.0, 0.0]
    polished = polish(ARM, ARM.hand(outside), angles, posture=HOME, mobility=EASE)
    assert polished.miss < 1e-6
    assert polished.angles[3] <= CHAIN.upper[3]
