"""What the live loop does before its first tick."""

import pytest

from kinesic.motion import spline_program

from .simulated import Simulation


def test_the_first_stop_finds_its_solver_loaded(simulation: Simulation, monkeypatch: pytest.MonkeyPatch):
    solved = []
    found = spline_program.nearest_within_limits
    monkeypatch.setattr(spline_program, "nearest_within_limits", lambda *given: solved.append(given) or found(*given))
    loop = simulation.make()
    assert solved
    assert loop.stops == 0
    assert not loop.halted
