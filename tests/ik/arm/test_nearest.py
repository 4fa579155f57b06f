import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench.ik.tasks import best_posture
from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import vector
from kinesic.ik.solve import solve

from ...reference.ik.nearest import finish

LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(LEFT_ARM)  # linkage of the left arm
SHOULDER_POSITION = np.array([0.0, 0.155, -0.035])  # (3,) [m] in the frame of the arm's base


def _beyond(count: int, *, seed: int) -> list[Floats]:
    """Return unreachable targets: too far, too near, or behind the back."""
    random, results = default_rng(seed), []
    while len(results) < count:
        direction = random.normal(size=3)
        length = random.uniform(0.1, 1.5) * ARM_LINKAGE.farthest
        target = SHOULDER_POSITION + direction * length / np.linalg.norm(direction)
        if not solve(LEFT_ARM, Reach(target), start=LEFT_ARM.rest).reached:
            results.append(target)
    return results


@pytest.mark.soak
def test_ik_residual_of_unreachable_targets_is_close_to_the_optimum():
    gaps = []
    for target in _beyond(20, seed=41):
        first = solve(LEFT_ARM, Reach(target), start=LEFT_ARM.rest)
        result = finish(ARM_LINKAGE, vector(target), [first.angles.tolist()])
        gaps.append(result.miss - best_posture(LEFT_ARM, Reach(target), starts=8).residual)
    assert np.mean(np.array(gaps) < 5e-3) >= 0.95
    assert np.mean(np.array(gaps) < 1e-3) >= 0.9


def test_ik_residual_of_targets_behind_the_back_is_within_1_1_mm_of_the_optimum():
    random = default_rng(45)
    behind = [np.array([-0.52, -0.15, -0.052]), np.array([-1.932, -0.421, -0.073]), np.array([-2.568, -0.377, -0.184])]
    for _ in range(3):
        direction = np.array([-1.0, random.uniform(-0.6, 0.1), random.uniform(-0.5, 0.3)])
        behind.append(
            SHOULDER_POSITION + random.uniform(1.0, 8.0) * ARM_LINKAGE.farthest * direction / np.linalg.norm(direction)
        )
    for target in behind:
        best = best_posture(LEFT_ARM, Reach(target), starts=8).residual
        assert solve(LEFT_ARM, Reach(target), start=LEFT_ARM.rest).residual < best + 1.1e-3


def test_ik_keeps_the_first_posture_if_others_gain_less_than_1_mm():
    target = vector(LEFT_ARM.hand(LEFT_ARM.rest))
    away = LEFT_ARM.rest + np.array([0.1, 0.3, 0.3, 0.2, 0.4, 0.0, 0.0, 0.0])
    assert finish(ARM_LINKAGE, target, [away.tolist(), LEFT_ARM.rest.tolist()]).miss < 1e-9
    near = LEFT_ARM.rest + np.array([0.0, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    kept = finish(ARM_LINKAGE, target, [near.tolist(), LEFT_ARM.rest.tolist()])
    assert kept.angles == tuple(near.tolist()[: len(kept.angles)])
    assert 1e-4 < kept.miss < 1e-3


def test_nearest_arm_posture_for_unreachable_targets_is_in_range_and_no_worse_than_its_start():
    random = default_rng(42)
    for target in _beyond(40, seed=43):
        start = random.uniform(LEFT_ARM.lower, LEFT_ARM.upper)
        result = finish(ARM_LINKAGE, vector(target), [start.tolist()])
        angles = np.array([*result.angles, *start[len(result.angles) :]])
        assert np.all((LEFT_ARM.lower <= angles) & (angles <= LEFT_ARM.upper))
        assert abs(np.linalg.norm(LEFT_ARM.hand(angles) - target) - result.miss) < 1e-12
        assert result.miss <= np.linalg.norm(LEFT_ARM.hand(start) - target)
        assert result.rounds <= 30


def test_nearest_arm_posture_is_a_coordinatewise_optimum():
    for target in _beyond(15, seed=44):
        result = finish(ARM_LINKAGE, vector(target), [LEFT_ARM.rest.tolist()])
        for k in range(len(result.angles)):
            for step in (-1e-4, 1e-4):
                moved = np.array([*result.angles, *LEFT_ARM.rest[len(result.angles) :]])
                moved[k] = np.clip(moved[k] + step, LEFT_ARM.lower[k], LEFT_ARM.upper[k])
                assert np.linalg.norm(LEFT_ARM.hand(moved) - target) > result.miss - 1e-6


def test_nearest_posture_search_keeps_an_arm_with_its_hand_on_target():
    result = finish(ARM_LINKAGE, vector(LEFT_ARM.hand(LEFT_ARM.rest)), [LEFT_ARM.rest.tolist()])
    assert np.abs(np.array(result.angles) - LEFT_ARM.rest[: len(result.angles)]).max() < 1e-9
