"""Gesture files of users: overriding, errors that suggest a correction, and refused folders."""

import os
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon

GESTURE_TOML = """
category = "beat"
[[gesture]]
id = "own"
keys = [{ right = { at = ["XC", 0.1, "ZNear"], palm = "in up" } }, { both = { at = [0.3, 0.2, 0.5] } }]
"""


def test_user_gestures_override_builtin_ones(tmp_path: Path):
    (tmp_path / "a.toml").write_text(GESTURE_TOML.replace('"own"', '"beat"'))
    for path in (tmp_path, tmp_path / "a.toml"):
        lexicon = Lexicon.load(path)
        assert lexicon.find("beat").form.keys[0].hands["r"].position == pytest.approx([0.4, 0.25, 0.1])
        assert lexicon.find("stop").form.id == "stop"
        assert lexicon.find("beat").form.keys[0].hands["r"].palm == pytest.approx([0, -np.sqrt(0.5), np.sqrt(0.5)])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("palm", "plam", r"plam.*did you mean palm\?"),
        ('"beat"', '"beet"', "beet"),
        ("in up", "inn", r"gesture own: inn is no direction; did you mean in\?"),
        ("in up", "in out", r"gesture own: 'in out' points nowhere"),
        ('"XC"', "1e308", r"gesture own: a hand is 1e\+308 arm lengths outward, outside \[-5, 5\]"),
        ("XC", "XD", r"gesture own: XD is no sector of x; known: XEP"),
        ("{ both = { at = [0.3, 0.2, 0.5] } }", "{}", r"gesture own: a key without hands"),
        ("{ both =", "{ left = { at = [0.3, 0, 0.5] }, both =", r"gesture own: a key has both and a single hand"),
        ('palm = "in up"', "openness = 3", r"gesture own: openness is 3, outside \[0, 1\]"),
        ("0.1,", "inf,", r"must be a finite number"),
    ],
)
def test_invalid_gesture_file_error_names_the_file_and_the_cause(tmp_path: Path, old, new, message):
    assert old in GESTURE_TOML
    (tmp_path / "own.toml").write_text(GESTURE_TOML.replace(old, new))
    with pytest.raises(ConfigError, match=message) as error:
        Lexicon.load(tmp_path / "own.toml")
    assert "own.toml" in str(error.value)


@pytest.mark.parametrize("odd", ["pipe", "link"])
def test_gesture_folder_with_a_pipe_or_a_link_to_a_file_outside_is_refused(odd: str, tmp_path: Path):
    folder = tmp_path / "gestures"
    folder.mkdir()
    (folder / "a.toml").touch()
    (tmp_path / "b.toml").touch()
    if odd == "pipe":
        os.mkfifo(folder / "b.toml")
    else:
        (folder / "b.toml").symlink_to("../b.toml")
    with pytest.raises(ConfigError, match=r"b\.toml' is (outside|not a regular file)"):
        Lexicon.load(folder)


def test_error_names_missing_gesture_files_and_empty_folders(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"without \.toml files"):
        Lexicon.load(tmp_path)
    with pytest.raises(ConfigError, match="no such file"):
        Lexicon.load(tmp_path / "none.toml")
