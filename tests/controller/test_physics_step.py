"""Compare physics steps of the compiled loop with MuJoCo."""

import ctypes
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
import pytest

from kinesic.body.command import COMMAND_RATE
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.sim.servo_factors import Factors
from kinesic.sim.stepping import friction_step
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.twin import Twin


@pytest.fixture
def free(calm):
    """Return a factory of twins with only friction and joint stops."""
    return partial(Twin, calm.plan.setup.robot, start=calm.plan.trajectory.at(0.0).angles, touches=False)


@pytest.fixture
def swing(calm, free):
    """Drive all hinges beyond their stops and back, twice, and return all angles."""
    low, high = free().physics[0].jnt_range.T
    times = np.arange(400) / COMMAND_RATE
    reach = np.sin(np.pi * times)[:, None] ** 3 * 1.3
    goals = np.where(reach > 0, reach * high, -reach * low)
    nothing = np.zeros_like(goals)

    def run(twin):
        lead = FeedForwardSetpoints(goals, nothing, nothing, nothing)
        for _ in perform_in_twins(calm.plan.trajectory, times, lambda part: lead, [twin], None, lambda share: None):
            pass
        return twin._log.steps().angles

    return run


def test_physics_steps_equal_mujoco_at_and_off_joint_stops(free, swing, monkeypatch):
    fast = swing(free())
    monkeypatch.setattr(Twin, "friction_parts", lambda self: None)
    slow = swing(free())
    low, high = free().physics[0].jnt_range.T
    beyond = ((slow < low) | (slow > high)).any(axis=1)
    assert 0.05 < beyond.mean() < 0.95
    assert np.count_nonzero(np.diff(beyond)) >= 4, "to the stops and back, more than once"
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-9)


def test_model_with_only_friction_uses_partial_mujoco_steps(free, swing, monkeypatch):
    friction_parts = Twin.friction_parts
    monkeypatch.setattr(
        Twin, "friction_parts", lambda self: replace(friction_parts(self), after=friction_parts(self).after[:-1])
    )
    first, *later = swing(free())[1:60]
    assert all(np.array_equal(first, item) for item in later), "without their last stage nothing moves"


@pytest.mark.parametrize(
    "held",
    [{"touches": True}, {"factors": Factors(play=0.004)}, {"step": 0.02}],
    ids=["touches", "play", "steps that soften the friction"],
)
def test_contacts_backlash_and_long_steps_disable_the_partial_mujoco_steps(free, held):
    assert free().friction_parts() is not None
    assert free(**held).friction_parts() is None


def test_joint_without_friction_disables_the_partial_mujoco_steps(free):
    twin = free()
    twin.physics[0].dof_frictionloss[3] = 0.0
    assert twin.friction_parts() is None


def test_unexpected_mujoco_matrix_layout_disables_the_partial_mujoco_steps(free, swing, monkeypatch):
    friction_parts = Twin.friction_parts
    parts = []

    def misread(self):
        right = friction_parts(self)
        parts.append(replace(right, begins=right.begins + 1))
        return parts[-1]

    monkeypatch.setattr(Twin, "friction_parts", misread)
    misled = swing(free())
    monkeypatch.setattr(Twin, "friction_parts", lambda self: None)
    assert np.array_equal(misled, swing(free()))
    assert parts


def test_unexpected_mujoco_step_stages_disable_the_partial_mujoco_steps(free, monkeypatch):
    assert friction_step.stages_make_a_step()
    monkeypatch.setattr(friction_step, "STAGES_AFTER_CONSTRAINTS", friction_step.STAGES_AFTER_CONSTRAINTS[1:])
    friction_step.stages_make_a_step.cache_clear()
    assert free().friction_parts() is None
    monkeypatch.undo()
    friction_step.stages_make_a_step.cache_clear()
    assert free().friction_parts() is not None


def test_mujoco_step_timer_measures_no_time_in_the_compiled_loop_but_does_afterwards(free, swing):
    twin = free()
    swing(twin)
    timer = twin.physics[1].timer[mujoco.mjtTimer.mjTIMER_STEP]
    assert timer.number > 0
    assert timer.duration == 0.0
    mujoco.mj_step(*twin.physics)
    assert timer.duration > 0.0


def test_mujoco_clock_advances_between_calls_of_a_passive_callback(free, swing):
    clock = ctypes.c_void_p.from_address(function_address("mjcb_time"))
    shown = []

    def read(*_):
        shown.append(ctypes.CFUNCTYPE(ctypes.c_double)(clock.value)())

    read()
    mujoco.set_mjcb_passive(read)
    try:
        swing(free())
    finally:
        mujoco.set_mjcb_passive(None)
    read()
    assert shown == sorted(shown)
    assert len(set(shown)) > 100
