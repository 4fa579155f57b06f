import math

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.scalar3 import distance, turned, unit

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def test_one_hinge_rotates_a_direction_onto_another() -> None:
    assert turn_towards(Z, X, Y) == pytest.approx(math.pi / 2)
    assert turn_towards(Z, Y, X) == pytest.approx(-math.pi / 2)


def test_one_axis_rotation_minimises_the_angle_to_an_unreachable_direction() -> None:
    wanted = unit((1.0, 1.0, 3.0))
    angle = turn_towards(Z, X, wanted)
    assert angle is not None
    nearest = min(np.linspace(-math.pi, math.pi, 721), key=lambda a: distance(turned(X, Z, a), wanted))
    assert angle == pytest.approx(nearest, abs=0.01)


def test_direction_along_a_hinge_axis_gives_no_rotation_angle() -> None:
    assert turn_towards(Z, X, Z) is None
    assert turn_towards(Z, Z, X) is None


def test_two_oblique_hinge_axes_aim_a_direction_exactly_in_both_solutions() -> None:
    random = default_rng(3)
    for _ in range(50):
        first, second, rest = (unit(tuple(random.normal(size=3).tolist())) for _ in range(3))
        one, two = random.uniform(-3, 3, 2)
        wanted = turned(turned(rest, second, two), first, one)
        branches = first_of_two(first, second, rest, wanted)
        assert len(branches) == 2
        assert min(abs(math.remainder(branch - one, math.tau)) for branch in branches) < 1e-6
        for branch in branches:
            last = turn_towards(second, rest, turned(wanted, first, -branch))
            assert last is not None
            assert distance(turned(turned(rest, second, last), first, branch), wanted) < 1e-7


def test_two_axis_aiming_in_gimbal_lock_has_no_solution_angle() -> None:
    assert first_of_two(Z, X, Z, Z) == ()


def test_two_axis_aiming_at_an_unreachable_direction_gives_the_best_angle() -> None:
    second = unit((0.0, 1.0, 1.0))
    wanted = unit((1.0, 0.0, -2.0))
    (branch,) = first_of_two(Z, second, Z, wanted)

    def miss(angle: float) -> float:
        last = turn_towards(second, Z, turned(wanted, Z, -angle))
        return distance(turned(turned(Z, second, last or 0.0), Z, angle), wanted)

    assert miss(branch) <= min(miss(angle) for angle in np.linspace(-3.14, 3.14, 200)) + 1e-6
