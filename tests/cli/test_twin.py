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
    """The neck of a robot with weak neck servos nods."""
    twin = Twin(ROBOT, factors=Factors(servos={"xc430_w240": DriveFactors(stall=0.8)}))
    still, tilt = np.zeros(22), ROBOT.skeleton.joint("skullbase_tilt")
    for k in range(41):
        goals = ROBOT.skeleton.rest.copy()
        goals[tilt] = 0.3 * np.sin(0.1 * k)
        twin.write(Command(0.01 * k, goals, still, still, goals))
    write_log(twin.measurements(), ROBOT, tmp_path / "measured.npz")
    return tmp_path / "measured.npz"


def test_a_log_is_fitted_and_the_factors_are_read_by_perform(kinesic, log, tmp_path):
    ended = kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "factors: mine.toml"
    found = Factors.read(tmp_path / "mine.toml")
    assert found.servos["xc430_w240"].stall == pytest.approx(0.8, rel=0.05)
    data = json.loads(kinesic("perform", "-", "--twin", "mine.toml", "--no-film", "--json", stdin=NOD).out)
    assert data["ok"]
    assert kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml").code == 2  # it is there already
    assert kinesic("twin", "fit", log, "--free", "stall", "--out", "mine.toml", "--force").code == 0


def test_what_is_not_told_is_said_in_json_and_in_a_comment(kinesic, log, tmp_path):
    ended = kinesic("twin", "fit", log, "--free", "armature", "--out", "mine.toml", "--json")
    rows = {row["servo"]: row for row in json.loads(ended.out)["estimates"]}
    assert rows["xm540_w270"]["why"] == "the log hardly depends on it"
    assert "# armature: the log hardly depends on it" in (tmp_path / "mine.toml").read_text()


def test_perform_writes_a_log_that_fit_reads(kinesic, tmp_path):
    assert "measured: there/measured.npz" in kinesic("perform", "-", "--out", "there", "--no-film", stdin=NOD).out
    ended = kinesic("twin", "fit", tmp_path / "there" / "measured.npz", "--free", "latency", "--json")
    assert json.loads(ended.out)["after_deg"] < 0.05


def test_stall_and_mass_together_are_refused_in_one_line(kinesic, log):
    ended = kinesic("twin", "fit", log, "--free", "stall", "--free", "mass")
    assert ended.code == 2
    assert "angles show only their ratio" in ended.err
    assert kinesic("twin", "fit", "none.npz").code == 2


NODS = (
    b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    b'<head id="h" lexeme="NOD" repetition="2" start="0.2" end="1.6"/></bml>'
)


@pytest.fixture
def perform(kinesic, tmp_path):
    """Performs nods, and returns what the report says."""

    def run(*options: str) -> dict[str, object]:
        ended = kinesic("perform", "-", "--no-film", "--json", "--force", "--out", "there", *options, stdin=NODS)
        assert ended.code == 0, ended.err
        return json.loads(ended.out) | {"said": ended.err}

    return run


def test_what_a_twin_is_fitted_to_is_performed_led_and_reported(kinesic, perform, tmp_path):
    """A log of soft servos, its fit, and a performance in the twin of that robot, with what is known and without."""
    (tmp_path / "soft.toml").write_text("gain = 0.6\n")
    unknown = perform("--twin", "soft.toml", "--learn", "none")
    assert unknown["lead"]["text"] == "as data sheets say"
    fit = ("twin", "fit", tmp_path / "there" / "measured.npz", "--free", "gain", "--out", "mine.toml")
    assert kinesic(*fit).code == 0
    known = perform("--twin", "mine.toml")
    assert known["lead"]["gain"]["xc430_w240"] == pytest.approx(0.6, rel=0.05)
    assert known["learned"] is None
    assert known["tracking"]["rmse_deg"] < 0.6 * unknown["tracking"]["rmse_deg"]
    page = (tmp_path / "there" / "report.html").read_text()
    assert "Goals lead for servos with P gain x" in page


def test_what_one_performance_learned_leads_the_next(perform, tmp_path):
    (tmp_path / "soft.toml").write_text("gain = 0.6\nlatency = 0.015\n")
    first, second = (perform("--twin", "soft.toml", "--learn", "robot.toml") for _ in range(2))
    assert first["lead"]["text"] == "as data sheets say"
    assert first["learned"]["gain"]["xc430_w240"] == pytest.approx(0.6, rel=0.05)
    assert first["learned"]["latency_s"] == pytest.approx(0.015, abs=0.001)
    assert "servos: learned: P gain x" in first["said"]
    assert "--learn robot.toml" in first["said"]
    assert second["lead"]["gain"] == first["learned"]["gain"]
    assert second["tracking"]["rmse_deg"] < 0.7 * first["tracking"]["rmse_deg"]
    assert Factors.read(tmp_path / "robot.toml").latency == pytest.approx(0.015, abs=0.001)


def test_the_twin_of_a_robot_is_as_it_was_learned_unless_another_is_named(perform, tmp_path):
    (tmp_path / "robot.toml").write_text("gain = 0.6\n")
    own = perform("--learn", "robot.toml")
    assert list(own["twins"]) == ["own"]
    assert own["tracking"]["rmse_deg"] < 0.1


def test_a_memory_that_cannot_be_used_is_refused_before_anything_moves(kinesic, tmp_path):
    (tmp_path / "robot.toml").write_text("gain = 0\n")
    for options, message in (
        (("--learn", "robot.toml"), "factor gain is 0.0, must be above 0"),
        (("--learn", "nowhere/robot.toml"), "nowhere"),
        (("--learn", "robot.toml", "--robot", "upper22,upper36"), "is of one robot"),
    ):
        ended = kinesic("perform", "a.bml", "--no-film", *options)
        assert ended.code == 2
        assert message in ended.err
