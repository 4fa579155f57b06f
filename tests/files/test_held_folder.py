import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files import held_folder
from kinesic.files.held_folder import check_above, find_place, hold_folder, name_beside, name_failures


def test_symlinks_in_parent_folders_are_followed_but_a_symlink_at_the_end_of_a_path_is_not(tmp_path: Path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "way").symlink_to("disk")
    assert find_place(tmp_path / "way" / "new") == tmp_path / "disk" / "new"
    assert find_place(tmp_path / "way") == tmp_path / "way"


@pytest.mark.parametrize("path", ["", ".", "./", "/", ".."])
def test_empty_dot_and_root_paths_are_resolved_to_absolute_paths(path: str):
    assert find_place(Path(path)) == Path(path).resolve()


def test_cyclic_links_to_a_folder_give_a_config_error(tmp_path: Path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(ConfigError):
        check_above(find_place(tmp_path / "a" / "new"), tmp_path / "a" / "new")


def test_output_path_below_a_file_is_refused(tmp_path: Path):
    (tmp_path / "letter").write_text("dear")
    with pytest.raises(ConfigError, match="letter is no folder"):
        check_above(tmp_path / "letter" / "new", Path("letter/new"))


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_error_names_an_unwritable_folder(tmp_path: Path):
    (tmp_path / "closed").mkdir(mode=0o500)
    with pytest.raises(ConfigError, match="closed may not be written"):
        check_above(tmp_path / "closed" / "new", Path("closed/new"))


def test_open_folder_refuses_symlinks_and_stays_open_after_renaming(tmp_path: Path):
    (tmp_path / "one").mkdir()
    (tmp_path / "link").symlink_to("one")
    with pytest.raises(OSError, match="link"), hold_folder(tmp_path / "link"):
        pass
    with hold_folder(tmp_path / "one") as held:
        (tmp_path / "one").rename(tmp_path / "other")
        (tmp_path / "one").mkdir()
        os.close(os.open("mine", os.O_CREAT | os.O_WRONLY, dir_fd=held.descriptor))
    assert os.listdir(tmp_path / "other") == ["mine"]


def test_folder_entries_are_reached_by_path_on_systems_without_folder_descriptors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(held_folder, "HAS_FOLDER_DESCRIPTORS", False)
    (tmp_path / "one").mkdir()
    (tmp_path / "link").symlink_to("one")
    with pytest.raises(NotADirectoryError, match="link"), hold_folder(tmp_path / "link"):
        pass
    with hold_folder(tmp_path) as outer, hold_folder("one", inside=outer) as held:
        os.close(held.open_entry("a", os.O_CREAT | os.O_WRONLY))
        held.rename_entry("a", "b")
        assert held.names() == ["b"]
        assert held.entry_status("b").st_size == 0
        held.remove_entry("b")
        os.mkdir(held.entry_path("old"))
        os.mkdir(held.entry_path("new"))
        held.rename_entry("old", "new")
        assert os.listdir(tmp_path / "one") == ["new"]


def test_renaming_in_an_open_folder_changes_nothing_in_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for folder in ("here/new", "there/old"):
        (tmp_path / folder).mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    with hold_folder(tmp_path / "there") as held:
        held.rename_entry("old", "new")
    assert [sorted(path.name for path in (tmp_path / name).iterdir()) for name in ("here", "there")] == [["new"]] * 2


def test_temporary_file_name_is_hidden_and_unique_and_keeps_the_suffix():
    names = {name_beside("motion.npz") for _ in range(100)}
    assert len(names) == 100
    assert all(name.startswith(".motion-") and name.endswith(".npz") for name in names)
    assert len(name_beside("x" * 250)) < 255


def test_file_system_error_names_the_users_path():
    with pytest.raises(ConfigError, match=r"^out/mine: No space left on device$"), name_failures(Path("out/mine")):
        raise OSError(28, "No space left on device", "/elsewhere/.mine-12")


# file names of almost the maximum length, or with unencodable characters
LONG_NAMES = ("a" * 251 + ".bml", "\N{GRINNING FACE}" * 62 + ".bml", "a." + "b" * 253, "\udc80.bml")


@pytest.mark.parametrize("name", LONG_NAMES, ids=range(len(LONG_NAMES)))
def test_temporary_file_name_of_a_long_name_is_valid(tmp_path: Path, name: str):
    beside = name_beside(name)
    (tmp_path / beside).write_text("x")
    assert len(beside.encode()) <= 255
    assert beside.startswith(".")
