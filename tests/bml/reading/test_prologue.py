"""The first tag of a document."""

import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.bml.reading.prologue import first_tag

from ...growth import STRAIGHT, growth

COMMENTS = "<!---->" * 60 + '<bml id="b"><head id="h" lexeme="NOD"/></bml>'


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("<bml>", "bml"),
        ("  \n<my-1.0:FML-APML\n", "fml-apml"),
        ('<?xml version="1.0"?> <!-- <bml> --><!-- > --> <!doctype bml SYSTEM "a"><bml/>', "bml"),
        ("<!--><bml/>--><head/>", "head"),
        ("<?><bml/>?><head/>", "head"),
        ("<!-- <bml/>", ""),
        ("<?xml <bml/>", ""),
        ("<!-- -->hello <bml/>", ""),
        ("hello <bml/>", ""),
        ("<bml", ""),
        ("<:bml/>", ""),
        ("< bml/>", ""),
        ("", ""),
    ],
)
def test_the_first_tag_stands_behind_whatever_may_go_before_a_root(text: str, name: str) -> None:
    assert first_tag(text) == name


@pytest.mark.parametrize("piece", ["<!---->", "<??>", "<?", "<!--", "<!DOCTYPE>", " ", "<a:", "<", "<!-- ", "a"])
def test_twice_as_long_a_text_takes_at_most_twice_as_long(piece: str) -> None:
    assert growth(first_tag, lambda size: size * piece) < STRAIGHT


VERBS = """
from kinesic.cli import kinesic
for words in (["plan", "many.bml"], ["validate", "."]):
    kinesic.main(words, standalone_mode=False)
print("both ended")
"""


def test_a_document_behind_many_comments_is_read_at_once(tmp_path: Path) -> None:
    (tmp_path / "many.bml").write_text(COMMENTS)
    (tmp_path / "many.txt").write_text("<!---->" * 60)  # a folder's file, which is looked into
    command = [sys.executable, "-c", VERBS]
    done = subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.stdout.endswith("both ended\n"), done.stderr
