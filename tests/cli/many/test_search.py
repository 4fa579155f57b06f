import json
from dataclasses import replace
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError, locate_config
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.cli.many import search as search_verb
from kinesic.cli.many.search import SEARCH_JOURNAL_FILE, _prepare_folder, _print_result, _write_designs
from kinesic.cli.options import Output
from kinesic.studies.designs.search import BASE_DESIGN, Round, SearchResult
from kinesic.studies.designs.trial import BodyFigures, Trial
from kinesic.tasks.store import DESIGNS_FILE

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
VARY_OPTIONS = ("--vary", "l_elbow_flexion.servo=xm430_w210,xc430_w240", "--vary", "vl5_roll.reduction=2.5,10")
BODY = BodyFigures(price=100.0, mass=2.0, arm_length=0.5, torque=0.5, hinge="l_elbow_flexion", sectors=40)
NAMED = Path("found", "upper22_1.toml")


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
    base, light = Trial(BASE_DESIGN, body=BODY), Trial((("l_elbow.length", "0.2"),), body=replace(BODY, mass=1.0))
    _print_result(SearchResult((light, base), (), (), (Round(3, 2),)), [light])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "round 1: 2 designs, 3 documents"
    assert any("as it is (dominated)" in line and "2.00" in line and "better" not in line for line in lines)
    assert any("1.00" in line and "better in mass; worse in nothing" in line for line in lines)
    assert lines[-1] == "eliminated: 0 of 2 designs"


def test_output_folder_continues_an_interrupted_search_but_keeps_a_finished_one(tmp_path):
    folder = tmp_path / "found"
    assert _prepare_folder(Output(None, False, False)) is None
    assert _prepare_folder(Output(folder, False, False)) == folder
    (folder / SEARCH_JOURNAL_FILE).touch()
    assert _prepare_folder(Output(folder, False, False)) == folder
    assert (folder / SEARCH_JOURNAL_FILE).exists()
    (folder / DESIGNS_FILE).touch()
    with pytest.raises(ConfigError, match="contains a finished search"):
        _prepare_folder(Output(folder, False, False))
    assert _prepare_folder(Output(folder, True, False)) == folder
    assert list(folder.glob("*.json*")) == []


def test_search_writes_one_robot_per_pareto_optimal_design_if_requested(kinesic, tmp_path, monkeypatch):
    (tmp_path / "nod.bml").write_text(NOD)
    design = (("l_elbow_flexion.servo", "xc430_w240"),)
    trials = (Trial(design, body=BODY), Trial(BASE_DESIGN, body=replace(BODY, mass=3.0)))
    monkeypatch.setattr(search_verb, "search", lambda *_, **__: SearchResult(trials, (), (), (Round(1, 2),)))
    printed = kinesic("robots", "search", "upper22", "nod.bml", *VARY_OPTIONS[:2], "--jobs", "1")
    assert (printed.code, printed.out.splitlines()[-1]) == (0, "eliminated: 0 of 2 designs")
    ended = kinesic("robots", "search", "upper22", "nod.bml", *VARY_OPTIONS[:2], "--jobs", "1", "--out", "found")
    assert ended.out.splitlines()[-2:] == [
        f"{path.suffix[1:]}: {path}" for path in (NAMED, Path("found", DESIGNS_FILE))
    ]
    assert Robot.load(tmp_path / NAMED).name == "upper22_1"


def test_files_of_an_earlier_search_are_replaced(tmp_path):
    path = locate_config("robot", "upper22")
    for text in ("old", ""):
        (tmp_path / DESIGNS_FILE).write_text(text)
        result = SearchResult((Trial(BASE_DESIGN, body=BODY),), (), (), (Round(1, 1),))
        file = read_robot(path, RobotFile)
        assert _write_designs(result, result.finished, "upper22", path, file, tmp_path) == [tmp_path / DESIGNS_FILE]
        (row,) = json.loads((tmp_path / DESIGNS_FILE).read_text())["designs"]
        assert (row["state"], row["unbeaten"], row["sectors"]) == ("finished", True, 40)
