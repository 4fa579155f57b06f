import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files import output_folder
from kinesic.files.output_folder import MARKER_FILE, MARKER_TEXT, check_folder, is_made, new_folder


@pytest.fixture
def made(tmp_path: Path) -> Path:
    """Return a folder created by kinesic that contains a result."""
    folder = tmp_path / "out" / "demo"
    with new_folder(folder) as fresh:
        (fresh / "result").write_text("first")
    return folder


def test_output_folder_appears_only_when_complete(tmp_path: Path):
    folder = tmp_path / "deep" / "down"
    with new_folder(folder) as fresh:
        assert not folder.exists()
        (fresh / "result").write_text("first")
    assert sorted(os.listdir(folder)) == [MARKER_FILE, "result"]
    assert os.listdir(tmp_path / "deep") == ["down"]
    assert is_made(folder)
    (tmp_path / "usual").mkdir()
    assert folder.stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_forced_replacement_leaves_nothing_of_the_old_folder(made: Path):
    (made / "deep").mkdir()
    (made / "deep" / "old").write_text("old")
    with pytest.raises(ConfigError, match="exists already; --force replaces it, --out names another"):
        check_folder(made)
    with new_folder(made, force=True) as fresh:
        (fresh / "result").write_text("second")
        assert (made / "result").read_text() == "first"
    assert sorted(os.listdir(made)) == [MARKER_FILE, "result"]
    assert (made / "result").read_text() == "second"
    assert os.listdir(made.parent) == ["demo"]


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt])
def test_failed_run_keeps_the_earlier_output_folder(made: Path, error: type[BaseException]):
    with pytest.raises(error), new_folder(made, force=True):
        raise error
    assert (made / "result").read_text() == "first"
    assert os.listdir(made.parent) == ["demo"]


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt])
def test_parent_folders_created_for_an_output_folder_are_removed_after_a_failure(
    tmp_path: Path, error: type[BaseException]
):
    (tmp_path / "here").mkdir()
    with pytest.raises(error), new_folder(tmp_path / "here" / "new" / "newer" / "demo"):
        raise error if (tmp_path / "here" / "new" / "newer").is_dir() else AssertionError
    assert os.listdir(tmp_path / "here") == []


def test_parent_folder_created_for_an_output_folder_is_kept_if_it_has_other_files(tmp_path: Path):
    def write_and_fail(folder: Path) -> None:
        with new_folder(folder):
            (tmp_path / "new" / "letter").write_text("dear")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_and_fail(tmp_path / "new" / "newer" / "demo")
    assert os.listdir(tmp_path / "new") == ["letter"]


def test_full_disk_error_names_the_output_folder_and_keeps_its_earlier_content(made: Path):
    with pytest.raises(ConfigError, match="demo: No space left"), new_folder(made, force=True):
        raise OSError(28, "No space left on device")
    assert (made / "result").read_text() == "first"


@pytest.mark.parametrize("mark", [None, b"", b"mine", MARKER_TEXT + b"x", "link", "pipe"])
def test_output_folder_without_the_exact_kinesic_marker_is_never_replaced(tmp_path: Path, mark: bytes | str | None):
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "letter").write_text("dear")
    if mark == "pipe":
        os.mkfifo(folder / MARKER_FILE)
    elif mark == "link":
        (tmp_path / "elsewhere").write_bytes(MARKER_TEXT)
        (folder / MARKER_FILE).symlink_to("../elsewhere")
    elif isinstance(mark, bytes):
        (folder / MARKER_FILE).write_bytes(mark)
    with pytest.raises(ConfigError, match=r"not marked as kinesic's own .*remove it yourself, or name another"):
        check_folder(folder, force=True)
    with pytest.raises(ConfigError, match="not marked"), new_folder(folder, force=True):
        pass
    assert (folder / "letter").read_text() == "dear"
    assert not is_made(folder)


@pytest.mark.parametrize("path", [".", "..", "/", "", "home", "home/..", "work/..", "home/deep/.."])
def test_home_and_working_folders_with_the_kinesic_marker_are_never_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str
):
    home, work = tmp_path / "home", tmp_path / "work" / "now"
    for folder in (home, work, home / "deep"):
        folder.mkdir(parents=True)
    for folder in (tmp_path, home, work, work.parent):
        (folder / MARKER_FILE).write_bytes(MARKER_TEXT)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(work)
    target = Path(path) if path in (".", "..", "/", "") else tmp_path / path
    for force in (False, True):
        with pytest.raises(ConfigError, match=r"is never replaced|may not be written"):
            check_folder(target, force=force)
    with pytest.raises(ConfigError, match=r"is never replaced|may not be written"), new_folder(target, force=True):
        pass
    assert (home / MARKER_FILE).exists()
    assert (work / MARKER_FILE).exists()


def test_empty_home_folder_is_never_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    with pytest.raises(ConfigError, match="is never replaced"):
        check_folder(tmp_path)


def test_empty_existing_folder_may_become_an_output_folder(tmp_path: Path):
    (tmp_path / "empty").mkdir()
    with new_folder(tmp_path / "empty") as fresh:
        (fresh / "result").write_text("first")
    assert (tmp_path / "empty" / "result").exists()


@pytest.mark.parametrize("way", ["demo", "nowhere", "letter"])
def test_output_folder_may_not_be_a_symlink(made: Path, way: str):
    (made.parent / "letter").write_text("dear")
    link = made.parent / "link"
    link.symlink_to(way)
    assert not is_made(link)
    for target in (link, Path(f"{link}/")):
        with pytest.raises(ConfigError, match="is a link, and links are never followed"):
            check_folder(target, force=True)
    assert (made / "result").read_text() == "first"
    assert link.is_symlink()


def test_output_folder_at_or_below_the_path_of_a_file_is_refused(tmp_path: Path):
    (tmp_path / "letter").write_text("dear")
    for target in (tmp_path / "letter", tmp_path / "letter" / "new"):
        with pytest.raises(ConfigError, match=r"letter is (a file|no folder)"):
            check_folder(target, force=True)
    assert (tmp_path / "letter").read_text() == "dear"


def test_replacing_an_output_folder_removes_links_but_not_their_targets(made: Path, tmp_path: Path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter").write_text("dear")
    (made / "folder").symlink_to(tmp_path / "mine")
    (made / "file").symlink_to(tmp_path / "mine" / "letter")
    (made / "deep").mkdir()
    (made / "deep" / "folder").symlink_to(tmp_path / "mine")
    (made / "nothing").symlink_to("nowhere")
    with new_folder(made, force=True):
        pass
    assert os.listdir(made) == [MARKER_FILE]
    assert os.listdir(made.parent) == ["demo"]
    assert (tmp_path / "mine" / "letter").read_text() == "dear"


def test_output_folder_or_link_created_by_another_program_during_writing_is_kept(made: Path, tmp_path: Path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter").write_text("dear")

    def exchange() -> None:
        made.rename(made.parent / "away")
        made.symlink_to(tmp_path / "mine")

    with pytest.raises(ConfigError, match="is a link"), new_folder(made, force=True):
        exchange()
    assert made.is_symlink()
    made.unlink()
    with pytest.raises(ConfigError, match="exists already"), new_folder(made):
        (tmp_path / "mine").rename(made)
    assert (made / "letter").read_text() == "dear"
    assert sorted(os.listdir(made.parent)) == ["away", "demo"]


@pytest.mark.parametrize("kind", ["folder", "link", "file"])
def test_folder_link_or_file_of_another_program_created_after_the_output_check_is_restored(
    made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "letter").write_text("dear")

    def exchange(name: str) -> str:
        made.rename(made.parent / "away")
        match kind:
            case "folder":
                mine.rename(made)
            case "link":
                made.symlink_to(mine)
            case _:
                made.write_text("dear")
        return f".{name}-aside"

    with pytest.raises(ConfigError, match="was replaced by another program meanwhile"), new_folder(made, force=True):
        monkeypatch.setattr(output_folder, "name_beside", exchange)
    assert (made if kind == "file" else made / "letter").read_text() == "dear"
    assert made.is_symlink() == (kind == "link")
    assert sorted(os.listdir(made.parent)) == ["away", "demo"]
    assert (made.parent / "away" / "result").read_text() == "first"


def test_interruption_after_the_replacement_of_an_output_folder_keeps_the_new_folder(
    made: Path, monkeypatch: pytest.MonkeyPatch
):
    rename, calls = os.rename, []

    def interrupt(*arguments: str, **more: int) -> None:
        rename(*arguments, **more)
        calls.append(arguments)
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(os, "rename", interrupt)
    with pytest.raises((KeyboardInterrupt, ConfigError)), new_folder(made, force=True) as fresh:
        (fresh / "result").write_text("second")
    assert (made / "result").read_text() == "second"


def test_parent_folder_replaced_by_link_is_not_followed(made: Path, tmp_path: Path):
    mine = tmp_path / "mine" / "demo"
    mine.mkdir(parents=True)
    (mine / MARKER_FILE).write_bytes(MARKER_TEXT)
    (mine / "letter").write_text("dear")
    with new_folder(made, force=True):
        made.parent.rename(tmp_path / "away")
        made.parent.symlink_to("mine")
    assert (mine / "letter").read_text() == "dear"
    assert os.listdir(tmp_path / "away" / "demo") == [MARKER_FILE]


def test_existing_output_folder_is_kept_without_force(tmp_path: Path):
    with new_folder(tmp_path / "mine") as fresh:
        (fresh / "letter").write_text("dear")
    with pytest.raises(ConfigError, match="exists already; --force"):
        check_folder(tmp_path / "mine")
    with pytest.raises(ConfigError, match="exists already; --force"), new_folder(tmp_path / "mine"):
        pass
    assert (tmp_path / "mine" / "letter").read_text() == "dear"
