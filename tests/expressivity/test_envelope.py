import numpy as np
import pytest

from kinesic.expressivity.envelope import QUICKEST, Envelope

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
