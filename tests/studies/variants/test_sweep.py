from functools import partial

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.controller.dry_run import dry_run
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors
from kinesic.studies.variants import sweep
from kinesic.studies.variants.sweep import perform_variants, sweep_servos
from kinesic.tasks.engine import Processes, using_engine

TEXT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="beat" stroke="0.8"/></bml>'
)
SOFT_SERVOS = Factors(gain=0.3)


def test_servo_sweep_rows_equal_dry_runs_and_coarse_physics_is_close():
    planned = plan(TEXT, set_up())
    variants = (NOMINAL_FACTORS, PESSIMISTIC_FACTORS, SOFT_SERVOS)
    exact, coarse = (perform_variants(planned, variants, step=step) for step in (0.004, sweep.PHYSICS_STEP))
    run = dry_run(planned, twin=PESSIMISTIC_FACTORS, watch=False)
    assert exact[1, 0] == pytest.approx(np.sqrt(np.nanmean(run.errors**2)))
    assert exact[1, 2] == run.measured.clearance.distances.min()
    assert exact[1, 4] == run.measured.power.peak.max()
    assert np.abs(coarse - exact)[:, 0].max() < np.radians(0.1)
    assert np.abs(coarse - exact)[:, 1].max() < 0.011  # a tick
    assert np.abs(coarse - exact)[:, 2].max() < 0.001


def test_servo_sweep_keeps_the_variant_order_and_finds_larger_errors_of_soft_servos(monkeypatch):
    monkeypatch.setattr(sweep, "GROUP_SIZE", 2)
    variants = [NOMINAL_FACTORS, SOFT_SERVOS, Factors(gain=0.31), Factors(mass=1.01), Factors(latency=0.03)]
    with using_engine(Processes(2)):
        result = sweep_servos(TEXT, variants, set_up)
    assert result.variants == tuple(variants)
    assert len(result.tracking) == len(variants)
    assert min(result.tracking[[1, 2]]) > max(result.tracking[[0, 3]])
    assert result.lateness[4] > result.lateness[0]


def test_sweep_without_servo_variants_gives_no_rows():
    assert len(sweep_servos(TEXT, [], set_up).tracking) == 0


def test_error_names_servo_variants_that_crash_a_worker():
    with using_engine(Processes(1)), pytest.raises(ConfigError, match=r"variants gain = 0\.3: its process ended"):
        sweep_servos(TEXT, [SOFT_SERVOS], partial(set_up, "nobody"))
