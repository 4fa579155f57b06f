import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.multistart import reach, reach_many

from ...reference.ik import multistart as reference

DEFAULT_ROBOT = Robot.load()
LEFT_ARM = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
RIGHT_ARM = DEFAULT_ROBOT.arms["r"]  # chain of the right arm
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])  # signs that mirror a vector in the midline plane


def test_multistart_ik_reaches_feasible_targets() -> None:
    random = default_rng(31)
    for chain in (LEFT_ARM, RIGHT_ARM):
        for _ in range(60):
            target, angles = chain.hand(random.uniform(chain.lower, chain.upper)), chain.rest.copy()
            residual = reach(chain, target, angles)
            assert residual < 1e-4
            assert residual == pytest.approx(np.linalg.norm(chain.hand(angles) - target), abs=1e-12)
            assert np.all((chain.lower <= angles) & (angles <= chain.upper))
            assert np.array_equal(angles[5:], chain.rest[5:])


def test_multistart_ik_clips_a_start_posture_outside_the_ranges() -> None:
    target, inside, outside = LEFT_ARM.hand(LEFT_ARM.rest), LEFT_ARM.upper.copy(), LEFT_ARM.upper + 2.0
    reach(LEFT_ARM, target, inside)
    reach(LEFT_ARM, target, outside)
    assert np.array_equal(inside, outside)


def test_multistart_ik_of_the_right_arm_mirrors_the_left() -> None:
    target, left, right = LEFT_ARM.hand(LEFT_ARM.rest + 0.2), LEFT_ARM.rest.copy(), RIGHT_ARM.rest.copy()
    reach(LEFT_ARM, target, left)
    reach(RIGHT_ARM, target * MIRROR_SIGNS, right)
    assert left == pytest.approx(right, abs=1e-9)


def test_invalid_multistart_ik_targets_raise_an_error() -> None:
    with pytest.raises(ValueError, match="3 numbers"):
        reach(LEFT_ARM, np.zeros(2), LEFT_ARM.rest.copy())
    with pytest.raises(ValueError, match="finite"):
        reach(LEFT_ARM, np.array([np.nan, 0, 0]), LEFT_ARM.rest.copy())
    with pytest.raises(ValueError, match=r"\(m, 3\)"):
        reach_many(LEFT_ARM, np.zeros(3), LEFT_ARM.rest)
    with pytest.raises(ValueError, match="finite"):
        reach_many(LEFT_ARM, np.full((1, 3), np.inf), LEFT_ARM.rest)


def test_batched_ik_stays_in_range_and_accepts_an_empty_batch() -> None:
    random = default_rng(32)
    targets = random.uniform(-0.6, 0.6, (40, 3))
    for chain in (LEFT_ARM, RIGHT_ARM):
        angles, residuals = reach_many(chain, targets, chain.rest, rounds=12)
        assert np.all((chain.lower <= angles) & (angles <= chain.upper))
        for row, target, residual in zip(angles, targets, residuals, strict=True):
            assert residual == pytest.approx(np.linalg.norm(chain.hand(row) - target), abs=1e-12)
    angles, residuals = reach_many(LEFT_ARM, np.empty((0, 3)), LEFT_ARM.rest)
    assert (angles.shape, residuals.shape) == ((0, 8), (0,))


def test_batched_ik_equals_the_python_reference_and_single_calls() -> None:
    random = default_rng(33)
    targets = np.array([LEFT_ARM.hand(random.uniform(LEFT_ARM.lower, LEFT_ARM.upper)) for _ in range(200)])
    angles, residuals = reach_many(LEFT_ARM, targets, LEFT_ARM.rest, rounds=12)
    specified, misses = reference.reach_many(LEFT_ARM, targets, LEFT_ARM.rest, rounds=12)
    assert angles == pytest.approx(specified, abs=1e-9)
    assert residuals == pytest.approx(misses, abs=1e-9)
    for target, row in zip(targets, angles, strict=True):
        alone, _ = reach_many(LEFT_ARM, target[None], LEFT_ARM.rest, rounds=12)
        assert np.array_equal(alone[0], row)
