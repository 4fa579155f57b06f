from functools import partial

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.studies.variants import sweep
from kinesic.studies.variants.sweep import perform_variants, sweep_servos
from kinesic.tasks.engine import Processes, using_engine

TEXT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="beat" stroke="0.8"/></bml>'
)
SOFT = Factors(gain=0.3)


def test_rows_are_what_dry_runs_measure_and_coarser_steps_come_near_them():
    planned = plan(TEXT, set_up())
    variants = (NOMINAL, PESSIMISTIC, SOFT)
    exact, coarse = (perform_variants(planned, variants, step=step) for step in (0.004, sweep.PHYSICS_STEP))
    run = dry_run(planned, twin=PESSIMISTIC, watch=False)
    assert exact[1, 0] == pytest.approx(np.sqrt(np.nanmean(run.errors**2)))
    assert exact[1, 2] == run.measured.clearance.distances.min()
    assert exact[1, 4] == run.measured.power.peak.max()
    assert np.abs(coarse - exact)[:, 0].max() < np.radians(0.1)
    assert np.abs(coarse - exact)[:, 1].max() < 0.011  # a tick
    assert np.abs(coarse - exact)[:, 2].max() < 0.001


def test_soft_servos_follow_worse_and_rows_keep_the_order_of_variants(monkeypatch):
    monkeypatch.setattr(sweep, "GROUP", 2)
    variants = [NOMINAL, SOFT, Factors(gain=0.31), Factors(mass=1.01), Factors(latency=0.03)]
    with using_engine(Processes(2)):
        found = sweep_servos(TEXT, variants, set_up)
    assert found.variants == tuple(variants)
    assert len(found.tracking) == len(variants)
    assert min(found.tracking[[1, 2]]) > max(found.tracking[[0, 3]])
    assert found.lateness[4] > found.lateness[0]


def test_no_variants_are_no_rows():
    assert len(sweep_servos(TEXT, [], set_up).tracking) == 0


def test_variants_that_kill_their_process_are_named():
    with using_engine(Processes(1)), pytest.raises(ConfigError, match=r"variants gain = 0\.3: its process ended"):
        sweep_servos(TEXT, [SOFT], partial(set_up, "nobody"))
