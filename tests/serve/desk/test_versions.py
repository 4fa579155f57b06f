"""Versions of documents: the last ten, each content once."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.desk.archive import ARCHIVE_NAME
from kinesic.serve.desk.versions import MAX_VERSIONS, VersionFolder


@pytest.fixture
def versions(tmp_path):
    return VersionFolder(tmp_path, max_size=100)


def test_last_ten_versions_of_each_document_are_kept(versions, tmp_path):
    versions.keep("other.bml", b"other")
    for number in range(1, MAX_VERSIONS + 4):
        versions.keep("tea.bml", f"text {number}".encode())
    listed = versions.list("tea.bml")
    assert [version.number for version in listed] == list(range(13, 3, -1))
    assert versions.read("tea.bml", 13) == "text 13"
    assert versions.read("other.bml", 1) == "other"
    names = {path.name for path in (tmp_path / ARCHIVE_NAME).iterdir()}
    assert names == {"other.0001.bml", *(f"tea.{number:04d}.bml" for number in range(4, 14))}


def test_content_equal_to_the_last_version_adds_no_version(versions):
    for content in (b"a", b"a", b"b", b"a"):
        versions.keep("tea.bml", content)
    assert len(versions.list("tea.bml")) == 3


def test_documents_with_similar_names_have_separate_versions(versions):
    for name in ("tea.bml", "tea.toml", "tea-2.bml", "Tea.bml"):
        versions.keep(name, name.encode())
    for name in ("tea.bml", "tea.toml", "tea-2.bml", "Tea.bml"):
        assert [versions.read(name, version.number) for version in versions.list(name)] == [name]


def test_missing_document_version_is_refused_with_the_existing_version_numbers(versions):
    with pytest.raises(ConfigError, match="no version 1; there are: none"):
        versions.read("tea.bml", 1)
    versions.keep("tea.bml", b"x")
    with pytest.raises(ConfigError, match="no version 2; there are: 1"):
        versions.read("tea.bml", 2)


def test_symlink_in_the_archive_is_not_read_as_a_version_of_a_document(versions, tmp_path):
    versions.keep("tea.bml", b"x")
    (tmp_path / "secret").write_text("secret")
    (tmp_path / ARCHIVE_NAME / "tea.0002.bml").symlink_to(tmp_path / "secret")
    with pytest.raises(ConfigError, match="no version 2"):
        versions.read("tea.bml", 2)
    versions.keep("tea.bml", b"y")
    assert versions.read("tea.bml", 3) == "y"
    assert (tmp_path / "secret").read_text() == "secret"
