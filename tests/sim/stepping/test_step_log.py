import numpy as np

from kinesic.sim.stepping.step_log import StepLog


def test_whoever_was_shown_steps_may_hold_them_while_others_are_kept():
    angles, speeds = np.zeros(2), np.zeros(2)
    log, held = StepLog(angles, speeds, np.zeros(2)), []
    for k in range(1, 4):
        angles[:], speeds[:] = k, 10 * k
        log.keep_supplied(0.1 * k)
        log.keep_angles()
        log.keep_speeds()
        log.stepped(1, 0.01 * k)
        held.append(log.kept())  # such as a profiler, which looks at the frames of another thread
        log.forget()
    for k, shown in enumerate(held):
        np.testing.assert_array_equal(shown.angles, [[k, k], [k + 1, k + 1]])
        np.testing.assert_array_equal(shown.speeds, 10 * shown.angles)
        np.testing.assert_allclose(shown.spans, [0.01 * k, 0.01 * (k + 1)])
        np.testing.assert_allclose(shown.supplied, [0.1 * k if k else 1.0, 0.1 * (k + 1)])
