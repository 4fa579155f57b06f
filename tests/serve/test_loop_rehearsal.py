"""Preparations of the control loop before its first tick."""

import pytest

from kinesic.motion import spline_program

from .simulated import Simulation


def test_starting_the_loop_loads_the_solver_of_emergency_stops(simulation: Simulation, monkeypatch: pytest.MonkeyPatch):
    solved = []
    nearest_within_limits = spline_program.nearest_within_limits
    monkeypatch.setattr(
        spline_program, "nearest_within_limits", lambda *given: solved.append(given) or nearest_within_limits(*given)
    )
    loop = simulation.make()
    assert solved
    assert loop.stop_count == 0
    assert not loop.is_stopped
