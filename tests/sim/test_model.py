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
from kinesic.sim.model import actuator_order, build_model, describe, joint_order, of_hinges, play_order
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, DriveFactors, Factors
from kinesic.sim.uncoupled import uncouple

ROBOT = Robot.load()
MODEL = build_model(ROBOT)

# [deg] the least ranges that the default robot may have
LEAST_RANGES = {
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


def test_the_orders_of_joints_are_the_same_by_name():
    assert list(joint_order(ROBOT, MODEL)) == list(range(22))
    assert [MODEL.actuator(k).name for k in range(MODEL.nu)] == list(ROBOT.skeleton.names)
    assert (MODEL.nq, MODEL.nv, MODEL.nu, MODEL.na) == (22, 22, 22, 0)


def test_compiled_ranges_are_radians_and_no_narrower_than_they_may_be():
    for name, lower, upper in zip(ROBOT.skeleton.names, ROBOT.skeleton.lower, ROBOT.skeleton.upper, strict=True):
        compiled = MODEL.joint(name).range
        assert compiled == pytest.approx([lower, upper], abs=1e-12)
        least = np.radians(LEAST_RANGES[side_free(name)])
        assert compiled[0] <= least[0] + 1e-12
        assert compiled[1] >= least[1] - 1e-12
        assert MODEL.joint(name).limited


def test_without_play_no_joint_is_added():
    assert len(play_order(ROBOT, MODEL)) == 0
    values = np.arange(22.0)
    np.testing.assert_array_equal(of_hinges(values, joint_order(ROBOT, MODEL), play_order(ROBOT, MODEL)), values)


def test_play_lets_a_hinge_that_carries_something_lie_against_its_stop():
    """Held by their motors, forearms that stick out forwards hang half the play lower."""
    play = np.radians(0.5).item()
    model = build_model(ROBOT, servos=Factors(play=play))
    data = mujoco.MjData(model)
    motors, gaps = joint_order(ROBOT, model), play_order(ROBOT, model)
    assert model.body_mass.sum() == pytest.approx(MODEL.body_mass.sum(), abs=1e-12)
    posture = np.array(ROBOT.skeleton.rest)
    elbows = [ROBOT.skeleton.joint(f"{side}_elbow_flexion") for side in "lr"]
    posture[elbows] = np.pi / 2
    data.qpos[motors] = posture
    data.ctrl[actuator_order(ROBOT, model)] = posture
    mujoco.mj_step(model, data, 500)
    np.testing.assert_allclose(data.qpos[gaps][elbows], -play / 2, rtol=0.07)
    np.testing.assert_array_equal(of_hinges(data.qpos, motors, gaps), data.qpos[motors] + data.qpos[gaps])
    assert np.abs(data.qpos[gaps]).max() < 0.55 * play


def test_total_mass_is_structure_and_servos():
    structure = sum(segment.mass for segment in ROBOT.skeleton.segments)
    servos = sum(drive.count * drive.servo.mass for drive in ROBOT.drives)
    assert MODEL.body_mass.sum() == pytest.approx(structure + servos, abs=1e-9)
    assert MODEL.body_mass.sum() == pytest.approx(5.945, abs=1e-9)
    assert build_model(ROBOT, servos=PESSIMISTIC).body_mass.sum() == pytest.approx(1.1 * 5.945, abs=1e-9)


def test_every_segment_outweighs_the_servos_it_carries():
    for segment in ROBOT.skeleton.segments:
        carried = sum(m.drive.count * m.drive.servo.mass for m in ROBOT.mounts if m.segment == segment.name)
        assert MODEL.body(segment.name).mass[0] >= 1.3 * carried, segment.name


def test_the_arm_is_of_a_plausible_length():
    assert 0.42 - 1e-9 <= ROBOT.arm_length <= 0.55


def test_left_is_the_mirror_of_right():
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


def test_hinges_have_the_drives_figures():
    for k, drive in enumerate(ROBOT.drives):
        assert MODEL.dof_armature[k] == pytest.approx(drive.armature)
        assert MODEL.dof_frictionloss[k] == pytest.approx(drive.frictionloss)
        assert MODEL.dof_damping[k] == pytest.approx(drive.damping)


@pytest.mark.parametrize("duty", [-3.0, -1.0, -0.4, 0.0, 0.7, 1.0, 2.5])
@pytest.mark.parametrize("speed", [-1.5, 0.0, 2.0])
def test_actuators_follow_the_servos_law(duty, speed):
    data = mujoco.MjData(MODEL)
    drives = ROBOT.drives
    data.qvel[:] = speed
    rates = np.array([drive.rate_gain / drive.stall for drive in drives])
    data.ctrl[:] = (duty + rates * speed) / drives.gain
    mujoco.mj_forward(MODEL, data)
    for k, drive in enumerate(drives):
        torque = drive.stall * min(1.0, max(-1.0, duty)) - drive.stall / drive.no_load * speed
        assert data.actuator_force[k] == pytest.approx(torque, rel=1e-9, abs=1e-9), ROBOT.skeleton.names[k]


def test_only_counted_pairs_may_touch():
    excluded = {
        frozenset((MODEL.body(int(signature) >> 16).name, MODEL.body(int(signature) & 0xFFFF).name))
        for signature in MODEL.exclude_signature
    }
    names = [segment.name for segment in ROBOT.skeleton.segments]
    everything = {frozenset((a, b)) for a in names for b in names if a != b}
    assert everything - excluded == {frozenset(pair) for pair in ROBOT.counted_pairs}


def test_nothing_touches_at_zero_and_a_hand_in_the_chest_does():
    data = mujoco.MjData(MODEL)
    mujoco.mj_forward(MODEL, data)
    assert data.ncon == 0
    data.qpos[ROBOT.skeleton.joint("l_shoulder_twisting")] = -1.2
    data.qpos[ROBOT.skeleton.joint("l_elbow_flexion")] = 2.0
    data.qpos[ROBOT.skeleton.joint("l_shoulder_flexion")] = -0.2
    mujoco.mj_forward(MODEL, data)
    assert data.ncon > 0


def test_sites_lie_where_the_robot_says():
    data = mujoco.MjData(MODEL)
    mujoco.mj_forward(MODEL, data)
    frames = ROBOT.skeleton.frames(np.zeros(22))
    for name, site in ROBOT.sites.items():
        k = ROBOT.skeleton.segment(site.segment)
        where = frames.origins[k] + frames.rotations[k] @ site.position
        assert data.site(name).xpos == pytest.approx(where, abs=1e-12)


LINK_MASS, LENGTH, RADIUS = 0.5, 0.2, 0.03  # of the pendulum's capsule
SERVO = ServoModel(
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
        path=ROBOT.path,
        skeleton=Skeleton((Segment("base", None, sealed([0, 0, 0]), 1.0, ()), link), (hinge,)),
        mounts=(Mount(Drive(SERVO, 1, 1.5), "base", sealed([0, 0, 0])),),
        chains={},
        sites={},
        exclusions=(),
        least_clearance=0.01,
        targets={},
    )


def swung_by_hand(drive, inertia, moment, goal, duration):
    """Angles [rad] every millisecond of a pendulum whose servo is told a goal, by small Runge-Kutta steps."""

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


def test_a_pendulum_swings_as_integrated_by_hand():
    capsule = Capsule(sealed([0, 0, -0.1]), sealed([0, 0, -0.1 - LENGTH]), RADIUS)
    robot = pendulum((capsule,))
    cylinder, balls = pi * RADIUS**2 * LENGTH, 4 / 3 * pi * RADIUS**3
    tube, caps = LINK_MASS * cylinder / (cylinder + balls), LINK_MASS * balls / (cylinder + balls)
    own = tube * (LENGTH**2 / 12 + RADIUS**2 / 4)
    own += caps * (2 / 5 * RADIUS**2 + LENGTH**2 / 4 + 3 / 8 * LENGTH * RADIUS)
    inertia = own + LINK_MASS * 0.2**2 + robot.drives[0].armature
    expected = swung_by_hand(robot.drives[0], inertia, LINK_MASS * 9.81 * 0.2, 1.2, 1.0)
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


def test_a_ball_and_a_bare_segment_have_their_mass():
    ball = Capsule(sealed([0, 0, -0.2]), sealed([0, 0, -0.2]), RADIUS)
    for capsules in ((ball,), ()):
        model = build_model(pendulum(capsules))
        assert model.body("link").mass[0] == pytest.approx(LINK_MASS)
        assert model.body("base").mass[0] == pytest.approx(1.0 + SERVO.mass)


def saved(model):
    """All bytes that MuJoCo writes of a model."""
    whole = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, whole)
    return whole


VARIANTS = [
    NOMINAL,
    PESSIMISTIC,
    Factors(gain=1.1, friction=1.5, latency=0.01),
    Factors(armature=1.3, play=0.01, supply=0.9),
    Factors(mass=1.2, servos={"xm540_w150": DriveFactors(armature=2.0, no_load=0.9), "muscle": DriveFactors(gain=0.8)}),
]


@pytest.mark.parametrize("name", ["upper22", "human"])
def test_a_model_whose_drives_were_exchanged_is_that_which_would_have_been_compiled(name):
    robot = Robot.load(name)
    known = {drive.servo.name for drive in robot.drives}
    for factors in VARIANTS:
        servos = {servo: own for servo, own in factors.servos.items() if servo in known}
        factors = msgspec.structs.replace(factors, servos=servos)  # noqa: PLW2901 - of this robot
        spec = describe(uncouple(factors.applied(robot)), play=factors.play)
        spec.compiler.discardvisual = True
        np.testing.assert_array_equal(saved(build_model(robot, servos=factors)), saved(spec.compile()))
