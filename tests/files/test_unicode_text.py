"""Text with lone surrogates: refused or escaped."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.files.output_file import write_text
from kinesic.files.unicode_text import check_encodable, escape_surrogates


@pytest.mark.parametrize("text", ["", "Grüße \N{GRINNING FACE}", "\0"])
def test_text_without_lone_surrogates_is_accepted_and_unchanged(text):
    check_encodable(text, place="x")
    assert escape_surrogates(text) == text


def test_lone_surrogate_is_refused_with_its_place_and_escaped_on_request():
    with pytest.raises(ConfigError, match=r"^tea\.bml: character 3 is not a Unicode character; remove it$"):
        check_encodable("abc\udcff", place="tea.bml")
    assert escape_surrogates("abc\udcff\ud800") == r"abc\udcff\ud800"


def test_file_whose_new_text_has_a_lone_surrogate_keeps_its_old_text(tmp_path):
    path = tmp_path / "tea.bml"
    write_text(path, "old")
    with pytest.raises(ConfigError, match=r"tea\.bml: character 0 is not a Unicode character"):
        write_text(path, "\udcff", force=True)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["tea.bml"]
