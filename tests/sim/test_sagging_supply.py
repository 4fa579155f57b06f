import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.power import LOWEST_VOLTAGE, Supply
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.servo_shafts import Shafts
from kinesic.sim.twin import STEP, Twin

ROBOT = Robot.load()
DRIVES = ROBOT.drives
COUNT = len(DRIVES)
SHOULDER = ROBOT.skeleton.names.index("l_shoulder_flexion")
REST = ROBOT.skeleton.rest


def supply(**figures):
    factors = Factors(**figures)
    found = Supply.of(factors.applied(ROBOT).drives, factors)
    assert found
    return found


def drawn(duties, speeds, share):
    """[A] by the law of the bridge, servo by servo."""
    loads = share * duties - speeds / DRIVES.no_load
    return float((np.maximum(duties * loads, 0.0) * DRIVES.stall_current + DRIVES.idle_current).sum())


def raised(factors, *, seconds=1.0):
    """A twin that is asked to raise both arms by 60 degrees at once, as no plan would."""
    twin, goal = Twin(ROBOT, factors=factors), np.array(REST)
    for side in "lr":
        goal[ROBOT.skeleton.names.index(f"{side}_shoulder_flexion")] += np.radians(60)
    still = np.zeros(COUNT)
    for k in range(round(seconds * 100)):
        twin.write(Command(k / 100, goal, still, still, goal))
    return twin


def test_a_supply_that_holds_its_voltage_is_none():
    assert Supply.of(DRIVES, NOMINAL) is None
    assert Supply.of(DRIVES, Factors(supply=0.8)) is None


@pytest.mark.parametrize("resistance", [0.05, 0.2, 0.6])
def test_the_voltage_is_what_the_current_at_that_voltage_leaves(resistance):
    chance = np.random.default_rng(3)
    for _ in range(50):
        duties, speeds = chance.uniform(-0.6, 0.6, COUNT), chance.uniform(-1, 1, COUNT) * DRIVES.no_load
        share = supply(resistance=resistance).share(duties, speeds)
        assert share == pytest.approx(
            max(LOWEST_VOLTAGE, 1 - resistance * drawn(duties, speeds, share) / 12.0), abs=1e-5
        )


def test_a_supply_of_three_amperes_gives_no_more():
    chance, limited = np.random.default_rng(4), 0
    for _ in range(50):
        duties, speeds = chance.uniform(-0.3, 0.3, COUNT), chance.uniform(-0.2, 0.2, COUNT) * DRIVES.no_load
        share, whole = supply(amps=3.0).share(duties, speeds), drawn(duties, speeds, 1.0)
        assert share == 1.0 if whole <= 3.0 else drawn(duties, speeds, share) == pytest.approx(3.0, abs=1e-4)
        limited += whole > 3.0
    assert 0 < limited < 50


def test_servos_that_cannot_be_fed_stay_as_weak_as_the_least_voltage():
    assert supply(amps=0.1).share(np.ones(COUNT), np.zeros(COUNT)) == LOWEST_VOLTAGE
    assert supply(resistance=4.0).share(np.ones(COUNT), np.zeros(COUNT)) == LOWEST_VOLTAGE


def test_a_sagging_twin_is_slower_and_tells_the_lowest_voltage():
    stiff, sagging = raised(NOMINAL), raised(Factors(resistance=0.3))
    power = sagging.measurements().power
    assert power.volts == pytest.approx(12.0 - 0.3 * power.peak.max(), abs=0.2)  # half a step of the physics apart
    assert stiff.measurements().power.volts == 12.0
    assert power.volts < 11.0
    there, late = (np.degrees(twin.measurements().angles[25, SHOULDER] - REST[SHOULDER]) for twin in (stiff, sagging))
    assert late < there - 1.0


def test_without_load_a_sagging_supply_is_a_stiff_one():
    still, same = raised(Factors(resistance=1e-9)), raised(NOMINAL)
    assert np.abs(still.measurements().angles - same.measurements().angles).max() < np.radians(0.01)


def test_the_limit_of_the_current_holds_in_the_motion():
    power, stiff = (raised(factors).measurements().power for factors in (Factors(amps=3.0), NOMINAL))
    assert power.peak.max() < 4.5 < 6.0 < stiff.peak.max()  # half a step of the physics apart
    assert power.mean.max() < 4.5 < stiff.mean.max()
    assert power.volts < 11.0


def test_play_and_a_sagging_supply_go_together():
    twin = raised(Factors(play=0.0087, resistance=0.2), seconds=2.0)
    assert twin.measurements().power.volts < 11.5
    assert abs(twin.positions()[SHOULDER] - REST[SHOULDER] - np.radians(60)) < np.radians(6)


def test_shafts_behind_a_sagging_supply_do_what_the_twin_does():
    factors, goal = Factors(resistance=0.3), np.array(REST)
    goal[SHOULDER] += np.radians(60)
    shafts, twin, still = Shafts(ROBOT, factors=factors), Twin(ROBOT, factors=factors, rounds=False), np.zeros(COUNT)
    for k in range(51):
        twin.write(Command(k * STEP, goal, still, still, goal))
        if k:
            shafts.advance(STEP, goal, np.ones(COUNT))
    assert np.abs(shafts.angles - twin.state().angles).max() < np.radians(0.01)
    stiff = Shafts(ROBOT)
    stiff.advance(50 * STEP, goal, np.ones(COUNT))
    assert stiff.angles[SHOULDER] - shafts.angles[SHOULDER] > np.radians(1)
