"""Templates that `kinesic new` writes."""

import re
from pathlib import Path

import pytest

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.cli.new import EXAMPLE_ROBOT
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def test_new_gesture_is_planned_without_warnings(kinesic, tmp_path: Path):
    written = kinesic("new", "gesture", "my_offer")
    assert written.code == 0, written.err
    assert written.out.splitlines()[0] == "gesture: my_offer.toml"
    assert Lexicon.load(tmp_path / "my_offer.toml").find("my_offer") is not None
    block = BLOCK.format('<gesture id="g" lexeme="my_offer" start="0" end="3"/>').encode()
    planned = kinesic("plan", "-", "--lexicon", "my_offer.toml", stdin=block)
    assert planned.code == 0
    assert planned.err == ""
    assert re.search(r"gesture my_offer, (left|right) hand", " ".join(planned.out.split()))


def test_command_printed_by_new_draws_the_new_gesture(kinesic, tmp_path: Path):
    command = kinesic("new", "gesture", "my_offer").out.splitlines()[1]
    drawn = kinesic(*command.removeprefix("try: kinesic ").split(), "--drawn")
    assert drawn.code == 0, drawn.err
    assert (tmp_path / "my_offer.png").exists()


def test_new_style_file_has_a_smaller_spatial_extent_for_the_head_than_for_gestures(kinesic, tmp_path: Path):
    assert kinesic("new", "style", "open_minded").code == 0
    style = Style.load(tmp_path / "open_minded.toml")
    assert style.name == "open_minded"
    assert style.head.spatial < style.gesture.spatial


def test_robot_template_has_the_joints_of_the_example_robot(kinesic, tmp_path: Path):
    assert kinesic("new", "robot", "my_body", "--out", str(tmp_path)).code == 0
    robot, example = Robot.load(tmp_path / "my_body.toml"), Robot.load(EXAMPLE_ROBOT)
    assert robot.name == "my_body"
    assert robot.skeleton.names == example.skeleton.names


def test_new_writes_to_the_toml_file_or_folder_given_as_out(kinesic, tmp_path: Path):
    (tmp_path / "mine.toml").mkdir()
    for out, file in (("tap.toml", "tap.toml"), ("mine.toml", "mine.toml/my_offer.toml")):
        assert kinesic("new", "gesture", "my_offer", "--out", out).code == 0
        assert Lexicon.load(tmp_path / file).find("my_offer") is not None
    refused = kinesic("new", "gesture", "my_offer", "--out", "nowhere/tap.toml")
    assert (refused.code, "there is no folder nowhere;" in refused.err) == (2, True)


@pytest.mark.parametrize("kind", ["gesture", "style", "robot"])
def test_new_replaces_an_existing_file_only_with_force(kinesic, tmp_path: Path, kind: str):
    mine = tmp_path / "mine.toml"
    mine.write_text("my work", encoding="utf-8")
    refused = kinesic("new", kind, "mine")
    assert refused.code == 2
    assert "mine.toml exists already; --force replaces it" in refused.err
    assert mine.read_text(encoding="utf-8") == "my work"
    assert kinesic("new", kind, "mine", "--force").code == 0


@pytest.mark.parametrize("name", ["../up", "", "a/b", "1st", "x" * 65, "ünï", "a.b"])
def test_new_refuses_names_that_are_no_identifiers(kinesic, tmp_path: Path, name: str):
    ended = kinesic("new", "gesture", name)
    assert ended.code == 2
    assert "begins with a letter" in ended.err
    assert list(tmp_path.iterdir()) == []


def test_new_refuses_a_name_that_windows_reserves_for_a_device(kinesic, tmp_path: Path):
    ended = kinesic("new", "gesture", "Com1")
    assert (ended.code, "Windows reserves this name" in ended.err, list(tmp_path.iterdir())) == (2, True, [])


def test_every_scalar_setting_of_the_templates_has_a_comment():
    for template in sorted((CONFIGS / "templates").glob("*.toml")):
        lines = template.read_text(encoding="utf-8").splitlines()
        settings = [line for line in lines if re.match(r"[a-z_]+ = [^\[]", line)]
        assert [line for line in settings if "  # " not in line] == []
