from importlib.util import find_spec

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik import Kernel
from kinesic.ik.arm.multistart import reach, reach_many

ROBOT = Robot.load()
LEFT, RIGHT = ROBOT.arms["l"], ROBOT.arms["r"]
FLIP = np.array([1.0, -1.0, 1.0])
KERNELS: tuple[Kernel, ...] = ("numpy",) if find_spec("kinesic.ik._kernel") is None else ("numpy", "compiled")


@pytest.mark.parametrize("kernel", KERNELS)
def test_in_limit_targets_are_reached(kernel: Kernel) -> None:
    random = default_rng(31)
    for chain in (LEFT, RIGHT):
        for _ in range(60):
            target, angles = chain.hand(random.uniform(chain.lower, chain.upper)), chain.rest.copy()
            residual = reach(chain, target, angles, kernel=kernel)
            assert residual < 1e-4
            assert residual == pytest.approx(np.linalg.norm(chain.hand(angles) - target), abs=1e-12)
            assert np.all((chain.lower <= angles) & (angles <= chain.upper))
            assert np.array_equal(angles[5:], chain.rest[5:])


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_start_outside_the_ranges_is_pulled_in(kernel: Kernel) -> None:
    target, inside, outside = LEFT.hand(LEFT.rest), LEFT.upper.copy(), LEFT.upper + 2.0
    reach(LEFT, target, inside, kernel=kernel)
    reach(LEFT, target, outside, kernel=kernel)
    assert np.array_equal(inside, outside)


@pytest.mark.parametrize("kernel", KERNELS)
def test_the_right_arm_mirrors_the_left(kernel: Kernel) -> None:
    target, left, right = LEFT.hand(LEFT.rest + 0.2), LEFT.rest.copy(), RIGHT.rest.copy()
    reach(LEFT, target, left, kernel=kernel)
    reach(RIGHT, target * FLIP, right, kernel=kernel)
    assert left == pytest.approx(right, abs=1e-9)


@pytest.mark.parametrize("kernel", KERNELS)
def test_what_is_no_question_is_refused(kernel: Kernel) -> None:
    with pytest.raises(ValueError, match="3 numbers"):
        reach(LEFT, np.zeros(2), LEFT.rest.copy(), kernel=kernel)
    with pytest.raises(ValueError, match="finite"):
        reach(LEFT, np.array([np.nan, 0, 0]), LEFT.rest.copy(), kernel=kernel)
    with pytest.raises(ValueError, match=r"\(m, 3\)"):
        reach_many(LEFT, np.zeros(3), LEFT.rest, kernel=kernel)
    with pytest.raises(ValueError, match="finite"):
        reach_many(LEFT, np.full((1, 3), np.inf), LEFT.rest, kernel=kernel)


@pytest.mark.parametrize("kernel", KERNELS)
def test_many_at_once_stay_inside_and_no_targets_are_no_error(kernel: Kernel) -> None:
    random = default_rng(32)
    targets = random.uniform(-0.6, 0.6, (40, 3))
    for chain in (LEFT, RIGHT):
        angles, residuals = reach_many(chain, targets, chain.rest, rounds=12, kernel=kernel)
        assert np.all((chain.lower <= angles) & (angles <= chain.upper))
        for row, target, residual in zip(angles, targets, residuals, strict=True):
            assert residual == pytest.approx(np.linalg.norm(chain.hand(row) - target), abs=1e-12)
    angles, residuals = reach_many(LEFT, np.empty((0, 3)), LEFT.rest, kernel=kernel)
    assert (angles.shape, residuals.shape) == ((0, 8), (0,))


@pytest.mark.skipif("compiled" not in KERNELS, reason="the kernel was not compiled here")
def test_the_compiled_batch_is_the_specified_one_and_that_of_one_by_one() -> None:
    random = default_rng(33)
    targets = np.array([LEFT.hand(random.uniform(LEFT.lower, LEFT.upper)) for _ in range(200)])
    angles, residuals = reach_many(LEFT, targets, LEFT.rest, rounds=12, kernel="compiled")
    specified, misses = reach_many(LEFT, targets, LEFT.rest, rounds=12, kernel="numpy")
    assert angles == pytest.approx(specified, abs=1e-9)
    assert residuals == pytest.approx(misses, abs=1e-9)
    for target, row in zip(targets, angles, strict=True):
        alone, _ = reach_many(LEFT, target[None], LEFT.rest, rounds=12, kernel="compiled")
        assert np.array_equal(alone[0], row)
