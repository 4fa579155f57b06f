"""Tests of notation detection and document limits."""

import pytest

from kinesic.bml.block import BmlError, DocumentBounds
from kinesic.bml.reading.document import read_document

HEAD_ELEMENT = '<head id="h" lexeme="NOD"/>'


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        (f'<bml id="b">{HEAD_ELEMENT}</bml>', "none"),
        (f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{HEAD_ELEMENT}</bml>', "bml-1.0"),
        (f'<bml xmlns="http://www.mindmakers.org/projects/BML" id="b">{HEAD_ELEMENT}</bml>', "draft"),
        (f'<fml-apml><fml/><bml id="b">{HEAD_ELEMENT}</bml></fml-apml>', "fml-apml"),
        (f'<head><bml id="b">{HEAD_ELEMENT}</bml></head>', "none"),
        (f"  {HEAD_ELEMENT}", "smartbody"),
        (f"<!-- nod -->{HEAD_ELEMENT}", "smartbody"),
        ('[{"type": "head"}]', "json"),
        ('\n {"data": []}', "json"),
    ],
)
@pytest.mark.parametrize("encoding", [None, "utf-8", "utf-8-sig"])
def test_document_notation_and_dialect_are_detected_from_the_text(
    text: str, dialect: str, encoding: str | None
) -> None:
    document = read_document(text if encoding is None else text.encode(encoding), source="f")
    assert document.dialect == dialect
    assert document.bml.local == "bml"


def test_utf_16_and_latin_1_documents_are_read_as_xml() -> None:
    text = f'<?xml version="1.0" encoding="UTF-16"?><bml id="b">{HEAD_ELEMENT}</bml>'
    assert read_document(text.encode("utf-16"), source="f").dialect == "none"
    latin = '<?xml version="1.0" encoding="latin-1"?><bml id="é"/>'
    assert read_document(latin.encode("latin-1"), source="f").bml.attributes["id"] == "é"


@pytest.mark.parametrize(
    "text", [f'<bml id="b">{HEAD_ELEMENT}</bml>', HEAD_ELEMENT, '[{"type": "head", "lexeme": "NOD"}]']
)
def test_documents_above_the_size_limit_are_rejected_in_xml_and_json(text: str) -> None:
    with pytest.raises(BmlError, match=r"^f:1:1: the document has \d+ characters; the limit is 20"):
        read_document(text, source="f", bounds=DocumentBounds(size=20))


@pytest.mark.parametrize(
    "text", [f'<bml id="b">{3 * HEAD_ELEMENT}</bml>', 5 * HEAD_ELEMENT, "[" + ",".join(99 * "1") + "]"]
)
def test_documents_with_too_many_elements_are_rejected_in_xml_and_json(text: str) -> None:
    with pytest.raises(BmlError, match=r"^f:1:\d+: more than \d+ (elements|values); split the document"):
        read_document(text, source="f", bounds=DocumentBounds(elements=3))


@pytest.mark.parametrize("text", [f"<head><a>{HEAD_ELEMENT}</a></head>", '[{"type": "a", "b": {"c": [{}]}}]'])
def test_deeply_nested_documents_are_rejected_in_xml_and_json(text: str) -> None:
    with pytest.raises(BmlError, match=r"level.*; the limit is 3"):
        read_document(text, source="f", bounds=DocumentBounds(depth=3))
