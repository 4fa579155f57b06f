"""Installation of shared collections of gestures."""

import stat
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon import gesture_collection
from kinesic.expressivity.lexicon.gesture_collection import find_collections, install_collection, remove_collection
from kinesic.session.setup import set_up

from .captured_clips import write_gesture

CARD = 'name = "My gestures"\nlicence = "CC0"\nsource = "a lab"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write a collection of one gesture."""
    made = tmp_path / "made"
    made.mkdir()
    (made / "card.toml").write_text(CARD)
    (made / "notes.exe").write_bytes(b"left behind")
    return write_gesture(made)


def archive(path: Path, folder: Path, *, top: str = "", **more: bytes) -> Path:
    """Write a zip archive of a collection, with the given additional entries."""
    with ZipFile(path, "w", ZIP_DEFLATED) as file:
        for source in folder.glob("*.[tn]*[lz]"):
            file.write(source, top + source.name)
        for name, data in more.items():
            file.writestr(name, data)
    return path


@pytest.mark.parametrize("top", ["", "mine/"])
def test_gesture_collection_is_installed_from_a_folder_or_zip_file_and_removed(folder, tmp_path, top):
    library = tmp_path / "library"
    place, card, count = install_collection(folder, library)
    assert (place, card.licence, count) == (library / "My_gestures", "CC0", 1)
    assert sorted(path.name for path in place.iterdir()) == [".kinesic", "card.toml", "swing.npz", "swing.toml"]
    with pytest.raises(ConfigError, match="exists already"):
        install_collection(folder, library)
    install_collection(archive(tmp_path / "a.zip", folder, top=top), library, force=True)
    assert find_collections(library) == (place,)
    assert "swing" in set_up("upper22", library=library).lexicon.forms_by_id
    assert remove_collection("My_gestures", library) == place
    assert not place.exists()
    with pytest.raises(ConfigError, match="no collection"):
        set_up("upper22", library=library)


def test_folder_not_created_by_kinesic_is_not_removed_as_a_gesture_collection(folder, tmp_path):
    with pytest.raises(ConfigError, match="not marked"):
        remove_collection("made", tmp_path)
    with pytest.raises(ConfigError, match="no collection 'other'"):
        remove_collection("other", tmp_path)
    assert (folder / "swing.npz").exists()


@pytest.mark.parametrize(
    "name",
    ["../evil.toml", "/evil.toml", "a/../evil.toml", "..\\evil.toml", "evil.py", ".bashrc", "nul.toml", "b/c/d.toml"],
)
def test_gesture_collection_archive_with_an_unexpected_path_is_refused(folder, tmp_path, name):
    hostile = archive(tmp_path / "a.zip", folder, **{name: b"x"})
    with pytest.raises(ConfigError):
        install_collection(hostile, tmp_path / "library")
    assert not (tmp_path / "library").exists()
    assert not (tmp_path / "evil.toml").exists()


def test_gesture_collection_archive_with_a_symlink_is_refused(folder, tmp_path):
    path = archive(tmp_path / "a.zip", folder)
    link = ZipInfo("link.toml")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with ZipFile(path, "a") as file:
        file.writestr(link, "/etc/passwd")
    with pytest.raises(ConfigError, match="is a link"):
        install_collection(path, tmp_path / "library")


def test_gesture_collection_archive_that_unpacks_beyond_the_size_limit_is_refused(folder, tmp_path):
    bomb = archive(tmp_path / "a.zip", folder, **{"big.npz": bytes(9_000_000)})
    with pytest.raises(ConfigError, match="at most"):
        install_collection(bomb, tmp_path / "library")


def test_damaged_gesture_collection_archive_and_invalid_gestures_are_refused(folder, tmp_path):
    data = archive(tmp_path / "a.zip", folder).read_bytes()
    for damaged in (b"", b"PK", data[:-30], data[:40] + bytes(40) + data[80:]):
        (tmp_path / "b.zip").write_bytes(damaged)
        with pytest.raises(ConfigError):
            install_collection(tmp_path / "b.zip", tmp_path / "library")
    (folder / "swing.npz").unlink()
    with pytest.raises(ConfigError, match=r"swing\.npz"):
        install_collection(folder, tmp_path / "library")
    assert not (tmp_path / "library").exists()


@pytest.mark.parametrize("card", ["", 'name = "a"\n', CARD.replace("CC0", " "), CARD + "more = 1\n"])
def test_gesture_collection_without_name_licence_or_source_is_refused(folder, tmp_path, card):
    (folder / "card.toml").write_text(card)
    with pytest.raises(ConfigError):
        install_collection(folder, tmp_path / "library")


@pytest.mark.parametrize("is_packed", [False, True])
def test_gesture_collection_with_too_many_files_is_refused(folder, tmp_path, monkeypatch, is_packed):
    count = len(list(folder.glob("*.[tn]*[lz]")))
    source = archive(tmp_path / "a.zip", folder) if is_packed else folder
    monkeypatch.setattr(gesture_collection, "MAX_FILES", count - 1)
    with pytest.raises(ConfigError, match=f"at most {count - 1} files and"):
        install_collection(source, tmp_path / "library")
    assert not (tmp_path / "library").exists()
