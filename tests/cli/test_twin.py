import json

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.log import write_log
from kinesic.sim.servo_factors import DriveFactors, Factors
from kinesic.sim.twin import Twin

ROBOT = Robot.load()
NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


@pytest.fixture
def log(tmp_path):
    """Log of a nod by a robot with weak neck servos."""
    twin = Twin(ROBOT, factors=Factors(servos={"xc430_w240": DriveFactors(stall=0.8)}))
    still, tilt = np.zeros(22), ROBOT.skeleton.joint("skullbase_tilt")
    for k in range(41):
        goals = ROBOT.skeleton.rest.copy()
        goals[tilt] = 0.3 * np.sin(0.1 * k)
        twin.write(Command(0.01 * k, goals, still, still, goals))
    write_log(twin.measurements(), ROBOT, tmp_path / "measured.npz")
    return tmp_path / "measured.npz"


def test_perform_uses_the_servo_factors_fitted_to_a_log(kinesic, log, tmp_path):
    ended = kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "factors: mine.toml"
    factors = Factors.read(tmp_path / "mine.toml")
    assert factors.servos["xc430_w240"].stall == pytest.approx(0.8, rel=0.05)
    data = json.loads(kinesic("perform", "-", "--twin", "mine.toml", "--no-film", "--json", stdin=NOD).out)
    assert data["ok"]
    assert kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml").code == 2  # The file exists already.
    assert kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml", "--force").code == 0


def test_twin_fit_gives_the_reason_for_an_undetermined_servo_factor(kinesic, log, tmp_path):
    ended = kinesic("twin", "fit", log, "--free", "armature", "--out", "mine.toml", "--json")
    rows = {row["servo"]: row for row in json.loads(ended.out)["estimates"]}
    assert rows["xm540_w270"]["why"] == "the log hardly depends on it"
    assert "# armature: the log hardly depends on it" in (tmp_path / "mine.toml").read_text()


def test_twin_fit_reads_the_log_written_by_perform(kinesic, tmp_path):
    assert "measured: there/measured.npz" in kinesic("perform", "-", "--out", "there", "--no-film", stdin=NOD).out
    ended = kinesic("twin", "fit", tmp_path / "there" / "measured.npz", "--free", "latency", "--json")
    assert json.loads(ended.out)["after_deg"] < 0.05


def test_twin_fit_refuses_free_stall_torque_and_mass_together(kinesic, log):
    ended = kinesic("twin", "fit", log, "--free", "stall", "--free", "mass")
    assert ended.code == 2
    assert "angles show only their ratio" in ended.err


def test_twin_fit_names_a_missing_log(kinesic):
    ended = kinesic("twin", "fit", "none.npz")
    assert (ended.code, ended.err) == (2, "kinesic: none.npz: No such file or directory\n")


NODS = (
    b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    b'<head id="h" lexeme="NOD" repetition="2" start="0.1" end="1.1"/></bml>'
)


@pytest.fixture
def perform(kinesic, tmp_path):
    """Return a function that performs nods and returns the report."""

    def run(*options: str) -> dict[str, object]:
        ended = kinesic("perform", "-", "--no-film", "--json", "--force", "--out", "there", *options, stdin=NODS)
        assert ended.code == 0, ended.err
        return json.loads(ended.out) | {"said": ended.err}

    return run


def test_fitted_servo_factors_improve_tracking_and_are_reported(kinesic, perform, tmp_path):
    """Compare performances with soft servos before and after a fit."""
    (tmp_path / "soft.toml").write_text("gain = 0.6\n")
    unfitted = perform("--twin", "soft.toml", "--learn", "none")
    assert unfitted["lead"]["text"] == "as in the data sheets"
    fit = ("twin", "fit", tmp_path / "there" / "measured.npz", "--free", "gain", "--out", "mine.toml")
    assert kinesic(*fit).code == 0
    fitted = perform("--twin", "mine.toml")
    assert fitted["lead"]["gain"]["xc430_w240"] == pytest.approx(0.6, rel=0.05)
    assert fitted["learned"] is None
    assert fitted["tracking"]["rmse_deg"] < 0.6 * unfitted["tracking"]["rmse_deg"]
    page = (tmp_path / "there" / "report.html").read_text()
    assert "Servo parameters assumed for the setpoints: P gain x" in page


def test_learned_servo_factors_improve_the_next_performance(perform, tmp_path):
    (tmp_path / "soft.toml").write_text("gain = 0.6\nlatency = 0.015\n")
    first, second = (perform("--twin", "soft.toml", "--learn", "robot.toml") for _ in range(2))
    assert first["lead"]["text"] == "as in the data sheets"
    assert first["learned"]["gain"]["xc430_w240"] == pytest.approx(0.6, rel=0.05)
    assert first["learned"]["latency_s"] == pytest.approx(0.015, abs=0.001)
    assert "servos: learned: P gain x" in first["said"]
    assert "--learn robot.toml" in first["said"]
    assert second["lead"]["gain"] == first["learned"]["gain"]
    assert second["tracking"]["rmse_deg"] < 0.7 * first["tracking"]["rmse_deg"]
    assert Factors.read(tmp_path / "robot.toml").latency == pytest.approx(0.015, abs=0.001)


def test_twin_uses_the_learned_servo_factors_by_default(perform, tmp_path):
    (tmp_path / "robot.toml").write_text("gain = 0.6\n")
    report = perform("--learn", "robot.toml")
    unlearned = perform("--twin", "robot.toml", "--learn", "none")
    assert list(report["twins"]) == ["own"]
    assert report["tracking"]["rmse_deg"] < 0.4 * unlearned["tracking"]["rmse_deg"]


def test_invalid_learned_file_is_refused_before_the_performance(kinesic, tmp_path):
    (tmp_path / "robot.toml").write_text("gain = 0\n")
    for options, message in (
        (("--learn", "robot.toml"), "factor gain is 0.0, must be above 0"),
        (("--learn", "nowhere/robot.toml"), "nowhere"),
        (("--learn", "robot.toml", "--robot", "upper22,upper36"), "belong to one robot"),
    ):
        ended = kinesic("perform", "a.bml", "--no-film", *options)
        assert ended.code == 2
        assert message in ended.err
