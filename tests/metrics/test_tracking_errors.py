import numpy as np
import pytest

from kinesic.metrics.tracking_errors import TrackingErrors, measure_errors

from ..reference.metrics import paths

ERROR_GENERATOR = np.random.default_rng(4)
RANDOM_ERRORS = 0.02 * ERROR_GENERATOR.normal(size=(200, 5))  # [rad] tracking errors of five hinges
MOVING_FLAGS = ERROR_GENERATOR.random(RANDOM_ERRORS.shape) < 0.6  # whether each hinge moves in each sample


def test_error_statistics_use_only_moving_hinges_and_locate_the_largest_error():
    measured, moving = np.zeros((4, 2)), np.array([[True, False], [True, True], [True, True], [False, False]])
    measured[2, 1], measured[0, 1], measured[1, 0] = np.radians(3.0), np.radians(50.0), -np.radians(1.0)
    errors = measure_errors(measured[moving], moving)
    assert errors.max == pytest.approx(3.0)
    assert (errors.row, errors.hinge, errors.most) == (2, 1, 1)
    assert errors.rmse == pytest.approx(np.sqrt((9.0 + 1.0) / 5))
    assert errors.p95 == pytest.approx(np.percentile([0.0, 0.0, 0.0, 1.0, 3.0], 95))


def test_tracking_error_of_motionless_hinges_is_reported_as_zero():
    nothing = np.zeros_like(MOVING_FLAGS)
    assert measure_errors(np.zeros(0), nothing) == TrackingErrors(0.0, 0.0, 0.0, 0, 0, 0)


@pytest.mark.parametrize("count", [1, 2, 21, 200])
def test_compiled_error_statistics_equal_numpy(count):
    moving = MOVING_FLAGS[:count].copy()
    moving[0, 0] = True
    fast = measure_errors(RANDOM_ERRORS[:count][moving], moving)
    slow = paths.measure_errors(RANDOM_ERRORS[:count][moving], moving)
    for name in ("rmse", "p95", "max"):
        assert getattr(fast, name) == pytest.approx(getattr(slow, name), rel=1e-14)
    assert (fast.row, fast.hinge, fast.most) == (slow.row, slow.hinge, slow.most)


@pytest.mark.parametrize("count", [0, 1, -1])
def test_number_of_tracking_errors_must_match_the_moving_joints(count):
    errors = np.zeros(MOVING_FLAGS.sum() + count) if count else np.zeros(0)
    with pytest.raises(ValueError, match="do not fit"):
        measure_errors(errors, MOVING_FLAGS)


@pytest.mark.parametrize("every", [1, 7])
def test_nan_counts_as_the_largest_tracking_error(every):
    errors = RANDOM_ERRORS.copy()
    errors[3::every] = np.nan
    result = measure_errors(errors[MOVING_FLAGS], MOVING_FLAGS)
    expected = paths.measure_errors(errors[MOVING_FLAGS], MOVING_FLAGS)
    assert (result.row, result.hinge, result.most) == (expected.row, expected.hinge, expected.most)
    assert np.isnan([result.rmse, result.p95, result.max]).all()
    assert (result.row, result.hinge) == (3, MOVING_FLAGS[3].argmax())
