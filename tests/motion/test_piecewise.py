from math import perm

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PPoly

from kinesic.motion import piecewise
from kinesic.motion.piecewise import PiecewisePolynomial, QuinticSpline

MAX_AGE = 3.0  # [s] largest time since the start of an interval


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(1, 6), st.integers(1, 4))
def test_piecewise_polynomials_and_derivatives_match_scipy_inside_and_outside(
    seed: int, pieces: int, powers: int, curves: int
):
    random = np.random.default_rng(seed)
    times = random.normal() + np.cumsum(random.uniform(0.01, MAX_AGE - 1.0, pieces + 1))
    scales = 10.0 ** random.uniform(-3.0, 3.0, (powers, 1, 1))
    coefficients = scales * random.normal(size=(powers, pieces, curves))
    asked = np.concatenate([times, random.uniform(times[0] - 1.0, times[-1] + 1.0, 20)])
    own, known = PiecewisePolynomial(times, coefficients), PPoly(coefficients, times)
    most = np.abs(coefficients[::-1]).max(axis=(1, 2))  # of each power, from the constant on
    for order, values in enumerate(own.derivatives(asked, powers)):
        largest = sum(most[k] * perm(k, order) * MAX_AGE ** (k - order) for k in range(order, powers))
        assert np.all(np.abs(values - known(asked, nu=order)) <= 1e-14 * largest)
    assert np.array_equal(own.at(asked), own.derivatives(asked, 1)[0])


def test_piecewise_polynomial_at_a_breakpoint_uses_the_following_interval():
    steps = PiecewisePolynomial(np.array([0.0, 1.0, 3.0]), np.array([[[1.0], [2.0]]]))
    assert steps.at(np.array([-1.0, 0.0, np.nextafter(1.0, 0.0), 1.0, 3.0, 9.0]))[:, 0].tolist() == [1, 1, 1, 2, 2, 2]


@pytest.mark.parametrize("order", range(4))
def test_derivatives_of_a_cubic_match_calculus(order: int):
    cubic = PiecewisePolynomial(np.array([2.0, 5.0]), np.array([[[2.0]], [[-3.0]], [[5.0]], [[7.0]]]))
    since = np.array([0.0, 0.5, 2.0])
    exact = (
        2 * since**3 - 3 * since**2 + 5 * since + 7,
        6 * since**2 - 6 * since + 5,
        12 * since - 6,
        np.full(3, 12.0),
    )
    np.testing.assert_allclose(cubic.derivatives(2.0 + since, 4)[order][:, 0], exact[order], rtol=1e-14)


def test_quintic_spline_interpolates_its_states(monkeypatch):
    random = np.random.default_rng(3)
    curve = QuinticSpline(np.cumsum(random.uniform(0.1, 0.4, 9)), random.normal(size=(3, 9, 2)))
    np.testing.assert_allclose(curve.derivatives(curve.times, 3), curve.states, rtol=0, atol=1e-9)
    asked = random.uniform(curve.times[0] - 0.1, curve.times[-1] + 0.1, 50)
    at_once = curve.derivatives(asked, 4)
    assert curve._around(asked) is curve._around(asked[:1]), "of a short one the coefficients are kept"
    monkeypatch.setattr(piecewise, "TIMES_PER_EVALUATION", 7)
    assert len(curve._around(asked[:1]).times) == 2
    assert np.array_equal(curve.derivatives(asked, 4), at_once)
    assert curve.derivatives(asked[:0], 4).shape == (4, 0, 2)


def test_quintic_spline_of_a_known_polynomial_is_that_polynomial():
    times = np.array([-1.0, 0.5, 0.7, 2.0])
    powers = np.array([0.3, -1.0, 0.5, 2.0, -0.7, 0.2])  # highest first
    states = np.stack([np.polyval(np.polyder(powers, order), times) for order in range(3)])[:, :, None]
    asked = np.linspace(-1.0, 2.0, 31)
    values = QuinticSpline(times, states).derivatives(asked, 6)
    for order in range(6):
        np.testing.assert_allclose(values[order][:, 0], np.polyval(np.polyder(powers, order), asked), atol=1e-8)


def test_quintic_spline_evaluated_in_batches_equals_the_spline_evaluated_at_once(monkeypatch):
    random = np.random.default_rng(9)
    times = np.cumsum(random.uniform(0.1, 0.4, 12))
    states = random.normal(size=(3, 12, 2))
    asked = np.concatenate([times, random.uniform(times[0] - 0.3, times[-1] + 0.3, 40)])
    kept = QuinticSpline(times, states).derivatives(asked, 3)
    for most in (1, 5, 11, 12):
        monkeypatch.setattr(piecewise, "TIMES_PER_EVALUATION", most)
        np.testing.assert_array_equal(QuinticSpline(times, states).derivatives(asked, 3), kept)
