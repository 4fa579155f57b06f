"""Client documents: exact content, plain names, no access outside the folder."""

import os

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.desk.archive import ARCHIVE_NAME
from kinesic.serve.desk.documents import MAX_DOCUMENT_SIZE, MAX_LISTED_NAMES, DocumentFolder, RevisionError


def test_saved_document_is_read_back_byte_for_byte(tmp_path):
    folder = DocumentFolder(tmp_path)
    folder.save("a.bml", "one\r\n  two\n")
    folder.save("a.bml", "three\r\n\n")
    assert (tmp_path / "a.bml").read_bytes() == b"three\r\n\n"
    assert (folder.read("a.bml").text, folder.list().names) == ("three\r\n\n", ("a.bml",))


@pytest.mark.parametrize(
    "name",
    [
        "con.bml",
        "NUL.bml",
        "Aux.toml",
        "com1.bml",
        "LPT9.toml",
        "../a.bml",
        "/etc/a.bml",
        "a/b.bml",
        "a",
        ".bml",
        ".a.bml",
        "a.bml\n",
        "a.py",
        "a.bml.sh",
        "ä.bml",
        "a\0.bml",
    ],
)
def test_invalid_document_names_are_refused(tmp_path, name):
    folder = DocumentFolder(tmp_path)
    for act in (lambda: folder.read(name), lambda: folder.save(name, "x")):
        with pytest.raises(ConfigError, match="not a document name"):
            act()


def test_links_and_folders_are_not_read_as_documents(tmp_path):
    (tmp_path / "secret").write_text("secret")
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "link.bml").symlink_to(tmp_path / "secret")
    (mine / "folder.bml").mkdir()
    folder = DocumentFolder(mine)
    os.mkfifo(mine / "pipe.bml")
    assert folder.list().names == ()
    for name in ("link.bml", "pipe.bml", "folder.bml"):
        with pytest.raises(ConfigError, match="no such document"):
            folder.read(name)
        assert folder.read_present(name) == ""
    assert folder.read_present("gone.bml") is None
    with pytest.raises(ConfigError, match="link"):
        folder.save("link.bml", "x")
    assert (tmp_path / "secret").read_text() == "secret"


def test_saving_a_document_without_a_configured_folder_is_refused():
    with pytest.raises(ConfigError, match="--folder"):
        DocumentFolder(None).save("a.bml", "x")
    assert DocumentFolder(None).list().names == ()


def test_document_size_and_listing_length_are_limited(tmp_path):
    for number in range(MAX_LISTED_NAMES + 1):
        (tmp_path / f"d{number:04}.bml").touch()
    folder = DocumentFolder(tmp_path)
    results = folder.list()
    assert (len(results.names), results.is_whole) == (MAX_LISTED_NAMES, False)
    with pytest.raises(ConfigError, match=r"d0019\.bml and 980 more"):
        folder.read("gone.bml")
    (tmp_path / "d0000.bml").write_text("x" * (MAX_DOCUMENT_SIZE + 1))
    with pytest.raises(ConfigError, match="more than 1000000 bytes"):
        folder.read("d0000.bml")


def test_saving_a_document_preserves_its_file_permissions(tmp_path):
    folder = DocumentFolder(tmp_path)
    for name, mode in (("private.bml", 0o600), ("kept.bml", 0o444)):
        (tmp_path / name).write_text("before")
        (tmp_path / name).chmod(mode)
    folder.save("private.bml", "after")
    assert (tmp_path / "private.bml").stat().st_mode & 0o777 == 0o600
    with pytest.raises(ConfigError, match="read-only"):
        folder.save("kept.bml", "after")
    assert (tmp_path / "kept.bml").read_text() == "before"


def test_saved_document_is_synced_to_disk(tmp_path, monkeypatch):
    synced, sync = [], os.fsync

    def record(descriptor):
        synced.append(os.fstat(descriptor).st_ino)
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", record)
    DocumentFolder(tmp_path).save("a.bml", "x")
    assert synced == [(tmp_path / "a.bml").stat().st_ino, tmp_path.stat().st_ino]


def test_document_listing_omits_windows_device_names(tmp_path):
    for name in ("con.bml", "console.bml", "NUL.toml"):
        (tmp_path / name).touch()
    assert DocumentFolder(tmp_path).list().names == ("console.bml",)


def test_earlier_text_of_a_replaced_document_is_kept_as_a_version(tmp_path):
    folder = DocumentFolder(tmp_path)
    for text in ("one", "two", "two", "three"):
        folder.save("a.bml", text)
    assert [version.number for version in folder.list_versions("a.bml")] == [2, 1]
    assert [folder.read_version("a.bml", number) for number in (1, 2)] == ["one", "two"]
    assert folder.list_versions("a.toml") == ()


def test_existing_document_is_replaced_only_by_a_request_with_its_current_revision(tmp_path):
    folder = DocumentFolder(tmp_path)
    revision = folder.save("a.bml", "one", "")
    assert folder.read("a.bml").revision == revision
    for wrong, why in (("", "exists already"), ("0" * 16, "was changed by another program")):
        with pytest.raises(RevisionError, match=why):
            folder.save("a.bml", "two", wrong)
        with pytest.raises(RevisionError, match=why):
            folder.check_revision("a.bml", wrong)
    assert folder.read("a.bml").text == "one"
    assert folder.save("a.bml", "two", revision) != revision
    (tmp_path / "a.bml").unlink()
    folder.save("a.bml", "three", revision)  # nothing can be lost
    assert folder.read("a.bml").text == "three"


def test_document_too_large_to_be_kept_as_a_version_is_not_replaced(tmp_path):
    (tmp_path / "a.bml").write_text("x" * (MAX_DOCUMENT_SIZE + 1))
    with pytest.raises(ConfigError, match="is not replaced"):
        DocumentFolder(tmp_path).save("a.bml", "mine")
    assert len((tmp_path / "a.bml").read_text()) == MAX_DOCUMENT_SIZE + 1


def test_document_is_not_replaced_if_its_version_cannot_be_kept(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / ARCHIVE_NAME).symlink_to(tmp_path / "elsewhere")
    folder = DocumentFolder(tmp_path)
    folder.save("a.bml", "one")
    with pytest.raises(ConfigError, match="remove it, or choose another --folder"):
        folder.save("a.bml", "two")
    assert folder.read("a.bml").text == "one"
    assert not list((tmp_path / "elsewhere").iterdir())


def test_document_with_a_lone_surrogate_is_refused_and_the_saved_document_kept(tmp_path):
    folder = DocumentFolder(tmp_path)
    folder.save("a.bml", "x")
    with pytest.raises(ConfigError, match=r"a\.bml: character 4 is not a Unicode character"):
        folder.save("a.bml", "late\udcff")
    assert folder.read("a.bml").text == "x"
    assert folder.list_versions("a.bml") == ()
