"""A greeting's nod on the servos of a pseudo-terminal, through the supervisor's own process."""

import json
import re
from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.cli import perform
from kinesic.report.report import report
from kinesic.sim.log import read_log

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@pytest.fixture
def nod(tmp_path: Path) -> Path:
    path = tmp_path / "nod.bml"
    path.write_text(NOD, encoding="utf-8")
    return path


def test_servos_perform_what_the_twin_has(kinesic, served, nod: Path, tmp_path: Path):
    out = tmp_path / "report"
    options = ("--on", "servos,twin", "--port", f"body={served.port}", "--no-film", "--out", out, "--force")
    ended = kinesic("perform", nod, *options)
    assert ended.code == 0, ended.out + ended.err
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    told = report["servos"]
    assert served.energised == 0
    assert (told["ending"], told["why"]) == ("performed", "")
    checks = {check["name"]: check for check in report["checks"]}
    assert checks["measured.performed"]["status"] == "pass"
    if told["full_pace"] == 1.0:  # a machine that comes late slows time, and errors are measured at full pace
        assert told["rmse_deg"] < 5.0
    assert told["per_joint"]["skullbase_tilt"] > 0.0
    assert any(event["text"].endswith("-> closed (done)") for event in told["events"])
    log = read_log(out / "servos.npz", Robot.load())
    assert len(log.times) > 50
    assert (out / "events.jsonl").stat().st_size > 0
    assert re.search(r"^(all )?\d+ .*checks pass$", ended.out, re.MULTILINE)
    fitted = kinesic("twin", "fit", out / "servos.npz", "--free", "latency", "--json")
    assert fitted.code == 0, fitted.err
    found = json.loads(fitted.out)
    assert {e["figure"] for e in found["estimates"]} == {"latency"}
    assert found["after_deg"] <= found["before_deg"]
    assert f"servos: {report['learned']['text']}" in ended.out
    assert (out / "learned.toml").exists() == (report["learned"]["why"] == "")
    assert "On the robot" in (out / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--on", "legs"), "'legs' is not one of twin, servos"),
        (("--on", "servos"), "no port given; add --port body=PATH"),
        (("--on", "servos", "--port", "arm=/dev/null"), "no bus arm; known: body"),
        (("--on", "twin,servos", "--port", "body=/dev/nothing"), "/dev/nothing: no such port"),
    ],
)
def test_bad_input_is_one_line_and_nothing_moves(kinesic, nod: Path, options: tuple[str, ...], message: str):
    ended = kinesic("perform", nod, "--no-film", *options)
    assert ended.code == 2
    assert message in ended.err.splitlines()[-1]


def test_the_servos_rest_when_a_check_of_the_twin_fails(kinesic, served, nod: Path, monkeypatch):
    monkeypatch.setattr(perform, "report", lambda *given, **named: report(*given, **named) | {"ok": False})
    ended = kinesic("perform", nod, "--on", "servos", "--port", served.port, "--no-film")
    assert ended.code == 1
    assert "the servos did not move: a check of the twin failed" in ended.err
    assert served.energised == 0
