"""`kinesic studio`: what it refuses before anything opens, and what the page is given."""

import json

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli.live.studio import open_studio
from kinesic.cli.options import Door, Performers, Planning
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
            Door(listen, None, ()),
            Performers(frozenset({"twin"}), ()),
            None if folder is None else tmp_path / folder,
            sound=False,
            browser=False,
            rules=(),
        )


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
