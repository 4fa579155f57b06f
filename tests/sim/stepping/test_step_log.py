import numpy as np

from kinesic.sim.stepping.step_log import StepLog


def test_step_arrays_returned_by_a_log_stay_valid_after_the_log_restarts():
    angles, speeds = np.zeros(2), np.zeros(2)
    log, held = StepLog(angles, speeds, np.zeros(2)), []
    for k in range(1, 4):
        angles[:], speeds[:] = k, 10 * k
        log.log_voltage(0.1 * k)
        log.log_angles()
        log.log_velocities()
        log.stepped(1, 0.01 * k)
        held.append(log.steps())  # as a profiler does that inspects frames of other threads
        log.forget()
    for k, shown in enumerate(held):
        np.testing.assert_array_equal(shown.angles, [[k, k], [k + 1, k + 1]])
        np.testing.assert_array_equal(shown.velocities, 10 * shown.angles)
        np.testing.assert_allclose(shown.spans, [0.01 * k, 0.01 * (k + 1)])
        np.testing.assert_allclose(shown.supplied, [0.1 * k if k else 1.0, 0.1 * (k + 1)])
