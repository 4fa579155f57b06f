"""Million bus cycles in virtual time, with one reply in ten corrupted."""

import numpy as np
import pytest

from kinesic.bench.bus.drivers import KinesicDriver
from kinesic.bench.bus.matrix import BUS_PERIOD, list_cases, run_trial

pytestmark = pytest.mark.soak

SERVO_COUNT = 14
BAUD_RATE = 1_000_000  # [bit/s] baud rate of the bus
RUN_COUNT = 20  # number of runs with different seeds
CYCLE_COUNT = 50_000  # bus cycles per run
(MIXED,) = (case for case in list_cases() if case.name.startswith("mixed"))


@pytest.mark.parametrize("seed", range(RUN_COUNT))
def test_servo_bus_reports_no_wrong_servo_status_and_raises_no_exception(seed: int):
    trial = run_trial(MIXED, KinesicDriver, servos=SERVO_COUNT, baud=BAUD_RATE, seed=seed, cycles=CYCLE_COUNT)
    print(  # noqa: T201  # the figures of docs/reference/servos.md
        f"seed {seed}: {CYCLE_COUNT} cycles, fresh {100 * trial.fresh:.3f} %, oldest {1000 * trial.oldest:.0f} ms, "
        f"p99 {1000 * trial.duration(99):.2f} ms, longest {1000 * trial.durations.max():.2f} ms"
    )
    assert (trial.exceptions, trial.wrong) == (0, 0)
    assert trial.fresh > 0.995
    assert np.percentile(trial.durations, 99) < BUS_PERIOD
