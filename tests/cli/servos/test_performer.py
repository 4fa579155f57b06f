"""Servos under `Performer` after a failed check in the twin."""

import pytest

from kinesic import Performer

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


def test_python_performer_does_not_move_servos_if_a_twin_check_fails(served, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.report.run.Performance.ok", False)
    run = Performer().perform(NOD, on="servos", ports={"body": served.port})
    assert run.servos is None
    assert served.energised == 0
