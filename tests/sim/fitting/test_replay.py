import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import Twin

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
NONE = np.zeros_like(REST)
TIMES = np.cumsum([0.5, *[0.002] * 30, 0.01, 0.001, *[0.002] * 10])  # [s], not all alike


@pytest.mark.parametrize(
    "factors", [NOMINAL, Factors(play=0.005), Factors(resistance=0.5)], ids=("plain", "play", "sag")
)
def test_a_replay_is_where_commands_without_latency_lead(factors: Factors):
    goals = REST + 0.1 * np.random.default_rng(1).uniform(-1.0, 1.0, (len(TIMES) - 1, len(REST)))
    written, replayed = (Twin(ROBOT, factors=factors, step=0.003) for _ in range(2))
    angles = []
    for time, goal in zip(TIMES.tolist(), [*goals, REST], strict=True):
        written.write(Command(time, goal, NONE, NONE, goal))
        angles.append(written.state().angles)
    seen = {0, 7, 31, len(TIMES) - 1}
    found = replayed.replay(TIMES, goals, seen)
    assert np.array_equal(found, np.array(angles)[sorted(seen)])
    assert np.abs(found[-1] - REST).max() > 0.01
    with pytest.raises(ValueError, match="nothing was measured"):
        replayed.measurements()
