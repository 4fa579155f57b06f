"""What holds for every motion in MPEG-4 body animation parameters."""

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.bap import PER_RADIAN, read_bap, write_bap

ROBOT = Robot.load()
COUNT = len(ROBOT.skeleton.hinges)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_reading_what_was_written_is_exact_to_the_formats_resolution(seed: int, pieces: int):
    """Written, read, written again: the same numbers; and read angles are within half a unit of the motion's."""
    controls = np.random.default_rng(seed).uniform(-3.0, 3.0, (pieces + 3, COUNT))
    motion = Trajectory(sealed(controls), 0.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "motion.bap"
        write_bap(motion, ROBOT, path)
        frames = read_bap(path, ROBOT)
    wanted = motion.sample(frames.times)[0]
    assert np.abs(frames.angles - wanted).max() <= 0.5 / PER_RADIAN + 1e-12
    ticks = frames.angles * PER_RADIAN
    assert np.abs(ticks - np.rint(ticks)).max() < 1e-6
    np.testing.assert_array_equal(np.rint(ticks), np.rint(wanted * PER_RADIAN))
