import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError, locate_config
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.cli.many import search as search_verb
from kinesic.cli.many.search import (
    SEARCH_JOURNAL_FILE,
    _compare,
    _prepare_folder,
    _print_result,
    _to_json,
    _write_designs,
    search_designs,
)
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output
from kinesic.studies.designs.search import BASE_DESIGN, Round, SearchResult
from kinesic.studies.designs.trial import BodyFigures, DocumentFigures, Trial
from kinesic.studies.designs.variant import Design
from kinesic.tasks.journal import Journal
from kinesic.tasks.store import DESIGNS_FILE

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
VARY_OPTIONS = ("--vary", "l_elbow_flexion.servo=xm430_w210,xc430_w240", "--vary", "vl5_roll.reduction=2.5,10")
LIGHT_DESIGN: Design = (("l_elbow.length", "0.2"),)
BODY_FIGURES = BodyFigures(price=100.0, mass=2.0, arm_length=0.5, torque=0.5, hinge="l_elbow_flexion", sectors=40)
DESIGN_PATH = Path("found", "upper22_1.toml")


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
def test_design_search_writes_only_into_the_output_folder_if_the_robot_name_contains_a_path(kinesic, tmp_path):
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


def test_printed_search_table_compares_each_pareto_optimal_design_with_the_base_robot(capsys):
    documents = (DocumentFigures("nod.bml", 1, 0.5, 0.75, ("limits.speed",)),)
    base = Trial(BASE_DESIGN, body=BODY_FIGURES, documents=documents)
    light = Trial(LIGHT_DESIGN, body=replace(BODY_FIGURES, mass=1.0), documents=documents)
    mixed = Trial(
        (("l_elbow.length", "0.3"), ("vl5_roll.reduction", "2")),
        body=replace(BODY_FIGURES, price=None, arm_length=0.6, torque=0.49),
        documents=documents,
    )
    rejected = Trial((("l_elbow.length", "9"),), out="too long [m]")
    _print_result(
        SearchResult((light, base, mixed), (Trial(LIGHT_DESIGN),), (rejected,), (Round(3, 2), Round(9, 1))),
        [light, mixed],
    )
    rounds, heading, (heads, units, *rows) = (lines := capsys.readouterr().out.splitlines())[:2], lines[2], lines[3:]
    assert rounds == ["round 1: 2 designs, 3 documents", "round 2: 1 designs, 9 documents"]
    assert heading.rstrip() == "Pareto-optimal designs"
    assert heads.split() == ["lateness", "violations", "torque", "mass", "price", "sectors", "arm", "worst"]
    assert units.split() == ["design", "ms", "of", "stall", "kg", "US$", "of", "105", "m", "ms", "compared"]
    assert [" ".join(row.split()) for row in rows] == [
        "as it is (dominated) 500 1 0.50 2.00 100 40 0.500 750",
        "l_elbow.length 0.2 500 1 0.50 1.00 100 40 0.500 750 better in mass; worse in nothing",
        "l_elbow.length 0.3 500 1 0.49 2.00 ? 40 0.600 750 better in torque, arm; worse in price",
        "vl5_roll.reduction 2",
        "rejected: l_elbow.length = 9: too long [m]",
        "eliminated: 1 of 3 designs",
    ]


@pytest.mark.parametrize(
    ("steps", "text"),
    [
        ([0, 0, 0, 0, 0, 0, 0], "equal"),
        ([-1, 0, 0, 0, -3, 0, 0], "better in lateness, price; worse in nothing"),
        ([0, 1, 0, 0, 0, 2, 0], "better in nothing; worse in violations, sectors"),
        ([-1, 0, 1, 0, 0, 0, 0], "better in lateness; worse in torque"),
    ],
)
def test_design_comparison_names_better_and_worse_criteria(steps, text):
    assert _compare(np.array(steps, float)) == text


def test_search_json_lists_changes_and_metrics_of_each_design():
    documents = (DocumentFigures("nod.bml", 2, 0.5, 0.75, ("limits.speed",)),)
    light = Trial(LIGHT_DESIGN, body=replace(BODY_FIGURES, price=None), documents=documents)
    rejected = Trial((("a", "1"), ("b", "2")), out="too long")
    found = _to_json(
        SearchResult((light,), (Trial(BASE_DESIGN, body=BODY_FIGURES),), (rejected,), (Round(3, 2),)), [light]
    )
    first, second, third = found["designs"]
    assert found["rounds"] == [{"documents": 3, "designs": 2}]
    assert first == {
        "design": "l_elbow.length = 0.2",
        "changes": {"l_elbow.length": "0.2"},
        "state": "finished",
        "why": "",
        "unbeaten": True,
        "documents": 1,
        "worst_stroke_ms": 750.0,
        "lateness": 250.0,
        "violations": 1,
        "torque": 0.5,
        "mass": 2.0,
        "price": None,
        "sectors": 40,
        "arm": 0.5,
        "performed": [{"file": "nod.bml", "strokes": 2, "late": 0.5, "worst": 0.75, "violations": ["limits.speed"]}],
    }
    assert (second["design"], second["state"], second["unbeaten"], second["price"]) == ("as it is", "left", False, 100)
    assert (third["design"], third["state"], third["why"]) == ("a = 1, b = 2", "out", "too long")
    assert "mass" not in third


def test_search_reuses_the_folder_of_an_interrupted_search_but_needs_force_for_a_finished_one(tmp_path):
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


@pytest.fixture
def searches(tmp_path, monkeypatch) -> list[dict[str, object]]:
    """List the arguments of each search, which returns three fixed designs."""
    asked: list[dict[str, object]] = []
    design = (("l_elbow_flexion.servo", "xc430_w240"),)
    cheap = (("vl5_roll.reduction", "2.5"),)
    trials = (
        Trial(design, body=BODY_FIGURES),
        Trial(cheap, body=replace(BODY_FIGURES, price=50.0, mass=3.0)),
        Trial(BASE_DESIGN, body=replace(BODY_FIGURES, mass=3.0)),
    )

    def search(
        robot: str,
        designs: list[Design],
        contents: list[tuple[str, bytes]],
        *,
        journal: Journal[Trial] | None,
        **options: object,
    ) -> SearchResult:
        asked.append({"robot": robot, "designs": designs, "contents": contents, **options})
        if journal is not None:
            journal.append("done", trials[0])
        return SearchResult(trials, (), (), (Round(1, 2),))

    (tmp_path / "nod.bml").write_text(NOD)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(search_verb, "search", search)
    monkeypatch.setattr(search_verb, "fingerprint_inputs", lambda planning: f"inputs of {planning.robot}")
    return asked


def search_upper22(output: Output, robot: str = "upper22", style: str = "neutral") -> int:
    return search_designs(robot, (Path("nod.bml"),), VARY_OPTIONS[1:2], 4, 7, style, Workers(1, None), output)


def test_search_writes_one_robot_per_pareto_optimal_design_if_requested(searches, capsys):
    assert search_upper22(Output(None, False, False)) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "eliminated: 0 of 2 designs"
    assert list(Path().glob("*.toml")) == []
    assert search_upper22(Output(Path("found"), False, False)) == 0
    printed = capsys.readouterr()
    files = [DESIGN_PATH, DESIGN_PATH.with_name("upper22_2.toml"), DESIGN_PATH.with_name(DESIGNS_FILE)]
    assert printed.out.splitlines()[-3:] == [f"{path.suffix[1:]}: {path}" for path in files]
    assert printed.err == ""
    assert [Robot.load(path).name for path in files[:2]] == ["upper22_1", "upper22_2"]
    assert sorted(DESIGN_PATH.parent.glob("*.toml")) == files[:2]


def test_search_with_option_json_prints_only_json_to_standard_output(searches, capsys):
    assert search_upper22(Output(Path("found"), False, True)) == 0
    printed = capsys.readouterr()
    text = Path("found", DESIGNS_FILE).read_text()
    assert printed.out == f"{text}\n"
    assert text.startswith('{\n "rounds": [\n  {\n   "documents": 1,')
    assert printed.err.splitlines()[0] == f"toml: {DESIGN_PATH}"


def test_search_performs_the_given_documents_with_all_variants(searches):
    search_upper22(Output(None, False, False))
    (asked,) = searches
    assert asked["robot"] == "upper22"
    assert asked["designs"] == [(), (("l_elbow_flexion.servo", "xc430_w240"),)]
    assert asked["contents"] == [("nod.bml", NOD.encode())]
    assert (asked["style"], asked["seed"], asked["settings"]) == ("neutral", 7, "inputs of upper22")


def test_finished_documents_of_a_search_are_recorded_in_its_folder(searches):
    search_upper22(Output(Path("found"), False, False))
    assert list(Journal(Path("found", SEARCH_JOURNAL_FILE), Trial).read()) == ["done"]


def test_unknown_style_ends_a_search_before_it_begins(searches):
    with pytest.raises(ConfigError, match="loud"):
        search_upper22(Output(None, False, False), style="loud")
    assert searches == []


def test_user_robot_file_is_copied_next_to_its_variants(searches):
    Path("robots").mkdir()
    for text in ('[robot]\nname = "mine"\nextends = "upper22"\n', '[robot]\nname = "mine"\nextends = "upper22"\n#\n'):
        Path("robots", "mine.toml").write_text(text)
        search_upper22(Output(Path("found"), False, False), robot=str(Path("robots", "mine.toml")))
        assert Path("found", "mine.toml").read_text() == text
        assert Robot.load(Path("found", "mine_1.toml")).name == "mine_1"
        Path("found", SEARCH_JOURNAL_FILE).touch()  # the next search resumes there
        Path("found", DESIGNS_FILE).unlink()
    assert sorted(path.name for path in Path("found").glob("*.toml")) == ["mine.toml", "mine_1.toml", "mine_2.toml"]


def test_search_replaces_the_designs_file_of_an_earlier_search(tmp_path):
    path = locate_config("robot", "upper22")
    for text in ("old", ""):
        (tmp_path / DESIGNS_FILE).write_text(text)
        result = SearchResult((Trial(BASE_DESIGN, body=BODY_FIGURES),), (), (), (Round(1, 1),))
        file = read_robot(path, RobotFile)
        assert _write_designs(result, result.finished, "upper22", path, file, tmp_path) == [tmp_path / DESIGNS_FILE]
        (row,) = json.loads((tmp_path / DESIGNS_FILE).read_text())["designs"]
        assert (row["state"], row["unbeaten"], row["sectors"]) == ("finished", True, 40)
