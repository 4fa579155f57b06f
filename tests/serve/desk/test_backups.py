"""Backups of unsaved documents: exact text, fixed file names, the newest twenty."""

import os

import pytest

from kinesic.body.config import ConfigError
from kinesic.files.held_folder import name_beside
from kinesic.serve.desk import backups as module
from kinesic.serve.desk.archive import ARCHIVE_NAME, MIN_ABANDONED_AGE
from kinesic.serve.desk.backups import BACKUP_FILES, MAX_BACKUPS, MAX_TEXT_SIZE, BackupFolder, Header


@pytest.fixture
def backups(tmp_path, monkeypatch):
    times = iter(range(1000))
    monkeypatch.setattr(module, "unix_time", lambda: float(next(times)))
    return BackupFolder(tmp_path)


def test_backup_keeps_the_exact_text_with_key_file_name_revision_and_time(backups):
    for text in ("", "\n", "first line\r\n\n\ttab \N{GREEK SMALL LETTER ALPHA}\n", '{"key": "b"}\n'):
        backups.keep("a", "tea.bml", "r1", text)
        assert backups.read("a").text == text
    assert backups.read("a").header == Header("a", "tea.bml", "r1", 3.0)


def test_backup_has_the_time_that_its_client_sent(backups):
    backups.keep("a", "tea.bml", "r1", "x", time=12.5)
    assert [header.time for header in backups.list()] == [12.5]


def test_later_backup_of_the_same_document_replaces_the_earlier_one(backups, tmp_path):
    for text in ("one", "two"):
        backups.keep("a", "tea.bml", "", text)
    backups.keep("b", "tea.bml", "", "other")
    assert [header.key for header in backups.list()] == ["b", "a"]
    assert {path.name for path in (tmp_path / ARCHIVE_NAME).iterdir()} == set(BACKUP_FILES[:2])
    backups.discard("a")
    backups.discard("a")
    assert [header.key for header in backups.list()] == ["b"]
    with pytest.raises(ConfigError, match="no backup 'a'"):
        backups.read("a")


def test_backup_beyond_the_maximum_number_replaces_the_oldest(backups):
    for number in range(MAX_BACKUPS):
        backups.keep(f"k{number}", "tea.bml", "", "x")
    backups.keep("k0", "tea.bml", "", "newer")
    backups.keep("more", "tea.bml", "", "x")
    keys = [header.key for header in backups.list()]
    assert keys[:2] == ["more", "k0"]
    assert len(keys) == MAX_BACKUPS
    assert "k1" not in keys


def test_invalid_backup_files_are_skipped_and_replaced(backups, tmp_path):
    backups.keep("a", "tea.bml", "", "x")
    archive = tmp_path / ARCHIVE_NAME
    (archive / BACKUP_FILES[1]).write_bytes(b"\xff no header")
    (tmp_path / "secret").write_text('{"key": "s", "name": "", "revision": "", "time": 0}\nsecret')
    (archive / BACKUP_FILES[2]).symlink_to(tmp_path / "secret")
    assert [header.key for header in backups.list()] == ["a"]
    for key in ("b", "c"):
        backups.keep(key, "tea.bml", "", key)
    assert {header.key for header in backups.list()} == {"a", "b", "c"}
    assert "secret" in (tmp_path / "secret").read_text()


def test_earlier_backup_of_a_document_survives_a_failed_write(backups, monkeypatch):
    backups.keep("a", "tea.bml", "", "one")

    def fail(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(ConfigError, match="No space left"):
        backups.keep("a", "tea.bml", "", "two")
    monkeypatch.undo()
    assert backups.read("a").text == "one"


def test_temporary_backup_files_are_removed_if_older_than_an_hour(backups, tmp_path):
    backups.keep("a", "tea.bml", "", "x")
    old, new = (tmp_path / ARCHIVE_NAME / name_beside("backup_02.txt") for _ in range(2))
    for path in (old, new):
        path.touch()
    age = new.stat().st_mtime - 2 * MIN_ABANDONED_AGE
    os.utime(old, (age, age))
    backups.list()
    assert not old.exists()
    assert new.exists()


def test_backup_of_a_text_beyond_the_size_limit_is_refused(backups):
    with pytest.raises(ConfigError, match="limit for backups"):
        backups.keep("a", "tea.bml", "", "x" * (MAX_TEXT_SIZE + 1))


def test_listing_backups_without_a_document_folder_raises_an_error_naming_the_folder_option():
    with pytest.raises(ConfigError, match="--folder"):
        BackupFolder(None).list()


@pytest.mark.parametrize("field", ["key", "name", "revision", "text"])
def test_backup_with_a_lone_surrogate_is_refused_and_the_earlier_backup_kept(backups, field):
    fields = {"key": "a", "name": "tea.bml", "revision": "r1", "text": "x"}
    backups.keep(**fields)
    with pytest.raises(ConfigError, match=f"the {field} of the backup: character 1 is not a Unicode character"):
        backups.keep(**fields | {field: "a\udcff"})
    assert [header.key for header in backups.list()] == ["a"]
    assert backups.read("a").text == "x"
