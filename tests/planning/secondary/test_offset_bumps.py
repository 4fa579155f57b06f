import numpy as np
import pytest

from kinesic.motion.trajectory import KNOT_INTERVAL, stay
from kinesic.planning.secondary.changes import Changes

from .tilts import REST_ANGLES, STILL_MOTION, TILT_HINGE, swell


def laid_on(motion, swells):
    return Changes(motion, [swell for swell, _ in swells]).added(np.array([amount for _, amount in swells]))


def test_smooth_offset_rises_to_its_peak_and_returns_to_zero():
    laid = laid_on(STILL_MOTION, [(swell(1.0, 2.0, 4.0), 1.0)])
    angles, speeds, _ = laid.sample(np.array([0.0, 0.99, 2.0, 4.02, 5.0]))
    np.testing.assert_allclose(np.degrees(angles[:, TILT_HINGE]), [0.0, 0.0, 1.0, 0.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(speeds[:, TILT_HINGE], 0.0, atol=1e-3)
    np.testing.assert_allclose(
        np.delete(angles, TILT_HINGE, axis=1), np.tile(np.delete(REST_ANGLES, TILT_HINGE), (5, 1)), atol=1e-12
    )


def test_motion_is_unchanged_outside_the_time_spans_of_offsets():
    laid = laid_on(
        STILL_MOTION, [(swell(1.0, 1.5, 2.0), 1.0), (swell(3.0, 3.5, 4.0), 0.5), (swell(2.2, 2.4, 2.6), 0.0)]
    )
    outside = np.array([0.5, 0.97, 2.03, 2.4, 2.97, 4.03, 4.9])
    np.testing.assert_allclose(laid.sample(outside)[0], STILL_MOTION.sample(outside)[0], atol=1e-12)
    assert np.degrees(laid.at(3.5).angles[TILT_HINGE]) == pytest.approx(0.5, abs=1e-2)


def test_motion_is_extended_until_last_offset_ends():
    laid = laid_on(stay(REST_ANGLES, 0.1), [(swell(0.3, 1.0, 2.0), 1.0)])
    assert laid.end == pytest.approx(2.0, abs=2 * KNOT_INTERVAL)
    np.testing.assert_array_equal(laid.controls[:3], np.tile(REST_ANGLES, (3, 1)))
    np.testing.assert_array_equal(laid.controls[-3:], np.tile(REST_ANGLES, (3, 1)))


def test_motion_offset_is_smooth_up_to_acceleration():
    laid = laid_on(STILL_MOTION, [(swell(1.0, 2.0, 4.0), 1.0)])
    accelerations = laid.sample(np.arange(0.0, 5.0, KNOT_INTERVAL))[2][:, TILT_HINGE]
    assert np.abs(np.diff(accelerations)).max() < 0.08 * np.ptp(accelerations)
