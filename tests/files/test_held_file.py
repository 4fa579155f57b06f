"""Tests of files in an open folder: reading, durable replacement, links."""

import os

import pytest

from kinesic.files.held_file import read_held, replace_held
from kinesic.files.held_folder import hold_folder


def test_replaced_file_has_the_new_content_and_no_temporary_file_is_left(tmp_path):
    with hold_folder(tmp_path) as folder:
        for content in (b"one", b"", b"three"):
            replace_held(folder, "a", content)
            assert read_held(folder, "a", limit=10) == content
        assert read_held(folder, "a", limit=2) == b"th"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_file_is_synced_before_it_replaces_another(tmp_path, monkeypatch):
    (tmp_path / "a").write_text("before")
    seen, sync = [], os.fsync

    def record(descriptor):
        seen.append((os.fstat(descriptor).st_ino, (tmp_path / "a").read_text()))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", record)
    with hold_folder(tmp_path) as folder:
        replace_held(folder, "a", b"after")
    assert seen == [((tmp_path / "a").stat().st_ino, "before"), (tmp_path.stat().st_ino, "after")]


def test_failed_replacement_of_a_file_keeps_the_earlier_file(tmp_path, monkeypatch):
    (tmp_path / "a").write_text("before")

    def fail(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with hold_folder(tmp_path) as folder, pytest.raises(OSError, match="No space"):
        replace_held(folder, "a", b"after")
    assert (tmp_path / "a").read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_links_pipes_and_folders_are_not_read_in_place_of_a_file(tmp_path):
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "link").symlink_to(tmp_path / "secret")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    with hold_folder(tmp_path) as folder:
        assert [read_held(folder, name, limit=9) for name in ("link", "folder", "pipe", "gone")] == [None] * 4
        replace_held(folder, "link", b"mine")
    assert (tmp_path / "secret").read_text() == "secret"
