import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.twin import Twin

ROBOT = Robot.load()
REST_POSTURE = ROBOT.skeleton.rest
ZERO_VELOCITIES = np.zeros_like(REST_POSTURE)
STEP_TIMES = np.cumsum([0.5, *[0.002] * 30, 0.01, 0.001, *[0.002] * 10])  # [s] with uneven steps


@pytest.mark.parametrize(
    "factors", [NOMINAL_FACTORS, Factors(play=0.005), Factors(resistance=0.5)], ids=("plain", "play", "sag")
)
def test_replayed_log_without_latency_equals_direct_commands(factors: Factors):
    goals = REST_POSTURE + 0.1 * np.random.default_rng(1).uniform(-1.0, 1.0, (len(STEP_TIMES) - 1, len(REST_POSTURE)))
    written, replayed = (Twin(ROBOT, factors=factors, step=0.003) for _ in range(2))
    angles = []
    for time, goal in zip(STEP_TIMES.tolist(), [*goals, REST_POSTURE], strict=True):
        written.write(Command(time, goal, ZERO_VELOCITIES, ZERO_VELOCITIES, goal))
        angles.append(written.state().angles)
    seen = {0, 7, 31, len(STEP_TIMES) - 1}
    result = replayed.replay(STEP_TIMES, goals, seen)
    assert np.array_equal(result, np.array(angles)[sorted(seen)])
    assert np.abs(result[-1] - REST_POSTURE).max() > 0.01
    with pytest.raises(ValueError, match="nothing was measured"):
        replayed.measurements()
