"""Restoring gain of the correction for stiff and late servos."""

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.dry_run import dry_run, make_observer
from kinesic.controller.learned_gains import reduce_stiffness
from kinesic.controller.observer import Observer
from kinesic.controller.stability import MAX_POLE, compute_loop_poles, find_stable_fraction
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, DriveFactors, Factors

from ..performances import DYNAMICS, ROBOT

STIFF_AND_LATE = Factors(gain=2.0, latency=0.02)


def loop(believed: Factors) -> tuple[Observer, Robot, MujocoDynamics, float]:
    observer = Observer.of(reduce_stiffness(ROBOT, believed), DYNAMICS, period=0.01, delay=believed.latency)
    return observer, believed.applied(ROBOT), DYNAMICS, believed.latency


@pytest.mark.parametrize("latency", [0.0, 0.008, 0.014, 0.02])
@pytest.mark.parametrize("factors", [NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors(gain=0.5), Factors(gain=1.25)])
def test_stable_servo_loop_keeps_full_correction_gain(factors, latency):
    believed = Factors(gain=factors.gain, stall=factors.stall, no_load=factors.no_load, latency=latency)
    assert find_stable_fraction(*loop(believed)) == 1.0


@pytest.mark.parametrize(
    ("gain", "latency", "part"),
    [(2.0, 0.012, 1.0), (2.0, 0.014, 0.75), (2.0, 0.02, 0.5), (3.0, 0.02, 0.25), (3.0, 0.05, 0)],
)
def test_correction_gain_falls_with_servo_stiffness_and_latency(gain, latency, part):
    given = loop(Factors(gain=gain, latency=latency))
    assert find_stable_fraction(*given) == part
    alone = compute_loop_poles(*given, part=0.0)
    assert np.all(compute_loop_poles(*given, part=part) <= np.maximum(alone, MAX_POLE))


def test_servo_loop_becomes_unstable_only_by_stiffness_and_latency_errors_together():
    assert compute_loop_poles(*loop(STIFF_AND_LATE)).max() > 1.01
    assert compute_loop_poles(*loop(Factors(gain=2.0))).max() < 1.0
    assert compute_loop_poles(*loop(Factors(latency=0.02))).max() < 1.0


def test_high_gain_of_a_single_servo_model_reduces_the_correction_gain():
    stiff = Factors(latency=0.02, servos={ROBOT.drives[0].servo.name: DriveFactors(gain=3.0)})
    assert find_stable_fraction(*loop(stiff)) < 1.0


def test_observer_correction_is_halved_for_stiff_servos_with_latency():
    known = set_up()
    planned = plan('<bml><gesture lexeme="greet_wave" start="0.2"/><head lexeme="SHAKE" start="0.4"/></bml>', known)
    knowing = dry_run(planned, twin=STIFF_AND_LATE, believed=STIFF_AND_LATE)
    assert knowing.restoring == make_observer(known, STIFF_AND_LATE, 0.02, 1).restoring == 0.5
    result = next(check for check in checks(knowing) if check.name == "tracking.restoring")
    assert (result.status, result.value) == ("warn", 0.5)
    assert "P gain x 2.00 (all servos), 20 ms late" in result.where
    assert knowing.tracking.rmse < 0.1  # 0.6 deg with all of it
    nominal = dry_run(planned)
    assert nominal.restoring == 1.0
    assert "tracking.restoring" not in {check.name for check in checks(nominal)}
