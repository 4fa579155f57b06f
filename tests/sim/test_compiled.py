"""The compiled kernel of the room gives what its Python gives."""

from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim import distances, dynamics, kinematics
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.kinematics import body_frames, motion_frames
from kinesic.sim.worst_postures import random_postures

pytestmark = pytest.mark.skipif(kinematics.KERNEL != "compiled", reason="no compiled kernel")

ROBOTS = [Robot.load(), Robot.load("upper36")]


@pytest.fixture
def in_python(monkeypatch):
    def run(function):
        with monkeypatch.context() as patch:
            for module in (distances, dynamics, kinematics):
                patch.setattr(module, "KERNEL", "numpy")
            return function()

    return run


def swing(robot: Robot, count: int = 150) -> np.ndarray:
    """A motion from one random posture to another and on to a third."""
    ends = random_postures(robot.skeleton, 3, seed=5)
    return np.concatenate([np.linspace(a, b, count) for a, b in pairwise(ends)])


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_frames_are_the_same(robot, in_python):
    postures = random_postures(robot.skeleton, 70, seed=3)
    fast, slow = motion_frames(robot.skeleton, postures), in_python(lambda: motion_frames(robot.skeleton, postures))
    np.testing.assert_allclose(fast.rotations, slow.rotations, rtol=0, atol=1e-14)
    np.testing.assert_allclose(fast.origins, slow.origins, rtol=0, atol=1e-14)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_distances_are_the_same(robot, in_python):
    measure, postures = CapsuleDistances(robot), random_postures(robot.skeleton, 150, seed=4)
    fast, slow = measure.clearance(postures), in_python(lambda: measure.clearance(postures))
    np.testing.assert_allclose(fast.distances, slow.distances, rtol=0, atol=1e-12)
    assert fast.pairs == slow.pairs
    gaps = measure.gaps(postures)
    np.testing.assert_allclose(gaps, in_python(lambda: measure.gaps(postures)), rtol=0, atol=1e-12)


@pytest.mark.parametrize("near", [0.03, 0.1])
@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_approaches_are_the_same_and_so_are_the_postures_that_are_measured(robot, near, in_python):
    measure, motion = CapsuleDistances(robot), swing(robot)
    ends = np.arange(0, len(motion), 3)
    fast, slow = (run(lambda: measure.approach(motion, ends, near=near)) for run in (lambda f: f(), in_python))
    np.testing.assert_allclose(fast.distances, slow.distances, rtol=0, atol=1e-12)
    lowest = measure.lowest(body_frames(robot, motion[ends]), motion[ends])
    near = max(near, float(lowest.min()))
    suspects = measure._suspects(motion, ends, lowest, near)
    assert 0 < len(suspects) < len(motion)
    np.testing.assert_array_equal(suspects, in_python(lambda: measure._suspects(motion, ends, lowest, near)))


def test_torques_are_the_same(in_python):
    robot = ROBOTS[0]
    model, chance = MujocoDynamics(robot), np.random.default_rng(2)
    postures = random_postures(robot.skeleton, 20, seed=6)
    motion = postures, chance.normal(size=postures.shape), chance.normal(size=postures.shape)
    fast, slow = model.torques(*motion), in_python(lambda: model.torques(*motion))
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-12)
    assert np.abs(fast).max() > 1.0


def test_arrays_that_do_not_fit_are_refused():
    frames = kinematics.compiled_frames(ROBOTS[0].skeleton)
    with pytest.raises(ValueError, match="do not fit"):
        frames.solve(np.ones(3, dtype=np.bool_), np.zeros(4), np.zeros(4), np.zeros(9), np.zeros(3))
