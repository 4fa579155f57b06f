"""Compare the compiled observer tick with its CasADi graph."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.observer import LoadEstimate, Observer, ObserverInputs

from ..performances import DYNAMICS, ROBOT
from ..reference.controller.observer_step import advance

HINGE_COUNT = len(ROBOT.skeleton.hinges)


@pytest.mark.parametrize("delay", [0.0, 0.013])
@pytest.mark.parametrize("restoring", [1.0, 0.4])
def test_observer_kernel_equals_python_reference_for_random_ticks(delay: float, restoring: float):
    observer = replace(Observer.of(ROBOT, DYNAMICS, period=0.01, delay=delay), restoring=restoring)
    chance = np.random.default_rng(3)
    belief = observer.begin()
    for tick in range(60):
        rows = 0.05 * chance.normal(size=(10, HINGE_COUNT))
        rows[2:4] = rows[1] - 0.1, rows[1] + 0.1
        inputs = ObserverInputs(*rows[:, None])
        deviation = 0.02 * chance.normal(size=HINGE_COUNT)
        deviation[tick % HINGE_COUNT] = np.nan
        expected = advance(observer, belief.rows, deviation, rows)
        belief = observer.advance(belief, deviation, inputs, 0)
        np.testing.assert_array_equal(belief.rows, expected)


def test_external_torque_estimate_decays_if_no_servo_answers():
    observer = Observer.of(ROBOT, DYNAMICS, period=0.01)
    nothing = ObserverInputs(*np.zeros((10, 1, HINGE_COUNT)))
    rows = observer.begin().rows.copy()
    rows[2] = 0.01
    silent = observer.advance(LoadEstimate(rows), np.full(HINGE_COUNT, np.nan), nothing, 0)
    assert (np.abs(silent.motion[2]) < 0.01).all()
