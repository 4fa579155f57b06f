"""`kinesic studio`: what it refuses before anything opens, and what the page is given."""

import json
import pickle
import re
from dataclasses import replace

import pytest

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.cli.live.door import Door
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.studio import StudioPlanning, open_studio
from kinesic.cli.options import Performers, Planning
from kinesic.controller.perform import set_up
from kinesic.studio.page import page_files


@pytest.mark.parametrize(
    ("file", "folder", "listen", "why"),
    [
        ("a.txt", None, "127.0.0.1:0", "NAME.bml"),
        ("gone.bml", None, "127.0.0.1:0", "no such file"),
        ("a.bml", "other", "127.0.0.1:0", "outside of which"),
        (None, "gone", "127.0.0.1:0", "no such folder"),
        (None, None, "none", "needs an address"),
    ],
)
def test_what_cannot_be_shown_is_refused(tmp_path, file, folder, listen, why):
    (tmp_path / "a.bml").write_text("<bml/>")
    (tmp_path / "other").mkdir()
    with pytest.raises(ConfigError, match=why):
        open_studio(
            None if file is None else tmp_path / file,
            Planning("upper22", "neutral", {}),
            Door(listen, None, (), texts=False),
            Performers(frozenset({"twin"}), ()),
            None if folder is None else tmp_path / folder,
            sound=False,
            browser=False,
            rules=(),
        )


@pytest.fixture
def frozen(tmp_path):
    """Planning of a studio for a robot, style and targets of its own folder."""
    (tmp_path / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper22"\n')
    (tmp_path / "manner.toml").write_text((CONFIGS / "styles" / "calm.toml").read_text())
    (tmp_path / "targets.toml").write_text("cup = [0.3, 0.0, 1.0]\n")
    planning = Planning(
        str(tmp_path / "mine.toml"), str(tmp_path / "manner.toml"), {"targets": tmp_path / "targets.toml"}
    )
    return replace(StudioPlanning.of(planning), folder=tmp_path)


def test_robot_style_and_targets_are_those_of_the_beginning_whatever_becomes_of_their_files(frozen):
    folder, before = frozen.folder, frozen.set_up()
    (folder / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper36"\n[collision]\nclearance = 0.0\n')
    (folder / "manner.toml").write_text("nothing")
    (folder / "targets.toml").unlink()
    elsewhere = pickle.loads(pickle.dumps(frozen)).set_up()  # as another process makes it
    for after in (frozen.set_up(), elsewhere):
        assert len(after.robot.skeleton.rest) == 22
        assert after.robot.least_clearance == before.robot.least_clearance > 0.0
        assert after.style == before.style
        assert after.targets["cup"].tolist() == [0.3, 0.0, 1.0]
    assert len(pickle.dumps(frozen)) < 64_000  # what a pipe takes at once


def test_gestures_of_the_folder_are_known_and_what_is_wrong_is_passed_over_and_said(frozen):
    gesture = 'category = "beat"\n[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, {}, 0.5] }} }}]\n'
    (frozen.folder / "good.toml").write_text(gesture.format("good", 0.3))
    (frozen.folder / "far.toml").write_text(gesture.format("far", "1e308"))
    (frozen.folder / "digits.toml").write_text("category = " + "1" * 5000)
    (frozen.folder / "dotted.toml").write_text(".".join(["a"] * 450_000) + " = 1")
    (frozen.folder / "large.toml").write_text("#" * 1_000_001)
    (frozen.folder / "link.toml").symlink_to(frozen.folder / "good.toml")
    lexicon = frozen.set_up().lexicon
    assert "good" in lexicon.forms_by_id
    assert "far" not in lexicon.forms_by_id
    told = "\n".join(read_folder(frozen.folder).faults)
    for name, why in (("far", "arm lengths"), ("digits", "digits"), ("dotted", "32 parts"), ("large", "at most 1 MB")):
        assert re.search(rf"{name}\.toml: .*{why}", told), told
    for name in ("good", "mine", "manner", "link"):
        assert f"{name}.toml" not in told, told


def test_the_page_is_given_the_body_the_gestures_and_examples():
    setup = set_up("upper36")
    files = page_files(setup.robot, setup.lexicon, document="mine.bml")
    assert {"/", "/studio.js", "/studio.css", "/icon.svg", "/studio.json"} == set(files)
    about = json.loads(files["/studio.json"].body)
    robot = about["robot"]
    assert len(robot["hinges"]) == len(robot["rest"]) == len(robot["lower"]) == len(robot["upper"]) == 36
    assert [robot["names"][robot["hands"][side]][0] for side in "lr"] == ["l", "r"]
    assert about["document"] == "mine.bml"
    assert about["examples"][0]["name"] == "welcome"
    assert len(about["examples"]) >= 9
    assert len({each["id"] for each in about["gestures"]}) > 200
