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

LEFT = Robot.load().arms["l"]
LINKAGE = linkage_of(LEFT)
SHOULDER = np.array([0.0, 0.155, -0.035])


def _beyond(count: int, *, seed: int) -> list[Floats]:
    """Return targets that the arm cannot reach: too far, too near or behind the back."""
    random, results = default_rng(seed), []
    while len(results) < count:
        direction = random.normal(size=3)
        length = random.uniform(0.1, 1.5) * LINKAGE.farthest
        target = SHOULDER + direction * length / np.linalg.norm(direction)
        if not solve(LEFT, Reach(target), start=LEFT.rest).reached:
            results.append(target)
    return results


@pytest.mark.soak
def test_ik_residual_of_unreachable_targets_is_close_to_the_optimum():
    gaps = []
    for target in _beyond(20, seed=41):
        first = solve(LEFT, Reach(target), start=LEFT.rest)
        result = finish(LINKAGE, vector(target), [first.angles.tolist()])
        gaps.append(result.miss - best_posture(LEFT, Reach(target), starts=8).residual)
    assert np.mean(np.array(gaps) < 5e-3) >= 0.95
    assert np.mean(np.array(gaps) < 1e-3) >= 0.9


def test_ik_residual_of_targets_behind_the_back_is_within_1_1_mm_of_the_optimum():
    random = default_rng(45)
    behind = [np.array([-0.52, -0.15, -0.052]), np.array([-1.932, -0.421, -0.073]), np.array([-2.568, -0.377, -0.184])]
    for _ in range(7):
        direction = np.array([-1.0, random.uniform(-0.6, 0.1), random.uniform(-0.5, 0.3)])
        behind.append(SHOULDER + random.uniform(1.0, 8.0) * LINKAGE.farthest * direction / np.linalg.norm(direction))
    for target in behind:
        best = best_posture(LEFT, Reach(target), starts=8).residual
        assert solve(LEFT, Reach(target), start=LEFT.rest).residual < best + 1.1e-3


def test_ik_keeps_the_first_posture_if_others_gain_less_than_1_mm():
    target = vector(LEFT.hand(LEFT.rest))
    away = LEFT.rest + np.array([0.1, 0.3, 0.3, 0.2, 0.4, 0.0, 0.0, 0.0])
    assert finish(LINKAGE, target, [away.tolist(), LEFT.rest.tolist()]).miss < 1e-9
    near = LEFT.rest + np.array([0.0, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    kept = finish(LINKAGE, target, [near.tolist(), LEFT.rest.tolist()])
    assert kept.angles == tuple(near.tolist()[: len(kept.angles)])
    assert 1e-4 < kept.miss < 1e-3


def test_nearest_arm_posture_for_unreachable_targets_is_in_range_and_no_worse_than_its_start():
    random = default_rng(42)
    for target in _beyond(40, seed=43):
        start = random.uniform(LEFT.lower, LEFT.upper)
        result = finish(LINKAGE, vector(target), [start.tolist()])
        angles = np.array([*result.angles, *start[len(result.angles) :]])
        assert np.all((LEFT.lower <= angles) & (angles <= LEFT.upper))
        assert abs(np.linalg.norm(LEFT.hand(angles) - target) - result.miss) < 1e-12
        assert result.miss <= np.linalg.norm(LEFT.hand(start) - target)
        assert result.rounds <= 30


def test_nearest_arm_posture_is_a_coordinatewise_optimum():
    for target in _beyond(15, seed=44):
        result = finish(LINKAGE, vector(target), [LEFT.rest.tolist()])
        for k in range(len(result.angles)):
            for step in (-1e-4, 1e-4):
                moved = np.array([*result.angles, *LEFT.rest[len(result.angles) :]])
                moved[k] = np.clip(moved[k] + step, LEFT.lower[k], LEFT.upper[k])
                assert np.linalg.norm(LEFT.hand(moved) - target) > result.miss - 1e-6


def test_nearest_posture_search_keeps_an_arm_with_its_hand_on_target():
    result = finish(LINKAGE, vector(LEFT.hand(LEFT.rest)), [LEFT.rest.tolist()])
    assert np.abs(np.array(result.angles) - LEFT.rest[: len(result.angles)]).max() < 1e-9
