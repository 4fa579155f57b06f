"""Documents of clients: kept byte for byte, by plain names, and nothing outside their folder."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.desk.documents import DocumentFolder


def test_what_is_saved_is_read_again(tmp_path):
    folder = DocumentFolder(tmp_path)
    folder.save("a.bml", "one\r\n  two\n")
    folder.save("a.bml", "three\r\n\n")
    assert (tmp_path / "a.bml").read_bytes() == b"three\r\n\n"
    assert (folder.read("a.bml"), folder.names()) == ("three\r\n\n", ("a.bml",))


@pytest.mark.parametrize(
    "name",
    ["../a.bml", "/etc/a.bml", "a/b.bml", "a", ".bml", ".a.bml", "a.bml\n", "a.py", "a.bml.sh", "ä.bml", "a\0.bml"],
)
def test_other_names_are_refused(tmp_path, name):
    folder = DocumentFolder(tmp_path)
    for act in (lambda: folder.read(name), lambda: folder.save(name, "x")):
        with pytest.raises(ConfigError, match="no name of a document"):
            act()


def test_links_and_folders_are_no_documents(tmp_path):
    (tmp_path / "secret").write_text("secret")
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "link.bml").symlink_to(tmp_path / "secret")
    (mine / "folder.bml").mkdir()
    folder = DocumentFolder(mine)
    assert folder.names() == ()
    with pytest.raises(ConfigError, match="no such document"):
        folder.read("link.bml")
    with pytest.raises(ConfigError, match="link"):
        folder.save("link.bml", "x")
    assert (tmp_path / "secret").read_text() == "secret"


def test_without_a_folder_nothing_is_kept():
    with pytest.raises(ConfigError, match="--folder"):
        DocumentFolder(None).save("a.bml", "x")
    assert DocumentFolder(None).names() == ()
