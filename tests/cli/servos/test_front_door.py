"""The front door's way to servos: the same nod, on a pseudo-terminal, from Python."""

import json
from pathlib import Path

import numpy as np
import pytest

from kinesic import Performer
from kinesic.sim.log import read_log

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


def test_servos_perform_what_the_twin_has_and_the_run_tells_of_both(served, tmp_path: Path):
    performer = Performer()
    run = performer.perform(NOD, on="servos", ports={"body": served.port})
    assert served.energised == 0
    assert run.servos is not None
    assert run.servos.ending == "performed"
    assert "measured.performed" in {check.name for check in run.checks}
    assert repr(run).endswith("in the nominal twin and on servos>")
    np.testing.assert_array_equal(run.motion.angles, run.servos.followed)
    run.report(tmp_path / "nod", film=False)
    data = json.loads((tmp_path / "nod" / "report.json").read_text(encoding="utf-8"))
    assert data["servos"]["ending"] == "performed"
    assert len(read_log(tmp_path / "nod" / "servos.npz", performer.robot).times) > 50
    run.report(tmp_path / "nod", film=False)  # over the earlier one


def test_servos_stay_where_they_are_when_a_check_of_the_twin_fails(served, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.report.run.Performance.ok", False)
    run = Performer().perform(NOD, on="servos", ports={"body": served.port})
    assert run.servos is None
    assert served.energised == 0
