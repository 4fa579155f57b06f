"""Properties of motions written as MPEG-4 body animation parameters."""

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.files.bap import UNITS_PER_RADIAN, read_bap, write_bap

DEFAULT_ROBOT = Robot.load()
HINGE_COUNT = len(DEFAULT_ROBOT.skeleton.hinges)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_bap_round_trip_is_exact_to_resolution(seed: int, pieces: int):
    """Write and read random motions, and compare angles and BAP units."""
    controls = np.random.default_rng(seed).uniform(-3.0, 3.0, (pieces + 3, HINGE_COUNT))
    motion = Trajectory(sealed(controls), 0.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "motion.bap"
        write_bap(motion, DEFAULT_ROBOT, path)
        frames = read_bap(path, DEFAULT_ROBOT)
    wanted = motion.sample(frames.times)[0]
    assert np.abs(frames.angles - wanted).max() <= 0.5 / UNITS_PER_RADIAN + 1e-12
    ticks = frames.angles * UNITS_PER_RADIAN
    assert np.abs(ticks - np.rint(ticks)).max() < 1e-6
    np.testing.assert_array_equal(np.rint(ticks), np.rint(wanted * UNITS_PER_RADIAN))
