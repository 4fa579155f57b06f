"""Tests of private folders in places writable by all users."""

import os
from pathlib import Path

import pytest

from kinesic.files.private_folder import hold_private_folder

NOBODY_UID = 65_534  # user id of another user


def hold(path: Path, *, make: bool = True) -> None:
    with hold_private_folder(path, make=make) as folder:
        assert os.path.samestat(folder.status(), path.stat())


def test_missing_private_folder_is_created_for_this_user_only(tmp_path: Path):
    hold(tmp_path / "mine")
    assert (tmp_path / "mine").stat().st_mode & 0o777 == 0o700
    hold(tmp_path / "mine")
    with pytest.raises(FileNotFoundError):
        hold(tmp_path / "other", make=False)


@pytest.mark.parametrize("kind", ["file", "link", "dangling", "open"])
def test_private_folder_that_is_a_file_or_a_link_or_open_to_others_is_refused(tmp_path: Path, kind: str):
    path = tmp_path / "mine"
    match kind:
        case "file":
            path.write_text("dear")
        case "open":
            path.mkdir()
            path.chmod(0o770)
        case _:
            path.symlink_to("elsewhere")
            if kind == "link":
                (tmp_path / "elsewhere").mkdir()
    with pytest.raises(OSError, match=r"Not a directory|Too many levels|other users may write it"):
        hold(path)
    assert kind != "dangling" or not (tmp_path / "elsewhere").exists()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give folders away")
def test_private_folder_of_another_user_is_refused(tmp_path: Path):
    (tmp_path / "mine").mkdir(mode=0o700)
    os.chown(tmp_path / "mine", NOBODY_UID, NOBODY_UID)
    with pytest.raises(PermissionError, match=f"it belongs to another user .uid {NOBODY_UID}"):
        hold(tmp_path / "mine")
