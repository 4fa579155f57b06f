import math

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.scalar3 import distance, turned, unit

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def test_one_hinge_takes_a_direction_onto_another() -> None:
    assert turn_towards(Z, X, Y) == pytest.approx(math.pi / 2)
    assert turn_towards(Z, Y, X) == pytest.approx(-math.pi / 2)


def test_one_hinge_comes_nearest_to_a_direction_out_of_its_plane() -> None:
    wanted = unit((1.0, 1.0, 3.0))
    angle = turn_towards(Z, X, wanted)
    assert angle is not None
    nearest = min(np.linspace(-math.pi, math.pi, 721), key=lambda a: distance(turned(X, Z, a), wanted))
    assert angle == pytest.approx(nearest, abs=0.01)


def test_a_direction_along_the_hinge_defines_no_angle() -> None:
    assert turn_towards(Z, X, Z) is None
    assert turn_towards(Z, Z, X) is None


def test_two_hinges_aim_exactly_on_both_branches_even_when_oblique() -> None:
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


def test_two_hinges_in_gimbal_lock_have_no_first_angle() -> None:
    assert first_of_two(Z, X, Z, Z) == ()


def test_two_hinges_out_of_reach_give_the_one_nearest_angle() -> None:
    second = unit((0.0, 1.0, 1.0))
    wanted = unit((1.0, 0.0, -2.0))
    (branch,) = first_of_two(Z, second, Z, wanted)

    def miss(angle: float) -> float:
        last = turn_towards(second, Z, turned(wanted, Z, -angle))
        return distance(turned(turned(Z, second, last or 0.0), Z, angle), wanted)

    assert miss(branch) <= min(miss(angle) for angle in np.linspace(-3.14, 3.14, 200)) + 1e-6
