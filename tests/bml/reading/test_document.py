"""Notations of a document, and how they are told apart."""

import pytest

from kinesic.bml.block import BmlError, Bounds
from kinesic.bml.reading.document import read_document

INSIDE = '<head id="h" lexeme="NOD"/>'


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        (f'<bml id="b">{INSIDE}</bml>', "none"),
        (f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{INSIDE}</bml>', "bml-1.0"),
        (f'<bml xmlns="http://www.mindmakers.org/projects/BML" id="b">{INSIDE}</bml>', "draft"),
        (f'<fml-apml><fml/><bml id="b">{INSIDE}</bml></fml-apml>', "fml-apml"),
        (f'<head><bml id="b">{INSIDE}</bml></head>', "none"),
        (f"  {INSIDE}", "smartbody"),
        (f"<!-- nod -->{INSIDE}", "smartbody"),
        ('[{"type": "head"}]', "json"),
        ('\n {"data": []}', "json"),
    ],
)
@pytest.mark.parametrize("encoding", [None, "utf-8", "utf-8-sig"])
def test_the_notation_shows(text: str, dialect: str, encoding: str | None) -> None:
    document = read_document(text if encoding is None else text.encode(encoding), source="f")
    assert document.dialect == dialect
    assert document.bml.local == "bml"


def test_other_encodings_are_those_of_xml() -> None:
    text = f'<?xml version="1.0" encoding="UTF-16"?><bml id="b">{INSIDE}</bml>'
    assert read_document(text.encode("utf-16"), source="f").dialect == "none"
    latin = '<?xml version="1.0" encoding="latin-1"?><bml id="é"/>'
    assert read_document(latin.encode("latin-1"), source="f").bml.attributes["id"] == "é"


@pytest.mark.parametrize("text", [f'<bml id="b">{INSIDE}</bml>', INSIDE, '[{"type": "head", "lexeme": "NOD"}]'])
def test_what_is_too_large_is_refused_in_every_notation(text: str) -> None:
    with pytest.raises(BmlError, match=r"^f:1:1: the document has \d+ characters; at most 20 are read"):
        read_document(text, source="f", bounds=Bounds(size=20))


@pytest.mark.parametrize("text", [f'<bml id="b">{3 * INSIDE}</bml>', 5 * INSIDE, "[" + ",".join(99 * "1") + "]"])
def test_what_has_too_many_parts_is_refused_in_every_notation(text: str) -> None:
    with pytest.raises(BmlError, match=r"^f:1:\d+: more than \d+ (elements|values); split the document"):
        read_document(text, source="f", bounds=Bounds(elements=3))


@pytest.mark.parametrize("text", [f"<head><a>{INSIDE}</a></head>", '[{"type": "a", "b": {"c": [{}]}}]'])
def test_what_is_too_deep_is_refused_in_every_notation(text: str) -> None:
    with pytest.raises(BmlError, match=r"inside one another; at most 3 are read"):
        read_document(text, source="f", bounds=Bounds(depth=3))
