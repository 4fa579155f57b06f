"""Fallback to whole MuJoCo steps for MuJoCo versions with unknown stages."""

import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL_FACTORS
from kinesic.sim.stepping import friction_step
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.stepping.friction_step import STAGES_AFTER_CONSTRAINTS, find_friction_parts, stages_make_a_step
from kinesic.sim.stepping.simulation import build_simulation
from kinesic.sim.twin import MAX_PHYSICS_STEP

ROBOT = Robot.load()

pytestmark = pytest.mark.skipif(function_address("mj_step") is None, reason="no library of MuJoCo is found")


class ChangedObject:
    """MuJoCo object of another version with changed or missing (None) arrays."""

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
    return build_simulation(ROBOT, NOMINAL_FACTORS, touches=False)


@pytest.fixture(autouse=True)
def cleared_stage_cache():
    """Clear the cached test of stages before and after a test."""
    stages_make_a_step.cache_clear()
    yield
    stages_make_a_step.cache_clear()


def test_friction_step_is_available_for_a_robot_without_contacts(simulation):
    parts = find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP)
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
def test_unexpected_array_layout_disables_the_friction_step(simulation, monkeypatch, where, name, value):
    model, data = simulation.model, simulation.data
    mujoco.mj_fwdPosition(model, data)
    monkeypatch.setattr(mujoco, "mj_fwdPosition", lambda *_: None)  # the real function rejects other objects
    changed = ChangedObject(getattr(simulation, where), **{name: value})
    given = (changed, data) if where == "model" else (model, changed)
    assert find_friction_parts(*given, MAX_PHYSICS_STEP) is None


def test_friction_step_is_disabled_if_a_mujoco_control_callback_is_set(simulation):
    mujoco.set_mjcb_control(lambda model, data: None)
    try:
        assert find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP) is None
    finally:
        mujoco.set_mjcb_control(None)
    assert find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP) is not None


def test_friction_step_is_disabled_if_the_mujoco_library_lacks_a_step_function(simulation, monkeypatch):
    monkeypatch.setattr(friction_step, "STAGES_AFTER_CONSTRAINTS", (*STAGES_AFTER_CONSTRAINTS, "mj_stride"))
    assert find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP) is None


def test_friction_step_is_disabled_if_mujoco_lacks_a_python_function_of_the_step(simulation, monkeypatch):
    monkeypatch.delattr(mujoco, "mj_implicit")
    assert find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP) is None


def test_friction_step_is_disabled_if_a_mujoco_step_function_has_another_signature(simulation, monkeypatch):
    implicit = mujoco.mj_implicit
    monkeypatch.setattr(mujoco, "mj_implicit", lambda model, data, skip: implicit(model, data))
    assert find_friction_parts(simulation.model, simulation.data, MAX_PHYSICS_STEP) is None


def test_joint_limits_of_the_friction_step_have_the_margin_of_the_model(simulation):
    model = simulation.model
    simulation.data.qpos[:] = model.jnt_range.mean(axis=1)  # so that no limit is active
    model.jnt_margin[:] = 1e-4
    model.jnt_limited[3] = 0
    parts = find_friction_parts(model, simulation.data, MAX_PHYSICS_STEP)
    assert parts is not None
    lower, upper = model.jnt_range[:, 0] + 1e-4, model.jnt_range[:, 1] - 1e-4
    lower[3], upper[3] = -np.inf, np.inf
    np.testing.assert_allclose(parts.lower, lower)
    np.testing.assert_allclose(parts.upper, upper)
