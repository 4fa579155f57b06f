"""Steps stay whole wherever MuJoCo is not the one whose stages are known."""

import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL
from kinesic.sim.stepping import friction_step
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.stepping.friction_step import AFTER, find_friction_parts, stages_make_a_step
from kinesic.sim.stepping.simulation import build_simulation
from kinesic.sim.twin import STEP

ROBOT = Robot.load()

pytestmark = pytest.mark.skipif(function_address("mj_step") is None, reason="no library of MuJoCo is found")


class Changed:
    """Something of MuJoCo in a version that has changed some of its arrays, or renamed them (None)."""

    def __init__(self, real, **changed):
        self._real, self._changed = real, changed

    def __getattr__(self, name):
        if name not in self._changed:
            return getattr(self._real, name)
        if self._changed[name] is None:
            raise AttributeError(name)
        return self._changed[name]


@pytest.fixture
def simulation():
    return build_simulation(ROBOT, NOMINAL, touches=False)


@pytest.fixture(autouse=True)
def tried_anew():
    """Has the stages tried again before the test, and after it."""
    stages_make_a_step.cache_clear()
    yield
    stages_make_a_step.cache_clear()


def test_of_a_robot_that_touches_nothing_all_parts_are_found(simulation):
    parts = find_friction_parts(simulation.model, simulation.data, STEP)
    assert parts is not None
    assert len(parts.matrix) == len(parts.lower) ** 2


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        ("model", "M_rowadr", None),
        ("model", "M_colind", np.zeros(3)),
        ("data", "qLD", np.zeros((22, 22))),
        ("data", "qLDiagInv", None),
        ("data", "efc_AR", np.zeros((22, 22))),
        ("data", "efc_R", None),
    ],
)
def test_arrays_that_are_laid_out_otherwise_keep_steps_whole(simulation, monkeypatch, where, name, value):
    model, data = simulation.model, simulation.data
    mujoco.mj_fwdPosition(model, data)
    monkeypatch.setattr(mujoco, "mj_fwdPosition", lambda *_: None)  # which takes nothing but its own
    changed = Changed(getattr(simulation, where), **{name: value})
    given = (changed, data) if where == "model" else (model, changed)
    assert find_friction_parts(*given, STEP) is None


def test_where_somebody_controls_what_mujoco_steps_steps_stay_whole(simulation):
    mujoco.set_mjcb_control(lambda model, data: None)
    try:
        assert find_friction_parts(simulation.model, simulation.data, STEP) is None
    finally:
        mujoco.set_mjcb_control(None)
    assert find_friction_parts(simulation.model, simulation.data, STEP) is not None


def test_a_stage_that_the_library_does_not_have_keeps_steps_whole(simulation, monkeypatch):
    monkeypatch.setattr(friction_step, "AFTER", (*AFTER, "mj_stride"))
    assert find_friction_parts(simulation.model, simulation.data, STEP) is None


def test_a_stage_that_has_another_name_in_python_keeps_steps_whole(simulation, monkeypatch):
    monkeypatch.delattr(mujoco, "mj_implicit")
    assert find_friction_parts(simulation.model, simulation.data, STEP) is None


def test_a_stage_that_wants_more_than_model_and_data_keeps_steps_whole(simulation, monkeypatch):
    implicit = mujoco.mj_implicit
    monkeypatch.setattr(mujoco, "mj_implicit", lambda model, data, skip: implicit(model, data))
    assert find_friction_parts(simulation.model, simulation.data, STEP) is None
