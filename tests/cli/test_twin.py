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
