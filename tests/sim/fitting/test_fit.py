import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.fitting.fit import REPLAY_STEP, _integrate_setpoints, fit_factors, replay_log
from kinesic.sim.fitting.parameters import DEFAULT_PARAMETERS
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import NOMINAL_FACTORS, DriveFactors, Factors
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin

ROBOT = Robot.load()
SKELETON = ROBOT.skeleton
FREE_PARAMETERS = tuple(figure for figure in DEFAULT_PARAMETERS if figure != "gain")
SERVO_TICKS = ROBOT.drives.tick
WORN_FACTORS = Factors(
    latency=0.006,
    servos={
        "xm540_w270": DriveFactors(stall=0.85, no_load=0.9, friction=1.5, armature=1.25),
        "xm540_w150": DriveFactors(stall=0.8, no_load=0.95, friction=0.7, armature=1.3),
        "xm430_w210": DriveFactors(stall=1.1, no_load=0.9, friction=1.4, armature=0.8),
        "xc430_w240": DriveFactors(stall=0.9, no_load=1.1, friction=1.3, armature=1.2),
        "xc330_t288": DriveFactors(stall=0.75, no_load=0.9, friction=1.5, armature=1.4),
    },
)
LOG_TIMES = 0.01 * np.arange(60)
LOG_SETPOINTS = SKELETON.rest + 0.1 * np.outer(np.sin(9.0 * LOG_TIMES), np.ones(22))
for side in "lr":
    LOG_SETPOINTS[:, SKELETON.joint(f"{side}_shoulder_abduct")] += np.minimum(LOG_TIMES, 0.3)  # away from the body


def record_log(factors, *, seconds, quick=1.0, seed=0, step=MAX_PHYSICS_STEP):
    """Return the log of swinging hinges with different frequencies and rounded angles."""
    random = np.random.default_rng(seed)
    times = 0.01 * np.arange(round(seconds / 0.01) + 1)
    half = np.minimum(SKELETON.upper - SKELETON.rest, SKELETON.rest - SKELETON.lower) / 2
    speeds = ROBOT.drives.no_load
    swings = 2 * np.pi * quick * random.uniform(0.6, 1.4, len(half))  # [rad/s] angular frequency
    width = np.minimum(np.minimum(half, 0.35), 0.4 * speeds / swings)
    fade = np.minimum(times / 0.3, 1.0)[:, None]
    goals = SKELETON.rest + fade * width * np.sin(np.outer(times, swings) * (1 + 0.3 * times[:, None] / seconds))
    goals[:, SKELETON.joint("l_shoulder_abduct")] += 0.4 * fade[:, 0]
    goals[:, SKELETON.joint("r_shoulder_abduct")] += 0.4 * fade[:, 0]
    twin, still = Twin(ROBOT, factors=factors, step=step), np.zeros(len(half))
    for time, goal in zip(times, goals, strict=True):
        twin.write(Command(time, goal, still, still, goal))
    seen = twin.measurements()
    return Log(seen.times, seen.setpoints, sealed(np.rint(seen.angles / SERVO_TICKS) * SERVO_TICKS))


def true_value(unknown, factors):
    return getattr(factors.servos[unknown.servo] if unknown.servo else factors, unknown.figure)


@pytest.fixture(scope="module")
def worn():
    """Fit servo parameters to a log of simulated worn servos."""
    return fit_factors(record_log(WORN_FACTORS, seconds=0.55, step=0.001), ROBOT, free=FREE_PARAMETERS)


def test_identifiable_servo_parameters_are_recovered_within_five_percent(worn):
    estimates = [estimate for estimate in worn.estimates if not estimate.why]
    for estimate in estimates:
        assert estimate.value == pytest.approx(true_value(estimate.unknown, WORN_FACTORS), rel=0.05), str(
            estimate.unknown
        )
    assert len(estimates) >= 16
    assert {estimate.unknown.figure for estimate in estimates} >= {
        "stall",
        "no_load",
        "friction",
        "armature",
        "latency",
    }


def test_fitted_servo_factors_are_the_identified_estimates(worn):
    for estimate in worn.estimates:
        left = 0.0 if estimate.unknown.figure == "latency" else 1.0
        assert true_value(estimate.unknown, worn.factors) == pytest.approx(left if estimate.why else estimate.value)
    assert worn.error_after < worn.error_before / 5


def test_unidentified_servo_parameters_have_a_reason(worn):
    names = {str(estimate.unknown) for estimate in worn.estimates}
    refused = [estimate for estimate in worn.estimates if estimate.why]
    assert refused
    for estimate in refused:
        assert estimate.why == "the log hardly depends on it" or estimate.why.split("distinguish it from ")[1] in names


def test_servo_gain_is_identified_only_if_the_duty_saturates():
    free = ("stall", "no_load", "gain")
    slow, quick = (
        fit_factors(record_log(NOMINAL_FACTORS, seconds=0.4, quick=pace), ROBOT, free=free) for pace in (0.3, 3.0)
    )
    for result, some in ((slow, False), (quick, True)):
        gains = [estimate for estimate in result.estimates if estimate.unknown.figure == "gain"]
        assert any(not estimate.why for estimate in gains) == some
        assert all("does not distinguish it from" in estimate.why for estimate in gains if estimate.why)


@pytest.mark.soak
def test_servo_log_without_motion_identifies_neither_armature_nor_no_load_velocity():
    still = Log(sealed([0.0, 0.05, 0.1]), sealed([SKELETON.rest] * 3), sealed([SKELETON.rest] * 3))
    fit = fit_factors(still, ROBOT, free=("no_load", "armature"))
    assert all(estimate.why == "the log hardly depends on it" for estimate in fit.estimates)
    assert fit.factors == Factors(servos={name: DriveFactors() for name in WORN_FACTORS.servos})


@pytest.mark.soak
def test_servo_fit_is_deterministic():
    log = record_log(WORN_FACTORS, seconds=0.3)
    one, two = (fit_factors(log, ROBOT, free=("stall", "latency")) for _ in range(2))
    assert one == two


def test_fit_to_a_log_of_nominal_servos_gives_nominal_factors():
    fit = fit_factors(record_log(NOMINAL_FACTORS, seconds=0.5), ROBOT, free=("stall",))
    assert fit.error_before < SERVO_TICKS.max()
    for estimate in fit.estimates:
        assert estimate.why or estimate.value == pytest.approx(1.0, abs=0.02)


def test_mass_can_be_fitted_only_with_fixed_stall_torque():
    fit = fit_factors(record_log(Factors(mass=1.15), seconds=0.6), ROBOT, free=("mass",))
    assert fit.factors.mass == pytest.approx(1.15, rel=0.05)
    with pytest.raises(ValueError, match="stall and mass cannot both be free"):
        fit_factors(record_log(NOMINAL_FACTORS, seconds=0.1), ROBOT, free=(*DEFAULT_PARAMETERS, "mass"))


def performed(factors, *, step=0.004):
    twin, still = Twin(ROBOT, factors=factors, step=step), np.zeros(22)
    for time, goals in zip(LOG_TIMES, LOG_SETPOINTS, strict=True):
        twin.write(Command(time, goals, still, still, goals))
    seen = twin.measurements()
    return Log(seen.times, seen.setpoints, seen.angles)


def test_replay_of_a_servo_log_reproduces_the_twin():
    log = performed(NOMINAL_FACTORS, step=REPLAY_STEP)
    assert replay_log(log, ROBOT, NOMINAL_FACTORS) == pytest.approx(log.angles, abs=1e-9)


def test_replay_of_a_servo_log_reproduces_the_latency():
    late = Factors(latency=0.0065)
    log = performed(late, step=0.001)
    assert np.abs(replay_log(log, ROBOT, late) - log.angles).max() < np.radians(0.1)
    assert np.abs(replay_log(log, ROBOT, NOMINAL_FACTORS) - log.angles).max() > np.radians(0.4)


def test_replayed_angles_are_continuous_in_the_latency():
    log = performed(NOMINAL_FACTORS)
    path = np.array([replay_log(log, ROBOT, Factors(latency=1e-4 * k)) for k in range(35, 46)])
    bends = np.abs(np.diff(path, n=2, axis=0)).max()
    assert bends < 0.2 * np.abs(np.diff(path, axis=0)).max()


def test_replay_holds_the_initial_angles_before_the_first_setpoint_of_a_log():
    log = Log(sealed([0.0, 1.0, 3.0]), sealed([[1.0], [2.0], [4.0]]), sealed([[0.5], [0.0], [0.0]]))
    sums = _integrate_setpoints(log, np.array([-2.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0]))[:, 0]
    assert np.diff(sums) == pytest.approx([1.0, 0.5, 0.5, 2.0, 2.0, 4.0])
