from typing import get_args

import numpy as np
import pytest
from scipy.interpolate import BPoly

from kinesic.motion.easing import DEFAULT_OVERSHOOT, EASING_INTERVALS, Easing, ease, overshoot_shape, soften_easing

EASING_NAMES = get_args(Easing)  # names of all easings
SAMPLE_TIMES = np.linspace(0.0, 1.0, 2001)  # normalised times from 0 to 1


def played(easing: Easing, steepness: float) -> BPoly:
    """Return the softened easing as a function of time."""
    return BPoly.from_derivatives(np.linspace(0.0, 1.0, EASING_INTERVALS + 1), soften_easing(easing, steepness).T)


@pytest.mark.parametrize("easing", EASING_NAMES)
def test_every_easing_starts_at_0_and_ends_at_1(easing):
    np.testing.assert_allclose(ease(easing, np.array([-0.5, 0.0, 1.0, 1.5])), [0.0, 0.0, 1.0, 1.0], atol=1e-12)


@pytest.mark.parametrize(
    ("easing", "begins", "ends"),
    [("minimum_jerk", 0.0, 0.0), ("linear", 1.0, 1.0), ("out_quart", 4.0, 0.0), ("out_back", 4.70158, 0.0)],
)
def test_end_velocities_of_easings_match_their_formulas(easing, begins, ends):
    step = 1e-6
    assert ease(easing, np.array([step]))[0] / step == pytest.approx(begins, abs=1e-4)
    assert (1 - ease(easing, np.array([1 - step]))[0]) / step == pytest.approx(ends, abs=1e-4)


def test_out_back_overshoots_by_the_requested_ratio():
    for share in (0.02, 0.05, 0.1, 0.2):
        assert ease("out_back", SAMPLE_TIMES, overshoot=share).max() == pytest.approx(1 + share, abs=1e-4)
    assert overshoot_shape(DEFAULT_OVERSHOOT) == pytest.approx(1.70158, abs=1e-4)


def test_out_bounce_bounces_three_times_without_overshoot():
    values = ease("out_bounce", SAMPLE_TIMES)
    assert values.max() <= 1.0
    tops = np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] > values[2:]))
    assert len(tops) == 3


@pytest.mark.parametrize("steepness", [1.0, 2.0, 4.0, 8.0])
def test_initial_slope_of_out_power_easing_equals_its_steepness(steepness):
    assert ease("out_power", np.array([1e-6]), steepness=steepness)[0] / 1e-6 == pytest.approx(steepness, rel=1e-4)
    assert np.all(np.diff(ease("out_power", SAMPLE_TIMES, steepness=steepness)) >= 0.0)


def test_velocity_of_late_easing_peaks_after_80_percent_of_its_time():
    steep = (3.5, 5.0, 6.5, 8.0)
    speeds = [played("late", steepness)(SAMPLE_TIMES, nu=1) for steepness in steep]
    assert all(SAMPLE_TIMES[speed.argmax()] > 0.8 for speed in speeds)
    tops = [speed.max() for speed in speeds]
    assert np.all(np.diff(tops) > 0.1)
    assert tops[0] < 2.3, "hardly more than the 1.875 of minimum jerk"
    np.testing.assert_allclose(played("late", 1.0)(SAMPLE_TIMES), played("minimum_jerk", 1.0)(SAMPLE_TIMES), atol=2e-3)


@pytest.mark.parametrize("easing", EASING_NAMES)
def test_softened_easing_goes_from_rest_to_rest(easing):
    for steepness in (1.0, 2.5, 8.0):
        table = soften_easing(easing, steepness)
        np.testing.assert_allclose(table[:, 0], 0.0)
        np.testing.assert_allclose(table[:, -1], [1.0, 0.0, 0.0])


@pytest.mark.parametrize("easing", [easing for easing in EASING_NAMES if easing != "minimum_jerk"])
def test_softened_easing_is_the_weighted_moving_average_of_the_easing(easing):
    curve = played(easing, 3.0)
    step = 1e-4
    inner = SAMPLE_TIMES[1:-1]
    np.testing.assert_allclose((curve(inner + step) - curve(inner - step)) / (2 * step), curve(inner, nu=1), atol=1e-3)
    window = 3.0**-1.5 if easing == "late" else 0.5
    average = np.mean(
        [
            ease(easing, (inner - window * s) / (1 - window), steepness=3.0) * 30 * s**2 * (1 - s) ** 2
            for s in SAMPLE_TIMES
        ],
        axis=0,
    )
    np.testing.assert_allclose(curve(inner), average, atol=2e-3)


@pytest.mark.parametrize("easing", [easing for easing in EASING_NAMES if easing != "minimum_jerk"])
def test_easings_of_lowest_steepness_equal_minimum_jerk(easing):
    np.testing.assert_allclose(
        soften_easing(easing, 1.0)[0], ease("minimum_jerk", np.linspace(0, 1, EASING_INTERVALS + 1)), atol=1e-3
    )


def test_steepness_raises_peak_velocity_and_overshoot_of_out_back_easing():
    curves = [played("out_back", steepness) for steepness in np.linspace(1.0, 8.0, 15)]
    assert np.all(np.diff([curve(SAMPLE_TIMES, nu=1).max() for curve in curves]) > 0.0)
    assert np.all(np.diff([curve(SAMPLE_TIMES).max() for curve in curves]) > 0.0)
    assert curves[6](SAMPLE_TIMES, nu=1).max() > 2.0 * 1.875


INNER_TIMES = np.linspace(0.02, 0.98, 49)  # normalised times without the ends


def test_easings_match_their_published_formulas():
    back = 1.70158
    formulas = {
        "minimum_jerk": 10 * INNER_TIMES**3 - 15 * INNER_TIMES**4 + 6 * INNER_TIMES**5,
        "linear": INNER_TIMES,
        "out_quart": 1 - (1 - INNER_TIMES) ** 4,
        "out_power": 1 - (1 - INNER_TIMES) ** 4,
        "late": INNER_TIMES**2,
        "out_back": 1 + (back + 1) * (INNER_TIMES - 1) ** 3 + back * (INNER_TIMES - 1) ** 2,
    }
    for easing, values in formulas.items():
        np.testing.assert_allclose(ease(easing, INNER_TIMES), values, atol=1e-5, err_msg=easing)
    np.testing.assert_allclose(ease("late", INNER_TIMES, steepness=6.0), INNER_TIMES**2.5)
    np.testing.assert_allclose(ease("out_power", INNER_TIMES, steepness=2.5), 1 - (1 - INNER_TIMES) ** 2.5)


def test_out_bounce_touches_the_end_between_parabolas_of_falling_height():
    touches, tops = np.array([1.0, 2.0, 2.5]) / 2.75, np.array([1.5, 2.25, 2.625]) / 2.75
    assert ease("out_bounce", touches) == pytest.approx(1.0)
    assert ease("out_bounce", touches - 1e-9) == pytest.approx(1.0, abs=1e-7)
    assert ease("out_bounce", tops) == pytest.approx([0.75, 0.9375, 0.984375])
    assert ease("out_bounce", np.array([0.1, 0.2])) == pytest.approx(7.5625 * np.array([0.01, 0.04]))


def test_overshoot_shape_solves_its_cubic_equation():
    for overshoot in (0.01, 0.07, 0.1, 0.5, 3.0):
        s = overshoot_shape(overshoot)
        assert s > 0.0
        assert 4 * s**3 / (27 * (s + 1) ** 2) == pytest.approx(overshoot)


def bell(x):
    """Return the velocity of minimum jerk, and its slope."""
    x = np.clip(x, 0.0, 1.0)
    return 30 * x**2 * (1 - x) ** 2, 60 * x * (1 - x) * (1 - 2 * x)


@pytest.mark.parametrize("steepness", [2.0, 3.0, 5.5, 8.0])
def test_softened_linear_easing_has_the_derivatives_of_an_averaged_ramp(steepness):
    window, even = 2.0 / (1.0 + steepness), np.linspace(0.0, 1.0, 17)
    begun, ended = even / window, (even - 1.0 + window) / window
    table = soften_easing("linear", steepness)
    assert table.shape == (3, 17)
    speed = ease("minimum_jerk", begun) - ease("minimum_jerk", ended)
    np.testing.assert_allclose(table[1], speed / (1.0 - window), atol=2e-3)
    force = bell(begun)[0] - bell(ended)[0]
    np.testing.assert_allclose(table[2], force / (window * (1.0 - window)), atol=2e-2)


@pytest.mark.parametrize(
    ("steepness", "window"), [(1.0, 1.0), (2.0, 2**-1.5), (3.0, 3**-1.5), (5.0, 0.18), (8.0, 0.18)]
)
def test_late_easing_is_averaged_over_a_window_that_shrinks_to_18_percent(steepness, window):
    even, s = np.linspace(0.0, 1.0, 17)[1:-1, None], (np.arange(4000) + 0.5) / 4000
    raw = np.clip((even - window * s) / max(1.0 - window, 1e-9), 0.0, 1.0) ** (1.0 + steepness / 4.0)
    np.testing.assert_allclose(soften_easing("late", steepness)[0, 1:-1], np.mean(raw * bell(s)[0], axis=1), atol=1e-4)


def test_softened_minimum_jerk_ignores_its_steepness():
    even = np.linspace(0.0, 1.0, 17)
    for steepness in (1.0, 4.0, 8.0):
        table = soften_easing("minimum_jerk", steepness)
        np.testing.assert_allclose(table[0], ease("minimum_jerk", even), atol=1e-6)
        np.testing.assert_allclose(table[1:], bell(even), atol=1e-4)


def test_softened_easing_overshoots_by_the_requested_ratio_or_a_tenth():
    small, usual, large = (played_overshoot(share) for share in (0.02, 0.1, 0.3))
    assert 0.0 < small < usual < large
    default = BPoly.from_derivatives(np.linspace(0.0, 1.0, 17), soften_easing("out_back", 8.0).T)
    assert default(SAMPLE_TIMES).max() - 1.0 == pytest.approx(usual, abs=1e-9)


def played_overshoot(share: float) -> float:
    """Return the overshoot of a softened easing beyond its end."""
    table = soften_easing("out_back", 8.0, share)
    return float(BPoly.from_derivatives(np.linspace(0.0, 1.0, 17), table.T)(SAMPLE_TIMES).max()) - 1.0
