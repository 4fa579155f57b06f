import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.body.named_file import check_inside


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a file, a folder with another one, a pipe, and links to them and out of it."""
    folder = tmp_path / "folder"
    (folder / "below").mkdir(parents=True)
    for path in (folder / "own", folder / "below" / "own", tmp_path / "secret"):
        path.write_text("words")
    os.mkfifo(folder / "pipe")
    (folder / "in").symlink_to("below/own")
    (folder / "out").symlink_to("../secret")
    (folder / "up").symlink_to("..")
    (folder / "ring").symlink_to("ring")
    return folder


@pytest.mark.parametrize("name", ["own", "below/own", "below/../own", "in", "none", "../folder/own"])
def test_a_file_in_the_folder_may_be_named(folder: Path, name: str) -> None:
    check_inside(folder, folder / name)


@pytest.mark.parametrize("name", ["../secret", "/etc/hostname", "out", "up/secret", "../none", "below/../../secret"])
def test_no_file_outside_of_it(folder: Path, name: str) -> None:
    with pytest.raises(ConfigError, match=r"is outside of the folder .*folder; copy that file there"):
        check_inside(folder, folder / name)


@pytest.mark.parametrize(
    ("name", "why"), [("pipe", "no ordinary"), (".", "no ordinary"), ("ring", "ring"), ("a\0b", "null")]
)
def test_nothing_but_an_ordinary_file(folder: Path, name: str, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        check_inside(folder, folder / name)


def test_a_folder_may_be_reached_by_a_link(folder: Path) -> None:
    (folder.parent / "linked").symlink_to(folder)
    check_inside(folder.parent / "linked", folder.parent / "linked" / "own")
