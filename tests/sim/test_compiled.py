"""The compiled kernel of the room gives what its Python gives."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.command import RATE, Command
from kinesic.body.robot import Robot
from kinesic.body.servo import Drives
from kinesic.sim import distances, dynamics, kinematics, reaches
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.kinematics import body_frames, motion_frames
from kinesic.sim.servo_factors import Factors
from kinesic.sim.stepping import driven_motion
from kinesic.sim.twin import Twin
from kinesic.sim.worst_postures import random_postures

pytestmark = pytest.mark.skipif(kinematics.KERNEL != "compiled", reason="no compiled kernel")

ROBOTS = [Robot.load(), Robot.load("upper36")]


@pytest.fixture
def in_python(monkeypatch):
    def run(function):
        with monkeypatch.context() as patch:
            for module in (distances, driven_motion, dynamics, kinematics, reaches):
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
    find = partial(reaches.suspects, motion, ends, lowest, measure._reaches, limit=near)
    assert 0 < len(find()) < len(motion)
    np.testing.assert_array_equal(find(), in_python(find))


@pytest.mark.parametrize("robot", [*ROBOTS, Robot.load("human")], ids=lambda robot: robot.name)
def test_surveys_are_the_same_whatever_the_window(robot, in_python, monkeypatch):
    measure, postures = CapsuleDistances(robot), random_postures(robot.skeleton, 70, seed=8)
    wrists = [robot.arm(side).wrist for side in "lr"]
    monkeypatch.setattr(distances, "POSTURES_PER_WINDOW", 32)
    lowest, origins = measure.survey(postures, wrists)
    slow, places = in_python(lambda: measure.survey(postures, wrists))
    np.testing.assert_allclose(lowest, slow, rtol=0, atol=1e-12)
    np.testing.assert_allclose(origins, places, rtol=0, atol=1e-14)
    frames = motion_frames(robot.skeleton, postures)
    np.testing.assert_allclose(origins, frames.origins[wrists].transpose(0, 2, 1), rtol=0, atol=1e-14)


FACTORS = [Factors(), Factors(play=0.01, latency=0.013), Factors(resistance=0.4, gain=0.8)]


@pytest.mark.parametrize("factors", FACTORS, ids=["stiff", "play and latency", "sagging"])
def test_what_servos_did_is_the_same(factors, in_python):
    drives = ROBOTS[0].drives
    warm = (replace(each, servo=replace(each.servo, thermal=(5.0, 20.0))) for each in drives[:3])
    robot = ROBOTS[0]
    twin = Twin(robot, factors=factors)
    for k, row in enumerate(0.1 * swing(robot, 20)):
        twin.write(Command(k / RATE, row, row, row, robot.skeleton.clamp(row)))
    twin.write(Command(k / RATE, row, row, row, robot.skeleton.clamp(row)))  # an interval without length
    places = driven_motion.HingePlaces(np.arange(len(twin.physics[1].qpos))[twin._order], twin._play)
    known = twin._log.kept(), places, robot.skeleton.names, Drives((*warm, *drives[3:]))
    fast = driven_motion.measure_drives(*known)
    slow = in_python(lambda: driven_motion.measure_drives(*known))
    for name in ("postures", "angles", "speeds", "duties", "torques"):
        np.testing.assert_array_equal(getattr(fast, name), getattr(slow, name), err_msg=name)
    seen, law = twin.measurements(), driven_motion.measure_drives(*known[:3], twin._robot.drives)
    for name in ("duties", "torques"):
        np.testing.assert_array_equal(getattr(seen, name), getattr(law, name), err_msg=name)
    for name in ("mean", "peak", "energy", "volts"):
        np.testing.assert_allclose(getattr(fast.power, name), getattr(slow.power, name), rtol=1e-14, err_msg=name)
    assert fast.power.warming.keys() == slow.power.warming.keys()
    assert len(fast.power.warming) == 3
    for name, rises in slow.power.warming.items():
        np.testing.assert_allclose(fast.power.warming[name], rises, rtol=1e-13, err_msg=name)


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
