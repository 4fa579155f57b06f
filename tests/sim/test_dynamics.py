import mujoco
import numpy as np
import pytest

from kinesic.body.limits import LEAST_ACCELERATION, LEAST_DUTY, Limits
from kinesic.body.robot import Robot
from kinesic.sim.dynamics import FRICTION_SPEED, MujocoDynamics
from kinesic.sim.model import build_model, joint_order
from kinesic.sim.servo_factors import Factors
from kinesic.sim.worst_postures import random_postures

ROBOT = Robot.load()
DYNAMICS = MujocoDynamics(ROBOT)
POSTURES = random_postures(ROBOT.skeleton, 40, seed=6)
STILL = np.zeros_like(POSTURES)

# [rad/s^2] and shares of stall that the robot's sheet gives, computed with other code
SHEET_ACCELERATION = [13, 17, 11, 93, 68, 71, *[32, 59, 59, 80, 81, 139, 350, 350] * 2]
SHEET_RATIO = [0, 0.215, 0.251, 0.105, 0.220, 0.201, *[0.217, 0.177, 0.177, 0.127, 0.127, 0.020, 0.043, 0.043] * 2]


def potential_energy(angles):
    """[J] of all segments and their servos, from the skeleton and the model's centres of mass."""
    model = build_model(ROBOT)
    frames = ROBOT.skeleton.frames(angles)
    energy = 0.0
    for k, segment in enumerate(ROBOT.skeleton.segments):
        body = model.body(segment.name)
        energy += 9.81 * body.mass[0] * (frames.origins[k] + frames.rotations[k] @ body.ipos)[2]
    return energy


def test_holding_torque_is_the_slope_of_the_potential_energy():
    posture, step = POSTURES[4], 1e-5
    slope = [
        (potential_energy(posture + step * unit) - potential_energy(posture - step * unit)) / (2 * step)
        for unit in np.eye(22)
    ]
    assert DYNAMICS.holding(posture[None])[0] == pytest.approx(slope, abs=1e-7)


def test_torque_grows_with_inertia_times_acceleration():
    inertias = DYNAMICS.inertias(POSTURES)
    for hinge in (1, 7, 13, 20):
        pushed = STILL.copy()
        pushed[:, hinge] = 3.0
        more = DYNAMICS.torques(POSTURES, STILL, pushed) - DYNAMICS.holding(POSTURES)
        assert more[:, hinge] == pytest.approx(3.0 * inertias[:, hinge], rel=1e-9)


def test_inertia_includes_the_armature():
    assert (DYNAMICS.inertias(POSTURES) > [drive.armature for drive in ROBOT.drives]).all()


def test_friction_and_damping_are_added_smoothly():
    drive, hinge = ROBOT.drives[13], 13  # a wrist hinge alone feels no other
    for speed in (-2.0, 0.5 * FRICTION_SPEED, 1.0):
        speeds = STILL[:1].copy()
        speeds[0, hinge] = speed
        more = DYNAMICS.torques(POSTURES[:1], speeds, STILL[:1])[0, hinge] - DYNAMICS.holding(POSTURES[:1])[0, hinge]
        expected = drive.frictionloss * np.tanh(speed / FRICTION_SPEED) + drive.damping * speed
        assert more == pytest.approx(expected, abs=1e-6)


def test_a_touching_posture_gets_no_help():
    inside = ROBOT.skeleton.rest.copy()
    inside[ROBOT.skeleton.joint("l_shoulder_abduct")] = -0.6
    held = DYNAMICS.holding(inside[None])[0]
    assert np.abs(held).max() < 3.0


def test_acceleration_limits_agree_with_the_sheet():
    limits = Limits.of(ROBOT, DYNAMICS.load).acceleration
    assert limits == pytest.approx(SHEET_ACCELERATION, rel=0.06)
    assert np.array_equal(limits[6:14], limits[14:22])
    assert np.array_equal(limits, Limits.of(ROBOT, MujocoDynamics(ROBOT).load).acceleration)


def test_no_hinge_needs_more_than_two_fifths_of_its_stall_torque():
    worst = DYNAMICS.worst_static
    assert worst.values == pytest.approx(SHEET_RATIO, abs=0.005)
    assert worst.values.max() <= 0.40
    again = DYNAMICS.static_ratios(worst.postures).diagonal()
    assert worst.values == pytest.approx(again)


def test_a_drive_that_cannot_hold_itself_still_gets_a_positive_limit():
    weak = Factors(stall=0.1).applied(ROBOT)
    limits = Limits.of(weak, MujocoDynamics(weak).load)
    assert limits.acceleration.min() == LEAST_ACCELERATION
    assert limits.duty.min() == LEAST_DUTY


def test_mujoco_finds_the_same_torques():
    """`mj_inverse` adds armature and damping by itself; friction is a constraint, and so not among them."""
    random = np.random.default_rng(5)
    postures = random_postures(ROBOT.skeleton, 40, seed=5)
    speeds, accelerations = random.normal(0.0, 2.0, (2, 40, 22))
    model = build_model(ROBOT)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data, order = mujoco.MjData(model), joint_order(ROBOT, model)
    friction = ROBOT.drives.frictionloss
    found = MujocoDynamics(ROBOT).torques(postures, speeds, accelerations)
    for k in range(40):
        data.qpos[order], data.qvel[order], data.qacc[order] = postures[k], speeds[k], accelerations[k]
        mujoco.mj_inverse(model, data)
        rubbing = friction * np.tanh(speeds[k] / FRICTION_SPEED)
        assert found[k] == pytest.approx(data.qfrc_inverse[order] + rubbing, abs=1e-11)


def test_mujoco_called_from_python_finds_the_same(monkeypatch: pytest.MonkeyPatch):
    found = DYNAMICS.holding(POSTURES), DYNAMICS.inertias(POSTURES), DYNAMICS.torques(POSTURES, POSTURES, POSTURES)
    monkeypatch.setattr("kinesic.sim.dynamics.KERNEL", "numpy")
    again = DYNAMICS.holding(POSTURES), DYNAMICS.inertias(POSTURES), DYNAMICS.torques(POSTURES, POSTURES, POSTURES)
    for kernel, python in zip(found, again, strict=True):
        assert np.array_equal(kernel, python)
