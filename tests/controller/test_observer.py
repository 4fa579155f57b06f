from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs
from scipy.linalg import expm

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.servo import USABLE_VELOCITY_FRACTION
from kinesic.controller import observer as observer_module
from kinesic.controller.dry_run import dry_run, make_observer
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.controller.learned_gains import identify_servos, reduce_stiffness
from kinesic.controller.observer import (
    MAX_CORRECTION,
    LoadEstimate,
    Observer,
    ObserverInputs,
    _compute_transition,
    correct_setpoints,
)
from kinesic.controller.observer_step import DISTURBANCE_DECAY, LOAD_ERROR_RANGE, RESTORING_GAINS
from kinesic.session.plan import plan
from kinesic.sim.log import Log, make_log
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

from ..passage import passage_text
from ..performances import DYNAMICS, ROBOT

HINGE_COUNT = len(ROBOT.skeleton.hinges)
COMMAND_PERIOD = 0.01
OBSERVER = Observer.of(ROBOT, DYNAMICS, period=COMMAND_PERIOD)
REST_ANGLES = ROBOT.skeleton.rest
ZERO_ANGLES = np.zeros(HINGE_COUNT)


def command(angles: Floats = REST_ANGLES) -> Command:
    return Command(0.0, angles, ZERO_ANGLES, ZERO_ANGLES, angles)


def setpoints(loads: Floats, leads: Floats | None = None) -> FeedForwardSetpoints:
    """Make feed-forward with given torque and velocity offsets (m, n)."""
    return FeedForwardSetpoints(loads, loads, np.zeros_like(loads) if leads is None else leads, loads)


def inputs(angles: Floats = REST_ANGLES, load: float = 0.0, **changes: Floats) -> ObserverInputs:
    """Return the observer inputs of one tick without adaptation, with some changed."""
    return replace(OBSERVER.precompute_inputs([command(angles)], setpoints(ZERO_ANGLES[None] + load)), **changes)


IDLE_INPUTS = inputs()  # inputs of a tick at rest without load


def closed_loop(
    observer: Observer, factors: tuple[float, float, float], latency: float, *, gain: float = 1.0
) -> Floats:
    """Compute the largest pole (n,) of observer and plant.

    Factors scale stall torque, no-load speed, inertia and P gain of the plant.
    """
    stall, no_load, heavier = factors
    inertia = heavier * DYNAMICS.load.inertia
    torque = stall * ROBOT.drives.stall
    back = np.array([drive.stall / drive.no_load * stall / no_load + drive.rate_gain * stall for drive in ROBOT.drives])
    spring = gain * torque * [drive.gain for drive in ROBOT.drives]
    drag = back + [drive.damping for drive in ROBOT.drives]
    late = int(latency / COMMAND_PERIOD + 1e-9)
    spans = latency - late * COMMAND_PERIOD, COMMAND_PERIOD - latency + late * COMMAND_PERIOD
    old, new = (_compute_transition(spring / inertia, drag / inertia, span) for span in spans)
    state = np.broadcast_to(np.eye(10), (HINGE_COUNT, 10, 10))
    plant, belief, sent = state[:, :2], state[:, 2:5], state[:, 5:]
    moved = old[:, :2, :2] @ plant + old[:, :2, 2:] @ sent[:, late + 1 : late + 2]
    moved = new[:, :2, :2] @ moved + new[:, :2, 2:] @ sent[:, late : late + 1]
    corrected = belief + observer.gain.T[:, :, None] * (plant[:, :1] - belief[:, :1])
    entered = np.zeros_like(corrected)
    entered[:, 2] = np.einsum("h,nhk->nk", observer.arrival, sent[:, : len(observer.arrival)])
    corrected = observer.forecast.transpose(2, 0, 1) @ (corrected + entered) - entered
    correction = -np.einsum("i,nik->nk", RESTORING_GAINS, corrected)[:, None]
    loop = np.concatenate([moved, corrected, correction, sent[:, :-1]], axis=1)
    return np.abs(np.linalg.eigvals(loop)).max(axis=1)


PESSIMISTIC_FACTORS = (0.8, 0.9, 1.3)  # factors on stall torque, no-load velocity and inertia
# Factors of which one is wrong by two, besides none and all slightly
MODEL_ERRORS = [(1.0, 1.0, 1.0), PESSIMISTIC_FACTORS]
MODEL_ERRORS += [tuple(2.0**power if k == which else 1.0 for k in range(3)) for which in range(3) for power in (-1, 1)]


@pytest.mark.parametrize("latency", [0.0, 0.008, 0.014, 0.02])
@pytest.mark.parametrize("told", [True, False], ids=["told", "not told"])
def test_observer_loop_is_stable_up_to_20_ms_latency_if_one_parameter_is_wrong_by_a_factor_of_two(latency, told):
    observer = Observer.of(ROBOT, DYNAMICS, period=COMMAND_PERIOD, delay=latency if told else 0.0)
    for factors in MODEL_ERRORS:
        assert closed_loop(observer, factors, latency).max() < 1.0, factors


@pytest.mark.parametrize("gain", [0.5, 0.7])
@pytest.mark.parametrize("latency", [0.0, 0.02])
def test_observer_loop_is_stable_with_a_correctly_estimated_low_servo_gain(latency, gain):
    observer = Observer.of(reduce_stiffness(ROBOT, Factors(gain=gain)), DYNAMICS, period=COMMAND_PERIOD, delay=latency)
    for factors in MODEL_ERRORS:
        assert closed_loop(observer, factors, latency, gain=gain).max() < 1.0, factors


def test_observer_loop_is_stable_if_the_servo_gain_is_twice_the_estimate():
    stiff = reduce_stiffness(ROBOT, Factors(gain=2.0))
    np.testing.assert_array_equal([drive.gain for drive in stiff.drives], [drive.gain for drive in ROBOT.drives])
    for latency in (0.0, 0.008):
        observer = Observer.of(stiff, DYNAMICS, period=COMMAND_PERIOD, delay=latency)
        assert closed_loop(observer, (1.0, 1.0, 1.0), latency, gain=2.0).max() < 1.0


def test_three_observer_poles_of_each_joint_coincide():
    for hinge in range(HINGE_COUNT):
        forecast, gain = OBSERVER.forecast[..., hinge], OBSERVER.gain[:, hinge]
        poles = np.linalg.eigvals(forecast @ (np.eye(3) - np.outer(gain, np.eye(3)[0])))
        np.testing.assert_allclose(poles, np.exp(-1.0), atol=1e-3)


def test_servo_transition_matrix_equals_the_matrix_exponential():
    drive = ROBOT.drives[0]
    inertia = DYNAMICS.load.inertia[0]
    rates = np.zeros((3, 3))
    rates[0, 1] = 1.0
    spring, drag = drive.stall * drive.gain, drive.stall / drive.no_load + drive.rate_gain + drive.damping
    rates[1] = np.array([-spring, -drag, spring]) / inertia
    np.testing.assert_allclose(OBSERVER.forecast[..., 0], expm(rates * COMMAND_PERIOD), atol=1e-6)


def test_observer_without_deviation_gives_no_correction():
    belief = OBSERVER.begin()
    for _ in range(20):
        belief = OBSERVER.advance(belief, ZERO_ANGLES, IDLE_INPUTS, 0)
    np.testing.assert_array_equal(belief.setpoints, REST_ANGLES)
    np.testing.assert_array_equal(belief.share, 0.0)
    np.testing.assert_array_equal(belief.pace, 0.0)


def test_observer_step_does_not_change_its_input_estimate():
    belief = OBSERVER.begin()
    kept = [getattr(belief, name).copy() for name in LoadEstimate.__dataclass_fields__]
    first, second = (OBSERVER.advance(belief, ZERO_ANGLES + 0.01, inputs(load=0.02), 0) for _ in range(2))
    for name, before in zip(LoadEstimate.__dataclass_fields__, kept, strict=True):
        np.testing.assert_array_equal(getattr(belief, name), before)
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_hinges_below_their_reference_get_a_positive_correction():
    belief = OBSERVER.begin()
    for _ in range(50):
        belief = OBSERVER.advance(belief, ZERO_ANGLES - 0.01, inputs(np.zeros(HINGE_COUNT)), 0)
    assert np.all(belief.correction[ROBOT.skeleton.upper > 0.05] > 0.0)


@pytest.mark.parametrize("deviation", [-3.0, -0.05, 0.05, 3.0])
def test_observer_correction_is_bounded_in_size_rate_and_range(deviation):
    belief, one = OBSERVER.begin(), np.ones((1, HINGE_COUNT))
    taught = inputs(load=0.1, noticed=0.1 * one, trust=one, leads=0.1 * one, noticed_leads=0.1 * one, trust_leads=one)
    step = (1 - USABLE_VELOCITY_FRACTION) * ROBOT.drives.no_load * COMMAND_PERIOD
    for _ in range(200):
        before = belief.correction
        belief = OBSERVER.advance(belief, ZERO_ANGLES + deviation, taught, 0)
        assert np.all(np.abs(belief.correction) <= MAX_CORRECTION + 1e-12)
        assert np.all(np.abs(belief.correction - before) <= step + 1e-12)
        assert np.all((belief.setpoints >= ROBOT.skeleton.lower) & (belief.setpoints <= ROBOT.skeleton.upper))
        for learned in (belief.share, belief.pace):
            assert np.all((learned >= LOAD_ERROR_RANGE[0]) & (learned <= LOAD_ERROR_RANGE[1]))


def test_observer_estimates_heavier_load_than_modelled_during_motion():
    share, belief = 0.6, OBSERVER.begin()
    plant = np.zeros((HINGE_COUNT, 3))
    loads = 0.06 * np.sin(np.arange(60) / 5)[:, None] + ZERO_ANGLES
    taught = OBSERVER.precompute_inputs([command(ZERO_ANGLES)] * 60, setpoints(loads))
    for tick, load in enumerate(loads):
        previous = plant[:, 0]
        belief = OBSERVER.advance(belief, previous, taught, tick)
        plant[:, 2] = np.clip(belief.correction, -1, 1) - share * load
        plant = np.einsum("ijn,nj->ni", OBSERVER.forecast, plant)
    middle = (ROBOT.skeleton.lower < -0.2) & (ROBOT.skeleton.upper > 0.2)
    np.testing.assert_allclose(belief.share[middle], share, atol=0.2)


@pytest.mark.parametrize("gain", [0.75, 1.5])
def test_observer_estimates_load_and_velocity_errors_of_a_wrong_gain(gain):
    """Torque and velocity offsets are in quadrature, as in every oscillation."""
    belief, plant, ticks = OBSERVER.begin(), np.zeros((HINGE_COUNT, 3)), np.arange(300) / 5
    loads = 0.06 * np.sin(ticks)[:, None] + ZERO_ANGLES
    leads = 0.06 * np.cos(ticks)[:, None] + ZERO_ANGLES
    taught = OBSERVER.precompute_inputs([command(ZERO_ANGLES)] * len(ticks), setpoints(loads, leads))
    middle = (ROBOT.skeleton.lower < -0.2) & (ROBOT.skeleton.upper > 0.2)
    for tick, led in enumerate(loads + leads):
        previous = plant[:, 0]
        belief = OBSERVER.advance(belief, previous, taught, tick)
        plant[:, 2] = gain * np.clip(belief.correction, -1, 1) - (1.0 - gain) * led
        plant = np.einsum("ijn,nj->ni", OBSERVER.forecast, plant)
    for learned in (belief.share, belief.pace):
        np.testing.assert_allclose(learned[middle], 1.0 / gain - 1.0, atol=0.2)


def test_external_torque_estimate_decays_for_a_silent_servo_but_not_for_a_measured_one():
    belief = OBSERVER.begin()
    for _ in range(30):
        belief = OBSERVER.advance(belief, ZERO_ANGLES + 0.02, IDLE_INPUTS, 0)
    push = belief.motion[2]
    silent = ZERO_ANGLES + 0.02
    silent[3] = np.nan
    for _ in range(40):
        belief = OBSERVER.advance(belief, silent, IDLE_INPUTS, 0)
        assert np.isfinite(belief.setpoints).all()
    assert abs(belief.motion[2, 3]) < 1.01 * abs(push[3]) * DISTURBANCE_DECAY**40
    assert abs(belief.motion[2, 4]) > 0.5 * abs(push[4])


def test_one_observer_tracks_two_robots_independently():
    random = np.random.default_rng(0)
    loads, leads = 0.05 * random.standard_normal((2, 30, HINGE_COUNT))
    deviations = 0.01 * random.standard_normal((2, 30, HINGE_COUNT))
    stream = [command()] * 30

    def goals(observer: Observer, measured: Floats) -> Floats:
        taught, belief, results = observer.precompute_inputs(stream, setpoints(loads, leads)), observer.begin(), []
        for tick, deviation in enumerate(measured):
            belief = observer.advance(belief, deviation, taught, tick)
            results.append(belief.setpoints)
        return np.array(results)

    pair = Observer.of(ROBOT, DYNAMICS, period=COMMAND_PERIOD, delay=0.012, bodies=2)
    one = Observer.of(ROBOT, DYNAMICS, period=COMMAND_PERIOD, delay=0.012)
    together = goals(pair, np.concatenate(deviations, axis=1))
    np.testing.assert_allclose(
        together, np.hstack([goals(one, deviation) for deviation in deviations]), rtol=0, atol=1e-15
    )


class Still:
    """Body that never moves, with one servo that never answers."""

    def __init__(self, angles: Floats) -> None:
        self.angles = angles
        self.written: list[Command] = []

    def write(self, command: Command, /) -> None:
        self.written.append(command)

    def close(self) -> None:
        pass

    def positions(self) -> Floats:
        return np.where(np.arange(HINGE_COUNT) == 5, np.nan, self.angles)


def test_setpoint_correction_keeps_times_reference_angles_and_first_setpoints():
    body = Still(REST_ANGLES + 0.01)
    stream = [structs.replace(command(), time=k * COMMAND_PERIOD) for k in range(5)]
    for (told,) in correct_setpoints(stream, setpoints(np.zeros((5, HINGE_COUNT))), [body], OBSERVER):
        body.write(told)
    assert [item.time for item in body.written] == [asked.time for asked in stream]
    np.testing.assert_array_equal(body.written[0].setpoints, REST_ANGLES)
    assert all(told.angles is asked.angles for told, asked in zip(body.written, stream, strict=True))
    assert not np.array_equal(body.written[-1].setpoints, REST_ANGLES)
    assert body.written[-1].setpoints[5] == REST_ANGLES[5]


def test_setpoint_correction_requires_one_setpoint_row_per_command():
    with pytest.raises(ValueError, match="shorter"):
        list(correct_setpoints([command()], setpoints(np.zeros((2, HINGE_COUNT))), [Still(REST_ANGLES)], OBSERVER))


def test_servo_delay_of_a_fraction_of_a_period_divides_a_setpoint_between_two_periods():
    for delay, arrival in ((0.0, [1.0, 0.0]), (0.0025, [0.75, 0.25]), (0.018, [0.0, 0.2, 0.8])):
        observer = Observer.of(ROBOT, DYNAMICS, period=COMMAND_PERIOD, delay=delay)
        np.testing.assert_allclose(observer.arrival, arrival, atol=1e-9)


def test_identified_servo_factors_reduce_the_tracking_error_of_another_plan(known):
    """Half the P gain and 15 ms delay: known deviations need no correction."""
    first, second = (plan(passage_text(k), known) for k in (0, 1))
    wrong = Factors(gain=0.5, latency=0.015)
    seen = make_log(dry_run(first, twin=wrong).measured)
    half = len(seen.times) // 2  # which tells as much
    lesson = identify_servos(Log(seen.times[:half], seen.setpoints[:half], seen.angles[:half]), known.robot)
    assert (lesson.why, lesson.bounded) == ("", False)
    np.testing.assert_allclose([own.gain for own in lesson.estimate.servos.values()], 0.5, atol=0.02)
    assert lesson.estimate.latency == pytest.approx(0.015, abs=0.001)
    new, taught = (dry_run(second, twin=wrong, believed=believed) for believed in (NOMINAL_FACTORS, lesson.estimate))
    assert taught.tracking.rmse < 0.7 * new.tracking.rmse


def test_setpoint_correction_allows_larger_offsets_for_low_gain_servos(known):
    """At half the gain, a fast hinge needs setpoints beyond full duty of the data sheet."""
    planned, soft = plan(passage_text(0), known), Factors(gain=0.5)
    result = dry_run(planned, twin=soft, believed=soft)
    stiff = Observer.of(known.robot, known.dynamics, period=COMMAND_PERIOD)
    assert np.abs(result.measured.setpoints - result.measured.angles).max() > stiff.full.min()
    assert result.tracking.rmse < 0.1


def test_saturation_margin_reduces_the_tracking_error_of_servos_with_half_gain(monkeypatch, known):
    """An error below the saturation margin is attributed to a weak gain."""
    planned = plan(passage_text(0), known)

    def rmse() -> float:
        make_observer.cache_clear()
        return dry_run(planned, twin=Factors(gain=0.5)).tracking.rmse

    doubted = rmse()
    monkeypatch.setattr(observer_module, "SATURATION_MARGIN", 1.0)
    believed = rmse()
    make_observer.cache_clear()
    assert doubted < 0.8 * believed < 0.8
