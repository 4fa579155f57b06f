import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import qp
from kinesic.motion.bspline import grid
from kinesic.motion.qp import nearest_motion, nearest_without_limits
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def segment(pieces: int, start: float, end: float, **keys: float) -> SplineSegment:
    """From rest to rest; keys by their place, as p15=0.3."""
    places, angles = np.array([float(name[1:]) for name in keys]), np.array([*keys.values()])
    return SplineSegment(0, 0, grid(pieces, STEP), start, end, places, angles)


def largest(found: SplineSegment, controls) -> float:
    return max(float(np.abs(share).max()) for share in found.grid.shares(controls, LIMITS, 0))


def test_a_gentle_wish_is_followed_as_it_is():
    way = segment(60, 0.0, 0.5)
    s = np.linspace(0, 1, 61)
    wish = 0.5 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    controls = nearest_motion(way, wish, LIMITS)
    np.testing.assert_array_equal(controls, nearest_without_limits(way, wish))
    np.testing.assert_allclose(way.grid.at_knots @ controls, wish, atol=2e-4)


def test_a_sharp_wish_is_followed_as_far_as_the_limits_go():
    way = segment(60, 0.0, 0.5, p30=0.25)
    wish = np.where(np.arange(61) < 30, 0.0, 0.5)
    wish[30] = 0.25
    controls = nearest_motion(way, wish, LIMITS)
    assert largest(way, nearest_without_limits(way, wish)) > 5.0
    assert largest(way, controls) == pytest.approx(1.0, abs=1e-6)
    matrix, values = way.fixed
    np.testing.assert_allclose(matrix @ controls, values, atol=1e-9)


def test_it_is_the_optimum():
    way = segment(60, 0.0, 0.5)
    wish = np.where(np.arange(61) < 30, 0.0, 0.5)
    best = nearest_motion(way, wish, LIMITS)
    rng = np.random.default_rng(5)

    def cost(controls) -> float:
        return float(np.sum((way.grid.at_knots @ controls - wish) ** 2))

    for _ in range(200):
        other = nearest_motion(way, wish + rng.normal(scale=0.02, size=61), LIMITS)
        assert cost(best) <= cost(other) + 1e-9


def test_what_cannot_be_is_none():
    assert nearest_motion(segment(20, 0.0, 1.5), np.linspace(0, 1.5, 21), LIMITS) is None


def test_what_does_not_move_needs_no_program():
    np.testing.assert_array_equal(
        nearest_motion(segment(20, 0.3, 0.3, p5=0.3), np.full(21, 0.3), LIMITS), np.full(23, 0.3)
    )


def test_many_keys_are_passed_as_few_are():
    """A sparse system finds the same as a dense one."""
    rng = np.random.default_rng(8)
    places = np.arange(30, 3000, 30) + rng.uniform(-5, 5, 99)
    way = SplineSegment(0, 0, grid(3030, STEP), 0.0, 0.0, places, rng.uniform(-0.5, 0.5, 99))
    wish = np.interp(np.arange(3031), [0, *places, 3030], [0, *way.angles, 0])
    matrix, values = way.fixed
    assert len(values) >= qp.MANY
    for found in (nearest_without_limits(way, wish), qp.smoothest(way)):
        np.testing.assert_allclose(matrix @ found, values, atol=1e-9)
    sparse = nearest_without_limits(way, wish)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(qp, "MANY", 1000)
        np.testing.assert_allclose(sparse, nearest_without_limits(way, wish), atol=1e-9)
