import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.log import Log
from kinesic.sim.replay import STEP, _sums, replay_log
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import Twin

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
TIMES = 0.01 * np.arange(60)
GOALS = REST + 0.1 * np.outer(np.sin(9.0 * TIMES), np.ones(22))
for side in "lr":
    GOALS[:, ROBOT.skeleton.joint(f"{side}_shoulder_abduct")] += np.minimum(TIMES, 0.3)  # away from the body


def performed(factors, *, step=0.004):
    twin, still = Twin(ROBOT, factors=factors, step=step), np.zeros(22)
    for time, goals in zip(TIMES, GOALS, strict=True):
        twin.write(Command(time, goals, still, still, goals))
    seen = twin.measurements()
    return Log(seen.times, seen.goals, seen.angles)


def test_what_a_twin_did_is_repeated():
    log = performed(NOMINAL, step=STEP)
    assert replay_log(log, ROBOT, NOMINAL) == pytest.approx(log.angles, abs=1e-9)


def test_a_latency_is_repeated():
    late = Factors(latency=0.0065)
    log = performed(late, step=0.001)
    assert np.abs(replay_log(log, ROBOT, late) - log.angles).max() < np.radians(0.1)
    assert np.abs(replay_log(log, ROBOT, NOMINAL) - log.angles).max() > np.radians(0.4)


def test_angles_change_smoothly_with_the_latency():
    log = performed(NOMINAL)
    path = np.array([replay_log(log, ROBOT, Factors(latency=1e-4 * k)) for k in range(35, 46)])
    bends = np.abs(np.diff(path, n=2, axis=0)).max()
    assert bends < 0.2 * np.abs(np.diff(path, axis=0)).max()


def test_goals_before_the_first_are_where_the_log_begins():
    log = Log(sealed([0.0, 1.0, 3.0]), sealed([[1.0], [2.0], [4.0]]), sealed([[0.5], [0.0], [0.0]]))
    sums = _sums(log, np.array([-2.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0]))[:, 0]
    assert np.diff(sums) == pytest.approx([1.0, 0.5, 0.5, 2.0, 2.0, 4.0])
