"""Preparations of the control loop before its first tick."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.motion import spline_program
from kinesic.motion.trajectory import Trajectory
from kinesic.serve import loop as loop_module

from .simulated import Simulation


def test_new_control_loop_computes_a_trial_stop_and_is_not_stopped(
    simulation: Simulation, monkeypatch: pytest.MonkeyPatch
):
    solved = []
    nearest_within_limits = spline_program.nearest_within_limits
    monkeypatch.setattr(
        spline_program, "nearest_within_limits", lambda *given: solved.append(given) or nearest_within_limits(*given)
    )
    loop = simulation.make()
    assert solved
    assert loop.stop_count == 0
    assert not loop.is_stopped


@pytest.mark.parametrize("edge", ["lower", "upper"])
def test_trial_stop_begins_within_the_joint_limits(simulation: Simulation, monkeypatch: pytest.MonkeyPatch, edge: str):
    """Joints of imported robots may rest at a limit."""
    stopped: list[Trajectory] = []
    monkeypatch.setattr(loop_module, "stop", lambda motion, *_: stopped.append(motion))
    setup = simulation.setup
    limits = replace(setup.limits, **{edge: setup.robot.skeleton.rest})
    loop_module._warm_up_stop(SimpleNamespace(limits=limits, robot=setup.robot))
    (motion,) = stopped
    assert np.ptp(motion.controls, axis=0).min() > 0.0
    assert (motion.controls >= limits.lower - 1e-9).all()
    assert (motion.controls <= limits.upper + 1e-9).all()
