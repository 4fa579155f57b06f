import numpy as np
import pytest

from kinesic.controller import tracking_errors
from kinesic.controller.tracking_errors import TrackingErrors, measure_errors

CHANCE = np.random.default_rng(4)
ERRORS = 0.02 * CHANCE.normal(size=(200, 5))
MOVING = CHANCE.random(ERRORS.shape) < 0.6


def test_errors_count_where_a_hinge_moves_and_the_largest_has_a_place():
    measured, moving = np.zeros((4, 2)), np.array([[True, False], [True, True], [True, True], [False, False]])
    measured[2, 1], measured[0, 1], measured[1, 0] = np.radians(3.0), np.radians(50.0), -np.radians(1.0)
    found = measure_errors(measured[moving], moving)
    assert found.max == pytest.approx(3.0)
    assert (found.row, found.hinge, found.most) == (2, 1, 1)
    assert found.rmse == pytest.approx(np.sqrt((9.0 + 1.0) / 5))
    assert found.p95 == pytest.approx(np.percentile([0.0, 0.0, 0.0, 1.0, 3.0], 95))


def test_where_nothing_moves_there_is_no_error():
    nothing = np.zeros_like(MOVING)
    assert measure_errors(np.zeros(0), nothing) == TrackingErrors(0.0, 0.0, 0.0, 0, 0, 0)


@pytest.mark.skipif(tracking_errors.KERNEL != "compiled", reason="no compiled kernel")
@pytest.mark.parametrize("count", [1, 2, 21, 200])
def test_the_kernel_measures_the_same(count, monkeypatch):
    moving = MOVING[:count].copy()
    moving[0, 0] = True
    fast = measure_errors(ERRORS[:count][moving], moving)
    monkeypatch.setattr(tracking_errors, "KERNEL", "numpy")
    slow = measure_errors(ERRORS[:count][moving], moving)
    for name in ("rmse", "p95", "max"):
        assert getattr(fast, name) == pytest.approx(getattr(slow, name), rel=1e-14)
    assert (fast.row, fast.hinge, fast.most) == (slow.row, slow.hinge, slow.most)


@pytest.mark.skipif(tracking_errors.KERNEL != "compiled", reason="no compiled kernel")
@pytest.mark.parametrize("count", [0, 1, -1])
def test_errors_that_are_not_those_of_what_moves_are_refused(count):
    errors = np.zeros(MOVING.sum() + count) if count else np.zeros(0)
    with pytest.raises(ValueError, match="do not fit"):
        measure_errors(errors, MOVING)


@pytest.mark.parametrize("kernel", sorted({tracking_errors.KERNEL, "numpy"}))
@pytest.mark.parametrize("every", [1, 7])
def test_an_error_that_is_no_number_is_the_largest(kernel, every, monkeypatch):
    monkeypatch.setattr(tracking_errors, "KERNEL", kernel)
    errors = ERRORS.copy()
    errors[3::every] = np.nan
    found = measure_errors(errors[MOVING], MOVING)
    assert np.isnan([found.rmse, found.p95, found.max]).all()
    assert (found.row, found.hinge) == (3, MOVING[3].argmax())
