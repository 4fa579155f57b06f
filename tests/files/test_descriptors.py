"""Tests that file operations close their descriptors, also after errors."""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files.draft import hold_draft, mark_as_abandoned, remove_abandoned
from kinesic.files.held_file import read_held, replace_held
from kinesic.files.held_folder import hold_folder
from kinesic.files.input_file import open_regular, read_inside
from kinesic.files.output_file import write_text
from kinesic.files.output_folder import new_folder
from kinesic.files.private_file import check_private, read_secret
from kinesic.files.private_folder import hold_private_folder

DESCRIPTOR_FOLDER = Path("/proc/self/fd")  # folder in which Linux lists the open files of a process
pytestmark = pytest.mark.skipif(not DESCRIPTOR_FOLDER.is_dir(), reason="the system has no list of open files")


class InterruptionError(Exception):
    """Error of a program while it writes."""


def replace_durably(folder: Path) -> None:
    for text in ("first", "second"):
        write_text(folder / "mine", text, force=True, durable=True)


def write_existing(folder: Path) -> None:
    (folder / "mine").touch()
    write_text(folder / "mine", "x")


def make_folder(folder: Path) -> None:
    for _ in range(2):
        with new_folder(folder / "report", force=True) as fresh:
            (fresh / "page").write_text("x")


def interrupt_folder(folder: Path) -> None:
    with new_folder(folder / "report"):
        raise InterruptionError


def abandon_draft(folder: Path) -> None:
    with hold_folder(folder) as parent, hold_draft("report", parent=parent):
        remove_abandoned(parent)


def mark_folder(folder: Path) -> None:
    with hold_folder(folder) as held:
        for _ in range(2):
            mark_as_abandoned(held)


def replace_in_held(folder: Path) -> None:
    with hold_folder(folder) as held:
        replace_held(held, "mine", b"x" * 10)
        assert read_held(held, "mine", limit=20) == b"x" * 10
        assert read_held(held, "none", limit=20) is None
        replace_held(held, "mine/none", b"x")


def read_missing(folder: Path) -> None:
    read_inside(folder, folder / "none", max_size=9)


def read_oversized(folder: Path) -> None:
    (folder / "large").write_bytes(b"x" * 10)
    assert read_inside(folder, folder / "large", max_size=10) == b"x" * 10
    read_inside(folder, folder / "large", max_size=9)


def read_pipe(folder: Path) -> None:
    os.mkfifo(folder / "pipe")
    with open_regular(folder / "pipe"):
        pass


def read_secrets(folder: Path) -> None:
    (folder / "token").touch(0o600)
    (folder / "token").write_text("open sesame")
    check_private(folder / "token", "--token-file")
    assert read_secret(folder / "token", "--token-file") == "open sesame"
    (folder / "token").chmod(0o644)
    read_secret(folder / "token", "--token-file")


def hold_private(folder: Path) -> None:
    with hold_private_folder(folder / "own", make=True):
        pass
    (folder / "own").chmod(0o777)
    with hold_private_folder(folder / "own"):
        pass


@pytest.mark.parametrize(
    "use",
    [
        replace_durably,
        write_existing,
        make_folder,
        interrupt_folder,
        abandon_draft,
        mark_folder,
        replace_in_held,
        read_missing,
        read_oversized,
        read_pipe,
        read_secrets,
        hold_private,
    ],
)
def test_file_operations_leave_no_file_descriptor_open(tmp_path: Path, use: Callable[[Path], None]):
    before = sorted(os.listdir(DESCRIPTOR_FOLDER))
    with suppress(ConfigError, OSError, InterruptionError):
        use(tmp_path)
    assert sorted(os.listdir(DESCRIPTOR_FOLDER)) == before
