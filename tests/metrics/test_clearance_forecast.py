"""Forecast of the clearance with recent tracking errors."""

import numpy as np
import pytest

from kinesic.metrics.clearance_forecast import forecast_clearance
from tests.wall import Wall

WALL = Wall()


def test_clearance_forecast_uses_earlier_tracking_errors():
    planned = np.full((100, 1), 0.05)
    planned[60:] = 0.02
    measured = planned.copy()
    measured[50] += 0.015
    rooms = forecast_clearance(planned, measured, WALL, every=10)
    assert rooms[5] == pytest.approx(0.035)
    assert rooms[7] == pytest.approx(0.005)  # the error was before the wall came near
    np.testing.assert_allclose(rooms[:5], 0.05)
    assert rooms[0] == pytest.approx(0.05)


class RoughWall(Wall):
    """Wall with lower bounds that are 1 mm too low."""

    def bounds(self, angles, turns):
        return super().bounds(angles, turns) - 0.001


def test_smallest_clearance_forecast_equals_exhaustive_search():
    rng = np.random.default_rng(4)
    for _ in range(20):
        planned, errors = rng.uniform(0.02, 0.06, (90, 1)), rng.normal(0.0, 0.01, (90, 1))
        rooms = forecast_clearance(planned, planned + errors, RoughWall(), every=10)
        every = [
            min(planned[10 * k, 0] + way * errors[10 * j, 0] for j in range(k, -1, -2) for way in (1.0, -1.0))
            for k in range(9)
        ]
        assert rooms.min() == pytest.approx(min(every), abs=1e-15)
        assert int(rooms.argmin()) == int(np.argmin(every))
        assert np.all(rooms <= np.array(every) + 1e-15)
