import numpy as np
import pytest

from kinesic.expressivity.face.envelope import FADING, OVERSHOOT, QUICKEST, WIDEST, Envelope
from kinesic.expressivity.style.style import Expressivity

TIMES = {"start": 1.0, "attackPeak": 1.5, "relax": 2.0, "end": 3.0}


def test_it_is_at_its_peak_from_attack_peak_to_relax_and_nothing_outside():
    course = Envelope.of(TIMES)
    np.testing.assert_array_equal(course.at(np.array([0.0, 1.0, 3.0, 9.0])), 0.0)
    np.testing.assert_array_equal(course.at(np.array([1.5, 1.7, 2.0])), 1.0)
    np.testing.assert_allclose(course.at(np.array([1.25, 2.5])), 0.5)
    rising = course.at(np.linspace(1.0, 1.5, 50))
    assert np.all(np.diff(rising) > 0.0)


def test_what_stays_never_goes_back():
    course = Envelope.of({"start": 1.0, "end": 2.0}, stays=True)
    np.testing.assert_allclose(course.at(np.array([1.0, 1.5, 2.0, 1e6])), [0.0, 0.5, 1.0, 1.0])


@pytest.mark.parametrize("stays", [False, True])
def test_points_that_coincide_leave_the_quickest_way(stays: bool):
    times = dict.fromkeys(TIMES, 1.0)
    found = Envelope.of(times, stays=stays).at(np.linspace(0.9, 1.2, 301))
    assert np.abs(np.diff(found)).max() < 1e-3 / QUICKEST * 2
    assert found.max() == pytest.approx(1.0, abs=1e-2)


FINE = np.linspace(0.9, 3.1, 2201)


@pytest.mark.parametrize("manner", [Expressivity(power=p, fluidity=f, spatial=w) for p, f, w in np.eye(3)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_every_manner_keeps_the_four_times(manner: Expressivity, sign: float):
    manner = Expressivity(**{name: sign * value for name, value in vars(manner).items() if value})
    found = Envelope.of(TIMES).at(FINE, manner)
    assert np.all(found[(FINE <= 1.0) | (FINE >= 3.0)] == 0.0)
    assert np.all(found[(FINE > 1.01) & (FINE < 2.99)] > 0.0)
    peak = found[np.searchsorted(FINE, 1.5)]
    assert np.all(np.diff(found[FINE <= 1.5]) >= -1e-12)
    assert np.all(found[FINE > 1.5] <= peak + 1e-12)


def test_a_wide_face_shows_more_and_a_tight_one_less():
    peaks = [Envelope.of(TIMES).at(FINE, Expressivity(spatial=value)).max() for value in (-1.0, -0.4, 0.0, 1.0)]
    np.testing.assert_allclose(peaks, [1.0 - WIDEST, 1.0 - 0.4 * WIDEST, 1.0, 1.0 + WIDEST])


def test_power_comes_early_and_overshoots_and_weakness_comes_late_and_fades():
    strong, plain, weak = (Envelope.of(TIMES).at(FINE, Expressivity(power=value)) for value in (1.0, 0.0, -1.0))
    half = [float(FINE[np.argmax(course >= 0.5)]) for course in (strong, plain, weak)]
    assert half == sorted(half)
    assert half[0] < half[1] - 0.03 < half[2] - 0.06
    assert strong.max() == pytest.approx(1.0 + OVERSHOOT, abs=0.01)
    before_relax = np.searchsorted(FINE, 2.0)
    assert strong[before_relax] == pytest.approx(1.0, abs=0.01)
    assert weak[before_relax] == pytest.approx(1.0 - FADING, abs=0.01)


def test_a_jerky_face_begins_abruptly():
    jerk = [np.abs(np.diff(Envelope.of(TIMES).at(FINE, Expressivity(fluidity=f)), 2)).max() for f in (0.0, -0.5, -1.0)]
    assert jerk == sorted(jerk)
    assert jerk[2] > 10 * jerk[0]
