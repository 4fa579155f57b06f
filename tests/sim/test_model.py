from math import pi

import msgspec
import mujoco
import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.description import Mount
from kinesic.body.robot import Robot
from kinesic.body.servo import Drive, ServoModel
from kinesic.body.skeleton import Capsule, Hinge, Segment, Skeleton
from kinesic.sim.model import (
    build_model,
    describe,
    find_actuator_indices,
    find_joint_indices,
    find_play_indices,
    sum_hinge_values,
)
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, DriveFactors, Factors
from kinesic.sim.uncoupled import uncouple

ROBOT = Robot.load()
MODEL = build_model(ROBOT)

# Smallest allowed ranges of the default robot [deg].
REQUIRED_RANGES = {
    "vl5_torsion": (-50, 50),
    "vl5_tilt": (-15, 35),
    "vl5_roll": (-20, 20),
    "skullbase_torsion": (-75, 75),
    "skullbase_tilt": (-35, 40),
    "skullbase_roll": (-25, 25),
    "sternoclavicular_abduct": (-10, 25),
    "shoulder_flexion": (-50, 170),
    "shoulder_abduct": (-40, 120),
    "shoulder_twisting": (-90, 90),
    "elbow_flexion": (0, 135),
    "elbow_twisting": (-85, 85),
    "wrist_flexion": (-60, 60),
    "wrist_pivot": (-30, 30),
}


def side_free(name):
    return name.removeprefix("l_").removeprefix("r_")


def test_mujoco_joints_and_actuators_have_the_order_of_the_skeleton():
    assert list(find_joint_indices(ROBOT, MODEL)) == list(range(22))
    assert [MODEL.actuator(k).name for k in range(MODEL.nu)] == list(ROBOT.skeleton.names)
    assert (MODEL.nq, MODEL.nv, MODEL.nu, MODEL.na) == (22, 22, 22, 0)


def test_joint_ranges_match_the_robot_description_and_contain_the_required_ranges():
    for name, lower, upper in zip(ROBOT.skeleton.names, ROBOT.skeleton.lower, ROBOT.skeleton.upper, strict=True):
        compiled = MODEL.joint(name).range
        assert compiled == pytest.approx([lower, upper], abs=1e-12)
        least = np.radians(REQUIRED_RANGES[side_free(name)])
        assert compiled[0] <= least[0] + 1e-12
        assert compiled[1] >= least[1] - 1e-12
        assert MODEL.joint(name).limited


def test_model_without_backlash_has_no_backlash_joints():
    assert len(find_play_indices(ROBOT, MODEL)) == 0
    values = np.arange(22.0)
    np.testing.assert_array_equal(
        sum_hinge_values(values, find_joint_indices(ROBOT, MODEL), find_play_indices(ROBOT, MODEL)), values
    )


def test_loaded_hinge_with_backlash_rests_at_its_backlash_stop():
    """With motors holding, horizontal forearms hang lower by half the backlash."""
    play = np.radians(0.5).item()
    model = build_model(ROBOT, servos=Factors(play=play))
    data = mujoco.MjData(model)
    motors, gaps = find_joint_indices(ROBOT, model), find_play_indices(ROBOT, model)
    assert model.body_mass.sum() == pytest.approx(MODEL.body_mass.sum(), abs=1e-12)
    posture = np.array(ROBOT.skeleton.rest)
    elbows = [ROBOT.skeleton.joint(f"{side}_elbow_flexion") for side in "lr"]
    posture[elbows] = np.pi / 2
    data.qpos[motors] = posture
    data.ctrl[find_actuator_indices(ROBOT, model)] = posture
    mujoco.mj_step(model, data, 500)
    np.testing.assert_allclose(data.qpos[gaps][elbows], -play / 2, rtol=0.07)
    np.testing.assert_array_equal(sum_hinge_values(data.qpos, motors, gaps), data.qpos[motors] + data.qpos[gaps])
    assert np.abs(data.qpos[gaps]).max() < 0.55 * play


def test_total_mass_of_the_default_robot_is_that_of_segments_plus_servos():
    structure = sum(segment.mass for segment in ROBOT.skeleton.segments)
    servos = sum(drive.count * drive.servo.mass for drive in ROBOT.drives)
    assert MODEL.body_mass.sum() == pytest.approx(structure + servos, abs=1e-9)
    assert MODEL.body_mass.sum() == pytest.approx(5.945, abs=1e-9)
    assert build_model(ROBOT, servos=PESSIMISTIC_FACTORS).body_mass.sum() == pytest.approx(1.1 * 5.945, abs=1e-9)


def test_default_robot_segments_weigh_at_least_1_3_times_their_servos():
    for segment in ROBOT.skeleton.segments:
        carried = sum(m.drive.count * m.drive.servo.mass for m in ROBOT.mounts if m.segment == segment.name)
        assert MODEL.body(segment.name).mass[0] >= 1.3 * carried, segment.name


def test_arm_length_of_the_default_robot_is_between_42_and_55_cm():
    assert 0.42 - 1e-9 <= ROBOT.arm_length <= 0.55


def test_left_side_of_the_physics_model_mirrors_the_right_side():
    flip = np.array([1, -1, 1])
    for segment in ROBOT.skeleton.segments:
        if segment.name.startswith("l_"):
            left, right = MODEL.body(segment.name), MODEL.body(f"r_{side_free(segment.name)}")
            assert left.mass == pytest.approx(right.mass, abs=1e-15)
            assert left.pos * flip == pytest.approx(right.pos, abs=1e-15)
            assert left.ipos * flip == pytest.approx(right.ipos, abs=1e-12)
            assert left.inertia == pytest.approx(right.inertia, rel=1e-9)
    for name in ROBOT.skeleton.names:
        if name.startswith("l_"):
            left, right = MODEL.joint(name), MODEL.joint(f"r_{side_free(name)}")
            assert left.axis * -flip == pytest.approx(right.axis, abs=1e-15)
            assert left.range == pytest.approx(right.range, abs=1e-15)


def test_joints_of_the_physics_model_have_the_drive_parameters():
    for k, drive in enumerate(ROBOT.drives):
        assert MODEL.dof_armature[k] == pytest.approx(drive.armature)
        assert MODEL.dof_frictionloss[k] == pytest.approx(drive.frictionloss)
        assert MODEL.dof_damping[k] == pytest.approx(drive.damping)


@pytest.mark.parametrize("duty", [-3.0, -1.0, -0.4, 0.0, 0.7, 1.0, 2.5])
@pytest.mark.parametrize("speed", [-1.5, 0.0, 2.0])
def test_actuators_follow_the_servo_control_law(duty, speed):
    data = mujoco.MjData(MODEL)
    drives = ROBOT.drives
    data.qvel[:] = speed
    rates = np.array([drive.rate_gain / drive.stall for drive in drives])
    data.ctrl[:] = (duty + rates * speed) / drives.gain
    mujoco.mj_forward(MODEL, data)
    for k, drive in enumerate(drives):
        torque = drive.stall * min(1.0, max(-1.0, duty)) - drive.stall / drive.no_load * speed
        assert data.actuator_force[k] == pytest.approx(torque, rel=1e-9, abs=1e-9), ROBOT.skeleton.names[k]


def test_only_segment_pairs_of_the_collision_check_can_collide():
    excluded = {
        frozenset((MODEL.body(int(signature) >> 16).name, MODEL.body(int(signature) & 0xFFFF).name))
        for signature in MODEL.exclude_signature
    }
    names = [segment.name for segment in ROBOT.skeleton.segments]
    everything = {frozenset((a, b)) for a in names for b in names if a != b}
    assert everything - excluded == {frozenset(pair) for pair in ROBOT.counted_pairs}


def test_mujoco_has_contacts_in_a_colliding_posture_but_none_in_the_zero_posture():
    data = mujoco.MjData(MODEL)
    mujoco.mj_forward(MODEL, data)
    assert data.ncon == 0
    data.qpos[ROBOT.skeleton.joint("l_shoulder_twisting")] = -1.2
    data.qpos[ROBOT.skeleton.joint("l_elbow_flexion")] = 2.0
    data.qpos[ROBOT.skeleton.joint("l_shoulder_flexion")] = -0.2
    mujoco.mj_forward(MODEL, data)
    assert data.ncon > 0


def test_sites_of_the_physics_model_are_at_the_described_positions():
    data = mujoco.MjData(MODEL)
    mujoco.mj_forward(MODEL, data)
    frames = ROBOT.skeleton.frames(np.zeros(22))
    for name, site in ROBOT.sites.items():
        k = ROBOT.skeleton.segment(site.segment)
        where = frames.origins[k] + frames.rotations[k] @ site.position
        assert data.site(name).xpos == pytest.approx(where, abs=1e-12)


LINK_MASS = 0.5  # [kg] of the pendulum
LINK_LENGTH = 0.2  # [m] of the pendulum's capsule
LINK_RADIUS = 0.03  # [m] of the pendulum's capsule
PENDULUM_SERVO = ServoModel(
    name="test",
    model=1,
    volt=12.0,
    stall_nm=4.0,
    stall_a=2.0,
    no_load_rpm=46.0,
    gear=300.0,
    mass=0.08,
    size=(0.03, 0.05, 0.03),
    p_gain=800,
    d_gain=1000,
    kp_divisor=128,
    armature=0.045,
    frictionloss=0.0,
    damping=0.02,
)


def pendulum(capsules):
    link = Segment("link", "base", sealed([0, 0, 1]), LINK_MASS, capsules)
    hinge = Hinge("swing", "link", sealed([0, 1, 0]), -3.0, 3.0, 0.0)
    return Robot(
        name="pendulum",
        contact_distance=0.015,
        path=ROBOT.path,
        skeleton=Skeleton((Segment("base", None, sealed([0, 0, 0]), 1.0, ()), link), (hinge,)),
        mounts=(Mount(Drive(PENDULUM_SERVO, 1, 1.5), "base", sealed([0, 0, 0])),),
        chains={},
        sites={},
        exclusions=(),
        min_clearance=0.01,
        targets={},
    )


def integrate_pendulum(drive, inertia, moment, goal, duration):
    """Integrate a servo-driven pendulum with Runge-Kutta, one angle [rad] per millisecond."""

    def change(state):
        angle, speed = state
        duty = np.clip(drive.gain * (goal - angle) - drive.rate_gain / drive.stall * speed, -1, 1)
        torque = drive.stall * duty - drive.stall / drive.no_load * speed
        return np.array([speed, (torque - drive.damping * speed - moment * np.sin(angle)) / inertia])

    state, step, angles = np.zeros(2), 2.5e-4, []
    for k in range(round(duration / step)):
        a = change(state)
        b = change(state + step / 2 * a)
        c = change(state + step / 2 * b)
        d = change(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        if k % 4 == 3:
            angles.append(state[0])
    return np.array(angles)


def test_simulated_pendulum_equals_independent_integration():
    capsule = Capsule(sealed([0, 0, -0.1]), sealed([0, 0, -0.1 - LINK_LENGTH]), LINK_RADIUS)
    robot = pendulum((capsule,))
    cylinder, balls = pi * LINK_RADIUS**2 * LINK_LENGTH, 4 / 3 * pi * LINK_RADIUS**3
    tube, caps = LINK_MASS * cylinder / (cylinder + balls), LINK_MASS * balls / (cylinder + balls)
    own = tube * (LINK_LENGTH**2 / 12 + LINK_RADIUS**2 / 4)
    own += caps * (2 / 5 * LINK_RADIUS**2 + LINK_LENGTH**2 / 4 + 3 / 8 * LINK_LENGTH * LINK_RADIUS)
    inertia = own + LINK_MASS * 0.2**2 + robot.drives[0].armature
    expected = integrate_pendulum(robot.drives[0], inertia, LINK_MASS * 9.81 * 0.2, 1.2, 1.0)
    model = build_model(robot)
    model.opt.timestep = 5e-4
    data = mujoco.MjData(model)
    data.ctrl[0] = 1.2
    angles = []
    for _ in range(1000):
        mujoco.mj_step(model, data, 2)
        angles.append(data.qpos[0])
    assert robot.drives[0].gain * 1.2 > 1.0, "the duty must saturate at first"
    assert np.degrees(np.abs(np.array(angles) - expected).max()) < 0.1


def test_spherical_segment_and_segment_without_shapes_have_their_described_mass():
    ball = Capsule(sealed([0, 0, -0.2]), sealed([0, 0, -0.2]), LINK_RADIUS)
    for capsules in ((ball,), ()):
        model = build_model(pendulum(capsules))
        assert model.body("link").mass[0] == pytest.approx(LINK_MASS)
        assert model.body("base").mass[0] == pytest.approx(1.0 + PENDULUM_SERVO.mass)


def model_bytes(model):
    """Return all bytes that MuJoCo writes for a model."""
    whole = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, whole)
    return whole


FACTOR_VARIANTS = [
    NOMINAL_FACTORS,
    PESSIMISTIC_FACTORS,
    Factors(gain=1.1, friction=1.5, latency=0.01),
    Factors(armature=1.3, play=0.01, supply=0.9),
    Factors(mass=1.2, servos={"xm540_w150": DriveFactors(armature=2.0, no_load=0.9), "muscle": DriveFactors(gain=0.8)}),
]


@pytest.mark.parametrize("name", ["upper22", "human"])
def test_model_with_replaced_drives_equals_a_new_model(name):
    robot = Robot.load(name)
    known = {drive.servo.name for drive in robot.drives}
    for factors in FACTOR_VARIANTS:
        servos = {servo: own for servo, own in factors.servos.items() if servo in known}
        factors = msgspec.structs.replace(factors, servos=servos)  # noqa: PLW2901 - of this robot
        spec = describe(uncouple(factors.applied(robot)), play=factors.play)
        spec.compiler.discardvisual = True
        np.testing.assert_array_equal(model_bytes(build_model(robot, servos=factors)), model_bytes(spec.compile()))
