"""Tests of reading regular files inside a folder up to a size."""

import os
import threading
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files.input_file import open_regular, read_inside


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder that contains a file, next to a secret file."""
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "home" / "below").mkdir(parents=True)
    (tmp_path / "home" / "below" / "file").write_text("file")
    return tmp_path / "home"


def test_input_file_in_the_allowed_folder_is_read_by_its_path_or_through_links(folder: Path):
    (folder / "link").symlink_to("below/file")
    (folder / "way").symlink_to("below")
    for name in ("below/file", "link", "way/file", "below/../below/file"):
        assert read_inside(folder, folder / name, max_size=4) == b"file"


@pytest.mark.parametrize("name", ["../secret", "out", "away/secret", "below/../../secret"])
def test_input_file_outside_the_allowed_folder_is_refused(folder: Path, name: str):
    (folder / "out").symlink_to("../secret")
    (folder / "away").symlink_to("..")
    with pytest.raises(ConfigError, match="outside of the folder home"):
        read_inside(folder, folder / name, max_size=100)


def test_cyclic_links_to_an_input_file_are_refused(folder: Path):
    (folder / "a").symlink_to("b")
    (folder / "b").symlink_to("a")
    with pytest.raises(ConfigError, match="loop"):
        read_inside(folder, folder / "a", max_size=100)


@pytest.mark.parametrize("kind", ["pipe", "folder"])
def test_pipes_and_folders_as_input_file_are_refused_without_blocking(folder: Path, kind: str):
    os.mkfifo(folder / "pipe")
    (folder / "folder").mkdir()
    with pytest.raises((ConfigError, IsADirectoryError), match=r"not a regular file|Is a directory"):
        read_inside(folder, folder / kind, max_size=100)
    with pytest.raises((ConfigError, IsADirectoryError)), open_regular(folder / kind):
        pass


def test_device_file_as_input_file_is_refused():
    with pytest.raises(ConfigError, match="zero is not a regular file"), open_regular(Path("/dev/zero")):
        pass


def test_input_file_above_the_size_limit_is_refused_before_reading(folder: Path):
    with (folder / "sparse").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(ConfigError, match=r"sparse has 1000000000000 bytes; at most 100"):
        read_inside(folder, folder / "sparse", max_size=100)


def test_links_replaced_during_reads_never_give_access_outside_the_folder(folder: Path):
    """Replace a file and a folder by links while another thread reads."""
    inside, done = folder / "below", threading.Event()
    (folder / "spare").mkdir()
    (folder / "spare" / "secret").write_text("file")
    read = set()

    def exchange() -> None:
        while not done.is_set():
            os.symlink("../../secret", inside / "new")
            os.replace(inside / "new", inside / "file")
            (inside / "new").write_text("file")
            os.replace(inside / "new", inside / "file")
            os.rename(folder / "spare", folder / "kept")
            os.symlink("..", folder / "spare")
            os.unlink(folder / "spare")
            os.rename(folder / "kept", folder / "spare")

    exchanger = threading.Thread(target=exchange)
    exchanger.start()
    try:
        for _ in range(2000):
            for name in ("below/file", "spare/secret"):
                try:
                    read.add(read_inside(folder, folder / name, max_size=100))
                except (ConfigError, OSError):
                    continue
    finally:
        done.set()
        exchanger.join()
    assert b"file" in read
    assert b"secret" not in read
