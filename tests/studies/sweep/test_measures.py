import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.perform import perform
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.model import build_model, joint_order
from kinesic.studies.sweep.measures import SHOWN, Measures, kinetic_energy, measures, turns_one_way

ROBOT = Robot.load()


def test_it_is_the_energy_that_mujoco_has():
    random = np.random.default_rng(3)
    angles = random.uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper, (5, len(ROBOT.skeleton.hinges)))
    speeds = random.normal(0.0, 2.0, angles.shape)
    model = build_model(ROBOT)
    data, order, wanted = mujoco.MjData(model), joint_order(ROBOT, model), []
    for posture, speed in zip(angles, speeds, strict=True):
        data.qpos[order], data.qvel[order] = posture, speed
        mujoco.mj_fwdPosition(model, data)
        full = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        wanted.append(0.5 * data.qvel @ full @ data.qvel)
    np.testing.assert_allclose(kinetic_energy(MujocoDynamics(ROBOT), angles, speeds), wanted, rtol=1e-9)


def test_a_hinge_that_turns_back_begins_a_new_turn():
    steps = np.array([[0.2, 0.1], [0.3, -0.4], [-0.1, -0.2], [-0.1, 0.3]])
    np.testing.assert_allclose(turns_one_way(steps), [[0.5, 0.1], [0.2, 0.6], [0.0, 0.3], [0.0, 0.0]])


def test_a_body_at_rest_has_none():
    still = np.zeros((2, len(ROBOT.skeleton.hinges)))
    assert kinetic_energy(MujocoDynamics(ROBOT), still + ROBOT.skeleton.rest, still).tolist() == [0.0, 0.0]


BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def measured(known, gesture: str) -> Measures:
    return measures(perform(BLOCK.format(gesture), known), "g")


@pytest.fixture(scope="module")
def right(known) -> Measures:
    return measured(known, '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" stroke="2"/>')


@pytest.fixture(scope="module")
def left(known) -> Measures:
    return measured(known, '<gesture id="g" lexeme="beat" mode="LEFT_HAND" stroke="2"/>')


def test_the_mirrored_gesture_measures_the_same(right, left):
    for name in SHOWN:
        if name != "stroke_error":
            assert getattr(left, name) == pytest.approx(getattr(right, name), rel=0.02, abs=1e-3), name


def test_figures_are_those_of_a_small_arm(right):
    assert 0.2 < right.stroke_speed <= right.peak_speed < 3.0
    assert right.path_length > 2 * 0.2  # there and back
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


def test_every_measure_has_words():
    assert set(SHOWN) == set(Measures.__dataclass_fields__)


def test_a_behaviour_without_hands_is_refused(known):
    block = BLOCK.format('<head id="g" lexeme="NOD" start="0.2"/>')
    with pytest.raises(ValueError, match="g moves no hand"):
        measures(perform(block, known), "g")
