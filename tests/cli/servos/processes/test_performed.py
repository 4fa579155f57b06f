"""Nod on virtual servos, started by the command line and by Python."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from kinesic import Performer
from kinesic.body.robot import Robot
from kinesic.sim.log import read_log

from .conftest import Arms

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


def test_perform_on_servos_passes_checks_and_returns_the_arms_to_rest(kinesic, arms: Arms, tmp_path: Path):
    nod, out = tmp_path / "nod.bml", tmp_path / "report"
    nod.write_text(NOD, encoding="utf-8")
    options = ("--on", "servos,twin", "--port", f"body={arms.port}", "--no-film", "--out", out, "--force")
    ended = kinesic("perform", nod, *options)
    assert ended.code == 0, ended.out + ended.err
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    servos = report["servos"]
    assert arms.is_home
    assert (servos["ending"], servos["why"]) == ("performed", "")
    checks = {check["name"]: check for check in report["checks"]}
    assert checks["measured.performed"]["status"] == "pass"
    if servos["full_pace"] == 1.0:  # Errors are measured only at full pace, and a slow machine slows time.
        assert servos["rmse_deg"] < 5.0
        assert servos["per_joint"]["skullbase_tilt"] > 0.0
    assert any(event["text"].endswith("-> closed (done)") for event in servos["events"])
    log = read_log(out / "servos.npz", Robot.load())
    assert len(log.times) > 50
    assert (out / "events.jsonl").stat().st_size > 0
    assert re.search(r"^(all )?\d+ .*checks pass$", ended.out, re.MULTILINE)
    fitted = kinesic("twin", "fit", out / "servos.npz", "--free", "latency", "--json")
    assert fitted.code == 0, fitted.err
    fit = json.loads(fitted.out)
    assert {estimate["figure"] for estimate in fit["estimates"]} == {"latency"}
    assert fit["after_deg"] <= fit["before_deg"]
    assert f"servos: {report['learned']['text']}" in ended.out
    assert (out / "learned.toml").exists() == (report["learned"]["why"] == "")
    assert "On the robot" in (out / "report.html").read_text(encoding="utf-8")


def test_performance_on_servos_from_python_contains_the_results_of_twin_and_servos(arms: Arms, tmp_path: Path):
    performer = Performer()
    run = performer.perform(NOD, on="servos", ports={"body": arms.port})
    assert arms.is_home
    assert run.servos is not None
    assert run.servos.ending == "performed"
    assert "measured.performed" in {check.name for check in run.checks}
    assert repr(run).endswith("in the nominal twin and on servos>")
    np.testing.assert_array_equal(run.motion.angles, run.servos.interpolated_angles)
    run.report(tmp_path / "nod", film=False)
    data = json.loads((tmp_path / "nod" / "report.json").read_text(encoding="utf-8"))
    assert data["servos"]["ending"] == "performed"
    assert len(read_log(tmp_path / "nod" / "servos.npz", performer.robot).times) > 50
    run.report(tmp_path / "nod", film=False)  # replaces the earlier report
