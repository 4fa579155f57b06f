import tracemalloc

import numpy as np

from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.kinematics import body_frames

ROBOT = Robot.load()


def test_distance_computation_needs_less_than_half_the_memory_of_all_segment_frames(monkeypatch):
    monkeypatch.setattr("kinesic.sim.distances.POSTURES_PER_WINDOW", 128)
    angles = np.tile(ROBOT.skeleton.rest, (4000, 1)) + 0.1 * np.sin(np.arange(4000))[:, None]
    measure, peaks = CapsuleDistances(ROBOT), []
    measure.survey(angles[:2], [0])
    for look in (lambda: measure.lowest(body_frames(ROBOT, angles), angles), lambda: measure.survey(angles, [0])[0]):
        tracemalloc.start()
        lowest = look()
        peaks.append(tracemalloc.get_traced_memory()[1] - lowest.nbytes)
        tracemalloc.stop()
    assert peaks[1] < 0.5 * peaks[0]
