from dataclasses import replace

import mujoco
import numpy as np
import pytest

from kinesic.body.limits import MIN_ACCELERATION, MIN_DUTY, Limits
from kinesic.body.robot import Robot
from kinesic.sim.dynamics import COULOMB_FADE_VELOCITY, MujocoDynamics, _compute_load, _find_worst_static
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.servo_factors import Factors
from kinesic.sim.worst_postures import extremes, random_postures

ROBOT = Robot.load()
DYNAMICS = MujocoDynamics(ROBOT)
RANDOM_POSTURES = random_postures(ROBOT.skeleton, 40, seed=6)
ZERO_VELOCITIES = np.zeros_like(RANDOM_POSTURES)

# Documented accelerations [rad/s^2] and holding torque / stall torque, computed independently.
DOCUMENTED_ACCELERATIONS = [13, 17, 11, 93, 68, 71, *[32, 59, 59, 80, 81, 139, 350, 350] * 2]
DOCUMENTED_RATIOS = [
    0,
    0.215,
    0.251,
    0.105,
    0.220,
    0.201,
    *[0.217, 0.177, 0.177, 0.127, 0.127, 0.020, 0.043, 0.043] * 2,
]


def potential_energy(angles):
    """Return the potential energy [J] of all segments and servos.

    Computed from the skeleton and the model's centres of mass.
    """
    model = build_model(ROBOT)
    frames = ROBOT.skeleton.frames(angles)
    energy = 0.0
    for k, segment in enumerate(ROBOT.skeleton.segments):
        body = model.body(segment.name)
        energy += 9.81 * body.mass[0] * (frames.origins[k] + frames.rotations[k] @ body.ipos)[2]
    return energy


def test_holding_torque_is_the_gradient_of_potential_energy():
    posture, step = RANDOM_POSTURES[4], 1e-5
    slope = [
        (potential_energy(posture + step * unit) - potential_energy(posture - step * unit)) / (2 * step)
        for unit in np.eye(22)
    ]
    assert DYNAMICS.holding(posture[None])[0] == pytest.approx(slope, abs=1e-7)


def test_torque_grows_with_inertia_times_acceleration():
    inertias = DYNAMICS.inertias(RANDOM_POSTURES)
    for hinge in (1, 7, 13, 20):
        pushed = ZERO_VELOCITIES.copy()
        pushed[:, hinge] = 3.0
        more = DYNAMICS.torques(RANDOM_POSTURES, ZERO_VELOCITIES, pushed) - DYNAMICS.holding(RANDOM_POSTURES)
        assert more[:, hinge] == pytest.approx(3.0 * inertias[:, hinge], rel=1e-9)


def test_inertia_of_each_hinge_exceeds_the_armature_of_its_drive():
    assert (DYNAMICS.inertias(RANDOM_POSTURES) > [drive.armature for drive in ROBOT.drives]).all()


def test_friction_torque_is_a_tanh_of_velocity_plus_linear_damping():
    drive, hinge = ROBOT.drives[13], 13  # the last wrist hinge carries no other hinge
    for speed in (-2.0, 0.5 * COULOMB_FADE_VELOCITY, 1.0):
        speeds = ZERO_VELOCITIES[:1].copy()
        speeds[0, hinge] = speed
        more = (
            DYNAMICS.torques(RANDOM_POSTURES[:1], speeds, ZERO_VELOCITIES[:1])[0, hinge]
            - DYNAMICS.holding(RANDOM_POSTURES[:1])[0, hinge]
        )
        expected = drive.frictionloss * np.tanh(speed / COULOMB_FADE_VELOCITY) + drive.damping * speed
        assert more == pytest.approx(expected, abs=1e-6)


def test_holding_torque_of_a_colliding_posture_excludes_contact_forces():
    inside = ROBOT.skeleton.rest.copy()
    inside[ROBOT.skeleton.joint("l_shoulder_abduct")] = -0.6
    held = DYNAMICS.holding(inside[None])[0]
    assert np.abs(held).max() < 3.0


def test_acceleration_limits_agree_with_the_documented_values():
    limits = Limits.of(ROBOT, DYNAMICS.load).acceleration
    assert limits == pytest.approx(DOCUMENTED_ACCELERATIONS, rel=0.06)
    assert np.array_equal(limits[6:14], limits[14:22])
    _compute_load.cache_clear()
    _find_worst_static.cache_clear()
    assert np.array_equal(limits, Limits.of(ROBOT, MujocoDynamics(ROBOT).load).acceleration)


def test_default_robot_holds_each_posture_with_at_most_40_percent_of_stall_torque():
    worst = DYNAMICS.worst_static
    assert worst.values == pytest.approx(DOCUMENTED_RATIOS, abs=0.005)
    assert worst.values.max() <= 0.40
    again = DYNAMICS.static_ratios(worst.postures).diagonal()
    assert worst.values == pytest.approx(again)


def test_equal_robots_share_their_worst_case_load():
    first, second = (MujocoDynamics(Robot.load()) for _ in range(2))
    assert first.load is second.load
    assert first.worst_static is second.worst_static


def test_robot_with_another_mass_drive_range_or_rest_posture_has_its_own_worst_case_load():
    hinges = ROBOT.skeleton.hinges

    def turn(**changes: float) -> Robot:
        changed = tuple(replace(hinge, **changes) if k == 7 else hinge for k, hinge in enumerate(hinges))
        return replace(ROBOT, skeleton=replace(ROBOT.skeleton, hinges=changed))

    for changed in (
        Factors(mass=1.1).applied(ROBOT),
        Factors(stall=0.9).applied(ROBOT),
        turn(lower=hinges[7].lower + 0.1),
        turn(upper=hinges[7].upper - 0.1),
        turn(rest=hinges[7].rest + 0.1),
    ):
        dynamics = MujocoDynamics(changed)
        load, worst = dynamics.load, dynamics.worst_static
        assert load is not DYNAMICS.load
        assert np.array_equal(worst.values, extremes(changed.skeleton, dynamics.static_ratios).values)


def test_overloaded_drive_still_gets_a_positive_acceleration_limit():
    weak = Factors(stall=0.1).applied(ROBOT)
    limits = Limits.of(weak, MujocoDynamics(weak).load)
    assert limits.acceleration.min() == MIN_ACCELERATION
    assert limits.duty.min() == MIN_DUTY


def test_torques_equal_mujoco_inverse_dynamics():
    """Compare with `mj_inverse`, to which friction is added."""
    random = np.random.default_rng(5)
    postures = random_postures(ROBOT.skeleton, 40, seed=5)
    speeds, accelerations = random.normal(0.0, 2.0, (2, 40, 22))
    model = build_model(ROBOT)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data, order = mujoco.MjData(model), find_joint_indices(ROBOT, model)
    friction = ROBOT.drives.frictionloss
    result = MujocoDynamics(ROBOT).torques(postures, speeds, accelerations)
    for k in range(40):
        data.qpos[order], data.qvel[order], data.qacc[order] = postures[k], speeds[k], accelerations[k]
        mujoco.mj_inverse(model, data)
        rubbing = friction * np.tanh(speeds[k] / COULOMB_FADE_VELOCITY)
        assert result[k] == pytest.approx(data.qfrc_inverse[order] + rubbing, abs=1e-11)


def test_python_fallback_of_the_dynamics_gives_equal_torques(monkeypatch: pytest.MonkeyPatch):
    results = (
        DYNAMICS.holding(RANDOM_POSTURES),
        DYNAMICS.inertias(RANDOM_POSTURES),
        DYNAMICS.torques(RANDOM_POSTURES, RANDOM_POSTURES, RANDOM_POSTURES),
    )
    monkeypatch.setattr("kinesic.sim.dynamics.function_address", lambda name: None)
    again = (
        DYNAMICS.holding(RANDOM_POSTURES),
        DYNAMICS.inertias(RANDOM_POSTURES),
        DYNAMICS.torques(RANDOM_POSTURES, RANDOM_POSTURES, RANDOM_POSTURES),
    )
    for kernel, python in zip(results, again, strict=True):
        assert np.array_equal(kernel, python)
