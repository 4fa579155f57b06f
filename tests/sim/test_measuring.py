import tracemalloc

import numpy as np

from kinesic.body.robot import Robot
from kinesic.sim import twin as module
from kinesic.sim.twin import Twin

ROBOT = Robot.load()


def test_frames_of_a_long_motion_are_never_all_there(monkeypatch):
    twin = Twin(ROBOT)
    angles = np.tile(ROBOT.skeleton.rest, (4000, 1)) + 0.1 * np.sin(np.arange(4000))[:, None]
    found, peaks = [], []
    for window in (4000, 128):
        monkeypatch.setattr(module, "WINDOW", window)
        tracemalloc.start()
        found.append(twin._places(angles))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    (hands, lowest), (windowed, below) = found
    assert np.array_equal(below, lowest)
    assert all(np.array_equal(windowed[side], hands[side]) for side in hands)
    assert peaks[1] < 0.8 * peaks[0]
