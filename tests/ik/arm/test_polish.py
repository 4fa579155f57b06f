import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import distance, vector

from ...reference.ik.polish import MAX_ITERATIONS, polish

ARM_CHAIN = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(ARM_CHAIN)  # linkage of the left arm
REST_ANGLES = ARM_CHAIN.rest.tolist()  # [rad] rest angles of the arm's hinges
HINGE_MOBILITIES = [0.1, *[1.0] * 7]  # mobility of each hinge, the first of them low


def test_numerical_ik_correction_brings_a_near_hand_onto_its_target() -> None:
    random = default_rng(6)
    middle, half = 0.5 * (ARM_CHAIN.lower + ARM_CHAIN.upper), 0.5 * (ARM_CHAIN.upper - ARM_CHAIN.lower)
    for _ in range(50):
        angles = middle + 0.7 * half * random.uniform(-1, 1, 8)
        target = vector(ARM_CHAIN.hand(angles + random.uniform(-0.1, 0.1, 8)))
        polished = polish(ARM_LINKAGE, target, angles.tolist(), posture=REST_ANGLES, mobility=HINGE_MOBILITIES)
        assert polished.miss < 1e-6
        assert polished.miss == pytest.approx(distance(ARM_LINKAGE.hand(polished.angles), target), abs=1e-15)
        assert polished.rounds <= MAX_ITERATIONS


def test_numerical_correction_of_random_postures_does_not_increase_errors_or_leave_ranges() -> None:
    random = default_rng(7)
    for _ in range(50):
        angles = random.uniform(ARM_CHAIN.lower, ARM_CHAIN.upper)
        target = tuple(random.uniform(-0.8, 0.8, 3).tolist())
        polished = polish(ARM_LINKAGE, target, angles.tolist(), posture=REST_ANGLES, mobility=HINGE_MOBILITIES)
        assert polished.miss <= distance(ARM_LINKAGE.hand(angles.tolist()), target) + 1e-15
        assert np.all(ARM_CHAIN.lower[:5] <= polished.angles)
        assert np.all(polished.angles <= ARM_CHAIN.upper[:5])


def test_joint_without_mobility_is_unchanged_by_numerical_ik_correction() -> None:
    target = vector(ARM_CHAIN.hand(ARM_CHAIN.rest + 0.1))
    polished = polish(ARM_LINKAGE, target, REST_ANGLES, posture=REST_ANGLES, mobility=[0.0, *HINGE_MOBILITIES[1:]])
    assert polished.angles[0] == REST_ANGLES[0]
    assert polished.miss < 1e-6


def test_posture_with_the_hand_on_target_is_not_corrected() -> None:
    polished = polish(
        ARM_LINKAGE, ARM_LINKAGE.hand(REST_ANGLES), REST_ANGLES, posture=REST_ANGLES, mobility=HINGE_MOBILITIES
    )
    assert polished.rounds == 0
    assert polished.angles == tuple(REST_ANGLES[:5])


def test_numerical_ik_correction_compensates_for_a_joint_limit_with_other_joints() -> None:
    angles = [0.0, 0.5, 0.2, ARM_CHAIN.upper[3], 1.2, 0.0, 0.0, 0.0]
    outside = [0.0, 0.5, 0.2, ARM_CHAIN.upper[3] + 0.15, 1.2, 0.0, 0.0, 0.0]
    polished = polish(ARM_LINKAGE, ARM_LINKAGE.hand(outside), angles, posture=REST_ANGLES, mobility=HINGE_MOBILITIES)
    assert polished.miss < 1e-6
    assert polished.angles[3] <= ARM_CHAIN.upper[3]
