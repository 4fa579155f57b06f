import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.dry_run import dry_run
from kinesic.session.plan import plan
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.studies.sweep.measures import MEASURE_FORMATS, Measures, kinetic_energy, measures, sum_turns

ROBOT = Robot.load()


def test_kinetic_energy_of_a_motion_equals_that_of_mujoco():
    random = np.random.default_rng(3)
    angles = random.uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper, (5, len(ROBOT.skeleton.hinges)))
    speeds = random.normal(0.0, 2.0, angles.shape)
    model = build_model(ROBOT)
    data, order, wanted = mujoco.MjData(model), find_joint_indices(ROBOT, model), []
    for posture, speed in zip(angles, speeds, strict=True):
        data.qpos[order], data.qvel[order] = posture, speed
        mujoco.mj_fwdPosition(model, data)
        full = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        wanted.append(0.5 * data.qvel @ full @ data.qvel)
    np.testing.assert_allclose(kinetic_energy(MujocoDynamics(ROBOT), angles, speeds), wanted, rtol=1e-9)


def test_rotation_sum_of_a_joint_starts_again_at_each_reversal():
    steps = np.array([[0.2, 0.1], [0.3, -0.4], [-0.1, -0.2], [-0.1, 0.3]])
    np.testing.assert_allclose(sum_turns(steps), [[0.5, 0.1], [0.2, 0.6], [0.0, 0.3], [0.0, 0.0]])


def test_kinetic_energy_of_a_resting_robot_is_zero():
    still = np.zeros((2, len(ROBOT.skeleton.hinges)))
    assert kinetic_energy(MujocoDynamics(ROBOT), still + ROBOT.skeleton.rest, still).tolist() == [0.0, 0.0]


BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def measured(known, gesture: str) -> Measures:
    return measures(dry_run(plan(BLOCK.format(gesture), known)), "g")


@pytest.fixture(scope="module")
def right(known) -> Measures:
    return measured(known, '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" stroke="2"/>')


@pytest.fixture(scope="module")
def left(known) -> Measures:
    return measured(known, '<gesture id="g" lexeme="beat" mode="LEFT_HAND" stroke="2"/>')


def test_mirrored_gesture_has_equal_motion_measures(right, left):
    for name in MEASURE_FORMATS:
        if name != "stroke_error":
            assert getattr(left, name) == pytest.approx(getattr(right, name), rel=0.02, abs=1e-3), name


def test_gesture_measures_of_a_small_arm_lie_in_plausible_ranges(right):
    assert 0.2 < right.stroke_speed <= right.peak_speed < 3.0
    assert right.path_length > 2 * 0.2  # forward and back
    assert 0.0 < right.swept_volume < 0.03
    assert right.strokes == 1
    assert 0.2 < right.preparation < 1.2
    assert right.elbow_offset is not None
    assert -0.1 < right.elbow_offset < 0.55
    assert right.energy > 0.0
    assert right.overshoot < np.radians(5)
    assert right.allowed_speed > 0.0
    assert right.stroke_error is not None
    assert abs(right.stroke_error) < 0.01


def test_every_gesture_measure_has_a_label_and_unit():
    assert set(MEASURE_FORMATS) == set(Measures.__dataclass_fields__)


def test_measuring_a_behaviour_without_hands_is_refused(known):
    block = BLOCK.format('<head id="g" lexeme="NOD" start="0.2"/>')
    with pytest.raises(ValueError, match="g moves no hand"):
        measures(dry_run(plan(block, known)), "g")
