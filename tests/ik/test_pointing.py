import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.pointing import best_swivel
from kinesic.ik.solve import Solution, solve

from ..reference.ik import pointing as reference

ARM_CHAINS = Robot.load().arms  # chains of both arms, by side
LEFT_ARM = ARM_CHAINS["l"]  # chain of the left arm


def _held(chain: Chain, angles: Floats, *, palm: bool) -> Reach:
    """Return the hand's position, pointing direction and palm direction in a posture."""
    rotations, centres = chain.frames(angles)
    along = centres[-1] - centres[-2]
    return Reach(centres[-2], along / np.linalg.norm(along), rotations[-1] @ chain.palm if palm else None)


def _direction_error(solution: Solution) -> float:
    return (solution.pointing_error or 0.0) + (solution.palm_error or 0.0)


@pytest.mark.parametrize(("palm", "satisfied"), [(False, 0.95), (True, 0.88)])
def test_swivel_search_meets_most_hand_directions_of_random_postures(palm, satisfied):
    random, before, after = default_rng(31), [], []
    for _ in range(100):
        reach = _held(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper), palm=palm)
        first, result = solve(LEFT_ARM, reach, start=LEFT_ARM.rest), best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest)
        assert _direction_error(result) <= _direction_error(first)
        assert np.all((LEFT_ARM.lower <= result.angles) & (result.angles <= LEFT_ARM.upper))
        assert np.linalg.norm(LEFT_ARM.hand(result.angles) - reach.position) == pytest.approx(result.residual, abs=1e-9)
        assert result.residual < 1e-4
        before.append(_direction_error(first))
        after.append(_direction_error(result))
    assert np.mean(np.array(after) < 0.01) >= satisfied
    assert np.percentile(after, 90) < 0.25 * np.percentile(before, 90)


def test_swivel_search_reports_the_direction_errors_of_the_posture_it_found():
    random = default_rng(32)
    for _ in range(20):
        reach = _held(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper), palm=True)
        result = best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest)
        now = _held(LEFT_ARM, result.angles, palm=True)
        for error, one, other in (
            (result.pointing_error, now.pointing, reach.pointing),
            (result.palm_error, now.palm, reach.palm),
        ):
            assert error is not None
            assert error == pytest.approx(2 * np.arcsin(np.linalg.norm(one - other) / 2), abs=1e-6)


@pytest.mark.parametrize("side", ["l", "r"])
@pytest.mark.parametrize("max_swivel", [np.pi, 0.6])
def test_compiled_elbow_swivel_search_equals_the_python_reference(side, max_swivel):
    random, swung, chain = default_rng(36), 0, ARM_CHAINS[side]
    for k in range(9):
        held = _held(chain, random.uniform(chain.lower, chain.upper), palm=k % 3 != 1)
        reach = Reach(held.position, held.pointing if k % 3 else None, held.palm)
        rest = random.uniform(chain.lower - 0.1, chain.upper + 0.1) if k % 4 == 0 else None
        one, two = (
            solve_swivel(chain, reach, start=chain.rest, rest=rest, max_swivel=max_swivel)
            for solve_swivel in (reference.best_swivel, best_swivel)
        )
        assert np.array_equal(one.angles, two.angles)
        assert (one.residual, one.pointing_error, one.palm_error) == (two.residual, two.pointing_error, two.palm_error)
        swung += not np.array_equal(two.angles, solve(chain, reach, start=chain.rest, rest=rest).angles)
    assert swung > 2


def test_swivel_search_returns_the_ik_solution_unchanged_if_direction_errors_are_small():
    for reach in (Reach(np.array([0.25, 0.15, -0.05])), _held(LEFT_ARM, LEFT_ARM.rest, palm=True)):
        first, result = solve(LEFT_ARM, reach, start=LEFT_ARM.rest), best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest)
        assert result.angles.tobytes() == first.angles.tobytes()


def test_swivel_search_keeps_a_requested_elbow_swivel():
    random = default_rng(33)
    held = _held(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper), palm=True)
    reach = Reach(held.position, held.pointing, held.palm, swivel=0.5)
    assert np.array_equal(
        best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest).angles, solve(LEFT_ARM, reach, start=LEFT_ARM.rest).angles
    )


def test_swivel_search_changes_the_elbow_swivel_by_at_most_its_limit():
    random, swung = default_rng(34), 0
    for _ in range(30):
        reach = _held(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper), palm=True)
        first = swivel(LEFT_ARM, solve(LEFT_ARM, reach, start=LEFT_ARM.rest).angles)
        swivel_angle = swivel(LEFT_ARM, best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest, max_swivel=0.5).angles)
        if first is None or swivel_angle is None:
            continue
        assert abs(np.arctan2(np.sin(swivel_angle - first), np.cos(swivel_angle - first))) <= 0.5 + 1e-6
        swung += abs(swivel_angle - first) > 1e-3
    assert swung > 5


def test_swivel_search_of_the_right_arm_mirrors_the_left():
    random, flip = default_rng(35), np.array([1.0, -1.0, 1.0])
    for _ in range(10):
        reach = _held(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper), palm=True)
        assert reach.pointing is not None
        assert reach.palm is not None
        mirrored = Reach(reach.position * flip, reach.pointing * flip, reach.palm * flip)
        left, right = (
            best_swivel(LEFT_ARM, reach, start=LEFT_ARM.rest),
            best_swivel(ARM_CHAINS["r"], mirrored, start=LEFT_ARM.rest),
        )
        assert np.abs(left.angles - right.angles).max() < 1e-9
