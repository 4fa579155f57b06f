"""Tests of draft folders and their removal after a killed process."""

import errno
import fcntl
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kinesic.files import draft as draft_module
from kinesic.files.draft import (
    DRAFT_FILE,
    DRAFT_TEXT,
    hold_draft,
    is_same,
    mark_as_abandoned,
    remove_abandoned,
    remove_folder,
)
from kinesic.files.held_folder import hold_folder
from kinesic.files.output_folder import MARKER_FILE, MARKER_TEXT

NOBODY_UID = 65_534  # user id of another user
WRITER_PROGRAM = """
import sys, time
from pathlib import Path
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import new_folder
place = Path(sys.argv[1])
with new_folder(place / "rep") as folder, new_file(place / "song.wav") as file:
    (folder / "deep").mkdir()
    (folder / "deep" / "half").write_text("half")
    file.write_text("half")
    print("ready", flush=True)
    sys.stdin.readline()
"""
NEXT_RUN_PROGRAM = """
import sys
from pathlib import Path
from kinesic.files.output_file import write_text
write_text(Path(sys.argv[1]) / "next", "next", force=True)
"""


@contextmanager
def writer(place: Path) -> Iterator[subprocess.Popen]:
    """Start a process that writes a folder and a file until killed."""
    words = [sys.executable, "-c", WRITER_PROGRAM, str(place)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield process
        process.kill()


def run_next(place: Path) -> None:
    subprocess.run([sys.executable, "-c", NEXT_RUN_PROGRAM, str(place)], check=True)


def test_next_run_removes_unfinished_output_of_a_killed_run(tmp_path: Path):
    with writer(tmp_path) as process:
        assert len(list(tmp_path.glob(".*"))) == 2
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert len(list(tmp_path.glob(".*"))) == 2
    run_next(tmp_path)
    assert os.listdir(tmp_path) == ["next"]


def test_unfinished_output_of_running_writers_is_kept(tmp_path: Path):
    with writer(tmp_path) as process:
        run_next(tmp_path)
        assert len(list(tmp_path.glob(".*"))) == 2
        process.communicate("\n")
        assert process.returncode == 0
    assert sorted(os.listdir(tmp_path)) == ["next", "rep", "song.wav"]
    assert (tmp_path / "rep" / "deep" / "half").read_text() == "half"
    assert sorted(os.listdir(tmp_path / "rep")) == [MARKER_FILE, "deep"]


@pytest.fixture
def abandoned(tmp_path: Path) -> Path:
    """Create a draft folder as left by a killed process."""
    folder = tmp_path / "out" / ".rep-0123456789ab"
    folder.mkdir(parents=True)
    (folder / MARKER_FILE).write_bytes(MARKER_TEXT)
    (folder / DRAFT_FILE).write_bytes(DRAFT_TEXT)
    return folder


def sweep(folder: Path) -> list[str]:
    """Remove abandoned drafts and return the remaining names in a folder."""
    with hold_folder(folder) as held:
        remove_abandoned(held)
    return sorted(os.listdir(folder))


def test_links_in_an_abandoned_temporary_folder_are_not_followed(abandoned: Path, tmp_path: Path):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "letter").write_text("dear")
    (abandoned / "folder").symlink_to(mine)
    (abandoned / "file").symlink_to(mine / "letter")
    assert sweep(abandoned.parent) == []
    assert (mine / "letter").read_text() == "dear"


def test_symlink_named_like_a_temporary_folder_is_kept(abandoned: Path, tmp_path: Path):
    abandoned.rename(tmp_path / "mine")
    abandoned.symlink_to(tmp_path / "mine")
    assert sweep(abandoned.parent) == [abandoned.name]
    assert (tmp_path / "mine" / DRAFT_FILE).exists()


@pytest.mark.parametrize("name", ["rep", ".rep", ".rep-0123", ".rep-0123456789AB", "rep-0123456789ab"])
def test_abandoned_folder_without_a_temporary_name_is_kept(abandoned: Path, name: str):
    abandoned.rename(abandoned.with_name(name))
    assert sweep(abandoned.parent) == [name]


@pytest.mark.parametrize("text", [None, b"", b"mine", DRAFT_TEXT[:-1], DRAFT_TEXT + b"x", "link", "pipe", "folder"])
def test_folder_without_the_exact_temporary_marker_file_is_kept(
    abandoned: Path, tmp_path: Path, text: bytes | str | None
):
    file = abandoned / DRAFT_FILE
    file.unlink()
    match text:
        case "link":
            (tmp_path / "elsewhere").write_bytes(DRAFT_TEXT)
            file.symlink_to(tmp_path / "elsewhere")
        case "pipe":
            os.mkfifo(file)
        case "folder":
            file.mkdir()
        case bytes():
            file.write_bytes(text)
        case _:
            pass
    assert sweep(abandoned.parent) == [abandoned.name]
    assert (abandoned / MARKER_FILE).exists()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
@pytest.mark.parametrize("given", [".", DRAFT_FILE])
def test_temporary_folder_is_kept_if_it_or_its_marker_file_belongs_to_another_user(abandoned: Path, given: str):
    os.chown(abandoned / given, NOBODY_UID, NOBODY_UID)
    assert sweep(abandoned.parent) == [abandoned.name]


def test_finished_temporary_folder_is_kept(tmp_path: Path):
    """Expect the folder to stay, although its name is still hidden."""
    with hold_folder(tmp_path) as parent, hold_draft("rep", parent=parent) as draft:
        draft.finish()
        assert sweep(tmp_path) == [draft.name]


def test_temporary_folder_is_private_locked_and_removed_after_use(tmp_path: Path):
    with hold_folder(tmp_path) as parent:
        with hold_draft("rep", parent=parent) as draft:
            assert (tmp_path / draft.name).stat().st_mode & 0o777 == 0o700
            assert sweep(tmp_path) == [draft.name], "it is locked"
        assert os.listdir(tmp_path) == []


def test_failed_creation_of_a_temporary_folder_leaves_no_file_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    usual = os.open

    def fail(path: str, *arguments: int, **more: int) -> int:
        if path == DRAFT_FILE:
            raise OSError(28, "No space left on device")
        return usual(path, *arguments, **more)

    with hold_folder(tmp_path) as parent:
        monkeypatch.setattr(os, "open", fail)
        with pytest.raises(OSError, match="No space left"), hold_draft("rep", parent=parent):
            pass
    assert os.listdir(tmp_path) == []


def test_folder_removal_keeps_a_link_that_replaced_the_open_folder(tmp_path: Path):
    """Keep a link that has taken the name of the open folder."""
    (tmp_path / "draft").mkdir()
    (tmp_path / "draft" / "half").write_text("half")
    with hold_folder(tmp_path) as parent, hold_folder("draft", inside=parent) as held:
        (tmp_path / "draft").rename(tmp_path / "away")
        assert not is_same("draft", held, parent=parent)
        (tmp_path / "draft").symlink_to("away")
        assert not is_same("draft", held, parent=parent)
        remove_folder("draft", held, parent=parent)
        assert (tmp_path / "away" / "half").read_text() == "half"
        assert is_same("away", held, parent=parent)
        remove_folder("away", held, parent=parent)
    assert os.listdir(tmp_path) == ["draft"]


def test_abandoned_temporary_folder_is_removed_with_its_subfolders(abandoned: Path):
    (abandoned / "deep" / "deeper").mkdir(parents=True)
    (abandoned / "deep" / "deeper" / "half").write_text("half")
    assert sweep(abandoned.parent) == []


def test_old_output_folder_marked_as_abandoned_is_removed_by_the_next_run(tmp_path: Path):
    aside = tmp_path / ".rep-0123456789ab"
    aside.mkdir()
    (aside / "old").write_text("old")
    with hold_folder(aside) as folder:
        mark_as_abandoned(folder)
        mark_as_abandoned(folder)  # a mark that is there stays
    assert (aside / DRAFT_FILE).read_bytes() == DRAFT_TEXT
    assert (aside / DRAFT_FILE).stat().st_mode & 0o777 == 0o600
    assert sweep(tmp_path) == []


def test_marker_file_of_a_temporary_folder_is_private_and_explains_its_purpose(tmp_path: Path):
    with hold_folder(tmp_path) as parent, hold_draft("rep", parent=parent) as draft:
        file = tmp_path / draft.name / DRAFT_FILE
        assert file.stat().st_mode & 0o777 == 0o600
        assert file.read_bytes() == DRAFT_TEXT


def test_temporary_folder_on_a_disk_without_locks_has_no_marker_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Expect no marker file, since an unlocked one marks an abandoned draft."""

    def refuse(*arguments: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with hold_folder(tmp_path) as parent:
        with hold_draft("rep", parent=parent) as draft:
            assert os.listdir(tmp_path / draft.name) == []
            assert sweep(tmp_path) == [draft.name]
        assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("mode", [0o700, 0o777])
def test_temporary_folder_has_the_requested_permissions_minus_the_umask(tmp_path: Path, mode: int):
    usual = os.umask(0o022)
    try:
        with hold_folder(tmp_path) as parent, hold_draft("rep", parent=parent, mode=mode) as draft:
            assert (tmp_path / draft.name).stat().st_mode & 0o777 == mode & ~0o022
    finally:
        os.umask(usual)


def test_abandoned_temporary_folders_are_removed_once_per_folder_and_process(tmp_path: Path):
    for place in ("first", "second"):
        (tmp_path / place).mkdir()
        for count, kept in enumerate(([], [".rep-0123456789ab"])):
            left = tmp_path / place / ".rep-0123456789ab"
            left.mkdir()
            (left / DRAFT_FILE).write_bytes(DRAFT_TEXT)
            with hold_folder(tmp_path / place) as parent, hold_draft("rep", parent=parent):
                pass
            assert os.listdir(tmp_path / place) == kept, count


def test_temporary_folder_on_windows_has_no_marker_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(draft_module, "_lock_file", lambda _: None)
    with hold_folder(tmp_path) as parent:
        for platform, files in (("win32", []), ("linux", [DRAFT_FILE])):
            monkeypatch.setattr(sys, "platform", platform)
            with hold_draft("rep", parent=parent) as draft:
                assert draft.folder.names() == files
