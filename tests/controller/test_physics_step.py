"""Steps of the compiled loop are those of MuJoCo, whole or in stages."""

import ctypes
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
import pytest

from kinesic.body.command import RATE
from kinesic.controller import closed_loop
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.sim.servo_factors import Factors
from kinesic.sim.stepping import friction_step
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.twin import Twin

pytestmark = pytest.mark.skipif(closed_loop.KERNEL != "compiled", reason="no compiled kernel")


@pytest.fixture
def free(calm):
    """Makes a twin that touches nothing, so that friction and stops are all that holds it."""
    return partial(Twin, calm.plan.setup.robot, start=calm.plan.trajectory.at(0.0).angles, touches=False)


@pytest.fixture
def swing(calm, free):
    """Drives all hinges of a twin beyond their stops and back, twice, and gives the angles of all steps."""
    low, high = free().physics[0].jnt_range.T
    times = np.arange(400) / RATE
    reach = np.sin(np.pi * times)[:, None] ** 3 * 1.3
    goals = np.where(reach > 0, reach * high, -reach * low)
    nothing = np.zeros_like(goals)

    def run(twin):
        lead = FeedForwardGoals(goals, nothing, nothing, nothing)
        for _ in perform_in_twins(calm.plan.trajectory, times, lambda part: lead, [twin], None, lambda share: None):
            pass
        return twin._log.kept().angles

    return run


def test_at_stops_and_away_from_them_steps_are_those_of_mujoco(free, swing, monkeypatch):
    fast = swing(free())
    monkeypatch.setattr(Twin, "friction_parts", lambda self: None)
    slow = swing(free())
    low, high = free().physics[0].jnt_range.T
    beyond = ((slow < low) | (slow > high)).any(axis=1)
    assert 0.05 < beyond.mean() < 0.95
    assert np.count_nonzero(np.diff(beyond)) >= 4, "to the stops and back, more than once"
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-9)


def test_where_only_friction_holds_hinges_only_stages_of_a_step_are_done(free, swing, monkeypatch):
    found = Twin.friction_parts
    monkeypatch.setattr(Twin, "friction_parts", lambda self: replace(found(self), after=found(self).after[:-1]))
    first, *later = swing(free())[1:60]
    assert all(np.array_equal(first, each) for each in later), "without their last stage nothing moves"


@pytest.mark.parametrize(
    "held",
    [{"touches": True}, {"factors": Factors(play=0.004)}, {"step": 0.02}],
    ids=["touches", "play", "steps that soften the friction"],
)
def test_where_more_than_friction_counts_steps_stay_whole(free, held):
    assert free().friction_parts() is not None
    assert free(**held).friction_parts() is None


def test_a_hinge_without_friction_keeps_steps_whole(free):
    twin = free()
    twin.physics[0].dof_frictionloss[3] = 0.0
    assert twin.friction_parts() is None


def test_a_matrix_that_is_not_mujocos_keeps_steps_whole(free, swing, monkeypatch):
    found = Twin.friction_parts
    parts = []

    def misread(self):
        right = found(self)
        parts.append(replace(right, begins=right.begins + 1))
        return parts[-1]

    monkeypatch.setattr(Twin, "friction_parts", misread)
    misled = swing(free())
    monkeypatch.setattr(Twin, "friction_parts", lambda self: None)
    assert np.array_equal(misled, swing(free()))
    assert parts


def test_stages_that_no_longer_make_a_step_keep_steps_whole(free, monkeypatch):
    assert friction_step.stages_make_a_step()
    monkeypatch.setattr(friction_step, "AFTER", friction_step.AFTER[1:])
    friction_step.stages_make_a_step.cache_clear()
    assert free().friction_parts() is None
    monkeypatch.undo()
    friction_step.stages_make_a_step.cache_clear()
    assert free().friction_parts() is not None


def test_mujocos_clock_stands_in_the_loop_and_goes_on_after_it(free, swing):
    twin = free()
    swing(twin)
    timer = twin.physics[1].timer[mujoco.mjtTimer.mjTIMER_STEP]
    assert timer.number > 0
    assert timer.duration == 0.0
    mujoco.mj_step(*twin.physics)
    assert timer.duration > 0.0


def test_whoever_reads_mujocos_clock_meanwhile_reads_when_the_step_began(free, swing):
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
