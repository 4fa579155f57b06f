"""Tests of the search for a document's first tag behind a prologue."""

import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.bml.reading.prologue import find_first_tag

from ...growth import LINEAR_GROWTH_LIMIT, growth

COMMENTED_DOCUMENT = "<!---->" * 60 + '<bml id="b"><head id="h" lexeme="NOD"/></bml>'  # document behind 60 comments


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
def test_first_tag_is_found_behind_an_xml_prologue_but_not_behind_text(text: str, name: str) -> None:
    assert find_first_tag(text) == name


@pytest.mark.parametrize("piece", ["<!---->", "<??>", "<?", "<!--", "<!DOCTYPE>", " ", "<a:", "<", "<!-- ", "a"])
def test_search_for_the_first_tag_takes_linear_time(piece: str) -> None:
    assert growth(find_first_tag, lambda size: size * piece) < LINEAR_GROWTH_LIMIT


# program that plans and validates a document
READ_DOCUMENT_SCRIPT = """
from kinesic.cli import kinesic
for words in (["plan", "many.bml"], ["validate", "."]):
    kinesic.main(words, standalone_mode=False)
print("both ended")
"""


def test_document_behind_many_comments_is_read_within_a_minute(tmp_path: Path) -> None:
    (tmp_path / "many.bml").write_text(COMMENTED_DOCUMENT)
    (tmp_path / "many.txt").write_text("<!---->" * 60)  # file in a folder argument
    command = [sys.executable, "-c", READ_DOCUMENT_SCRIPT]
    done = subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.stdout.endswith("both ended\n"), done.stderr
