"""Tests of documents within Markdown fences and prose."""

import pytest

from kinesic.bml.block import BmlError, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.wrapping import MAX_OPENED_SIZE, find_root, is_wrapped, open_document

XML_DOCUMENT = '<bml id="b"><head id="h" lexeme="NOD" start="1"/></bml>'
# the same document as JSON
JSON_DOCUMENT = '{"id": "b", "behaviours": [{"type": "head", "id": "h", "lexeme": "NOD", "start": 1}]}'
FENCE_NOTICE = "the Markdown fence around the document is ignored"  # notice about an ignored code fence


@pytest.mark.parametrize(
    "document", [XML_DOCUMENT, JSON_DOCUMENT, f'<?xml version="1.0"?>\n<!-- nod -->\n{XML_DOCUMENT}']
)
@pytest.mark.parametrize(
    ("before", "after", "notices"),
    [
        ("```\n", "\n```", [FENCE_NOTICE]),
        ("\ufeff\r\n```json\r\n", "\r\n```\r\n", [FENCE_NOTICE]),
        ("~~~~ xml\n", "", [FENCE_NOTICE]),
        (
            "Sure! A (small) nod:\n\n```xml\n",
            "\n```\nEnjoy.",
            [FENCE_NOTICE, "ignored: Sure!", "Enjoy"],
        ),
        ("Here: ", " Have fun -- I did.", ["before the document is ignored: Here:", "ignored: Have fun -- I did."]),
        ("[1] {see below} `", "`", ["ignored: [1] {see below} `", "ignored: `"]),
        ("<think>a nod? {}</think>\n", "", ["thoughts before the document are ignored"]),
        ("<|im_start|>", "", ["<|im_start|>"]),
    ],
)
def test_document_within_a_text_is_parsed_and_the_text_around_it_reported(document, before, after, notices):
    block = parse(before + document + after)
    [head] = block.behaviours
    text = before + document
    place = text.index("<head" if "<head" in text else '{"type"')
    line = text.count("\n", 0, place) + 1
    assert (block.id, head.place.line) == ("b", line)
    assert head.place.column == place - text.rfind("\n", 0, place) - (line == 1 and before[0] == "\ufeff" and 1)
    texts = [notice.text for notice in block.notices if notice.type is NoticeType.PARSING_FAILURE]
    assert len(texts) == len(notices)
    assert all(part in text for part, text in zip(notices, texts, strict=True))
    encoded = open_document((before + document + after).encode("utf-16"))
    assert encoded.surroundings == open_document(before + document + after).surroundings


@pytest.mark.parametrize(
    "text",
    [
        XML_DOCUMENT,
        f"\ufeff {XML_DOCUMENT}\n<!-- the end of </bml> -->",
        f"{XML_DOCUMENT}{XML_DOCUMENT}",
        "Hello {name}, how are [you]? It costs 3 < 5.",
        '{"a": [1, 2',
        "```sh\nrm x\n```",
        '<person><bml id="b"/></person>',
        '<!-- <bml id="old">',
        "",
    ],
)
def test_complete_documents_and_texts_without_a_document_are_unchanged(text):
    assert open_document(text).text == text
    assert not is_wrapped(text)


def test_error_in_a_document_within_a_code_fence_has_the_line_of_the_file():
    with pytest.raises(BmlError, match=r"^f:3:24: not JSON: ':' is missing"):
        parse('Sure:\n```json\n{"behaviours": 1, "id" 2}\n```', source="f")
    with pytest.raises(BmlError, match=r"^f:4:9: .*mismatched tag"):
        parse("Sure:\n```xml\n<bml>\n<head></bml>\n```", source="f")


@pytest.mark.parametrize(
    ("text", "root"),
    [
        (XML_DOCUMENT, "bml"),
        (f"Look:\n```\n{XML_DOCUMENT}", "bml"),
        ("```xml\n<speak>Hi</speak>\n```", "speak"),
        (JSON_DOCUMENT, ""),
        ("Hi.", ""),
    ],
)
def test_root_element_is_found_within_a_code_fence(text, root):
    assert find_root(text) == root
    assert find_root(text.encode()) == root


def test_document_in_an_unknown_element_is_read():
    for document in (JSON_DOCUMENT, f'<?xml version="1.0"?>{XML_DOCUMENT}', f"```\n{XML_DOCUMENT}\n```"):
        assert parse(f"<answer>{document}</answer>").behaviours[0].id == "h"


def test_text_above_the_size_limit_is_not_searched_for_a_document():
    text = "word " * (1 + MAX_OPENED_SIZE // 5) + "<bml id='b'/>"
    assert open_document(text).text is text
    assert not open_document(text[-1000:]).text[:900].strip()
