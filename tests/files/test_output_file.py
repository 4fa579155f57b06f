import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files import output_file
from kinesic.files.output_file import check_file, new_file, open_to_add, write_text


def write(path: Path, text: str, meanwhile: Callable[[], object], *, force: bool = False) -> None:
    """Write a file and call a function before it is complete."""
    with new_file(path, force=force) as fresh:
        fresh.write_text(text)
        meanwhile()


def fail() -> None:
    raise ZeroDivisionError


def fill_disk() -> None:
    raise OSError(28, "No space left on device")


def test_output_file_appears_only_when_complete(tmp_path: Path):
    path = tmp_path / "a.txt"
    with new_file(path) as fresh:
        fresh.write_text("half")
        assert not path.exists()
        assert fresh.suffix == ".txt"
        fresh.write_text("whole")
    assert path.read_text() == "whole"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_old_output_file_is_kept_if_writing_the_new_one_fails(tmp_path: Path):
    path = tmp_path / "a.txt"
    path.write_text("before")
    with pytest.raises(ZeroDivisionError):
        write(path, "half", fail, force=True)
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["a.txt"]
    write_text(path, "after", force=True)
    assert path.read_text() == "after"


def test_full_disk_error_names_the_output_file_and_leaves_no_file(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"a\.txt: No space left"):
        write(tmp_path / "a.txt", "half", fill_disk)
    assert os.listdir(tmp_path) == []


def test_new_output_file_has_default_permissions(tmp_path: Path):
    write_text(tmp_path / "mine", "x")
    (tmp_path / "usual").write_text("x")
    assert (tmp_path / "mine").stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize(
    ("kind", "says"),
    [("folder", "is a folder"), ("link", "is a link"), ("dangling", "is a link"), ("pipe", "is not a regular file")],
)
def test_folder_link_or_pipe_at_the_output_path_is_refused_even_if_forced(
    tmp_path: Path, kind: str, says: str, force: bool
):
    path, letter = tmp_path / "a", tmp_path / "letter"
    letter.write_text("dear")
    match kind:
        case "folder":
            path.mkdir()
        case "link":
            path.symlink_to("letter")
        case "dangling":
            path.symlink_to("nowhere")
        case _:
            os.mkfifo(path)
    with pytest.raises(ConfigError, match=says):
        check_file(path, force=force)
    with pytest.raises(ConfigError, match=says):
        write_text(path, "x", force=force)
    assert letter.read_text() == "dear"
    assert sorted(os.listdir(tmp_path)) == ["a", "letter"]


@pytest.mark.parametrize("path", ["", ".", "/", ".."])
def test_output_path_without_a_file_name_is_refused(path: str):
    with pytest.raises(ConfigError, match=r"is a folder|may not be written"):
        check_file(Path(path), force=True)


def test_check_of_an_existing_output_file_raises_an_error_unless_force_is_set(tmp_path: Path):
    (tmp_path / "a").write_text("before")
    with pytest.raises(ConfigError, match="exists already; --force replaces it"):
        check_file(tmp_path / "a")
    check_file(tmp_path / "a", force=True)


def test_file_created_by_another_program_during_writing_is_kept(tmp_path: Path):
    with pytest.raises(ConfigError, match="exists already"):
        write(tmp_path / "a", "new", lambda: (tmp_path / "a").write_text("dear"))
    assert (tmp_path / "a").read_text() == "dear"
    assert os.listdir(tmp_path) == ["a"]


def test_file_created_by_another_program_after_the_name_check_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    look = output_file._check_name

    def look_and_be_late(*arguments: object, force: bool) -> None:
        look(*arguments, force=force)
        (tmp_path / "a").write_text("dear")

    def begin_late() -> None:
        monkeypatch.setattr(output_file, "_check_name", look_and_be_late)

    with pytest.raises(ConfigError, match="File exists"):
        write(tmp_path / "a", "new", begin_late)
    assert (tmp_path / "a").read_text() == "dear"


def test_link_created_during_writing_is_not_followed(tmp_path: Path):
    (tmp_path / "letter").write_text("dear")
    with pytest.raises(ConfigError, match="is a link"):
        write(tmp_path / "a", "new", lambda: (tmp_path / "a").symlink_to("letter"), force=True)
    assert (tmp_path / "letter").read_text() == "dear"


def test_error_names_a_missing_parent_folder(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"there is no folder .*nowhere; make it first"):
        check_file(tmp_path / "nowhere" / "a")
    assert not (tmp_path / "nowhere").exists()


def test_appending_keeps_file_contents_and_follows_no_link(tmp_path: Path):
    for word in (b"one", b"two"):
        with open_to_add(tmp_path / "log") as file:
            file.write(word)
    assert (tmp_path / "log").read_bytes() == b"onetwo"
    (tmp_path / "link").symlink_to("log")
    with pytest.raises(OSError, match="link"):
        open_to_add(tmp_path / "link")


def test_appending_to_a_pipe_without_reader_is_refused(tmp_path: Path):
    """Expect an error instead of waiting for a reader."""
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="No such device"):
        open_to_add(tmp_path / "pipe")


def test_existing_output_file_is_kept_without_force(tmp_path: Path):
    path = tmp_path / "mine"
    path.write_text("dear")
    for write in (check_file, lambda path: write_text(path, "new")):
        with pytest.raises(ConfigError, match="exists already"):
            write(path)
    with pytest.raises(ConfigError, match="exists already"), new_file(path):
        pass
    assert path.read_text() == "dear"


def test_appending_to_a_missing_output_file_creates_the_file(tmp_path: Path):
    open_to_add(tmp_path / "log").close()
    (tmp_path / "any").touch()
    assert (tmp_path / "log").stat().st_mode == (tmp_path / "any").stat().st_mode


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o755, 0o666])
def test_replaced_output_file_keeps_its_permissions(tmp_path: Path, mode: int):
    path = tmp_path / "mine"
    path.write_text("before")
    path.chmod(mode)
    write_text(path, "after", force=True)
    assert path.read_text() == "after"
    assert path.stat().st_mode & 0o7777 == mode


def test_replacement_of_a_private_file_is_written_in_a_private_temporary_folder(tmp_path: Path):
    path = tmp_path / "mine"
    path.write_text("before")
    path.chmod(0o600)
    with new_file(path, force=True) as fresh:
        fresh.write_text("secret")
        assert fresh.parent.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("mode", [0o444, 0o400, 0o000])
def test_read_only_output_file_is_not_replaced_even_if_forced(tmp_path: Path, mode: int):
    path = tmp_path / "mine"
    path.write_text("before")
    path.chmod(mode)
    for write_over in (check_file, lambda path, *, force: write_text(path, "x", force=force)):
        with pytest.raises(ConfigError, match="mine is read-only and is not replaced; chmod u"):
            write_over(path, force=True)
    assert path.stat().st_mode & 0o7777 == mode
    path.chmod(0o600)
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["mine"]


def test_durable_file_and_its_folder_are_flushed_to_disk(tmp_path: Path, monkeypatch):
    synced, sync = [], os.fsync

    def record(descriptor: int) -> None:
        synced.append((os.fstat(descriptor).st_ino, sorted(os.listdir(tmp_path))))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", record)
    write_text(tmp_path / "mine", "x", durable=True)
    file, folder = synced
    assert file[0] == (tmp_path / "mine").stat().st_ino
    assert "mine" not in file[1], "the file is on the disk before it has its name"
    assert folder[0] == tmp_path.stat().st_ino
    assert "mine" in folder[1]
    write_text(tmp_path / "other", "x")
    assert len(synced) == 2, "thousands of reports do not wait for the disk"
