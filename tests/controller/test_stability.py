"""How much a correction may restore: what stiff and late servos bear."""

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import soften
from kinesic.controller.observer import Observer
from kinesic.controller.perform import dry_run, make_observer, plan, set_up
from kinesic.controller.stability import CALM, calm_part, loop_poles
from kinesic.report.checks import checks
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, DriveFactors, Factors

from ..performances import DYNAMICS, ROBOT

STIFF_AND_LATE = Factors(gain=2.0, latency=0.02)


def loop(believed: Factors) -> tuple[Observer, Robot, MujocoDynamics, float]:
    observer = Observer.of(soften(ROBOT, believed), DYNAMICS, period=0.01, delay=believed.latency)
    return observer, believed.applied(ROBOT), DYNAMICS, believed.latency


@pytest.mark.parametrize("latency", [0.0, 0.008, 0.014, 0.02])
@pytest.mark.parametrize("factors", [NOMINAL, PESSIMISTIC, Factors(gain=0.5), Factors(gain=1.25)])
def test_nothing_is_taken_from_a_loop_that_comes_to_rest(factors, latency):
    believed = Factors(gain=factors.gain, stall=factors.stall, no_load=factors.no_load, latency=latency)
    assert calm_part(*loop(believed)) == 1.0


@pytest.mark.parametrize(
    ("gain", "latency", "part"),
    [(2.0, 0.012, 1.0), (2.0, 0.014, 0.75), (2.0, 0.02, 0.5), (3.0, 0.02, 0.25), (3.0, 0.05, 0)],
)
def test_a_stiff_and_late_loop_restores_what_it_bears(gain, latency, part):
    given = loop(Factors(gain=gain, latency=latency))
    assert calm_part(*given) == part
    alone = loop_poles(*given, part=0.0)
    assert np.all(loop_poles(*given, part=part) <= np.maximum(alone, CALM))


def test_two_known_errors_together_swing_up():
    assert loop_poles(*loop(STIFF_AND_LATE)).max() > 1.01
    assert loop_poles(*loop(Factors(gain=2.0))).max() < 1.0
    assert loop_poles(*loop(Factors(latency=0.02))).max() < 1.0


def test_one_stiff_servo_model_is_enough():
    stiff = Factors(latency=0.02, servos={ROBOT.drives[0].servo.name: DriveFactors(gain=3.0)})
    assert calm_part(*loop(stiff)) < 1.0


def test_servos_known_to_be_stiff_and_late_do_not_swing():
    known = set_up()
    planned = plan('<bml><gesture lexeme="greet_wave" start="0.2"/><head lexeme="SHAKE" start="0.4"/></bml>', known)
    knowing = dry_run(planned, twin=STIFF_AND_LATE, believed=STIFF_AND_LATE)
    assert knowing.restoring == make_observer(known, STIFF_AND_LATE, 0.02, 1).restoring == 0.5
    told = next(check for check in checks(knowing) if check.name == "tracking.restoring")
    assert (told.status, told.value) == ("warn", 0.5)
    assert "P gain x 2.00 (all servos), 20 ms late" in told.where
    assert knowing.tracking.rmse < 0.1  # 0.6 deg with all of it
    nominal = dry_run(planned)
    assert nominal.restoring == 1.0
    assert "tracking.restoring" not in {check.name for check in checks(nominal)}
