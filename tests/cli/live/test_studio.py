"""Arguments that `kinesic studio` refuses, and the files of its page."""

import json
import pickle
import re
from dataclasses import replace

import pytest

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.studio import StudioPlanning, open_studio
from kinesic.cli.options import Performers, Planning
from kinesic.session.setup import set_up
from kinesic.studio.page import page_files


@pytest.mark.parametrize(
    ("file", "folder", "listen", "why"),
    [
        ("a.txt", None, "127.0.0.1:0", "NAME.bml"),
        ("gone.bml", None, "127.0.0.1:0", "no such file"),
        ("a.bml", "other", "127.0.0.1:0", "outside the folder"),
        (None, "gone", "127.0.0.1:0", "no such folder"),
        (None, None, "none", "needs an address"),
    ],
)
def test_invalid_studio_arguments_are_refused(tmp_path, file, folder, listen, why):
    (tmp_path / "a.bml").write_text("<bml/>")
    (tmp_path / "other").mkdir()
    with pytest.raises(ConfigError, match=why):
        open_studio(
            None if file is None else tmp_path / file,
            Planning("upper22", "neutral", {}),
            AccessOptions(listen, None, (), texts=False),
            Performers(frozenset({"twin"}), ()),
            None if folder is None else tmp_path / folder,
            sound=False,
            browser=False,
            rules=(),
        )


@pytest.fixture
def snapshot(tmp_path):
    """Planning snapshot of a studio with its robot, style and targets in one folder."""
    (tmp_path / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper22"\n')
    (tmp_path / "manner.toml").write_text((CONFIGS / "styles" / "calm.toml").read_text())
    (tmp_path / "targets.toml").write_text("cup = [0.3, 0.0, 1.0]\n")
    planning = Planning(
        str(tmp_path / "mine.toml"), str(tmp_path / "manner.toml"), {"targets": tmp_path / "targets.toml"}
    )
    return replace(StudioPlanning.of(planning), folder=tmp_path)


def test_studio_snapshot_keeps_robot_style_and_targets_if_their_files_change(snapshot):
    folder, before = snapshot.folder, snapshot.set_up()
    (folder / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper36"\n[collision]\nclearance = 0.0\n')
    (folder / "manner.toml").write_text("nothing")
    (folder / "targets.toml").unlink()
    unpickled = pickle.loads(pickle.dumps(snapshot)).set_up()  # as in another process
    for after in (snapshot.set_up(), unpickled):
        assert len(after.robot.skeleton.rest) == 22
        assert after.robot.min_clearance == before.robot.min_clearance > 0.0
        assert after.style == before.style
        assert after.targets["cup"].tolist() == [0.3, 0.0, 1.0]
    assert len(pickle.dumps(snapshot)) < 64_000  # fits into a pipe's buffer


def test_valid_gestures_of_the_folder_are_loaded_and_invalid_files_reported(snapshot):
    gesture = 'category = "beat"\n[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, {}, 0.5] }} }}]\n'
    (snapshot.folder / "good.toml").write_text(gesture.format("good", 0.3))
    (snapshot.folder / "far.toml").write_text(gesture.format("far", "1e308"))
    (snapshot.folder / "digits.toml").write_text("category = " + "1" * 5000)
    (snapshot.folder / "dotted.toml").write_text(".".join(["a"] * 450_000) + " = 1")
    (snapshot.folder / "large.toml").write_text("#" * 1_000_001)
    (snapshot.folder / "link.toml").symlink_to(snapshot.folder / "good.toml")
    lexicon = snapshot.set_up().lexicon
    assert "good" in lexicon.forms_by_id
    assert "far" not in lexicon.forms_by_id
    faults = "\n".join(read_folder(snapshot.folder).faults)
    for name, why in (("far", "arm lengths"), ("digits", "digits"), ("dotted", "32 parts"), ("large", "at most 1 MB")):
        assert re.search(rf"{name}\.toml: .*{why}", faults), faults
    for name in ("good", "mine", "manner", "link"):
        assert f"{name}.toml" not in faults, faults


def test_studio_page_files_contain_robot_gestures_and_examples():
    setup = set_up("upper36")
    files = page_files(setup.robot, setup.lexicon, document="mine.bml")
    assert {"/", "/studio.js", "/studio.css", "/icon.svg", "/studio.json"} == set(files)
    page_data = json.loads(files["/studio.json"].body)
    robot = page_data["robot"]
    assert len(robot["hinges"]) == len(robot["rest"]) == len(robot["lower"]) == len(robot["upper"]) == 36
    assert [robot["names"][robot["hands"][side]][0] for side in "lr"] == ["l", "r"]
    assert page_data["document"] == "mine.bml"
    assert page_data["examples"][0]["name"] == "welcome"
    assert len(page_data["examples"]) >= 9
    assert len({gesture["id"] for gesture in page_data["gestures"]}) > 200
