"""Sine, cosine and arc tangent of our own, against the library's; and the same bits with the kernel and without."""

import math
from importlib.util import find_spec

import pytest
from numpy.random import default_rng

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.angles import arccosine, arctangent, cosine_sine
from kinesic.ik.solve import solve


def test_sine_and_cosine_are_the_librarys() -> None:
    for angle in default_rng(1).uniform(-20.0, 20.0, 2000).tolist():
        assert cosine_sine(angle) == pytest.approx((math.cos(angle), math.sin(angle)), abs=3e-16)


def test_quarters_of_a_turn() -> None:
    for k in range(-8, 9):
        assert cosine_sine(k * math.pi / 2.0) == pytest.approx(
            (math.cos(k * math.pi / 2.0), math.sin(k * math.pi / 2.0))
        )


def test_the_arc_tangent_is_the_librarys() -> None:
    for y, x in default_rng(2).normal(size=(2000, 2)).tolist():
        assert arctangent(y, x) == pytest.approx(math.atan2(y, x), rel=1e-15)


@pytest.mark.parametrize("y", [0.0, -0.0, 1.0, -1.0, 1e-300])
@pytest.mark.parametrize("x", [0.0, -0.0, 1.0, -1.0, 1e300])
def test_the_arc_tangent_on_the_axes(y: float, x: float) -> None:
    assert arctangent(y, x) == math.atan2(y, x)
    assert math.copysign(1.0, arctangent(y, x)) == math.copysign(1.0, math.atan2(y, x))


def test_the_arc_cosine_is_the_librarys_and_has_both_ends() -> None:
    for x in default_rng(3).uniform(-1.0, 1.0, 2000).tolist():
        assert arccosine(x) == pytest.approx(math.acos(x), rel=1e-15)
    assert (arccosine(1.0), arccosine(-1.0)) == (0.0, math.pi)


@pytest.mark.skipif(find_spec("kinesic.ik._kernel") is None, reason="the kernel was not compiled here")
def test_whole_solves_have_the_same_bits_with_the_kernel_and_without() -> None:
    random = default_rng(4)
    for chain in Robot.load().arms.values():
        for k in range(100):
            swivel = float(random.uniform(-9.0, 9.0)) if k % 3 == 0 else None
            reach = Reach(chain.hand(random.uniform(chain.lower, chain.upper)), random.normal(size=3), swivel=swivel)
            start = random.uniform(chain.lower, chain.upper)
            one, other = (solve(chain, reach, start=start, kernel=kernel) for kernel in ("numpy", "compiled"))
            assert one.angles.tobytes() == other.angles.tobytes()
            assert (one.residual, one.iterations) == (other.residual, other.iterations)
