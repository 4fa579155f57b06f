"""Million bus cycles in virtual time with a tenth of all replies corrupted."""

import numpy as np
import pytest

from kinesic.bench.bus.drivers import KinesicDriver
from kinesic.bench.bus.matrix import BUS_PERIOD, list_cases, run_trial

pytestmark = pytest.mark.soak

SERVOS, BAUD = 14, 1_000_000
RUNS, CYCLES = 20, 50_000
(MIXED,) = (case for case in list_cases() if case.name.startswith("mixed"))


@pytest.mark.parametrize("seed", range(RUNS))
def test_servo_bus_reports_no_wrong_servo_status_and_raises_no_exception(seed: int):
    trial = run_trial(MIXED, KinesicDriver, servos=SERVOS, baud=BAUD, seed=seed, cycles=CYCLES)
    print(  # noqa: T201  # the figures of docs/reference/servos.md
        f"seed {seed}: {CYCLES} cycles, fresh {100 * trial.fresh:.3f} %, oldest {1000 * trial.oldest:.0f} ms, "
        f"p99 {1000 * trial.duration(99):.2f} ms, longest {1000 * trial.durations.max():.2f} ms"
    )
    assert (trial.exceptions, trial.wrong) == (0, 0)
    assert trial.fresh > 0.995
    assert np.percentile(trial.durations, 99) < BUS_PERIOD
