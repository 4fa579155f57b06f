"""Tests of portable trigonometric functions against Python's `math`."""

import math

import pytest
from numpy.random import default_rng

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.angles import arccosine, arctangent, cosine_sine
from kinesic.ik.solve import solve

from ..reference.ik import solve as reference


def test_portable_sine_and_cosine_match_the_python_library() -> None:
    for angle in default_rng(1).uniform(-20.0, 20.0, 2000).tolist():
        assert cosine_sine(angle) == pytest.approx((math.cos(angle), math.sin(angle)), abs=3e-16)


def test_sine_and_cosine_of_quarter_turns_match_the_math_module() -> None:
    for k in range(-8, 9):
        assert cosine_sine(k * math.pi / 2.0) == pytest.approx(
            (math.cos(k * math.pi / 2.0), math.sin(k * math.pi / 2.0))
        )


def test_portable_arc_tangent_matches_the_python_library() -> None:
    for y, x in default_rng(2).normal(size=(2000, 2)).tolist():
        assert arctangent(y, x) == pytest.approx(math.atan2(y, x), rel=1e-15)


@pytest.mark.parametrize("y", [0.0, -0.0, 1.0, -1.0, 1e-300])
@pytest.mark.parametrize("x", [0.0, -0.0, 1.0, -1.0, 1e300])
def test_arc_tangent_is_exact_on_the_axes(y: float, x: float) -> None:
    assert arctangent(y, x) == math.atan2(y, x)
    assert math.copysign(1.0, arctangent(y, x)) == math.copysign(1.0, math.atan2(y, x))


def test_portable_arc_cosine_matches_the_python_library() -> None:
    for x in default_rng(3).uniform(-1.0, 1.0, 2000).tolist():
        assert arccosine(x) == pytest.approx(math.acos(x), rel=1e-15)
    assert (arccosine(1.0), arccosine(-1.0)) == (0.0, math.pi)


def test_compiled_ik_solutions_are_bit_identical_to_the_python_reference() -> None:
    random = default_rng(4)
    for chain in Robot.load().arms.values():
        for k in range(40):
            swivel = float(random.uniform(-9.0, 9.0)) if k % 3 == 0 else None
            reach = Reach(chain.hand(random.uniform(chain.lower, chain.upper)), random.normal(size=3), swivel=swivel)
            start = random.uniform(chain.lower, chain.upper)
            one, other = (answer(chain, reach, start=start) for answer in (reference.solve, solve))
            assert one.angles.tobytes() == other.angles.tobytes()
            assert (one.residual, one.iterations) == (other.residual, other.iterations)
