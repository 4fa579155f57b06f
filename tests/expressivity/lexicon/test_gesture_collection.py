"""Installation of shared collections of gestures."""

import stat
from pathlib import Path
from zipfile import ZIP_BZIP2, ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

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


def test_zip_of_an_imported_folder_with_its_marker_file_is_installed(folder, tmp_path):
    packed = archive(tmp_path / "a.zip", folder, top="mine/", **{"mine/.kinesic": b"made by kinesic"})
    place, _, count = install_collection(packed, tmp_path / "library")
    assert count == 1
    assert (place / ".kinesic").read_bytes() != b"made by kinesic"


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


@pytest.mark.parametrize("is_packed", [False, True])
def test_gesture_collection_of_exactly_the_largest_number_and_size_is_installed(
    folder, tmp_path, monkeypatch, is_packed
):
    (folder / "notes.exe").unlink()
    sizes = [path.stat().st_size for path in folder.iterdir()]
    source = archive(tmp_path / "a.zip", folder) if is_packed else folder
    monkeypatch.setattr(gesture_collection, "MAX_FILES", len(sizes) + (0 if is_packed else 1))
    monkeypatch.setattr(gesture_collection, "MAX_ARCHIVE_SIZE", sum(sizes))
    assert install_collection(source, tmp_path / "library")[2] == 1
    monkeypatch.setattr(gesture_collection, "MAX_ARCHIVE_SIZE", sum(sizes) - 1)
    with pytest.raises(ConfigError, match="files and 0 MB"):
        install_collection(source, tmp_path / "other")


def test_gesture_collection_has_at_most_5000_files_and_200_megabytes(folder, tmp_path, monkeypatch):
    assert (gesture_collection.MAX_FILES, gesture_collection.MAX_ARCHIVE_SIZE) == (5000, 200_000_000)
    monkeypatch.setattr(gesture_collection, "MAX_FILES", 1)
    with pytest.raises(ConfigError, match="at most 1 files and 200 MB"):
        install_collection(folder, tmp_path / "library")


def test_library_folder_that_is_itself_a_collection_is_found_but_not_removable(folder, tmp_path):
    assert find_collections(folder) == (folder,)
    with pytest.raises(ConfigError, match="no collection 'made'; it has none"):
        remove_collection("made", folder)
    with pytest.raises(ConfigError, match=r"no collection of gestures; `kinesic capture import`"):
        find_collections(tmp_path / "nothing")


def test_collections_of_a_library_are_in_the_order_of_their_names(tmp_path):
    for name in ("b", "a", "c"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "card.toml").write_text(CARD)
    (tmp_path / "d" / "card.toml").mkdir(parents=True)
    assert [path.name for path in find_collections(tmp_path)] == ["a", "b", "c"]
    with pytest.raises(ConfigError, match="no collection 'd'; it has a, b, c"):
        remove_collection("d", tmp_path)


@pytest.mark.parametrize(
    ("card", "name"),
    [
        (CARD.replace("My gestures", "../up"), "up"),
        (CARD.replace("My gestures", "con"), "con_"),
        (CARD.replace('name = "My gestures"', 'name="a"'), "a"),
        ("# a remark\n" + CARD, "My_gestures"),
        (CARD.replace("My gestures", "😀"), "gestures"),
    ],
)
def test_folder_of_an_installed_collection_has_a_plain_name(folder, tmp_path, card, name):
    (folder / "card.toml").write_text(card, encoding="utf-8")
    place, _, _ = install_collection(folder, tmp_path / "library")
    assert place == tmp_path / "library" / name


def test_gesture_collection_without_a_card_or_gestures_is_refused(folder, tmp_path):
    (folder / "swing.toml").write_text('category = "beat"\n')
    with pytest.raises(ConfigError, match="made: it has no gestures"):
        install_collection(folder, tmp_path / "library")
    (folder / "card.toml").write_text('licence = "CC0"\n')
    with pytest.raises(ConfigError, match=r"made: card.toml has no name"):
        install_collection(folder, tmp_path / "library")
    (folder / "card.toml").unlink()
    with pytest.raises(ConfigError, match=r"made: it has no card.toml with name, licence and source"):
        install_collection(folder, tmp_path / "library")
    assert not (tmp_path / "library").exists()


def test_installed_collection_contains_gestures_and_licences_but_no_other_files(folder, tmp_path):
    names = ["LICENSE", "LICENCE.txt", "NOTICE.md", "README"]
    for name in (*names, "licence", ".hidden.toml", "a b.toml", "x" * 81 + ".toml"):
        (folder / name).write_text("free")
    place, _, _ = install_collection(folder, tmp_path / "library")
    found = {path.name for path in place.iterdir()}
    assert found == {*names, ".kinesic", "card.toml", "swing.npz", "swing.toml"}
    assert (place / "NOTICE.md").read_text() == "free"


def test_file_of_a_collection_folder_that_is_too_large_or_a_link_out_of_it_is_refused(folder, tmp_path, monkeypatch):
    (folder / "LICENSE").symlink_to(tmp_path / "none")
    with pytest.raises(ConfigError, match="LICENSE"):
        install_collection(folder, tmp_path / "library")
    (folder / "LICENSE").unlink()
    monkeypatch.setattr(gesture_collection, "MAX_MOTION_FILE_SIZE", 10)
    with pytest.raises(ConfigError, match="at most 10 are read"):
        install_collection(folder, tmp_path / "library")


@pytest.mark.parametrize(
    ("entries", "problem"),
    [
        ({"a/x.toml": b"", "b/y.toml": b""}, "must lie in one folder"),
        ({"a/b/x.toml": b""}, "must lie in one folder"),
        ({"x.toml": b"", "X.toml": b""}, "two files are named X.toml"),
        ({"x" * 80 + ".py": b""}, f"unexpected file '{'x' * 60}'; only .toml, .npz and licences"),
        ({"x.tom": b""}, "unexpected file 'x.tom'"),
        ({"a\\x.toml": b""}, "unexpected file"),
        ({"/x.toml": b""}, "must lie in one folder|unexpected file"),
        ({"con.toml": b""}, "unexpected file 'con.toml'"),
    ],
)
def test_archive_entry_with_a_doubtful_name_is_refused_with_the_reason(tmp_path, entries, problem):
    with ZipFile(tmp_path / "a.zip", "w") as file:
        for name, data in entries.items():
            file.writestr(ZipInfo(name), data)
    with pytest.raises(ConfigError, match=rf"a.zip: .*{problem}"):
        install_collection(tmp_path / "a.zip", tmp_path / "library")


def test_archive_entry_of_exactly_the_largest_size_is_read(folder, tmp_path, monkeypatch):
    largest = max(path.stat().st_size for path in folder.iterdir())
    source = archive(tmp_path / "a.zip", folder)
    monkeypatch.setattr(gesture_collection, "MAX_MOTION_FILE_SIZE", largest)
    assert install_collection(source, tmp_path / "library")[2] == 1
    monkeypatch.setattr(gesture_collection, "MAX_MOTION_FILE_SIZE", largest - 1)
    with pytest.raises(ConfigError, match=f"has {largest} bytes; at most {largest - 1} are read"):
        install_collection(source, tmp_path / "other")


@pytest.mark.parametrize(("method", "is_read"), [(ZIP_STORED, True), (ZIP_DEFLATED, True), (ZIP_BZIP2, False)])
def test_archive_packed_by_another_method_than_deflate_is_refused(folder, tmp_path, method, is_read):
    with ZipFile(tmp_path / "a.zip", "w", method) as file:
        for path in folder.glob("*.[tn]*[lz]"):
            file.write(path, path.name)
    if is_read:
        assert install_collection(tmp_path / "a.zip", tmp_path / "library")[2] == 1
        return
    with pytest.raises(ConfigError, match="is encrypted or packed by another method"):
        install_collection(tmp_path / "a.zip", tmp_path / "library")


def test_encrypted_archive_is_refused(folder, tmp_path):
    data = bytearray(archive(tmp_path / "a.zip", folder).read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    (tmp_path / "a.zip").write_bytes(data)
    with pytest.raises(ConfigError, match="is encrypted or packed"):
        install_collection(tmp_path / "a.zip", tmp_path / "library")


def test_folders_in_an_archive_are_no_files(folder, tmp_path):
    source = archive(tmp_path / "a.zip", folder, top="mine/")
    with ZipFile(source, "a") as file:
        file.mkdir("mine/empty") if hasattr(file, "mkdir") else file.writestr("mine/empty/", b"")
    assert install_collection(source, tmp_path / "library")[2] == 1
