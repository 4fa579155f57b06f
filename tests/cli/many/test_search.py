import json
from dataclasses import replace

import pytest

from kinesic.body.robot import Robot
from kinesic.cli.many.search import _print_result
from kinesic.studies.designs.search import BASE_DESIGN, Round, SearchResult
from kinesic.studies.designs.trial import BodyFigures, Trial

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
VARY_OPTIONS = ("--vary", "l_elbow_flexion.servo=xm430_w210,xc430_w240", "--vary", "vl5_roll.reduction=2.5,10")


@pytest.mark.realtime
def test_search_prints_and_writes_pareto_optimal_designs(kinesic, tmp_path):
    (tmp_path / "nod.bml").write_text(NOD)
    ended = kinesic("robots", "search", "upper22", "nod.bml", *VARY_OPTIONS, "--out", "found", "--jobs", "1")
    assert ended.code == 0
    assert "as it is (dominated)" in ended.out
    assert "mass, price;" in ended.out
    assert "turns its servo by 400 degrees" in ended.out
    rows = json.loads((tmp_path / "found" / "designs.json").read_text())["designs"]
    (best,) = [row for row in rows if row["unbeaten"]]
    assert best["changes"] == {"l_elbow_flexion.servo": "xc430_w240"}
    robot = Robot.load(tmp_path / "found" / "upper22_1.toml")
    assert robot.name == "upper22_1"
    assert robot.drives[robot.skeleton.names.index("r_elbow_flexion")].servo.name == "xc430_w240"
    again = kinesic("robots", "search", "upper22", "nod.bml", *VARY_OPTIONS, "--out", "found")
    assert "contains a finished search" in again.err


@pytest.mark.realtime
def test_robot_name_with_a_path_stays_inside_the_output_folder(kinesic, tmp_path):
    (tmp_path / "mine_1.toml").write_text("dear")
    (tmp_path / "nod.bml").write_text(NOD)
    (tmp_path / "robot.toml").write_text('[robot]\nname = "../mine"\nextends = "upper22"\n')
    ended = kinesic("robots", "search", "robot.toml", "nod.bml", *VARY_OPTIONS[:2], "--out", "found", "--jobs", "1")
    assert ended.code == 0, ended.err
    assert (tmp_path / "mine_1.toml").read_text() == "dear"
    assert sorted(path.name for path in (tmp_path / "found").glob("*.toml")) == ["mine_1.toml", "robot.toml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nod.bml", "--vary", "l_elbow.len=1"), "no len; did you mean length"),
        (("nod.bml", "--vary", "l_elbw.length=1"), "no body l_elbw; did you mean l_elbow"),
        ((".", "--vary", "l_elbow.length=0.2"), ".: no documents"),
    ],
)
def test_invalid_input_of_search_is_reported_in_one_line(kinesic, tmp_path, arguments, message):
    if arguments[0] != ".":
        (tmp_path / "nod.bml").write_text(NOD)
    ended = kinesic("robots", "search", "upper22", *arguments)
    assert ended.code == 2
    assert message in ended.err
    assert len(ended.err.splitlines()) == 1


def test_printed_table_compares_each_pareto_optimal_design_with_the_base(capsys):
    body = BodyFigures(price=100.0, mass=2.0, arm_length=0.5, torque=0.5, hinge="l_elbow_flexion", sectors=40)
    base, light = Trial(BASE_DESIGN, body=body), Trial((("l_elbow.length", "0.2"),), body=replace(body, mass=1.0))
    _print_result(SearchResult((light, base), (), (), (Round(3, 2),)), [light])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "round 1: 2 designs, 3 documents"
    assert any("as it is (dominated)" in line and "2.00" in line and "better" not in line for line in lines)
    assert any("1.00" in line and "better in mass; worse in nothing" in line for line in lines)
    assert lines[-1] == "eliminated: 0 of 2 designs"
