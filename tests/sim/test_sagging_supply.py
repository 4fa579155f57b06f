import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.power import MIN_VOLTAGE_FRACTION, SaggingSupply
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.servo_shafts import Shafts
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin

ROBOT = Robot.load()
DRIVES = ROBOT.drives
HINGE_COUNT = len(DRIVES)
SHOULDER_INDEX = ROBOT.skeleton.names.index("l_shoulder_flexion")
REST_POSTURE = ROBOT.skeleton.rest


def supply(**figures):
    factors = Factors(**figures)
    result = SaggingSupply.of(factors.applied(ROBOT).drives, factors)
    assert result
    return result


def total_current(duties, speeds, share):
    """Return the total current [A] of the PWM bridges."""
    loads = share * duties - speeds / DRIVES.no_load
    return float((np.maximum(duties * loads, 0.0) * DRIVES.stall_current + DRIVES.idle_current).sum())


def raise_arms(factors, *, seconds=1.0):
    """Run a twin whose arm setpoints step by 60 degrees."""
    twin, goal = Twin(ROBOT, factors=factors), np.array(REST_POSTURE)
    for side in "lr":
        goal[ROBOT.skeleton.names.index(f"{side}_shoulder_flexion")] += np.radians(60)
    still = np.zeros(HINGE_COUNT)
    for k in range(round(seconds * 100)):
        twin.write(Command(k / 100, goal, still, still, goal))
    return twin


def test_constant_voltage_needs_no_supply_object():
    assert SaggingSupply.of(DRIVES, NOMINAL_FACTORS) is None
    assert SaggingSupply.of(DRIVES, Factors(supply=0.8)) is None


@pytest.mark.parametrize("resistance", [0.05, 0.2, 0.6])
def test_sagging_supply_has_the_open_voltage_minus_current_drop_or_the_minimum_voltage(resistance):
    chance = np.random.default_rng(3)
    for _ in range(50):
        duties, speeds = chance.uniform(-0.6, 0.6, HINGE_COUNT), chance.uniform(-1, 1, HINGE_COUNT) * DRIVES.no_load
        share = supply(resistance=resistance).voltage_fraction(duties, speeds)
        assert share == pytest.approx(
            max(MIN_VOLTAGE_FRACTION, 1 - resistance * total_current(duties, speeds, share) / 12.0), abs=1e-5
        )


def test_supply_with_a_limit_of_3_a_lowers_its_voltage_until_the_servos_draw_3_a():
    chance, limited = np.random.default_rng(4), 0
    for _ in range(50):
        duties, speeds = chance.uniform(-0.3, 0.3, HINGE_COUNT), chance.uniform(-0.2, 0.2, HINGE_COUNT) * DRIVES.no_load
        share, whole = supply(amps=3.0).voltage_fraction(duties, speeds), total_current(duties, speeds, 1.0)
        assert share == 1.0 if whole <= 3.0 else total_current(duties, speeds, share) == pytest.approx(3.0, abs=1e-4)
        limited += whole > 3.0
    assert 0 < limited < 50


def test_overloaded_servo_supply_has_the_minimum_voltage():
    assert supply(amps=0.1).voltage_fraction(np.ones(HINGE_COUNT), np.zeros(HINGE_COUNT)) == MIN_VOLTAGE_FRACTION
    assert supply(resistance=4.0).voltage_fraction(np.ones(HINGE_COUNT), np.zeros(HINGE_COUNT)) == MIN_VOLTAGE_FRACTION


def test_sagging_twin_is_slower_and_reports_the_lowest_voltage():
    stiff, sagging = raise_arms(NOMINAL_FACTORS), raise_arms(Factors(resistance=0.3))
    power = sagging.measurements().power
    assert power.volts == pytest.approx(12.0 - 0.3 * power.peak.max(), abs=0.2)  # sampled half a physics step apart
    assert stiff.measurements().power.volts == 12.0
    assert power.volts < 11.0
    there, late = (
        np.degrees(twin.measurements().angles[25, SHOULDER_INDEX] - REST_POSTURE[SHOULDER_INDEX])
        for twin in (stiff, sagging)
    )
    assert late < there - 1.0


def test_supply_with_negligible_resistance_moves_arms_like_a_constant_voltage():
    still, same = raise_arms(Factors(resistance=1e-9)), raise_arms(NOMINAL_FACTORS)
    assert np.abs(still.measurements().angles - same.measurements().angles).max() < np.radians(0.01)


def test_current_limit_of_3_a_keeps_sampled_currents_of_a_motion_below_4_5_a():
    power, stiff = (raise_arms(factors).measurements().power for factors in (Factors(amps=3.0), NOMINAL_FACTORS))
    assert power.peak.max() < 4.5 < 6.0 < stiff.peak.max()  # sampled half a physics step apart
    assert power.mean.max() < 4.5 < stiff.mean.max()
    assert power.volts < 11.0


def test_backlash_and_sagging_supply_can_be_combined():
    twin = raise_arms(Factors(play=0.0087, resistance=0.2), seconds=2.0)
    assert twin.measurements().power.volts < 11.5
    assert abs(twin.positions()[SHOULDER_INDEX] - REST_POSTURE[SHOULDER_INDEX] - np.radians(60)) < np.radians(6)


def test_shafts_with_sagging_supply_move_like_the_twin():
    factors, goal = Factors(resistance=0.3), np.array(REST_POSTURE)
    goal[SHOULDER_INDEX] += np.radians(60)
    shafts, twin, still = (
        Shafts(ROBOT, factors=factors),
        Twin(ROBOT, factors=factors, rounds=False),
        np.zeros(HINGE_COUNT),
    )
    for k in range(51):
        twin.write(Command(k * MAX_PHYSICS_STEP, goal, still, still, goal))
        if k:
            shafts.advance(MAX_PHYSICS_STEP, goal, np.ones(HINGE_COUNT))
    assert np.abs(shafts.angles - twin.state().angles).max() < np.radians(0.01)
    stiff = Shafts(ROBOT)
    stiff.advance(50 * MAX_PHYSICS_STEP, goal, np.ones(HINGE_COUNT))
    assert stiff.angles[SHOULDER_INDEX] - shafts.angles[SHOULDER_INDEX] > np.radians(1)
