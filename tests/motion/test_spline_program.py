import numpy as np
import pytest

from kinesic._kernel import motion as kernel
from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import at_knots, grid
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.infeasibility import EASY_DEFICIT
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import (
    _linear_part,
    can_pass,
    nearest_motion,
    nearest_within_limits,
    nearest_without_limits,
    relax_limits,
    smoothest,
)
from kinesic.motion.trajectory import KNOT_INTERVAL

from ..naming import about
from ..reference.motion import spline_programs as reference

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def segment(pieces: int, start: float, end: float, **keys: float) -> SplineSegment:
    """Return a segment between rests, where `p15=0.3` is 0.3 rad at knot 15."""
    places, angles = np.array([float(name[1:]) for name in keys]), np.array([*keys.values()])
    return SplineSegment(0, 0, grid(pieces, KNOT_INTERVAL), start, end, places, angles)


def largest(found: SplineSegment, controls) -> float:
    return max(float(np.abs(share).max()) for share in found.grid.limit_ratios(controls, JOINT_LIMITS, 0))


def test_desired_motion_within_limits_is_followed_within_0_2_mrad():
    way = segment(60, 0.0, 0.5)
    s = np.linspace(0, 1, 61)
    wish = 0.5 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    controls = nearest_motion(way, wish, JOINT_LIMITS)
    np.testing.assert_array_equal(controls, nearest_without_limits(way, wish))
    np.testing.assert_allclose(at_knots(controls), wish, atol=2e-4)


def test_sharp_desired_motion_is_followed_up_to_the_limits():
    way = segment(60, 0.0, 0.5, p30=0.25)
    wish = np.where(np.arange(61) < 30, 0.0, 0.5)
    wish[30] = 0.25
    controls = nearest_motion(way, wish, JOINT_LIMITS)
    assert largest(way, nearest_without_limits(way, wish)) > 5.0
    assert largest(way, controls) == pytest.approx(1.0, abs=1e-6)
    matrix, values = way.fixed.matrix, way.fixed.values
    np.testing.assert_allclose(matrix @ controls, values, atol=1e-9)


def test_motion_within_limits_is_nearer_to_the_desired_motion_than_80_other_feasible_motions():
    way = segment(60, 0.0, 0.5)
    wish = np.where(np.arange(61) < 30, 0.0, 0.5)
    best = nearest_motion(way, wish, JOINT_LIMITS)
    rng = np.random.default_rng(5)

    def cost(controls) -> float:
        return float(np.sum((at_knots(controls) - wish) ** 2))

    for _ in range(80):
        other = nearest_motion(way, wish + rng.normal(scale=0.02, size=61), JOINT_LIMITS)
        assert cost(best) <= cost(other) + 1e-9


def test_infeasible_spline_program_returns_none():
    assert nearest_motion(segment(20, 0.0, 1.5), np.linspace(0, 1.5, 21), JOINT_LIMITS) is None


def test_segment_without_motion_stays_constant():
    np.testing.assert_array_equal(
        nearest_motion(segment(20, 0.3, 0.3, p5=0.3), np.full(21, 0.3), JOINT_LIMITS), np.full(23, 0.3)
    )


def many_keys() -> tuple[SplineSegment, Floats]:
    """Return a segment with 99 inner keys, and its desired angles."""
    rng = np.random.default_rng(8)
    places = np.arange(30, 3000, 30) + rng.uniform(-5, 5, 99)
    way = SplineSegment(0, 0, grid(3030, KNOT_INTERVAL), 0.0, 0.0, places, rng.uniform(-0.5, 0.5, 99))
    return way, np.interp(np.arange(3031), [0, *places, 3030], [0, *way.angles, 0])


def test_spline_through_many_keys_matches_sparse_and_dense_references():
    """Compare the kernel with sparse and dense linear solvers."""
    way, wish = many_keys()
    matrix, values = way.fixed.matrix, way.fixed.values
    assert len(values) >= reference.DENSE_ROWS
    band = nearest_without_limits(way, wish), smoothest(way)
    forms = (
        (way.grid.closeness_bands, _linear_part(way, wish)),
        (way.grid.calmness_bands, np.zeros(way.grid.size)),
    )
    sparse = [reference.smoothest(way, *form) for form in forms]
    dense = [reference.smoothest(way, *form, dense_rows=1000) for form in forms]
    for result, other, third in zip(band, sparse, dense, strict=True):
        np.testing.assert_allclose(matrix @ result, values, atol=1e-9)
        np.testing.assert_allclose(result, other, atol=1e-7)
        np.testing.assert_allclose(other, third, atol=1e-7)


def random_segment(seed: int) -> tuple[SplineSegment, Floats]:
    """Return a random segment of up to seven keys, and desired angles."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(0, 8))
    places = 8 + np.cumsum(rng.uniform(4, 40, count))
    pieces = int(np.ceil(8 + places[-1:].sum() + rng.uniform(8, 40)))
    keys = np.cumsum(rng.normal(0.0, 0.12, count + 2)).clip(-1.5, 1.5)
    way = SplineSegment(0, 0, grid(pieces, KNOT_INTERVAL), keys[0], keys[-1], places, keys[1:-1])
    wish = np.interp(np.arange(pieces + 1), [0, *places, pieces], keys)
    return way, wish + rng.normal(0.0, 0.05, pieces + 1)


def test_compiled_spline_programs_match_piqp():
    for seed in range(60):
        with about(f"seed {seed}"):
            way, wish = random_segment(seed)
            ours = nearest_within_limits(way, wish, JOINT_LIMITS), relax_limits(way, JOINT_LIMITS, easy=EASY_DEFICIT)
            theirs = (
                reference.nearest_within_limits(way, wish, JOINT_LIMITS),
                reference.relax_limits(way, JOINT_LIMITS, easy=EASY_DEFICIT),
            )
            compare(way, wish, *ours, *theirs)


def compare(way: SplineSegment, wish: Floats, ours, relaxed, theirs, other) -> None:
    """Assert that kernel and PIQP agree on motion and relaxation."""
    assert relaxed is not None
    if other is not None:
        assert relaxed.amount == pytest.approx(other.amount, abs=2e-6)
        exceeded = largest(way, relaxed.controls)
        assert exceeded <= 1.0 + 3.0 * max(relaxed.amount, 0.0) + 1e-6
    if theirs is None or ours is None:
        assert relaxed.amount > -1e-4, "what has room has a motion"
        return
    assert largest(way, ours) <= 1.0 + 1e-7
    np.testing.assert_allclose(way.fixed.matrix @ ours, way.fixed.values, atol=1e-8)
    assert distance(way, wish, ours) <= distance(way, wish, theirs) + 1e-8
    np.testing.assert_allclose(ours, theirs, atol=2e-3)


def distance(way: SplineSegment, wish: Floats, controls: Floats) -> float:
    """Return the objective that the solver minimizes, without its constant part."""
    form = reference.closeness(way.grid)
    return float(controls @ (form @ controls) / 2 - (reference.angles_matrix(way.grid).T @ wish) @ controls)


def test_feasibility_test_agrees_with_the_existence_of_a_motion_within_limits():
    stuck = 0
    for seed in range(60):
        with about(f"seed {seed}"):
            way, wish = random_segment(seed)
            result = can_pass(way, wish, JOINT_LIMITS)
            assert result == (nearest_within_limits(way, wish, JOINT_LIMITS) is not None)
            stuck += not result
    assert 4 <= stuck <= 40


def test_segment_becomes_feasible_with_the_wider_angle_range_of_its_desired_motion():
    way, wish = random_segment(7)
    narrow, wide = (relax_limits(way, JOINT_LIMITS, easy=EASY_DEFICIT, desired=desired) for desired in (None, wish))
    assert narrow.amount > 1e-3
    assert wide.amount < -1e-3


def test_no_random_feasible_change_of_control_points_improves_the_optimum():
    """Test that the objective does not fall towards other feasible motions."""
    judged = 0
    for seed in range(20):
        way, wish = random_segment(seed)
        best = nearest_within_limits(way, wish, JOINT_LIMITS)
        if best is None:  # there is no motion in this time
            continue
        slope = reference.closeness(way.grid) @ best - reference.angles_matrix(way.grid).T @ wish
        for other in range(20):
            rng = np.random.default_rng((seed, other))
            result = nearest_within_limits(way, wish + rng.normal(0.0, 0.1, len(wish)), JOINT_LIMITS)
            assert result is None or slope @ (result - best) >= -1e-6
            judged += result is not None
    assert judged >= 60


def test_multipliers_of_a_limit_relaxation_equal_its_finite_differences():
    way = segment(40, 0.0, 1.6, p17=0.8)
    result, more = relax_limits(way, JOINT_LIMITS, easy=EASY_DEFICIT), 1e-4
    farther = relax_limits(segment(40, 0.0, 1.6, p17=0.8 + more), JOINT_LIMITS, easy=EASY_DEFICIT)
    assert -result.fixed_multipliers[0] == pytest.approx((farther.amount - result.amount) / more, rel=0.02)
    assert (result.limit_multipliers >= 0.0).all()
    powers = way.grid.powers[way.grid.bounds == 1.0]
    assert float(result.limit_multipliers @ powers) == pytest.approx(
        1.0, abs=1e-4
    )  # one more of the relaxation is worth one


@pytest.mark.parametrize("broken", range(8))
def test_spline_kernel_arrays_of_wrong_length_raise_an_error(broken: int):
    way, wish = random_segment(1)
    fixed, grid_ = way.fixed, way.grid
    good = [
        fixed.first,
        fixed.weights,
        fixed.values,
        grid_.closeness_bands,
        np.convolve(wish, [1 / 6, 4 / 6, 1 / 6]),
        grid_.stencils(JOINT_LIMITS, 0),
        *way.corridor(JOINT_LIMITS, wish),
    ]
    assert kernel.nearest(*good) is None or len(kernel.nearest(*good)) == grid_.size
    bad = [array.ravel()[:-1].copy() if k == broken else array for k, array in enumerate(good)]
    with pytest.raises(ValueError, match="do not fit"):
        kernel.nearest(*bad)
    with pytest.raises(ValueError, match="do not fit"):
        kernel.smooth(fixed.first + np.int32(grid_.size), *good[1:5])


@pytest.mark.parametrize("begins", [10, 150, 450, 560])
def test_local_violation_changes_a_long_segment_only_locally(begins: int):
    """Compare the kernel's local solution with the optimum of the whole segment."""
    way = segment(600, 0.0, 0.0, p80=0.1, p300=-0.1, p520=0.1)
    ends, angles = np.array([0, 80, 300, 520, 600]), np.array([0.0, 0.1, -0.1, 0.1, 0.0])
    way_of = np.clip(np.searchsorted(ends, np.arange(601), side="right") - 1, 0, 3)
    shares = (np.arange(601) - ends[way_of]) / np.diff(ends)[way_of]
    wish = angles[way_of] + np.diff(angles)[way_of] * minimum_jerk(shares)
    wish[begins : begins + 20] += 0.08 * np.hanning(20)
    free, result = nearest_without_limits(way, wish), nearest_within_limits(way, wish, JOINT_LIMITS)
    assert largest(way, free) > 1.2
    assert largest(way, result) <= 1.0 + 1e-7
    changed = np.flatnonzero(np.abs(result - free) > 1e-9)
    assert 0 < np.ptp(changed) < 300
    np.testing.assert_allclose(way.fixed.matrix @ result, way.fixed.values, atol=1e-9)
    theirs = reference.nearest_within_limits(way, wish, JOINT_LIMITS)
    assert distance(way, wish, result) <= distance(way, wish, theirs) + 1e-9
    np.testing.assert_allclose(result, theirs, atol=1e-5)
