"""Paths of values in JSON documents, by line and column."""

import json

import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.mcp.json_paths import MAX_PATH_LENGTH, find_json_path

DOCUMENT = '{"id": "b",\n "behaviours": [{"type": "head"},\n  {"type": "gesture", "pose": {"part": "x"}}]}'


@pytest.mark.parametrize(
    ("line", "column", "path"),
    [
        (1, 1, ""),
        (1, 8, "id"),
        (2, 16, "behaviours"),
        (2, 17, "behaviours[0]"),
        (2, 26, "behaviours[0].type"),
        (3, 3, "behaviours[1]"),
        (3, 31, "behaviours[1].pose"),
        (3, 40, "behaviours[1].pose.part"),
    ],
)
def test_json_path_leads_to_the_value_at_a_line_and_column(line: int, column: int, path: str):
    assert find_json_path(DOCUMENT, line, column) == path


def test_json_path_quotes_keys_with_special_characters():
    text = '{"kinesic:style": {"a \\" b": 1}}'
    assert find_json_path(text, 1, text.index("1") + 1) == '["kinesic:style"]["a \\" b"]'


def test_json_path_of_an_error_includes_the_attribute_in_its_message():
    text = '{"behaviours": [{"type": "head", "amount": "much", "kinesic:power": "7"}]}'
    column = text.index("[{") + 2
    assert find_json_path(text, 1, column, problem="amount='much' is not a number") == "behaviours[0].amount"
    assert find_json_path(text, 1, column, problem="kinesic:power='7' is out") == 'behaviours[0]["kinesic:power"]'
    assert find_json_path(text, 1, column, problem="lexeme: unknown") == "behaviours[0]"


@pytest.mark.parametrize("text", ['{"a": [1, 2', '{"a": [1, "', "}}]]", '{"a" "b": [', "[" * 5000, ""])
def test_json_path_in_an_invalid_document_has_a_bounded_length(text: str):
    assert len(find_json_path(text, 1, len(text) + 1)) <= MAX_PATH_LENGTH


@pytest.mark.parametrize(
    ("behaviour", "path"),
    [
        ({"id": "s"}, "behaviours[1]"),
        ({"type": "gesture", "id": "g", "stroke": "x+"}, "behaviours[1].stroke"),
        ({"type": "head", "id": "g", "lexeme": "NOD", "amount": "much"}, "behaviours[1].amount"),
    ],
)
def test_bml_parser_errors_of_json_documents_lead_to_json_paths(behaviour: dict, path: str):
    text = json.dumps({"id": "b", "behaviours": [{"type": "head", "id": "h", "lexeme": "NOD"}, behaviour]})
    with pytest.raises(BmlError) as result:
        parse(text)
    _, line, column, problem = str(result.value).split(":", 3)
    assert find_json_path(text, int(line), int(column), problem=problem.strip()) == path
