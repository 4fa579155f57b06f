"""Compiled kernels against reference implementations in NumPy."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.command import COMMAND_RATE, Command
from kinesic.body.robot import Robot
from kinesic.body.servo import Drives
from kinesic.sim import distances, dynamics, kinematics, reaches
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.kinematics import body_frames, compute_motion_frames
from kinesic.sim.servo_factors import Factors
from kinesic.sim.stepping import driven_motion
from kinesic.sim.twin import Twin
from kinesic.sim.worst_postures import random_postures

from ..reference.sim import distances as reference
from ..reference.sim import driven_motion as reference_drives
from ..reference.sim import kinematics as reference_kinematics
from ..reference.sim.distances import ReferenceDistances

ROBOTS = [Robot.load(), Robot.load("upper36")]


def make_motion(robot: Robot, count: int = 150) -> np.ndarray:
    """Return a motion through three random postures."""
    ends = random_postures(robot.skeleton, 3, seed=5)
    return np.concatenate([np.linspace(a, b, count) for a, b in pairwise(ends)])


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_kernel_frames_equal_the_python_reference(robot):
    postures = random_postures(robot.skeleton, 70, seed=3)
    fast = compute_motion_frames(robot.skeleton, postures)
    slow = reference_kinematics.compute_motion_frames(robot.skeleton, postures)
    np.testing.assert_allclose(fast.rotations, slow.rotations, rtol=0, atol=1e-14)
    np.testing.assert_allclose(fast.origins, slow.origins, rtol=0, atol=1e-14)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_kernel_distances_equal_the_python_reference(robot):
    measure, postures = CapsuleDistances(robot), random_postures(robot.skeleton, 150, seed=4)
    fast, slow = measure.clearance(postures), ReferenceDistances(robot).clearance(postures)
    np.testing.assert_allclose(fast.distances, slow.distances, rtol=0, atol=1e-12)
    assert fast.pairs == slow.pairs
    gaps = measure.gaps(postures)
    np.testing.assert_allclose(gaps, ReferenceDistances(robot).gaps(postures), rtol=0, atol=1e-12)


@pytest.mark.parametrize("near", [0.03, 0.1])
@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_kernel_and_reference_find_equal_closest_approaches_and_select_equal_postures(robot, near):
    measure, motion = CapsuleDistances(robot), make_motion(robot)
    ends = np.arange(0, len(motion), 3)
    fast, slow = (item.approach(motion, ends, near=near) for item in (measure, ReferenceDistances(robot)))
    np.testing.assert_allclose(fast.distances, slow.distances, rtol=0, atol=1e-12)
    lowest = measure.lowest(body_frames(robot, motion[ends]), motion[ends])
    near = max(near, float(lowest.min()))
    fast, slow = (
        suspects(motion, ends, lowest, measure._reaches, limit=near)
        for suspects in (reaches.suspects, reference.suspects)
    )
    assert 0 < len(fast) < len(motion)
    np.testing.assert_array_equal(fast, slow)


@pytest.mark.parametrize("robot", [*ROBOTS, Robot.load("human")], ids=lambda robot: robot.name)
def test_computed_distances_do_not_depend_on_the_window_size(robot, monkeypatch):
    measure, postures = CapsuleDistances(robot), random_postures(robot.skeleton, 70, seed=8)
    wrists = [robot.arm(side).wrist for side in "lr"]
    monkeypatch.setattr(distances, "POSTURES_PER_WINDOW", 32)
    lowest, origins = measure.survey(postures, wrists)
    slow, places = ReferenceDistances(robot).survey(postures, wrists)
    np.testing.assert_allclose(lowest, slow, rtol=0, atol=1e-12)
    np.testing.assert_allclose(origins, places, rtol=0, atol=1e-14)
    frames = compute_motion_frames(robot.skeleton, postures)
    np.testing.assert_allclose(origins, frames.origins[wrists].transpose(0, 2, 1), rtol=0, atol=1e-14)


TWIN_VARIANTS = [Factors(), Factors(play=0.01, latency=0.013), Factors(resistance=0.4, gain=0.8)]


@pytest.mark.parametrize("factors", TWIN_VARIANTS, ids=["stiff", "play and latency", "sagging"])
def test_kernel_servo_measurements_equal_the_python_reference(factors):
    drives = ROBOTS[0].drives
    warm = (replace(drive, servo=replace(drive.servo, thermal=(5.0, 20.0))) for drive in drives[:3])
    robot = ROBOTS[0]
    twin = Twin(robot, factors=factors)
    for k, row in enumerate(0.1 * make_motion(robot, 20)):
        twin.write(Command(k / COMMAND_RATE, row, row, row, robot.skeleton.clamp(row)))
    twin.write(Command(k / COMMAND_RATE, row, row, row, robot.skeleton.clamp(row)))  # an interval of zero duration
    places = driven_motion.HingePlaces(np.arange(len(twin.physics[1].qpos))[twin._order], twin._play)
    known = twin._log.steps(), places, robot.skeleton.names, Drives((*warm, *drives[3:]))
    fast = driven_motion.measure_drives(*known)
    slow = reference_drives.measure_drives(*known)
    for name in ("postures", "angles", "velocities", "duties", "torques"):
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


def test_torques_are_equal_without_mujoco_function_addresses(monkeypatch):
    robot = ROBOTS[0]
    model, chance = MujocoDynamics(robot), np.random.default_rng(2)
    postures = random_postures(robot.skeleton, 20, seed=6)
    motion = postures, chance.normal(size=postures.shape), chance.normal(size=postures.shape)
    fast = model.torques(*motion)
    monkeypatch.setattr(dynamics, "function_address", lambda name: None)
    slow = model.torques(*motion)
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-12)
    assert np.abs(fast).max() > 1.0


def test_kinematics_kernel_rejects_arrays_of_wrong_shape():
    frames = kinematics.compile_frames(ROBOTS[0].skeleton)
    with pytest.raises(ValueError, match="do not fit"):
        frames.solve(np.ones(3, dtype=np.bool_), np.zeros(4), np.zeros(4), np.zeros(9), np.zeros(3))
